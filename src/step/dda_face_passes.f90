!> Contact forces of joints that keep to their faces: open, sliding or stuck, each a linear law
!>
!> Coulomb's law is piecewise linear. With the faces known, forces and motion are one solution of
!> linear equations, unsymmetric where joints slide; joints that disagree change their faces, all at
!> once. Near the answer that ends after one to three passes and leaves rounding; far from it, it
!> may go round in circles, and interior springs find the way (`dda_contact_interior`).
submodule (dda_multipliers:dda_contact_interior) dda_face_passes
   use dda_friction_cone, only : joint_face_t, shear_bound
   implicit none

   !> Compliance of a force that does not follow its opening, over that of the blocks
   real(wp), parameter :: free = 1.0e20_wp
   !> Forces across gaps, and by openings, that are left, over the size of a force
   real(wp), parameter :: tolerance = 1.0e-6_wp
   !> Change of a force by its spring at the end, over the same; where it falls no more, gaps
   !> contradict one another, and forces would grow without end: then the above counts
   real(wp), parameter :: remains = 1.0e-7_wp
   !> Most passes; fewer where not half as many faces change as in the pass before
   integer, parameter :: max_passes = 5
   !> Most solutions
   integer, parameter :: max_turns = 24
   !> Compliances of the springs of many joints over that of few, tried one after the other: where
   !> the firmest find no faces, soft ones find some in few passes from farther away, and the faces
   !> of each are near those of the next
   real(wp), parameter :: softness(4) = [1.0e-3_wp, 1.0_wp, 3.0e-2_wp, 1.0e-3_wp]
   !> Where more than this share of many joints change, most of what is held is wrong
   real(wp), parameter :: most_changes = 0.2_wp
   !> Most passes of many joints with springs of one softness
   integer, parameter :: many_passes = 12
   !> Passes that do not bring noticeably fewer changes and end them; of very many joints the first
   integer, parameter :: patience = 2
   !> Share of very many joints that may still change where sweeps rather go on from there
   real(wp), parameter :: nearly = 1.0e-2_wp
   !> What counts as noticeable
   real(wp), parameter :: falling = 0.7_wp

