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
!> stacks. Blocks that no contact joins know nothing of one another: each such group is swept by
!> itself, and those that would take long go on by interior springs (`dda_contact_interior`).
!>
!> Equation (M5) of docs/method.md
module dda_contact_sweeps
   use dda_assembly, only : equations_t
   use dda_contact_groups, only : group_joints
   use dda_contact_interior, only : solve_interior
   use dda_contact_view, only : contact_view_t, move_blocks, see_joints
   use dda_friction_cone, only : cone_t, joint_face_t
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   use dda_step_state, only : step_state_t
   implicit none
   private

   public :: sweep_contacts

   !> Change of a force that counts as none, over the sum of all that bear on the blocks
   real(wp), parameter :: tolerance = 1.0e-15_wp
   !> Change of an opening or slip that counts as none, over the size of the smallest block
   real(wp), parameter :: no_matter = 1.0e-9_wp
   !> The same of a force, over the largest of its group
   real(wp), parameter :: no_force = 1.0e-7_wp
   !> Few blocks settle to rounding in so many sweeps
   integer, parameter :: strictly = 64
   !> Multiple of no_matter that will do where more sweeps bring no less
   real(wp), parameter :: coarse = 1.0e2_wp
   !> The same where they bring no less without haste either, or behind interior springs
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
   !> Groups of more joints than this may go on by interior springs
   integer, parameter :: few = 2
   !> Sweeps that cost as much as interior springs
   integer, parameter :: worth = 32

   !> What a group is swept for: to rounding, to see whether it settles soon, or to make good what
   !> interior springs leave
   integer, parameter :: to_the_end = 1, soon = 2, afterwards = 3

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
      type(contact_view_t) :: view
      real(wp) :: force(3, size(springs%stiffness)), enough(2), noise
      real(wp) :: motion(size(state%motion, 1), 0:size(state%motion, 2))
      integer :: g, n, joint(size(springs%stiffness)), first(size(springs%stiffness) + 1)
      logical :: settled(size(springs%stiffness)), left(size(springs%stiffness))

      call see_joints(equations, springs, state, view)
      call group_joints(springs, size(state%motion, 2), n, first, joint)
      force = state%multiplier
      motion(:, 0) = 0.0_wp
      call move_blocks(equations, springs, view, force, motion(:, 1:))
      noise = min(1.0_wp, state%fineness)*equations%gap_noise
      enough = [tolerance*equations%force_scale, no_matter*state%fineness*smallest(equations)]
      left = .false.
      do g = 1, n
         associate (of_group => joint(first(g):first(g + 1) - 1))
            call sweep_group(of_group, merge(soon, to_the_end, size(of_group) > few), springs, &
               & view, noise, enough, force, motion, settled(g))
            if (.not. settled(g)) left(first(g):first(g + 1) - 1) = .true.
         end associate
      end do
      state%passes = state%passes + 1
      if (any(left)) then
         call solve_interior(equations, springs, view, pack(joint, left), force, motion(:, 1:), &
            & state%passes)
         call move_blocks(equations, springs, view, force, motion(:, 1:))
         do g = 1, n
            if (.not. settled(g)) call sweep_group(joint(first(g):first(g + 1) - 1), afterwards, &
               & springs, view, noise, enough, force, motion, settled(g))
         end do
      end if
      state%settled = all(settled(:n))
      call keep_forces(equations, springs, view, force, state)
   end subroutine sweep_contacts

   !> Sweep one group until nothing changes, or until that is seen to take too long
   pure subroutine sweep_group(joint, purpose, springs, view, noise, enough, force, motion, settled)
      !> Joints of the group: (n)
      integer, intent(in) :: joint(:)
      !> What for: to_the_end, soon or afterwards
      integer, intent(in) :: purpose
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the joints see
      type(contact_view_t), intent(in) :: view
      !> Gap that rounding can make [m]
      real(wp), intent(in) :: noise
      !> Changes that count as none, of a force [N/m] and of a gap [m]: (2)
      real(wp), intent(in) :: enough(2)
      !> Forces of all joints: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Motion of the blocks, of those that do not move first: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(:, 0:)
      !> Whether it is settled
      logical, intent(out) :: settled
      real(wp) :: before(3, size(joint)), change(2), last, lately, square, wanted(2)
      real(wp) :: way(3, size(joint))
      logical :: active(size(joint)), hasty
      integer :: sweep

      last = huge(last)
      lately = huge(last)
      square = 0.0_wp
      way = 0.0_wp
      hasty = .true.
      settled = .false.
      do sweep = 0, max_sweeps
         change = 0.0_wp
         if (modulo(sweep, round) == 0) active = .true.
         before = force(:, joint)
         call sweep_twice(joint, springs, view, noise, active, force, motion, change)
         if (modulo(sweep, round) == 0) then
            wanted = [max(enough(1), no_force*maxval(abs(force(:, joint)))), enough(2)]
            if (purpose == afterwards .and. sweep > 0) wanted = coarsest*wanted
            settled = change(1) <= enough(1) .or. all(change <= wanted) &
               & .and. (purpose /= to_the_end .or. sweep >= strictly)
            if (settled) exit
            if (purpose == soon .and. sweep > 0) then
               if (takes_long(maxval(change/wanted), lately)) exit
            end if
            lately = maxval(change/wanted)
         end if
         if (modulo(sweep, patience) == 0 .and. sweep > 0) then
            if (.not. change(2) < falling*last) then
               settled = change(2) <= merge(coarse, coarsest, hasty)*enough(2)
               if (settled .or. sweep >= plain_sweeps) exit
               hasty = .false.
            end if
            last = change(2)
         end if
         ! not before an end: the forces that it goes on to need not be admissible
         if (hasty) call go_on(joint, springs, view, force(:, joint) - before, square, way, force, &
            & motion)
      end do
   end subroutine sweep_group

   !> Whether a change that falls as it did in the last round needs more sweeps than are worth it
   pure logical function takes_long(change, lately)
      !> The change over what counts as none
      real(wp), intent(in) :: change
      !> That of a round before
      real(wp), intent(in) :: lately

      takes_long = .not. change < lately
      if (.not. takes_long) takes_long = -log(change) < worth/round*log(change/lately)
   end function takes_long

   !> One sweep over the joints forwards and one backwards
   pure subroutine sweep_twice(joint, springs, view, noise, active, force, motion, change)
      !> The joints: (n)
      integer, intent(in) :: joint(:)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the sweeps need of the joints
      type(contact_view_t), intent(in) :: view
      !> Gap that rounding can make [m]
      real(wp), intent(in) :: noise
      !> Joints that are looked at; after it, those that carry a force: (n)
      logical, intent(inout) :: active(:)
      !> Forces of all joints: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Motion of the blocks, of those that do not move first: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(:, 0:)
      !> Largest change of a force [N/m] and of a gap [m]: (2)
      real(wp), intent(inout) :: change(2)
      integer :: i, j, k

      do i = 1, 2*size(joint)
         k = merge(i, 2*size(joint) + 1 - i, i <= size(joint))
         if (.not. active(k)) cycle
         j = joint(k)
         call relax(size(motion, 1), springs, view, j, noise, force(:, j), motion, change)
         active(k) = any(abs(force(:, j)) > 0.0_wp)
      end do
   end subroutine sweep_twice

   !> Forces and motion where the sweeps have ended, as the open-close loop knows them
   pure subroutine keep_forces(equations, springs, view, force, state)
      !> The equations
      type(equations_t), intent(in) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the sweeps need of the joints
      type(contact_view_t), intent(in) :: view
      !> Forces of the joints: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> Receives them
      type(step_state_t), intent(inout) :: state
      integer :: j, k

      call move_blocks(equations, springs, view, force, state%motion)
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

   !> Go on in the direction of the sweeps so far, as conjugate gradients do, unless the last sweep
   !> has changed more than the one before
   pure subroutine go_on(joint, springs, view, change, square, way, force, motion)
      !> Joints of the group: (n)
      integer, intent(in) :: joint(:)
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> What the joints see
      type(contact_view_t), intent(in) :: view
      !> What the sweep has changed: (3, n) [N/m]
      real(wp), intent(in) :: change(:, :)
      !> Its square; that of the sweep before in
      real(wp), intent(inout) :: square
      !> The direction: (3, n) [N/m]
      real(wp), intent(inout) :: way(:, :)
      !> Forces of all joints: (3, n_joint) [N/m]
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
         force(:, joint(j)) = force(:, joint(j)) + ratio*way(:, j)
         call push(size(motion, 1), springs, view, joint(j), ratio*way(:, j), motion)
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
      type(contact_view_t), intent(in) :: view
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
      ! three unknowns at a time, so that the compiler knows the length
      do i = 1, n_dof, 3
         do k = 1, 3
            gap(k) = gap(k) + springs%row(i, k, 1, j)*motion(i, a) &
               & + springs%row(i + 1, k, 1, j)*motion(i + 1, a) &
               & + springs%row(i + 2, k, 1, j)*motion(i + 2, a) &
               & + springs%row(i, k, 2, j)*motion(i, b) &
               & + springs%row(i + 1, k, 2, j)*motion(i + 1, b) &
               & + springs%row(i + 2, k, 2, j)*motion(i + 2, b)
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
      type(contact_view_t), intent(in) :: view
      !> Number of the joint
      integer, intent(in) :: j
      !> The change: (3) [N/m]
      real(wp), intent(in) :: change(3)
      !> Motion of the blocks: (n_dof, 0:n_equation)
      real(wp), intent(inout) :: motion(n_dof, 0:*)
      integer :: a, b, i, k

      a = springs%equation(1, j)
      b = springs%equation(2, j)
      do i = 1, n_dof, 3
         do k = i, i + 2
            motion(k, a) = motion(k, a) + change(1)*view%answer(k, 1, 1, j) &
               & + change(2)*view%answer(k, 2, 1, j) + change(3)*view%answer(k, 3, 1, j)
            motion(k, b) = motion(k, b) + change(1)*view%answer(k, 1, 2, j) &
               & + change(2)*view%answer(k, 2, 2, j) + change(3)*view%answer(k, 3, 2, j)
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
