!> Scene of a deck of any kind, and family of scenes of a search
module dda_deck_scene
   use dda_arch_scene, only : arch_numbers, arch_scene, half_joints_deg, set_loads, settings_of, &
      & unit_weight
   use dda_block_input, only : block_plan_t
   use dda_deck, only : deck_t, parameter_t, put_number, source_of
   use dda_deck_keys, only : deck_key
   use dda_error, only : error_t, fatal_error
   use dda_key_names, only : arch_half_angle_deg, arch_thickness_ratio, &
      & load_displacement_factor, load_gravity_direction_deg, load_horizontal_coefficient, &
      & load_load_factor
   use dda_key_value, only : number_fits
   use dda_kinds, only : degree, wp
   use dda_line_scene, only : line_scene
   use dda_live_loads, only : add_live_loads, check_live_points
   use dda_scene, only : family_t, scene_t, searched_load
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : load_direction
   implicit none
   private

   public :: deck_family_t, deck_scene, movable_blocks, move_ground, new_family, put_value

   !> Scenes of one deck as a function of the searched parameter
   type, extends(family_t) :: deck_family_t
      type(deck_t), allocatable :: deck  !! The deck of one case
      !> The searched parameter
      type(parameter_t) :: parameter
   contains
      !> Make the scene of a value
      procedure :: build => build_deck_scene
      !> Make the scene of a value from that of another value
      procedure :: turn => turn_deck_scene
   end type deck_family_t

   interface

      !> Make the scene of a block plan
      pure module subroutine file_scene(deck, blocks, scene)
         type(deck_t), intent(in) :: deck
         type(block_plan_t), intent(in) :: blocks
         type(scene_t), intent(out) :: scene
      end subroutine file_scene

      !> Number of movable blocks in the scene of a case
      pure integer module function movable_blocks(deck)
         type(deck_t), intent(in) :: deck
      end function movable_blocks

      !> Make the scene of a shaped arch
      pure module subroutine shape_scene(deck, scene)
         type(deck_t), intent(in) :: deck
         !> The scene; without blocks if the arch does not exist
         type(scene_t), intent(out) :: scene
      end subroutine shape_scene

      !> Set the ground motion of a scene from &ground
      pure module subroutine move_ground(deck, scene)
         type(deck_t), intent(in) :: deck
         !> The scene; without &ground, the motion of its file of blocks is kept
         type(scene_t), intent(inout) :: scene
      end subroutine move_ground

   end interface

contains

   !> Make the scene of a deck
   pure subroutine deck_scene(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(out) :: scene

      select case (source_of(deck))
      case ("arch")
         call arch_scene(deck, scene)
      case ("lines")
         call line_scene(deck, scene)
      case ("blocks")
         call file_scene(deck, deck%plan, scene)
         call scale_paths(deck%value(load_displacement_factor)%number, scene)
      case ("shape")
         call shape_scene(deck, scene)
      end select
      call move_ground(deck, scene)
      if (source_of(deck) /= "shape") call add_live_loads(deck, scene)
   end subroutine deck_scene

   !> Scale the prescribed displacements
   pure subroutine scale_paths(factor, scene)
      real(wp), intent(in) :: factor         !! Factor of the displacements
      type(scene_t), intent(inout) :: scene  !! The scene; its prescribed displacements are scaled
      integer :: i

      if (.not. allocated(scene%settings%boundary%held)) return
      do i = 1, size(scene%settings%boundary%held)
         associate (path => scene%settings%boundary%held(i)%path)
            if (allocated(path%value)) path%value = factor*path%value
         end associate
      end do
   end subroutine scale_paths

   !> Prepare the family of a deck
   pure subroutine new_family(parameter, family)
      type(parameter_t), intent(in) :: parameter
      type(deck_family_t), intent(inout) :: family  !! The family; only its deck must be set
      type(scene_plan_t) :: plan

      plan = plan_scene(family%deck)
      family%parameter = parameter
      if (parameter%key == load_horizontal_coefficient) family%load = searched_load%push
      if (parameter%key == load_gravity_direction_deg) family%load = searched_load%tilt
      if (parameter%key == load_load_factor) family%load = searched_load%factor
      family%chains = plan%row .and. parameter%key == arch_thickness_ratio
      family%decides_chains = family%chains .and. plan%chain
      if (.not. family%chains) return
      associate (deck => family%deck)
         family%chain_settings = settings_of(deck, degree*deck%value(arch_half_angle_deg)%number, &
            & size(half_joints_deg(deck)))
         family%numbers = arch_numbers(deck)
         family%numbers%body_force = unit_weight(deck)*load_direction(family%chain_settings)
         family%numbers%halved = plan%halved
      end associate
   end subroutine new_family

   !> Set the parameter in a deck
   pure subroutine put_value(family, value, deck, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value        !! The value
      type(deck_t), intent(inout) :: deck  !! The deck of the family, or a copy of its values
      type(error_t), allocatable, intent(out) :: error

      if (number_fits(deck_key(family%parameter%key), value)) then
         call put_number(deck, family%parameter, value, &
            & deck%value(family%parameter%key)%place, error)
      else
         call fatal_error(error, "the searched parameter cannot have this value")
      end if
   end subroutine put_value

   !> Make the scene of a value of the parameter
   pure subroutine build_deck_scene(family, value, scene, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Value of the parameter
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck

      deck = family%deck
      call put_value(family, value, deck, error)
      if (allocated(error)) return
      call deck_scene(deck, scene)
      if (allocated(scene%system%area)) then
         call check_live_points(deck, scene, error)
      else
         call fatal_error(error, "the searched parameter makes no arch of this value")
      end if
   end subroutine build_deck_scene

   !> Make the scene of a value from that of another value; for a load coefficient only the settings
   !> differ
   pure subroutine turn_deck_scene(family, value, scene, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(scene_t), intent(inout) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck

      if (family%load == searched_load%none .or. .not. allocated(scene%contacts%joint)) then
         call family%build(value, scene, error)
      else
         ! copy only the values, because there may be many blocks
         deck%file = family%deck%file
         allocate (deck%value, source=family%deck%value)
         call put_value(family, value, deck, error)
         if (.not. allocated(error)) call set_loads(deck, scene%settings)
      end if
   end subroutine turn_deck_scene
end module dda_deck_scene
