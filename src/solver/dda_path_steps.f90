!> Steps of the loading path, from event to event
submodule (dda_loading_path) dda_path_steps
   use dda_coulomb_equations, only : bend_joints
   use dda_event_rates, only : find_rates, rates_t, undamp_rates, weak_force
   use dda_load_jump, only : nudge, nudge_to_balance, share_anew
   use dda_path_event, only : event_kind, event_t, go_back, move_on, next_event
   implicit none

   interface

      !> Go on along rates to the next event at most, where joints crush
      pure module subroutine follow_bend(path, way, rates, longest, state, event, found)
         type(loading_path_t), intent(inout) :: path
         type(path_rate_t), intent(in) :: way
         type(rates_t), intent(in) :: rates       !! Rates of the state
         real(wp), intent(in) :: longest          !! Distance to the end
         type(coulomb_state_t), intent(inout) :: state
         type(event_t), intent(out) :: event      !! The event, or where the step ends
         logical, intent(out) :: found            !! True if the state was found
      end subroutine follow_bend

   end interface

   !> Factor of progress within which jumps increase the nudge
   real(wp), parameter :: slow_factor = 10.0_wp
   !> Largest nudge, over the weight of a block: by so much a value reached by such jumps may err
   real(wp), parameter :: largest_nudge = 1.0e-2_wp
   !> Unbalanced share of the load at rest without damping
   real(wp), parameter :: rests_unbalanced = 1.0e-6_wp
   !> Distance to an event below which it makes no progress
   real(wp), parameter :: no_way = 1.0e-13_wp
   !> Step over the load that is left before the largest one, as the motion grows, that is no gain:
   !> steps are a tenth of it and more
   real(wp), parameter :: no_gain = 1.0e-2_wp
   !> Maximum number of events without progress
   integer, parameter :: max_standstill = 60
   !> Maximum number of events and jumps, and per joint
   integer, parameter :: least_patience = 2000, patience = 100
   !> Maximum number of jumps
   integer, parameter :: max_jump = 1000

