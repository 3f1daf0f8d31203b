!> Ground acceleration from velocity or displacement
!>
!> Accelerations are histories, linear between their times. A piecewise linear velocity has an
!> acceleration with jumps. A displacement is interpolated by a cubic spline, whose second
!> derivative is piecewise linear.
module dda_ground_motion
   use dda_boundary, only : history_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: acceleration_of_record, acceleration_of_velocity, acceleration_of_displacement

   !> Duration of a jump over the adjacent interval
   real(wp), parameter :: share = 1.0e-9_wp

contains

   !> Acceleration of an acceleration record; zero before and after
   pure function acceleration_of_record(record) result(acceleration)
      type(history_t), intent(in) :: record  !! The record, with at least two times [m/s2]
      type(history_t) :: acceleration        !! The acceleration [m/s2]
      integer :: n

      n = size(record%time)
      allocate (acceleration%time(n + 2), acceleration%value(2, n + 2))
      acceleration%time(1) = record%time(1) - jump_beside(record%time(1:2))
      acceleration%time(2:n + 1) = record%time
      acceleration%time(n + 2) = record%time(n) + jump_beside(record%time(n - 1:n))
      acceleration%value = 0.0_wp
      acceleration%value(:, 2:n + 1) = record%value
   end function acceleration_of_record

   !> Acceleration of a velocity that is linear between its times; zero before and after
   pure function acceleration_of_velocity(velocity) result(acceleration)
      type(history_t), intent(in) :: velocity  !! The velocity, with at least two times [m/s]
      type(history_t) :: acceleration          !! Its rate [m/s2]
      real(wp) :: length
      integer :: i, n

      n = size(velocity%time)
      allocate (acceleration%time(2*n), acceleration%value(2, 2*n))
      acceleration%value = 0.0_wp
      acceleration%time(1) = velocity%time(1) - jump_beside(velocity%time(1:2))
      do i = 1, n - 1
         length = velocity%time(i + 1) - velocity%time(i)
         acceleration%time(2*i:2*i + 1) = [velocity%time(i), &
            & velocity%time(i + 1) - jump_beside(velocity%time(i:i + 1))]
         acceleration%value(:, 2*i) = (velocity%value(:, i + 1) - velocity%value(:, i))/length
         acceleration%value(:, 2*i + 1) = acceleration%value(:, 2*i)
      end do
      acceleration%time(2*n) = velocity%time(n)
   end function acceleration_of_velocity

   !> Second derivative of the cubic spline through displacements, with the not-a-knot condition (a
   !> parabola for three points, a straight line for two). It is zero outside the record, where the
   !> velocity is constant
   pure function acceleration_of_displacement(displacement) result(acceleration)
      type(history_t), intent(in) :: displacement  !! The displacement, with at least two times [m]
      type(history_t) :: acceleration              !! Its second derivative [m/s2]

      acceleration = acceleration_of_record(history_t(displacement%time, &
         & second_derivatives(displacement%time, displacement%value)))
   end function acceleration_of_displacement

   !> Duration of a jump at an end of an interval: negligible, but above round-off [s]
   pure real(wp) function jump_beside(interval)
      real(wp), intent(in) :: interval(2)  !! Beginning and end: (2) [s]

      jump_beside = max(share*(interval(2) - interval(1)), 4.0_wp*spacing(maxval(abs(interval))))
   end function jump_beside

   !> Second derivatives of the spline at its points, from a tridiagonal system
   pure function second_derivatives(time, value) result(second)
      real(wp), intent(in) :: time(:)      !! Times of the points, increasing: (n)
      real(wp), intent(in) :: value(:, :)  !! Values at the points: (2, n)
      real(wp) :: second(2, size(time))    !! Second derivatives: (2, n)
      real(wp) :: length(size(time) - 1), slope(2, size(time) - 1)
      real(wp) :: diagonal(size(time)), above(size(time)), below(size(time)), ratio
      integer :: i, n

      n = size(time)
      second = 0.0_wp
      if (n < 3) return
      length = time(2:) - time(:n - 1)
      slope = (value(:, 2:) - value(:, :n - 1))/spread(length, 1, 2)
      do i = 2, n - 1
         below(i) = length(i - 1)
         diagonal(i) = 2.0_wp*(length(i - 1) + length(i))
         above(i) = length(i)
         second(:, i) = 6.0_wp*(slope(:, i) - slope(:, i - 1))
      end do
      if (n == 3) then
         second(:, 2) = second(:, 2)/(3.0_wp*(length(1) + length(2)))
         second(:, [1, 3]) = spread(second(:, 2), 2, 2)
         return
      end if
      ! eliminate the ends, which continue their neighbours linearly
      ratio = length(1)/length(2)
      diagonal(2) = diagonal(2) + length(1)*(1.0_wp + ratio)
      above(2) = above(2) - length(1)*ratio
      ratio = length(n - 1)/length(n - 2)
      diagonal(n - 1) = diagonal(n - 1) + length(n - 1)*(1.0_wp + ratio)
      below(n - 1) = below(n - 1) - length(n - 1)*ratio
      do i = 3, n - 1
         ratio = below(i)/diagonal(i - 1)
         diagonal(i) = diagonal(i) - ratio*above(i - 1)
         second(:, i) = second(:, i) - ratio*second(:, i - 1)
      end do
      second(:, n - 1) = second(:, n - 1)/diagonal(n - 1)
      do i = n - 2, 2, -1
         second(:, i) = (second(:, i) - above(i)*second(:, i + 1))/diagonal(i)
      end do
      second(:, 1) = second(:, 2) + length(1)/length(2)*(second(:, 2) - second(:, 3))
      second(:, n) = second(:, n - 1) &
         & + length(n - 1)/length(n - 2)*(second(:, n - 1) - second(:, n - 2))
   end function second_derivatives
end module dda_ground_motion
