!> Critical value of a load coefficient: the first collapse on the loading path, and the associated
!> limit. The coefficient comes last on the path, so one path finds its critical value
submodule (dda_critical) dda_load_search
   use dda_dead_rest, only : follow_from_rest
   use dda_decision, only : record_collapse, record_rest
   use dda_graph_decision, only : see_fall, slide_along
   use dda_joint_graph, only : breaks, joint_graph_t
   use dda_limit_load, only : find_limit, limit_state
   use dda_load_coefficient, only : added_loads, can_follow, carry_load, coefficient, full_loads, &
      & is_push, knows_no_order, may_seek, restore_weight, seek_rest, value_at_end, &
      & values_between, with_coefficient
   use dda_load_stations, only : load_stations, load_stations_t, only_weight
   use dda_path_event, only : path_end
   use dda_scene_graph, only : graph_verdict_t, has_friction, scene_graph
   use dda_search, only : limit_t
   use dda_settings, only : flow_rule, settings_t
   implicit none

   !> Where a structure falls on one side of the unloaded state
   type :: side_t
      integer :: end = path_end%reached  !! One of path_end
      !> Value at which it falls, from that state; of what stands, the end of the range
      real(wp) :: value = 0.0_wp
      real(wp) :: half = 0.0_wp  !! Its error
      !> Least and largest value, as jumps may lead elsewhere and joints crush
      real(wp) :: reach(2) = [huge(1.0_wp), -huge(1.0_wp)]
      type(limit_t) :: limit     !! The associated limit, with the sign of the side
      !> A load somewhat beyond the limit, or the dead load if that falls: (3, n_block)
      real(wp), allocatable :: beyond(:, :)
      logical :: stands_upright = .true.  !! True if the path leads further than its dead loads
      logical :: falls_dead = .false.     !! True if no forces balance the dead loads
      real(wp) :: least = 0.0_wp  !! Coefficient of a live load that is none beside the dead loads
      type(graph_verdict_t) :: proof      !! Collapse, or equilibrium at the end of the range
   end type side_t

   !> Relative excess over a limit for its mechanism
   real(wp), parameter :: nudge = 1.0e-2_wp
   !> Relative accuracy of a loading path
   real(wp), parameter :: path_resolution = 1.0e-9_wp
   !> Largest live load over the largest dead load that is none: a decision does not see it
   real(wp), parameter :: unseen = 1.0e-10_wp
   !> Least relative gap of both bounds of a limit
   real(wp), parameter :: least_gap = 1.0e-13_wp

