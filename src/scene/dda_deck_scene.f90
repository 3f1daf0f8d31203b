!> From a deck of any kind to its scene
module dda_deck_scene
   use dda_arch_assembly, only : arch_assembly_t, n_movable
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_arch_scene, only : arch_scene, joint_angles_deg, material_of, settings_of, unit_weight
   use dda_block_input, only : block_plan_t
   use dda_block_scene, only : base_t, block_scene
   use dda_boundary, only : history_t
   use dda_deck, only : deck_t, has_group, source_of
   use dda_fill_loads, only : add_fill_weight, fill_of, fill_t, press_fill
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_key_names, only : arch_lune_deg, fill_group, ground_amplitude, ground_direction_deg, &
      & ground_duration, ground_frequency, ground_pulse, ground_quantity, ground_record, &
      & ground_scale, ground_unit, joint_cohesion, joint_friction_deg, joint_residual_deg, &
      & joint_slip_length, joint_tension, load_displacement_factor, load_gravity, &
      & load_water_rise, scene_kind, tie_group
   use dda_kinds, only : degree, pi, wp
   use dda_line_scene, only : held_blocks, line_scene
   use dda_live_loads, only : add_live_loads
   use dda_scene, only : scene_t
   use dda_shape_check, only : add_ties
   use dda_shape_scene, only : add_lune_weights, find_crown_joint, shape_assembly, shape_form
   implicit none
   private

   public :: deck_scene, movable_blocks, move_ground

   !> Points of a period of a sine
   integer, parameter :: points = 360

   !> Length of the jump at the end of a pulse, over its duration
   real(wp), parameter :: jump = 1.0e-9_wp

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
      case ("shape")
         call shape_scene(deck, scene)
      end select
      call move_ground(deck, scene%settings%boundary%base_acceleration)
      if (source_of(deck) /= "shape") call add_live_loads(deck, scene)
   end subroutine deck_scene

   !> Give the ground of a scene the motion that &ground asks for
   pure subroutine move_ground(deck, acceleration)
      type(deck_t), intent(in) :: deck
      !> Acceleration of the ground: that of the file of blocks in, that of the case out
      type(history_t), intent(inout) :: acceleration

      if (deck%value(ground_pulse)%given) then
         acceleration = pulse_of(deck)
      else if (deck%value(ground_record)%given) then
         acceleration = record_of(deck)
      end if
      if (allocated(acceleration%value)) &
         & acceleration%value = deck%value(ground_scale)%number*acceleration%value
   end subroutine move_ground

   !> A pulse. What is constant before its beginning and after its end is no time of the run, and
   !> nothing
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
         ! corners lie so far outside the sine that the broken line has its impulse
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

   !> Unit vector of the direction of a pulse; the four main ones are free of rounding
   pure function direction_of(deck) result(direction)
      type(deck_t), intent(in) :: deck
      real(wp) :: direction(2)  !! Components along x and y: (2)

      direction = degree*deck%value(ground_direction_deg)%number
      direction = [cos(direction(1)), sin(direction(1))]
      where (abs(direction) < epsilon(1.0_wp)) direction = 0.0_wp
   end function direction_of

   !> The record of the case as an acceleration, turned, and brought to its amplitude if one is
   !> given; none before its first time and after its last
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
      if (has_group(deck, tie_group)) call add_ties(deck, assembly%plan)
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

   !> The scene of blocks as a file or an arch gives them
   pure subroutine file_scene(deck, blocks, scene)
      type(deck_t), intent(in) :: deck
      type(block_plan_t), intent(in) :: blocks
      type(scene_t), intent(out) :: scene
      type(base_t) :: base
      integer :: i

      base%material = material_of(deck)
      base%unit_weight = unit_weight(deck)
      base%gravity = deck%value(load_gravity)%number
      base%law = [deck%value(joint_friction_deg)%number, deck%value(joint_cohesion)%number, &
         & deck%value(joint_tension)%number, 90.0_wp, deck%value(joint_slip_length)%number]
      if (deck%value(joint_residual_deg)%given) base%law(4) = deck%value(joint_residual_deg)%number
      base%water_rise = deck%value(load_water_rise)%number
      scene%settings = settings_of(deck, pi/2.0_wp, size(blocks%fixed))
      call block_scene(blocks, base, scene)
      if (.not. deck%value(load_displacement_factor)%given) return
      if (.not. allocated(scene%settings%boundary%held)) return
      do i = 1, size(scene%settings%boundary%held)
         associate (path => scene%settings%boundary%held(i)%path)
            if (allocated(path%value)) path%value = &
               & deck%value(load_displacement_factor)%number*path%value
         end associate
      end do
   end subroutine file_scene

   !> Number of blocks that can move in the scene of a case
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
end module dda_deck_scene
