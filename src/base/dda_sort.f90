!> The order of many numbers
module dda_sort
   use, intrinsic :: iso_fortran_env, only : int64
   implicit none
   private

   public :: rising_order, place_in

contains

   !> Places of numbers in rising order, equal ones as they came: merge sort
   pure function rising_order(number) result(order)
      !> Any numbers: (n)
      integer(int64), intent(in) :: number(:)
      !> number(order) rises: (n)
      integer :: order(size(number))
      integer :: work(size(number)), n, width, first, middle, last

      n = size(number)
      order = [(first, first=1, n)]
      width = 1
      do while (width < n)
         do first = 1, n, 2*width
            middle = min(first + width, n + 1)
            last = min(first + 2*width, n + 1)
            call merge_runs(number, order(first:middle - 1), order(middle:last - 1), &
               & work(first:last - 1))
         end do
         order = work
         width = 2*width
      end do
   end function rising_order

   !> Merge two rising runs
   pure subroutine merge_runs(number, left, right, merged)
      !> The numbers
      integer(int64), intent(in) :: number(:)
      !> Places of the first run
      integer, intent(in) :: left(:)
      !> Places of the second run
      integer, intent(in) :: right(:)
      !> Places of both: (size(left) + size(right))
      integer, intent(out) :: merged(:)
      integer :: i, j, k
      logical :: from_left

      i = 1
      j = 1
      do k = 1, size(merged)
         from_left = j > size(right)
         if (.not. from_left .and. i <= size(left)) &
            & from_left = number(left(i)) <= number(right(j))
         if (from_left) then
            merged(k) = left(i)
            i = i + 1
         else
            merged(k) = right(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

   !> First place of a number among rising ones, or of the next larger
   pure integer function place_in(rising, number)
      !> Rising numbers: (n)
      integer(int64), intent(in) :: rising(:)
      !> What is looked for
      integer(int64), intent(in) :: number
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
