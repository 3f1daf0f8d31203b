!> The order of many numbers
module dda_sort
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: sorted_order, rising_order, sort_numbers, place_in

   !> Fewer numbers are sorted without counting their digits
   integer, parameter :: few = 512

contains

   !> Order by a whole number, then by a real one; what is equal keeps its order
   pure function sorted_order(major, minor) result(order)
      integer, intent(in) :: major(:)   !! What counts first: (n)
      real(wp), intent(in) :: minor(:)  !! What counts where the first is equal: (n)
      integer :: order(size(major))     !! Places of the items, smallest first: (n)

      call merge_sort(int(major, int64), minor, order)
   end function sorted_order

   !> Places of numbers in rising order, equal ones as they came
   pure function rising_order(number) result(order)
      integer(int64), intent(in) :: number(:)  !! Any numbers: (n)
      integer :: order(size(number))           !! number(order) rises: (n)
      integer(int64) :: least, most

      least = 0
      most = 0
      if (size(number) >= few) then
         least = minval(number)
         most = maxval(number)
      end if
      ! the difference must not overflow
      if (size(number) < few .or. most > huge(most) + min(least, 0_int64)) then
         call merge_sort(number, spread(0.0_wp, 1, size(number)), order)
      else
         call radix_sort(number, least, most, order)
      end if
   end function rising_order

   !> Put numbers in rising order
   pure subroutine sort_numbers(number)
      integer, intent(inout) :: number(:)  !! The numbers: (n)
      integer, allocatable :: order(:)
      integer :: i, j, this

      if (size(number) >= few) then
         order = rising_order(int(number, int64))
         number = number(order)
         return
      end if
      do i = 2, size(number)
         this = number(i)
         do j = i, 2, -1
            if (number(j - 1) <= this) exit
            number(j) = number(j - 1)
         end do
         number(j) = this
      end do
   end subroutine sort_numbers

   !> Sort by digits, the last one first, each keeping the order of the one before; linear
   pure subroutine radix_sort(number, least, most, order)
      integer(int64), intent(in) :: number(:)
      integer(int64), intent(in) :: least  !! The least of them
      integer(int64), intent(in) :: most   !! The largest of them
      integer, intent(out) :: order(:)     !! Places of the items, smallest first: (n)
      integer, parameter :: bits = 11
      integer :: next(0:2**bits - 1), other(size(order)), digit, i, shift

      order = [(i, i=1, size(order))]
      do shift = 0, 63, bits
         if (shift > 0 .and. ishft(most - least, -shift) == 0) exit
         next = 0
         do i = 1, size(order)
            digit = digit_of(number(i))
            next(digit) = next(digit) + 1
         end do
         next = eoshift(next, -1, boundary=1)
         do i = 1, ubound(next, 1)
            next(i) = next(i - 1) + next(i)
         end do
         do i = 1, size(order)
            digit = digit_of(number(order(i)))
            other(next(digit)) = order(i)
            next(digit) = next(digit) + 1
         end do
         order = other
      end do

   contains

      !> The digit that is sorted by
      pure integer function digit_of(value)
         integer(int64), intent(in) :: value  !! A number

         digit_of = int(ibits(value - least, shift, min(bits, 63 - shift)))
      end function digit_of
   end subroutine radix_sort

   !> Merge sort from runs of one
   pure subroutine merge_sort(major, minor, order)
      integer(int64), intent(in) :: major(:)  !! What counts first: (n)
      real(wp), intent(in) :: minor(:)        !! What counts next: (n)
      integer, intent(out) :: order(:)
      integer :: other(size(order)), i, n, width, start, middle, finish

      n = size(order)
      order = [(i, i=1, n)]
      width = 1
      do while (width < n)
         do start = 1, n, 2*width
            middle = min(start + width, n + 1)
            finish = min(middle + width, n + 1)
            call merge_runs(major, minor, order, start, middle, finish, other)
         end do
         order = other
         if (width > n/2) exit
         width = 2*width
      end do
   end subroutine merge_sort

   !> Merge two sorted runs that lie side by side
   pure subroutine merge_runs(major, minor, order, start, middle, finish, merged)
      integer(int64), intent(in) :: major(:)
      real(wp), intent(in) :: minor(:)
      !> The runs: places start to middle - 1 and middle to finish - 1
      integer, intent(in) :: order(:)
      integer, intent(in) :: start         !! Start of the first run
      integer, intent(in) :: middle        !! Start of the second run
      integer, intent(in) :: finish        !! One beyond the second run
      integer, intent(inout) :: merged(:)  !! Receives the places start to finish - 1
      integer :: a, b, k
      logical :: take_second

      a = start
      b = middle
      do k = start, finish - 1
         take_second = a >= middle
         if (.not. take_second .and. b < finish) &
            & take_second = is_before(major, minor, order(b), order(a))
         if (take_second) then
            merged(k) = order(b)
            b = b + 1
         else
            merged(k) = order(a)
            a = a + 1
         end if
      end do
   end subroutine merge_runs

   !> Whether one item comes strictly before another
   pure logical function is_before(major, minor, a, b)
      integer(int64), intent(in) :: major(:)
      real(wp), intent(in) :: minor(:)
      integer, intent(in) :: a  !! One item
      integer, intent(in) :: b  !! The other

      is_before = major(a) < major(b) .or. (major(a) == major(b) .and. minor(a) < minor(b))
   end function is_before

   !> First place of a number among rising ones, or of the next larger
   pure integer function place_in(rising, number)
      integer(int64), intent(in) :: rising(:)  !! Rising numbers: (n)
      integer(int64), intent(in) :: number     !! What is looked for
      integer :: above, middle

      place_in = 1
      above = size(rising) + 1
      do while (place_in < above)
         middle = (place_in + above)/2
         if (rising(middle) < number) then
            place_in = middle + 1
         else
            above = middle
         end if
      end do
   end function place_in
end module dda_sort
