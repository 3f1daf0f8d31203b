!> The scenes of a deck that differ by one number
submodule (dda_deck_scene) dda_deck_family
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_chain, only : arch_chain
   use dda_arch_form, only : form_problem_t
   use dda_arch_scene, only : arch_numbers, half_joints_deg, joint_angles_deg, set_loads, &
      & settings_of, unit_weight
   use dda_deck_keys, only : deck_key
   use dda_deck, only : put_number
   use dda_error, only : fatal_error
   use dda_key_names, only : arch_half_angle_deg, arch_thickness_ratio, &
      & load_gravity_direction_deg, load_horizontal_coefficient, load_load_factor
   use dda_key_value, only : number_fits
   use dda_live_loads, only : check_live_points
   use dda_scene, only : searched_load
   use dda_scene_plan, only : plan_scene
   use dda_settings, only : load_direction
   use dda_shape_scene, only : shape_assembly
   implicit none

contains

   !> Make a deck a family, its numbers read
   module procedure new_family
      family%parameter = parameter
      if (parameter%key == load_horizontal_coefficient) family%load = searched_load%push
      if (parameter%key == load_gravity_direction_deg) family%load = searched_load%tilt
      if (parameter%key == load_load_factor) family%load = searched_load%factor
      family%plan = plan
      family%chains = plan%row .and. parameter%key == arch_thickness_ratio
      family%decides_chains = family%chains .and. plan%chain
      if (.not. family%chains) return
      associate (deck => family%deck)
         family%settings = settings_of(deck, plan, degree*deck%value(arch_half_angle_deg)%number, &
            & size(half_joints_deg(deck)))
         family%numbers = arch_numbers(deck)
         family%numbers%body_force = unit_weight(deck)*load_direction(family%settings)
         family%numbers%halved = family%decides_chains .and. plan%halved
         allocate (family%joint_angle_deg, source=joint_angles_deg(deck))
      end associate
   end procedure new_family

   !> Make the chain of one thickness ratio
   module procedure link_arch
      linked = family%chains
      if (linked) linked = number_fits(deck_key(family%parameter%key), value)
      if (.not. linked) return
      settings = family%settings
      call arch_chain(family%numbers, family%rays, value, chain)
   end procedure link_arch

   !> Put one value of the parameter into a deck
   module procedure put_value
      if (number_fits(deck_key(family%parameter%key), value)) then
         call put_number(deck, family%parameter, value, &
            & deck%value(family%parameter%key)%place, error)
      else
         call fatal_error(error, "the searched parameter cannot have this value")
      end if
   end procedure put_value

   !> Make the scene of one value of the parameter
   module procedure build_deck_scene
      type(deck_t) :: deck
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(scene_plan_t) :: plan

      deck = family%deck
      call put_value(family, value, deck, error)
      if (allocated(error)) return
      if (source_of(deck) == "shape") call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) call fatal_error(error, &
         & "the searched parameter makes no arch of this value")
      if (allocated(error)) return
      plan = family%plan
      if (.not. family%chains) plan = plan_scene(deck)
      call deck_scene(deck, plan, scene)
      call check_live_points(deck, scene, error)
   end procedure build_deck_scene

   !> Make the scene of one value from that of another one
   module procedure turn_deck_scene
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
   end procedure turn_deck_scene

end submodule dda_deck_family
