!> Verdict of rigid blocks in reference geometry, with its certificate
!>
!> A load that no forces balance collapses under every law of friction. Limit analysis decides that
!> first, by forces or by a mechanism. The rest is decided by the loading path of Coulomb friction:
!> dead loads at once, then live loads, from event to event, with the slip so far. The first load
!> at which the blocks fall is the collapse, and all beyond it is collapsed. Joints that break have
!> no limit analysis: the path alone decides.
module dda_graph_decision
   use dda_block_system, only : block_system_t
   use dda_boundary, only : value_at
   use dda_contacts, only : contacts_t
   use dda_coulomb_law, only : coulomb_state_t
   use dda_first_fall, only : find_coulomb_fall, find_first_motion
   use dda_joint_graph, only : breaks, crushes, joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, decide_on_way, load_decision_t, load_state
   use dda_load_stations, only : last_history_time, load_stations, load_stations_t, loads_at
   use dda_path_event, only : path_end
   use dda_path_verdict, only : follow_stations
   use dda_scene_graph, only : graph_verdict_t, has_friction, scene_graph
   use dda_settings, only : factor_of, flow_rule, settings_t
   implicit none
   private

   public :: decide_graph, no_start, see_fall, slide_along

   !> Why a path is undecided that limit analysis lets stand at its end
   character(len=*), parameter :: no_start = "no state under Coulomb friction is found under the " &
      & //"initial loads"
   !> Relative gap of both bounds of a limit with its mechanism
   real(wp), parameter :: limit_gap = 1.0e-9_wp
   !> Share of the largest power beside which accelerations are too small for a direction
   real(wp), parameter :: slow = 1.0e-4_wp
   !> Factorisations for sliding at collapse, and for the whole collapse under live loads
   integer, parameter :: few = 5, most = 30
   !> Factorisations after which no first mechanism is sought
   integer, parameter :: enough = most - few - 2

