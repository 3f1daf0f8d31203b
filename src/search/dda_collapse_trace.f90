!> Where a collapse stops: the value from which on the loads can be carried
!>
!> The margin of limit analysis is negative where a structure falls, and a concave function of its
!> loads. The secant method finds where it is zero.
module dda_collapse_trace
   use dda_error, only : error_t
   use dda_joint_graph, only : breaks, crushes, joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : find_margin, resolution
   use dda_load_stations, only : load_stations, load_stations_t, loads_at
   use dda_scene, only : family_t, link_once, scene_t
   use dda_scene_graph, only : scene_graph
   use dda_search, only : critical_t, decision_t, search_t
   use dda_settings, only : flow_rule
   implicit none
   private

   public :: proposal_t, least_half, margin_at, trace, trace_chain

   !> Where a collapse stops
   type :: proposal_t
      logical :: usable = .false.  !! True if it stops anywhere
      real(wp) :: value = 0.0_wp   !! The value
      !> Half the width of the bracket to close around it: of the tolerance, or of what the rounded
      !> coordinates can tell apart
      real(wp) :: half = 0.0_wp
      !> How far beyond and before it to decide; more than half where the margin, which knows
      !> nothing of moving blocks, only comes near
      real(wp) :: reach = 0.0_wp
   end type proposal_t

   !> Share of the value by which moving blocks are first looked for beyond its margin's zero
   real(wp), parameter :: first_reach = 1.0e-3_wp
   !> Half a bracket is no narrower than this share of its value
   real(wp), parameter :: least_share = 4.0e-12_wp
   !> What each joint adds to that share
   real(wp), parameter :: share_of_joint = 2.0e-14_wp
   !> How far a sharp margin may be off over its unit: half the gap at which limit analysis ends
   real(wp), parameter :: least_margin = 0.5_wp*resolution
   !> How far a margin may be off over the one before it
   real(wp), parameter :: sharpness = 1.0e-3_wp
   !> Least and largest first step of the secant method over the value
   real(wp), parameter :: first_step(2) = [1.0e-3_wp, 0.3_wp]
   !> Most values of the secant method
   integer, parameter :: max_values = 30

   interface

      !> Trace a chain to where it ceases to collapse, by the secant method on the deficit of chains
      !> in which only some of its joints part
      pure module subroutine trace_chain(family, search, from, limit, frozen, critical, proposal)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         real(wp), intent(in) :: from     !! Where to begin
         real(wp), intent(in) :: limit    !! The end of the range on the side that stands
         !> True if the mechanism at the beginning is kept: all values before the one proposed then
         !> collapse
         logical, intent(in) :: frozen
         type(critical_t), intent(inout) :: critical
         type(proposal_t), intent(out) :: proposal
      end subroutine trace_chain

   end interface

