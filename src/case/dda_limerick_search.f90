!> Critical value under Shi's scheme: a bracket of two runs, halved
module dda_limerick_search
   use dda_case, only : case_t
   use dda_deck, only : deck_t
   use dda_deck_family, only : deck_family_t, put_value
   use dda_deck_scene, only : deck_scene
   use dda_error, only : error_t
   use dda_frames, only : album_t
   use dda_key_names, only : output_frames
   use dda_kinds, only : wp
   use dda_limerick_decision, only : decide_limerick
   use dda_scene, only : scene_t
   use dda_search, only : critical_t, decision_t, keep_decision, search_t
   use dda_verdict, only : verdict
   implicit none
   private

   public :: search_limerick

   !> First step away from the start, over the start; the steps double
   real(wp), parameter :: first_stride = 0.02_wp
   !> Most runs of a search
   integer, parameter :: max_runs = 100

contains

   !> Search the critical value of Shi's scheme, with pictures of the run nearest to it that was
   !> found to fall, else to stand
   pure subroutine search_limerick(this)
      type(case_t), intent(inout) :: this
      type(decision_t) :: decision
      type(error_t), allocatable :: error

      ! the limit of this scheme lies somewhat above the exact value
      if (this%exact_known .and. .not. this%search%check_far_end) &
         & this%search%start = min(max(this%exact, this%search%low), this%search%high)
      call close_bracket(this%family, this%search, this%critical)
      if (allocated(this%critical%fallen)) &
         & call this%family%build(this%critical%falls, this%scene, error)
      if (nint(this%family%deck%value(output_frames)%number) == 0) return
      if (.not. (allocated(this%critical%fallen) .or. allocated(this%critical%standing))) return
      call run_at(this%family, merge(this%critical%falls, this%critical%stands, &
         & allocated(this%critical%fallen)), decision, error, this%album)
   end subroutine search_limerick

   !> Close the bracket around the value
   pure subroutine close_bracket(family, search, critical)
      type(deck_family_t), intent(in) :: family
      !> What is searched; where the far end needs no check, the search strides out from the start
      type(search_t), intent(in) :: search
      type(critical_t), intent(out) :: critical
      integer :: answer

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
   end subroutine close_bracket

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
      real(wp), intent(in) :: value   !! The value
      type(critical_t), intent(inout) :: critical
      integer, intent(out) :: answer  !! One of verdict
      type(decision_t), allocatable :: decision
      type(error_t), allocatable :: error

      answer = verdict%undecided
      critical%decisions = critical%decisions + 1
      allocate (decision)
      call run_at(family, value, decision, error)
      if (allocated(error)) then
         critical%reason = error%message
         critical%undecided_at = value
         return
      end if
      associate (outcome => decision%outcome)
         if (outcome%verdict == verdict%completed) then
            outcome%verdict = verdict%undecided
            outcome%reason = "a dynamic run ends completed, neither stable nor collapsed"
         end if
         answer = outcome%verdict
      end associate
      call keep_decision(critical, value, decision)
   end subroutine decide_at

   !> Run one value
   pure subroutine run_at(family, value, decision, error, album)
      type(deck_family_t), intent(in) :: family
      real(wp), intent(in) :: value
      type(decision_t), intent(out) :: decision
      type(error_t), allocatable, intent(out) :: error  !! A value that the deck cannot have
      type(album_t), intent(inout), optional :: album   !! Receives its pictures
      type(deck_t) :: deck
      type(scene_t) :: scene

      deck = family%deck
      call put_value(family, value, deck, error)
      if (allocated(error)) return
      call deck_scene(deck, scene)
      call decide_limerick(deck, scene, decision, album)
   end subroutine run_at
end module dda_limerick_search
