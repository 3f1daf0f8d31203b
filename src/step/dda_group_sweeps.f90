!> Sweeps over the joints of one group of blocks (Gauss and Seidel): each joint in turn takes the
!> forces that close its gaps and stop its slip, as far as the law of contact allows
!>
!> Equation (M5) of docs/method.md
submodule (dda_multipliers:dda_contact_sweeps) dda_group_sweeps
   implicit none

   !> Few blocks settle to rounding in so many sweeps
   integer, parameter :: strictly = 64
   !> Change of a force that counts as none, over the largest of its group: of few joints, lest what
   !> rests creeps and gains energy, and of many
   real(wp), parameter :: no_force = 1.0e-9_wp, no_force_of_many = 1.0e-7_wp
   !> Multiple of a change that counts as none that will do where sweeps in haste bring no less
   real(wp), parameter :: coarse = 1.0e2_wp

   !> After this many sweeps the change must have fallen noticeably
   integer, parameter :: patience = 100

   !> After this many sweeps a change that falls no more ends them
   integer, parameter :: plain_sweeps = 1000
   !> Most sweeps
   integer, parameter :: max_sweeps = 4000
   !> After this many sweeps the joints without force are looked at again
   integer, parameter :: round = 8
   !> After so many of these rounds it is seen how soon many joints will settle
   integer, parameter :: first_rounds = 2
   !> Multiple of a change that counts as none which may be left where a longer step has failed
   real(wp), parameter :: in_the_end = 1.0e5_wp

   !> What counts as noticeable
   real(wp), parameter :: falling = 0.8_wp
   !> Sweeps that cost as much as interior springs of few joints, and of many
   integer, parameter :: worth = 32, worth_many = 96
   !> Joints swept, again and again, before what is left is no more to be swept
   integer, parameter :: most_work = 400000
   !> The same where a longer step has failed
   integer, parameter :: patient_work = 4000000
   !> Multiple of what no step notices that may be left then
   real(wp), parameter :: last_resort = 3.0e1_wp

