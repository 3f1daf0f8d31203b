!> Verdict of the loading path of a scene under Coulomb friction, with its certificate
module dda_path_verdict
   use dda_block_system, only : block_system_t
   use dda_coulomb_law, only : coulomb_state_t
   use dda_joint_graph, only : joint_graph_t, take_over
   use dda_kinds, only : wp
   use dda_load_stations, only : load_stations_t, loads_at
   use dda_loading_path, only : apply_dead_load, follow_path, loading_path_t, new_path, &
      & path_rate_t, path_reason, path_result_t
   use dda_path_event, only : path_end
   use dda_scene_graph, only : graph_verdict_t
   use dda_settings, only : flow_rule, settings_t
   implicit none
   private

   public :: follow_stations

contains

   !> Follow the loading path from its dead loads to its end or its collapse
   pure subroutine follow_stations(settings, system, graph, stations, verdict, start)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> The joints, without rows afterwards: the path takes them over
      type(joint_graph_t), intent(inout) :: graph
      type(load_stations_t), intent(in) :: stations
      type(graph_verdict_t), intent(out) :: verdict
      !> State that a stage before has left, with the load that it balances; the path begins there
      type(coulomb_state_t), intent(in), optional :: start
      type(joint_graph_t) :: taken
      type(loading_path_t) :: path
      type(coulomb_state_t) :: state
      type(path_rate_t) :: rate
      type(path_result_t) :: result
      integer :: i, n

      verdict%flow = flow_rule%coulomb
      n = ubound(stations%tilt, 1)
      verdict%on_path = n > 0
      allocate (rate%load(3, graph%n_block))
      call loads_at(stations, 0, settings, system, graph, rate%load)
      call take_over(graph, taken)
      call new_path(taken, rate%load, path)
      if (present(start)) then
         ! a removed block releases its neighbours, and a new one gets its weight
         state = start
         rate%load = rate%load - state%load
         call follow_path(path, state, rate, 1.0_wp, result)
         verdict%on_path = .true.
      else
         call apply_dead_load(rate%load, path, state, result)
      end if
      if (allocated(settings%boundary%held)) allocate (rate%opening(3, size(graph%kind)))
      call count_up(result, verdict)
      verdict%no_start = result%end /= path_end%reached .and. .not. present(start)
      do i = 1, n
         if (result%end /= path_end%reached) exit
         call see_leg(stations, i, settings, system, graph, rate)
         call follow_path(path, state, rate, 1.0_wp, result)
         call count_up(result, verdict)
         verdict%station = i - 1
         ! joints that crush bear more than where the last step ends
         verdict%share = min(1.0_wp, result%reached + result%rest)
         verdict%jump = result%jump
         verdict%reach = result%reached + [-result%spread, result%spread]
         ! until it jumps the path goes one way
         if (verdict%n_jump == size(result%jump)) verdict%reach(1) = max(verdict%reach(1), &
            & minval([result%reached, result%jump]))
         verdict%reach = max(0.0_wp, verdict%reach + [0.0_wp, 2.0_wp*result%rest])
      end do
      verdict%state = state
      call conclude(result, verdict)
   end subroutine follow_stations

   !> Growth from one station to the next
   pure subroutine see_leg(stations, station, settings, system, graph, rate)
      type(load_stations_t), intent(in) :: stations
      integer, intent(in) :: station  !! Number of the later one
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      type(path_rate_t), intent(inout) :: rate  !! With room for the load, and for openings if any
      type(path_rate_t) :: before

      before = rate
      call loads_at(stations, station - 1, settings, system, graph, before%load, before%opening)
      call loads_at(stations, station, settings, system, graph, rate%load, rate%opening)
      rate%load = rate%load - before%load
      if (allocated(rate%opening)) rate%opening = rate%opening - before%opening
   end subroutine see_leg

   !> End of a path
   pure subroutine conclude(result, verdict)
      type(path_result_t), intent(inout) :: result  !! End of its last leg
      type(graph_verdict_t), intent(inout) :: verdict

      verdict%end = result%end
      if (result%end == path_end%collapsed) then
         call move_alloc(result%mechanism, verdict%mechanism)
      else if (result%end == path_end%undecided .and. result%reason == path_reason%too_many) then
         verdict%reason = "the loading path has too many jumps"
      else if (result%end == path_end%undecided .and. result%reason == path_reason%too_costly) then
         verdict%reason = "the loading path takes too many factorisations"
      else if (result%end == path_end%undecided .and. result%reason == path_reason%no_balance) then
         verdict%reason = "forces at the end of the loading path do not balance or break a law"
      else if (result%end == path_end%undecided) then
         verdict%reason = "a jump on the loading path does not converge"
      end if
   end subroutine conclude

   !> Add what one leg took
   pure subroutine count_up(result, verdict)
      type(path_result_t), intent(in) :: result
      type(graph_verdict_t), intent(inout) :: verdict

      verdict%n_event = verdict%n_event + result%n_event
      verdict%n_jump = verdict%n_jump + size(result%jump)
      verdict%largest_jump = max(verdict%largest_jump, result%largest_jump)
      verdict%n_factorisation = verdict%n_factorisation + result%n_factorisation
   end subroutine count_up
end module dda_path_verdict
