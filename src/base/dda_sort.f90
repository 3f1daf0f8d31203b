!> Sorting of numbers
module dda_sort
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: list_by_owner, place_in, rising_order, sort_numbers, sorted_order

   !> Size below which numbers are sorted by comparison
   integer, parameter :: few = 128

contains

   !> Order by an integer, then by a real number; equal items keep their order
   pure function sorted_order(major, minor) result(order)
      integer, intent(in) :: major(:)   !! First sort key: (n)
      real(wp), intent(in) :: minor(:)  !! Second sort key: (n)
      integer :: order(size(major))     !! Places of the items, smallest first: (n)

      order = rising_order(ordered_bits(minor))
      order = order(rising_order(int(major(order), int64)))
   end function sorted_order

   !> Integer with the order of real numbers: its bits, inverted for negative numbers
   elemental integer(int64) function ordered_bits(number)
      real(wp), intent(in) :: number  !! The real number

      ! zeros of both signs are equal
      ordered_bits = transfer(merge(number, 0.0_wp, abs(number) > 0.0_wp), ordered_bits)
      if (ordered_bits < 0) ordered_bits = ieor(ordered_bits, huge(ordered_bits))
   end function ordered_bits

   !> Order of numbers, ascending; equal numbers keep their order
   pure function rising_order(number) result(order)
      integer(int64), intent(in) :: number(:)  !! Any numbers: (n)
      integer :: order(size(number))           !! Permutation with number(order) ascending: (n)
      integer :: i, j

      order = [(i, i=1, size(number))]
      if (size(number) >= few) then
         call radix_sort(number, order)
         return
      end if
      do i = 2, size(number)
         do j = i, 2, -1
            if (number(order(j - 1)) <= number(i)) exit
            order(j) = order(j - 1)
         end do
         order(j) = i
      end do
   end function rising_order

   !> List items per owner: owner i has item(first(i)) to item(first(i + 1) - 1), ascending
   pure subroutine list_by_owner(owner, first, item)
      integer, intent(in) :: owner(:)   !! Owner of each item, 0 for none: (n)
      integer, intent(out) :: first(:)  !! First item of each owner, and end: (n_owner + 1)
      integer, allocatable, intent(out) :: item(:)  !! The items that have an owner
      integer :: i

      first = 0
      do i = 1, size(owner)
         if (owner(i) > 0) first(owner(i)) = first(owner(i)) + 1
      end do
      do i = 2, size(first)
         first(i) = first(i - 1) + first(i)
      end do
      allocate (item(first(size(first))))
      ! start after each owner's last item and fill backwards
      first = first + 1
      do i = size(owner), 1, -1
         if (owner(i) == 0) cycle
         first(owner(i)) = first(owner(i)) - 1
         item(first(owner(i))) = i
      end do
   end subroutine list_by_owner

   !> Sort numbers in ascending order
   pure subroutine sort_numbers(number)
      integer, intent(inout) :: number(:)  !! The numbers: (n)

      number = number(rising_order(int(number, int64)))
   end subroutine sort_numbers

   !> Radix sort from the last digit; each pass keeps the order of the one before. Linear cost
   pure subroutine radix_sort(number, order)
      integer(int64), intent(in) :: number(:)
      integer, intent(inout) :: order(:)  !! Places of the items, smallest first: (n)
      integer, parameter :: bits = 11
      integer(int64) :: differing
      integer :: next(0:2**bits - 1), other(size(order)), digit, i, shift

      ! all digits above the highest differing bit are equal
      differing = iany(ieor(number, number(1)))
      do shift = 0, 63, bits
         if (ishft(differing, -shift) == 0) exit
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

      !> Digit that is sorted by; the sign bit is inverted, so that negative numbers come first
      pure integer function digit_of(value)
         integer(int64), intent(in) :: value  !! A number

         digit_of = int(ibits(ieor(value, not(huge(value))), shift, min(bits, 64 - shift)))
      end function digit_of
   end subroutine radix_sort

   !> First place of a number in an ascending list, or of the next larger one
   pure integer function place_in(rising, number)
      integer(int64), intent(in) :: rising(:)  !! Ascending numbers: (n)
      integer(int64), intent(in) :: number     !! Number to find
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
