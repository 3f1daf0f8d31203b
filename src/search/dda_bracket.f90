!> Critical value of a parameter: a bracket of a collapsed and a stable decision
!>
!> The margin of a collapse has its zero where it would stop. Two decisions close around that value
!> prove it. Where no zero is found, the bracket is halved.
module dda_bracket
   use dda_chain_decision, only : decide_chain
   use dda_collapse_trace, only : proposal_t, trace
   use dda_decision, only : decide
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, link_once, scene_t
   use dda_search, only : critical_t, decision_t, keep_decision, search_t, shed
   use dda_settings, only : verdict
   implicit none
   private

   public :: close_bracket, decide_at, middle

   !> Maximum number of decisions of a search
   integer, parameter :: max_decisions = 100
   !> Maximum number of values before the first collapse
   integer, parameter :: max_descent = 8
   !> Maximum number of consecutive undecided values
   integer, parameter :: max_undecided = 6

   !> Decisions of a proposal before the bracket is halved
   integer, parameter :: patience = 3
   !> Largest relative bracket of a result, unless the tolerance is larger
   real(wp), parameter :: widest = 1.0e-4_wp

contains

   !> Close the bracket around the value
   pure subroutine close_bracket(family, search, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(critical_t), intent(out) :: critical  !! Result; chains may be halves
      type(proposal_t) :: proposal
      real(wp) :: limit, start, value
      integer :: answer, in_vain, undecided
      logical :: may_turn

      if (family%decides_chains) call trace(family, search, search%high, critical, proposal)
      start = search%start
      if (proposal%usable) start = max(search%low, proposal%value - proposal%reach)
      call find_collapse(family, search, start, limit, critical)
      if (critical%verdict /= verdict%undecided) return
      if (.not. allocated(critical%fallen)) return
      if (search%check_far_end .and. .not. allocated(critical%standing)) &
         & call decide_at(family, limit, critical, answer)
      answer = verdict%collapsed
      may_turn = allocated(critical%reason) .and. .not. search%start > search%low
      in_vain = 0
      undecided = 0
      do while (critical%decisions < max_decisions .and. undecided < max_undecided)
         if (.not. abs(critical%falls - limit) > 0.0_wp) then
            if (.not. may_turn) then
               critical%verdict = verdict%collapsed
               return
            end if
            ! the low end is undecided: what stands may lie between it and the first collapse
            limit = critical%undecided_at
            may_turn = .false.
         end if
         if (answer == verdict%collapsed) then
            if (.not. proved(search, limit, critical, proposal)) &
               & call trace(family, search, limit, critical, proposal)
         end if
         in_vain = merge(0, in_vain + 1, answer == verdict%collapsed)
         if (closed(search, critical, proposal)) then
            critical%verdict = verdict%found
            critical%half = proposal%half
            if (abs(critical%stands - critical%falls) > 2.0001_wp*proposal%half) &
               & critical%half = 0.5_wp*abs(critical%stands - critical%falls)
            critical%stop = proposal%value
            critical%stops = proposal%usable .and. .not. critical%current
            return
         end if
         value = candidate(critical, proposal, limit, in_vain)
         if (undecided > 0) value = not_again(value, critical, undecided)
         call decide_at(family, value, critical, answer)
         if (answer == verdict%undecided) then
            undecided = undecided + 1
            proposal%half = 4.0_wp*proposal%half
            proposal%reach = 4.0_wp*proposal%reach
         else
            undecided = 0
         end if
      end do
   end subroutine close_bracket

   !> Go to the first collapse: from the start towards the low end, or else at the high end
   pure subroutine find_collapse(family, search, start, limit, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: start  !! Where to begin
      !> The end of the range on the side that stands [unit of the parameter]
      real(wp), intent(out) :: limit
      !> Receives the first collapse, or a verdict where both ends agree
      type(critical_t), intent(inout) :: critical
      integer :: answer, attempt
      real(wp) :: value

      limit = search%high
      value = start
      do attempt = 1, max_descent
         if (attempt == max_descent) value = search%low
         call decide_at(family, value, critical, answer)
         if (answer == verdict%collapsed) return
         if (.not. value > search%low) exit
         if (answer == verdict%undecided) exit
         value = max(search%low, value/5.0_wp)
      end do
      if (answer == verdict%undecided) then
         ! up to the first value that is decided
         do attempt = 1, max_descent
            call decide_at(family, value + (search%high - value)*2.0_wp**(attempt - max_descent), &
               & critical, answer)
            if (answer /= verdict%undecided) exit
         end do
         return
      end if
      limit = search%low
      call decide_at(family, search%high, critical, answer)
      if (answer == verdict%stable) critical%verdict = verdict%stable
   end subroutine find_collapse

   !> Where to decide next: just beyond the proposal, then just before it, then inside the bracket
   pure function candidate(critical, proposal, limit, in_vain) result(value)
      type(critical_t), intent(in) :: critical
      type(proposal_t), intent(in) :: proposal  !! Where the last collapse stops
      real(wp), intent(in) :: limit
      integer, intent(in) :: in_vain            !! Decisions since the last collapse
      real(wp) :: value
      real(wp) :: beyond, before, far, toward

      far = limit
      if (allocated(critical%standing)) far = critical%stands
      toward = sign(1.0_wp, far - critical%falls)
      beyond = proposal%value + toward*proposal%reach
      before = proposal%value - toward*proposal%reach
      if (.not. proposal%usable) then
         value = far
         if (allocated(critical%standing)) value = middle(critical%falls, far)
      else if (inside(beyond)) then
         value = beyond
      else if (.not. allocated(critical%standing)) then
         value = critical%falls + toward*2.0_wp*abs(critical%falls - proposal%value)
         if (.not. critical%current .or. .not. inside(value)) value = far
      else if (inside(before)) then
         value = before
      else if (critical%current .or. abs(far - critical%falls) > 0.3_wp*abs(far)) then
         value = middle(critical%falls, far)
      else
         value = far - merge(0.1_wp, 0.5_wp, in_vain <= patience)*(far - critical%falls)
      end if

   contains

      !> True if a value lies strictly between the ends of the bracket
      pure logical function inside(x)
         real(wp), intent(in) :: x  !! The value

         inside = toward*(x - critical%falls) > 0.0_wp .and. toward*(far - x) > 0.0_wp
      end function inside
   end function candidate

   !> A value beside the one that has just been undecided: the middle of a bracket may be critical
   !> to the last digit, where nothing rests and nothing moves
   pure real(wp) function not_again(value, critical, undecided)
      real(wp), intent(in) :: value     !! The value to decide next
      type(critical_t), intent(in) :: critical
      integer, intent(in) :: undecided  !! Number of consecutive undecided values
      real(wp) :: share

      not_again = value
      if (abs(value - critical%undecided_at) > 0.0_wp) return
      if (.not. allocated(critical%standing)) return
      share = 0.5_wp + 0.1_wp*real(merge(1, -1, mod(undecided, 2) == 0)*((undecided + 1)/2), wp)
      not_again = critical%falls + share*(critical%stands - critical%falls)
   end function not_again

   !> True if the last collapse is at the value of the proposal, within the tolerance: another trace
   !> would add nothing
   pure logical function proved(search, limit, critical, proposal)
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: limit
      type(critical_t), intent(in) :: critical
      type(proposal_t), intent(in) :: proposal  !! Where the collapse before the last stops

      ! of a chain the mechanism that the proposal follows is that of this decision
      proved = proposal%usable .and. critical%deficit%exchanges == 0
      if (proved) proved = proposal%half <= 0.5001_wp*search%tolerance*abs(proposal%value) &
         & .and. abs((proposal%value - critical%falls)*sign(1.0_wp, limit - critical%falls) &
         & - proposal%half) < 1.0e-3_wp*proposal%half
   end function proved

   !> True if the bracket is as narrow as the proposal asks for, or as decisions can make it
   pure logical function closed(search, critical, proposal)
      type(search_t), intent(in) :: search
      type(critical_t), intent(in) :: critical
      type(proposal_t), intent(in) :: proposal

      closed = allocated(critical%standing)
      if (.not. closed) return
      associate (width => abs(critical%stands - critical%falls))
         closed = width <= search%least
         if (closed) return
         closed = width <= 2.0001_wp*proposal%half .and. 2.0_wp*proposal%half &
            & <= max(widest, 2.0_wp*search%tolerance)*abs(critical%stands)
      end associate
   end function closed

   !> Decide one value and keep the decision on its side of the bracket
   pure subroutine decide_at(family, value, critical, answer, whole)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value   !! The value
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! One of verdict
      !> True if the decision is kept whole, as in dynamic searches; otherwise its verdict suffices
      logical, intent(in), optional :: whole
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error
      type(scene_t) :: scene
      logical :: bare, decided

      bare = .true.
      if (present(whole)) bare = .not. whole
      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      allocate (decision)
      decided = family%decides_chains
      if (decided) call link_once(family, value, critical%link)
      if (decided) decided = critical%link%known
      if (decided) call decide_chain(family%chain_settings, critical%link%chain, decision, &
         & decided, critical%deficit)
      if (.not. decided) then
         call family%build(value, scene, error)
         if (allocated(error)) then
            critical%reason = error%message
            critical%undecided_at = value
            return
         end if
         critical%current = scene%settings%current
         call decide(scene, decision, verdict_only=bare)
         ! what has not fallen at the end of its time stands
         if (decision%outcome%verdict == verdict%completed) &
            & decision%outcome%verdict = verdict%stable
      end if
      answer = decision%outcome%verdict
      if (bare) call shed(decision, keeps_joints=.true.)
      call keep_decision(critical, value, decision)
   end subroutine decide_at

   !> Middle of a bracket; the geometric one where the ends are of different magnitude
   pure real(wp) function middle(a, b)
      real(wp), intent(in) :: a, b  !! Its ends

      middle = (a + b)/2.0_wp
      if (min(a, b) > 0.0_wp .and. max(a, b) > 4.0_wp*min(a, b)) middle = sqrt(a*b)
   end function middle
end module dda_bracket
