!> Damped motion of an assembly at constant load, from event to event, to equilibrium or without
!> end
!>
!> Where a load has grown by a little and no state in balance is near, the blocks move until gaps
!> close or joints stick, and forces balance again: a jump. If nothing stops them they fall.
module dda_load_jump
   use dda_coulomb_equations, only : bend_joints, coulomb_equations_t
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : apply_law, coulomb_state_t, imbalance
   use dda_event_rates, only : find_rates, rates_t, weak_force
   use dda_joint_graph, only : add_joint_forces
   use dda_kinds, only : wp
   use dda_path_event, only : event_kind, event_t, hold_forces, move_on, next_event
   implicit none
   private

   public :: motion_end, motion_end_enum, jump_t, moves_unbalanced
   public :: balance_rest, far_factor, few_pivots, jump_to_balance, nudge, nudge_to_balance
   public :: share_anew

   !> End of a motion
   type :: motion_end_enum
      !> It did not settle
      integer :: unsettled = 0
      !> Forces balance the load
      integer :: balanced = 1
      !> No gap closes however far the blocks move, and the load drives them
      integer :: endless = 2
      !> The blocks have moved very far
      integer :: far = 3
   end type motion_end_enum

   !> Names of the ends
   type(motion_end_enum), parameter :: motion_end = motion_end_enum()

   !> Input and output of a motion
   type :: jump_t
      !> Balance is where no more than this is left of the load
      real(wp) :: tolerance = 0.0_wp
      !> A motion beyond this is far
      real(wp) :: far = huge(1.0_wp)
      !> Largest displacement of one that came to balance
      real(wp) :: way = 0.0_wp
      !> Velocities of a motion without end: (3, n_block)
      real(wp), allocatable :: mechanism(:, :)
   end type jump_t

   !> Share of the load in damping above which blocks move
   real(wp), parameter :: moves_unbalanced = 0.01_wp
   !> Displacement that counts as far, over that under the dead loads
   real(wp), parameter :: far_factor = 1.0e4_wp
   !> Displacement of a collapse after a share of the steps, over the far one
   real(wp), parameter :: driven = 0.01_wp
   !> Inverse of that share
   integer, parameter :: brief = 10
   !> Pivots after which damping increases
   integer, parameter :: few_pivots = 16
   !> Distance to an event below which it makes no progress
   real(wp), parameter :: no_way = 1.0e-13_wp
   !> Maximum number of events without progress
   integer, parameter :: max_standstill = 60
   !> Maximum number of steps of a jump, and per joint, while its motion does not grow by half
   integer, parameter :: least_patience = 6000, patience = 10
   !> Factor of damping after a step without event, and its inverse without rates
   real(wp), parameter :: calmer = 0.1_wp
   !> First damping without rates along a path
   real(wp), parameter :: first_firm = 1.0e-3_wp
   !> Least and largest damping
   real(wp), parameter :: weakest = 1.0e-10_wp, strongest = 1.0e5_wp
   !> Least increase of a load that starts a motion, over the weight of a block
   real(wp), parameter :: nudge = 1.0e-6_wp
   !> Factor of the increase where a motion does not converge
   real(wp), parameter :: wider = 10.0_wp
   !> Residual of an increase after the motion
   real(wp), parameter :: nudge_left = 1.0e-6_wp
   !> Violation of an event, and residual at a block, over the remaining load
   real(wp), parameter :: minor_share = 1.0e-3_wp
   !> Round-off of forces
   real(wp), parameter :: rounding = 1.0e-12_wp
   !> Residual of equilibrium that is not corrected
   real(wp), parameter :: exact = 1.0e-14_wp

