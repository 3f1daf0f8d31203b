!> Steps of the loading path of joints that crush
!>
!> The path is curved: strips of crushed joints follow the forces, while corners and joints keep
!> what they do. A step goes along its tangent, then Newton's method brings it back to balance and
!> to the event at which it ends. The first limit passed on the way is the next event to aim at.
submodule (dda_loading_path:dda_path_steps) dda_path_bends
   use dda_crushed_joint, only : bear_side, can_crush, reserve
   use dda_coulomb_joints, only : end_role, shear_role
   use dda_coulomb_law, only : face, imbalance, normal_forces, shear_face, shear_limit, &
      & spring_forces
   use dda_event_rates, only : solve_rates, weak_force
   use dda_kinds, only : small
   use dda_path_event, only : go_ahead, left_to_event
   implicit none

   !> Residual of balance and distance from an event, over the largest force: Newton's method
   !> squares its error, so that another correction would be round-off
   real(wp), parameter :: exact = 1.0e-12_wp
   !> Largest correction of a step over the step: a larger one may lead to another state of balance
   real(wp), parameter :: most_bend = 0.2_wp
   !> Least and largest share of a step that failed
   real(wp), parameter :: shorter = 0.25_wp, somewhat_shorter = 0.9_wp
   !> Maximum number of corrections
   integer, parameter :: most_turns = 12
   !> Largest share of the strength with which joints begin to crush
   real(wp), parameter :: gentle = 1.0e-2_wp

