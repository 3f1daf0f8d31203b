!> From a deck of any kind to its scene
module dda_deck_scene
   use dda_arch_assembly, only : arch_assembly_t, n_movable
   use dda_arch_chain, only : arch_chain, arch_numbers_t, arch_rays_t
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_arch_scene, only : arch_numbers, arch_scene, half_joints_deg, joint_angles_deg, &
      & material_of, settings_of, unit_weight
   use dda_block_input, only : block_plan_t
   use dda_block_scene, only : base_t, block_scene
   use dda_chain, only : chain_t
   use dda_constants, only : degree, pi
   use dda_deck, only : deck_t, parameter_t, scene_kind
   use dda_deck_keys, only : key_index
   use dda_deck_set, only : number_fits, put_number
   use dda_error, only : error_t, fatal_error
   use dda_fill_loads, only : add_fill_weight, fill_of, fill_t, press_fill
   use dda_ground, only : move_ground
   use dda_kinds, only : wp
   use dda_line_scene, only : held_blocks, line_scene
   use dda_live_loads, only : add_live_loads, check_live_points
   use dda_scene, only : family_t, scene_t, searched_load
   use dda_scene_plan, only : scene_plan_t
   use dda_settings, only : load_direction, settings_t
   use dda_shape_scene, only : add_lune_weights, find_crown_joint, shape_assembly, &
      & shape_form
   use dda_tie_bars, only : add_ties
   implicit none
   private

   public :: deck_family_t, deck_scene, movable_blocks, new_family

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      !> The deck of one case
      type(deck_t) :: deck
      !> The parameter
      type(parameter_t) :: parameter
      !> Whether its scenes are chains but for strain, and differ by their thickness ratio alone
      logical :: chains = .false.
      !> Then: what the arches are made from
      type(arch_numbers_t) :: numbers
      !> Settings of their runs
      type(settings_t) :: settings
      !> Angle of each joint from the crown: (n_joint) [deg]
      real(wp), allocatable :: joint_angle_deg(:)
      !> What does not depend on the thickness; made by the one who searches
      type(arch_rays_t) :: rays
   contains
      !> Make the chain of one value
      procedure :: link => link_arch
      !> Make the scene of one value
      procedure :: build => build_deck_scene
   end type deck_family_t