contains

   !> From event to event, with jumps, which have rates of their own, where no rates go on
   module procedure follow
      type(rates_t) :: rates
      type(jump_t) :: jump
      real(wp) :: damping, last_jump, start(3, size(state%load, 2)), width
      integer :: standstill, i
      logical :: goes_on, slow

      standstill = 0
      start = state%motion
      last_jump = -1.0_wp
      width = nudge
      damping = path%equations%rest_damping
      do i = 1, least_patience + patience*size(state%slip)
         if (result%reached >= h_end) return
         if (size(result%jump) > max_jump) exit
         call bend_joints(path%equations, path%joints, state)
         goes_on = standstill <= max_standstill
         if (goes_on) call see_rates(path, way, state, rates, goes_on)
         if (goes_on) call step_on(path, first, way, h_end, rates, standstill, state, result, &
            & goes_on)
         path%equations%rest_damping = damping
         if (goes_on .and. result%end == path_end%reached .and. result%rest > 0.0_wp) then
            ! beyond a far motion a path that leads hardly any farther falls
            if (result%step*result%haste < no_gain .and. &
               & maxval(abs(state%motion - start)) > far_of(path, state)) then
               jump%mechanism = rates%motion
               call note_fall(motion_end%far, jump, result)
            end if
         end if
         if (.not. goes_on) then
            ! a load that is left and counts as none sets nothing in motion
            if (h_end - result%reached <= weak_force) return
            slow = result%reached - last_jump < slow_factor*width
            width = merge(min(4.0_wp*width, largest_nudge), nudge, slow)
            last_jump = result%reached
            standstill = 0
            rates = rates_t()
            call jump_on(path, state, way, width, h_end, result)
         end if
         if (result%end /= path_end%reached) return
         state%load = first + result%reached*way%load
      end do
      result%end = path_end%undecided
      result%reason = path_reason%too_many
   end procedure follow

   !> Rates of a state at rest. Strips soften joints as these are crushed, without end where the
   !> load comes near to its largest. Rates that damping holds back may slide the other way without
   !> it: it has to be so small that it holds back nothing
   pure subroutine see_rates(path, way, state, rates, found)
      type(loading_path_t), intent(inout) :: path
      type(path_rate_t), intent(in) :: way
      type(coulomb_state_t), intent(in) :: state
      type(rates_t), intent(inout) :: rates
      logical, intent(out) :: found  !! True if there are any

      do
         call find_rates(path%joints, path%equations, state, way%load, 0.0_wp, rates, found, &
            & way%opening)
         if (.not. found) return
         if (.not. allocated(path%joints%share) .or. rates%unbalanced <= rests_unbalanced &
            & .or. path%equations%rest_damping <= least_damping) exit
         path%equations%rest_damping = 0.1_wp*path%equations%rest_damping
      end do
      found = rates%unbalanced <= moves_unbalanced
      if (found) call undamp_rates(path%joints, path%equations, way%load, rates)
      found = rates%unbalanced <= rests_unbalanced
   end subroutine see_rates

   !> Go on along rates, to the next event at most
   pure subroutine step_on(path, first, way, h_end, rates, standstill, state, result, found)
      type(loading_path_t), intent(inout) :: path
      real(wp), intent(in) :: first(:, :)  !! Load at the beginning: (3, n_block)
      type(path_rate_t), intent(in) :: way
      real(wp), intent(in) :: h_end
      type(rates_t), intent(in) :: rates   !! Rates of the state
      integer, intent(inout) :: standstill !! Number of events so far without progress
      type(coulomb_state_t), intent(inout) :: state
      !> Receives the event, or how the blocks fall
      type(path_result_t), intent(inout) :: result
      logical, intent(out) :: found        !! False if joints that crush go no farther
      type(coulomb_state_t) :: last
      type(event_t) :: event
      type(jump_t) :: jump
      real(wp) :: haste
      integer :: end

      found = .true.
      if (allocated(state%whole)) last = state
      if (allocated(path%joints%share)) then
         haste = maxval(abs(rates%motion))/max(maxval(abs(state%motion)), tiny(haste))
         call follow_bend(path, way, rates, h_end - result%reached, state, event, found)
         if (.not. found) return
         call see_rest(haste, event, result)
      else
         event = next_event(path%joints, state, rates, h_end - result%reached)
         call move_on(path%joints, rates, event, state)
      end if
      standstill = merge(standstill + 1, 0, event%distance < no_way)
      result%reached = merge(h_end, result%reached + event%distance, &
         & event%kind == event_kind%none .and. event%distance >= h_end - result%reached)
      result%n_event = result%n_event + 1
      if (.not. allocated(state%whole)) return
      state%load = first + result%reached*way%load
      if (all(last%whole .eqv. state%whole)) return
      call share_anew(path%joints, path%equations, far_of(path, state), state, jump, end)
      if (end == motion_end%balanced) return
      call note_fall(end, jump, result)
      call go_back(path%joints, rates, event, last, state)
   end subroutine step_on

   !> Load that a step has left to the largest one that joints bear as they crush. Near that one
   !> the motion grows as a power of this load, its inverse or the root of that, so that the motion
   !> over its rate is a multiple of this load
   pure subroutine see_rest(haste, event, result)
      real(wp), intent(in) :: haste       !! Rate of motion over the motion, where the step began
      type(event_t), intent(in) :: event  !! Where it has ended
      type(path_result_t), intent(inout) :: result
      real(wp) :: grown

      grown = 0.0_wp
      if (result%haste > 0.0_wp) grown = haste/result%haste - 1.0_wp
      result%rest = 0.0_wp
      if (event%kind == event_kind%none .and. grown > 0.0_wp) &
         & result%rest = max(0.0_wp, result%step/grown - event%distance)
      result%step = event%distance
      result%haste = haste
   end subroutine see_rest

   !> A motion beyond this is far
   pure real(wp) function far_of(path, state)
      type(loading_path_t), intent(in) :: path
      type(coulomb_state_t), intent(in) :: state

      far_of = far_factor*max(path%softness*max(1.0_wp, maxval(abs(state%force))), path%given)
   end function far_of

   !> Go on by a jump
   pure subroutine jump_on(path, state, way, width, h_end, result)
      type(loading_path_t), intent(inout) :: path
      !> The state, unchanged unless another one in balance is found
      type(coulomb_state_t), intent(inout) :: state
      type(path_rate_t), intent(in) :: way
      !> Growth of the load by which the blocks are set in motion; out: the growth that was reached
      real(wp), intent(inout) :: width
      !> Where the path ends
      real(wp), intent(in) :: h_end
      !> Receives the jump, or how the blocks fall
      type(path_result_t), intent(inout) :: result
      type(jump_t) :: jump
      real(wp) :: before(3, size(state%force, 2)), gained
      integer :: end

      before = state%force
      jump%far = far_of(path, state)
      call nudge_to_balance(path%joints, path%equations, way%load, width, h_end - result%reached, &
         & state, jump, gained, end, way%opening)
      if (end == motion_end%balanced) then
         result%jump = [result%jump, result%reached]
         result%largest_jump = max(result%largest_jump, jump%way)
         result%reached = min(h_end, result%reached + gained)
         result%haste = 0.0_wp
         path%jumped = hypot(path%jumped, path%joints%force_unit*maxval(abs(state%force - before)))
         width = min(width, gained)
      else
         ! where joints crush the load falls by less than was tried
         if (allocated(path%joints%share)) result%rest = max(result%rest, gained)
         call note_fall(end, jump, result)
      end if
   end subroutine jump_on

   !> Result of a path that ends by a collapse, or by a motion that did not converge
   module procedure note_fall

      result%end = path_end%collapsed
      if (end == motion_end%endless) then
         result%reason = path_reason%mechanism
      else if (end == motion_end%far) then
         result%reason = path_reason%far_motion
      else
         result%end = path_end%undecided
         result%reason = path_reason%unsettled_motion
      end if
      if (allocated(jump%mechanism)) result%mechanism = jump%mechanism
   end procedure note_fall

end submodule dda_path_steps
