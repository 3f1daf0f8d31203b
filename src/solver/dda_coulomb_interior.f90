!> Coulomb's law by an interior-point method: forces and motion under a sudden load
!>
!>    A f + load = damping*mass*v,   C f + gap + A'v = F_flow' z,   s = F f >= 0, z >= 0, s z = 0
!>
!> The rows of F are N1, N2, friction*(N1 + N2) + T and friction*(N1 + N2) - T; those of F_flow are
!> N1, N2, T and -T, for joints that slide do not open. With d = z/s the spring of a joint is the
!> inverse of
!>
!>    K = C + F_flow' d F, a lower triangle: the normal springs know nothing of friction
!>
!> so that an iteration is one assembly and one factorisation, with a predictor and a corrector
!> (Mehrotra 1992) and one length of step for all.
module dda_coulomb_interior
   use dda_block_factor, only : substitute
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, shear_role
   use dda_coulomb_law, only : imbalance
   use dda_coulomb_matrix, only : add_stiffness, begin_matrix, coulomb_matrix_t, factor_matrix
   use dda_joint_graph, only : joint_motion, open_joints, push_blocks
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: coulomb_interior_t, interior_motion, enough, sharp

   !> Accepted and best residual of equations and work
   real(wp), parameter :: enough = 1.0e-6_wp, sharp = 1.0e-10_wp

   !> An iterate, or a step from it
   type :: coulomb_interior_t
      real(wp), allocatable :: motion(:, :)  !! Motion: (3, n_block)
      real(wp), allocatable :: force(:, :)   !! N1, N2, T: (3, n_joint)
      real(wp), allocatable :: slack(:, :)   !! Distance of the forces from each face: (4, n_joint)
      real(wp), allocatable :: flow(:, :)    !! Opening or slip at each face: (4, n_joint)
   end type coulomb_interior_t

   !> What an iterate leaves of the equations
   type :: rest_t
      real(wp), allocatable :: balance(:, :)  !! Of the balance of the blocks: (3, n_block)
      real(wp), allocatable :: opening(:, :)  !! Of the opening of the joints: (3, n_joint)
      real(wp) :: slack = 0.0_wp              !! The most of the slacks
   end type rest_t

