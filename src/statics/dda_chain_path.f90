!> Loading of a chain of elastic joints without sliding
!>
!> Where no joint slides, the joints' springs, which push and never pull, have no history: the
!> forces are those of least energy, a quadratic function of three unknowns, and corners that open
!> are bounds. As the load grows, forces and gaps change in proportion between two events, at which
!> a corner opens or closes. If no shear force comes to its bound at any event, none does between
!> them, and the loading path under Coulomb friction is this one.
!>
!> Equation (M4) of docs/method.md
module dda_chain_path
   use dda_chain, only : chain_t
   use dda_chain_balance, only : add_reaction, hold_upright, influence, solve_3, sum_loads
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: stick_all_along

   !> A corner of a joint that is open
   type :: open_corner_t
      integer :: joint = 0       !! Number of the joint
      integer :: corner = 0      !! 1 or 2
      real(wp) :: gap = 0.0_wp   !! Its width [m]
      real(wp) :: rate = 0.0_wp  !! Its change along a leg
   end type open_corner_t

   !> Forces and gaps of a chain on its way
   type :: chain_state_t
      !> Coefficients of the three unknowns in N1, N2, T of each joint: (3, 3, n + 1)
      real(wp), allocatable :: influence(:, :, :)
      !> Inverse of the springs' compliance for the unknowns
      real(wp) :: stiffness(3, 3) = 0.0_wp
      !> N1, N2, T of each joint: (3, n + 1) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Prestress that a corner must overcome to open [N/m]
      real(wp) :: squeeze = 0.0_wp
      !> Joints whose corners can open; unknowns, 2 of half a chain
      integer :: n_bearing = 0
      integer :: n_unknown = 3
      !> Open corners; the first ones count
      integer :: n_open = 0
      type(open_corner_t) :: open(3)
   end type chain_state_t

   !> Changes along a leg, over its length
   type :: chain_leg_t
      !> Forces if the unknowns stayed: (3, n + 1) [N/m]
      real(wp), allocatable :: force(:, :)
      !> The same for the unknowns: work of the springs' closing
      real(wp) :: closing(3) = 0.0_wp
      !> Prestress [N/m]
      real(wp) :: squeeze = 0.0_wp
   end type chain_leg_t

   !> Maximum number of events per leg
   integer, parameter :: max_events = 200
   !> Round-off of zero forces and gaps, over the largest
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> Least slope of loads that are reached by way of vertical ones
   real(wp), parameter :: flattest = 1.0e-3_wp

