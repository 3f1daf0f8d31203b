!> Small functions of an angle that keep every digit where the textbook form cancels
!>
!> All theories of the circular arch are written with differences such as x - sin x, 1 - cos x and 2
!> - x cot(x/2). Taken literally they lose two digits with every digit by which the angle gets
!> smaller. Here each is summed or factored so that its relative error stays at a few units in the
!> last place from 0 to pi.
module couplet_heyman_kernels
   use, intrinsic :: iso_fortran_env, only : wp => real64
   implicit none
   private

   public :: arc_excess, versine, arm_excess, embrace, embrace_deficit

   !> Below this argument [rad] the power series are shorter and sharper than sine and cosine
   real(wp), parameter :: series_range = 1.5_wp
   !> Terms that reach the last digit there
   integer, parameter :: terms = 11

contains

   !> p(x) = x - sin x: what an arc of the unit circle is longer than its half chord
   elemental real(wp) function arc_excess(x)
      !> Angle [rad]
      real(wp), intent(in) :: x
      !> Ratios of the series, 1/(2i (2i + 1))
      real(wp), parameter :: ratio(terms) = &
         1.0_wp/real([20, 42, 72, 110, 156, 210, 272, 342, 420, 506, 600], wp)

      if (abs(x) < series_range) then
         arc_excess = x*x*x/6.0_wp*nested_series(x*x, ratio)
      else
         arc_excess = x - sin(x)
      end if
   end function arc_excess

   !> q(x) = 1 - cos x = 2 sin^2(x/2)
   elemental real(wp) function versine(x)
      real(wp), intent(in) :: x

      versine = 2.0_wp*sin(0.5_wp*x)**2
   end function versine

   !> k(x) = sin x - x cos x
   elemental real(wp) function arm_excess(x)
      real(wp), intent(in) :: x
      !> Ratios of the series, 1/(2i (2i + 3))
      real(wp), parameter :: ratio(terms) = &
         1.0_wp/real([10, 28, 54, 88, 130, 180, 238, 304, 378, 460, 550], wp)

      if (abs(x) < series_range) then
         arm_excess = x*x*x/3.0_wp*nested_series(x*x, ratio)
      else
         arm_excess = sin(x) - x*cos(x)
      end if
   end function arm_excess

   !> A(x) = x cot(x/2), eq. (9), the group through which the half angle of embrace enters every
   !> theory
   elemental function embrace(x) result(a)
      real(wp), intent(in) :: x  !! Angle in (-pi, pi); 0 is allowed [rad]
      real(wp) :: a              !! x cot(x/2), from 2 at 0 down to 0 at pi

      if (abs(x) < 1.0_wp) then
         a = 2.0_wp - embrace_deficit(x)
      else
         a = x/tan(0.5_wp*x)
      end if
   end function embrace

   !> a(x) = 2 - A(x) = 2 - x cot(x/2) = 2 k(x/2)/sin(x/2)
   elemental function embrace_deficit(x) result(a)
      real(wp), intent(in) :: x
      real(wp) :: a  !! 2 - x cot(x/2), from 0 at 0 up to 2 at pi

      a = 0.0_wp
      if (abs(x) > 0.0_wp) a = 2.0_wp*arm_excess(0.5_wp*x)/sin(0.5_wp*x)
   end function embrace_deficit

   !> 1 - y r(1) (1 - y r(2) (1 - ...)): an alternating series from its last term
   pure real(wp) function nested_series(y, ratio)
      real(wp), intent(in) :: y             !! Square of the argument
      real(wp), intent(in) :: ratio(terms)  !! Each term over the one before it and over -y: (terms)
      integer :: i

      nested_series = 1.0_wp
      do i = terms, 1, -1
         nested_series = 1.0_wp - y*ratio(i)*nested_series
      end do
   end function nested_series

end module couplet_heyman_kernels
