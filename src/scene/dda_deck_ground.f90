!> Ground motion of a scene: a pulse or a record
submodule (dda_deck_scene) dda_deck_ground
   use dda_boundary, only : history_t
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_key_names, only : ground_amplitude, ground_direction_deg, ground_duration, &
      & ground_frequency, ground_pulse, ground_quantity, ground_record, ground_scale, ground_unit
   use dda_kinds, only : pi
   implicit none

   !> Points per period of a sine
   integer, parameter :: points = 360
   !> Length of the jump at the end of a pulse over its duration
   real(wp), parameter :: jump = 1.0e-9_wp

contains

   !> Set the ground motion of a scene from &ground
   module procedure move_ground
      associate (acceleration => scene%settings%boundary%base_acceleration)
         if (deck%value(ground_pulse)%given) then
            acceleration = pulse_of(deck)
         else if (deck%value(ground_record)%given) then
            acceleration = record_of(deck)
         end if
         if (allocated(acceleration%value)) &
            & acceleration%value = deck%value(ground_scale)%number*acceleration%value
      end associate
   end procedure move_ground

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
end submodule dda_deck_ground
