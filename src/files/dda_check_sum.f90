!> Checksums: the CRC-32 of a text, and the sum over its lines
!>
!> The sum does not depend on the order of the lines, so the sums of several tables can be added.
!> CRC-32 is that of zlib and Python
module dda_check_sum
   use, intrinsic :: iso_fortran_env, only : int32, int64
   implicit none
   private

   public :: add_sums, crc_32, line_sum

   !> Bits of a checksum
   integer, parameter :: bits = 32
   !> The polynomial of ISO 3309, the lowest bit first
   integer(int32), parameter :: polynomial = -306674912_int32

contains

   !> CRC-32 of a text, computed for half a byte at a time
   pure integer(int64) function crc_32(text)
      character(len=*), intent(in) :: text  !! Any bytes
      integer :: i
      ! effect of each four bits on a remainder
      integer(int32), parameter :: half_byte(0:15) = [(int(i, int32), i=0, 15)]
      integer(int32), parameter :: bits_1(0:15) = ieor(shiftr(half_byte, 1), &
         & merge(polynomial, 0_int32, btest(half_byte, 0)))
      integer(int32), parameter :: bits_2(0:15) = ieor(shiftr(bits_1, 1), &
         & merge(polynomial, 0_int32, btest(bits_1, 0)))
      integer(int32), parameter :: bits_3(0:15) = ieor(shiftr(bits_2, 1), &
         & merge(polynomial, 0_int32, btest(bits_2, 0)))
      integer(int32), parameter :: bits_4(0:15) = ieor(shiftr(bits_3, 1), &
         & merge(polynomial, 0_int32, btest(bits_3, 0)))
      integer(int32) :: rest

      rest = not(0_int32)
      do i = 1, len(text)
         rest = ieor(rest, ichar(text(i:i), int32))
         rest = ieor(shiftr(rest, 4), bits_4(iand(rest, 15_int32)))
         rest = ieor(shiftr(rest, 4), bits_4(iand(rest, 15_int32)))
      end do
      crc_32 = iand(int(not(rest), int64), shiftl(1_int64, bits) - 1)
   end function crc_32

   !> Sum of the CRC-32 of the lines of a text; the last line may lack a line feed
   pure integer(int64) function line_sum(text)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      integer :: first, length

      line_sum = 0
      first = 1
      do while (first <= len(text))
         length = index(text(first:), new_line("a")) - 1
         if (length < 0) length = len(text) - first + 1
         line_sum = add_sums(line_sum, crc_32(text(first:first + length - 1)))
         first = first + length + 1
      end do
   end function line_sum

   !> Combine two sums
   elemental integer(int64) function add_sums(first, second)
      integer(int64), intent(in) :: first   !! One sum; a negative one is subtracted
      integer(int64), intent(in) :: second  !! The other sum

      add_sums = modulo(first + second, shiftl(1_int64, bits))
   end function add_sums
end module dda_check_sum
