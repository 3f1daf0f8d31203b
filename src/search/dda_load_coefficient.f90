!> A load coefficient on the loading path: its value, scenes with other values, and its value at
!> the end
!>
!> It is measured from where it does nothing: the horizontal coefficient or the load factor itself,
!> or the angle of gravity from upright.
module dda_load_coefficient
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_load_stations, only : bears_live_load, last_history_time, load_stations, &
      & load_stations_t, loads_at, only_weight
   use dda_path_event, only : path_end
   use dda_scene, only : scene_t, searched_load
   use dda_scene_graph, only : decides_as_graph, graph_verdict_t, has_friction
   use dda_search, only : limit_t
   use dda_settings, only : flow_rule, full_push, settings_t
   implicit none
   private

   public :: added_loads, can_follow, carry_load, coefficient, full_loads
   public :: is_push, knows_no_order, may_seek, restore_weight, seek_rest, value_at_end
   public :: values_between, with_coefficient

   !> Coefficient beside which round-off of constant loads is negligible
   real(wp), parameter :: many = 2.0_wp**40

contains

   !> True if the coefficient comes last on a path that the joint graph can follow
   pure logical function can_follow(load, scene, largest)
      integer, intent(in) :: load         !! One of searched_load
      type(scene_t), intent(in) :: scene  !! The scene at the high end
      real(wp), intent(in) :: largest     !! Largest size of the coefficient in the range

      type(settings_t) :: dead_push

      associate (settings => scene%settings)
         dead_push = settings
         dead_push%push = full_push(settings)
         dead_push%live_push = .false.
         can_follow = decides_as_graph(settings, scene%contacts) &
            & .and. .not. last_history_time(settings) > 0.0_wp
         ! under the associated rule the order of the loads does not matter
         if (load /= searched_load%factor .and. bears_live_load(dead_push)) &
            & can_follow = can_follow .and. settings%verdict_flow == flow_rule%associated
         if (load == searched_load%tilt) can_follow = can_follow &
            & .and. .not. abs(settings%push) > 0.0_wp &
            & .and. (settings%verdict_flow == flow_rule%coulomb .or. only_weight(settings) &
            & .and. is_push(largest))
      end associate
   end function can_follow

   !> True if the order in which loads come is nothing to a scene
   pure logical function knows_no_order(settings, graph)
      type(settings_t), intent(in) :: settings
      type(joint_graph_t), intent(in) :: graph

      knows_no_order = settings%verdict_flow == flow_rule%associated .or. .not. has_friction(graph)
   end function knows_no_order

   !> True if limit analysis can rule values out, whatever leads to them: under Coulomb friction
   !> live loads come later than dead ones that fall, but gravity acts as it is
   pure logical function may_seek(load, scene, no_order, width)
      integer, intent(in) :: load
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: no_order  !! True if the order in which loads come is nothing to it
      real(wp), intent(in) :: width    !! Width of the range

      may_seek = no_order
      if (load == searched_load%tilt) may_seek = only_weight(scene%settings) &
         & .and. width <= acos(-1.0_wp)
   end function may_seek

   !> True if gravity at this angle is upright gravity and a push, up to its magnitude
   pure logical function is_push(tilt)
      real(wp), intent(in) :: tilt  !! The angle from upright [rad]

      is_push = cos(tilt) > 1.0e-6_wp .and. abs(tilt) < 2.0_wp
   end function is_push

   !> Value of the parameter, relative to the one without effect
   pure real(wp) function coefficient(load, settings)
      integer, intent(in) :: load
      type(settings_t), intent(in) :: settings

      coefficient = settings%load_factor
      if (load == searched_load%push) coefficient = full_push(settings)
      if (load == searched_load%tilt) coefficient = settings%tilt
   end function coefficient

   !> Settings with another value of what is searched
   pure type(settings_t) function with_coefficient(settings, load, value) result(other)
      type(settings_t), intent(in) :: settings
      integer, intent(in) :: load
      real(wp), intent(in) :: value  !! The value

      other = settings
      select case (load)
      case (searched_load%tilt)
         other%tilt = value
      case (searched_load%push)
         other%push = value
         other%live_push = .false.
      case (searched_load%factor)
         other%load_factor = value
      end select
   end function with_coefficient

   !> Loads at the end of the loading path
   pure function full_loads(settings, scene, graph) result(load)
      type(settings_t), intent(in) :: settings  !! Settings of the run, without histories
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      real(wp) :: load(3, graph%n_block)        !! The loads: (3, n_block) [N/m, N/m, N]
      type(load_stations_t) :: stations

      stations = load_stations(settings, .true.)
      call loads_at(stations, ubound(stations%tilt, 1), settings, scene%system, graph, load)
   end function full_loads

   !> Forces that carry the loads at a value that stands; those that carry a limit do not carry less
   pure subroutine carry_load(load, value, scene, graph, proof)
      integer, intent(in) :: load
      real(wp), intent(in) :: value
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      !> The verdict there; one that stands without a path gets its forces, none where none are
      !> found
      type(graph_verdict_t), intent(inout) :: proof
      type(load_decision_t) :: decision

      if (proof%end /= path_end%reached .or. allocated(proof%state)) return
      if (allocated(proof%force)) deallocate (proof%force)
      call decide_load(graph, full_loads(with_coefficient(scene%settings, load, value), scene, &
         & graph), decision)
      if (decision%state == load_state%stands) call move_alloc(decision%force, proof%force)
   end subroutine carry_load

   !> Loads added by a coefficient of one; for tilting gravity, their initial rate with its angle
   pure function added_loads(load, settings, scene, graph, value) result(live)
      integer, intent(in) :: load
      type(settings_t), intent(in) :: settings
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in), optional :: value  !! The angle that gravity has, of one that tilts
      real(wp) :: live(3, graph%n_block)       !! The loads: (3, n_block) [N/m, N/m, N]
      type(settings_t) :: none
      integer :: varied

      varied = merge(searched_load%push, load, load == searched_load%tilt)
      none = with_coefficient(settings, load, 0.0_wp)
      live = (full_loads(with_coefficient(none, varied, many), scene, graph) &
         & - full_loads(with_coefficient(none, varied, 0.0_wp), scene, graph))/many
      if (load /= searched_load%tilt .or. .not. present(value)) return
      live = cos(value)*live - sin(value)*full_loads(none, scene, graph)
   end function added_loads

   !> Value of what is searched at which a path ended, or at another share of its last leg
   pure real(wp) function value_at_end(load, far, stations, proof, share) result(value)
      integer, intent(in) :: load
      real(wp), intent(in) :: far                    !! Its value at the end of the path
      type(load_stations_t), intent(in) :: stations  !! Stations of the path
      type(graph_verdict_t), intent(in) :: proof
      real(wp), intent(in), optional :: share        !! The share
      real(wp) :: gravity(2), reached
      integer :: i

      i = proof%station
      reached = proof%share
      if (present(share)) reached = share
      value = 0.0_wp
      if (ubound(stations%tilt, 1) == 0) return
      associate (before => 1.0_wp - reached, after => reached)
         select case (load)
         case (searched_load%push)
            value = before*stations%push(i) + after*stations%push(i + 1)
         case (searched_load%factor)
            value = (before*stations%live(i) + after*stations%live(i + 1))*far
         case default
            gravity = gravity_on_leg(stations, i, reached)
            value = atan2(gravity(1), gravity(2))
         end select
      end associate
   end function value_at_end

   !> Values between which a path ends as its jumps may lead elsewhere and its joints crush, up to
   !> the associated limit
   pure function values_between(load, far, stations, proof, limit) result(value)
      integer, intent(in) :: load
      real(wp), intent(in) :: far                    !! Its value at the end of the path
      type(load_stations_t), intent(in) :: stations  !! Stations of the path
      type(graph_verdict_t), intent(in) :: proof
      type(limit_t), intent(in) :: limit             !! The associated limit
      real(wp) :: value(2)                           !! The least and the largest

      value = [value_at_end(load, far, stations, proof, proof%reach(1)), &
         & value_at_end(load, far, stations, proof, proof%reach(2))]
      if (limit%known .and. abs(value(2)) > abs(limit%value(2))) value(2) = limit%value(2)
      value = [minval(value), maxval(value)]
   end function values_between

   !> Gravity at a share of a leg, over that at the beginning of the path: to the right and down
   pure function gravity_on_leg(stations, station, share) result(gravity)
      type(load_stations_t), intent(in) :: stations
      integer, intent(in) :: station  !! Station where the leg begins
      real(wp), intent(in) :: share
      real(wp) :: gravity(2), part(2)

      associate (i => station)
         part = [1.0_wp - share, share]*stations%weight(i:i + 1)
         gravity = [sum(part*sin(stations%tilt(i:i + 1))), sum(part*cos(stations%tilt(i:i + 1)))]
      end associate
   end function gravity_on_leg

   !> Give blocks their whole weight where a path has ended on a chord between two directions of it
   pure subroutine restore_weight(stations, proof)
      type(load_stations_t), intent(in) :: stations
      !> Result of the path; its forces grow by a few millionths
      type(graph_verdict_t), intent(inout) :: proof
      real(wp) :: weight

      if (ubound(stations%tilt, 1) == 0) return
      weight = norm2(gravity_on_leg(stations, proof%station, proof%share))
      proof%state%force = proof%state%force/weight
      proof%state%load = proof%state%load/weight
   end subroutine restore_weight

   !> A value of the range that stands, where 0 does not. The mechanism of one that falls excludes
   !> all values at which the loads drive it: a half line, or half a turn of gravity. The rest of
   !> the range is searched until a value stands or nothing is left
   pure subroutine seek_rest(load, scene, graph, low, high, value, found, n_factorisation)
      integer, intent(in) :: load
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      !> The range; becomes what is not ruled out, nothing of it where high is no more than low
      real(wp), intent(inout) :: low, high
      real(wp), intent(out) :: value           !! The value, or the low end
      logical, intent(out) :: found            !! True if there is one
      integer, intent(out) :: n_factorisation  !! Factorisations
      integer, parameter :: most = 60
      type(load_decision_t) :: decision
      real(wp) :: ruled_out(2), first
      integer :: i

      first = low
      value = 0.0_wp
      n_factorisation = 0
      do i = 1, most
         call decide_load(graph, full_loads(with_coefficient(scene%settings, load, value), scene, &
            & graph), decision)
         n_factorisation = n_factorisation + decision%n_factorisation
         if (decision%state /= load_state%falls) exit
         ruled_out = driven_range(load, scene, graph, value, decision%velocity(:3, :))
         if (ruled_out(1) <= low) low = max(low, ruled_out(2))
         if (ruled_out(2) >= high) high = min(high, ruled_out(1))
         if (.not. high > low) exit
         value = 0.5_wp*(low + high)
      end do
      found = decision%state == load_state%stands
      if (.not. found) value = first
   end subroutine seek_rest

   !> Values at which the loads drive a mechanism that they drive at one of them
   pure function driven_range(load, scene, graph, value, velocity) result(range)
      integer, intent(in) :: load
      type(scene_t), intent(in) :: scene
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: value           !! The value
      real(wp), intent(in) :: velocity(:, :)  !! The mechanism: (3, n_block)
      real(wp) :: range(2)                    !! From and to
      real(wp), parameter :: quarter = acos(0.0_wp)
      real(wp) :: power, rate

      power = sum(full_loads(with_coefficient(scene%settings, load, value), scene, graph)*velocity)
      rate = sum(added_loads(load, scene%settings, scene, graph, value)*velocity)
      if (load == searched_load%tilt) then
         ! gravity drives it most in one direction, and up to a quarter to either side of that
         range = value + atan2(rate, power) + [-quarter, quarter]
      else
         range = [-huge(rate), huge(rate)]
         if (rate < 0.0_wp) range(2) = value - power/rate
         if (rate > 0.0_wp) range(1) = value - power/rate
      end if
   end function driven_range
end module dda_load_coefficient