contains

   !> Load a chain and check that all joints stick: gravity acts at once, upright,
   !> then it tilts, then comes the push. Joints that are not shown to stick may yet do so
   pure subroutine stick_all_along(chain, tilt, face, sticks)
      type(chain_t), intent(in) :: chain
      !> Angle of gravity from upright, to the right [rad]
      real(wp), intent(in) :: tilt
      !> Faces of the joints under the load: (n + 1)
      type(joint_face_t), intent(out) :: face(:)
      !> True if no joint slides
      logical, intent(out) :: sticks
      type(chain_state_t) :: state, upright
      type(chain_leg_t) :: push
      real(wp) :: slope, turned, whole(2)
      integer :: i

      whole = [sum(chain%block%weight(1)), sum(chain%block%weight(2))]
      sticks = all(abs(whole) <= 0.0_wp)
      if (sticks .or. -whole(2) <= flattest*abs(whole(1))) return
      call stand_upright(chain, upright, push, sticks)
      ! forces depend on the direction of the loads alone, and have no history
      slope = -whole(1)/whole(2)
      turned = tan(tilt)
      state = upright
      if (sticks) call follow(chain, turned, push, state, sticks)
      if (turned*slope < 0.0_wp) then
         state = upright
         turned = 0.0_wp
      end if
      if (sticks) call follow(chain, slope - turned, push, state, sticks)
      if (.not. sticks) return
      do i = 1, state%n_open
         face(state%open(i)%joint)%open(state%open(i)%corner) = .true.
      end do
   end subroutine stick_all_along

   !> The chain under its weight, upright, and what a push as large as the weight would change
   pure subroutine stand_upright(chain, state, push, stands)
      type(chain_t), intent(in) :: chain
      type(chain_state_t), intent(out) :: state
      type(chain_leg_t), intent(out) :: push
      logical, intent(out) :: stands  !! True if forces hold it and no joint slides
      type(chain_leg_t) :: crack
      real(wp) :: load(3, size(chain%joint)), reaction(3)
      real(wp), parameter :: to_the_side(2, 2) = reshape([0, 0, -1, 0], [2, 2])
      real(wp), parameter :: upright(2, 2) = reshape([0, 0, 0, 1], [2, 2])

      call new_state(chain, state)
      call sum_loads(chain, load, to_the_side)
      call new_leg(chain, load, push)
      call sum_loads(chain, load, upright)
      call new_leg(chain, load, crack)
      reaction = -matmul(state%stiffness, crack%closing)
      call add_reaction(chain, reaction, crack%force, state%force)
      ! an even pressure that goes away lets one corner open after the other
      crack%force = 0.0_wp
      crack%closing = 0.0_wp
      crack%squeeze = min(0.0_wp, minval(state%force(:2, :state%n_bearing)))
      state%squeeze = -crack%squeeze
      call move_along(chain, crack, .false., state, stands)
      if (stands) stands = .not. slides(chain, state)
   end subroutine stand_upright

   !> Springs of a chain without forces
   pure subroutine new_state(chain, state)
      type(chain_t), intent(in) :: chain
      type(chain_state_t), intent(out) :: state
      real(wp) :: flexibility(3, 3), g(3, 3), slope(3), unit(3)
      integer :: i, j, n

      n = size(chain%block)
      allocate (state%influence(3, 3, n + 1), state%force(3, n + 1))
      ! the last joint of half a chain with a keystone is inside a block
      state%n_bearing = merge(n, n + 1, chain%keystone)
      if (chain%halved) state%n_unknown = 2
      flexibility = 0.0_wp
      do j = 1, n + 1
         g = influence(chain, j)
         if (chain%halved) g(:, 2) = 0.0_wp
         flexibility = flexibility + chain%joint(j)%compliance*matmul(transpose(g), g)
         state%influence(:, :, j) = g
      end do
      slope = 0.0_wp
      if (chain%halved) call hold_upright(slope, flexibility)
      do i = 1, 3
         unit = 0.0_wp
         unit(i) = 1.0_wp
         call solve_3(flexibility, unit, state%stiffness(:, i))
      end do
   end subroutine new_state

   !> A leg along which a load grows
   pure subroutine new_leg(chain, load, leg)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)  !! Sums of the loads: (3, n + 1)
      type(chain_leg_t), intent(out) :: leg
      real(wp) :: along, moment, normal
      integer :: j

      allocate (leg%force(3, size(load, 2)))
      do j = 1, size(load, 2)
         associate (joint => chain%joint(j))
            normal = joint%tangent(2)*load(1, j) - joint%tangent(1)*load(2, j)
            along = joint%tangent(1)*load(1, j) + joint%tangent(2)*load(2, j)
            moment = (load(3, j) - joint%middle(1)*load(2, j) + joint%middle(2)*load(1, j)) &
               & /joint%half
            leg%force(:, j) = [(normal + moment)/2.0_wp, (normal - moment)/2.0_wp, along]
            ! the force times what each unknown makes of it: N1**2 + N2**2 = (N**2 + (M/half)**2)/2
            normal = joint%compliance*normal/2.0_wp
            along = joint%compliance*along
            moment = joint%compliance*moment/(2.0_wp*joint%half)
            leg%closing = leg%closing + [joint%tangent(2)*normal + joint%tangent(1)*along &
               & + joint%middle(2)*moment, joint%tangent(2)*along - joint%tangent(1)*normal &
               & - joint%middle(1)*moment, moment]
         end associate
      end do
      if (chain%halved) leg%closing(2) = 0.0_wp
   end subroutine new_leg

   !> Go along so many times a leg, or back along it
   pure subroutine follow(chain, times, leg, state, sticks)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: times   !! Number of times
      type(chain_leg_t), intent(in) :: leg
      type(chain_state_t), intent(inout) :: state
      logical, intent(out) :: sticks  !! True if forces are found to its end, and no joint slides
      type(chain_leg_t) :: way

      sticks = .not. abs(times) > 0.0_wp
      if (sticks) return
      way = chain_leg_t(times*leg%force, times*leg%closing, 0.0_wp)
      call move_along(chain, way, .true., state, sticks)
   end subroutine follow

   !> From event to event
   pure subroutine move_along(chain, leg, may_slide, state, sticks)
      type(chain_t), intent(in) :: chain
      type(chain_leg_t), intent(in) :: leg
      logical, intent(in) :: may_slide  !! True if joints that would slide end it
      type(chain_state_t), intent(inout) :: state
      logical, intent(out) :: sticks
      real(wp) :: rate(3, size(chain%joint)), change(3), left, step
      type(open_corner_t) :: opening
      integer :: closing, event, i
      logical :: opens

      sticks = .false.
      left = 1.0_wp
      do event = 1, max_events
         call find_rates(leg, state, change)
         call add_reaction(chain, change, leg%force, rate)
         call next_event(state, rate, leg%squeeze, left, step, opening, closing)
         state%force = state%force + step*rate
         do i = 1, state%n_open
            state%open(i)%gap = state%open(i)%gap + step*state%open(i)%rate
         end do
         state%squeeze = state%squeeze + step*leg%squeeze
         if (slides(chain, state) .and. may_slide) return
         left = left - step
         if (opening%joint == 0 .and. closing == 0) then
            sticks = holds_tight(state)
            return
         else if (closing > 0) then
            state%open(closing:state%n_open - 1) = state%open(closing + 1:state%n_open)
            state%n_open = state%n_open - 1
         else
            if (any(state%open(:state%n_open)%joint == opening%joint)) return
            call open_corner(opening, state, opens)
            if (.not. opens) return
         end if
      end do
   end subroutine move_along

   !> Rates of the unknowns and gaps while the corners stay open or closed
   pure subroutine find_rates(leg, state, change)
      type(chain_leg_t), intent(in) :: leg
      type(chain_state_t), intent(inout) :: state  !! The state; the rates of its gaps are set
      real(wp), intent(out) :: change(3)           !! Rates of the unknowns: (3)
      real(wp) :: matrix(3, 3), row(3, 3), rest(3), gap(3)
      integer :: i, n

      n = state%n_open
      change = -matmul(state%stiffness, leg%closing)
      call open_rows(state, row, matrix)
      rest = 0.0_wp
      do i = 1, n
         rest(i) = -dot_product(row(:, i), change) - leg%squeeze &
            & - leg%force(state%open(i)%corner, state%open(i)%joint)
      end do
      call solve_3(matrix, rest, gap)
      state%open(:n)%rate = gap(:n)
      change = change + matmul(state%stiffness, matmul(row(:, :n), gap(:n)))
   end subroutine find_rates

   !> Coefficients of the unknowns at the open corners, and of their gaps for one another
   pure subroutine open_rows(state, row, matrix)
      type(chain_state_t), intent(in) :: state
      !> Their coefficients: (3, 3), one column per corner
      real(wp), intent(out) :: row(3, 3)
      !> Forces at the corners by unit gaps: (3, 3), of the unit matrix beyond them
      real(wp), intent(out) :: matrix(3, 3)
      integer :: i, n

      n = state%n_open
      row = 0.0_wp
      do i = 1, n
         row(:, i) = state%influence(state%open(i)%corner, :, state%open(i)%joint)
      end do
      matrix = matmul(transpose(row), matmul(state%stiffness, row))
      do i = n + 1, 3
         matrix(i, i) = 1.0_wp
      end do
   end subroutine open_rows

   !> The next corner that opens or closes, if any does
   pure subroutine next_event(state, rate, squeeze, longest, step, opening, closing)
      type(chain_state_t), intent(in) :: state
      real(wp), intent(in) :: rate(:, :)           !! Rates of the forces: (3, n + 1)
      real(wp), intent(in) :: squeeze              !! Rate of the prestress
      real(wp), intent(in) :: longest              !! Rest of the leg
      real(wp), intent(out) :: step                !! Distance of the event
      type(open_corner_t), intent(out) :: opening  !! The corner that opens; joint 0 if none does
      integer, intent(out) :: closing              !! Open corner that closes, or 0
      logical :: is_open(2, size(rate, 2))
      real(wp) :: fall, force
      integer :: i, j

      is_open = .false.
      do i = 1, state%n_open
         is_open(state%open(i)%corner, state%open(i)%joint) = .true.
      end do
      step = longest
      closing = 0
      do j = 1, state%n_bearing
         do i = 1, 2
            fall = -(rate(i, j) + squeeze)
            if (is_open(i, j) .or. .not. fall > 0.0_wp) cycle
            force = state%force(i, j) + state%squeeze
            if (force >= step*fall) cycle
            step = max(0.0_wp, force/fall)
            opening%joint = j
            opening%corner = i
         end do
      end do
      do i = 1, state%n_open
         if (.not. state%open(i)%gap + step*state%open(i)%rate < 0.0_wp) cycle
         step = max(0.0_wp, -state%open(i)%gap/state%open(i)%rate)
         closing = i
         opening%joint = 0
      end do
   end subroutine next_event

   !> Open a corner. Where as many are open as there are unknowns, all turn about these hinges at
   !> once until another one closes; if none does the chain falls
   pure subroutine open_corner(corner, state, opens)
      type(open_corner_t), intent(in) :: corner
      type(chain_state_t), intent(inout) :: state
      logical, intent(out) :: opens  !! True if one could
      real(wp) :: matrix(3, 3), row(3, 3), share(3), turn
      integer :: closing, i, n

      n = state%n_open
      opens = n < state%n_unknown
      if (opens) then
         n = n + 1
         closing = n
         turn = 0.0_wp
      else
         call open_rows(state, row, matrix)
         call solve_3(matrix, matmul(transpose(row), matmul(state%stiffness, &
            & state%influence(corner%corner, :, corner%joint))), share)
         closing = 0
         ! farther than any, and no product of it with a share is infinite
         turn = sqrt(huge(1.0_wp))
         do i = 1, n
            if (.not. state%open(i)%gap < turn*share(i)) cycle
            turn = state%open(i)%gap/share(i)
            closing = i
         end do
         opens = closing > 0
         if (.not. opens) return
         state%open(:n)%gap = state%open(:n)%gap - turn*share(:n)
      end if
      state%n_open = n
      state%open(closing) = open_corner_t(corner%joint, corner%corner, turn, 0.0_wp)
   end subroutine open_corner

   !> True if a joint slides
   pure logical function slides(chain, state)
      type(chain_t), intent(in) :: chain
      type(chain_state_t), intent(in) :: state
      integer :: j

      slides = .false.
      ! the plane of symmetry is smooth
      do j = 1, size(chain%joint) - merge(1, 0, chain%halved)
         slides = slides .or. .not. chain%joint(j)%no_slip .and. abs(state%force(3, j)) &
            & > chain%joint(j)%friction*(state%force(1, j) + state%force(2, j))
      end do
   end function slides

   !> True if no corner pulls, and none that is open pushes, except by rounding
   pure logical function holds_tight(state)
      type(chain_state_t), intent(in) :: state
      real(wp) :: most, wrong
      integer :: i

      wrong = max(0.0_wp, -minval(state%force(:2, :state%n_bearing)))
      do i = 1, state%n_open
         wrong = max(wrong, abs(state%force(state%open(i)%corner, state%open(i)%joint)))
      end do
      most = maxval(state%force(:2, :state%n_bearing))
      holds_tight = wrong <= rounding*most .and. all(state%open(:state%n_open)%gap &
         & >= -rounding*maxval(abs(state%open%gap)))
   end function holds_tight
end module dda_chain_path
