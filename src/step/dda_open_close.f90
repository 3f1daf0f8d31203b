!> The motion and the faces of one step by open-close iteration, Newton's method, interior point
!>
!> One step minimises a convex, piecewise quadratic energy (M1); with faces fixed that is a linear
!> system (M3). In chains joints that disagree with their faces more than their neighbours do
!> change them (Shi: df18 to df22). Elsewhere Newton's method searches lines; where many faces are
!> wrong these are mechanisms, which the next contact stops after a millionth of the way. Then
!> the interior point comes near the minimum, from any beginning.
module dda_open_close
   use dda_assembly, only : refresh, solve_faces
   use dda_bar_springs, only : acting, add_bars, bar_motion
   use dda_block_factor, only : substitute
   use dda_contact_interior, only : max_convex_iterations, share
   use dda_contact_types, only : joint_springs_t
   use dda_coulomb_interior, only : absent, coulomb_iterate_t, coulomb_lack_t, coulomb_problem_t, &
      & distances, find_lack, improve, mean_product
   use dda_friction_cone, only : cone_kind, joint_face_t, project
   use dda_joint_matrix, only : joint_matrix_t, lay_out_joints
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : disagreement, equations_t, force_noise, joint_forces, step_state_t
   implicit none
   private

   public :: approach, iterate_open_close

   !> Solutions before the interior point, which needs some twenty itself from wherever it begins
   integer, parameter :: few_passes = 20
   !> Least violation of a changing joint over the largest
   real(wp), parameter :: notable = 0.1_wp

