!> Critical value of a parameter of dynamic runs, by bisection
!>
!> A dynamic verdict need not change only once, so values on both sides are run too. The critical
!> value is the first change from the end that stands, or from the low end where both ends agree;
!> changes beyond it are listed in the log.
submodule (dda_critical) dda_time_search
   use dda_bracket, only : decide_at
   implicit none

   !> Maximum number of runs of a search
   integer, parameter :: max_runs = 200
   !> Other position that separates two neighbours if their middle is undecided
   real(wp), parameter :: share(6) = [0.5_wp, 0.4_wp, 0.6_wp, 0.25_wp, 0.75_wp, 0.1_wp]
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

   !> Search the critical value
   module procedure find_critical_in_time
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
   end procedure find_critical_in_time

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
         if (try > size(share) .or. critical%decisions >= max_runs) then
            if (width > max(widest, search%tolerance)) return
            exit
         end if
         call run_value(family, critical%falls + share(try)*(critical%stands - critical%falls), &
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
end submodule dda_time_search
