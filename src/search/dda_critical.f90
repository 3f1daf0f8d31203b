!> Critical value of a parameter: in time, of a load coefficient, or in general, and between equal
!> ends
!>
!> A dynamic verdict need not change only once, so values on both sides are run too. The critical
!> value is the first change from the end that stands, or from the low end where both ends agree;
!> changes beyond it are listed in the log.
module dda_critical
   use dda_bracket, only : close_bracket, decide_at, middle
   use dda_chain_decision, only : unfold
   use dda_collapse_trace, only : proposal_t, trace
   use dda_decision, only : decide
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, scene_t, searched_load
   use dda_scene_graph, only : decides_as_graph
   use dda_search, only : critical_t, decision_t, keep_decision, search_t, shed
   use dda_settings, only : flow_rule, verdict
   implicit none
   private

   public :: find_critical, find_critical_in_time

   !> Values between two ends, as shares of what is left, that may rule out nothing before the ends
   !> are held to agree
   real(wp), parameter :: share(7) = [4, 2, 6, 1, 3, 5, 7]/8.0_wp
   !> Share of the range below which the search between equal ends stops
   real(wp), parameter :: narrow = 1.0e-6_wp

   interface

      !> Search a family whose parameter is a load coefficient
      pure module subroutine find_critical_load(family, search, critical, done)
         class(family_t), intent(in) :: family
         !> The search; if it is not done, its low end may become
         type(search_t), intent(inout) :: search
         type(critical_t), intent(inout) :: critical
         logical, intent(out) :: done  !! True if the search could be done so
      end subroutine find_critical_load

   end interface

   !> Maximum number of runs of a search
   integer, parameter :: max_runs = 200
   !> Other position that separates two neighbours if their middle is undecided
   real(wp), parameter :: splits(6) = [0.5_wp, 0.4_wp, 0.6_wp, 0.25_wp, 0.75_wp, 0.1_wp]
   !> Where other values are run, from the critical value to an end
   real(wp), parameter :: probe(4) = [0.02_wp, 0.1_wp, 0.3_wp, 0.65_wp]
   !> Values that are run between two ends that agree
   integer, parameter :: n_between = 7
   !> Largest relative distance of neighbours separated by undecided runs
   real(wp), parameter :: widest = 1.0e-3_wp

   !> A value that was run
   type :: runs_t
      integer :: n = 0                          !! Number of decided values
      real(wp) :: value(max_runs + 2) = 0.0_wp  !! The values, increasing: (n or more)
      logical :: falls(max_runs + 2) = .false.  !! True if each falls: (n or more)
      !> Values of the decisions that are kept, of one that stands and one that falls
      real(wp) :: kept(2) = 0.0_wp
   end type runs_t

