!> Contact forces of blocks that move in time, joint by joint (Gauss and Seidel)
!>
!> Without springs between blocks the equations of a step are those of single blocks, A d = f + B'N,
!> and each joint sees how the blocks around it answer its forces. In a sweep each joint in turn
!> takes the forces that close its gaps and stop its slip, as far as the law of contact allows:
!>
!>    N = max(-tension, N - gap/W),   T = T - slip/W within the bounds that N makes
!>
!> That ends at the forces of Coulomb's law, bounds and all, without a factorisation. It ends soon
!> where the forces of the step before are a good beginning or blocks are few, and slowly in tall
!> stacks; these are left to the open-close loop, which goes on from there.
module dda_contact_sweeps
   use dda_assembly, only : equations_t
   use dda_friction_cone, only : cone_t, joint_face_t
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_small_cholesky, only : cholesky, solved
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : step_state_t
   implicit none
   private

   public :: sweep_contacts

   !> What the joints see of one step
   type :: view_t
      !> Motion of the two blocks by a unit of each force: (n_dof, 3, 2, n_joint) [m/(N/m)]
      real(wp), allocatable :: answer(:, :, :, :)
      !> Openings and slip of the joint by a unit of each of its forces: (3, 3, n_joint) [m/(N/m)]
      real(wp), allocatable :: give(:, :, :)
      !> Gaps before the motion: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
   end type view_t

   !> Change of a force that counts as none, over the sum of all that bear on the blocks
   real(wp), parameter :: tolerance = 1.0e-15_wp
   !> After this many sweeps another measure will do
   integer, parameter :: strictly = 64
   !> Change of an opening or slip that counts as none, over the size of the smallest block
   real(wp), parameter :: no_matter = 1.0e-9_wp
   !> Multiple of it that will do where more sweeps bring no less
   real(wp), parameter :: coarse = 1.0e2_wp
   !> The same where they bring no less without haste either
   real(wp), parameter :: coarsest = 1.0e4_wp
   !> After this many sweeps a change that falls no more ends them
   integer, parameter :: plain_sweeps = 1000
   !> Most sweeps
   integer, parameter :: max_sweeps = 4000
   !> After this many sweeps the joints without force are looked at again
   integer, parameter :: round = 8
   !> After this many sweeps the change must have fallen noticeably
   integer, parameter :: patience = 100
   !> What counts as noticeable
   real(wp), parameter :: falling = 0.8_wp

