!> The order of things that have a whole number and a real number each
module dda_sort
   use dda_kinds, only : wp
   implicit none
   private

   public :: sorted_order

contains

   !> Order by a whole number, then by a real one; what is equal keeps its order (merge sort)
   pure function sorted_order(major, minor) result(order)
      !> What counts first: (n)
      integer, intent(in) :: major(:)
      !> What counts where the first is equal: (n)
      real(wp), intent(in) :: minor(:)
      !> Places of the items, smallest first: (n)
      integer, allocatable :: order(:)
      integer, allocatable :: other(:)
      integer :: i, n, width, start, middle, finish

      n = size(major)
      allocate (order(n), other(n))
      do i = 1, n
         order(i) = i
      end do
      width = 1
      do while (width < n)
         do start = 1, n, 2*width
            middle = min(start + width, n + 1)
            finish = min(middle + width, n + 1)
            call merge_runs(major, minor, order, start, middle, finish, other)
         end do
         call move_alloc(other, order)
         allocate (other(n))
         if (width > n/2) exit
         width = 2*width
      end do
   end function sorted_order

   !> Merge two sorted runs that lie side by side
   pure subroutine merge_runs(major, minor, order, start, middle, finish, merged)
      !> What counts first: (n)
      integer, intent(in) :: major(:)
      !> What counts next: (n)
      real(wp), intent(in) :: minor(:)
      !> The runs: places start to middle - 1 and middle to finish - 1
      integer, intent(in) :: order(:)
      !> Start of the first run
      integer, intent(in) :: start
      !> Start of the second run
      integer, intent(in) :: middle
      !> One beyond the second run
      integer, intent(in) :: finish
      !> Receives the places start to finish - 1
      integer, intent(inout) :: merged(:)
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
      !> What counts first: (n)
      integer, intent(in) :: major(:)
      !> What counts next: (n)
      real(wp), intent(in) :: minor(:)
      !> One item
      integer, intent(in) :: a
      !> The other
      integer, intent(in) :: b

      is_before = major(a) < major(b) .or. (major(a) == major(b) .and. minor(a) < minor(b))
   end function is_before
end module dda_sort