contains

   !> Search the critical value of a family of scenes
   pure subroutine find_critical(family, search, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      !> Without results in, perhaps with the scene of a value; results out
      type(critical_t), intent(inout) :: critical
      type(critical_t) :: between
      type(search_t) :: part
      real(wp) :: value
      logical :: differs, done

      done = search%in_time
      part = search
      if (done) call find_critical_in_time(family, search, critical)
      if (.not. done .and. family%load /= searched_load%none) &
         & call find_critical_load(family, part, critical, done)
      if (done) return
      value = part%low
      differs = value > search%low
      if (.not. differs) then
         call close_bracket(family, part, critical)
         if (any(critical%verdict == [verdict%stable, verdict%collapsed])) then
            between = critical
            call look_between(family, search, between, value, differs)
            critical%steps = between%steps
            critical%passes = between%passes
            critical%factorisations = between%factorisations
            ! without a value that differs, the decision at the end is reported
            if (differs) critical = between
         end if
      end if
      if (differs) call close_both(family, search, value, critical)
      if (allocated(critical%fallen)) then
         if (critical%fallen%by_graph) then
            call tell_whole(family, verdict%collapsed, critical)
            ! beside the critical value the graph may see no sliding: steps follow it then
            critical%fallen%by_graph = critical%fallen%flow == flow_rule%coulomb &
               & .or. family%load /= searched_load%none
         end if
      end if
      if (allocated(critical%standing) .and. .not. (family%decides_chains &
         & .and. allocated(critical%fallen))) call tell_whole(family, verdict%stable, critical)
      if (allocated(critical%fallen)) call unfold(critical%fallen)
      if (allocated(critical%standing)) call unfold(critical%standing)
   end subroutine find_critical

   !> Search both sides of a value: above it, or below it where that falls and the ends stand. The
   !> result of the other side is reported beside it, or instead of it
   pure subroutine close_both(family, search, value, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: value                !! A value that stands, or one that falls
      type(critical_t), intent(inout) :: critical  !! Results so far
      type(search_t) :: part(2)
      type(critical_t) :: found(2)
      integer :: i, steps, passes, factorisations, first

      part = search
      part(1)%low = value
      part(1)%start = value
      part(2)%high = value
      part(2)%start = min(search%start, value)
      first = merge(2, 1, critical%verdict == verdict%stable)
      do i = 1, 2
         call close_bracket(family, part(i), found(i))
      end do
      steps = critical%steps + sum(found%steps)
      passes = critical%passes + sum(found%passes)
      factorisations = critical%factorisations + sum(found%factorisations)
      associate (other => found(3 - first))
         critical = found(first)
         if (critical%verdict == verdict%found) then
            critical%has_other = other%verdict == verdict%found
            critical%other = merge(other%stop, middle(other%stands, other%falls), other%stops)
         else if (critical%verdict /= verdict%undecided .and. other%verdict == verdict%found) then
            critical = other
         end if
      end associate
      critical%steps = steps
      critical%passes = passes
      critical%factorisations = factorisations
   end subroutine close_both

   !> Look between two ends that agree for a value that does not. A mechanism of limit analysis that
   !> falls rules out all values beyond the one at which it stops; values that part what is left
   !> evenly are tried
   pure subroutine look_between(family, search, critical, value, differs)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      !> The verdict of both ends; the decisions that are made are counted
      type(critical_t), intent(inout) :: critical
      real(wp), intent(out) :: value   !! Such a value
      logical, intent(out) :: differs  !! True if there is one
      real(wp) :: from, to
      integer :: agree, answer, try
      type(proposal_t) :: proposal

      from = search%low
      to = search%high
      agree = critical%verdict
      try = 1
      answer = agree
      do
         if (answer == verdict%collapsed) then
            call trace(family, search, merge(from, to, critical%falls > 0.5_wp*(from + to)), &
               & critical, proposal, by_tangent=.true.)
            if (proposal%usable) then
               if (proposal%value < critical%falls) to = min(to, proposal%value)
               if (proposal%value > critical%falls) from = max(from, proposal%value)
               try = 1
            end if
         end if
         differs = .false.
         if (try > size(share)) return
         if (to - from <= narrow*(search%high - search%low)) return
         value = from + share(try)*(to - from)
         try = try + 1
         call decide_at(family, value, critical, answer)
         differs = answer /= agree .and. answer /= verdict%undecided
         if (differs) return
      end do
   end subroutine look_between

   !> Decide a value again that was asked for its verdict alone, where its joint graph decides: for
   !> the way in which it falls, or for the elastic sharing of the forces of what stands
   pure subroutine tell_whole(family, wanted, critical)
      class(family_t), intent(in) :: family
      integer, intent(in) :: wanted  !! The verdict, collapsed or stable
      !> Results, among them a decision with that verdict
      type(critical_t), intent(inout) :: critical
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error
      type(scene_t) :: scene
      real(wp) :: value

      value = merge(critical%falls, critical%stands, wanted == verdict%collapsed)
      call family%build(value, scene, error)
      if (allocated(error)) return
      if (.not. decides_as_graph(scene%settings, scene%contacts)) return
      allocate (decision)
      call decide(scene, decision)
      if (decision%outcome%verdict /= wanted) return
      call shed(decision, keeps_joints=.true.)
      call keep_decision(critical, value, decision)
   end subroutine tell_whole

   !> Search the critical value
   pure subroutine find_critical_in_time(family, search, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(critical_t), intent(out) :: critical
      type(runs_t) :: runs
      real(wp) :: value
      integer :: answer, i, side

      call run_value(family, search%low, runs, critical, answer)
      if (answer == verdict%undecided) return
      call run_value(family, search%high, runs, critical, answer)
      if (answer == verdict%undecided) return
      do i = 1, n_between
         if (any(runs%falls(:runs%n) .neqv. runs%falls(1))) exit
         call run_value(family, search%low + (search%high - search%low)*real(i, wp) &
            & /real(n_between + 1, wp), runs, critical, answer)
         critical%others = critical%others + 1
      end do
      if (all(runs%falls(:runs%n) .eqv. runs%falls(1))) then
         critical%verdict = merge(verdict%collapsed, verdict%stable, runs%falls(1))
         return
      end if
      call halve_change(family, search, runs, critical)
      if (critical%verdict /= verdict%found) return
      value = (critical%falls + critical%stands)/2.0_wp
      do side = 1, 2
         do i = 1, size(probe)
            call run_value(family, value + probe(i) &
               & *(merge(search%low, search%high, side == 1) - value), runs, critical, answer)
            critical%others = critical%others + 1
         end do
      end do
      call halve_change(family, search, runs, critical)
      ! the decisions of the two neighbours may be none of the last
      if (abs(runs%kept(1) - critical%stands) > 0.0_wp) &
         & call run_value(family, critical%stands, runs, critical, answer)
      if (abs(runs%kept(2) - critical%falls) > 0.0_wp) &
         & call run_value(family, critical%falls, runs, critical, answer)
      ! where else the answer changes
      allocate (critical%other_change(2, 0))
      do i = 1, runs%n - 1
         if (i == first_change(runs) .or. (runs%falls(i) .eqv. runs%falls(i + 1))) cycle
         critical%other_change = reshape([critical%other_change, runs%value(i:i + 1)], &
            & [2, size(critical%other_change, 2) + 1])
      end do
   end subroutine find_critical_in_time

   !> The first two neighbours of which one falls, from the end that stands, or from the low end
   !> where both agree
   pure integer function first_change(runs)
      type(runs_t), intent(in) :: runs  !! The values that were run, with different verdicts

      associate (falls => runs%falls(:runs%n))
         first_change = findloc(falls(:runs%n - 1) .neqv. falls(2:), .true., dim=1, &
            & back=falls(1) .and. .not. falls(runs%n))
      end associate
   end function first_change

   !> Halve the first change until its neighbours are within the tolerance
   pure subroutine halve_change(family, search, runs, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(runs_t), intent(inout) :: runs
      type(critical_t), intent(inout) :: critical
      real(wp) :: pair(2), width
      integer :: answer, i, try

      critical%verdict = verdict%undecided
      try = 1
      do
         i = first_change(runs)
         pair = runs%value(i:i + 1)
         critical%falls = merge(pair(1), pair(2), runs%falls(i))
         critical%stands = merge(pair(2), pair(1), runs%falls(i))
         critical%half = (pair(2) - pair(1))/2.0_wp
         width = (pair(2) - pair(1))/maxval(abs(pair))
         if (width <= search%tolerance) exit
         if (try > size(splits) .or. critical%decisions >= max_runs) then
            if (width > max(widest, search%tolerance)) return
            exit
         end if
         call run_value(family, critical%falls + splits(try)*(critical%stands - critical%falls), &
            & runs, critical, answer)
         try = merge(try + 1, 1, answer == verdict%undecided)
      end do
      critical%verdict = verdict%found
   end subroutine halve_change

   !> Run one value
   pure subroutine run_value(family, value, runs, critical, answer)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value   !! The value
      type(runs_t), intent(inout) :: runs
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! Stable, collapsed or undecided
      integer :: i

      call decide_at(family, value, critical, answer, whole=.true.)
      if (answer == verdict%undecided) return
      runs%kept(merge(2, 1, answer == verdict%collapsed)) = value
      i = count(runs%value(:runs%n) < value)
      if (any(.not. abs(runs%value(:runs%n) - value) > 0.0_wp)) return
      if (runs%n == size(runs%value)) return
      runs%value(i + 2:runs%n + 1) = runs%value(i + 1:runs%n)
      runs%falls(i + 2:runs%n + 1) = runs%falls(i + 1:runs%n)
      runs%value(i + 1) = value
      runs%falls(i + 1) = answer == verdict%collapsed
      runs%n = runs%n + 1
   end subroutine run_value
end module dda_critical
