!> Scene of a deck of any kind, and family of scenes of a search
module dda_deck_scene
   use dda_arch_assembly, only : arch_assembly_t, n_movable
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_arch_scene, only : arch_numbers, arch_scene, half_joints_deg, joint_angles_deg, &
      & material_of, set_loads, settings_of, unit_weight
   use dda_block_input, only : block_plan_t
   use dda_block_scene, only : base_t, block_scene
   use dda_boundary, only : history_t
   use dda_deck, only : deck_t, has_group, parameter_t, put_number, source_of
   use dda_deck_keys, only : deck_key
   use dda_error, only : error_t, fatal_error
   use dda_fill_loads, only : add_fill_weight, fill_of, fill_t, press_fill
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_key_names, only : arch_half_angle_deg, arch_lune_deg, arch_thickness_ratio, fill_group, &
      & ground_amplitude, ground_direction_deg, ground_duration, ground_frequency, ground_pulse, &
      & ground_quantity, ground_record, ground_scale, ground_unit, joint_cohesion, &
      & joint_friction_deg, joint_residual_deg, joint_slip_length, joint_tension, &
      & load_displacement_factor, load_gravity, load_gravity_direction_deg, &
      & load_horizontal_coefficient, load_load_factor, load_water_rise, scene_kind, tie_group
   use dda_key_value, only : number_fits
   use dda_kinds, only : degree, pi, wp
   use dda_line_scene, only : held_blocks, line_scene
   use dda_live_loads, only : add_live_loads, check_live_points
   use dda_scene, only : family_t, scene_t, searched_load
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : load_direction
   use dda_shape_check, only : add_ties
   use dda_shape_scene, only : add_lune_weights, find_crown_joint, prescribe_springings, &
      & shape_assembly, shape_form
   implicit none
   private

   public :: deck_family_t, deck_scene, movable_blocks, move_ground, new_family, put_value

   !> Scenes of one deck as a function of the searched parameter
   type, extends(family_t) :: deck_family_t
      type(deck_t), allocatable :: deck  !! The deck of one case
      type(parameter_t) :: parameter     !! The searched parameter
   contains
      !> Make the scene of a value
      procedure :: build => build_deck_scene
      !> Make the scene of a value from that of another value
      procedure :: turn => turn_deck_scene
   end type deck_family_t

   !> Points per period of a sine
   integer, parameter :: points = 360
   !> Length of the jump at the end of a pulse over its duration
   real(wp), parameter :: jump = 1.0e-9_wp

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

   !> Make the scene of a shaped arch
   pure subroutine shape_scene(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(out) :: scene  !! The scene; without blocks if the arch does not exist
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(fill_t) :: fill

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) return
      if (has_group(deck, tie_group)) call add_ties(deck, assembly%plan)
      call prescribe_springings(deck, assembly%plan)
      call file_scene(deck, assembly%plan, scene)
      call find_crown_joint(assembly, scene)
      if (deck%value(arch_lune_deg)%given) call add_lune_weights(deck%value(arch_lune_deg)%number, &
         & scene)
      if (has_group(deck, fill_group)) then
         fill = fill_of(deck, assembly)
         call add_fill_weight(fill, scene)
         call add_live_loads(deck, scene, fill)
         call press_fill(fill, scene)
      else
         call add_live_loads(deck, scene)
      end if
   end subroutine shape_scene

   !> Make the scene of a block plan
   pure subroutine file_scene(deck, blocks, scene)
      type(deck_t), intent(in) :: deck
      type(block_plan_t), intent(in) :: blocks
      type(scene_t), intent(out) :: scene
      type(base_t) :: base

      base%material = material_of(deck)
      base%unit_weight = unit_weight(deck)
      base%gravity = deck%value(load_gravity)%number
      base%law = [deck%value(joint_friction_deg)%number, deck%value(joint_cohesion)%number, &
         & deck%value(joint_tension)%number, 90.0_wp, deck%value(joint_slip_length)%number]
      if (deck%value(joint_residual_deg)%given) base%law(4) = deck%value(joint_residual_deg)%number
      base%water_rise = deck%value(load_water_rise)%number
      scene%settings = settings_of(deck, pi/2.0_wp, size(blocks%fixed))
      call block_scene(blocks, base, scene)
   end subroutine file_scene

   !> Number of movable blocks in the scene of a case
   pure integer function movable_blocks(deck)
      type(deck_t), intent(in) :: deck
      type(arch_form_t) :: form
      type(form_problem_t) :: problem

      if (allocated(deck%cut)) then
         movable_blocks = count(.not. held_blocks(deck%cut))
      else if (deck%value(scene_kind)%text == "blocks") then
         movable_blocks = count(.not. deck%plan%fixed)
      else if (source_of(deck) == "shape") then
         call shape_form(deck, form, problem)
         movable_blocks = n_movable(form)
      else
         movable_blocks = size(joint_angles_deg(deck)) - 1
      end if
   end function movable_blocks

   !> Set the ground motion of a scene from &ground
   pure subroutine move_ground(deck, scene)
      type(deck_t), intent(in) :: deck
      !> The scene; without &ground, the motion of its file of blocks is kept
      type(scene_t), intent(inout) :: scene

      associate (acceleration => scene%settings%boundary%base_acceleration)
         if (deck%value(ground_pulse)%given) then
            acceleration = pulse_of(deck)
         else if (deck%value(ground_record)%given) then
            acceleration = record_of(deck)
         end if
         if (allocated(acceleration%value)) &
            & acceleration%value = deck%value(ground_scale)%number*acceleration%value
      end associate
   end subroutine move_ground

   !> Acceleration of a pulse. It ends with a drop to zero, because a history is constant after its
   !> last time
   pure type(history_t) function pulse_of(deck) result(pulse)
      type(deck_t), intent(in) :: deck
      real(wp) :: duration, frequency, along(2), half_step
      integer :: i, n

      along = deck%value(ground_amplitude)%number*direction_of(deck)
      duration = deck%value(ground_duration)%number
      frequency = deck%value(ground_frequency)%number
      if (deck%value(ground_pulse)%text == "sine") then
         if (.not. deck%value(ground_duration)%given) duration = 1.0_wp/frequency
         n = max(points, ceiling(min(1.0e5_wp, real(points, wp)*frequency*duration)))
         allocate (pulse%time(n + 2), pulse%value(2, n + 2))
         ! vertices lie outside the sine, so that the polygonal curve has the same impulse
         half_step = pi*frequency*duration/real(n, wp)
         do i = 0, n
            pulse%time(i + 1) = duration*real(i, wp)/real(n, wp)
            pulse%value(:, i + 1) = along*(tan(half_step)/half_step) &
               & *sin(2.0_wp*pi*frequency*pulse%time(i + 1))
         end do
      else
         n = 1
         allocate (pulse%time(3), pulse%value(2, 3))
         pulse%time(:2) = [0.0_wp, duration]
         pulse%value(:, :2) = spread(along, 2, 2)
      end if
      pulse%time(n + 2) = (1.0_wp + jump)*duration
      pulse%value(:, n + 2) = 0.0_wp
   end function pulse_of

   !> Unit vector of the direction of a pulse; exact along the axes
   pure function direction_of(deck) result(direction)
      type(deck_t), intent(in) :: deck
      real(wp) :: direction(2)  !! Components along x and y: (2)

      direction = degree*deck%value(ground_direction_deg)%number
      direction = [cos(direction(1)), sin(direction(1))]
      where (abs(direction) < epsilon(1.0_wp)) direction = 0.0_wp
   end function direction_of

   !> Acceleration of the record of a case, rotated, and scaled if an amplitude is given; zero
   !> outside the record
   pure type(history_t) function record_of(deck) result(acceleration)
      type(deck_t), intent(in) :: deck
      type(history_t) :: motion
      real(wp) :: turn(2, 2), largest
      integer :: i

      do i = 1, size(deck%ground_record)
         if (deck%ground_record(i)%name == deck%value(ground_record)%text) &
            & motion = deck%ground_record(i)%motion
      end do
      turn(:, 1) = direction_of(deck)
      turn(:, 2) = [-turn(2, 1), turn(1, 1)]
      motion%value = deck%value(ground_unit)%number*matmul(turn, motion%value)
      select case (deck%value(ground_quantity)%text)
      case ("velocity")
         acceleration = acceleration_of_velocity(motion)
      case ("displacement")
         acceleration = acceleration_of_displacement(motion)
      case default
         acceleration = acceleration_of_record(motion)
      end select
      if (.not. deck%value(ground_amplitude)%given) return
      largest = maxval(norm2(acceleration%value, dim=1))
      if (largest > 0.0_wp) acceleration%value = deck%value(ground_amplitude)%number/largest &
         & *acceleration%value
   end function record_of
end module dda_deck_scene
