!> One step of a chain: the open-close loop on flat arrays
!>
!> It is the step of `advance` for blocks that start at rest, do not move and have 3 unknowns: the
!> same energy, the same peaks, the same noise. A chain that does not settle here is left to the
!> loop for any pattern of blocks.
module dda_chain_step
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_chain, only : chain_t
   use dda_chain_factor, only : chain_factor_t, chain_matrix_t, factorise_chain, &
      & new_chain_factor, substitute_chain
   use dda_chain_stiffness, only : cone_of, joint_stiffness, joint_stiffness_t
   use dda_friction_cone, only : apply_face, is_stuck, joint_face_t, project
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_step_t, new_chain_step, lengthen_step, settle_chain

   !> Motion of the blocks, joints, and equations of a step
   type :: chain_step_t
      !> Length of the step [s]
      real(wp) :: dt = 0.0_wp
      !> Motion of the blocks: (3, n)
      real(wp), allocatable :: motion(:, :)
      !> Opening at the two corners and slip of each joint: (3, n + 1) [m]
      real(wp), allocatable :: increment(:, :)
      !> Trial forces at the beginning of the step: (3, n + 1) [N/m]
      real(wp), allocatable :: start(:, :)
      !> Trial forces at its end: (3, n + 1) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Admissible forces at its end: (3, n + 1) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Squares of the admissible forces at its beginning: (n + 1)
      real(wp), allocatable :: stored(:)
      !> Faces that the equations hold: (n + 1)
      type(joint_face_t), allocatable :: face(:)
      !> Which of them are the inside of the cone: (n + 1)
      logical, allocatable :: stuck(:)
      !> Faces that the forces ask for: (n + 1)
      type(joint_face_t), allocatable :: wanted(:)
      !> How far the force of a face is from the admissible one; a joint at either end has no
      !> neighbour there: (0:n + 2) [N/m]
      real(wp), allocatable :: gap(:)
      !> The largest of these [N/m]
      real(wp) :: highest = 0.0_wp
      !> Force that rounding alone can make: of all loads [N/m]
      real(wp) :: load_noise = 0.0_wp
      !> Force that rounding can make over the largest motion [N/m2]
      real(wp) :: spring_noise = 0.0_wp
      !> Matrix of the faces
      type(chain_matrix_t) :: matrix
      !> Its factor
      type(chain_factor_t) :: factor
      !> Blocks that have changed since the factor was made: first and last, none if first > last
      integer :: changed(2) = 0
      !> Passes of the open-close loop
      integer :: passes = 0
      !> Factorisations, whole or in part
      integer :: factorisations = 0
      !> Whether every joint's force agrees with its face
      logical :: settled = .false.
   end type chain_step_t

   !> Most passes before a chain is left to the loop for any blocks
   integer, parameter :: max_passes = 200
   !> Joints whose disagreement is as large as that of a peak but for rounding are peaks too
   real(wp), parameter :: tie = 1.0e-9_wp
   !> Joints whose disagreement is below this share of the largest wait for their turn
   real(wp), parameter :: notable = 0.1_wp