contains

   !> Newton's method on the step's energy from a motion, to the lowest point of each direction.
   !> That corrects what the blocks lack in balance, so that its rounding is small; a motion in
   !> balance is the answer even where rounding lets no face agree
   pure subroutine iterate_newton(equations, springs, state)
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> The step; its motion is where the method begins and ends
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face)), from(size(state%motion, 1), size(state%motion, 2))
      real(wp) :: direction(size(state%motion, 1), size(state%motion, 2))
      integer :: pass
      logical :: balanced

      do pass = 1, few_passes
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
      real(wp), dimension(3, size(state%face)) :: begun, rate
      real(wp) :: curvature, high, low, of_blocks, slope, slope_high, slope_low
      integer :: pass

      begun = relative_displacement(springs, from)
      rate = relative_displacement(springs, direction)
      of_blocks = sum(direction*(block_forces(equations, from) - equations%load))
      curvature = sum(direction*block_forces(equations, direction))
      low = 0.0_wp
      slope_low = slope_at(low)
      high = 1.0_wp
      slope_high = slope_at(high)
      do while (slope_high < 0.0_wp)
         low = high
         slope_low = slope_high
         high = 2.0_wp*high
         slope_high = slope_at(high)
      end do
      factor = high
      do pass = 1, 60
         if (.not. slope_high > slope_low) exit
         factor = low - slope_low*(high - low)/(slope_high - slope_low)
         if (mod(pass, 3) == 0) factor = (low + high)/2.0_wp
         slope = slope_at(factor)
         if (slope < 0.0_wp) then
            low = factor
            slope_low = slope
         else
            high = factor
            slope_high = slope
         end if
         if (high - low <= spacing(high) .or. abs(slope) <= epsilon(slope)*abs(of_blocks)) exit
      end do

   contains

      !> Slope of the energy on the way
      pure real(wp) function slope_at(way)
         real(wp), intent(in) :: way  !! Distance along it
         real(wp) :: force(3), shift(3)
         type(joint_face_t) :: face
         integer :: j

         slope_at = of_blocks + way*curvature
         do j = 1, size(rate, 2)
            shift = springs%shift(:, j)
            call project(state%cone(j), shift + state%trial(:, j) &
               & - springs%stiffness(j)*(begun(:, j) + way*rate(:, j)), force, face)
            slope_at = slope_at - dot_product(force - shift, rate(:, j))
         end do
      end function slope_at
   end function lowest_point

   !> Forces by which blocks and bars resist a motion
   pure function block_forces(equations, motion) result(force)
      type(equations_t), intent(in) :: equations
      real(wp), intent(in) :: motion(:, :)  !! The motion: (n_dof, n_equation)
      real(wp) :: force(size(motion, 1), size(motion, 2))  !! The forces: (n_dof, n_equation)
      integer :: e

      force = bar_motion(equations%bars, motion)
      do e = 1, size(motion, 2)
         force(:, e) = force(:, e) + matmul(equations%base(:, :, e), motion(:, e))
      end do
   end function block_forces

   !> Find the motion and the faces of one step
   pure subroutine iterate_open_close(equations, springs, most, state)
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: most  !! Most changes of the faces of a chain
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      type(joint_face_t) :: wanted(size(state%face))
      real(wp) :: gap(size(state%face))
      integer :: pass

      call refresh(springs, equations)
      do pass = 1, merge(min(most, few_passes), 1, equations%matrix%has_chains)
         call keep_faces(equations, springs, state, gap, wanted)
         if (.not. equations%factor%usable) return
         if (state%settled) exit
         where (is_peak(springs, gap, size(equations%load, 2))) state%face = wanted
      end do
      if (.not. state%settled) call iterate_newton(equations, springs, state)
      if (.not. state%settled) then
         call approach(equations, springs, state)
         call iterate_newton(equations, springs, state)
      end if
      if (state%settled) call joint_forces(springs, state)
   end subroutine iterate_open_close

   !> A motion near that of a step by the interior point (`dda_coulomb_interior`)
   pure subroutine approach(equations, springs, state)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state  !! The step; its motion is set
      type(coulomb_problem_t) :: q
      type(coulomb_iterate_t) :: x
      type(coulomb_lack_t) :: lack
      type(joint_matrix_t) :: matrix
      real(wp) :: length
      integer :: pass

      call pose_step(equations, springs, state, q)
      call lay_out_joints(q%block, size(q%load, 1), size(q%load, 2), .true., matrix%matrix, &
         & matrix%factor, matrix%entry)
      x%motion = 0.0_wp*q%load
      x%force = 0.0_wp*q%gap
      x%slack = max(distances(q, x%force), equations%force_scale)
      x%flow = merge(max(equations%force_scale*q%unit([1, 2, 3, 3], :), &
         & maxval(abs(state%increment))), 0.0_wp, q%bounded)
      do pass = 1, max_convex_iterations
         if (mean_product(q, x%slack, x%flow) <= epsilon(1.0_wp)*equations%force_scale**2) exit
         call find_lack(q, x, lack)
         call improve(q, lack, share, matrix, x, length)
         if (.not. matrix%factor%usable) exit
         state%passes = state%passes + 1
         equations%factorisations = equations%factorisations + 1
      end do
      state%motion = x%motion
   end subroutine approach

   !> The step as a problem of joints with compliance, behind which its bars stand as joints
   !> without bounds
   pure subroutine pose_step(equations, springs, state, q)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      type(coulomb_problem_t), intent(out) :: q
      integer :: i, j, n

      n = size(state%cone)
      associate (bars => equations%bars, more => size(equations%bars%trial))
         q%base = equations%base
         q%load = equations%load
         call add_bars(bars, -1.0_wp, q%base, q%load)
         q%load = equations%load
         allocate (q%block(2, n + more), q%bounded(4, n + more))
         allocate (q%row(size(q%load, 1), 3, 2, n + more), q%gap(3, n + more), &
            & q%shift(3, n + more), q%friction(n + more), q%limit(n + more), source=0.0_wp)
         allocate (q%soft(3, n + more), source=absent)
         q%dilatancy = 1.0_wp
         q%friction(:n) = state%cone%friction
         q%limit(:n) = state%cone%limit
         q%block(:, :n) = springs%equation
         q%row(:, :, :, :n) = springs%row
         q%shift(:, :n) = springs%shift
         do j = 1, n
            q%gap(:, j) = -state%trial(:, j)/springs%stiffness(j)
            q%soft(:, j) = 1.0_wp/springs%stiffness(j)
            q%bounded(:2, j) = state%cone(j)%kind /= cone_kind%mirror
            q%bounded(3:, j) = state%cone(j)%kind == cone_kind%frictional
            if (state%cone(j)%kind == cone_kind%mirror) q%soft(3, j) = absent
            if (.not. state%cone(j)%single) cycle
            q%bounded(2, j) = .false.
            q%soft(2, j) = absent
            q%shift(2, j) = 0.0_wp
         end do
         do i = 1, more
            j = n + i
            q%block(:, j) = bars%equation(:, i)
            q%row(:, :2, :, j) = bars%row(:, :, :, i)
            q%soft(:2, j) = 1.0_wp/max(acting(bars, i), tiny(1.0_wp))
            q%bounded(:, j) = .false.
         end do
         q%unit = q%soft
      end associate
   end subroutine pose_step

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

   !> Joints that disagree with their face as much as any other joint of their two blocks, and
   !> notably beside all joints
   pure function is_peak(springs, gap, n_equation)
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: gap(:)
      integer, intent(in) :: n_equation  !! Number of movable blocks
      logical :: is_peak(size(gap))      !! The joints: (n_joint)
      real(wp) :: highest(0:n_equation)
      integer :: j

      highest = 0.0_wp
      do j = 1, size(gap)
         highest(springs%equation(:, j)) = max(highest(springs%equation(:, j)), gap(j))
      end do
      highest(0) = notable*maxval(gap)
      do j = 1, size(gap)
         is_peak(j) = gap(j) > 0.0_wp .and. gap(j) >= max(highest(0), &
            & maxval(highest(springs%equation(:, j))))
      end do
   end function is_peak
end module dda_open_close
