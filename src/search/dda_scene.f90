!> A scene ready to run, and families of scenes that differ by one number
module dda_scene
   use dda_arch_chain, only : arch_chain, arch_numbers_t, arch_rays_t
   use dda_block_system, only : block_system_t, move_system
   use dda_chain, only : chain_t
   use dda_contacts, only : contacts_t, move_contacts
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   implicit none
   private

   public :: scene_t, family_t, link_t, searched_load, searched_load_enum, build_once, link_once
   public :: move_scene

   !> Load coefficients that come last on the loading path
   type :: searched_load_enum
      integer :: none = 0    !! The parameter is none
      integer :: push = 1    !! Horizontal coefficient
      integer :: tilt = 2    !! Direction of gravity
      integer :: factor = 3  !! Load factor of the live loads
   end type searched_load_enum

   !> Their names
   type(searched_load_enum), parameter :: searched_load = searched_load_enum()

   !> Thickness ratio of an arch without intrados
   real(wp), parameter :: thickest = 2.0_wp

   !> Blocks and contacts at the beginning, and how to run them
   type :: scene_t
      type(settings_t) :: settings    !! Settings of the run
      type(block_system_t) :: system  !! Blocks at the beginning
      type(contacts_t) :: contacts    !! Contacts at the beginning
      !> Where the origin of the blocks' coordinates is in those of the user: (2) [m]
      real(wp) :: origin(2) = 0.0_wp
      !> Angle of each joint from the crown, positive to the right; only for arches: (n_joint) [deg]
      real(wp), allocatable :: joint_angle_deg(:)
      !> Number of the joint at the crown of an arch of any shape; 0 for what is none
      integer :: crown_joint = 0
   end type scene_t

   !> The chain of a family that was made last
   type :: link_t
      logical :: known = .false.  !! True if there is one
      real(wp) :: value = 0.0_wp  !! Its value of the parameter
      type(chain_t) :: chain      !! The chain
   end type link_t

   !> Scenes that differ by the value of one parameter
   type, abstract :: family_t
      logical :: chains = .false.  !! True if they are chains apart from strain
      type(arch_numbers_t) :: numbers  !! Then: what the arches are made from
      type(settings_t) :: chain_settings  !! Settings of their runs
      type(arch_rays_t) :: rays  !! Rays, which do not depend on the thickness; made once per search
      !> True if its chains, if there are any, are decided as such; otherwise collapses alone are
      !> traced on them
      logical :: decides_chains = .false.
      integer :: load = 0  !! Load coefficient that the parameter is, one of searched_load
   contains
      procedure(build_scene), deferred :: build  !! Make the scene of one value
      !> Make the scene of one value from that of another one
      procedure :: turn => turn_anew
   end type family_t

   abstract interface
      !> Make the scene of one value
      pure subroutine build_scene(family, value, scene, error)
         import :: error_t, family_t, scene_t, wp
         class(family_t), intent(in) :: family
         real(wp), intent(in) :: value  !! Value of its parameter
         type(scene_t), intent(out) :: scene
         type(error_t), allocatable, intent(out) :: error
      end subroutine build_scene
   end interface

contains

   !> Make the scene of one value where it is not there yet, from that of another load coefficient
   !> where that is there; without joints where there is none
   pure subroutine build_once(family, value, scene)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(scene_t), intent(inout) :: scene
      type(error_t), allocatable :: error

      if (family%load == searched_load%none .and. allocated(scene%contacts%joint)) return
      call family%turn(value, scene, error)
      if (allocated(error) .and. allocated(scene%contacts%joint)) deallocate (scene%contacts%joint)
   end subroutine build_once

   !> Hand a scene over without a copy of what is large
   pure subroutine move_scene(from, to)
      type(scene_t), intent(inout) :: from  !! The scene; its blocks and contacts are gone
      type(scene_t), intent(inout) :: to

      to%settings = from%settings
      to%origin = from%origin
      to%crown_joint = from%crown_joint
      call move_system(from%system, to%system)
      call move_contacts(from%contacts, to%contacts)
      call move_alloc(from%joint_angle_deg, to%joint_angle_deg)
   end subroutine move_scene

   !> Make the scene of one value, whatever that of another one has
   pure subroutine turn_anew(family, value, scene, error)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(scene_t), intent(inout) :: scene
      type(error_t), allocatable, intent(out) :: error

      call family%build(value, scene, error)
   end subroutine turn_anew

   !> Make the chain of one value where it is not there yet
   pure subroutine link_once(family, value, link)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(link_t), intent(inout) :: link  !! The last chain, whose arrays are used again

      if (link%known .and. .not. abs(value - link%value) > 0.0_wp) return
      link%known = family%chains .and. value > 0.0_wp .and. value < thickest
      if (link%known) call arch_chain(family%numbers, family%rays, value, link%chain)
      link%value = value
   end subroutine link_once
end module dda_scene
