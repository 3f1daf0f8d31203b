!> Newton's method on the energy of a step with an exact line search
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

   !> Maximum number of Newton iterations; beyond, a shorter step is cheaper
   integer, parameter :: max_newton = 80

   !> Relative difference within which violations are equal
   real(wp), parameter :: tie = 1.0e-9_wp
   !> Least violation of a changing joint over the largest
   real(wp), parameter :: notable = 0.1_wp
   !> Changes before Newton's method for assemblies other than chains
   integer, parameter :: few_changes = 1

   !> A line of motions
   type :: line_t
      real(wp), allocatable :: from(:, :)  !! Openings and slips where it begins: (3, n_joint) [m]
      real(wp), allocatable :: rate(:, :)  !! Their growth by the whole way: (3, n_joint) [m]
      real(wp) :: slope = 0.0_wp           !! Slope of the energy of blocks and bars where it begins
      real(wp) :: curvature = 0.0_wp       !! Its growth by the whole way
   end type line_t

contains

   !> Newton's method on the step's energy from a motion, to the lowest point of each direction.
   !> That corrects what the blocks lack in balance, so that its rounding is small; a motion in
   !> balance is the answer even where rounding lets no face agree
   pure subroutine iterate_newton(equations, springs, start, state)
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: start(:, :)  !! The motion: (n_dof, n_equation)
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), from(size(state%motion, 1), size(state%motion, 2))
      real(wp) :: direction(size(state%motion, 1), size(state%motion, 2))
      integer :: pass
      logical :: balanced

      state%motion = start
      do pass = 1, max_newton
         from = state%motion
         call joint_forces(springs, state)
         call find_unbalance(equations, springs, state, direction, balanced)
         call keep_faces(equations, springs, state, gap, wanted)
         if (state%settled .or. .not. equations%factor%usable) return
         state%motion = from
         state%settled = balanced
         if (state%settled) return
         call substitute(equations%factor, direction)
         state%motion = from + lowest_point(equations, springs, state, from, direction)*direction
      end do
   end subroutine iterate_newton

   !> Loads that the admissible forces of a motion do not balance, and whether that is rounding:
   !> then no other motion has noticeably less energy
   pure subroutine find_unbalance(equations, springs, state, rest, balanced)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      real(wp), intent(out) :: rest(:, :)  !! Loads that nothing balances: (n_dof, n_equation)
      logical, intent(out) :: balanced     !! True if rounding can make as much
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

   !> Step from one motion towards another with the least energy. The slope of the energy
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
      type(line_t) :: line
      real(wp) :: low, high, slope_low, slope_high, slope
      integer :: pass

      line%from = relative_displacement(springs, from)
      line%rate = relative_displacement(springs, direction)
      call block_slope(equations, from, direction, line%slope, line%curvature)
      call find_bracket(springs, state, line, low, high, slope_low, slope_high)
      factor = high
      do pass = 1, 60
         if (.not. slope_high > slope_low) exit
         factor = low - slope_low*(high - low)/(slope_high - slope_low)
         if (mod(pass, 3) == 0) factor = (low + high)/2.0_wp
         slope = slope_at(springs, state, line, factor)
         if (slope < 0.0_wp) then
            low = factor
            slope_low = slope
         else
            high = factor
            slope_high = slope
         end if
         if (high - low <= spacing(high) .or. abs(slope) <= epsilon(slope)*abs(line%slope)) exit
      end do
   end function lowest_point

   !> A part of the way at whose end the slope has risen above zero
   pure subroutine find_bracket(springs, state, line, low, high, slope_low, slope_high)
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      type(line_t), intent(in) :: line
      real(wp), intent(out) :: low, high, slope_low, slope_high  !! Both ends, and the slopes there

      low = 0.0_wp
      slope_low = slope_at(springs, state, line, low)
      high = 1.0_wp
      slope_high = slope_at(springs, state, line, high)
      do while (slope_high < 0.0_wp)
         low = high
         slope_low = slope_high
         high = 2.0_wp*high
         slope_high = slope_at(springs, state, line, high)
      end do
   end subroutine find_bracket

   !> Slope of the energy on a line
   pure function slope_at(springs, state, line, way) result(slope)
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      type(line_t), intent(in) :: line
      real(wp), intent(in) :: way  !! Distance along it
      real(wp) :: slope, force(3), shift(3)
      type(joint_face_t) :: face
      integer :: j

      slope = line%slope + way*line%curvature
      do j = 1, size(line%rate, 2)
         shift = springs%shift(:, j)
         call project(state%cone(j), shift + state%trial(:, j) &
            & - springs%stiffness(j)*(line%from(:, j) + way*line%rate(:, j)), force, face)
         slope = slope - dot_product(force - shift, line%rate(:, j))
      end do
   end function slope_at

   !> Slope of the energy of blocks and bars along a direction, and how it grows
   pure subroutine block_slope(equations, from, direction, slope, curvature)
      type(equations_t), intent(in) :: equations
      real(wp), intent(in) :: from(:, :), direction(:, :)
      real(wp), intent(out) :: slope      !! The slope where the way begins
      real(wp), intent(out) :: curvature  !! Its growth by the whole way
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
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Most changes of faces of a chain before Newton's method is used
      integer, intent(in) :: max_changes
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      !> True if only the joint that disagrees most changes its face, as it does after a repetition
      logical, intent(in), optional :: one_by_one
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), best(size(state%motion, 1), size(state%motion, 2)), least
      integer(int64) :: seen(max_changes + 1)
      integer :: change, most, since
      logical :: peaks

      call refresh(springs, equations)
      most = merge(max_changes, min(max_changes, few_changes), equations%matrix%has_chains)
      peaks = .true.
      if (present(one_by_one)) peaks = .not. one_by_one
      since = 1
      best = 0.0_wp
      least = huge(least)
      do change = 1, most + 1
         seen(change) = hash(state%face)
         if (any(seen(since:change - 1) == seen(change))) then
            if (.not. peaks) exit
            peaks = .false.
            since = change
         end if
         call keep_faces(equations, springs, state, gap, wanted)
         if (.not. equations%factor%usable) return
         if (state%settled) exit
         if (maxval(gap) < least) best = state%motion
         least = min(least, maxval(gap))
         where (is_peak(equations, springs, gap, peaks)) state%face = wanted
      end do
      if (.not. state%settled) call iterate_newton(equations, springs, best, state)
      if (state%settled) call joint_forces(springs, state)
   end subroutine iterate_open_close

   !> Change the faces of a motion once: where to begin, if the motion is nearly that of a step
   pure subroutine change_faces(equations, springs, state)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state  !! The step; its faces are changed
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face))

      call disagreement(springs, state, gap, wanted)
      if (maxval(gap) <= force_noise(equations, springs, state)) return
      where (is_peak(equations, springs, gap, .true.)) state%face = wanted
   end subroutine change_faces

   !> The motion if every joint keeps to its face, and whether all forces are admissible then
   pure subroutine keep_faces(equations, springs, state, gap, wanted)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> The step; its motion is set, unless the factor is not usable
      type(step_state_t), intent(inout) :: state
      real(wp), intent(out) :: gap(:)               !! Disagreement: (n_joint) [N/m]
      type(joint_face_t), intent(out) :: wanted(:)  !! Face that each joint ought to have: (n_joint)

      call solve_faces(equations, springs, state%cone, state%face, state%trial, state%motion)
      state%passes = state%passes + 1
      state%settled = .false.
      if (.not. equations%factor%usable) return
      call disagreement(springs, state, gap, wanted)
      state%settled = maxval(gap) <= force_noise(equations, springs, state)
   end subroutine keep_faces

   !> Joints that disagree more than all others of their two blocks, or than all others
   pure function is_peak(equations, springs, gap, of_blocks)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: gap(:)
      logical, intent(in) :: of_blocks  !! True if other joints of its two blocks alone count
      logical :: is_peak(size(gap))     !! The joints: (n_joint)
      real(wp) :: highest, threshold
      integer :: e, j, k, side

      is_peak = gap >= (1.0_wp - tie)*maxval(gap)
      if (.not. of_blocks) return
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

   !> Number that identifies a set of faces: the rest of their digits by a large prime
   pure integer(int64) function hash(face)
      type(joint_face_t), intent(in) :: face(:)  !! Faces: (n_joint)
      integer(int64), parameter :: prime = 2_int64**47 - 115_int64
      integer :: j

      hash = 0_int64
      do j = 1, size(face)
         hash = modulo(30011_int64*hash + face(j)%slip + 1 + merge(3, 0, face(j)%open(1)) &
            & + merge(6, 0, face(j)%open(2)), prime)
      end do
   end function hash
end module dda_open_close
