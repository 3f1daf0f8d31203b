!> Critical value under the original's scheme: a bracket of two runs, halved
submodule (dda_compute_case) dda_limerick_search
   use dda_deck, only : deck_t
   use dda_deck_keys, only : deck_key
   use dda_deck_set, only : put_number
   use dda_key_value, only : number_fits
   use dda_scene_plan, only : plan_scene
   use dda_verdict, only : verdict
   implicit none

   !> First step away from the start, over the start; the steps double
   real(wp), parameter :: first_stride = 0.02_wp
   !> Most runs of a search
   integer, parameter :: max_runs = 100

contains

   !> Search the critical value
   module procedure find_limerick_critical
      integer :: answer

      critical%current = .true.
      if (search%check_far_end) then
         call decide_at(family, search%low, critical, answer)
         if (answer /= verdict%undecided) call decide_at(family, search%high, critical, answer)
      else
         call stride_out(family, search, critical, answer)
      end if
      do while (answer /= verdict%undecided .and. both_sides(critical))
         critical%half = abs(critical%stands - critical%falls)/2.0_wp
         if (critical%decisions >= max_runs) exit
         if (2.0_wp*critical%half <= search%tolerance*abs(critical%stands)) then
            critical%verdict = verdict%found
            return
         end if
         call decide_at(family, (critical%stands + critical%falls)/2.0_wp, critical, answer)
      end do
      if (answer == verdict%undecided .or. both_sides(critical)) return
      critical%verdict = merge(verdict%collapsed, verdict%stable, allocated(critical%fallen))
   end procedure find_limerick_critical

   !> Pictures of the run nearest to critical that was found to fall, else to stand
   module procedure repeat_with_pictures
      type(decision_t) :: decision
      type(scene_t) :: scene
      type(error_t), allocatable :: error
      type(deck_t) :: deck

      deck = family%deck
      if (allocated(critical%fallen)) then
         call put_number(deck, family%parameter, critical%falls, &
            & deck%value(family%parameter%key)%place, error)
      else if (allocated(critical%standing)) then
         call put_number(deck, family%parameter, critical%stands, &
            & deck%value(family%parameter%key)%place, error)
      else
         return
      end if
      if (allocated(error)) return
      call deck_scene(deck, plan_scene(deck), scene)
      call decide_limerick(deck, scene, decision, album)
   end procedure repeat_with_pictures

   !> Whether a value stands and another falls
   pure logical function both_sides(critical)
      type(critical_t), intent(in) :: critical

      both_sides = allocated(critical%fallen) .and. allocated(critical%standing)
   end function both_sides

   !> Go up from the start while it falls, or down while it stands, with steps that double
   pure subroutine stride_out(family, search, critical, answer)
      type(deck_family_t), intent(in) :: family
      type(search_t), intent(in) :: search
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! The last of them, one of verdict
      real(wp) :: value, stride

      value = search%start
      stride = first_stride*search%start
      do
         call decide_at(family, value, critical, answer)
         if (both_sides(critical) .or. answer == verdict%undecided) return
         if (answer == verdict%collapsed) then
            if (.not. value < search%high) return
            value = min(search%high, value + stride)
         else
            if (.not. value > search%low) return
            value = max(search%low, value - stride)
         end if
         stride = 2.0_wp*stride
      end do
   end subroutine stride_out

   !> Run one value and keep the decision on its side of the bracket
   pure subroutine decide_at(family, value, critical, answer)
      type(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! The value
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer
      type(decision_t), allocatable :: decision
      type(scene_t) :: scene
      type(error_t), allocatable :: error
      type(deck_t) :: deck

      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      critical%undecided_at = value
      critical%reason = "the searched parameter cannot have this value"
      if (.not. number_fits(deck_key(family%parameter%key), value)) return
      deck = family%deck
      call put_number(deck, family%parameter, value, deck%value(family%parameter%key)%place, error)
      if (allocated(error)) return
      allocate (decision)
      call deck_scene(deck, plan_scene(deck), scene)
      call decide_limerick(deck, scene, decision)
      critical%steps = critical%steps + decision%outcome%steps
      critical%passes = critical%passes + decision%outcome%passes
      critical%factorisations = critical%factorisations + decision%outcome%factorisations
      answer = decision%outcome%verdict
      if (allocated(decision%outcome%reason)) critical%reason = decision%outcome%reason
      if (answer == verdict%completed) then
         answer = verdict%undecided
         critical%reason = "a dynamic run ends completed, neither stable nor collapsed"
      end if
      if (answer == verdict%collapsed) then
         critical%falls = value
         call move_alloc(decision, critical%fallen)
      else if (answer == verdict%stable) then
         critical%stands = value
         call move_alloc(decision, critical%standing)
      end if
   end subroutine decide_at

end submodule dda_limerick_search
