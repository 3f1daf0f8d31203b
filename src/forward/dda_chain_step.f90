!> One step of a chain: the open-close loop on flat arrays
!>
!> It is the step of `advance` for blocks that start at rest, do not move and have 3 unknowns: the
!> same energy, the same peaks, the same noise. Its right-hand side holds only what is not in
!> balance at its beginning: loads and forces, which would drown that, are left out. A chain that
!> does not settle here is left to the loop for any pattern of blocks.
module dda_chain_step
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_chain, only : chain_t
   use dda_chain_factor, only : factorise_chain, substitute_chain
   use dda_chain_state, only : chain_step_t, hash
   use dda_chain_stiffness, only : add_joint, cone_of
   use dda_friction_cone, only : apply_face, is_stuck, joint_face_t, project
   use dda_kinds, only : wp
   implicit none
   private

   public :: lengthen_step, settle_chain, go_on, find_opening

   !> Most passes before a chain is left to the loop for any blocks
   integer, parameter :: max_passes = 200
   !> Joints whose disagreement is as large as that of a peak but for rounding are peaks too
   real(wp), parameter :: tie = 1.0e-9_wp
   !> Joints whose disagreement is below this share of the largest wait for their turn
   real(wp), parameter :: notable = 0.1_wp

contains

   !> Give the step a length, with the faces that it has: all diagonal blocks change
   pure subroutine lengthen_step(chain, dt, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The length [s]
      real(wp), intent(in) :: dt
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: beyond(3, 3), across(3, 3)
      integer :: j, n

      n = size(chain%mass)
      step%dt = dt
      step%stuck = is_stuck(step%face)
      beyond = 0.0_wp
      associate (diagonal => step%matrix%diagonal, coupling => step%matrix%coupling)
         call add_joint(chain, step%face(1), step%stuck(1), 1, beyond, diagonal(:, :, 1), &
            & coupling(:, :, 1))
         do j = 2, n
            call add_inertia(chain, j - 1, step)
            call add_joint(chain, step%face(j), step%stuck(j), j, diagonal(:, :, j - 1), &
               & diagonal(:, :, j), coupling(:, :, j))
         end do
         call add_inertia(chain, n, step)
         call add_joint(chain, step%face(n + 1), step%stuck(n + 1), n + 1, diagonal(:, :, n), &
            & beyond, across)
      end associate
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
      real(wp) :: beside(3, 3), across(3, 3)
      integer :: b, first, last

      first = max(1, j - 1)
      last = min(size(chain%mass), j)
      step%stuck(j) = is_stuck(step%face(j))
      associate (diagonal => step%matrix%diagonal, coupling => step%matrix%coupling)
         do b = first, last
            beside = 0.0_wp
            call add_joint(chain, step%face(b), step%stuck(b), b, beside, diagonal(:, :, b), &
               & coupling(:, :, b))
            call add_inertia(chain, b, step)
            call add_joint(chain, step%face(b + 1), step%stuck(b + 1), b + 1, diagonal(:, :, b), &
               & beside, across)
         end do
      end associate
      step%changed = [min(step%changed(1), first), max(step%changed(2), last)]
   end subroutine hold_face

   !> Motion of all blocks if every joint keeps to its face
   pure subroutine solve_motion(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: before(3), now(3)
      integer :: j, n

      n = size(chain%mass)
      if (step%changed(1) <= step%changed(2)) then
         call factorise_chain(step%matrix, step%changed(1), step%changed(2), step%factor)
         step%factorisations = step%factorisations + 1
         if (.not. step%factor%usable) return
         step%changed = [n + 1, 0]
      end if
      step%motion = step%load
      do j = 1, n + 1
         if (step%stuck(j) .and. .not. step%was_loose(j)) cycle
         before = step%start(:, j)
         if (step%was_loose(j)) before = step%held(:, j)
         now = step%start(:, j)
         if (.not. step%stuck(j)) now = held_force(chain, step%face(j), now, j)
         call push(chain, j, now - before, step%motion)
      end do
      call substitute_chain(step%factor, step%motion, step%work)
   end subroutine solve_motion

   !> Add the force of a joint to the loads of its two blocks
   pure subroutine push(chain, j, force, load)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j
      !> N1, N2, T: (3) [N/m]
      real(wp), intent(in) :: force(3)
      !> Loads and moments: (3, n)
      real(wp), intent(inout) :: load(:, :)
      real(wp) :: normal, turn, way(2)

      normal = force(1) + force(2)
      turn = chain%half(j)*(force(1) - force(2))
      way(1) = chain%tangent(2, j)*normal + chain%tangent(1, j)*force(3)
      way(2) = chain%tangent(2, j)*force(3) - chain%tangent(1, j)*normal
      if (j > 1) then
         load(1:2, j - 1) = load(1:2, j - 1) - way
         load(3, j - 1) = load(3, j - 1) &
            & - (chain%arm(1, 1, j)*normal + chain%arm(2, 1, j)*force(3) + turn)
      end if
      if (j <= size(load, 2)) then
         load(1:2, j) = load(1:2, j) + way
         load(3, j) = load(3, j) &
            & + chain%arm(1, 2, j)*normal + chain%arm(2, 2, j)*force(3) + turn
      end if
   end subroutine push

   !> Begin the next step, at rest, where a settled one has ended: its inertia is what the forces
   !> leave unbalanced
   pure subroutine go_on(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: rate
      integer :: b, j

      rate = 2.0_wp/step%dt**2
      do b = 1, size(chain%mass)
         step%load(1:2, b) = rate*chain%mass(b)*step%motion(1:2, b)
         step%load(3, b) = rate*chain%inertia(b)*step%motion(3, b)
      end do
      step%start = step%trial
      step%was_loose = .not. step%stuck
      do j = 1, size(step%face)
         if (step%was_loose(j)) &
            & step%held(:, j) = held_force(chain, step%face(j), step%start(:, j), j)
      end do
   end subroutine go_on

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

   !> Opening and slip of a joint by the motions of its blocks
   pure subroutine find_opening(chain, j, before, behind, normal, turn, slip)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j
      !> Motion of the block before it: (3) [m, m, 1]
      real(wp), intent(in) :: before(3)
      !> Motion of the block behind it: (3) [m, m, 1]
      real(wp), intent(in) :: behind(3)
      !> Opening at its middle [m]
      real(wp), intent(out) :: normal
      !> How much more it is at the first corner, and less at the second [m]
      real(wp), intent(out) :: turn
      !> Slip [m]
      real(wp), intent(out) :: slip

      normal = chain%tangent(2, j)*(behind(1) - before(1)) &
         & - chain%tangent(1, j)*(behind(2) - before(2)) &
         & + chain%arm(1, 2, j)*behind(3) - chain%arm(1, 1, j)*before(3)
      turn = chain%half(j)*(behind(3) - before(3))
      slip = chain%tangent(1, j)*(behind(1) - before(1)) &
         & + chain%tangent(2, j)*(behind(2) - before(2)) &
         & + chain%arm(2, 2, j)*behind(3) - chain%arm(2, 1, j)*before(3)
   end subroutine find_opening

   !> Trial and admissible forces of all joints after a motion, and how far the forces of their
   !> faces are from these, beyond rounding
   pure subroutine judge_joints(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: before(3), behind(3), normal, slip, turn, n1, n2, t, p, farthest
      integer :: j, n

      n = size(chain%mass)
      before = 0.0_wp
      farthest = 0.0_wp
      step%highest = 0.0_wp
      do j = 1, n + 1
         behind = 0.0_wp
         if (j <= n) behind = step%motion(:, j)
         farthest = max(farthest, abs(behind(1)), abs(behind(2)))
         call find_opening(chain, j, before, behind, normal, turn, slip)
         before = behind
         ! one by one: a processor waits for numbers stored apart and fetched together
         p = chain%stiffness(j)
         n1 = step%start(1, j) - p*(normal + turn)
         n2 = step%start(2, j) - p*(normal - turn)
         t = step%start(3, j) - p*slip
         step%trial(1, j) = n1
         step%trial(2, j) = n2
         step%trial(3, j) = t
         if (step%stuck(j) .and. n1 >= 0.0_wp .and. n2 >= 0.0_wp &
            & .and. abs(t) <= chain%limit(j) + chain%friction(j)*(n1 + n2)) then
            step%force(1, j) = n1
            step%force(2, j) = n2
            step%force(3, j) = t
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

   !> Add its inertia to a block's diagonal block
   pure subroutine add_inertia(chain, b, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the block
      integer, intent(in) :: b
      !> The step
      type(chain_step_t), intent(inout) :: step
      real(wp) :: rate

      rate = 2.0_wp/step%dt**2
      associate (diagonal => step%matrix%diagonal(:, :, b))
         diagonal(1, 1) = diagonal(1, 1) + rate*chain%mass(b)
         diagonal(2, 2) = diagonal(2, 2) + rate*chain%mass(b)
         diagonal(3, 3) = diagonal(3, 3) + rate*chain%inertia(b)
      end associate
   end subroutine add_inertia
end module dda_chain_step
