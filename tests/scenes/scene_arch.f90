!> A circular arch of equal voussoirs under its own weight, whose thickness or push is varied
module scene_arch
   use dda_arch, only : arch_blocks, arch_shape_t, equal_joints, facet_count
   use dda_contacts, only : find_contacts, raise_springs
   use dda_error, only : error_t
   use dda_kinds, only : degree, pi, wp
   use dda_material, only : joint_law_t, material_t
   use dda_scene, only : family_t, scene_t
   use dda_settings, only : settings_t
   implicit none
   private

   public :: arch_thickness_t, arch_push_t

   !> The arch; the value of the family is its thickness over its radius
   type, extends(family_t) :: arch_thickness_t
      integer :: voussoirs = 36  !! Number of voussoirs
      real(wp) :: half_angle = pi/2.0_wp  !! From the crown to a springing [rad]
      real(wp) :: radius = 10.0_wp  !! Halfway through the thickness [m]
      real(wp) :: facet_deg = 0.0_wp  !! Largest angle of a chord; 0 for one chord a voussoir [deg]
      real(wp) :: unit_weight = 22000.0_wp  !! Weight per volume [N/m3]
      type(joint_law_t) :: law = joint_law_t(no_slip=.true.)  !! Law of all joints
      type(material_t) :: material  !! Material of the voussoirs
      type(settings_t) :: settings  !! Settings of the run
   contains
      !> Make the scene of one thickness
      procedure :: build => build_arch
   end type arch_thickness_t

   !> The same of one thickness; the value of the family is the horizontal force over the weight
   type, extends(family_t) :: arch_push_t
      type(arch_thickness_t) :: arch         !! The arch
      real(wp) :: thickness_ratio = 0.15_wp  !! Its thickness over its radius
   contains
      !> Make the scene of one push
      procedure :: build => build_pushed_arch
   end type arch_push_t

contains

   !> Make the scene of one thickness
   pure subroutine build_arch(family, value, scene, error)
      class(arch_thickness_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Thickness over radius
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error  !! Never allocated
      type(arch_shape_t) :: shape
      type(joint_law_t), allocatable :: law(:)
      integer, allocatable :: edge_pair(:, :)
      integer :: chords, j

      shape%radius = family%radius
      shape%thickness_ratio = value
      shape%joint_angle = equal_joints(family%voussoirs, family%half_angle)
      chords = facet_count(2.0_wp*family%half_angle/(degree*real(family%voussoirs, wp)), &
         & family%facet_deg)
      shape%facets = [(chords, j=1, (family%voussoirs + 1)/2)]
      call arch_blocks(shape, family%material, scene%system, edge_pair)
      scene%system%unit_weight = family%unit_weight
      scene%settings = family%settings
      allocate (law(size(edge_pair, 2)), source=family%law)
      call find_contacts(scene%system, edge_pair, law, scene%contacts)
      call raise_springs(scene%settings, scene%system, scene%contacts)
      scene%joint_angle_deg = [(family%half_angle/degree &
         & *real(2*j - family%voussoirs, wp)/real(family%voussoirs, wp), j=0, family%voussoirs)]
      if (allocated(error)) deallocate (error)
   end subroutine build_arch

   !> Make the scene of one push
   pure subroutine build_pushed_arch(family, value, scene, error)
      class(arch_push_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Horizontal force over weight, to the right
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error  !! Never allocated

      call family%arch%build(family%thickness_ratio, scene, error)
      scene%settings%push = scene%settings%push + value
   end subroutine build_pushed_arch
end module scene_arch
