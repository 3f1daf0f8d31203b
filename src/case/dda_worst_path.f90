!> The position of the first collapse on the loading path
!>
!> Where joints slide, a path under Coulomb friction may end below the associated limit, by more at
!> one position than at another. No mechanism of one position bounds the factor of the next. So
!> paths are followed at positions all along the road. Intervals are halved while the inverse
!> factor, which is nearly as smooth as the loads, may exceed its maximum: at either end, plus its
!> change per interval. Neighbouring paths may take different branches, so that the factor jumps:
!> the jump that would reduce the factor most is kept for the log.
submodule (dda_compute_case:dda_worst_position) dda_worst_path
   use dda_search, only : critical_t, search_t
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
   !> Least distance of positions over the total size
   real(wp), parameter :: nearest = 1.0e-7_wp

   !> Positions along a part of the road, from left to right
   type :: trials_t
      real(wp), allocatable :: place(:)    !! The positions: (n) [m]
      real(wp), allocatable :: inverse(:)  !! Inverses of the factors: (n)
      logical, allocatable :: falls(:)     !! True if the factor is that of a collapse: (n)
   end type trials_t

contains

   !> Follow the paths of positions along the road
   module procedure follow_road
      type(stretch_t), allocatable :: stretch(:)
      type(trials_t) :: trials
      real(wp) :: step
      integer :: first, last

      call part_road(bridge, stretch)
      if (size(stretch) == 0) return
      step = (stretch(size(stretch))%to - stretch(1)%from)/real(first_trials, wp)
      first = 1
      do while (first <= size(stretch) .and. least%factor > 0.0_wp)
         last = last_of_side(stretch, first)
         call begin_trials(this, stretch(first)%from, stretch(last)%to, step, least, trials)
         call close_in(this, nearest*bridge%road%size, least, trials)
         call keep_jump(nearest*bridge%road%size, backward, trials, least)
         first = last + 1
      end do
      this%jump_note = note_of_jump(least)
   end procedure follow_road

   !> Try positions on a part of the road with the same fill to lean against
   pure subroutine begin_trials(this, from, to, step, least, trials)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: from, to  !! Its ends [m]
      real(wp), intent(in) :: step      !! Distance of positions at most [m]
      type(least_factor_t), intent(inout) :: least
      type(trials_t), intent(out) :: trials
      integer :: k, n

      n = max(1, ceiling((to - from)/step))
      trials%place = [(from + (to - from)*real(k, wp)/real(n, wp), k=0, n)]
      allocate (trials%inverse(n + 1), trials%falls(n + 1))
      do k = 1, n + 1
         call try_place(this, trials%place(k), least, trials%inverse(k), trials%falls(k))
      end do
   end subroutine begin_trials

   !> Try positions between others until none may have a smaller factor
   pure subroutine close_in(this, near, least, trials)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: near  !! Positions so near are not divided [m]
      type(least_factor_t), intent(inout) :: least
      type(trials_t), intent(inout) :: trials
      real(wp) :: inverse, middle
      logical, allocatable :: open(:)
      logical :: falls
      integer :: k

      do
         open = may_hide_more(near, least, trials)
         if (.not. (any(open) .and. least%decided .and. least%factor > 0.0_wp)) return
         ! from the right, so that those to the left keep their numbers
         do k = size(open), 1, -1
            if (.not. open(k)) cycle
            middle = 0.5_wp*(trials%place(k) + trials%place(k + 1))
            call try_place(this, middle, least, inverse, falls)
            trials%place = [trials%place(:k), middle, trials%place(k + 1:)]
            trials%inverse = [trials%inverse(:k), inverse, trials%inverse(k + 1:)]
            trials%falls = [trials%falls(:k), falls, trials%falls(k + 1:)]
         end do
      end do
   end subroutine close_in

   !> Between which positions and the next there may be a smaller factor than the least so far
   pure function may_hide_more(near, least, trials) result(open)
      real(wp), intent(in) :: near
      type(least_factor_t), intent(in) :: least
      type(trials_t), intent(in) :: trials
      logical, allocatable :: open(:)  !! True for those: (n - 1)
      real(wp) :: change(size(trials%place) - 1), most
      integer :: k, n

      n = size(change)
      allocate (open(n))
      associate (place => trials%place, inverse => trials%inverse)
         change = abs(inverse(2:) - inverse(:n))
         do k = 1, n
            most = max(inverse(k), inverse(k + 1)) + max(jump_of(trials, k), &
               & usual(change(max(1, k - 1):min(n, k + 1))))
            open(k) = most > (1.0_wp + no_smaller)/least%factor .and. place(k + 1) - place(k) > near
         end do
      end associate
   end function may_hide_more

   !> Change of the inverse factor from a collapse to a neighbour with a larger factor; of a
   !> neighbour whose path was not followed to its end, at least that
   pure real(wp) function jump_of(trials, k)
      type(trials_t), intent(in) :: trials
      integer, intent(in) :: k  !! Number of the position to the left

      associate (pair => trials%inverse(k:k + 1))
         jump_of = 0.0_wp
         if (trials%falls(k - 1 + maxloc(pair, dim=1))) jump_of = maxval(pair) - minval(pair)
      end associate
   end function jump_of

   !> Keep the jump that leads to the largest inverse factor if it occurs twice
   pure subroutine keep_jump(near, backward, trials, least)
      real(wp), intent(in) :: near
      logical, intent(in) :: backward
      type(trials_t), intent(in) :: trials
      type(least_factor_t), intent(inout) :: least
      integer :: k

      do k = 1, size(trials%place) - 1
         if (trials%place(k + 1) - trials%place(k) > near) cycle
         associate (pair => trials%inverse(k:k + 1))
            if (.not. maxval(pair) + jump_of(trials, k) > least%jump) cycle
            least%jump = maxval(pair) + jump_of(trials, k)
            least%jump_factor = 1.0_wp/[maxval(pair), minval(pair)]
         end associate
         least%jump_place = trials%place(k)
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

   !> Follow the loading path of a position, no farther than matters
   module procedure try_place
      type(critical_t) :: critical
      type(search_t) :: search
      real(wp) :: factor

      call put_vehicle(place, this%family%deck)
      search = this%search
      if (least%factor < no_limit .and. reach*least%factor > search%low) &
         & search%high = min(search%high, reach*least%factor)
      search%start = min(search%start, search%high)
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
      if (present(inverse)) inverse = 1.0_wp/max(factor, tiny(factor))
      if (present(falls)) falls = critical%verdict == verdict%found
      if (.not. factor < least%factor) return
      least%factor = factor
      least%place = place
      least%decided = critical%verdict /= verdict%undecided
   end procedure try_place

end submodule dda_worst_path
