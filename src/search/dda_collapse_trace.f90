!> Where a collapse stops: the value from which on the loads can be carried
!>
!> The margin of limit analysis is negative where a structure falls, and a concave function of its
!> loads. The secant method finds where it is zero. A chain has its deficit for it.
module dda_collapse_trace
   use dda_chain_programme, only : deficit_t, find_deficit
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

   public :: proposal_t, margin_at, trace

   !> Where a collapse stops
   type :: proposal_t
      logical :: usable = .false.  !! True if it stops anywhere
      real(wp) :: value = 0.0_wp   !! The value
      !> Half the width of the bracket to close around it: of the tolerance, or of the effect of
      !> rounded coordinates
      real(wp) :: half = 0.0_wp
      !> Distance beyond and before it at which to decide; more than half where blocks move: their
      !> margin in reference geometry is only an estimate
      real(wp) :: reach = 0.0_wp
   end type proposal_t

   !> First distance of decisions with moving blocks from the zero of the margin, over the value
   real(wp), parameter :: first_reach = 1.0e-3_wp
   !> Half a bracket is no narrower than this share of its value
   real(wp), parameter :: least_share = 4.0e-12_wp
   !> Increase of that share per joint
   real(wp), parameter :: share_of_joint = 2.0e-14_wp
   !> Error of a sharp margin over its unit: half
   real(wp), parameter :: least_margin = 0.5_wp*resolution
   !> Error of a margin over the previous one
   real(wp), parameter :: sharpness = 1.0e-3_wp
   !> Least and largest first step of the secant method over the value
   real(wp), parameter :: first_step(2) = [1.0e-3_wp, 0.3_wp]
   !> Longest of its further steps over the value or the last step
   real(wp), parameter :: longest_step = 2.0_wp
   !> Margin of a chain that is known, over its rounding error
   real(wp), parameter :: noise_of_chain = 3.0_wp
   !> Most values of the secant method
   integer, parameter :: max_values = 30

   !> Margin of one value
   type :: margin_t
      real(wp) :: value = 0.0_wp  !! The margin [N/m]
      real(wp) :: unit = 1.0_wp   !! Forces that it is small beside [N/m]
      real(wp) :: error = 0.0_wp  !! Its error [N/m]
      real(wp) :: noise = 0.0_wp  !! Margin that a decision takes for zero [N/m]
      !> True if a chain stands, in another mechanism than before: it may do so at its limit through
      !> a range of values
      logical :: is_beyond = .false.
   end type margin_t

