!> Search of any parameter: the ends of its range, what lies between them where they agree, and
!> how the blocks nearest to critical stand and fall
submodule (dda_critical) dda_find_critical
   use dda_bar, only : bar_state_t
   use dda_block_system, only : block_system_t
   use dda_chain_decision, only : decide_chain, unfold
   use dda_contact_types, only : joint_springs_t
   use dda_contacts, only : place_all_joints
   use dda_decision, only : decide
   use dda_error, only : error_t
   use dda_scene, only : link_once, searched_load
   use dda_scene_graph, only : decides_as_graph
   use dda_search, only : keep_decision
   use dda_verdict, only : verdict
   implicit none

   !> Values between two ends, as shares of what is left, that may rule out nothing before the ends
   !> are held to agree
   real(wp), parameter :: share(7) = [4, 2, 6, 1, 3, 5, 7]/8.0_wp
   !> Part of the range in which nothing is looked for any more
   real(wp), parameter :: narrow = 1.0e-6_wp

   interface

      !> Close the bracket around the value
      pure module subroutine close_bracket(family, search, critical)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical  !! What was found; chains may be halves
      end subroutine close_bracket

   end interface

contains

   !> Search the critical value of a family of scenes
   module procedure find_critical
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
         if (any(critical%verdict == [verdict%stable, verdict%collapsed])) &
            & call look_between(family, search, critical, value, differs)
      end if
      if (differs) call close_both(family, search, value, critical)
      if (family%load /= searched_load%none .and. allocated(critical%fallen)) then
         if (.not. critical%fallen%by_graph) call tell_whole(family, verdict%collapsed, critical)
      end if
      if (allocated(critical%standing) .and. .not. family%decides_chains) &
         & call tell_whole(family, verdict%stable, critical)
      if (allocated(critical%fallen)) call unfold(critical%fallen)
      if (allocated(critical%standing)) call unfold(critical%standing)
   end procedure find_critical

   !> Search both sides of a value: above it, or below it where that falls and the ends stand. What
   !> is found on the other side is told beside what is found there, or instead of it
   pure subroutine close_both(family, search, value, critical)
      class(family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      real(wp), intent(in) :: value                !! A value that stands, or one that falls
      type(critical_t), intent(inout) :: critical  !! What was found so far
      type(search_t) :: part(2)
      type(critical_t) :: found(2)
      integer :: i, steps, passes, factorisations, first

      part = search
      part(1)%low = value
      part(1)%start = value
      part(2)%high = value
      part(2)%start = min(search%start, value)
      first = merge(2, 1, critical%verdict == verdict%stable)
      steps = critical%steps
      passes = critical%passes
      factorisations = critical%factorisations
      do i = 1, 2
         call close_bracket(family, part(i), found(i))
         steps = steps + found(i)%steps
         passes = passes + found(i)%passes
         factorisations = factorisations + found(i)%factorisations
      end do
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
      logical, intent(out) :: differs  !! Whether there is one
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
               & critical, proposal)
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

   !> Decide one value and keep the decision on its side of the bracket
   pure subroutine decide_at(family, value, critical, answer)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value   !! The value
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! One of verdict
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error
      type(scene_t) :: scene
      logical :: decided

      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      allocate (decision)
      decided = family%decides_chains
      if (decided) call link_once(family, value, critical%link)
      if (decided) decided = critical%link%known
      if (decided) call decide_chain(critical%link%settings, critical%link%chain, decision, &
         & decided, critical%reaction)
      if (.not. decided) then
         call family%build(value, scene, error)
         if (allocated(error)) then
            critical%reason = error%message
            critical%undecided_at = value
            return
         end if
         critical%current = scene%settings%current
         call decide(scene%settings, scene%system, scene%contacts, decision, verdict_only=.true.)
      end if
      answer = decision%outcome%verdict
      call shed(decision, keeps_joints=.true.)
      call keep_decision(critical, value, decision)
   end subroutine decide_at

   !> Decide again what is told of a search, where its joint graph does: how it falls, as to follow
   !> that in steps takes minutes, or how what stands shares out its forces, as its proof does not
   !> tell
   pure subroutine tell_whole(family, wanted, critical)
      class(family_t), intent(in) :: family
      integer, intent(in) :: wanted  !! What is told, collapsed or stable
      !> What was found, a decision of that verdict among it
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
      call decide(scene%settings, scene%system, scene%contacts, decision)
      if (decision%outcome%verdict /= wanted) return
      call shed(decision, keeps_joints=.true.)
      call keep_decision(critical, value, decision)
   end subroutine tell_whole

   !> Give back what a search does not ask a kept decision for
   module procedure shed
      type(bar_state_t), allocatable :: bar(:)

      if (keeps_joints) call place_all_joints(decision%system, decision%contacts)
      if (.not. keeps_joints) deallocate (decision%contacts%joint)
      if (allocated(decision%system%bar)) allocate (bar, source=decision%system%bar)
      decision%system = block_system_t()
      if (allocated(bar)) call move_alloc(bar, decision%system%bar)
      decision%contacts%springs = joint_springs_t()
      if (decision%outcome%verdict == verdict%stable .and. allocated(decision%outcome%motion)) &
         & deallocate (decision%outcome%motion)
   end procedure shed

   !> Middle of a bracket; the geometric one where the ends are of different magnitude
   pure real(wp) function middle(a, b)
      real(wp), intent(in) :: a, b  !! Its ends

      middle = (a + b)/2.0_wp
      if (min(a, b) > 0.0_wp .and. max(a, b) > 4.0_wp*min(a, b)) middle = sqrt(a*b)
   end function middle

end submodule dda_find_critical