contains

   !> Search a family whose parameter is a load coefficient
   module procedure find_critical_load
      type(error_t), allocatable :: error
      type(joint_graph_t) :: graph
      type(scene_t), allocatable :: scene
      type(side_t) :: right, left
      real(wp) :: low, high, origin
      integer :: n
      logical :: rest

      call move_alloc(critical%scene, scene)
      if (.not. allocated(scene)) allocate (scene)
      call family%turn(search%low, scene, error)
      if (.not. allocated(error)) low = coefficient(family%load, scene%settings)
      if (.not. allocated(error)) call family%turn(search%high, scene, error)
      done = .not. allocated(error)
      if (done) high = coefficient(family%load, scene%settings)
      if (done) done = high > low .and. can_follow(family%load, scene, max(abs(low), abs(high)))
      if (.not. done) return
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      ! smooth joints follow no path, and gravity that tilts farther than a push is no limit
      if (family%load == searched_load%tilt .and. .not. has_friction(graph)) done &
         & = only_weight(scene%settings) .and. is_push(max(abs(low), abs(high)))
      if (.not. done) return
      ! from an unloaded state outside the range, the path leads through it
      call follow_side(family, scene, graph, 0.0_wp, high, 1.0_wp, search, right)
      call follow_side(family, scene, graph, 0.0_wp, low, -1.0_wp, search, left)
      call look_elsewhere(family, scene, graph, search, low, high, right, left, origin, &
         & rest, n)
      call tell_fall(scene%settings, graph, right)
      call tell_fall(scene%settings, graph, left)
      call carry_load(family%load, high, scene, graph, right%proof)
      call carry_load(family%load, low, scene, graph, left%proof)
      critical%factorisations = n + right%proof%n_factorisation + left%proof%n_factorisation
      critical%steps = right%proof%n_event + left%proof%n_event
      ! what does not stand upright may do so under gravity that acts another way from the beginning
      done = family%load /= searched_load%tilt .or. .not. rest &
         & .or. right%stands_upright .and. left%stands_upright
      ! where the two proofs of a limit do not meet, decisions of single values close a bracket
      if (done) done = .not. (lacks_limit(right) .or. lacks_limit(left))
      search%least = max(right%least, left%least)*(search%high - search%low)/(high - low)
      if (done) call conclude(search, low, high, scene, right, left, critical)
      if (done) call move_alloc(scene, critical%scene)
      search%low = search%low + (origin - low)*(search%high - search%low)/(high - low)
      search%start = search%low
   end procedure find_critical_load

   !> True if a side is undecided because its limit is not known
   pure logical function lacks_limit(side)
      type(side_t), intent(in) :: side

      lacks_limit = side%end == path_end%undecided .and. side%proof%flow == flow_rule%associated
   end function lacks_limit

   !> Seek values that stand where no forces balance the dead loads: limit analysis starts from
   !> there
   pure subroutine look_elsewhere(family, scene, graph, search, low, high, right, left, origin, &
      & may_stand, n)
      class(family_t), intent(in) :: family
      type(scene_t), intent(inout) :: scene
      type(joint_graph_t), intent(inout) :: graph
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: low, high  !! The range
      type(side_t), intent(inout) :: right, left
      real(wp), intent(out) :: origin    !! A value that may stand, low where none is known
      logical, intent(out) :: may_stand  !! True if not all of the range is known to fall
      integer, intent(out) :: n          !! Factorisations without those of the two sides
      real(wp) :: from, to, margin
      logical :: found, no_order

      n = 0
      origin = low
      from = low
      to = high
      may_stand = .true.
      no_order = knows_no_order(scene%settings, graph)
      if (breaks(graph) .or. .not. (right%falls_dead .or. left%falls_dead)) return
      if (.not. may_seek(family%load, scene, no_order, to - from)) return
      if (.not. no_order .and. right%stands_upright .and. left%stands_upright) return
      call seek_rest(family%load, scene, graph, from, to, origin, found, n)
      may_stand = to > from
      if (.not. (found .and. no_order)) return
      n = n + right%proof%n_factorisation + left%proof%n_factorisation
      ! what is ruled out begins at a limit or beyond
      margin = nudge*(to - from)
      call follow_side(family, scene, graph, origin, min(high, to + margin), 1.0_wp, search, right)
      call follow_side(family, scene, graph, origin, max(low, from - margin), -1.0_wp, search, left)
   end subroutine look_elsewhere

   !> Mechanism of a side that limit analysis has found to collapse
   pure subroutine tell_fall(settings, graph, side)
      type(settings_t), intent(in) :: settings
      type(joint_graph_t), intent(in) :: graph
      type(side_t), intent(inout) :: side

      if (side%end /= path_end%collapsed .or. side%proof%flow /= flow_rule%associated) return
      if (.not. allocated(side%beyond)) return
      if (side%proof%is_told) then
         call slide_along(settings, graph, side%beyond, side%limit%force, side%proof)
      else
         call see_fall(settings, graph, side%beyond, side%proof)
      end if
   end subroutine tell_fall

   !> Follow the path to one side, at most to the limit of limit analysis
   pure subroutine follow_side(family, scene, graph, origin, last, outward, search, side)
      class(family_t), intent(in) :: family
      type(scene_t), intent(inout) :: scene        !! The scene at the high end
      type(joint_graph_t), intent(inout) :: graph  !! Its joints, rebuilt behind a path
      !> Value from which the range is searched: 0, or one that stands where 0 does not
      real(wp), intent(in) :: origin
      real(wp), intent(in) :: last     !! End of the range on this side
      real(wp), intent(in) :: outward  !! 1 to the right, -1 to the left
      type(search_t), intent(in) :: search
      type(side_t), intent(out) :: side
      type(load_stations_t) :: stations
      type(settings_t) :: settings
      real(wp) :: far

      side%value = last
      if (.not. outward*(last - origin) > 0.0_wp) return
      call find_associated(family%load, scene, graph, origin, last - origin, search, side)
      side%falls_dead = side%limit%state == limit_state%no_dead_equilibrium
      far = last
      if (side%limit%known .and. abs(side%limit%value(1)) < abs(last)) far = side%limit%value(1)
      associate (proof => side%proof)
         proof%n_factorisation = side%limit%n_factorisation
         side%stands_upright = knows_no_order(scene%settings, graph)
         if (side%stands_upright .or. side%falls_dead) then
            call take_associated(last - origin, search, side)
            side%value = origin + side%value
            side%limit%value = origin + side%limit%value
            return
         end if
         if (abs(far) < abs(last)) far = far*(1.0_wp - path_resolution)
         settings = with_coefficient(scene%settings, family%load, far)
         stations = load_stations(settings, .true.)
         call follow_from_rest(family, search%high, settings, stations, &
            & side%limit%known .or. side%limit%state == limit_state%unbounded, scene, graph, proof)
         proof%n_factorisation = proof%n_factorisation + side%limit%n_factorisation
         side%falls_dead = proof%no_start
         side%stands_upright = .not. proof%no_start
         side%end = proof%end
         side%value = value_at_end(family%load, far, stations, proof)
         if (family%load == searched_load%tilt .and. only_weight(scene%settings)) &
            & call restore_weight(stations, proof)
         if (proof%end == path_end%reached .and. abs(far) < abs(last)) then
            ! no forces go on from here, whatever the law of friction
            side%end = path_end%collapsed
            side%value = far
            proof%mechanism = side%limit%velocity
            proof%is_told = .true.
            proof%flow = flow_rule%associated
         end if
         side%half = max(0.5_wp*search%tolerance, path_resolution)*abs(side%value)
         if (side%end == path_end%collapsed .and. proof%flow == flow_rule%coulomb) &
            & side%reach = values_between(family%load, far, stations, proof, side%limit)
         if (is_at_limit(side)) call take_associated(last, search, side)
      end associate
   end subroutine follow_side

   !> True if a path ends at the associated limit: where nothing slides in the collapse both rules
   !> agree, and limit analysis is sharper; a path that does not converge so near to the limit ends
   !> there
   pure logical function is_at_limit(side)
      type(side_t), intent(in) :: side

      is_at_limit = .false.
      if (side%falls_dead .or. .not. side%limit%known .or. side%end == path_end%reached) return
      is_at_limit = product(side%limit%value) <= 0.0_wp .or. abs(side%value - side%limit%value(2)) &
         & <= merge(10.0_wp, 100.0_wp, side%end == path_end%collapsed)*path_resolution &
         & *abs(side%value)
   end function is_at_limit

   !> The associated limit of what is searched, where it is linear in the load
   pure subroutine find_associated(load, scene, graph, origin, last, search, side)
      integer, intent(in) :: load  !! One of searched_load
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: origin, last  !! Where it begins, and from there the end of the range
      type(search_t), intent(in) :: search
      type(side_t), intent(inout) :: side
      real(wp) :: dead(3, graph%n_block), live(3, graph%n_block), tolerance

      if (breaks(graph) .or. load == searched_load%tilt .and. .not. &
         & (only_weight(scene%settings) .and. is_push(last))) return
      dead = full_loads(with_coefficient(scene%settings, load, origin), scene, graph)
      ! gravity and a push across it are gravity that tilts
      live = sign(1.0_wp, last)*added_loads(load, scene%settings, scene, graph, origin)
      side%least = unseen*maxval(abs(dead))/max(maxval(abs(live)), tiny(1.0_wp))
      tolerance = min(path_resolution, max(least_gap, 1.0e-2_wp*search%tolerance))
      side%limit%state = limit_state%unbounded
      if (search%below_limit) return
      call find_limit(graph, dead, live, tolerance, side%limit%limit_load_t)
      side%limit%known = side%limit%state == limit_state%found
      if (side%limit%state == limit_state%no_dead_equilibrium) side%beyond = dead
      if (.not. side%limit%known) return
      side%beyond = dead + (1.0_wp + nudge)*side%limit%upper*live
      side%limit%value = sign(1.0_wp, last)*[side%limit%lower, side%limit%upper]
      side%limit%live = live
      if (load /= searched_load%tilt) return
      ! gravity that tilts is as large as before
      side%limit%value = atan(side%limit%value)
      side%limit%force = cos(side%limit%value(1))*side%limit%force
      side%beyond = cos(side%limit%value(1))*side%beyond
   end subroutine find_associated

   !> Take the associated limit as the answer
   pure subroutine take_associated(last, search, side)
      real(wp), intent(in) :: last  !! End of the range, from where the limit is counted
      type(search_t), intent(in) :: search
      type(side_t), intent(inout) :: side

      associate (proof => side%proof, limit => side%limit)
         proof%flow = flow_rule%associated
         side%end = path_end%collapsed
         side%reach = [huge(1.0_wp), -huge(1.0_wp)]
         side%value = 0.5_wp*sum(limit%value)
         side%half = max(0.5_wp*abs(limit%value(2) - limit%value(1)), &
            & 4.0_wp*epsilon(1.0_wp)*abs(side%value), &
            & 0.5_wp*min(search%tolerance, path_resolution)*abs(side%value))
         ! a limit that may be nothing is nothing
         if (product(limit%value) <= 0.0_wp) then
            side%value = 0.0_wp
            side%half = maxval(abs(limit%value))
         end if
         select case (limit%state)
         case (limit_state%found, limit_state%no_dead_equilibrium)
            proof%mechanism = limit%velocity
            proof%is_told = limit%state == limit_state%found
         case (limit_state%unbounded)
            side%end = path_end%reached
         case default
            side%end = path_end%undecided
         end select
         if (limit%state == limit_state%found .and. abs(side%value) > abs(last)) &
            & side%end = path_end%reached
         if (side%end == path_end%reached) side%value = last
         proof%end = side%end
         proof%force = limit%force
         ! the path has left this state before the limit
         if (allocated(proof%state)) deallocate (proof%state)
      end associate
   end subroutine take_associated

   !> Verdict of the range. If it collapses on both sides, the critical value is that to the right,
   !> and the other one is reported beside it
   pure subroutine conclude(search, low, high, scene, right, left, critical)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: low, high  !! Ends of the range, from where it does nothing
      type(scene_t), intent(in) :: scene
      type(side_t), intent(in) :: right, left
      type(critical_t), intent(inout) :: critical
      logical :: falls_left, falls_right, falls_at_once

      if (allocated(right%proof%jump) .and. right%proof%share > 0.0_wp) &
         & critical%jump = right%proof%jump/right%proof%share
      falls_right = right%end == path_end%collapsed
      falls_left = left%end == path_end%collapsed
      ! where forces balance what acts without the coefficient, it stands there
      falls_at_once = falls_left .and. .not. right%value > left%value &
         & .and. (right%falls_dead .or. left%falls_dead)
      if (.not. right%value - right%half > low) falls_at_once = falls_at_once .or. &
         & abs(low) > 0.0_wp .or. right%falls_dead
      if (right%end == path_end%undecided) then
         call keep_limit(search, low, high, right, critical)
         critical%reason = right%proof%reason
      else if (left%end == path_end%undecided) then
         call keep_limit(search, low, high, left, critical)
         critical%reason = left%proof%reason
      else if (falls_right .and. falls_at_once) then
         ! at the lower end, or where the coefficient does nothing
         critical%verdict = verdict%collapsed
         critical%falls = search%low + max(0.0_wp, right%value - right%half - low) &
            & *(search%high - search%low)/(high - low)
         call keep_collapse(scene, right, critical)
         if (right%proof%n_jump > 0) call keep_limit(search, low, high, right, critical)
      else if (falls_left .and. .not. left%value + left%half < high) then
         critical%verdict = verdict%collapsed
         critical%falls = search%high
         call keep_collapse(scene, left, critical)
      else if (falls_right) then
         call keep_bracket(search, low, high, scene, right, 1.0_wp, critical)
         critical%has_other = falls_left
         critical%other = search%low + (left%value - low)*(search%high - search%low)/(high - low)
      else if (falls_left) then
         call keep_bracket(search, low, high, scene, left, -1.0_wp, critical)
      else
         critical%verdict = verdict%stable
         critical%stands = merge(search%high, search%low, high > 0.0_wp)
         allocate (critical%standing)
         if (high > 0.0_wp) call record_rest(scene, right%proof, critical%standing)
         if (.not. high > 0.0_wp) call record_rest(scene, left%proof, critical%standing)
         call shed(critical%standing, keeps_joints=.false.)
      end if
   end subroutine conclude

   !> The bracket about the value at which it falls to one side
   pure subroutine keep_bracket(search, low, high, scene, side, outward, critical)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: low, high
      type(scene_t), intent(in) :: scene
      type(side_t), intent(in) :: side
      real(wp), intent(in) :: outward
      type(critical_t), intent(inout) :: critical
      real(wp) :: scale

      scale = (search%high - search%low)/(high - low)
      critical%verdict = verdict%found
      critical%half = side%half*scale
      if (side%reach(1) <= side%reach(2)) critical%reach = search%low + (side%reach - low)*scale
      critical%falls = search%low + (side%value + outward*side%half - low)*scale
      critical%stands = search%low + (side%value - outward*side%half - low)*scale
      critical%stop = search%low + (side%value - low)*scale
      critical%stops = .true.
      call keep_collapse(scene, side, critical)
      allocate (critical%standing)
      call record_rest(scene, side%proof, critical%standing)
      call shed(critical%standing, keeps_joints=.false.)
      call keep_limit(search, low, high, side, critical)
   end subroutine keep_bracket

   !> Keep the associated limit of a side, and how far its path was followed
   pure subroutine keep_limit(search, low, high, side, critical)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: low, high
      type(side_t), intent(in) :: side
      type(critical_t), intent(inout) :: critical
      real(wp) :: scale

      scale = (search%high - search%low)/(high - low)
      critical%undecided_at = search%low + (side%value - low)*scale
      critical%limit = side%limit
      critical%limit%value = search%low + (side%limit%value - low)*scale
      critical%jumps = side%proof%n_jump
      critical%largest_jump = side%proof%largest_jump
   end subroutine keep_limit

   !> Keep how it falls
   pure subroutine keep_collapse(scene, side, critical)
      type(scene_t), intent(in) :: scene
      type(side_t), intent(in) :: side
      type(critical_t), intent(inout) :: critical

      allocate (critical%fallen)
      call record_collapse(scene, side%proof, critical%fallen)
      call shed(critical%fallen, keeps_joints=.false.)
   end subroutine keep_collapse

end submodule dda_load_search