contains

   !> Sweep one group until nothing changes, or until that is seen to take too long
   module procedure sweep_group
      real(wp) :: before(3, size(joint)), change(2), last, lately, square, way(3, size(joint))
      logical :: active(size(joint)), ended, hasty
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
         before = sweeps%force(:, joint)
         call sweep_twice(springs, joint, active, sweeps, change)
         if (modulo(sweep, round) == 0) then
            call judge(purpose, size(joint), sweep, maxval(abs(sweeps%force(:, joint))), enough, &
               & change, lately, settled, ended)
            if (ended) exit
         end if
         if (modulo(sweep, patience) == 0 .and. sweep > 0) then
            call see_progress(sweep, change(2)/enough(2), last, hasty, settled, ended)
            if (ended) exit
         end if
         ! not before an end: the forces that it goes on to need not be admissible
         if (hasty) &
            & call go_on(springs, joint, sweeps%force(:, joint) - before, square, way, sweeps)
      end do
   end procedure sweep_group

   !> Whether sweeps go on where gaps no longer change less: without haste, or no more
   pure subroutine see_progress(sweep, change, last, hasty, settled, ended)
      !> Sweeps so far
      integer, intent(in) :: sweep
      !> Change of the gaps over what counts as none
      real(wp), intent(in) :: change
      !> The same when this was seen last; now out
      real(wp), intent(inout) :: last
      !> Whether the direction of the sweeps is followed
      logical, intent(inout) :: hasty
      !> Whether the group is settled, and whether it is swept no more
      logical, intent(out) :: settled, ended

      settled = .false.
      if (.not. change < falling*last) then
         settled = change <= merge(coarse, coarsest, hasty)
         hasty = .false.
      end if
      ended = settled .or. .not. hasty .and. sweep >= plain_sweeps .and. .not. change < falling*last
      last = change
   end subroutine see_progress

   !> Whether a group is settled after some sweeps, or what is left is no more to be swept
   pure subroutine judge(purpose, n, sweep, largest, enough, change, lately, settled, ended)
      !> What the group is swept for
      integer, intent(in) :: purpose
      !> Joints of the group
      integer, intent(in) :: n
      !> Sweeps so far
      integer, intent(in) :: sweep
      !> Largest force of the group [N/m]
      real(wp), intent(in) :: largest
      real(wp), intent(in) :: enough(2)
      !> Changes of the last sweep, likewise: (2)
      real(wp), intent(in) :: change(2)
      !> Change over what counts as none, a round before in and now out
      real(wp), intent(inout) :: lately
      !> Whether the group is settled
      logical, intent(out) :: settled
      !> Whether it is swept no more
      logical, intent(out) :: ended
      real(wp) :: wanted(2)

      wanted = [max(enough(1), merge(no_force, no_force_of_many, n <= many)*largest), enough(2)]
      if (purpose >= sweeps_for%patience .and. sweep > 0) &
         & wanted = merge(in_the_end, coarsest, purpose == sweeps_for%the_end)*wanted
      settled = change(1) <= enough(1) .or. all(change <= wanted) &
         & .and. (purpose /= sweeps_for%rounding .or. sweep >= strictly)
      ended = settled .or. purpose == sweeps_for%a_look
      if (ended) return
      if (purpose == sweeps_for%haste .and. sweep > 0) &
         & ended = takes_long(maxval(change/wanted), lately, worth)
      if (purpose == sweeps_for%patience .and. sweep > first_rounds*round .and. n <= vast) &
         & ended = takes_long(maxval(change/wanted), lately, worth_many)
      if (purpose >= sweeps_for%patience .and. sweep*n &
         & > merge(patient_work, most_work, purpose == sweeps_for%the_end)) then
         settled = (purpose >= sweeps_for%the_last .or. n > vast) &
            & .and. change(2) <= last_resort*wanted(2)
         ended = .true.
      end if
      lately = maxval(change/wanted)
   end subroutine judge

   !> Whether a change that falls as it did in the last round needs more sweeps than are worth it
   pure logical function takes_long(change, lately, most)
      real(wp), intent(in) :: change  !! The change over what counts as none
      real(wp), intent(in) :: lately
      integer, intent(in) :: most     !! Sweeps that are worth it

      takes_long = .not. change < lately
      if (.not. takes_long) takes_long = -log(change) < most/round*log(change/lately)
   end function takes_long

   !> One sweep over the joints forwards and one backwards
   pure subroutine sweep_twice(springs, joint, active, sweeps, change)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)
      !> Joints that are looked at; after it, those that carry a force: (n)
      logical, intent(inout) :: active(:)
      type(sweeps_t), intent(inout) :: sweeps
      !> Largest change of a force [N/m] and of a gap [m]: (2)
      real(wp), intent(inout) :: change(2)
      integer :: i, j, k

      do i = 1, 2*size(joint)
         k = merge(i, 2*size(joint) + 1 - i, i <= size(joint))
         if (.not. active(k)) cycle
         j = joint(k)
         call relax(size(sweeps%motion, 1), springs, sweeps%view, j, sweeps%noise, &
            & sweeps%force(:, j), sweeps%motion, change)
         active(k) = any(abs(sweeps%force(:, j)) > 0.0_wp)
      end do
   end subroutine sweep_twice

   !> Go on in the direction of the sweeps so far, as conjugate gradients do, unless the last sweep
   !> has changed more than the one before
   pure subroutine go_on(springs, joint, change, square, way, sweeps)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: joint(:)
      real(wp), intent(in) :: change(:, :)  !! What the sweep has changed: (3, n) [N/m]
      real(wp), intent(inout) :: square     !! Its square; that of the sweep before in
      real(wp), intent(inout) :: way(:, :)  !! The direction: (3, n) [N/m]
      type(sweeps_t), intent(inout) :: sweeps
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
         sweeps%force(:, joint(j)) = sweeps%force(:, joint(j)) + ratio*way(:, j)
         call push(size(sweeps%motion, 1), springs, sweeps%view, joint(j), ratio*way(:, j), &
            & sweeps%motion)
      end do
      way = ratio*way + change
   end subroutine go_on

   !> Let one joint take the forces that the law of contact asks for. Column 0 of the motion stands
   !> for all that cannot move
   pure subroutine relax(n_dof, springs, view, j, noise, force, motion, change)
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      type(joint_springs_t), intent(in) :: springs
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
      integer :: k

      call see_gap(n_dof, springs, view, j, force, motion, gap)
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

   !> Openings and slip of a joint, with what follows its forces
   pure subroutine see_gap(n_dof, springs, view, j, force, motion, gap)
      integer, intent(in) :: n_dof
      type(joint_springs_t), intent(in) :: springs
      type(contact_view_t), intent(in) :: view
      integer, intent(in) :: j
      real(wp), intent(in) :: force(3), motion(n_dof, 0:*)
      real(wp), intent(out) :: gap(3)  !! Openings and slip: (3) [m]
      integer :: a, b, i, k

      a = springs%equation(1, j)
      b = springs%equation(2, j)
      gap = view%gap(:, j) + view%soft(:, j)*(force - view%rest(:, j))
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
   end subroutine see_gap

   !> Let the two blocks of a joint answer a change of its forces
   pure subroutine push(n_dof, springs, view, j, change, motion)
      integer, intent(in) :: n_dof
      type(joint_springs_t), intent(in) :: springs
      type(contact_view_t), intent(in) :: view
      integer, intent(in) :: j
      real(wp), intent(in) :: change(3)  !! The change: (3) [N/m]
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

end submodule dda_group_sweeps