contains

   !> Find forces and motion whose faces agree, from those of an iterate
   module procedure settle_faces
      type(joint_face_t) :: face(size(p%joint))
      real(wp) :: last_rest, rest
      integer :: changes, last, pass, turn
      logical :: held

      agreed = .false.
      call read_faces(p, x, face)
      held = .false.
      last = size(face)/2
      last_rest = huge(last_rest)
      pass = 0
      do turn = 1, max_turns
         if (.not. held) then
            if (pass == max_passes) return
            pass = pass + 1
            passes = passes + 1
            call hold_faces(face, p, x)
            call factor_springs(p)
            if (.not. p%factor%usable) return
         end if
         call move_on(p, x)
         call change_faces(p, x, face, changes)
         held = changes == 0
         if (held) then
            rest = maxval(p%soft/p%unit*abs(x%force - p%force_before), .not. p%follows)/p%size
            agreed = rest <= p%fineness*merge(tolerance, remains, rest > falling*last_rest) &
               & .or. maxval(p%soft*abs(x%force - p%force_before), .not. p%follows) <= p%left
            if (agreed) return
            last_rest = rest
            where (.not. p%follows) p%force_before = x%force
            changes = huge(changes)
         else if (2*changes > last) then
            return
         end if
         last = changes
      end do
   end procedure settle_faces

   !> The same of many joints, which rather end than keep to the way that the loads have led them
   module procedure settle_many_faces
      type(joint_face_t) :: face(size(p%joint))
      type(interior_t) :: firmer
      real(wp) :: soft(3, size(p%joint))
      logical :: ended
      integer :: changes, k

      soft = p%soft
      agreed = .false.
      near = .false.
      firmer = x
      do k = 1, size(softness)
         where (.not. p%follows) p%soft = softness(k)*soft
         if (k == 2) firmer = x
         if (k <= 2) call read_faces(p, firmer, face)
         call pass_faces(p, hasty, firmer, face, passes, changes)
         ended = changes == 0
         agreed = agreed .or. ended
         near = hasty .and. changes <= nearly*size(face)
         if (ended .or. near) x = firmer
         if ((ended .eqv. k == 1) .or. hasty) exit
      end do
      near = near .or. agreed
      p%soft = soft
   end procedure settle_many_faces

   !> Solve with the faces as they are and change those that disagree, again and again
   pure subroutine pass_faces(p, hasty, x, face, passes, changes)
      type(problem_t), intent(inout) :: p
      logical, intent(in) :: hasty
      type(interior_t), intent(inout) :: x
      type(joint_face_t), intent(inout) :: face(:)  !! Faces: (n_joint)
      integer, intent(inout) :: passes
      integer, intent(out) :: changes               !! How many forces disagree with their faces
      integer :: least, pass, stale

      changes = huge(changes)
      stale = 0
      least = huge(least)/2
      do pass = 1, many_passes
         passes = passes + 1
         call hold_faces(face, p, x)
         call factor_springs(p)
         if (.not. p%factor%usable) return
         call move_on(p, x)
         call change_faces(p, x, face, changes)
         if (changes == 0) exit
         stale = merge(0, stale + 1, changes < falling*least)
         if (stale == merge(1, patience, hasty) .or. changes > most_changes*size(face)) return
         least = min(least, changes)
      end do
      ! what rounding has left
      if (changes == 0) call move_on(p, x)
   end subroutine pass_faces

   !> Add what forces and motion lack, but to forces that their faces give
   pure subroutine move_on(p, x)
      !> The problem, factored; what is lacking afterwards is set
      type(problem_t), intent(inout) :: p
      type(interior_t), intent(inout) :: x
      real(wp) :: force(3, size(p%joint)), motion(size(p%balance, 1), size(p%equation))

      call see_lack(x, p)
      where (p%yield(:3, :) > 0.0_wp) p%opening = 0.0_wp
      where (p%yield(4, :) > 0.0_wp) p%opening(3, :) = 0.0_wp
      call respond(p, p%opening, force, motion)
      x%force = x%force + force
      x%motion = x%motion + motion
      call see_lack(x, p)
   end subroutine move_on

   !> The faces that forces and openings of the joints speak for
   pure subroutine read_faces(p, x, face)
      type(problem_t), intent(inout) :: p         !! The problem; what is lacking is set
      type(interior_t), intent(in) :: x
      type(joint_face_t), intent(out) :: face(:)  !! The faces: (n_joint)
      real(wp) :: force(3), trial(3)
      integer :: i

      call see_lack(x, p)
      do i = 1, size(face)
         force = x%force(:, i) + p%springs%shift(:, i)
         trial = force + p%opening(:, i)/p%unit(:, i)
         face(i)%open = .not. (p%given(1:2, i) .and. trial(1:2) >= 0.0_wp)
         if (abs(trial(3)) > shear_bound(p%springs%cone(i), max(0.0_wp, force)) &
            & .or. all(face(i)%open)) face(i)%slip = merge(1, -1, trial(3) > 0.0_wp)
         if (.not. p%given(3, i)) face(i)%slip = 0
      end do
   end subroutine read_faces

   !> Put the forces onto their faces, and let the springs keep them there
   pure subroutine hold_faces(face, p, x)
      type(joint_face_t), intent(in) :: face(:)
      type(problem_t), intent(inout) :: p  !! The problem; how the bounds yield is set
      type(interior_t), intent(inout) :: x
      integer :: i

      p%yield = 0.0_wp
      do i = 1, size(face)
         associate (shift => p%springs%shift(:, i), cone => p%springs%cone(i), &
            & slip => face(i)%slip, force => x%force(:, i))
            where (face(i)%open .and. p%given(1:2, i))
               force(1:2) = -shift(1:2)
               p%yield(1:2, i) = free*p%unit(1:2, i)
            end where
            if (slip == 0) cycle
            force(3) = slip*shear_bound(cone, force + shift)
            p%yield(merge(4, 3, slip > 0), i) = free*p%unit(3, i)
         end associate
      end do
   end subroutine hold_faces

   !> Let joints that disagree with their faces change them
   pure subroutine change_faces(p, x, face, changes)
      type(problem_t), intent(in) :: p
      type(interior_t), intent(in) :: x
      type(joint_face_t), intent(inout) :: face(:)
      integer, intent(out) :: changes  !! How many forces disagree
      real(wp) :: force(3), excess, opening(3), least
      logical :: sticks
      integer :: i, k

      changes = 0
      least = p%fineness*tolerance*p%size
      do i = 1, size(face)
         force = x%force(:, i) + p%springs%shift(:, i)
         ! of open contacts and sliding joints, over what the blocks give; others have none
         opening = -p%opening(:, i)/p%unit(:, i)
         do k = 1, 2
            if (.not. p%given(k, i)) cycle
            if (merge(opening(k), force(k), face(i)%open(k)) >= -least) cycle
            face(i)%open(k) = .not. face(i)%open(k)
            changes = changes + 1
         end do
         if (.not. p%given(3, i)) cycle
         excess = abs(force(3)) - shear_bound(p%springs%cone(i), max(0.0_wp, force))
         sticks = p%springs%cone(i)%kind == cone_kind%no_slip
         if (all(face(i)%open)) then
            if (face(i)%slip == 0) changes = changes + 1
            if (face(i)%slip == 0) face(i)%slip = 1
         else if (face(i)%slip == 0 .and. excess > least) then
            face(i)%slip = merge(1, -1, force(3) > 0.0_wp)
            changes = changes + 1
         else if (face(i)%slip*opening(3) > least .or. sticks .and. face(i)%slip /= 0) then
            ! what cannot slide does not go on as it did while it was open
            face(i)%slip = 0
            changes = changes + 1
         end if
      end do
   end subroutine change_faces

end submodule dda_face_passes
