!> From a deck of any kind to its scene
module dda_deck_scene
   use dda_arch_scene, only : arch_scene
   use dda_blocks_of_deck, only : file_scene, shape_scene
   use dda_boundary, only : history_t
   use dda_deck, only : deck_t, source_of
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_key_names, only : ground_amplitude, ground_direction_deg, ground_duration, &
      & ground_frequency, ground_pulse, ground_quantity, ground_record, ground_scale, ground_unit
   use dda_kinds, only : degree, pi, wp
   use dda_line_scene, only : line_scene
   use dda_live_loads, only : add_live_loads
   use dda_scene, only : scene_t
   implicit none
   private

   public :: deck_scene, move_ground

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
end module dda_deck_scene
