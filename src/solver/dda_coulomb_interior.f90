!> Joint forces under Coulomb's law by an interior-point method
!>
!>    A d = load + R f,   gap + R' d + C f = F_flow' z,   b = F f + bound >= 0,   z >= 0,   b z = 0
!>
!> A is a multiple of the mass: that of a time step, or the damping of a sudden load. The rows of F
!> give the distances of forces from their bounds: n1, n2, friction*(n1 + n2) + T and
!> friction*(n1 + n2) - T. Those of F_flow are n1, n2, T and -T, for joints that slide do not open:
!> the problem is not convex, and the search may end before a solution. With a dilatancy of 1 F_flow
!> is F, and the problem convex.
!>
!> With r = z/b a joint is a spring, the inverse of C + F_flow' r F, so that an iteration is one
!> factorisation with a predictor and a corrector (Mehrotra 1992). Springs and steps are closed
!> forms without differences of large numbers: elimination in the nearly singular 3x3 matrix, or
!> distances as sums of forces, would lose all digits.
module dda_coulomb_interior
   use dda_block_factor, only : substitute
   use dda_joint_matrix, only : add_row_forces, factor_joints, joint_matrix_t, row_openings
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: coulomb_iterate_t, coulomb_lack_t, coulomb_problem_t, absent, distances, find_lack
   public :: improve, mean_product

   !> The problem
   type :: coulomb_problem_t
      !> Matrix of each block without joints: (n_dof, n_dof, n_block)
      real(wp), allocatable :: base(:, :, :)
      real(wp), allocatable :: load(:, :)        !! Loads: (n_dof, n_block)
      integer, allocatable :: block(:, :)        !! Blocks of each joint, 0 if fixed: (2, n_joint)
      real(wp), allocatable :: row(:, :, :, :)   !! Rows of the joints: (n_dof, 3, 2, n_joint)
      real(wp), allocatable :: gap(:, :)         !! Openings without motion and forces: (3, n_joint)
      !> Compliance of each force, `absent` for a force that a joint does not have: (3, n_joint)
      real(wp), allocatable :: soft(:, :)
      real(wp), allocatable :: shift(:, :)  !! Tension that corners carry, and a zero: (3, n_joint)
      real(wp), allocatable :: friction(:)       !! Coefficients of friction: (n_joint)
      real(wp), allocatable :: limit(:)          !! Shear force without normal force: (n_joint)
      logical(small), allocatable :: bounded(:, :)  !! Bounds that exist: (4, n_joint)
      !> Opening that counts as much as a unit of force: (3, n_joint)
      real(wp), allocatable :: unit(:, :)
      real(wp) :: dilatancy = 0.0_wp  !! Opening by slip, over friction times slip: 0 or 1
      integer :: max_corrections = 0  !! Most corrections of a step until forces balance
   end type coulomb_problem_t

   !> An iterate, or a step from it
   type :: coulomb_iterate_t
      real(wp), allocatable :: motion(:, :)  !! Motion: (n_dof, n_block)
      real(wp), allocatable :: force(:, :)   !! N1, N2, T: (3, n_joint)
      real(wp), allocatable :: slack(:, :)   !! Distance of the forces from each bound: (4, n_joint)
      real(wp), allocatable :: flow(:, :)    !! Opening or slip at each bound: (4, n_joint)
   end type coulomb_iterate_t

   !> Residuals of the equations at an iterate
   type :: coulomb_lack_t
      real(wp), allocatable :: balance(:, :)   !! Of the balance of the blocks: (n_dof, n_block)
      real(wp), allocatable :: opening(:, :)   !! Of the openings: (3, n_joint)
      real(wp), allocatable :: distance(:, :)  !! Of the distances from bounds: (4, n_joint)
   end type coulomb_lack_t

   !> One joint at its bounds
   type :: joint_yield_t
      real(wp) :: soft      !! Compliance of the shear force
      real(wp) :: friction  !! Coefficient of friction
      real(wp) :: opening   !! Opening per slip: dilatancy times friction
      real(wp) :: ratio(4)  !! Flow over distance at each bound
      real(wp) :: own(2)    !! Stiffness of the normal forces without friction
      real(wp) :: wide      !! Stiffness of the shear bound by opening with slip
      real(wp) :: both      !! Compliance of shear at both bounds, times compliance
      real(wp) :: det       !! Determinant of normal and shear yield
   end type joint_yield_t

   !> Compliance of a force that a joint does not have
   real(wp), parameter :: absent = sqrt(huge(1.0_wp))
   !> Imbalance of a step that is not worth a correction, in units of force
   real(wp), parameter :: rounding = 1.0e-15_wp

