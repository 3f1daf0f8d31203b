!> A set of integers with lookup in constant time
module dda_key_set
   use, intrinsic :: iso_fortran_env, only : int64
   implicit none
   private

   public :: key_set_t, add_key, has_key, new_key_set

   !> Hash table with open addressing
   type :: key_set_t
      private
      !> The numbers, 0 for an empty place; the size n is a power of two: (0:n - 1)
      integer(int64), allocatable :: key(:)
   end type key_set_t

   !> Prime modulus of the hash, which spreads numbers of any stride
   integer(int64), parameter :: prime = 2147483647_int64

contains

   !> Make an empty set
   pure subroutine new_key_set(set, most)
      type(key_set_t), intent(out) :: set
      integer, intent(in) :: most  !! Maximum number of items
      integer :: n

      n = 8
      do while (n < most + most/2 + 1)
         n = 2*n
      end do
      allocate (set%key(0:n - 1), source=0_int64)
   end subroutine new_key_set

   !> True if a number is in a set
   pure logical function has_key(set, key)
      type(key_set_t), intent(in) :: set
      integer(int64), intent(in) :: key  !! The number, above 0

      has_key = set%key(place_of(set, key)) == key
   end function has_key

   !> Add a number to a set; a number that is present is not repeated
   pure subroutine add_key(set, key)
      type(key_set_t), intent(inout) :: set  !! The set, not full
      integer(int64), intent(in) :: key

      set%key(place_of(set, key)) = key
   end subroutine add_key

   !> Place of a number, or the empty place for it
   pure integer function place_of(set, key)
      type(key_set_t), intent(in) :: set
      integer(int64), intent(in) :: key
      integer :: last

      last = ubound(set%key, 1)
      place_of = iand(int(modulo(48271_int64*modulo(key, prime), prime)), last)
      do while (set%key(place_of) /= 0 .and. set%key(place_of) /= key)
         place_of = iand(place_of + 1, last)
      end do
   end function place_of
end module dda_key_set
