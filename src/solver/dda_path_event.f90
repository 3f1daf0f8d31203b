!> The next event on a path, at which a joint changes its state
module dda_path_event
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, shear_role
   use dda_coulomb_law, only : break_joint, coulomb_state_t, crush_joint, face, &
      & shear_face, shear_limit, strength, yield_joint
   use dda_crushed_joint, only : can_crush, reserve, strip_gap_rate
   use dda_event_rates, only : rates_t, weak_force
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: event_t, event_kind, event_kind_enum, path_end, go_ahead, go_back, hold_forces
   public :: left_to_event, move_on, next_event

   !> Events of a joint
   type :: event_kind_enum
      integer :: none = 0         !! Nothing
      integer :: opens = 1        !! A corner no longer pushes
      integer :: closes = 2       !! A gap closes
      integer :: slides = 3       !! The joint begins to slide against a positive shear force
      integer :: slides_back = 4  !! The joint begins to slide against a negative shear force
   end type event_kind_enum

   !> Names of what can happen
   type(event_kind_enum), parameter :: event_kind = event_kind_enum()

   !> The next change of a joint
   type :: event_t
      real(wp) :: distance = 0.0_wp  !! Its distance
      integer :: kind = 0            !! Kind of event
      integer :: joint = 0           !! To which joint
      integer :: corner = 0          !! At which corner, where one opens or closes
   end type event_t

   !> End of a path
   type :: path_end_enum
      integer :: undecided = 0  !! It is not known whether the assembly stands
      integer :: reached = 1    !! The end was reached, forces balance
      integer :: collapsed = 2  !! The assembly falls
   end type path_end_enum

   !> Names of the ends of a path
   type(path_end_enum), parameter :: path_end = path_end_enum()

   !> Least size of an event that counts
   type :: least_t
      real(wp) :: longest = 0.0_wp  !! Distance within which it counts
      real(wp) :: slow = 0.0_wp     !! Rates of force up to this are none
      real(wp) :: still = 0.0_wp    !! So are these where next to nothing is left of a force or gap
      real(wp) :: minor = 0.0_wp    !! Force by which it must lead beyond zero at the longest
   end type least_t

   !> Least change of a force on the path, over the weight of a block
   real(wp), parameter :: no_change = 1.0e-12_wp
   !> Share of the distance to an event just before it
   real(wp), parameter :: before_event = 1.0_wp - 4.0_wp*epsilon(1.0_wp)

