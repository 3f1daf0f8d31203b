!> Newton's method on a convex function of three unknowns, quadratic from piece to piece
module dda_three_unknowns
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_energy_t, is_better, try_between, hold_upright, solve_3

   !> A function of the three unknowns: its value with its first and second derivatives
   type :: chain_energy_t
      real(wp) :: value = 0.0_wp            !! Value
      real(wp) :: slope(3) = 0.0_wp         !! First derivatives
      real(wp) :: curvature(3, 3) = 0.0_wp  !! Second derivatives
   end type chain_energy_t

   !> Share of the fall that a straight line promises which counts as a fall
   real(wp), parameter :: barely = 1.0e-4_wp
   !> How steep a shortened step may end, over how steep it begins
   real(wp), parameter :: less_steep = 0.5_wp
   !> Relative error that rounding makes of the function
   real(wp), parameter :: rounding = 1.0e-11_wp

contains

   !> Whether a place along a direction is good enough: lower, and not as steep by far
   pure logical function is_better(here, there, direction, fall, way)
      type(chain_energy_t), intent(in) :: here, there
      real(wp), intent(in) :: direction(3)  !! The direction
      real(wp), intent(in) :: fall          !! How steeply the function falls at the beginning
      real(wp), intent(in) :: way           !! How far the place is

      is_better = there%value <= here%value*(1.0_wp + rounding) - barely*way*fall &
         & .and. (way >= 1.0_wp &
         & .or. abs(dot_product(there%slope, direction)) <= less_steep*fall)
   end function is_better

   !> Where along a direction to try next, between a place with a negative slope and one with a
   !> positive one: Newton's method on the slope and the secant in turns
   pure subroutine try_between(there, direction, bracket, steepness, try, way)
      type(chain_energy_t), intent(in) :: there
      real(wp), intent(in) :: direction(3)
      real(wp), intent(inout) :: bracket(2)    !! How far its ends are: (2)
      real(wp), intent(inout) :: steepness(2)  !! The slopes there: (2)
      integer, intent(in) :: try               !! Number of the try
      real(wp), intent(inout) :: way           !! The last place in, the next out
      real(wp) :: curvature, next, slope
      integer :: side

      slope = dot_product(there%slope, direction)
      curvature = dot_product(direction, matmul(there%curvature, direction))
      side = merge(2, 1, slope > 0.0_wp)
      bracket(side) = way
      steepness(side) = slope
      next = way - slope/max(curvature, tiny(curvature))
      if (mod(try, 2) == 0) next = bracket(1) + (bracket(2) - bracket(1)) &
         & *steepness(1)/(steepness(1) - steepness(2))
      if (.not. (next > bracket(1) .and. next < bracket(2))) next = sum(bracket)/2.0_wp
      way = next
   end subroutine try_between

   !> Take the second of three unknowns out: a smooth plane bears no weight, and stops none
   pure subroutine hold_upright(slope, curvature)
      real(wp), intent(inout) :: slope(3)         !! First derivatives
      real(wp), intent(inout) :: curvature(3, 3)  !! Second derivatives

      slope(2) = 0.0_wp
      curvature(:, 2) = 0.0_wp
      curvature(2, :) = 0.0_wp
      curvature(2, 2) = 1.0_wp
   end subroutine hold_upright

   !> Solve three equations with a symmetric matrix that is positive definite, but for directions
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