contains

   !> Room for a step, without length, faces and forces
   pure subroutine new_chain_step(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(out) :: step
      integer :: n

      n = size(chain%mass)
      allocate (step%motion(3, n), step%increment(3, n + 1), step%trial(3, n + 1))
      allocate (step%start(3, n + 1), step%force(3, n + 1), step%stored(n + 1))
      allocate (step%face(n + 1), step%wanted(n + 1), step%stuck(n + 1))
      allocate (step%gap(0:n + 2), source=0.0_wp)
      step%load_noise = 1.0e-13_wp*chain%whole_load
      step%spring_noise = 8.0_wp*epsilon(1.0_wp)*chain%stiffest
      call new_chain_factor(n, step%matrix, step%factor)
   end subroutine new_chain_step

   !> Give the step a length, with the faces that it has: all diagonal blocks change
   pure subroutine lengthen_step(chain, dt, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The length [s]
      real(wp), intent(in) :: dt
      !> The step
      type(chain_step_t), intent(inout) :: step
      type(joint_stiffness_t) :: part
      integer :: j, n

      n = size(chain%mass)
      step%dt = dt
      step%stuck = is_stuck(step%face)
      do j = 1, n + 1
         part = joint_stiffness(chain, step%face(j), step%stuck(j), j)
         if (j > 1) call end_block(part, j - 1, step)
         if (j <= n) call begin_block(chain, part, j, step)
      end do
      step%changed = [1, n]
   end subroutine lengthen_step

   !> Find motion and faces of the step from the faces that it has
   pure subroutine settle_chain(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step, with the trial forces at its beginning
      type(chain_step_t), intent(inout) :: step
      integer(int64) :: seen(max_passes)
      integer :: pass, since
      logical :: peaks

      peaks = .true.
      since = 1
      step%settled = .false.
      do pass = 1, max_passes
         seen(pass) = hash(step)
         if (any(seen(since:pass - 1) == seen(pass))) then
            if (.not. peaks) return
            peaks = .false.
            since = pass
         end if
         call solve_motion(chain, step)
         step%passes = step%passes + 1
         if (.not. step%factor%usable) return
         call judge_joints(chain, step)
         if (step%settled) return
         call change_faces(chain, peaks, step)
      end do
   end subroutine settle_chain

   !> Change the faces of the joints that disagree more than their neighbours, or of the worst alone
   pure subroutine change_faces(chain, peaks, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Whether all peaks change
      logical, intent(in) :: peaks
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: threshold
      integer :: j

      threshold = merge(notable, 1.0_wp - tie, peaks)*step%highest
      do j = 1, size(step%face)
         if (step%gap(j) < threshold) cycle
         if (step%gap(j) < (1.0_wp - tie)*max(step%gap(j - 1), step%gap(j + 1))) cycle
         step%face(j) = step%wanted(j)
         call hold_face(chain, j, step)
      end do
   end subroutine change_faces

   !> Bring the matrix up to date with the face of one joint
   pure subroutine hold_face(chain, j, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j
      !> The step
      type(chain_step_t), intent(inout) :: step
      integer :: b, first, last

      first = max(1, j - 1)
      last = min(size(chain%mass), j)
      step%stuck(j) = is_stuck(step%face(j))
      do b = first, last
         call begin_block(chain, joint_stiffness(chain, step%face(b), step%stuck(b), b), b, step)
         call end_block(joint_stiffness(chain, step%face(b + 1), step%stuck(b + 1), b + 1), b, step)
      end do
      step%changed = [min(step%changed(1), first), max(step%changed(2), last)]
   end subroutine hold_face

   !> Motion of all blocks if every joint keeps to its face
   pure subroutine solve_motion(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: held(3), normal, turn, way(2)
      integer :: j, n

      n = size(chain%mass)
      if (step%changed(1) <= step%changed(2)) then
         call factorise_chain(step%matrix, step%changed(1), step%changed(2), step%factor)
         step%factorisations = step%factorisations + 1
         if (.not. step%factor%usable) return
         step%changed = [n + 1, 0]
      end if
      do j = 1, n + 1
         held = step%start(:, j)
         if (.not. step%stuck(j)) held = held_force(chain, step%face(j), held, j)
         normal = held(1) + held(2)
         turn = chain%half(j)*(held(1) - held(2))
         way(1) = chain%tangent(2, j)*normal + chain%tangent(1, j)*held(3)
         way(2) = chain%tangent(2, j)*held(3) - chain%tangent(1, j)*normal
         if (j > 1) then
            step%motion(1:2, j - 1) = step%motion(1:2, j - 1) - way
            step%motion(3, j - 1) = step%motion(3, j - 1) &
               & - (chain%arm(1, 1, j)*normal + chain%arm(2, 1, j)*held(3) + turn)
         end if
         if (j > n) exit
         step%motion(1:2, j) = chain%weight(:, j) + way
         step%motion(3, j) = chain%arm(1, 2, j)*normal + chain%arm(2, 2, j)*held(3) + turn
      end do
      call substitute_chain(step%factor, step%motion)
   end subroutine solve_motion

   !> Force that a face makes of a trial force
   pure function held_force(chain, face, trial, j) result(held)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The face
      type(joint_face_t), intent(in) :: face
      !> The trial force
      real(wp), intent(in) :: trial(3)
      !> Number of the joint
      integer, intent(in) :: j
      !> The force
      real(wp) :: held(3)
      real(wp) :: tangent(3, 3), constant(3)

      call apply_face(cone_of(chain, j), face, tangent, constant)
      held = matmul(tangent, trial) + constant
   end function held_force

   !> Openings, trial and admissible forces of all joints after a motion, and how far the forces of
   !> their faces are from these, beyond rounding
   pure subroutine judge_joints(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: before(3), after(3), trial(3), normal, slip, turn, farthest
      integer :: j, n

      n = size(chain%mass)
      before = 0.0_wp
      farthest = 0.0_wp
      step%highest = 0.0_wp
      do j = 1, n + 1
         after = 0.0_wp
         if (j <= n) after = step%motion(:, j)
         farthest = max(farthest, abs(after(1)), abs(after(2)))
         normal = chain%tangent(2, j)*(after(1) - before(1)) &
            & - chain%tangent(1, j)*(after(2) - before(2)) &
            & + chain%arm(1, 2, j)*after(3) - chain%arm(1, 1, j)*before(3)
         slip = chain%tangent(1, j)*(after(1) - before(1)) &
            & + chain%tangent(2, j)*(after(2) - before(2)) &
            & + chain%arm(2, 2, j)*after(3) - chain%arm(2, 1, j)*before(3)
         turn = chain%half(j)*(after(3) - before(3))
         before = after
         after(1) = normal + turn
         after(2) = normal - turn
         after(3) = slip
         trial = step%start(:, j) - chain%stiffness(j)*after
         step%increment(:, j) = after
         step%trial(:, j) = trial
         if (step%stuck(j) .and. trial(1) >= 0.0_wp .and. trial(2) >= 0.0_wp &
            & .and. abs(trial(3)) <= chain%limit(j) + chain%friction(j)*(trial(1) + trial(2))) then
            step%force(:, j) = trial
            step%gap(j) = 0.0_wp
         else
            call judge_joint(chain, j, step)
            step%highest = max(step%highest, step%gap(j))
         end if
      end do
      step%settled = step%highest <= step%load_noise + step%spring_noise*farthest
   end subroutine judge_joints

   !> Admissible force of one joint
   pure subroutine judge_joint(chain, j, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j
      !> The step
      type(chain_step_t), intent(inout) :: step

      call project(cone_of(chain, j), step%trial(:, j), step%force(:, j), step%wanted(j))
      step%gap(j) = max(0.0_wp, norm2(held_force(chain, step%face(j), step%trial(:, j), j) &
         & - step%force(:, j)) - 16.0_wp*epsilon(1.0_wp)*maxval(abs(step%trial(:, j))))
   end subroutine judge_joint

   !> Diagonal block of inertia and the springs of the joint before it, and coupling across this one
   pure subroutine begin_block(chain, part, b, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> What the joint before the block adds
      type(joint_stiffness_t), intent(in) :: part
      !> Number of the block
      integer, intent(in) :: b
      !> The step; its matrix is made
      type(chain_step_t), intent(inout) :: step
      real(wp) :: rate

      rate = 2.0_wp/step%dt**2
      associate (diagonal => step%matrix%diagonal(:, :, b))
         diagonal = part%behind
         diagonal(1, 1) = diagonal(1, 1) + rate*chain%mass(b)
         diagonal(2, 2) = diagonal(2, 2) + rate*chain%mass(b)
         diagonal(3, 3) = diagonal(3, 3) + rate*chain%inertia(b)
      end associate
      if (b > 1) step%matrix%coupling(:, :, b) = part%coupling
   end subroutine begin_block

   !> Add the springs of the joint behind it to a block's diagonal block
   pure subroutine end_block(part, b, step)
      !> What this joint adds
      type(joint_stiffness_t), intent(in) :: part
      !> Number of the block
      integer, intent(in) :: b
      !> The step; its matrix is made
      type(chain_step_t), intent(inout) :: step

      step%matrix%diagonal(:, :, b) = step%matrix%diagonal(:, :, b) + part%before
   end subroutine end_block

   !> A number that tells sets of faces apart
   pure function hash(step) result(number)
      !> The step
      type(chain_step_t), intent(in) :: step
      !> The number
      integer(int64) :: number
      integer(int64) :: code
      integer :: j

      number = 0_int64
      do j = 1, size(step%face)
         if (step%stuck(j)) cycle
         associate (face => step%face(j))
            code = 12_int64*j + face%slip + 1
            if (face%open(1)) code = code + 3
            if (face%open(2)) code = code + 6
         end associate
         code = ieor(code, ishft(code, 21))
         code = ieor(code, ishft(code, -35))
         code = ieor(code, ishft(code, 4))
         code = ieor(code, ishft(code, 41))
         number = ieor(ishft(number, 7) + ishft(number, -57), code)
      end do
   end function hash
end module dda_chain_step