contains

   !> Rates of a motion with constant forces: blocks move a million times as fast as joints deform,
   !> and the rounding of its openings is no force
   pure subroutine hold_forces(rates)
      type(rates_t), intent(inout) :: rates
      real(wp), parameter :: rounding = 1.0e-8_wp
      real(wp) :: largest

      largest = maxval(abs(rates%opening))
      where (abs(rates%opening) < rounding*largest) rates%opening = 0.0_wp
      where (rates%face(3, :) == face%stuck) rates%opening(3, :) = 0.0_wp
      rates%force = 0.0_wp
   end subroutine hold_forces

   !> The next event, or none within a distance: its distance is the longest one if there is none
   pure type(event_t) function next_event(joints, state, rates, longest, minor) result(event)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state  !! Where the assembly is
      type(rates_t), intent(in) :: rates
      real(wp), intent(in) :: longest             !! Distance within which an event counts
      !> Force by which an event must lead beyond zero at that distance to count; any if absent
      real(wp), intent(in), optional :: minor
      type(least_t) :: least
      real(wp) :: bond(3), quantity(2)
      integer :: i, j
      logical :: crushes

      event%distance = longest
      least = least_t(longest=longest, slow=no_change/max(longest, tiny(1.0_wp)))
      if (present(minor)) least%minor = minor
      bond = 0.0_wp
      do j = 1, size(rates%face, 2)
         if (allocated(state%whole)) bond = strength(joints, state, j)
         crushes = allocated(joints%share)
         if (crushes) crushes = can_crush(joints, j)
         do i = 1, 2
            if (joints%end_role(i, j) /= end_role%contact) cycle
            least%still = rates%still/joints%graph%compliance(j)
            if (rates%face(i, j) == face%closed) then
               quantity = [state%force(i, j), rates%force(i, j)]
               if (crushes) quantity = force_left(joints, state, rates, j, i)
               quantity(1) = quantity(1) + bond(i)
               if (crushes) quantity(2) = mean_rate(joints, rates, j, i, quantity)
               call meet(quantity(1), quantity(2), least, event_kind%opens, j, i, event)
            else
               quantity = [state%gap(i, j), rates%opening(i, j)]/joints%graph%compliance(j)
               if (crushes) quantity = gap_left(joints, state, rates, j, i)
               call meet(quantity(1), quantity(2), least, event_kind%closes, j, i, event)
            end if
         end do
         if (rates%face(3, j) /= face%stuck) cycle
         if (joints%shear_role(j) /= shear_role%frictional) cycle
         least%still = rates%still/joints%graph%compliance(j)
         quantity = shear_left(joints, state, rates, j, 1)
         call meet(quantity(1) + bond(3), quantity(2), least, event_kind%slides, j, 0, event)
         quantity = shear_left(joints, state, rates, j, -1)
         call meet(quantity(1) + bond(3), quantity(2), least, event_kind%slides_back, j, 0, event)
      end do
   end function next_event

   !> Rest to an event, and its rate
   pure function left_to_event(joints, state, rates, event) result(left)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(in) :: rates
      type(event_t), intent(in) :: event
      real(wp) :: left(2)  !! As a force, and its rate; nothing where there is no event

      select case (event%kind)
      case (event_kind%opens)
         left = force_left(joints, state, rates, event%joint, event%corner)
      case (event_kind%closes)
         left = gap_left(joints, state, rates, event%joint, event%corner)
      case (event_kind%slides)
         left = shear_left(joints, state, rates, event%joint, 1)
      case (event_kind%slides_back)
         left = shear_left(joints, state, rates, event%joint, -1)
      case default
         left = 0.0_wp
      end select
   end function left_to_event

   !> Rest of a closed corner until it opens, and its rate
   pure function force_left(joints, state, rates, j, corner) result(left)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: j       !! Number of the joint
      integer, intent(in) :: corner  !! The corner
      real(wp) :: left(2)            !! As a force, and its rate

      left = [state%force(corner, j), rates%force(corner, j)]
      if (.not. can_crush(joints, j)) return
      if (rates%face(3 - corner, j) /= face%closed) then
         ! the whole of it opens or is crushed
         left = [sum(state%force(:2, j)), sum(rates%force(:2, j))]
         if (left(1) > 0.5_wp*joints%graph%crush(j)) left = [joints%graph%crush(j) - left(1), &
            & -left(2)]
         return
      end if
      left(1) = reserve(joints, j, corner, state%force(:2, j))
      left(2) = left(2) - joints%share(j)*sum(rates%force(:2, j))
   end function force_left

   !> Mean rate of what a closed corner has left, until it opens
   pure real(wp) function mean_rate(joints, rates, j, corner, left) result(rate)
      type(coulomb_joints_t), intent(in) :: joints
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: j        !! Number of the joint
      integer, intent(in) :: corner   !! The corner
      real(wp), intent(in) :: left(2) !! Rest as a force, and its rate
      real(wp) :: bend

      rate = left(2)
      if (rates%face(3 - corner, j) /= face%closed .or. .not. left(1) > 0.0_wp) return
      ! the force that is left is a parabola over the distance
      bend = 0.5_wp*sum(rates%force(:2, j))*(sum(rates%force(:2, j))/joints%graph%crush(j))
      rate = 0.5_wp*(rate - sqrt(rate**2 + 4.0_wp*bend*left(1)))
   end function mean_rate

   !> Gap of an open corner as a force, and its rate
   pure function gap_left(joints, state, rates, j, corner) result(left)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: j       !! Number of the joint
      integer, intent(in) :: corner  !! The corner
      real(wp) :: left(2)            !! As a force, and its rate

      left = [state%gap(corner, j), strip_gap_rate(joints, j, corner, &
         & rates%face(3 - corner, j) == face%closed, rates%opening(:2, j), rates%force(:2, j))] &
         & /joints%graph%compliance(j)
   end function gap_left

   !> Rest of the shear force of a joint until it slides by friction, and its rate
   pure function shear_left(joints, state, rates, j, sense) result(left)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: j      !! Number of the joint
      integer, intent(in) :: sense  !! 1 against a positive shear force, -1 against a negative one
      real(wp) :: left(2)           !! As a force, and its rate

      left = [shear_limit(joints, j, state%force(:2, j)), &
         & shear_limit(joints, j, rates%force(:2, j))] &
         & - real(sense, wp)*[state%force(3, j), rates%force(3, j)]
   end function shear_left

   !> Take an event that comes before the others: something positive falls to zero
   pure subroutine meet(rest, rate, least, kind, joint, corner, event)
      real(wp), intent(in) :: rest        !! Falling quantity, as a force
      real(wp), intent(in) :: rate        !! Its rate
      type(least_t), intent(in) :: least  !! Its least size
      integer, intent(in) :: kind         !! Event at zero
      integer, intent(in) :: joint        !! Number of the joint
      integer, intent(in) :: corner       !! Corner of the joint, or 0
      type(event_t), intent(inout) :: event

      if (.not. (rate < -least%slow .and. rest > 0.0_wp)) return
      if (rest <= weak_force .and. rate >= -least%still) return
      if (least%minor > 0.0_wp) then
         if (rest + least%longest*rate >= -least%minor) return
      end if
      ! what is farther than the largest number never comes
      if (rest > min(1.0_wp, -rate)*huge(rate)) return
      if (-rest/rate < event%distance) event = event_t(-rest/rate, kind, joint, corner)
   end subroutine meet

   !> Move a state on to its next event and let that happen
   pure subroutine move_on(joints, rates, event, state)
      type(coulomb_joints_t), intent(in) :: joints
      type(rates_t), intent(in) :: rates  !! Rates of the state
      type(event_t), intent(in) :: event  !! The event, or the end of the way
      type(coulomb_state_t), intent(inout) :: state
      real(wp) :: bond(3), shear
      integer :: i, j

      state%motion = state%motion + event%distance*rates%motion
      state%face(3, :) = rates%face(3, :)
      bond = 0.0_wp
      do j = 1, size(rates%face, 2)
         if (allocated(state%whole)) bond = strength(joints, state, j)
         if (can_crush(joints, j)) then
            call crush_joint(joints, j, event%distance*rates%opening(:2, j), state)
         else
            state%face(:2, j) = rates%face(:2, j)
            do i = 1, 2
               if (joints%end_role(i, j) == end_role%tied) then
                  state%force(i, j) = state%force(i, j) + event%distance*rates%force(i, j)
               else if (rates%face(i, j) == face%open) then
                  state%force(i, j) = 0.0_wp
                  if (joints%end_role(i, j) == end_role%contact) state%gap(i, j) = &
                     & max(0.0_wp, state%gap(i, j) + event%distance*rates%opening(i, j))
               else
                  state%force(i, j) = max(0.0_wp - bond(i), state%force(i, j) &
                     & + event%distance*rates%force(i, j))
                  state%gap(i, j) = 0.0_wp
               end if
            end do
         end if
         shear = state%force(3, j)
         call take_shear(joints, j, state%face(3, j), shear + event%distance*rates%force(3, j), &
            & state)
         state%slip(j) = state%slip(j) + event%distance*rates%opening(3, j) &
            & + joints%graph%compliance(j)*(state%force(3, j) - shear)
         if (allocated(state%whole)) call break_joint(joints, j, state)
      end do
      if (event%kind /= event_kind%none) call let_happen(joints, event, state)
   end subroutine move_on

   !> Let an event happen where a state is
   pure subroutine let_happen(joints, event, state)
      type(coulomb_joints_t), intent(in) :: joints
      type(event_t), intent(in) :: event
      type(coulomb_state_t), intent(inout) :: state

      associate (j => event%joint, i => event%corner)
         select case (event%kind)
         case (event_kind%opens)
            if (can_crush(joints, j)) call touch_limit(joints, j, i, state)
            ! what a tensile force has stretched is a gap
            state%gap(i, j) = max(0.0_wp, -state%force(i, j)*joints%graph%compliance(j))
            if (.not. can_crush(joints, j)) state%force(i, j) = 0.0_wp
            state%face(i, j) = face%open
            if (.not. sum(state%force(:2, j)) > 0.0_wp) &
               & state%face(3, j) = shear_face(joints, j, state%face(:2, j), state%face(3, j))
            call take_shear(joints, j, state%face(3, j), state%force(3, j), state)
         case (event_kind%closes)
            state%gap(i, j) = 0.0_wp
            state%face(i, j) = face%closed
            state%face(3, j) = shear_face(joints, j, state%face(:2, j), &
               & merge(face%stuck, state%face(3, j), state%face(3, j) == face%free))
         case (event_kind%slides, event_kind%slides_back)
            state%face(3, j) = merge(face%slides, face%slides_back, &
               & event%kind == event_kind%slides)
            call take_shear(joints, j, state%face(3, j), state%force(3, j), state)
         end select
         if (allocated(state%whole)) call break_joint(joints, j, state)
      end associate
   end subroutine let_happen

   !> Move a state on while all faces stay, beyond the limits of its joints, too
   pure subroutine go_ahead(joints, rates, distance, state, lag)
      type(coulomb_joints_t), intent(in) :: joints
      type(rates_t), intent(in) :: rates  !! Rates of the state
      real(wp), intent(in) :: distance    !! Distance along them
      type(coulomb_state_t), intent(inout) :: state
      real(wp), intent(out) :: lag(:)     !! Openings that crushed joints leave: (n_joint)
      real(wp) :: shear
      integer :: i, j

      state%motion = state%motion + distance*rates%motion
      do j = 1, size(rates%face, 2)
         lag(j) = 0.0_wp
         if (can_crush(joints, j)) then
            call yield_joint(joints, j, rates%face(:2, j), distance*rates%opening(:2, j), &
               & distance*sum(rates%force(:2, j)), state, lag(j))
         else
            do i = 1, 2
               state%force(i, j) = state%force(i, j) + distance*rates%force(i, j)
               if (joints%end_role(i, j) == end_role%contact .and. rates%face(i, j) == face%open) &
                  & state%gap(i, j) = state%gap(i, j) + distance*rates%opening(i, j)
            end do
         end if
         state%face(:, j) = rates%face(:, j)
         shear = state%force(3, j)
         if (state%face(3, j) == face%stuck) then
            state%force(3, j) = shear + distance*rates%force(3, j)
         else
            call take_shear(joints, j, state%face(3, j), shear, state)
         end if
         state%slip(j) = state%slip(j) + distance*rates%opening(3, j) &
            & + joints%graph%compliance(j)*(state%force(3, j) - shear)
      end do
   end subroutine go_ahead

   !> Put the forces of a joint that crushes where one of its corners opens
   pure subroutine touch_limit(joints, j, corner, state)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j, corner  !! Number of the joint, the corner
      type(coulomb_state_t), intent(inout) :: state
      real(wp) :: n

      associate (force => state%force(:2, j))
         n = sum(force)
         if (state%face(3 - corner, j) == face%open) then
            force = 0.0_wp
            if (n > 0.5_wp*joints%graph%crush(j)) force = 0.5_wp*joints%graph%crush(j)
            return
         end if
         force(corner) = force(corner) - reserve(joints, j, corner, force)
         if (.not. n > 0.0_wp) force(corner) = 0.0_wp
         force(3 - corner) = n - force(corner)
      end associate
   end subroutine touch_limit

   !> Go back from a collapse to where it broke: forces are those just before, with the joints that
   !> broke
   pure subroutine go_back(joints, rates, event, last, state)
      type(coulomb_joints_t), intent(in) :: joints
      type(rates_t), intent(in) :: rates             !! Rates that led to the event
      type(event_t), intent(in) :: event             !! Event that broke a joint
      type(coulomb_state_t), intent(in) :: last      !! State after the event before
      type(coulomb_state_t), intent(inout) :: state  !! With the load at the event
      type(coulomb_state_t) :: there

      there = last
      call move_on(joints, rates, event_t(before_event*event%distance), there)
      there%load = state%load
      ! what opens at once has broken at the event before
      if (any(there%whole .neqv. last%whole)) there = last
      there%whole = state%whole
      state = there
   end subroutine go_back

   !> Set the shear force of a joint as what it does allows
   pure subroutine take_shear(joints, j, does, trial, state)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j       !! Number of the joint
      integer(small), intent(in) :: does    !! Its state along itself
      real(wp), intent(in) :: trial  !! The force if it sticks
      type(coulomb_state_t), intent(inout) :: state
      real(wp) :: bond(3), bound

      select case (does)
      case (face%stuck)
         bond = strength(joints, state, j)
         bound = shear_limit(joints, j, state%force(:2, j), bond(3))
         state%force(3, j) = max(-bound, min(bound, trial))
      case (face%free)
         state%force(3, j) = 0.0_wp
      case default
         bound = shear_limit(joints, j, state%force(:2, j))
         state%force(3, j) = real(does, wp)*max(0.0_wp, bound)
      end select
   end subroutine take_shear
end module dda_path_event
