!> Three equations with a symmetric matrix
module dda_three_unknowns
   use dda_kinds, only : wp
   implicit none
   private

   public :: hold_upright, solve_3

contains

   !> Take the second of three unknowns out: a smooth plane bears no weight, and stops none
   pure subroutine hold_upright(slope, curvature)
      real(wp), intent(inout) :: slope(3)         !! First derivatives
      real(wp), intent(inout) :: curvature(3, 3)  !! Second derivatives

      slope(2) = 0.0_wp
      curvature(:, 2) = 0.0_wp
      curvature(2, :) = 0.0_wp
      curvature(2, 2) = 1.0_wp
   end subroutine hold_upright

   !> Solve three equations with a symmetric matrix that is positive definite, except for directions
   !> without stiffness, in which nothing moves
   pure subroutine solve_3(a, b, x)
      real(wp), intent(in) :: a(3, 3)  !! The matrix
      real(wp), intent(in) :: b(3)     !! Right-hand side
      real(wp), intent(out) :: x(3)    !! The solution
      real(wp) :: r(3), l21, l31, l32

      r(1) = inverse(a(1, 1))
      l21 = a(2, 1)*r(1)
      l31 = a(3, 1)*r(1)
      r(2) = inverse(a(2, 2) - l21*a(2, 1))
      l32 = (a(3, 2) - l31*a(2, 1))*r(2)
      r(3) = inverse(a(3, 3) - l31*a(3, 1) - l32*(a(3, 2) - l31*a(2, 1)))
      x(1) = b(1)
      x(2) = b(2) - l21*x(1)
      x(3) = b(3) - l31*x(1) - l32*x(2)
      x = x*r
      x(2) = x(2) - l32*x(3)
      x(1) = x(1) - l21*x(2) - l31*x(3)
   end subroutine solve_3

   !> One over a number, or 0
   pure real(wp) function inverse(number)
      real(wp), intent(in) :: number  !! The number

      inverse = 0.0_wp
      if (abs(number) > tiny(number)) inverse = 1.0_wp/number
   end function inverse
end module dda_three_unknowns