contains

   !> Settle contact forces and motion of one step, or begin to
   pure subroutine sweep_contacts(equations, springs, state)
      !> Blocks assembled
      type(equations_t), intent(in) :: equations
      !> The springs of the joints; their stiffness only measures gaps here
      type(joint_springs_t), intent(in) :: springs
      !> Multipliers and trial forces to begin with in; motion, forces and faces out, as far as they
      !> came
      type(step_state_t), intent(inout) :: state
      type(view_t) :: view
      real(wp), dimension(3, size(springs%stiffness)) :: before, force, way
      real(wp) :: change(2), enough(2), last, noise, square
      real(wp) :: motion(size(state%motion, 1), 0:size(state%motion, 2))
      logical :: active(size(springs%stiffness)), hasty
      integer :: sweep

      call see_joints(equations, springs, state, view)
      force = state%multiplier
      motion(:, 0) = 0.0_wp
      call move_blocks(equations, springs, force, motion(:, 1:))
      noise = min(1.0_wp, state%fineness)*equations%gap_noise
      enough = [tolerance*equations%force_scale, no_matter*state%fineness*smallest(equations)]
      last = huge(last)
      square = 0.0_wp
      way = 0.0_wp
      hasty = .true.
      active = .true.
      state%settled = .false.
      do sweep = 0, max_sweeps
         change = 0.0_wp
         if (modulo(sweep, round) == 0) active = .true.
         before = force
         call sweep_twice(springs, view, noise, active, force, motion, change)
         state%settled = modulo(sweep, round) == 0 .and. (change(1) <= enough(1) &
            & .or. sweep >= strictly .and. change(2) <= enough(2))
         if (state%settled) exit
         if (modulo(sweep, patience) == 0 .and. sweep > 0) then
            if (.not. change(2) < falling*last) then
               state%settled = change(2) <= merge(coarse, coarsest, hasty)*enough(2)
               if (state%settled .or. sweep >= plain_sweeps) exit
               hasty = .false.
            end if
            last = change(2)
         end if
         ! not before an end: the forces that it goes on to need not be admissible
         if (hasty) call go_on(springs, view, force - before, square, way, force, motion)
      end do
      call keep_forces(equations, springs, view, force, state)
   end subroutine sweep_contacts

   !> One sweep over the joints forwards and one backwards
   pure subroutine sweep_twice(springs, view, noise, active, force, motion, change)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the sweeps need of the joints
      type(view_t), intent(in) :: view
      !> Gap that rounding can make [m]
      real(wp), intent(in) :: noise
      !> Joints that are looked at; after it, those that carry a force: (n_joint)
      logical, intent(inout) :: active(:)
      !> Forces of the joints: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Motion of the blocks, of those that do not move first: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(:, 0:)
      !> Largest change of a force [N/m] and of a gap [m]: (2)
      real(wp), intent(inout) :: change(2)
      integer :: i, j

      do i = 1, 2*size(active)
         j = merge(i, 2*size(active) + 1 - i, i <= size(active))
         if (.not. active(j)) cycle
         if (size(motion, 1) == 3) then
            call relax(3, springs, view, j, noise, force(:, j), motion, change)
         else
            call relax(6, springs, view, j, noise, force(:, j), motion, change)
         end if
         active(j) = any(abs(force(:, j)) > 0.0_wp)
      end do
   end subroutine sweep_twice

   !> Forces and motion where the sweeps have ended, as the open-close loop knows them
   pure subroutine keep_forces(equations, springs, view, force, state)
      !> The equations
      type(equations_t), intent(in) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the sweeps need of the joints
      type(view_t), intent(in) :: view
      !> Forces of the joints: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> Receives them
      type(step_state_t), intent(inout) :: state
      integer :: j, k

      call move_blocks(equations, springs, force, state%motion)
      state%passes = state%passes + 1
      state%increment = relative_displacement(springs, state%motion)
      state%multiplier = force
      state%force = force
      do j = 1, size(force, 2)
         state%face(j) = face_of(springs%cone(j), force(:, j), springs%shift(:, j))
         do k = 1, 3
            state%start(k, j) = force(k, j) - springs%stiffness(j)*view%gap(k, j)
         end do
         state%trial(:, j) = state%start(:, j) - springs%stiffness(j)*state%increment(:, j)
      end do
   end subroutine keep_forces

   !> Radius of gyration of the smallest block [m]
   pure real(wp) function smallest(equations)
      !> The equations, for the masses
      type(equations_t), intent(in) :: equations

      smallest = sqrt(12.0_wp*minval(equations%mass(3, 3, :)/equations%mass(1, 1, :)))
   end function smallest

   !> How the blocks answer the forces of each joint
   pure subroutine see_joints(equations, springs, state, view)
      !> Blocks assembled
      type(equations_t), intent(in) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> The step, for the gaps
      type(step_state_t), intent(in) :: state
      !> The view
      type(view_t), intent(out) :: view
      real(wp) :: lower(size(state%motion, 1), size(state%motion, 1), size(state%motion, 2))
      integer :: e, j, k, side

      do e = 1, size(lower, 3)
         lower(:, :, e) = cholesky(equations%base(:, :, e))
      end do
      allocate (view%answer, mold=springs%row)
      allocate (view%give(3, 3, size(springs%stiffness)), source=0.0_wp)
      allocate (view%gap, mold=state%start)
      do j = 1, size(springs%stiffness)
         view%gap(:, j) = (state%multiplier(:, j) - state%start(:, j))/springs%stiffness(j)
         do side = 1, 2
            e = springs%equation(side, j)
            do k = 1, 3
               view%answer(:, k, side, j) = 0.0_wp
               if (e == 0) cycle
               view%answer(:, k, side, j) = solved(lower(:, :, e), springs%row(:, k, side, j))
               view%give(:, k, j) = view%give(:, k, j) &
                  & + matmul(view%answer(:, k, side, j), springs%row(:, :, side, j))
            end do
         end do
      end do
   end subroutine see_joints

   !> Motion of the blocks under given joint forces
   pure subroutine move_blocks(equations, springs, force, motion)
      !> Blocks assembled
      type(equations_t), intent(in) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Joint forces: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> The motion: (n_dof, n_equation)
      real(wp), intent(out) :: motion(:, :)
      integer :: e, j, side

      motion = equations%load
      do j = 1, size(force, 2)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e > 0) motion(:, e) = motion(:, e) &
               & + matmul(springs%row(:, :, side, j), force(:, j))
         end do
      end do
      do e = 1, size(motion, 2)
         motion(:, e) = solved(cholesky(equations%base(:, :, e)), motion(:, e))
      end do
   end subroutine move_blocks

   !> Go on in the direction of the sweeps so far, as conjugate gradients do, unless the last sweep
   !> has changed more than the one before
   pure subroutine go_on(springs, view, change, square, way, force, motion)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the joints see
      type(view_t), intent(in) :: view
      !> What the sweep has changed: (3, n_joint) [N/m]
      real(wp), intent(in) :: change(:, :)
      !> Its square; that of the sweep before in
      real(wp), intent(inout) :: square
      !> The direction: (3, n_joint) [N/m]
      real(wp), intent(inout) :: way(:, :)
      !> Joint forces: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Motion of the blocks: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(:, 0:)
      real(wp) :: ratio, last
      integer :: j

      last = square
      square = sum(change**2)
      if (.not. square < last) then
         way = change
         return
      end if
      ratio = square/last
      ! open contacts have no way to go on; fading away, theirs would become denormal
      where (.not. abs(change) > 0.0_wp) way = 0.0_wp
      do j = 1, size(change, 2)
         if (.not. any(abs(way(:, j)) > 0.0_wp)) cycle
         force(:, j) = force(:, j) + ratio*way(:, j)
         call push(size(motion, 1), springs, view, j, ratio*way(:, j), motion)
      end do
      way = ratio*way + change
   end subroutine go_on

   !> Let one joint take the forces that the law of contact asks for. Column 0 of the motion stands
   !> for all that cannot move
   pure subroutine relax(n_dof, springs, view, j, noise, force, motion, change)
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the joints see
      type(view_t), intent(in) :: view
      !> Number of the joint
      integer, intent(in) :: j
      !> Gaps that rounding makes: they ask for no force, which could grow without end [m]
      real(wp), intent(in) :: noise
      !> Its forces: (3) [N/m]
      real(wp), intent(inout) :: force(3)
      !> Motion of the blocks: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(n_dof, 0:*)
      !> Largest change so far: of a force, and of an opening or slip by it: (2) [N/m, m]
      real(wp), intent(inout) :: change(2)
      real(wp) :: before(3), gap(3), wanted
      integer :: a, b, i, k

      a = springs%equation(1, j)
      b = springs%equation(2, j)
      gap = view%gap(:, j)
      do k = 1, 3
         do i = 1, n_dof
            gap(k) = gap(k) + springs%row(i, k, 1, j)*motion(i, a) &
               & + springs%row(i, k, 2, j)*motion(i, b)
         end do
      end do
      before = force
      do k = 1, 3
         if (.not. view%give(k, k, j) > 0.0_wp) cycle
         if (k < 3) then
            wanted = sign(max(0.0_wp, abs(gap(k)) - noise), gap(k))
            wanted = max(-springs%shift(k, j), force(k) - wanted/view%give(k, k, j))
         else
            wanted = shear_bound(springs%cone(j), force + springs%shift(:, j))
            wanted = max(-wanted, min(wanted, force(k) - gap(k)/view%give(k, k, j)))
         end if
         gap = gap + (wanted - force(k))*view%give(:, k, j)
         force(k) = wanted
      end do
      do k = 1, 3
         wanted = force(k) - before(k)
         if (.not. abs(wanted) > 0.0_wp) cycle
         change(1) = max(change(1), abs(wanted))
         change(2) = max(change(2), abs(wanted)*view%give(k, k, j))
      end do
      call push(n_dof, springs, view, j, force - before, motion)
   end subroutine relax

   !> Let the two blocks of a joint answer a change of its forces
   pure subroutine push(n_dof, springs, view, j, change, motion)
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the joints see
      type(view_t), intent(in) :: view
      !> Number of the joint
      integer, intent(in) :: j
      !> The change: (3) [N/m]
      real(wp), intent(in) :: change(3)
      !> Motion of the blocks: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(n_dof, 0:*)
      integer :: a, b, i, k

      a = springs%equation(1, j)
      b = springs%equation(2, j)
      do k = 1, 3
         if (.not. abs(change(k)) > 0.0_wp) cycle
         do i = 1, n_dof
            motion(i, a) = motion(i, a) + change(k)*view%answer(i, k, 1, j)
            motion(i, b) = motion(i, b) + change(k)*view%answer(i, k, 2, j)
         end do
      end do
   end subroutine push

   !> Largest shear force that a joint carries; one that cannot slide can part
   pure real(wp) function shear_bound(cone, normal)
      !> Bounds of the force
      type(cone_t), intent(in) :: cone
      !> Normal forces beyond the tension that the contacts carry: (3), the third not used [N/m]
      real(wp), intent(in) :: normal(3)

      shear_bound = cone%limit
      if (cone%limit < huge(1.0_wp)) then
         shear_bound = cone%limit + cone%friction*(normal(1) + normal(2))
      else if (.not. (normal(1) > 0.0_wp .or. normal(2) > 0.0_wp)) then
         shear_bound = 0.0_wp
      end if
   end function shear_bound

   !> The face that a joint's force lies on
   pure type(joint_face_t) function face_of(cone, force, shift) result(face)
      !> Bounds of the force
      type(cone_t), intent(in) :: cone
      !> The force: (3) [N/m]
      real(wp), intent(in) :: force(3)
      !> Tension that the contacts carry, and a zero: (3) [N/m]
      real(wp), intent(in) :: shift(3)

      face%open = .not. force(1:2) + shift(1:2) > 0.0_wp
      if (abs(force(3)) >= shear_bound(cone, force + shift)) &
         & face%slip = merge(1, -1, force(3) > 0.0_wp)
      if (all(face%open) .and. .not. abs(force(3)) > 0.0_wp) face%slip = 0
   end function face_of
end module dda_contact_sweeps