contains

   !> Go on along rates to the next event at most, where joints crush
   module procedure follow_bend
      type(coulomb_state_t) :: last
      type(event_t) :: aim
      integer, parameter :: most_tries = 60
      real(wp) :: next
      integer :: try

      last = state
      event = next_event(path%joints, state, rates, longest)
      found = .false.
      do try = 1, most_tries
         call walk(path, way, rates, last%load, most_bend*event%distance &
            & *maxval(abs(rates%motion)), event, state, next, found)
         aim = event_t(next)
         if (found) aim = passed_limit(path%joints, last, state, rates, event)
         ! an event may lie farther away than its rates lead to
         if (aim%distance > longest) aim = event_t(longest)
         found = found .and. .not. aim%distance < event%distance
         if (found) exit
         event = aim
         if (event%distance < no_way) exit
         state = last
      end do
      if (.not. found) state = last
      if (.not. found) return
      call move_on(path%joints, rates_of_faces(rates), event_t(0.0_wp, event%kind, event%joint, &
         & event%corner), state)
   end procedure follow_bend

   !> Rates that lead nowhere
   pure type(rates_t) function rates_of_faces(rates) result(none)
      type(rates_t), intent(in) :: rates

      none = rates
      none%motion = 0.0_wp
      none%opening = 0.0_wp
      none%force = 0.0_wp
   end function rates_of_faces

   !> Walk to an event, or by a distance if it has none, in balance
   pure subroutine walk(path, way, rates, load, largest, event, state, next, found)
      type(loading_path_t), intent(inout) :: path
      type(path_rate_t), intent(in) :: way
      type(rates_t), intent(in) :: rates      !! Rates where it begins
      real(wp), intent(in) :: load(:, :)      !! Load there: (3, n_block)
      real(wp), intent(in) :: largest         !! Largest motion by a correction
      type(event_t), intent(inout) :: event   !! The event; its distance is corrected
      type(coulomb_state_t), intent(inout) :: state
      real(wp), intent(out) :: next           !! A distance to try where it is not
      logical, intent(out) :: found           !! True if it is there
      type(rates_t) :: onward, step
      real(wp) :: drive(3, size(state%slip)), lag(size(state%slip)), left(2), more, off
      real(wp) :: rest(3, size(load, 2))
      integer :: turn

      next = shorter*event%distance
      call go_ahead(path%joints, rates, event%distance, state, lag)
      step = rates
      onward = rates
      do turn = 1, most_turns
         state%load = load + event%distance*way%load
         call imbalance(path%joints, state%load, state%force, rest)
         left = left_to_event(path%joints, state, onward, event)
         call bend_joints(path%equations, path%joints, state)
         off = max(maxval(abs(rest)), force_of_lag(path%joints, step%face, lag))
         found = max(off, abs(left(1))) <= exact*max(1.0_wp, maxval(abs(state%force)))
         if (found) return
         drive(:2, :) = spread(lag, 1, 2)
         drive(3, :) = 0.0_wp
         call solve_rates(path%joints, path%equations, rest, 0.0_wp, step, drive)
         if (.not. path%equations%usable) return
         call spring_forces(path%joints, step%face, step%opening, step%force)
         if (event%kind /= event_kind%none) then
            call solve_rates(path%joints, path%equations, way%load, 0.0_wp, onward, way%opening)
            if (.not. path%equations%usable) return
            call spring_forces(path%joints, onward%face, onward%opening, onward%force)
            more = rate_of(path, state, onward, event)
            if (.not. abs(more) > 0.0_wp) return
            more = -(left(1) + rate_of(path, state, step, event))/more
            if (.not. event%distance + more >= 0.0_wp) return
            event%distance = event%distance + more
            step%motion = step%motion + more*onward%motion
            step%opening = step%opening + more*onward%opening
            step%force = step%force + more*onward%force
         end if
         ! forces that count as none may move soft blocks far: no other state
         if (maxval(abs(step%motion)) > largest .and. off > weak_force) then
            ! the correction grows as the square of the distance, its permitted size as the distance
            next = event%distance*max(shorter, min(somewhat_shorter, largest &
               & /maxval(abs(step%motion))))
            return
         end if
         call go_ahead(path%joints, step, 1.0_wp, state, lag)
      end do
   end subroutine walk

   !> Largest force that the openings which crushed joints leave would change
   pure real(wp) function force_of_lag(joints, faces, lag) result(largest)
      type(coulomb_joints_t), intent(in) :: joints
      integer(small), intent(in) :: faces(:, :)  !! Faces of the joints: (3, n_joint)
      real(wp), intent(in) :: lag(:)             !! The openings: (n_joint)
      integer :: j

      largest = 0.0_wp
      do j = 1, size(lag)
         if (abs(lag(j)) > 0.0_wp) largest = max(largest, &
            & maxval(abs(normal_forces(joints, j, faces(:2, j), spread(lag(j), 1, 2)))))
      end do
   end function force_of_lag

   !> Rate of what is left to an event
   pure real(wp) function rate_of(path, state, rates, event) result(rate)
      type(loading_path_t), intent(in) :: path
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(in) :: rates
      type(event_t), intent(in) :: event
      real(wp) :: left(2)

      left = left_to_event(path%joints, state, rates, event)
      rate = left(2)
   end function rate_of

   !> The limit that was passed first between two states with the same faces; without one the event
   !> at which they end
   pure type(event_t) function passed_limit(joints, last, state, rates, event) result(first)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: last, state
      type(rates_t), intent(in) :: rates  !! Rates of the first one
      type(event_t), intent(in) :: event
      real(wp) :: still
      integer :: i, j

      first = event
      ! slip by forces that count as none
      still = weak_force*max(1.0_wp, maxval(abs(rates%motion)))
      do j = 1, size(state%slip)
         do i = 1, 2
            if (joints%end_role(i, j) == end_role%contact) call see_limit(joints, last, state, &
               & rates, event, event_t(0.0_wp, merge(event_kind%opens, event_kind%closes, &
               & state%face(i, j) == face%closed), j, i), first)
         end do
         if (joints%shear_role(j) /= shear_role%frictional) cycle
         if (state%face(3, j) == face%stuck) then
            call see_limit(joints, last, state, rates, event, event_t(0.0_wp, event_kind%slides, &
               & j, 0), first)
            call see_limit(joints, last, state, rates, event, event_t(0.0_wp, &
               & event_kind%slides_back, j, 0), first)
         else if (abs(state%face(3, j)) == face%slides) then
            ! the joint turns back on the way
            if (real(state%face(3, j), wp)*(state%slip(j) - last%slip(j)) > still &
               & .and. first%distance > 0.5_wp*event%distance) &
               & first = event_t(0.5_wp*event%distance)
         end if
      end do
   end function passed_limit

   !> See if a limit was passed before others
   pure subroutine see_limit(joints, last, state, rates, event, limit, first)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: last, state
      type(rates_t), intent(in) :: rates
      type(event_t), intent(in) :: event     !! The event at which the states end
      type(event_t), intent(in) :: limit     !! The limit
      type(event_t), intent(inout) :: first  !! The first one so far
      real(wp) :: after(2), before(2), share
      logical :: leaves

      if (limit%kind == event%kind .and. limit%joint == event%joint &
         & .and. limit%corner == event%corner) return
      after = left_to_event(joints, state, rates, limit)
      ! rates that may be none lead to no limit
      if (.not. after(1) < -weak_force - event%distance*rates%still &
         & /joints%graph%compliance(limit%joint)) return
      before = left_to_event(joints, last, rates, limit)
      leaves = before(1) > weak_force .or. before(2) > 0.0_wp
      share = 0.5_wp
      if (leaves) share = root_of([max(0.0_wp, before(1)), event%distance*before(2), after(1)])
      if (.not. share*event%distance < first%distance) return
      first = event_t(share*event%distance)
      if (leaves) first = event_t(first%distance, limit%kind, limit%joint, limit%corner)
   end subroutine see_limit

   !> The first positive root of a parabola, of which the end is negative
   pure real(wp) function root_of(part) result(root)
      real(wp), intent(in) :: part(3)  !! Its value, not negative, and slope at 0, its value at 1
      real(wp) :: bend, spread

      bend = part(3) - part(1) - part(2)
      spread = sqrt(max(0.0_wp, part(2)**2 - 4.0_wp*bend*part(1)))
      if (part(2) > 0.0_wp) then
         root = -0.5_wp*(part(2) + spread)/bend
      else
         root = 2.0_wp*part(1)/(spread - part(2))
      end if
   end function root_of

   !> A state whose joints do not crush, at a share of its load at which they crush by little
   module procedure begin_to_crush
      type(coulomb_state_t) :: whole
      type(path_rate_t) :: way
      type(rates_t) :: rates
      type(event_t) :: event
      integer, parameter :: most_tries = 6
      real(wp) :: next
      integer :: i, try, turn
      logical :: gives

      whole = state
      share = 1.0_wp
      settled = least_reserve(path%joints, state) >= 0.0_wp
      if (settled) return
      share = min(1.0_wp, gentle/largest_share(path%joints, state))
      allocate (way%load, mold=state%load)
      way%load = 0.0_wp
      rates%face = state%face
      allocate (rates%motion, mold=state%motion)
      allocate (rates%opening, rates%force, mold=state%force)
      rates%motion = 0.0_wp
      rates%opening = 0.0_wp
      rates%force = 0.0_wp
      do try = 1, most_tries
         state%motion = share*whole%motion
         state%force = share*whole%force
         state%gap = share*whole%gap
         state%slip = share*whole%slip
         state%load = share*whole%load
         do i = 1, size(state%slip)
            if (can_crush(path%joints, i)) call rest_on_strip(path%joints, i, state)
         end do
         rates%face = whole%face
         do turn = 1, most_turns
            event = event_t(0.0_wp)
            call walk(path, way, rates, share*whole%load, most_bend*maxval(abs(state%motion)), &
               & event, state, next, settled)
            if (.not. settled) exit
            call give_way(path%joints, state, rates%face, gives)
            settled = .not. gives
            if (settled) return
         end do
         share = 0.1_wp*share
      end do
   end procedure begin_to_crush

   !> Let corners open and joints slide whose forces are beyond their limits: no event would find
   !> them
   pure subroutine give_way(joints, state, faces, gives)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      integer(small), intent(inout) :: faces(:, :)  !! States of corners and joints: (3, n_joint)
      logical, intent(out) :: gives                 !! True if there is one
      integer :: i, j

      gives = .false.
      do j = 1, size(faces, 2)
         do i = 1, 2
            if (joints%end_role(i, j) /= end_role%contact .or. faces(i, j) == face%open) cycle
            if (reserve(joints, j, i, state%force(:2, j)) >= -weak_force) cycle
            faces(i, j) = face%open
            gives = .true.
         end do
         faces(3, j) = shear_face(joints, j, faces(:2, j), faces(3, j))
         if (faces(3, j) /= face%stuck .or. abs(state%force(3, j)) &
            & <= shear_limit(joints, j, state%force(:2, j)) + weak_force) cycle
         faces(3, j) = merge(face%slides, face%slides_back, state%force(3, j) > 0.0_wp)
         gives = .true.
      end do
   end subroutine give_way

   !> Least distance of a closed corner from its limit
   pure real(wp) function least_reserve(joints, state) result(least)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      integer :: i, j

      least = 0.0_wp
      do j = 1, size(state%slip)
         if (.not. can_crush(joints, j)) cycle
         do i = 1, 2
            least = min(least, reserve(joints, j, i, state%force(:2, j)))
         end do
      end do
   end function least_reserve

   !> Largest normal force over the strength
   pure real(wp) function largest_share(joints, state) result(share)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      integer :: j

      share = tiny(share)
      do j = 1, size(state%slip)
         if (can_crush(joints, j)) share = max(share, &
            & sum(state%force(:2, j))/joints%graph%crush(j))
      end do
   end function largest_share

   !> Put the force of a joint that one corner bears on its strip
   pure subroutine rest_on_strip(joints, j, state)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j  !! Number of the joint
      type(coulomb_state_t), intent(inout) :: state
      integer :: side

      if (state%face(1, j) == state%face(2, j)) return
      side = merge(1, 2, state%face(1, j) == face%closed)
      call bear_side(joints, j, side, state%gap(:, j) - joints%graph%compliance(j) &
         & *state%force(:2, j), state%force(:2, j), state%gap(:, j))
   end subroutine rest_on_strip
end submodule dda_path_bends