contains

   !> The family of a deck, its numbers read
   pure subroutine new_family(deck, plan, parameter, family)
      type(deck_t), intent(in) :: deck
      !> What its scenes need
      type(scene_plan_t), intent(in) :: plan
      !> The parameter that varies
      type(parameter_t), intent(in) :: parameter
      type(deck_family_t), intent(out) :: family

      family%deck = deck
      family%parameter = parameter
      if (parameter%key == key_index("load", "horizontal_coefficient")) &
         & family%load = searched_load%push
      if (parameter%key == key_index("load", "gravity_direction_deg")) &
         & family%load = searched_load%tilt
      if (parameter%key == key_index("load", "load_factor")) family%load = searched_load%factor
      family%chains = plan%row .and. parameter%key == key_index("arch", "thickness_ratio")
      family%decides_chains = family%chains .and. plan%chain
      if (.not. family%chains) return
      family%settings = settings_of(deck, degree*deck%arch%half_angle_deg%number, &
         & size(half_joints_deg(deck)))
      family%numbers = arch_numbers(deck)
      family%numbers%body_force = unit_weight(deck)*load_direction(family%settings)
      family%numbers%halved = family%decides_chains .and. plan%halved
      allocate (family%joint_angle_deg, source=joint_angles_deg(deck))
   end subroutine new_family

   !> Make the chain of one thickness ratio
   pure subroutine link_arch(family, value, settings, chain, linked)
      class(deck_family_t), intent(in) :: family
      !> The thickness ratio
      real(wp), intent(in) :: value
      type(settings_t), intent(out) :: settings
      type(chain_t), intent(out) :: chain
      !> Whether the scenes are chains, and one has this value
      logical, intent(out) :: linked

      linked = family%chains
      if (linked) linked = number_fits(family%parameter%key, value)
      if (.not. linked) return
      settings = family%settings
      call arch_chain(family%numbers, family%rays, value, chain)
   end subroutine link_arch

   !> Make the scene of one value of the parameter
   pure subroutine build_deck_scene(family, value, scene, error)
      class(deck_family_t), intent(in) :: family
      !> Value of its parameter
      real(wp), intent(in) :: value
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem

      if (.not. number_fits(family%parameter%key, value)) then
         call fatal_error(error, "the searched parameter cannot have this value")
         return
      end if
      deck = family%deck
      call put_number(deck, family%parameter, value, deck%value(family%parameter%key)%place, error)
      if (allocated(error)) return
      if (scene_kind(deck) == "shape") call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) then
         call fatal_error(error, "the searched parameter makes no arch of this value")
         return
      end if
      call deck_scene(deck, scene)
      call check_live_points(deck, scene, error)
   end subroutine build_deck_scene

   !> The scene that the deck of one case describes
   pure subroutine deck_scene(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(out) :: scene

      select case (scene_kind(deck))
      case ("arch")
         call arch_scene(deck, scene)
      case ("lines")
         call line_scene(deck, scene)
      case ("blocks")
         call file_scene(deck, deck%plan, scene)
      case ("shape")
         call shape_scene(deck, scene)
      end select
      call move_ground(deck, scene%settings%boundary%base_acceleration)
      if (scene_kind(deck) /= "shape") call add_live_loads(deck, scene)
   end subroutine deck_scene

   !> The scene of an arch of any shape
   pure subroutine shape_scene(deck, scene)
      type(deck_t), intent(in) :: deck
      !> The scene; of an arch that cannot be, without blocks
      type(scene_t), intent(out) :: scene
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(fill_t) :: fill

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) return
      if (deck%tie%given) call add_ties(deck, assembly%plan)
      call file_scene(deck, assembly%plan, scene)
      call find_crown_joint(assembly, scene)
      if (deck%arch%lune_deg%given) call add_lune_weights(deck%arch%lune_deg%number, scene)
      if (deck%fill%given) then
         fill = fill_of(deck, assembly)
         call add_fill_weight(fill, scene)
         call add_live_loads(deck, scene, fill)
         call press_fill(fill, scene)
      else
         call add_live_loads(deck, scene)
      end if
   end subroutine shape_scene

   !> Number of blocks that can move in the scene of a case
   pure integer function movable_blocks(deck)
      type(deck_t), intent(in) :: deck
      type(arch_form_t) :: form
      type(form_problem_t) :: problem

      if (allocated(deck%cut)) then
         movable_blocks = count(.not. held_blocks(deck%cut))
      else if (deck%scene%kind%word == "blocks") then
         movable_blocks = count(.not. deck%plan%fixed)
      else if (scene_kind(deck) == "shape") then
         call shape_form(deck, form, problem)
         movable_blocks = n_movable(form)
      else
         movable_blocks = size(joint_angles_deg(deck)) - 1
      end if
   end function movable_blocks

   !> The scene of blocks as a file or an arch gives them
   pure subroutine file_scene(deck, plan, scene)
      type(deck_t), intent(in) :: deck
      type(block_plan_t), intent(in) :: plan
      type(scene_t), intent(out) :: scene
      type(base_t) :: base
      integer :: i

      base%material = material_of(deck)
      base%unit_weight = unit_weight(deck)
      base%gravity = deck%load%gravity%number
      base%law = [deck%joint%friction_deg%number, deck%joint%cohesion%number, &
         & deck%joint%tension%number, 90.0_wp, deck%joint%slip_length%number]
      if (deck%joint%residual_deg%given) base%law(4) = deck%joint%residual_deg%number
      base%water_rise = deck%load%water_rise%number
      scene%settings = settings_of(deck, pi/2.0_wp, size(plan%fixed))
      call block_scene(plan, base, scene)
      if (.not. deck%load%displacement_factor%given) return
      if (.not. allocated(scene%settings%boundary%held)) return
      do i = 1, size(scene%settings%boundary%held)
         associate (path => scene%settings%boundary%held(i)%path)
            if (allocated(path%value)) path%value = deck%load%displacement_factor%number*path%value
         end associate
      end do
   end subroutine file_scene
end module dda_deck_scene
