!> Length and check sums of a file, by which another one of the same name is known
module dda_file_mark
   use, intrinsic :: iso_fortran_env, only : int64
   implicit none
   private

   public :: file_mark, text_mark

   !> Bytes read at a time
   integer, parameter :: chunk = 65536
   !> The sums are polynomials at these places, modulo these primes
   integer(int64), parameter :: place(2) = [257_int64, 263_int64]
   integer(int64), parameter :: prime(2) = [2147483629_int64, 2147483587_int64]

contains

   !> The mark of a file: three numbers; a dash for one that cannot be read
   function file_mark(file) result(mark)
      character(len=*), intent(in) :: file  !! Name of the file
      character(len=:), allocatable :: mark
      character(len=chunk) :: bytes
      integer(int64) :: length, left, total(2)
      integer :: n, unit, stat

      mark = "-"
      open (newunit=unit, file=file, access="stream", form="unformatted", status="old", &
         & action="read", iostat=stat)
      if (stat /= 0) return
      inquire (unit=unit, size=length)
      total = 0
      left = length
      do while (left > 0 .and. stat == 0)
         n = int(min(int(chunk, int64), left))
         read (unit, iostat=stat) bytes(:n)
         call add_bytes(bytes(:n), total)
         left = left - n
      end do
      close (unit)
      if (stat == 0) mark = numbers(length, total)
   end function file_mark

   !> The mark of a text
   pure function text_mark(text) result(mark)
      character(len=*), intent(in) :: text  !! The text
      character(len=:), allocatable :: mark
      integer(int64) :: total(2)

      total = 0
      call add_bytes(text, total)
      mark = numbers(len(text, int64), total)
   end function text_mark

   !> Add bytes to the check sums
   pure subroutine add_bytes(bytes, total)
      character(len=*), intent(in) :: bytes      !! The bytes
      integer(int64), intent(inout) :: total(2)  !! The sums: (2)
      integer :: i

      do i = 1, len(bytes)
         total = modulo(total*place + ichar(bytes(i:i)), prime)
      end do
   end subroutine add_bytes

   !> Length and sums in digits
   pure function numbers(length, total) result(text)
      integer(int64), intent(in) :: length  !! Length [bytes]
      integer(int64), intent(in) :: total(2)
      character(len=:), allocatable :: text
      character(len=62) :: digits

      write (digits, "(i0, 1x, i0, 1x, i0)") length, total
      text = trim(digits)
   end function numbers
end module dda_file_mark