contains

   !> Trace the last collapse, or before any decision the start of the search, to where it stops: by
   !> the secant method on the margin between it and the limit
   pure subroutine trace(family, search, limit, critical, proposal, by_tangent)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: limit  !! The end of the range on the side that stands
      type(critical_t), intent(inout) :: critical  !! Results so far
      type(proposal_t), intent(out) :: proposal    !! Where the collapse stops
      !> True to end with the first secant, to exclude values: the secant method does not converge
      !> where a margin has no zero
      logical, intent(in), optional :: by_tangent
      real(wp) :: from, least, noise, value
      integer :: n
      logical :: enough

      enough = .false.
      if (present(by_tangent)) enough = by_tangent
      from = search%start
      n = 0
      if (allocated(family%rays%joint)) n = size(family%rays%joint)
      if (allocated(critical%fallen)) then
         from = critical%falls
         n = size(critical%fallen%contacts%face)
      end if
      least = least_half(search, from, n)
      proposal%half = least*max(abs(from), tiny(1.0_wp))
      if (allocated(critical%fallen)) then
         if (critical%fallen%flow /= flow_rule%associated .or. takes_power(critical%fallen)) return
      end if
      call find_zero(family, search, from, limit, least, enough, critical, value, noise, &
         & proposal%usable)
      if (.not. proposal%usable) return
      proposal%value = value
      proposal%half = least*abs(value)
      proposal%reach = proposal%half
      if (critical%current) proposal%reach = first_reach*abs(value)
      if (critical%current) return
      proposal%half = max(proposal%half, noise)
      ! close to its stop a decision takes the slow mechanism for rest
      if (allocated(critical%fallen)) then
         associate (outcome => critical%fallen%outcome)
            if (outcome%acceleration_ratio > 0.0_wp) proposal%half = max(proposal%half, noise &
               & + 1.1_wp*abs(value - from)*outcome%rest_tolerance/outcome%acceleration_ratio)
         end associate
      end if
      proposal%reach = proposal%half
   end subroutine trace

   !> Zero of the margin by the secant method
   pure subroutine find_zero(family, search, from, limit, least, enough, critical, value, noise, &
      & found)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: from, limit  !! Where to begin, and whereto
      real(wp), intent(in) :: least        !! Half the width of the bracket over the value
      logical, intent(in) :: enough        !! True if the first secant is
      type(critical_t), intent(inout) :: critical
      real(wp), intent(out) :: value  !! The zero
      real(wp), intent(out) :: noise  !! Its rounding error
      logical, intent(out) :: found   !! True if there is one
      type(deficit_t) :: fallen
      type(margin_t) :: margin(2)
      real(wp) :: near, slope, step, x(2)
      integer :: i

      x(1) = from
      value = from
      noise = 0.0_wp
      call see_margin(family, x(1), sharpness, critical, margin(1), found)
      if (.not. found) return
      step = min(first_step(2), max(first_step(1), abs(margin(1)%value/margin(1)%unit)))
      step = min(step*max(abs(x(1)), 0.01_wp*abs(limit - x(1))), abs(limit - x(1)))
      x(2) = x(1) + sign(step, limit - x(1))
      fallen = critical%deficit
      do i = 1, max_values
         call see_margin(family, x(2), max(resolution, sharpness &
            & *abs(margin(1)%value/margin(1)%unit)), critical, margin(2), found)
         if (found .and. margin(2)%is_beyond .and. margin(1)%value < -margin(1)%error) then
            critical%deficit = fallen
            x(2) = 0.5_wp*(x(1) + x(2))
            cycle
         end if
         found = found .and. abs(margin(2)%value - margin(1)%value) > 0.0_wp
         if (.not. found) return
         slope = (margin(2)%value - margin(1)%value)/(x(2) - x(1))
         noise = margin(2)%noise/abs(slope)
         value = x(2) - margin(2)%value/slope
         found = value >= search%low .and. value <= search%high
         if (enough) return
         near = max(0.02_wp*least*abs(value), noise)
         if (found .and. abs(value - x(2)) <= near .and. margin(2)%error/abs(slope) <= near) return
         step = longest_step*max(abs(x(2)), abs(x(2) - x(1)))
         value = min(max(value, search%low, x(2) - step), search%high, x(2) + step)
         found = abs(value - x(2)) > 0.0_wp
         if (.not. found) return
         x = [x(2), value]
         margin(1) = margin(2)
         fallen = critical%deficit
      end do
      found = .false.
   end subroutine find_zero

   !> Margin of one value: of the chain where there is one, else of the joint graph
   pure subroutine see_margin(family, value, tolerance, critical, margin, found)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value
      real(wp), intent(in) :: tolerance  !! Permitted error of that of a graph over its unit
      type(critical_t), intent(inout) :: critical
      type(margin_t), intent(out) :: margin
      logical, intent(out) :: found

      call link_once(family, value, critical%link)
      if (critical%link%known) then
         associate (chain => critical%link%chain, deficit => critical%deficit)
            call find_deficit(chain, deficit)
            found = deficit%known
            margin = margin_t(-deficit%least, chain%whole_load, deficit%noise, &
               & noise_of_chain*deficit%noise, deficit%exchanges > 0 &
               & .and. deficit%least <= deficit%noise)
         end associate
      else
         call margin_at(family, value, tolerance, critical, margin%value, margin%unit, found)
         margin%error = 0.5_wp*tolerance*margin%unit
         margin%noise = least_margin*margin%unit
      end if
   end subroutine see_margin

   !> Margin of one value
   pure subroutine margin_at(family, value, tolerance, critical, margin, unit, found)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value      !! The value
      real(wp), intent(in) :: tolerance  !! Permitted error of the margin over its unit
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

   !> True if a collapse dissipates power beside that of the loads: by crushing, or by a bar that
   !> yields
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
