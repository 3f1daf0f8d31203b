!> The scenes of a deck that differ by one number
module dda_deck_family
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_chain, only : arch_chain, arch_numbers_t, arch_rays_t
   use dda_arch_form, only : form_problem_t
   use dda_arch_scene, only : arch_numbers, half_joints_deg, set_loads, settings_of, unit_weight
   use dda_chain, only : chain_t
   use dda_deck, only : deck_t, parameter_t, put_number, source_of
   use dda_deck_keys, only : deck_key
   use dda_deck_scene, only : deck_scene
   use dda_error, only : error_t, fatal_error
   use dda_key_names, only : arch_half_angle_deg, arch_thickness_ratio, &
      & load_gravity_direction_deg, load_horizontal_coefficient, load_load_factor
   use dda_key_value, only : number_fits
   use dda_kinds, only : degree, wp
   use dda_live_loads, only : check_live_points
   use dda_scene, only : family_t, scene_t, searched_load
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : load_direction, settings_t
   use dda_shape_scene, only : shape_assembly
   implicit none
   private

   public :: deck_family_t, new_family, put_value

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      type(deck_t), allocatable :: deck  !! The deck of one case
      !> The parameter
      type(parameter_t) :: parameter
      !> Whether its scenes are chains but for strain, and differ by their thickness ratio alone
      logical :: chains = .false.
      type(arch_numbers_t) :: numbers  !! Then: what the arches are made from
      type(settings_t) :: settings     !! Settings of their runs
      !> What does not depend on the thickness; made by the one who searches
      type(arch_rays_t) :: rays
   contains
      !> Make the chain of one value
      procedure :: link => link_arch
      !> Make the scene of one value
      procedure :: build => build_deck_scene
      !> Make the scene of one value from that of another one
      procedure :: turn => turn_deck_scene
   end type deck_family_t

contains

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
         family%settings = settings_of(deck, degree*deck%value(arch_half_angle_deg)%number, &
            & size(half_joints_deg(deck)))
         family%numbers = arch_numbers(deck)
         family%numbers%body_force = unit_weight(deck)*load_direction(family%settings)
         family%numbers%halved = family%decides_chains .and. plan%halved
      end associate
   end subroutine new_family

   !> Make the chain of one thickness ratio
   pure subroutine link_arch(family, value, settings, chain, linked)
      class(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! The thickness ratio
      type(settings_t), intent(out) :: settings
      !> Any chain in, whose arrays are used again where they fit
      type(chain_t), intent(inout) :: chain
      logical, intent(out) :: linked  !! Whether the scenes are chains, and one has this value

      linked = family%chains
      if (linked) linked = number_fits(deck_key(family%parameter%key), value)
      if (.not. linked) return
      settings = family%settings
      call arch_chain(family%numbers, family%rays, value, chain)
   end subroutine link_arch

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
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem

      deck = family%deck
      call put_value(family, value, deck, error)
      if (allocated(error)) return
      if (source_of(deck) == "shape") call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) call fatal_error(error, &
         & "the searched parameter makes no arch of this value")
      if (allocated(error)) return
      call deck_scene(deck, scene)
      call check_live_points(deck, scene, error)
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

end module dda_deck_family
