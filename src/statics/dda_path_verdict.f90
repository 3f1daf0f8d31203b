!> Verdict of the loading path of a scene under Coulomb friction, with its certificate
!>
!> Where joints are crushed the path is followed with tangents of their parabolas as layers, which
!> are added where the forces at its end lie beyond, until they do not: the hinge of a layer is a
!> corner that has moved inwards by half the strip that bears the force.
module dda_path_verdict
   use dda_block_system, only : block_system_t
   use dda_coulomb_law, only : coulomb_state_t
   use dda_joint_graph, only : crushes, joint_graph_t, take_over
   use dda_joint_layers, only : add_layers, joint_layers_t, no_layers, touch_parabola
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

   !> Violation of the crushing parabola, over the largest force
   real(wp), parameter :: beyond = 1.0e-9_wp
   !> Maximum number of paths, and of their factorisations
   integer, parameter :: most_paths = 30, most_factorisations = 6000

contains

   !> Follow the loading path from its dead loads to its end or its collapse
   pure subroutine follow_stations(settings, system, graph, stations, verdict, start)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> The joints, without rows afterwards unless they crush: the path takes them over
      type(joint_graph_t), intent(inout) :: graph
      type(load_stations_t), intent(in) :: stations
      type(graph_verdict_t), intent(out) :: verdict
      !> State that a stage before has left, with the load that it balances; the path begins there.
      !> Joints that crush begin unloaded
      type(coulomb_state_t), intent(in), optional :: start
      type(joint_graph_t) :: layered
      type(joint_layers_t) :: layers
      real(wp), allocatable :: couple(:, :)
      integer :: k, n_factorisation
      logical :: touched

      if (.not. crushes(graph)) then
         call take_over(graph, layered)
         call follow_joints(settings, system, graph, layered, couple, stations, verdict, start)
         return
      end if
      layers = no_layers()
      n_factorisation = 0
      do k = 1, most_paths
         call add_layers(graph, layers, layered, couple)
         call follow_joints(settings, system, graph, layered, couple, stations, verdict)
         n_factorisation = n_factorisation + verdict%n_factorisation
         call touch_parabola(graph, verdict%state%force(:, :size(graph%kind)), &
            & beyond*maxval(abs(verdict%state%force(1:2, :))), layers, touched)
         if (.not. touched .or. n_factorisation > most_factorisations) exit
      end do
      verdict%n_factorisation = n_factorisation
      call take_layers_away(graph, verdict)
      if (.not. touched) return
      verdict%end = path_end%undecided
      verdict%reason = "the bearing strips of crushing joints do not converge"
   end subroutine follow_stations

   !> Loads and openings at a station, of layers too
   pure subroutine load_joints(stations, station, settings, system, graph, couple, load, opening)
      type(load_stations_t), intent(in) :: stations
      !> Number of the station
      integer, intent(in) :: station
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> Their joints without layers
      type(joint_graph_t), intent(in) :: graph
      !> Loads by the couples of the layers: (3, n_block of layered)
      real(wp), intent(in), optional :: couple(:, :)
      !> Loads: (3, n_block of layered) [N/m, N/m, N]
      real(wp), intent(out) :: load(:, :)
      !> Openings: (3, n_joint of layered) [m]
      real(wp), intent(out), optional :: opening(:, :)

      associate (b => graph%n_block, n => size(graph%kind))
         if (present(opening)) then
            opening = 0.0_wp
            call loads_at(stations, station, settings, system, graph, load(:, :b), opening(:, :n))
         else
            call loads_at(stations, station, settings, system, graph, load(:, :b))
         end if
         if (.not. present(couple)) return
         load(:, :b) = load(:, :b) + couple(:, :b)
         load(:, b + 1:) = couple(:, b + 1:)
      end associate
   end subroutine load_joints

   !> Growth from one station to the next
   pure subroutine see_leg(stations, station, settings, system, graph, couple, rate)
      type(load_stations_t), intent(in) :: stations
      integer, intent(in) :: station
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in), optional :: couple(:, :)
      type(path_rate_t), intent(inout) :: rate  !! With room for the load, and for openings if any
      type(path_rate_t) :: before

      before = rate
      call load_joints(stations, station - 1, settings, system, graph, couple, before%load, &
         & before%opening)
      call load_joints(stations, station, settings, system, graph, couple, rate%load, rate%opening)
      rate%load = rate%load - before%load
      if (allocated(rate%opening)) rate%opening = rate%opening - before%opening
   end subroutine see_leg

   !> Leave joints and blocks alone of those with layers
   pure subroutine take_layers_away(graph, verdict)
      type(joint_graph_t), intent(in) :: graph
      type(graph_verdict_t), intent(inout) :: verdict

      associate (state => verdict%state, b => graph%n_block, n => size(graph%kind))
         state%motion = state%motion(:, :b)
         state%load = state%load(:, :b)
         state%force = state%force(:, :n)
         state%gap = state%gap(:, :n)
         state%slip = state%slip(:n)
         state%face = state%face(:, :n)
         if (allocated(verdict%mechanism)) &
            & verdict%mechanism = verdict%mechanism(:, :min(b, size(verdict%mechanism, 2)))
      end associate
   end subroutine take_layers_away

   !> Follow the path of joints some of which may have layers
   pure subroutine follow_joints(settings, system, graph, layered, couple, stations, verdict, start)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      !> The joints with their layers; the path takes them over
      type(joint_graph_t), intent(inout) :: layered
      real(wp), intent(in), optional :: couple(:, :)
      type(load_stations_t), intent(in) :: stations
      type(graph_verdict_t), intent(out) :: verdict
      type(coulomb_state_t), intent(in), optional :: start
      type(loading_path_t) :: path
      type(coulomb_state_t) :: state
      type(path_rate_t) :: rate
      type(path_result_t) :: result
      integer :: i, n

      verdict%flow = flow_rule%coulomb
      n = ubound(stations%tilt, 1)
      verdict%on_path = n > 0
      allocate (rate%load(3, layered%n_block))
      call load_joints(stations, 0, settings, system, graph, couple, rate%load)
      call new_path(layered, rate%load, path)
      if (present(start)) then
         ! a removed block releases its neighbours, and a new one gets its weight
         state = start
         rate%load = rate%load - state%load
         call follow_path(path, state, rate, 1.0_wp, result)
         verdict%on_path = .true.
      else
         call apply_dead_load(rate%load, path, state, result)
      end if
      if (allocated(settings%boundary%held)) allocate (rate%opening(3, size(layered%kind)))
      ! the path has their laws
      deallocate (layered%kind)
      call count_up(result, verdict)
      verdict%no_start = result%end /= path_end%reached .and. .not. present(start)
      do i = 1, n
         if (result%end /= path_end%reached) exit
         call see_leg(stations, i, settings, system, graph, couple, rate)
         call follow_path(path, state, rate, 1.0_wp, result)
         call count_up(result, verdict)
         verdict%station = i - 1
         verdict%share = result%reached
         verdict%jump = result%jump
      end do
      verdict%state = state
      call conclude(result, verdict)
   end subroutine follow_joints

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
