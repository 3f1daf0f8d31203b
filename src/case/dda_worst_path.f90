!> The position of the first collapse on the loading path
!>
!> Where joints slide, a path under Coulomb friction may end below the associated limit, by more at
!> one position than at another. No mechanism of one position bounds the factor of the next. So
!> paths are followed at positions all along the road. Intervals are halved while the inverse
!> factor, which is nearly as smooth as the loads, may exceed its maximum: at either end, plus its
!> change per interval. Neighbouring paths may take different branches, so that the factor jumps:
!> the jump that would reduce the factor most is kept for the log.
!>
!> No path falls before the first place at which no rates go on, and up to there it changes little
!> from position to position. There blocks fall at one position and find balance by a jump at the
!> next. So positions are tried closely where paths jump before the least factor.
submodule (dda_compute_case:dda_worst_position) dda_worst_path
   use dda_search, only : search_t
   use dda_text, only : short_text
   implicit none

   !> Initial number of positions along a road
   integer, parameter :: first_trials = 48
   !> End of a path over the least factor
   real(wp), parameter :: reach = 1.1_wp
   !> Relative difference of a smaller factor
   real(wp), parameter :: no_smaller = 1.0e-7_wp
   !> Share of the least factor by which a jump may hide a smaller one without a remark
   real(wp), parameter :: hidden = 1.0e-2_wp
   !> Least distance of positions over the total size, and of those whose paths only jump
   real(wp), parameter :: nearest = 1.0e-7_wp, close = 5.0e-3_wp

