!> One block on a fixed base of its own width, level or not, pushed or not
module scene_block_on_base
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_material, only : friction_coefficient, joint_law_t, material_t
   use dda_scene, only : family_t, scene_t
   use dda_settings, only : settings_t
   use scene_model, only : add_block, add_joint, model_t, rectangle, scene_of, turned
   implicit none
   private

   public :: block_on_base_t, varied, varied_enum

   !> What a search changes
   type :: varied_enum
      integer :: push = 1          !! Horizontal force over weight
      integer :: friction_deg = 2  !! Angle of friction [deg]
      integer :: width = 3         !! Width of the block [m]
      integer :: unit_weight = 4   !! Weight per volume [N/m3]
   end type varied_enum

   !> Names of what a search changes
   type(varied_enum), parameter :: varied = varied_enum()

   !> The block; its base is block 1, it is block 2
   type, extends(family_t) :: block_on_base_t
      real(wp) :: width = 1.0_wp   !! Along the base [m]
      real(wp) :: height = 2.0_wp  !! Across the base [m]
      !> Angle by which block and base are turned counter-clockwise [rad]
      real(wp) :: slope = 0.0_wp
      real(wp) :: push = 0.0_wp             !! Horizontal force over weight, to the right
      real(wp) :: unit_weight = 25000.0_wp  !! Weight per volume [N/m3]
      type(joint_law_t) :: law              !! Law of the joint
      type(material_t) :: material          !! Material of the block
      type(settings_t) :: settings          !! Settings; the push is added to theirs
      integer :: what = 1                   !! One of varied
   contains
      !> Make the scene of one value
      procedure :: build => build_block_on_base
   end type block_on_base_t

contains

   !> Make the scene of one value of what is varied
   pure subroutine build_block_on_base(family, value, scene, error)
      class(block_on_base_t), intent(in) :: family
      real(wp), intent(in) :: value  !! The value
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error  !! Never allocated
      type(model_t) :: model
      type(joint_law_t) :: law
      real(wp) :: push, width

      law = family%law
      push = family%push
      width = family%width
      model%settings = family%settings
      model%material = family%material
      model%unit_weight = family%unit_weight
      if (family%what == varied%push) push = value
      if (family%what == varied%width) width = value
      if (family%what == varied%friction_deg) law%friction = friction_coefficient(value)
      if (family%what == varied%unit_weight) model%unit_weight = value
      model%settings%push = model%settings%push + push
      associate (base => rectangle([0.0_wp, -1.0_wp], width, 1.0_wp), &
         & block => rectangle([0.0_wp, 0.0_wp], width, family%height))
         call add_block(model, turned(base, family%slope), fixed=.true.)
         call add_block(model, turned(block, family%slope))
      end associate
      call add_joint(model, [1, 3, 2, 1], law)
      scene = scene_of(model)
      if (allocated(error)) deallocate (error)
   end subroutine build_block_on_base
end module scene_block_on_base