contains

   !> Raise the load by a little and let the blocks move; where they fall, by the least, too: to see
   !> a fall takes long. The way is the same wherever it is to end, unless that is next to nothing:
   !> where it leads beyond, a smaller one may end there
   pure subroutine nudge_to_balance(joints, equations, load_rate, width, left, state, jump, &
      & gained, end, opening_rate)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      !> Growing part of the load: (3, n_block)
      real(wp), intent(in) :: load_rate(:, :)
      !> Its growth
      real(wp), intent(in) :: width
      !> Required growth
      real(wp), intent(in) :: left
      !> The state, unchanged unless another one in balance is found
      type(coulomb_state_t), intent(inout) :: state
      type(jump_t), intent(inout) :: jump
      !> Growth that was gained
      real(wp), intent(out) :: gained
      !> End of the motion, one of motion_end
      integer, intent(out) :: end
      !> Openings that grow with the load, none if absent: (3, n_joint)
      real(wp), intent(in), optional :: opening_rate(:, :)
      type(coulomb_state_t) :: moved, last
      integer :: fall, last_end, most_pivots
      logical :: least

      most_pivots = equations%most_pivots
      equations%most_pivots = few_pivots
      gained = merge(left, width, left < nudge)
      least = gained <= nudge
      call try_nudge(joints, equations, load_rate, gained, state, jump, moved, end, opening_rate)
      if (end == motion_end%unsettled) then
         gained = wider*gained
         call try_nudge(joints, equations, load_rate, gained, state, jump, moved, end, opening_rate)
      end if
      if (end /= motion_end%balanced .and. end /= motion_end%unsettled .and. .not. least) then
         fall = end
         gained = nudge
         call try_nudge(joints, equations, load_rate, gained, state, jump, moved, end, opening_rate)
         ! a motion that does not converge ends as with a little more growth
         if (end == motion_end%unsettled) end = fall
      end if
      if (end == motion_end%balanced .and. gained > left) then
         call try_nudge(joints, equations, load_rate, left, state, jump, last, last_end, &
            & opening_rate)
         if (last_end == motion_end%balanced) moved = last
      end if
      if (end == motion_end%balanced) then
         jump%way = maxval(abs(moved%motion - state%motion))
         state = moved
      end if
      equations%most_pivots = most_pivots
   end subroutine nudge_to_balance

   !> Remove the unbalanced part of the load, beyond rounding
   pure subroutine balance_rest(joints, equations, state)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      type(coulomb_state_t), intent(inout) :: state
      integer, parameter :: max_turn = 3
      type(event_t) :: event
      type(rates_t) :: rates
      real(wp) :: rest(size(state%load, 1), size(state%load, 2))
      integer :: turn
      logical :: found

      do turn = 1, max_turn
         call imbalance(joints, state%load, state%force, rest)
         if (.not. maxval(abs(rest)) > exact) return
         call bend_joints(equations, joints, state)
         call find_rates(joints, equations, state, rest, 0.0_wp, rates, found)
         if (.not. found .or. rates%unbalanced > moves_unbalanced) return
         event = next_event(joints, state, rates, 1.0_wp)
         call move_on(joints, rates, event, state)
      end do
   end subroutine balance_rest

   !> Redistribute the force that a joint has ceased to carry, at the same load
   pure subroutine share_anew(joints, equations, far, state, jump, end)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: far  !! A motion beyond this is far
      type(coulomb_state_t), intent(inout) :: state
      type(jump_t), intent(inout) :: jump
      integer, intent(out) :: end

      jump%far = far
      jump%tolerance = rounding*max(1.0_wp, maxval(abs(state%force)))
      call jump_to_balance(joints, equations, (state%motion), state, jump, end)
   end subroutine share_anew

   !> Let the blocks move at a load that is somewhat larger
   pure subroutine try_nudge(joints, equations, load_rate, more, state, jump, moved, end, &
      & opening_rate)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: load_rate(:, :)
      real(wp), intent(in) :: more  !! Its growth
      type(coulomb_state_t), intent(in) :: state
      type(jump_t), intent(inout) :: jump
      type(coulomb_state_t), intent(out) :: moved
      integer, intent(out) :: end
      real(wp), intent(in), optional :: opening_rate(:, :)

      jump%tolerance = rounding*max(1.0_wp, maxval(abs(state%force)))
      ! where joints crush the path goes on from balance
      if (.not. allocated(joints%share)) jump%tolerance = max(jump%tolerance, nudge_left*more)
      moved = state
      moved%load = state%load + more*load_rate
      if (present(opening_rate)) then
         call apply_law(joints, state, more*opening_rate, moved)
      else
         call apply_law(joints, state, 0.0_wp*state%force, moved)
      end if
      call jump_to_balance(joints, equations, state%motion, moved, jump, end)
   end subroutine try_nudge

   !> Move from event to event at a constant load. Where friction lets forces drop, only motion that
   !> is damped enough has rates: damping rises until it has, and falls again with every step that
   !> meets no event. It is that of joints, in proportion to their stiffness: parts of the assembly
   !> that move as one are free while no joint snaps. Events that are minor beside the unbalanced
   !> load do not count: far from the moving blocks, joints at their limits change their faces by
   !> rounding alone, without end. So do all joints where the unbalanced load is a force that counts
   !> as none: a motion that has kept to such for many steps is balanced
   pure subroutine jump_to_balance(joints, equations, start, state, jump, end)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: start(:, :)  !! Motion of the state as it begins: (3, n_block)
      !> The state, which may not carry its load yet
      type(coulomb_state_t), intent(inout) :: state
      type(jump_t), intent(inout) :: jump
      integer, intent(out) :: end
      type(rates_t) :: rates
      type(event_t) :: event
      real(wp) :: far, firm, rest(3, size(state%load, 2)), viscosity, way
      integer :: faint, i, most, standstill
      logical :: calm, found, pushed, whole

      standstill = 0
      faint = 0
      pushed = .false.
      viscosity = 0.0_wp
      firm = first_firm
      calm = .false.
      whole = .false.
      far = jump%far
      most = least_patience + patience*size(state%slip)
      way = 0.0_wp
      i = 0
      do while (i < most)
         i = i + 1
         call renew_patience(maxval(abs(state%motion - start)), most, way, i)
         call find_rest(joints, state, rest, faint)
         call bend_joints(equations, joints, state)
         if (i > most/brief) far = driven*jump%far
         call see_end(joints, equations, rest, start, state, far, whole .and. .not. pushed &
            & .or. faint > max_standstill, rates, jump, end)
         if (end /= motion_end%unsettled) return
         if (equations%base%n_factorisation >= equations%most_factorisations) return
         call leave_minor(rest)
         if (calm) viscosity = merge(calmer*viscosity, 0.0_wp, calmer*viscosity > weakest)
         call find_rates(joints, equations, state, rest, viscosity, rates, found)
         if (.not. found) then
            if (viscosity > strongest) return
            calm = .false.
            viscosity = merge(firm, max(weakest, viscosity)/calmer, viscosity < firm)
            cycle
         end if
         firm = viscosity
         if (pushed .and. rates%unbalanced > moves_unbalanced) then
            call see_ray(joints, state, rest, rates, event, jump, end)
            if (event%kind == event_kind%none) return
         else
            event = next_turn(joints, state, rest, rates)
         end if
         ! forces that drop faster than this have no rates with less damping
         calm = event%kind == event_kind%none .and. rates%unbalanced < 1.0_wp/(1.0_wp - calmer)
         whole = event%kind == event_kind%none .and. .not. viscosity > 0.0_wp
         pushed = whole .and. rates%unbalanced > moves_unbalanced
         standstill = merge(standstill + 1, 0, event%distance < no_way)
         if (standstill > max_standstill) return
         call move_on(joints, rates, event, state)
      end do
   end subroutine jump_to_balance

   !> Unbalanced load, and how often it has been a force that counts as none
   pure subroutine find_rest(joints, state, rest, faint)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(out) :: rest(:, :)  !! The load: (3, n_block)
      integer, intent(inout) :: faint      !! The number of times

      call imbalance(joints, state%load, state%force, rest)
      if (maxval(abs(rest)) <= weak_force) faint = faint + 1
   end subroutine find_rest

   !> Give a motion that has grown by half the steps again that may bring it to its end
   pure subroutine renew_patience(moved, most, way, step)
      real(wp), intent(in) :: moved    !! The motion
      integer, intent(in) :: most      !! Maximum number of steps
      real(wp), intent(inout) :: way   !! Motion that had grown by half last
      integer, intent(inout) :: step   !! Number of the step
      real(wp), parameter :: grown = 1.5_wp

      if (moved <= grown*way) return
      way = moved
      step = min(step, most/brief)
   end subroutine renew_patience

   !> The next event of a step that would bring balance, or of as many as its rates lead
   pure type(event_t) function next_turn(joints, state, rest, rates) result(event)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(in) :: rest(:, :)  !! Unbalanced load: (3, n_block)
      type(rates_t), intent(in) :: rates
      real(wp) :: minor

      minor = max(weak_force, minor_share*maxval(abs(rest)))
      event = next_event(joints, state, rates, 1.0_wp, minor)
      if (event%kind == event_kind%none) &
         & event = next_event(joints, state, rates, stride(joints, rest, rates), minor)
   end function next_turn

   !> Leave out what is next to nothing of what forces leave of a load
   pure subroutine leave_minor(rest)
      real(wp), intent(inout) :: rest(:, :)  !! Unbalanced load: (3, n_block)
      real(wp) :: minor
      integer :: b

      minor = min(weak_force, minor_share*maxval(abs(rest)))
      do b = 1, size(rest, 2)
         if (maxval(abs(rest(:, b))) <= minor) rest(:, b) = 0.0_wp
      end do
   end subroutine leave_minor

   !> Number of steps along rates, each of which would bring balance without damping: while the
   !> unbalanced forces are the same up to a factor; at least one
   pure real(wp) function stride(joints, rest, rates)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: rest(:, :)  !! Unbalanced load: (3, n_block)
      type(rates_t), intent(in) :: rates
      real(wp), parameter :: bend = 0.3_wp
      real(wp) :: change(size(rest, 1), size(rest, 2)), share, largest

      change = 0.0_wp
      call add_joint_forces(joints%graph, rates%force, change)
      change = -change
      share = sum(change*rest)/sum(rest**2)
      largest = maxval(abs(change - share*rest))
      ! rates that change nothing lead farther than any far, but not to infinity
      stride = bend*maxval(abs(rest))/max(largest, sqrt(tiny(largest)))
      if (share > 0.0_wp) stride = min(stride, 1.0_wp/share)
      stride = max(1.0_wp, stride)
   end function stride

   !> Check if a motion has come to balance, or far. If a far one has no proof of being endless, the
   !> blocks have collapsed by its distance
   pure subroutine see_end(joints, equations, rest, start, state, far, whole, rates, jump, end)
      type(coulomb_joints_t), intent(inout) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: rest(:, :)
      real(wp), intent(in) :: start(:, :)  !! Motion where it began: (3, n_block)
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(in) :: far          !! A motion beyond this is far
      !> True if the last step should bring balance, or many have come near to it: then only
      !> negligible forces may be left
      logical, intent(in) :: whole
      !> Rates, other ones where the motion is far
      type(rates_t), intent(inout) :: rates
      type(jump_t), intent(inout) :: jump
      integer, intent(out) :: end
      type(event_t) :: event
      logical :: found

      end = merge(motion_end%balanced, motion_end%unsettled, maxval(abs(rest)) <= &
         & merge(max(jump%tolerance, weak_force), jump%tolerance, whole))
      if (.not. maxval(abs(state%motion - start)) > far) return
      if (end == motion_end%balanced) then
         ! balance so far away is that of a shape that nobody has drawn
         end = motion_end%far
         jump%mechanism = state%motion - start
         return
      end if
      call find_rates(joints, equations, state, rest, 0.0_wp, rates, found)
      if (found .and. rates%unbalanced > moves_unbalanced) &
         & call see_ray(joints, state, rest, rates, event, jump, end)
      if (end == motion_end%endless) return
      end = motion_end%far
      jump%mechanism = state%motion - start
   end subroutine see_end

   !> Follow a motion with constant forces: to the next gap that closes, or without end
   pure subroutine see_ray(joints, state, rest, rates, event, jump, end)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(in) :: rest(:, :)
      !> Rates of a motion; their forces are held
      type(rates_t), intent(inout) :: rates
      !> The gap that closes, or none
      type(event_t), intent(out) :: event
      type(jump_t), intent(inout) :: jump
      !> endless if no gap closes and the load drives the motion, otherwise unsettled
      integer, intent(out) :: end

      call hold_forces(rates)
      event = next_event(joints, state, rates, huge(1.0_wp))
      end = motion_end%unsettled
      if (event%kind /= event_kind%none .or. .not. sum(rest*rates%motion) > 0.0_wp) return
      end = motion_end%endless
      jump%mechanism = rates%motion
   end subroutine see_ray
end module dda_load_jump