contains

   !> Follow the paths of positions along the road
   module procedure follow_road
      type(stretch_t), allocatable :: stretch(:)
      type(trial_t), allocatable :: trial(:)
      real(wp) :: step
      integer :: first, last

      call part_road(bridge, stretch)
      if (size(stretch) == 0) return
      step = (stretch(size(stretch))%to - stretch(1)%from)/real(first_trials, wp)
      first = 1
      do while (first <= size(stretch) .and. least%factor > 0.0_wp)
         last = last_of_side(stretch, first)
         call begin_trials(this, stretch(first)%from, stretch(last)%to, step, least, trial)
         call close_in(this, bridge%road%size, least, trial)
         call keep_jump(nearest*bridge%road%size, backward, trial, least)
         first = last + 1
      end do
      this%jump_note = note_of_jump(least)
   end procedure follow_road

   !> Try positions on a part of the road with the same fill to lean against
   pure subroutine begin_trials(this, from, to, step, least, trial)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: from, to  !! Its ends [m]
      real(wp), intent(in) :: step      !! Distance of positions at most [m]
      type(least_factor_t), intent(inout) :: least
      type(trial_t), allocatable, intent(out) :: trial(:)  !! The paths, from left to right: (n)
      integer :: k, n

      n = max(1, ceiling((to - from)/step))
      allocate (trial(n + 1))
      do k = 1, n + 1
         call try_place(this, from + (to - from)*real(k - 1, wp)/real(n, wp), least, trial(k))
      end do
   end subroutine begin_trials

   !> Try positions between others until none may have a smaller factor
   pure subroutine close_in(this, size_of_road, least, trial)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: size_of_road  !! Total size [m]
      type(least_factor_t), intent(inout) :: least
      type(trial_t), allocatable, intent(inout) :: trial(:)
      type(trial_t) :: middle
      logical, allocatable :: open(:)
      integer :: k

      do
         open = may_hide_more(size_of_road, least, trial)
         if (.not. (any(open) .and. least%decided .and. least%factor > 0.0_wp)) return
         ! from the right, so that those to the left keep their numbers
         do k = size(open), 1, -1
            if (.not. open(k)) cycle
            call try_place(this, 0.5_wp*(trial(k)%place + trial(k + 1)%place), least, middle)
            trial = [trial(:k), middle, trial(k + 1:)]
         end do
      end do
   end subroutine close_in

   !> Intervals in which there may be a smaller factor than the least so far. A factor beyond the
   !> reach of paths counts as at its end, since paths may end there
   pure function may_hide_more(size_of_road, least, trial) result(open)
      real(wp), intent(in) :: size_of_road
      type(least_factor_t), intent(in) :: least
      type(trial_t), intent(in) :: trial(:)
      logical, allocatable :: open(:)  !! True for those: (n - 1)
      real(wp) :: gap(size(trial) - 1), most

      most = (1.0_wp + no_smaller)/least%factor
      gap = trial(2:)%place - trial(:size(gap))%place
      open = summit(max(trial%jump, most/reach)) > most .and. (gap > close*size_of_road &
         & .or. gap > nearest*size_of_road .and. (summit(max(trial%inverse, most/reach)) > most &
         & .or. summit_of_jumps(trial) > most))
   end function may_hide_more

   !> Largest inverse factor to expect between each position and the next
   pure function summit(inverse)
      real(wp), intent(in) :: inverse(:)         !! The factors: (n)
      real(wp) :: summit(size(inverse) - 1)
      real(wp) :: change(size(inverse) - 1)
      integer :: k, n

      n = size(change)
      change = abs(inverse(2:) - inverse(:n))
      do k = 1, n
         summit(k) = max(inverse(k), inverse(k + 1)) + usual(change(max(1, k - 1):min(n, k + 1)))
      end do
   end function summit

   !> Largest inverse factor to expect beside a jump from a position to the next: the larger one, if
   !> it is that of a collapse, plus the jump. Of a neighbour whose path was not followed to its
   !> end, the jump is at least that
   pure function summit_of_jumps(trial) result(summit)
      type(trial_t), intent(in) :: trial(:)
      real(wp) :: summit(size(trial) - 1)
      integer :: k

      do k = 1, size(summit)
         associate (pair => trial(k:k + 1)%inverse)
            summit(k) = maxval(pair)
            if (trial(k - 1 + maxloc(pair, dim=1))%falls) &
               & summit(k) = 2.0_wp*maxval(pair) - minval(pair)
         end associate
      end do
   end function summit_of_jumps

   !> Keep the jump that leads to the largest inverse factor if it occurs twice
   pure subroutine keep_jump(near, backward, trial, least)
      real(wp), intent(in) :: near
      logical, intent(in) :: backward
      type(trial_t), intent(in) :: trial(:)
      type(least_factor_t), intent(inout) :: least
      real(wp) :: summit(size(trial) - 1)
      integer :: k

      summit = summit_of_jumps(trial)
      do k = 1, size(summit)
         if (trial(k + 1)%place - trial(k)%place > near .or. .not. summit(k) > least%jump) cycle
         least%jump = summit(k)
         associate (pair => trial(k:k + 1)%inverse)
            least%jump_factor = 1.0_wp/[maxval(pair), minval(pair)]
         end associate
         least%jump_place = trial(k)%place
         least%jump_backward = backward
      end do
   end subroutine keep_jump

   !> Remark on a jump of the factor between positions; empty if there is none
   pure function note_of_jump(least) result(note)
      type(least_factor_t), intent(in) :: least
      character(len=:), allocatable :: note

      note = ""
      if (.not. least%jump*least%factor > 1.0_wp + hidden) return
      note = "; the load factor jumps with the position and may be smaller between the positions" &
         & //" tried: from "//short_text(least%jump_factor(1))//" to at least " &
         & //short_text(least%jump_factor(2))//" at "//short_text(least%jump_place) &
         & //" m, driving "//trim(merge("backward", "forward ", least%jump_backward))
   end function note_of_jump

   !> The middle one of three changes, for the largest may be a jump of the path; of fewer changes
   !> the largest
   pure real(wp) function usual(change)
      real(wp), intent(in) :: change(:)  !! The changes: (1 to 3)

      usual = maxval(change)
      if (size(change) == 3) usual = sum(change) - usual - minval(change)
   end function usual

   !> Follow the loading path of a position, no farther than matters. Its associated limit, which
   !> takes longer than the path, is sought only if the path ends before all others
   module procedure try_place
      type(critical_t) :: critical
      type(search_t) :: search
      real(wp) :: factor

      call put_vehicle(place, this%family%deck)
      search = this%search
      if (least%factor < no_limit .and. reach*least%factor > search%low) &
         & search%high = min(search%high, reach*least%factor)
      search%start = min(search%start, search%high)
      search%below_limit = search%high < this%search%high
      call find_end(this, search, critical, factor)
      if (search%below_limit .and. factor < least%factor) then
         search%below_limit = .false.
         call find_end(this, search, critical, factor)
      end if
      if (present(trial)) then
         trial%place = place
         trial%inverse = 1.0_wp/max(factor, tiny(factor))
         trial%jump = trial%inverse
         if (allocated(critical%jump)) trial%jump = trial%inverse &
            & /max(minval([critical%jump, 1.0_wp]), tiny(factor))
         trial%falls = critical%verdict == verdict%found
      end if
      if (.not. factor < least%factor) return
      least%factor = factor
      least%place = place
      least%decided = critical%verdict /= verdict%undecided
      if (allocated(least%critical)) deallocate (least%critical)
      allocate (least%critical, source=critical)
   end procedure try_place

   !> Find the load factor at which a path ends
   pure subroutine find_end(this, search, critical, factor)
      type(case_t), intent(in) :: this
      type(search_t), intent(in) :: search
      type(critical_t), intent(out) :: critical
      real(wp), intent(out) :: factor  !! The factor

      call find_critical(this%family, search, critical)
      select case (critical%verdict)
      case (verdict%found)
         factor = critical%stop
      case (verdict%stable)
         factor = search%high
         if (.not. search%high < this%search%high) factor = no_limit
      case (verdict%collapsed)
         factor = 0.0_wp
      case default
         factor = critical%undecided_at
      end select
   end subroutine find_end

   !> Try the mirrored position of a bridge of equal halves, with the vehicle turned round. A
   !> vehicle that is its own mirror image stands at the same position in both directions
   module procedure try_other_direction
      type(least_factor_t) :: other
      type(trial_t) :: trial

      associate (deck => this%family%deck)
         this%either_direction = is_symmetric(deck)
         this%other_place = least%place
         if (this%either_direction .or. .not. least%factor > 0.0_wp) return
         if (.not. least%backward) call turn_round(deck)
         ! the length of the vehicle is the same in both directions
         this%other_place = sum(bridge%road%reach + bridge%scene%origin(1)) - least%place &
            & - maxval(bridge%vehicle%offset)
         call try_place(this, this%other_place, other, trial)
         if (.not. least%backward) call turn_round(deck)
         this%either_direction = abs(trial%inverse*least%factor - 1.0_wp) &
            & <= max(no_smaller, this%search%tolerance)
      end associate
   end procedure try_other_direction

end submodule dda_worst_path