contains

   !> Trace the last collapse to where it stops, by the secant method on the margin between it and
   !> the limit. A chain is traced by its deficit
   pure subroutine trace(family, search, limit, critical, proposal, by_tangent)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: limit  !! The end of the range on the side that stands
      type(critical_t), intent(inout) :: critical  !! What was found so far
      type(proposal_t), intent(out) :: proposal    !! Where the collapse stops
      !> True to end with the first secant, to exclude values: the secant method does not converge
      !> where a margin has no zero
      logical, intent(in), optional :: by_tangent
      real(wp) :: x(2), margin(2), least, near, next, noise, slope, step, tolerance, unit
      integer :: i
      logical :: enough, found

      enough = .false.
      if (present(by_tangent)) enough = by_tangent
      least = least_half(search, critical%falls, size(critical%fallen%contacts%face))
      proposal%half = least*max(abs(critical%falls), tiny(1.0_wp))
      if (critical%fallen%flow /= flow_rule%associated) return
      if (takes_power(critical%fallen)) return
      call link_once(family, critical%falls, critical%link)
      if (critical%link%known) then
         call trace_chain(family, search, critical%falls, limit, .true., critical, proposal)
         return
      end if
      x(1) = critical%falls
      call margin_at(family, x(1), sharpness, critical, margin(1), unit, found)
      if (.not. found) return
      step = min(first_step(2), max(first_step(1), abs(margin(1)/unit)))
      step = min(step*max(abs(x(1)), 0.01_wp*abs(limit - x(1))), abs(limit - x(1)))
      x(2) = x(1) + sign(step, limit - x(1))
      do i = 1, max_values
         tolerance = max(resolution, sharpness*abs(margin(1)/unit))
         call margin_at(family, x(2), tolerance, critical, margin(2), unit, found)
         if (.not. found .or. .not. abs(margin(2) - margin(1)) > 0.0_wp) return
         slope = (margin(2) - margin(1))/(x(2) - x(1))
         noise = least_margin*unit/abs(slope)
         next = x(2) - margin(2)/slope
         if (next < search%low .or. next > search%high) return
         if (enough) exit
         near = max(0.02_wp*least*abs(next), noise)
         if (abs(next - x(2)) <= near .and. 0.5_wp*tolerance*unit/abs(slope) <= near) exit
         x = [x(2), next]
         margin(1) = margin(2)
      end do
      if (i > max_values) return
      proposal%usable = .true.
      proposal%value = next
      proposal%half = least*abs(next)
      proposal%reach = proposal%half
      if (critical%current) proposal%reach = first_reach*abs(next)
      if (critical%current) return
      proposal%half = max(proposal%half, noise)
      ! beside its stop a mechanism becomes too slow for a decision to tell it from rest
      associate (outcome => critical%fallen%outcome)
         if (outcome%acceleration_ratio > 0.0_wp) proposal%half = max(proposal%half, noise &
            & + 1.1_wp*abs(next - critical%falls)*outcome%rest_tolerance/outcome%acceleration_ratio)
      end associate
      proposal%reach = proposal%half
   end subroutine trace

   !> Margin of one value
   pure subroutine margin_at(family, value, tolerance, critical, margin, unit, found)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value      !! The value
      real(wp), intent(in) :: tolerance  !! How far the margin may be off over its unit
      type(critical_t), intent(inout) :: critical
      real(wp), intent(out) :: margin, unit  !! As of `find_margin` [N/m]
      logical, intent(out) :: found    !! True if it could be found
      type(error_t), allocatable :: error
      type(joint_graph_t) :: graph
      type(load_stations_t) :: stations
      type(scene_t) :: scene
      real(wp), allocatable :: load(:, :)
      integer :: n

      margin = 0.0_wp
      unit = 1.0_wp
      call family%build(value, scene, error)
      found = .not. allocated(error)
      if (.not. found) return
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      found = .not. (breaks(graph) .or. crushes(graph))
      if (.not. found) return
      stations = load_stations(scene%settings, .false.)
      allocate (load(3, graph%n_block))
      call loads_at(stations, ubound(stations%tilt, 1), scene%settings, scene%system, graph, load)
      call find_margin(graph, load, tolerance, margin, unit, found, n)
      critical%factorisations = critical%factorisations + n
   end subroutine margin_at

   !> True if a collapse takes power that the loads alone do not tell: what is crushed does, and a
   !> bar that yields
   pure logical function takes_power(fallen)
      type(decision_t), intent(in) :: fallen

      takes_power = .false.
      if (allocated(fallen%system%bar)) takes_power = size(fallen%system%bar) > 0
      if (takes_power .or. .not. allocated(fallen%contacts%joint)) return
      associate (contacts => fallen%contacts)
         takes_power = any(contacts%law(contacts%joint%law)%strength < huge(1.0_wp))
      end associate
   end function takes_power

   !> Half the width of a bracket over its value: of the tolerance, or of what rounding leaves
   pure real(wp) function least_half(search, value, n)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: value  !! A value near the critical one
      integer, intent(in) :: n       !! Number of joints
      real(wp) :: resolution

      resolution = search%resolution
      if (search%resolution_at > 0.0_wp) &
         & resolution = resolution*(search%resolution_at/value)**2
      least_half = max(search%tolerance/2.0_wp, resolution, &
         & least_share + share_of_joint*real(n, wp))
   end function least_half
end module dda_collapse_trace
