!> Length and check sums of a file, by which another one of the same name is known
module dda_file_mark
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_error, only : error_t
   use dda_text_file, only : read_bytes
   implicit none
   private

   public :: file_mark, text_mark

   !> The sums are polynomials at these places, modulo these primes
   integer(int64), parameter :: place(2) = [257_int64, 263_int64]
   integer(int64), parameter :: prime(2) = [2147483629_int64, 2147483587_int64]

contains

   !> The mark of a file: three numbers; a dash for one that cannot be read
   function file_mark(file) result(mark)
      character(len=*), intent(in) :: file  !! Name of the file
      character(len=:), allocatable :: mark
      character(len=:), allocatable :: bytes
      type(error_t), allocatable :: error

      mark = "-"
      call read_bytes(file, bytes, error)
      if (.not. allocated(error)) mark = text_mark(bytes)
   end function file_mark

   !> The mark of a text
   pure function text_mark(text) result(mark)
      character(len=*), intent(in) :: text  !! The text
      character(len=:), allocatable :: mark
      integer(int64) :: total(2)
      character(len=62) :: digits
      integer :: i

      total = 0
      do i = 1, len(text)
         total = modulo(total*place + ichar(text(i:i)), prime)
      end do
      write (digits, "(i0, 1x, i0, 1x, i0)") len(text, int64), total
      mark = trim(digits)
   end function text_mark
end module dda_file_mark