contains

   !> Motion under a load from rest without forces; false in settled if it was not found
   pure subroutine interior_motion(joints, matrix, load, damping, tolerance, x, settled)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_matrix_t), intent(inout) :: matrix
      !> The load: (3, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> Enough, sharp or between: the faces of joints that carry next to nothing depend on it
      real(wp), intent(in) :: tolerance
      !> The iterate; one that is there goes on
      type(coulomb_interior_t), intent(inout) :: x
      !> Whether it was found
      logical, intent(out) :: settled
      integer, parameter :: max_iteration = 150, patience = 15, few = 3
      real(wp), parameter :: shortfall = 0.995_wp, nothing = 1.0e-30_wp
      type(coulomb_interior_t) :: step
      type(rest_t) :: rest
      real(wp) :: best, gap, length, mean, merit
      integer :: i, n_face, waited
      logical(small) :: face(4, size(joints%shear_role))

      call list_faces(joints, face)
      n_face = count(face)
      if (.not. allocated(x%motion)) call begin(joints, load, face, x)
      step = x
      best = huge(1.0_wp)
      waited = 0
      do i = 1, max_iteration
         call find_rest(joints, load, damping, face, x, rest)
         mean = sum(x%slack*x%flow, face)/real(max(1, n_face), wp)
         gap = mean*real(n_face, wp)/max(abs(sum(load*x%motion)), nothing)
         merit = max(gap, max(maxval(abs(rest%balance)), rest%slack)/maxval(abs(load)), &
            & maxval(abs(rest%opening))/max(maxval(abs(x%motion)), nothing))
         waited = merge(0, waited + 1, merit < 0.9_wp*best)
         best = min(best, merit)
         if (merit < tolerance .or. waited >= merge(few, patience, best < enough) &
            & .or. .not. merit <= huge(1.0_wp)) exit
         call factor_springs(joints, matrix, damping, face, x)
         if (.not. matrix%factor%usable) exit
         step%flow = -x%slack*x%flow
         call find_step(joints, matrix, damping, face, x, rest, step)
         length = longest(face, x, step, 1.0_wp)
         step%flow = -x%slack*x%flow - step%slack*step%flow + mean*min(1.0_wp, &
            & (sum((x%slack + length*step%slack)*(x%flow + length*step%flow), face) &
            & /(real(max(1, n_face), wp)*max(mean, tiny(mean))))**3)
         call find_step(joints, matrix, damping, face, x, rest, step)
         length = longest(face, x, step, min(max(shortfall, 1.0_wp - gap), 1.0_wp - 1.0e-6_wp))
         x%motion = x%motion + length*step%motion
         x%force = x%force + length*step%force
         x%slack = x%slack + length*step%slack
         x%flow = x%flow + length*step%flow
      end do
      settled = merit < enough
   end subroutine interior_motion

   !> Which faces the forces of each joint have
   pure subroutine list_faces(joints, face)
      type(coulomb_joints_t), intent(in) :: joints
      logical(small), intent(out) :: face(:, :)  !! Whether there is a face: (4, n_joint)

      face(:2, :) = joints%end_role == end_role%contact
      face(3, :) = joints%shear_role == shear_role%frictional
      face(4, :) = face(3, :)
   end subroutine list_faces

   !> An iterate in the middle of the cones
   pure subroutine begin(joints, load, face, x)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: load(:, :)
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(out) :: x
      real(wp) :: push
      integer :: j, n_joint

      n_joint = size(face, 2)
      push = max(1.0_wp, sqrt(sum(abs(load))))
      allocate (x%motion(size(load, 1), size(load, 2)), source=0.0_wp)
      allocate (x%force(3, n_joint), source=0.0_wp)
      allocate (x%slack(4, n_joint), x%flow(4, n_joint), source=1.0_wp)
      where (face(:2, :)) x%force(:2, :) = push
      do j = 1, n_joint
         x%slack(:, j) = slack_of(joints, x%force(:, j), j)
      end do
      where (face)
         x%slack = max(x%slack, 1.0e-3_wp*push)
      elsewhere
         x%slack = 1.0_wp
         x%flow = 0.0_wp
      end where
   end subroutine begin

   !> Distance of the forces of a joint from its faces
   pure function slack_of(joints, force, j) result(slack)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: force(3)  !! N1, N2, T
      integer, intent(in) :: j          !! Number of the joint
      real(wp) :: slack(4), bound

      bound = joints%graph%friction(j)*(force(1) + force(2))
      slack = [force(:2), bound + force(3), bound - force(3)]
   end function slack_of

   !> What an iterate leaves of the equations
   pure subroutine find_rest(joints, load, damping, face, x, rest)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: load(:, :), damping
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x
      type(rest_t), intent(inout) :: rest
      integer :: j, n_joint

      n_joint = size(face, 2)
      if (.not. allocated(rest%balance)) &
         & allocate (rest%balance(size(load, 1), size(load, 2)), rest%opening(3, n_joint))
      call imbalance(joints, load - damping*joints%graph%mass*x%motion, x%force, rest%balance)
      call joint_motion(joints%graph, x%motion, rest%opening)
      do j = 1, n_joint
         rest%opening(:, j) = -rest%opening(:, j) - joints%graph%compliance(j)*x%force(:, j)
      end do
      if (allocated(joints%graph%gap)) &
         & rest%opening(:2, :) = rest%opening(:2, :) - joints%graph%gap
      rest%opening(:2, :) = rest%opening(:2, :) + x%flow(:2, :)
      rest%opening(3, :) = rest%opening(3, :) + x%flow(3, :) - x%flow(4, :)
      where (joints%end_role == end_role%absent) rest%opening(:2, :) = 0.0_wp
      where (joints%shear_role == shear_role%absent) rest%opening(3, :) = 0.0_wp
      rest%slack = 0.0_wp
      do j = 1, n_joint
         rest%slack = max(rest%slack, maxval(abs(lack_of(joints, face, x, j))))
      end do
   end subroutine find_rest

   !> What an iterate leaves of the slacks of a joint
   pure function lack_of(joints, face, x, j) result(lack)
      type(coulomb_joints_t), intent(in) :: joints
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: lack(4)       !! Distance of its forces from each face less the slack: (4)

      lack = merge(slack_of(joints, x%force(:, j), j) - x%slack(:, j), 0.0_wp, face(:, j))
   end function lack_of

   !> Assemble the springs of an iterate and factor their equations
   pure subroutine factor_springs(joints, matrix, damping, face, x)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_matrix_t), intent(inout) :: matrix
      real(wp), intent(in) :: damping
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x
      real(wp) :: ratio(4), spring(3, 3)
      integer :: i, j

      call begin_matrix(matrix, joints, damping)
      do j = 1, size(face, 2)
         spring = 0.0_wp
         ratio = ratio_of(x, face, j)
         do i = 1, 2
            if (joints%end_role(i, j) == end_role%absent) cycle
            spring(i, i) = 1.0_wp/(joints%graph%compliance(j) + ratio(i))
         end do
         if (joints%shear_role(j) /= shear_role%absent) then
            spring(3, 3) = 1.0_wp/(joints%graph%compliance(j) + ratio(3) + ratio(4))
            do i = 1, 2
               spring(3, i) = -joints%graph%friction(j)*(ratio(3) - ratio(4))*spring(i, i) &
                  & *spring(3, 3)
            end do
         end if
         call add_stiffness(matrix, joints, j, spring)
      end do
      call factor_matrix(matrix)
   end subroutine factor_springs

   !> The step that brings what is left to nothing, corrected until forces balance
   pure subroutine find_step(joints, matrix, damping, face, x, rest, step)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_matrix_t), intent(in) :: matrix
      real(wp), intent(in) :: damping
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x
      type(rest_t), intent(in) :: rest
      !> The step; its flow is what it is to change of the products of slack and flow before
      type(coulomb_interior_t), intent(inout) :: step
      integer, parameter :: max_correction = 3
      real(wp), parameter :: rounding = 1.0e-15_wp
      real(wp) :: drive(3), force(3), last, more(4), motion(3, size(step%motion, 2)), opening(3)
      integer :: j, turn

      step%motion = 0.0_wp
      step%force = 0.0_wp
      motion = rest%balance
      do j = 1, size(face, 2)
         step%slack(:, j) = lack_of(joints, face, x, j)
         call answer_joint(joints, face, x, j, drive_of(face, x, rest, step, j), force, more)
         call push_blocks(1, joints%graph%block(:, j), joints%graph%row(:, :, :, j), force, motion)
      end do
      last = huge(1.0_wp)
      do turn = 0, max_correction
         call substitute(matrix%factor, motion)
         step%motion = step%motion + motion
         do j = 1, size(face, 2)
            drive = 0.0_wp
            if (turn == 0) drive = drive_of(face, x, rest, step, j)
            call open_joints(1, joints%graph%block(:, j), joints%graph%row(:, :, :, j), motion, &
               & opening)
            call answer_joint(joints, face, x, j, drive - opening, force, more)
            step%force(:, j) = step%force(:, j) + force
            step%slack(:, j) = step%slack(:, j) + more
         end do
         call imbalance(joints, rest%balance - damping*joints%graph%mass*step%motion, step%force, &
            & motion)
         if (.not. maxval(abs(motion)) < 0.5_wp*last .or. maxval(abs(motion)) < rounding) exit
         last = maxval(abs(motion))
      end do
      step%flow = merge((step%flow - x%flow*step%slack)/x%slack, 0.0_wp, face)
   end subroutine find_step

   !> What the springs of a joint are pressed together by, while the step has the slacks that lack
   pure function drive_of(face, x, rest, step, j) result(drive)
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x, step
      type(rest_t), intent(in) :: rest
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: drive(3)
      real(wp) :: source(4)

      source = merge(step%flow(:, j)/x%slack(:, j) - ratio_of(x, face, j)*step%slack(:, j), &
         & 0.0_wp, face(:, j))
      drive = rest%opening(:, j) + source(:3)
      drive(3) = drive(3) - source(4)
   end function drive_of

   !> Forces of the springs of a joint under a drive, and what they add to its slacks, as sums that
   !> cancel nothing
   pure subroutine answer_joint(joints, face, x, j, drive, force, more)
      type(coulomb_joints_t), intent(in) :: joints
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x
      integer, intent(in) :: j          !! Number of the joint
      real(wp), intent(in) :: drive(3)  !! What the springs are pressed together by
      real(wp), intent(out) :: force(3)  !! N1, N2, T
      real(wp), intent(out) :: more(4)   !! What is added to the slacks
      real(wp) :: bound, r(4), spring
      integer :: i

      r = ratio_of(x, face, j)
      more = 0.0_wp
      force = 0.0_wp
      associate (c => joints%graph%compliance(j))
         do i = 1, 2
            if (joints%end_role(i, j) /= end_role%absent) force(i) = drive(i)/(c + r(i))
         end do
         more(:2) = merge(force(:2), 0.0_wp, face(:2, j))
         if (joints%shear_role(j) == shear_role%absent) return
         spring = 1.0_wp/(c + r(3) + r(4))
         bound = joints%graph%friction(j)*(force(1) + force(2))
         force(3) = (drive(3) - (r(3) - r(4))*bound)*spring
         if (.not. face(3, j)) return
         more(3) = (bound*(c + 2.0_wp*r(4)) + drive(3))*spring
         more(4) = (bound*(c + 2.0_wp*r(3)) - drive(3))*spring
      end associate
   end subroutine answer_joint

   !> Flow over slack at the faces of a joint
   pure function ratio_of(x, face, j) result(ratio)
      type(coulomb_interior_t), intent(in) :: x
      logical(small), intent(in) :: face(:, :)
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: ratio(4)      !! None where there is no face: (4)

      ratio = merge(x%flow(:, j)/x%slack(:, j), 0.0_wp, face(:, j))
   end function ratio_of

   !> The longest step, 1 at most, that keeps a share of every slack and flow
   pure real(wp) function longest(face, x, step, share)
      logical(small), intent(in) :: face(:, :)
      type(coulomb_interior_t), intent(in) :: x, step
      real(wp), intent(in) :: share  !! How much of the way to the first zero is gone
      integer :: i, j

      longest = 1.0_wp
      do j = 1, size(face, 2)
         do i = 1, 4
            if (.not. face(i, j)) cycle
            if (step%slack(i, j) < 0.0_wp) &
               & longest = min(longest, -share*x%slack(i, j)/step%slack(i, j))
            if (step%flow(i, j) < 0.0_wp) &
               & longest = min(longest, -share*x%flow(i, j)/step%flow(i, j))
         end do
      end do
   end function longest
end module dda_coulomb_interior
