!> Newton's method on the energy of a step, with an exact line search: the energy is convex and
!> piecewise quadratic, so that it must end
!>
!> Equation (M1) of docs/method.md
module dda_newton
   use dda_assembly, only : equations_t, solve_faces
   use dda_bar_springs, only : bar_motion
   use dda_block_factor, only : substitute
   use dda_friction_cone, only : joint_face_t, project
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : disagreement, force_noise, joint_forces, step_state_t
   implicit none
   private

   public :: iterate_newton

   !> Most passes of Newton's method: where it needs more, a shorter step is cheaper
   integer, parameter :: max_newton = 80

contains

   !> Newton's method on the step's energy from the motion of the state, to the lowest point of each
   !> direction. That corrects what the blocks lack in balance, so that its rounding is small; a
   !> motion in balance is the answer even where rounding lets no face agree
   pure subroutine iterate_newton(equations, springs, state)
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), from(size(state%motion, 1), size(state%motion, 2))
      real(wp) :: direction(size(state%motion, 1), size(state%motion, 2))
      integer :: pass
      logical :: balanced

      do pass = 1, max_newton
         from = state%motion
         call joint_forces(springs, state)
         call find_unbalance(equations, springs, state, direction, balanced)
         call solve_faces(equations, springs, state%cone, state%face, state%start, state%motion)
         state%passes = state%passes + 1
         if (.not. equations%factor%usable) return
         call disagreement(springs, state, gap, wanted)
         state%settled = maxval(gap) <= force_noise(equations, springs, state)
         if (state%settled) return
         state%motion = from
         state%settled = balanced
         if (state%settled) return
         call substitute(equations%factor, direction)
         state%motion = from + lowest_point(equations, springs, state, from, direction)*direction
      end do
   end subroutine iterate_newton

   !> What the admissible forces of a motion leave of the loads, and whether that is rounding: then
   !> no other motion has noticeably less energy
   pure subroutine find_unbalance(equations, springs, state, rest, balanced)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      !> Loads that nothing balances: (n_dof, n_equation)
      real(wp), intent(out) :: rest(:, :)
      !> Whether rounding can make as much
      logical, intent(out) :: balanced
      real(wp) :: rounding(size(rest, 1), size(rest, 2)), noise
      real(wp) :: coupled(size(rest, 1), size(rest, 2))
      integer :: e, j, side

      noise = force_noise(equations, springs, state)
      coupled = bar_motion(equations%bars, state%motion)
      do e = 1, size(rest, 2)
         rest(:, e) = equations%load(:, e) - coupled(:, e) &
            & - matmul(equations%base(:, :, e), state%motion(:, e))
         rounding(:, e) = 8.0_wp*epsilon(1.0_wp)*(abs(equations%load(:, e)) &
            & + abs(coupled(:, e)) + matmul(abs(equations%base(:, :, e)), abs(state%motion(:, e))))
      end do
      do j = 1, size(state%face)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e == 0) cycle
            rest(:, e) = rest(:, e) + matmul(springs%row(:, :, side, j), state%force(:, j))
            rounding(:, e) = rounding(:, e) + noise*sum(abs(springs%row(:, :, side, j)), dim=2)
         end do
      end do
      balanced = all(abs(rest) <= rounding)
   end subroutine find_unbalance

   !> How far to go from one motion towards another for the least energy. The slope of the energy
   !> rises piecewise linearly, so its zero is found by bracketing and false position
   pure function lowest_point(equations, springs, state, from, direction) result(factor)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> The step, for bounds and forces at its beginning
      type(step_state_t), intent(in) :: state
      !> Where to start: (n_dof, n_equation)
      real(wp), intent(in) :: from(:, :)
      !> Where to go: (n_dof, n_equation)
      real(wp), intent(in) :: direction(:, :)
      !> 1 is the whole way
      real(wp) :: factor
      real(wp) :: start(3, size(state%face)), rate(3, size(state%face))
      real(wp) :: slope_zero, curvature, low, high, slope_low, slope_high, slope
      integer :: pass

      start = relative_displacement(springs, from)
      rate = relative_displacement(springs, direction)
      call block_slope(equations, from, direction, slope_zero, curvature)
      call find_bracket(low, high, slope_low, slope_high)
      factor = high
      do pass = 1, 60
         if (.not. slope_high > slope_low) exit
         factor = low - slope_low*(high - low)/(slope_high - slope_low)
         if (mod(pass, 3) == 0) factor = (low + high)/2.0_wp
         slope = slope_of(factor)
         if (slope < 0.0_wp) then
            low = factor
            slope_low = slope
         else
            high = factor
            slope_high = slope
         end if
         if (high - low <= 1.0e-14_wp*high .or. abs(slope) <= 1.0e-15_wp*abs(slope_zero)) exit
      end do

   contains

      !> A part of the way at whose end the slope has risen above zero
      pure subroutine find_bracket(low, high, slope_low, slope_high)
         !> Both ends, and the slopes there
         real(wp), intent(out) :: low, high, slope_low, slope_high

         low = 0.0_wp
         slope_low = slope_of(low)
         high = 1.0_wp
         slope_high = slope_of(high)
         do while (slope_high < 0.0_wp .and. high < 1.0e6_wp)
            low = high
            slope_low = slope_high
            high = 2.0_wp*high
            slope_high = slope_of(high)
         end do
      end subroutine find_bracket

      !> Slope of the energy along the direction
      pure function slope_of(way) result(slope)
         !> How far along the direction
         real(wp), intent(in) :: way
         real(wp) :: slope
         real(wp) :: force(3), shift(3)
         type(joint_face_t) :: face
         integer :: j

         slope = slope_zero + way*curvature
         do j = 1, size(rate, 2)
            shift = springs%shift(:, j)
            call project(state%cone(j), shift + state%start(:, j) &
               & - springs%stiffness(j)*(start(:, j) + way*rate(:, j)), force, face)
            slope = slope - dot_product(force - shift, rate(:, j))
         end do
      end function slope_of
   end function lowest_point

   !> Slope of the energy of blocks and bars along a direction, and how it grows
   pure subroutine block_slope(equations, from, direction, slope, curvature)
      type(equations_t), intent(in) :: equations
      real(wp), intent(in) :: from(:, :), direction(:, :)
      !> The slope where the way begins
      real(wp), intent(out) :: slope
      !> Its growth by the whole way
      real(wp), intent(out) :: curvature
      integer :: e

      slope = sum(bar_motion(equations%bars, direction)*from)
      curvature = sum(bar_motion(equations%bars, direction)*direction)
      do e = 1, size(from, 2)
         slope = slope + dot_product(direction(:, e), &
            & matmul(equations%base(:, :, e), from(:, e)) - equations%load(:, e))
         curvature = curvature + dot_product(direction(:, e), &
            & matmul(equations%base(:, :, e), direction(:, e)))
      end do
   end subroutine block_slope
end module dda_newton