contains

   !> Distances of forces from their bounds
   pure function distances(q, force) result(slack)
      type(coulomb_problem_t), intent(in) :: q
      real(wp), intent(in) :: force(:, :)         !! The forces: (3, n_joint)
      real(wp) :: slack(4, size(q%friction))      !! The distances: (4, n_joint)

      slack(:2, :) = force(:2, :) + q%shift(:2, :)
      slack(4, :) = q%limit + q%friction*(slack(1, :) + slack(2, :))
      slack(3, :) = slack(4, :) + force(3, :)
      slack(4, :) = slack(4, :) - force(3, :)
   end function distances

   !> Residuals of the equations at an iterate
   pure subroutine find_lack(q, x, lack)
      type(coulomb_problem_t), intent(in) :: q
      type(coulomb_iterate_t), intent(in) :: x
      type(coulomb_lack_t), intent(inout) :: lack
      integer :: n_joint

      n_joint = size(q%friction)
      if (.not. allocated(lack%balance)) allocate (lack%balance, mold=q%load)
      if (.not. allocated(lack%opening)) allocate (lack%opening(3, n_joint))
      call find_balance(q, q%load, x%motion, x%force, lack%balance)
      call row_openings(size(q%load, 1), n_joint, q%block, q%row, x%motion, lack%opening)
      lack%opening = -lack%opening - q%gap - q%soft*x%force
      lack%opening(1, :) = lack%opening(1, :) + x%flow(1, :) &
         & + q%dilatancy*q%friction*(x%flow(3, :) + x%flow(4, :))
      lack%opening(2, :) = lack%opening(2, :) + x%flow(2, :) &
         & + q%dilatancy*q%friction*(x%flow(3, :) + x%flow(4, :))
      lack%opening(3, :) = lack%opening(3, :) + x%flow(3, :) - x%flow(4, :)
      where (.not. q%soft < absent) lack%opening = 0.0_wp
      lack%distance = merge(distances(q, x%force) - x%slack, 0.0_wp, q%bounded)
   end subroutine find_lack

   !> Load and joint forces that motion does not balance
   pure subroutine find_balance(q, load, motion, force, balance)
      type(coulomb_problem_t), intent(in) :: q
      real(wp), intent(in) :: load(:, :)      !! The load: (n_dof, n_block)
      real(wp), intent(in) :: motion(:, :)    !! Motion: (n_dof, n_block)
      real(wp), intent(in) :: force(:, :)     !! Joint forces: (3, n_joint)
      real(wp), intent(out) :: balance(:, :)  !! The rest: (n_dof, n_block)
      integer :: b, c

      balance = load
      call add_row_forces(size(load, 1), size(force, 2), q%block, q%row, force, balance)
      do b = 1, size(load, 2)
         do c = 1, size(load, 1)
            balance(:, b) = balance(:, b) - q%base(:, c, b)*motion(c, b)
         end do
      end do
   end subroutine find_balance

   !> One iteration: a predictor, and a corrector towards equal products of distance and flow
   pure subroutine improve(q, lack, share, matrix, x, length)
      type(coulomb_problem_t), intent(in) :: q
      type(coulomb_lack_t), intent(in) :: lack        !! Residuals of the iterate
      real(wp), intent(in) :: share                   !! Step over the distance to the first bound
      type(joint_matrix_t), intent(inout) :: matrix   !! Its factor is computed again
      !> The iterate; unchanged where the factor is not usable
      type(coulomb_iterate_t), intent(inout) :: x
      real(wp), intent(out) :: length                 !! Step over the full one
      type(coulomb_iterate_t) :: step
      type(joint_yield_t) :: yield(size(q%friction))
      real(wp) :: aim, mean
      integer :: k

      length = 0.0_wp
      do k = 1, size(yield)
         yield(k) = yield_of(q, x, k)
      end do
      call factor_joints(q%base, q%block, q%row, spring_stiffness(yield), matrix)
      if (.not. matrix%factor%usable) return
      step = x
      step%flow = -x%slack*x%flow
      call find_step(q, yield, matrix, x, lack, step)
      length = longest(q, x, step, 1.0_wp)
      mean = mean_product(q, x%slack, x%flow)
      aim = mean*min(1.0_wp, mean_product(q, x%slack + length*step%slack, &
         & x%flow + length*step%flow)/max(mean, tiny(mean)))**3
      step%flow = -x%slack*x%flow - length*step%slack*step%flow
      do k = 1, 4
         step%flow(k, :) = step%flow(k, :) + aim*q%unit(min(k, 3), :)
      end do
      call find_step(q, yield, matrix, x, lack, step)
      length = longest(q, x, step, share)
      x%motion = x%motion + length*step%motion
      x%force = x%force + length*step%force
      x%slack = x%slack + length*step%slack
      x%flow = x%flow + length*step%flow
   end subroutine improve

   !> The step that removes all residuals
   pure subroutine find_step(q, yield, matrix, x, lack, step)
      type(coulomb_problem_t), intent(in) :: q
      type(joint_yield_t), intent(in) :: yield(:)  !! The joints at their bounds: (n_joint)
      type(joint_matrix_t), intent(in) :: matrix
      type(coulomb_iterate_t), intent(in) :: x
      type(coulomb_lack_t), intent(in) :: lack
      !> The step; its flow in is the change of the products of distance and flow
      type(coulomb_iterate_t), intent(inout) :: step
      real(wp) :: last, motion(size(x%motion, 1), size(x%motion, 2))
      real(wp), dimension(3, size(x%force, 2)) :: force, opening
      real(wp), dimension(4, size(x%force, 2)) :: slack, source
      integer :: turn

      source = merge((step%flow - x%flow*lack%distance)/x%slack, 0.0_wp, q%bounded)
      step%motion = 0.0_wp
      step%force = 0.0_wp
      step%slack = lack%distance
      motion = lack%balance
      opening = lack%opening
      last = huge(last)
      call yield_joints(yield, opening, source, force, slack)
      call add_row_forces(size(motion, 1), size(force, 2), q%block, q%row, force, motion)
      do turn = 0, q%max_corrections
         call substitute(matrix%factor, motion)
         step%motion = step%motion + motion
         call row_openings(size(motion, 1), size(force, 2), q%block, q%row, motion, force)
         opening = opening - force
         call yield_joints(yield, opening, source, force, slack)
         step%force = step%force + force
         step%slack = step%slack + merge(slack, 0.0_wp, q%bounded)
         if (turn == q%max_corrections) exit
         call find_balance(q, lack%balance, step%motion, step%force, motion)
         if (.not. maxval(abs(motion)) < 0.5_wp*last .or. maxval(abs(motion)) < rounding) exit
         last = maxval(abs(motion))
         opening = 0.0_wp
         source = 0.0_wp
      end do
      step%flow = merge((step%flow - x%flow*step%slack)/x%slack, 0.0_wp, q%bounded)
   end subroutine find_step

   !> One joint at its bounds
   pure type(joint_yield_t) function yield_of(q, x, j) result(y)
      type(coulomb_problem_t), intent(in) :: q
      type(coulomb_iterate_t), intent(in) :: x
      integer, intent(in) :: j  !! Number of the joint

      y%soft = q%soft(3, j)
      y%friction = q%friction(j)
      y%opening = q%dilatancy*q%friction(j)
      y%ratio = merge(x%flow(:, j)/x%slack(:, j), 0.0_wp, q%bounded(:, j))
      y%own = 1.0_wp/(q%soft(1:2, j) + y%ratio(1:2))
      y%wide = y%opening*y%friction*sum(y%own)
      y%both = y%soft*(y%ratio(3) + y%ratio(4)) + 4.0_wp*y%ratio(3)*y%ratio(4)
      y%det = y%soft + y%ratio(3) + y%ratio(4) + y%wide*y%both
   end function yield_of

   !> Stiffness of all joints at their bounds
   pure function spring_stiffness(yield) result(stiffness)
      type(joint_yield_t), intent(in) :: yield(:)
      real(wp) :: stiffness(3, 3, size(yield))  !! Stiffness: (3, 3, n_joint)
      integer :: j, k

      do j = 1, size(yield)
         associate (y => yield(j), s => stiffness(:, :, j), r => yield(j)%ratio, &
            & cross => yield(j)%opening*yield(j)%friction*yield(j)%both)
            do k = 1, 2
               s(k, k) = y%own(k)*(y%soft + r(3) + r(4) + cross*y%own(3 - k))/y%det
               s(k, 3 - k) = -y%own(k)*y%own(3 - k)*cross/y%det
               s(3, k) = -y%friction*(r(3) - r(4))*y%own(k)/y%det
               s(k, 3) = -y%opening*(r(3) - r(4))*y%own(k)/y%det
            end do
            s(3, 3) = (1.0_wp + y%wide*(r(3) + r(4)))/y%det
         end associate
      end do
   end function spring_stiffness

   !> Forces of the joints by openings that are to be closed and by flows at constant forces, and
   !> the distances that these forces add
   pure subroutine yield_joints(yield, opening, source, force, slack)
      type(joint_yield_t), intent(in) :: yield(:)
      real(wp), intent(in) :: opening(:, :)  !! Openings and slip: (3, n_joint)
      real(wp), intent(in) :: source(:, :)   !! Flows at constant forces: (4, n_joint)
      real(wp), intent(out) :: force(:, :)   !! The forces: (3, n_joint)
      real(wp), intent(out) :: slack(:, :)   !! The distances: (4, n_joint)
      real(wp) :: close(2), other(2), press, r(2), s(2)
      integer :: j

      do j = 1, size(yield)
         r = yield(j)%ratio(3:4)
         other = r([2, 1])
         s = source(3:4, j)
         close = opening(1:2, j) + source(1:2, j)
         press = yield(j)%friction*dot_product(yield(j)%own, close)
         associate (y => yield(j), w => yield(j)%wide, slip => opening(3, j))
            ! slip at both bounds of friction opens
            force(1:2, j) = y%own*(close + y%opening*(sum((y%soft + 2.0_wp*other)*s) &
               & - (r(1) - r(2))*slip - y%both*press)/y%det)
            force(3, j) = (slip*(1.0_wp + w*sum(r)) + s(1)*(1.0_wp + 2.0_wp*w*r(2)) &
               & - s(2)*(1.0_wp + 2.0_wp*w*r(1)) - (r(1) - r(2))*press)/y%det
            slack(1:2, j) = force(1:2, j)
            slack(3:4, j) = (press*(y%soft + 2.0_wp*other) &
               & + [slip, -slip]*(1.0_wp + 2.0_wp*w*other) &
               & + s*(1.0_wp + w*(y%soft + 4.0_wp*other)) + s([2, 1])*(w*y%soft - 1.0_wp))/y%det
         end associate
      end do
   end subroutine yield_joints

   !> Mean product of distance and flow, in squares of a force
   pure real(wp) function mean_product(q, slack, flow)
      type(coulomb_problem_t), intent(in) :: q
      real(wp), intent(in) :: slack(:, :)  !! Distances: (4, n_joint)
      real(wp), intent(in) :: flow(:, :)   !! Flows: (4, n_joint)

      mean_product = (sum(slack(:3, :)*flow(:3, :)/q%unit, q%bounded(:3, :)) &
         & + sum(slack(4, :)*flow(4, :)/q%unit(3, :), q%bounded(4, :))) &
         & /real(max(1, count(q%bounded)), wp)
   end function mean_product

   !> The longest step, 1 at most, that keeps a share of every distance and flow
   pure real(wp) function longest(q, x, step, share)
      type(coulomb_problem_t), intent(in) :: q
      type(coulomb_iterate_t), intent(in) :: x, step
      real(wp), intent(in) :: share  !! Step over the distance to the first zero
      integer :: j, k

      longest = 1.0_wp
      do j = 1, size(x%slack, 2)
         do k = 1, 4
            if (.not. q%bounded(k, j)) cycle
            if (step%slack(k, j)*longest < -share*x%slack(k, j)) &
               & longest = -share*x%slack(k, j)/step%slack(k, j)
            if (step%flow(k, j)*longest < -share*x%flow(k, j)) &
               & longest = -share*x%flow(k, j)/step%flow(k, j)
         end do
      end do
   end function longest
end module dda_coulomb_interior
