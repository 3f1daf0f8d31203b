!> The scene of a deck of any kind, and scenes that differ by one number
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

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      type(deck_t), allocatable :: deck  !! The deck of one case
      !> The parameter
      type(parameter_t) :: parameter
   contains
      !> Make the scene of one value
      procedure :: build => build_deck_scene
      !> Make the scene of one value from that of another one
      procedure :: turn => turn_deck_scene
   end type deck_family_t

   interface

      !> The scene of blocks as a file or an arch gives them
      pure module subroutine file_scene(deck, blocks, scene)
         type(deck_t), intent(in) :: deck
         type(block_plan_t), intent(in) :: blocks
         type(scene_t), intent(out) :: scene
      end subroutine file_scene

      !> Number of blocks that can move in the scene of a case
      pure integer module function movable_blocks(deck)
         type(deck_t), intent(in) :: deck
      end function movable_blocks

      !> The scene of an arch of any shape
      pure module subroutine shape_scene(deck, scene)
         type(deck_t), intent(in) :: deck
         !> The scene; of an arch that cannot be, without blocks
         type(scene_t), intent(out) :: scene
      end subroutine shape_scene

      !> Give the ground of a scene the motion that &ground asks for
      pure module subroutine move_ground(deck, scene)
         type(deck_t), intent(in) :: deck
         !> The scene, whose ground moves as the file of blocks says, if it does
         type(scene_t), intent(inout) :: scene
      end subroutine move_ground

   end interface

contains

   !> The scene that the deck of one case describes
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

   !> Multiply the displacements of points that a file of blocks leads
   pure subroutine scale_paths(factor, scene)
      real(wp), intent(in) :: factor         !! Their factor
      type(scene_t), intent(inout) :: scene  !! The scene; its paths are multiplied
      integer :: i

      if (.not. allocated(scene%settings%boundary%held)) return
      do i = 1, size(scene%settings%boundary%held)
         associate (path => scene%settings%boundary%held(i)%path)
            if (allocated(path%value)) path%value = factor*path%value
         end associate
      end do
   end subroutine scale_paths

   !> Make a deck a family, its numbers read
   pure subroutine new_family(parameter, family)
      type(parameter_t), intent(in) :: parameter
      type(deck_family_t), intent(inout) :: family  !! New but for the deck
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

   !> Put one value of the parameter into a deck
   pure subroutine put_value(family, value, deck, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value        !! The value
      type(deck_t), intent(inout) :: deck  !! That of the family, or its values alone
      type(error_t), allocatable, intent(out) :: error

      if (number_fits(deck_key(family%parameter%key), value)) then
         call put_number(deck, family%parameter, value, &
            & deck%value(family%parameter%key)%place, error)
      else
         call fatal_error(error, "the searched parameter cannot have this value")
      end if
   end subroutine put_value

   !> Make the scene of one value of the parameter
   pure subroutine build_deck_scene(family, value, scene, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Value of its parameter
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

   !> Make the scene of one value from that of another one: where a load coefficient is the
   !> parameter, nothing else differs
   pure subroutine turn_deck_scene(family, value, scene, error)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(scene_t), intent(inout) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck

      if (family%load == searched_load%none .or. .not. allocated(scene%contacts%joint)) then
         call family%build(value, scene, error)
      else
         ! numbers alone are asked for: blocks may be many
         deck%file = family%deck%file
         deck%value = family%deck%value
         call put_value(family, value, deck, error)
         if (.not. allocated(error)) call set_loads(deck, scene%settings)
      end if
   end subroutine turn_deck_scene
end module dda_deck_scene