contains

   !> Decide a scene
   pure subroutine decide_graph(settings, system, contacts, bare, verdict, start)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> True if the verdict is enough: the way in which it falls is the mechanism of limit analysis
      logical, intent(in) :: bare
      type(graph_verdict_t), intent(out) :: verdict
      !> State in which a stage before has left these joints, with its load; else they are unloaded
      type(coulomb_state_t), intent(in), optional :: start
      type(joint_graph_t) :: graph
      type(load_stations_t) :: stations
      type(graph_verdict_t) :: path
      logical :: dead_alone

      call scene_graph(settings, system, contacts, graph)
      if (breaks(graph)) then
         call follow_breaking(settings, system, contacts, graph, verdict)
         return
      end if
      stations = stations_of(settings, system, graph, present(start))
      call decide_by_limit(settings, system, graph, stations, bare, verdict)
      ! the joints of an earlier stage are not those of a proof
      if (present(start) .and. allocated(verdict%limit)) deallocate (verdict%limit)
      if (verdict%end == path_end%collapsed) return
      dead_alone = ubound(stations%tilt, 1) == 0 .and. .not. present(start)
      verdict%on_path = verdict%end == path_end%reached .and. .not. dead_alone
      ! what blocks that are built carry is known of the path alone
      if (settings%verdict_flow == flow_rule%associated .or. .not. (has_friction(graph) &
         & .or. allocated(settings%boundary%change))) return
      if (verdict%end /= path_end%reached .and. dead_alone) return
      ! the path has forces of its own
      if (allocated(verdict%force)) deallocate (verdict%force)
      call follow_stations(settings, system, graph, stations, path, start)
      path%n_factorisation = path%n_factorisation + verdict%n_factorisation
      path%unproven = verdict%unproven .or. dead_alone
      if (path%no_start .and. .not. dead_alone) call see_dead_fall(settings, system, contacts, &
         & stations, path)
      if (path%no_start .and. (dead_alone .or. verdict%end == path_end%reached)) then
         path%end = path_end%undecided
         path%reason = no_start
      end if
      path%no_start = path%no_start .and. verdict%end == path_end%reached
      call move_alloc(verdict%limit, path%limit)
      verdict = path
   end subroutine decide_graph

   !> Decide the full load by limit analysis, with the mechanism of a collapse
   pure subroutine decide_by_limit(settings, system, graph, stations, bare, verdict)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      type(load_stations_t), intent(in) :: stations
      logical, intent(in) :: bare
      type(graph_verdict_t), intent(inout) :: verdict
      type(load_decision_t) :: decision
      real(wp) :: load(3, graph%n_block)
      logical :: is_slow, on_way

      call loads_at(stations, ubound(stations%tilt, 1), settings, system, graph, load)
      call decide_full(settings, system, graph, stations, load, bare, decision, on_way)
      verdict%n_factorisation = decision%n_factorisation
      if (.not. bare) allocate (verdict%limit, source=decision)
      verdict%power_share = power_share(settings, system, decision)
      if (is_feigned(settings, system, decision)) decision%state = load_state%undecided
      if (decision%state == load_state%falls) then
         verdict%end = path_end%collapsed
         verdict%is_told = .true.
         verdict%mechanism = decision%velocity
         verdict%force = decision%force
         if (bare) return
         ! a run of steps has the forces of bars
         is_slow = verdict%power_share < slow .and. .not. allocated(settings%boundary%bar)
         if (.not. (on_way .or. is_slow)) then
            call see_fall(settings, graph, load, verdict)
         else if (verdict%n_factorisation + few <= most) then
            call slide_along(settings, graph, load, decision%force, verdict)
         end if
      else if (decision%state == load_state%stands) then
         verdict%end = path_end%reached
         call move_alloc(decision%force, verdict%force)
      else
         verdict%reason = "limit analysis proves neither equilibrium nor collapse beyond round-off"
         verdict%unproven = .true.
      end if
   end subroutine decide_by_limit

   !> Follow joints that break: they have no limit analysis, so that the path alone decides.
   !> Gravity acts as it is where it points upwards, as on what hangs, or where the blocks fall
   !> upright
   pure subroutine follow_breaking(settings, system, contacts, graph, verdict)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(joint_graph_t), intent(inout) :: graph  !! Its joints; the path moves them
      type(graph_verdict_t), intent(out) :: verdict

      logical :: upright

      upright = cos(settings%tilt) > 0.0_wp
      call follow_stations(settings, system, graph, load_stations(settings, upright), verdict)
      if (verdict%no_start .and. upright .and. abs(settings%tilt) > 0.0_wp) then
         call scene_graph(settings, system, contacts, graph)
         call follow_stations(settings, system, graph, load_stations(settings, .false.), verdict)
      end if
      verdict%no_start = .false.
      verdict%is_told = .true.
      verdict%unproven = verdict%end == path_end%undecided
   end subroutine follow_breaking

   !> Blocks that fall by their dead loads fall before what is live could hold them
   pure subroutine see_dead_fall(settings, system, contacts, stations, path)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(load_stations_t), intent(in) :: stations
      !> A path that finds no state under the dead loads
      type(graph_verdict_t), intent(inout) :: path
      type(joint_graph_t) :: graph
      type(load_decision_t) :: decision
      real(wp), allocatable :: dead(:, :)

      call scene_graph(settings, system, contacts, graph)
      allocate (dead(3, graph%n_block))
      call loads_at(stations, 0, settings, system, graph, dead)
      call decide_load(graph, dead, decision)
      path%n_factorisation = path%n_factorisation + decision%n_factorisation
      if (decision%state /= load_state%falls .or. is_feigned(settings, system, decision)) return
      path%no_start = .false.
      if (path%end == path_end%collapsed) return
      path%end = path_end%collapsed
      path%mechanism = decision%velocity
      if (allocated(path%reason)) deallocate (path%reason)
   end subroutine see_dead_fall

   !> The stations of the loads. Gravity that tilts is upright at first where the blocks stand then,
   !> for others were drawn for gravity as it is; the associated rule has no order of loads
   pure type(load_stations_t) function stations_of(settings, system, graph, goes_on)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      logical, intent(in) :: goes_on  !! True if a stage before has left a state
      type(load_decision_t) :: decision
      real(wp) :: load(3, graph%n_block)
      logical :: coulomb

      coulomb = settings%verdict_flow == flow_rule%coulomb
      stations_of = load_stations(settings, coulomb)
      if (goes_on .or. .not. (coulomb .and. abs(settings%tilt) > 0.0_wp)) return
      call loads_at(stations_of, 0, settings, system, graph, load)
      call decide_load(graph, load, decision)
      stations_of = load_stations(settings, decision%state /= load_state%falls)
   end function stations_of

   !> Decide the full load: on the way from the dead load out of which it grows, unless it is not
   !> asked how it falls
   pure subroutine decide_full(settings, system, graph, stations, load, bare, decision, on_way)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      type(load_stations_t), intent(in) :: stations   !! Stations of the loading path
      real(wp), intent(in) :: load(:, :)              !! The full load: (3, n_block)
      logical, intent(in) :: bare                     !! True if it is not asked how it falls
      type(load_decision_t), intent(out) :: decision  !! The decision; its factorisations are all
      !> True if it was decided on the way, so that what falls is in the mechanism in which it fell
      !> first
      logical, intent(out) :: on_way
      real(wp) :: dead(3, graph%n_block)
      integer :: n

      n = 0
      on_way = .not. bare .and. ubound(stations%tilt, 1) > 0 .and. .not. crushes(graph)
      if (on_way) then
         call loads_at(stations, 0, settings, system, graph, dead)
         call decide_on_way(graph, dead, load, limit_gap, enough, decision)
         on_way = decision%state /= load_state%undecided
         if (on_way) return
         n = decision%n_factorisation
      end if
      call decide_load(graph, load, decision)
      decision%n_factorisation = decision%n_factorisation + n
   end subroutine decide_full

   !> True if a collapse has no more power than rounded coordinates make
   pure logical function is_feigned(settings, system, decision)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(load_decision_t), intent(in) :: decision

      is_feigned = decision%state == load_state%falls &
         & .and. .not. power_share(settings, system, decision) > settings%rest_tolerance
   end function is_feigned

   !> Power of the load on the mechanism of a collapse over what the loads could do at most, 0
   !> without a collapse
   pure real(wp) function power_share(settings, system, decision)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(load_decision_t), intent(in) :: decision

      power_share = 0.0_wp
      if (decision%state == load_state%falls .and. decision%power > 0.0_wp) power_share &
         & = decision%power/max(power_of_all(settings, system, decision%velocity), &
         & tiny(1.0_wp))
   end function power_share

   !> Largest power of all weights and forces, each along the motion. Rounded coordinates make a
   !> small share of it
   pure real(wp) function power_of_all(settings, system, velocity) result(power)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: velocity(:, :)  !! Velocities of the blocks: (3, n_block)
      real(wp) :: force(size(system%equation)), gyration
      integer :: b, e, i

      force = system%unit_weight*system%area
      if (allocated(settings%boundary%loaded)) then
         do i = 1, size(settings%boundary%loaded)
            associate (loaded => settings%boundary%loaded(i))
               b = loaded%block
               force(b) = force(b) + norm2(factor_of(settings, loaded) &
                  & *value_at(loaded%force, last_history_time(settings)))
            end associate
         end do
      end if
      power = 0.0_wp
      do b = 1, size(force)
         e = system%equation(b)
         if (e == 0) cycle
         gyration = sqrt((system%second(1, b) + system%second(2, b))/system%area(b))
         power = power + force(b)*(norm2(velocity(1:2, e)) + gyration*abs(velocity(3, e)))
      end do
   end function power_of_all

   !> Mechanism in which blocks begin to fall from rest
   pure subroutine see_fall(settings, graph, load, verdict)
      type(settings_t), intent(in) :: settings
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      type(graph_verdict_t), intent(inout) :: verdict
      real(wp) :: force(3, size(graph%kind)), motion(3, graph%n_block)
      integer :: n

      ! accelerations do not depend on strength: the mechanism is that of limit analysis
      verdict%is_told = crushes(graph)
      if (verdict%is_told) return
      call find_first_motion(graph, load, motion, force, verdict%is_told, n)
      verdict%n_factorisation = verdict%n_factorisation + n
      if (.not. verdict%is_told) return
      verdict%mechanism = motion
      verdict%force = force
      call slide_along(settings, graph, load, force, verdict)
   end subroutine see_fall

   !> Under Coulomb friction joints slide along themselves. Where that takes more than a few
   !> factorisations, or joints are crushed, it falls as limit analysis has it
   pure subroutine slide_along(settings, graph, load, force, verdict)
      type(settings_t), intent(in) :: settings
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: force(:, :)  !! Forces of limit analysis: (3, n_joint)
      !> A collapse; its mechanism and forces are set where one is found
      type(graph_verdict_t), intent(inout) :: verdict
      real(wp) :: falling(3, size(graph%kind))
      integer :: n
      logical :: found

      if (settings%verdict_flow == flow_rule%associated .or. .not. has_friction(graph) &
         & .or. crushes(graph)) return
      falling = force
      call find_coulomb_fall(graph, load, falling, few, verdict%mechanism, found, n)
      verdict%n_factorisation = verdict%n_factorisation + n
      if (.not. found) return
      verdict%flow = flow_rule%coulomb
      verdict%fall_force = falling
   end subroutine slide_along
end module dda_graph_decision
