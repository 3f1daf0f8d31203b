!> Newton's method on the energy of a step, with an exact line search: the energy is convex and
!> piecewise quadratic, so that it must end
!>
!> Equation (M1) of docs/method.md
!>
!> The open-close loop: an active-set method on the faces of the friction cones (Shi: df18 to df22)
!>
!> One step minimises a convex, piecewise quadratic energy. With the faces fixed the minimum is a
!> linear system; each joint that disagrees with its face more than its neighbours do then changes
!> it, as the simplex method pivots. Should a set of faces come again, only the worst joint does;
!> should one come again then, Newton's method with an exact line search, which must end.
!>
!> Equation (M3) of docs/method.md
module dda_open_close
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_assembly, only : refresh, solve_faces
   use dda_bar_springs, only : bar_motion
   use dda_block_factor, only : substitute
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : joint_face_t, project
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : disagreement, equations_t, force_noise, joint_forces, step_state_t
   implicit none
   private

   public :: iterate_open_close, change_faces

   !> Most passes of Newton's method: where it needs more, a shorter step is cheaper
   integer, parameter :: max_newton = 80

   !> Joints that disagree as much as the worst except for rounding change with it: mirror images do
   real(wp), parameter :: tie = 1.0e-9_wp
   !> Joints whose disagreement is below this share of the largest wait for their turn
   real(wp), parameter :: notable = 0.1_wp
   !> Changes of faces before Newton's method takes over where blocks make no chain
   integer, parameter :: few_changes = 1

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
      !> Where to start, and where to go: (n_dof, n_equation)
      real(wp), intent(in) :: from(:, :), direction(:, :)
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
         real(wp) :: slope, force(3), shift(3)
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

   !> Find the motion and the faces of one step
   pure subroutine iterate_open_close(equations, springs, max_changes, state, one_by_one)
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Most changes of faces of a chain before Newton's method takes over
      integer, intent(in) :: max_changes
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      !> Whether only the joint that disagrees most changes its face, as it does after a repetition
      logical, intent(in), optional :: one_by_one
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), best(size(state%motion, 1), size(state%motion, 2)), least
      integer(int64) :: seen(max_changes + 1)
      integer :: change, most, since
      logical :: peaks

      call refresh(springs, equations)
      most = merge(max_changes, min(max_changes, few_changes), equations%matrix%width <= 1)
      peaks = .true.
      if (present(one_by_one)) peaks = .not. one_by_one
      since = 1
      state%settled = .false.
      best = 0.0_wp
      least = huge(least)
      do change = 1, most + 1
         seen(change) = hash(state%face)
         if (any(seen(since:change - 1) == seen(change))) then
            if (.not. peaks) exit
            peaks = .false.
            since = change
         end if
         call solve_faces(equations, springs, state%cone, state%face, state%start, state%motion)
         state%passes = state%passes + 1
         if (.not. equations%factor%usable) return
         call disagreement(springs, state, gap, wanted)
         state%settled = maxval(gap) <= force_noise(equations, springs, state)
         if (state%settled) exit
         if (maxval(gap) < least) then
            least = maxval(gap)
            best = state%motion
         end if
         if (peaks) then
            where (is_peak(equations, springs, gap)) state%face = wanted
         else
            where (gap >= (1.0_wp - tie)*maxval(gap)) state%face = wanted
         end if
      end do
      if (.not. state%settled) then
         state%motion = best
         call iterate_newton(equations, springs, state)
      end if
      if (state%settled) call joint_forces(springs, state)
   end subroutine iterate_open_close

   !> Change the faces of a motion once: where to begin, if the motion is nearly that of a step
   pure subroutine change_faces(equations, springs, state)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> The step; its faces are changed
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face))

      call disagreement(springs, state, gap, wanted)
      if (maxval(gap) <= force_noise(equations, springs, state)) return
      where (is_peak(equations, springs, gap)) state%face = wanted
   end subroutine change_faces

   !> Joints that disagree more than all others of their two blocks
   pure function is_peak(equations, springs, gap)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Disagreement: (n_joint) [N/m]
      real(wp), intent(in) :: gap(:)
      !> The joints: (n_joint)
      logical :: is_peak(size(gap))
      real(wp) :: highest, threshold
      integer :: e, j, k, side

      threshold = notable*maxval(gap)
      do j = 1, size(gap)
         is_peak(j) = gap(j) >= threshold
         if (.not. is_peak(j)) cycle
         highest = gap(j)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e == 0) cycle
            do k = equations%first_joint(e), equations%first_joint(e + 1) - 1
               highest = max(highest, gap(abs(equations%joint(k))))
            end do
         end do
         is_peak(j) = gap(j) >= (1.0_wp - tie)*highest
      end do
   end function is_peak

   !> A number that tells sets of faces apart
   pure function hash(face) result(number)
      !> Faces: (n_joint)
      type(joint_face_t), intent(in) :: face(:)
      integer(int64) :: number
      integer(int64) :: code
      integer :: j

      number = 0_int64
      do j = 1, size(face)
         code = face(j)%slip + 1
         if (face(j)%open(1)) code = code + 3
         if (face(j)%open(2)) code = code + 6
         number = ieor(ishft(number, 7) + ishft(number, -57), mixed(12_int64*j + code))
      end do

   contains

      !> A number spread over all bits by shifts, which cannot overflow
      pure function mixed(code)
         !> Number to spread
         integer(int64), intent(in) :: code
         integer(int64) :: mixed

         mixed = ieor(code, ishft(code, 21))
         mixed = ieor(mixed, ishft(mixed, -35))
         mixed = ieor(mixed, ishft(mixed, 4))
         mixed = ieor(mixed, ishft(mixed, 41))
      end function mixed
   end function hash

end module dda_open_close
