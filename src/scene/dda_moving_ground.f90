!> The ground of a deck that moves: records and waves as accelerations of its blocks
submodule (dda_deck_scene) dda_moving_ground
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_kinds, only : degree, pi
   implicit none

   !> Points of a period of a sine
   integer, parameter :: points = 360

   !> Length of the jump at the end of a pulse, over its duration
   real(wp), parameter :: jump = 1.0e-9_wp

contains

   !> Give the ground of a scene the motion that &ground asks for
   module procedure move_ground
      if (deck%ground%pulse%given) then
         acceleration = pulse_of(deck)
      else if (deck%ground%record%given) then
         acceleration = record_of(deck)
      end if
      if (allocated(acceleration%value)) &
         & acceleration%value = deck%ground%scale%number*acceleration%value
   end procedure move_ground

   !> A pulse. What is constant before its beginning and after its end is no time of the run, and
   !> nothing
   pure type(history_t) function pulse_of(deck) result(pulse)
      type(deck_t), intent(in) :: deck
      real(wp) :: duration, frequency, along(2)
      integer :: i, n

      along = deck%ground%amplitude%number*direction_of(deck)
      duration = deck%ground%duration%number
      frequency = deck%ground%frequency%number
      if (deck%ground%pulse%word == "sine") then
         if (.not. deck%ground%duration%given) duration = 1.0_wp/frequency
         n = max(points, ceiling(min(1.0e5_wp, real(points, wp)*frequency*duration)))
         allocate (pulse%time(n + 2), pulse%value(2, n + 2))
         do i = 0, n
            pulse%time(i + 1) = duration*real(i, wp)/real(n, wp)
            pulse%value(:, i + 1) = along*swell(pi*frequency*duration/real(n, wp)) &
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

   !> By how much the corners of a broken line lie outside its sine, that it have the same impulse
   pure real(wp) function swell(half_step)
      !> Half the angle from corner to corner [rad]
      real(wp), intent(in) :: half_step

      swell = tan(half_step)/half_step
   end function swell

   !> Unit vector of the direction of a pulse; the four main ones are free of rounding
   pure function direction_of(deck) result(direction)
      type(deck_t), intent(in) :: deck
      !> Components along x and y: (2)
      real(wp) :: direction(2)

      direction = degree*deck%ground%direction_deg%number
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
         if (deck%ground_record(i)%name == deck%ground%record%text) &
            & motion = deck%ground_record(i)%motion
      end do
      turn(:, 1) = direction_of(deck)
      turn(:, 2) = [-turn(2, 1), turn(1, 1)]
      motion%value = deck%ground%unit%number*matmul(turn, motion%value)
      select case (deck%ground%quantity%word)
      case ("velocity")
         acceleration = acceleration_of_velocity(motion)
      case ("displacement")
         acceleration = acceleration_of_displacement(motion)
      case default
         acceleration = acceleration_of_record(motion)
      end select
      if (.not. deck%ground%amplitude%given) return
      largest = maxval(norm2(acceleration%value, dim=1))
      if (largest > 0.0_wp) acceleration%value = deck%ground%amplitude%number/largest &
         & *acceleration%value
   end function record_of

end submodule dda_moving_ground
