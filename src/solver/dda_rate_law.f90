!> Coulomb's law for rates: response of the joints at a state
!>
!> A corner that pushes stays closed, one with a gap stays open, a joint within Coulomb's limit
!> sticks. A corner without force and without gap, and a joint at its limit, are weak: they follow
!> the rates of opening, so that the rates of the forces are a function of these, in straight
!> pieces.
submodule (dda_event_rates) dda_rate_law
   use dda_coulomb_joints, only : end_role, shear_role
   use dda_coulomb_law, only : face, normal_forces, shear_face, strength
   use dda_crushed_joint, only : is_crushed, reserve, turn_of_corner
   implicit none

contains

   !> The law of a state
   module procedure set_rate_law
      real(wp) :: bond(3), bound, left(2)
      integer :: i, j, loose(size(state%slip)), n
      logical :: bears, pushes(2)

      allocate (law%weak(2, size(state%slip)), law%limit(2, size(state%slip)))
      allocate (law%given(3, size(state%slip)), law%holds(size(state%slip)))
      n = 0
      bond = 0.0_wp
      do j = 1, size(state%slip)
         if (allocated(state%whole)) bond = strength(joints, state, j)
         left = state%force(:2, j)
         if (allocated(joints%share)) left = [reserve(joints, j, 1, state%force(:2, j)), &
            & reserve(joints, j, 2, state%force(:2, j))]
         do i = 1, 2
            pushes(i) = joints%end_role(i, j) == end_role%tied &
               & .or. left(i) + bond(i) > weak_force
            law%weak(i, j) = .not. (pushes(i) .or. joints%end_role(i, j) == end_role%absent &
               & .or. state%gap(i, j) > weak_force*joints%graph%compliance(j))
            law%given(i, j) = merge(face%closed, face%open, pushes(i))
         end do
         law%holds(j) = bond(3) > weak_force
         law%given(3, j) = face%stuck
         if (.not. law%holds(j)) &
            & law%given(3, j) = shear_face(joints, j, law%given(:2, j), face%stuck)
         bears = any(pushes) .or. is_crushed(joints, j)
         law%limit(:, j) = .not. bears
         if (bears .or. law%holds(j)) then
            bound = joints%graph%friction(j)*(state%force(1, j) + state%force(2, j)) + bond(3)
            law%limit(1, j) = bound - state%force(3, j) <= weak_force
            law%limit(2, j) = bound + state%force(3, j) <= weak_force
         end if
         if (joints%shear_role(j) /= shear_role%frictional) law%limit(:, j) = .false.
         if (.not. (any(law%weak(:, j)) .or. any(law%limit(:, j)))) cycle
         n = n + 1
         loose(n) = j
      end do
      law%loose = loose(:n)
   end procedure set_rate_law

   !> Faces of joints with given rates of opening
   module procedure follow_law
      real(wp) :: beyond(2), margin
      integer(small) :: before(3, size(faces, 2))
      integer :: i, j, k

      before = faces
      faces = law%given
      ! closed and stuck faces remain until a change exceeds rounding, open and sliding ones until
      ! it does not
      do k = 1, size(law%loose)
         j = law%loose(k)
         do i = 1, 2
            if (law%weak(i, j)) faces(i, j) = merge(face%open, face%closed, &
               & turn_of_corner(joints, j, i, opening(:2, j)) &
               & > merge(0.0_wp, still, before(i, j) == face%open))
         end do
         if (any(law%weak(:, j)) .and. .not. law%holds(j)) &
            & faces(3, j) = shear_face(joints, j, faces(:2, j), face%stuck)
         if (faces(3, j) == face%free .or. .not. any(law%limit(:, j))) cycle
         beyond = beyond_limit(joints, j, faces(:2, j), opening(:, j))
         margin = still/joints%graph%compliance(j)
         if (law%limit(1, j) .and. &
            & beyond(1) > merge(0.0_wp, margin, before(3, j) == face%slides)) then
            faces(3, j) = face%slides
         else if (law%limit(2, j) .and. &
            & beyond(2) > merge(0.0_wp, margin, before(3, j) == face%slides_back)) then
            faces(3, j) = face%slides_back
         end if
      end do
   end procedure follow_law

   !> Rate at which a joint that sticks would exceed its limits
   pure function beyond_limit(joints, j, ends, opening) result(beyond)
      type(coulomb_joints_t), intent(in) :: joints
      !> Number of the joint
      integer, intent(in) :: j
      !> States of its corners: (2)
      integer(small), intent(in) :: ends(2)
      !> Rates of opening 1, opening 2, slip
      real(wp), intent(in) :: opening(3)
      !> Rate of the shear force less that of the limit: of a positive one, of a negative one
      real(wp) :: beyond(2)
      real(wp) :: push(3)

      push = -opening/joints%graph%compliance(j)
      push(:2) = merge(push(:2), 0.0_wp, ends == face%closed)
      if (allocated(joints%share)) push(:2) = normal_forces(joints, j, ends, opening(:2))
      beyond = [push(3), -push(3)] - joints%graph%friction(j)*sum(push(:2))
   end function beyond_limit

   !> The first bend of the law on a line of rates of opening
   module procedure next_break
      real(wp) :: far(4), rate(4), reach, fastest
      integer :: i, j, k

      ! what rounding makes may be left behind: of those in reach the fastest decides
      reach = huge(1.0_wp)
      do k = 1, size(law%loose)
         call see_bends(joints, law, law%loose(k), faces, opening, change, far, rate)
         do i = 1, 4
            if (rate(i) > 0.0_wp) reach = min(reach, far(i) + still/rate(i))
         end do
      end do
      next_break%distance = huge(1.0_wp)
      fastest = 0.0_wp
      do k = 1, size(law%loose)
         j = law%loose(k)
         call see_bends(joints, law, j, faces, opening, change, far, rate)
         do i = 1, 4
            if (.not. rate(i) > fastest .or. far(i) > reach) cycle
            fastest = rate(i)
            next_break = break_t(far(i), j, i, rises=.true.)
            if (i > 2) then
               next_break%rises = faces(3, j) /= merge(face%slides, face%slides_back, i == 3)
            else
               next_break%rises = faces(i, j) /= face%closed
            end if
         end do
      end do
   end procedure next_break

   !> Where a joint bends the law on a line of rates of opening
   pure subroutine see_bends(joints, law, j, faces, opening, change, far, rate)
      type(coulomb_joints_t), intent(in) :: joints
      type(rate_law_t), intent(in) :: law
      !> Number of the joint
      integer, intent(in) :: j
      integer(small), intent(in) :: faces(:, :)
      real(wp), intent(in) :: opening(:, :), change(:, :)
      !> Distances to changes of corner 1, corner 2, positive and negative sliding, and rates of
      !> approach; a rate of zero where nothing changes
      real(wp), intent(out) :: far(4), rate(4)
      real(wp) :: beyond(2), sense
      integer :: i

      far = 0.0_wp
      rate = 0.0_wp
      do i = 1, 2
         if (.not. law%weak(i, j)) cycle
         sense = merge(1.0_wp, -1.0_wp, faces(i, j) == face%closed)
         far(i) = -sense*turn_of_corner(joints, j, i, opening(:2, j))
         rate(i) = sense*turn_of_corner(joints, j, i, change(:2, j))
      end do
      if (faces(3, j) /= face%free) then
         do i = 1, 2
            if (.not. law%limit(i, j)) cycle
            sense = joints%graph%compliance(j)*merge(1.0_wp, -1.0_wp, &
               & faces(3, j) == merge(face%slides, face%slides_back, i == 1))
            beyond = sense*beyond_limit(joints, j, faces(:2, j), opening(:, j))
            far(i + 2) = beyond(i)
            beyond = -sense*beyond_limit(joints, j, faces(:2, j), change(:, j))
            rate(i + 2) = beyond(i)
         end do
      end if
      where (rate > 0.0_wp) far = max(0.0_wp, far)/rate
   end subroutine see_bends

   !> Rate along a line of the quantity that decides a bend
   module procedure break_rate
      real(wp) :: rate(2)

      associate (j => break%joint)
         if (break%part > 2) then
            rate = beyond_limit(joints, j, faces(:2, j), change(:, j))
            break_rate = rate(break%part - 2)
         else
            break_rate = -turn_of_corner(joints, j, break%part, change(:2, j))
         end if
      end associate
   end procedure break_rate

   !> Faces of a joint beyond a bend
   module procedure cross_break
      integer :: j

      j = break%joint
      if (break%part > 2) then
         faces(3, j) = merge(merge(face%slides, face%slides_back, break%part == 3), face%stuck, &
            & break%rises)
      else
         faces(break%part, j) = merge(face%closed, face%open, break%rises)
         ! a joint that begins to push slides as it moves
         if (faces(3, j) == face%free) faces(3, j) = merge(face%slides_back, face%slides, &
            & opening(3, j) > 0.0_wp)
         if (joints%shear_role(j) /= shear_role%frictional) faces(3, j) = face%stuck
         if (.not. law%holds(j)) faces(3, j) = shear_face(joints, j, faces(:2, j), faces(3, j))
      end if
   end procedure cross_break

end submodule dda_rate_law
