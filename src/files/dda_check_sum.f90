!> Check sums: the CRC-32 of a text, and the sum of those of its lines
!>
!> The sum does not depend on the order of the lines: the sums of several tables add up to one,
!> however their lines were written in turns. zlib and Python know CRC-32, so that others can
!> compute it too.
module dda_check_sum
   use, intrinsic :: iso_fortran_env, only : int32, int64
   implicit none
   private

   public :: add_sums, crc_32, line_sum

   !> Sums are counted modulo 2 to this power
   integer, parameter :: bits = 32
   !> The polynomial of ISO 3309, the lowest bit first
   integer(int32), parameter :: polynomial = -306674912_int32

contains

   !> CRC-32 of a text
   pure integer(int64) function crc_32(text)
      character(len=*), intent(in) :: text  !! Any bytes
      integer(int32) :: remainder
      integer :: i

      remainder = not(0_int32)
      do i = 1, len(text)
         remainder = next_remainder(remainder, text(i:i))
      end do
      crc_32 = of_remainder(remainder)
   end function crc_32

   !> Sum of the CRC-32 of the lines of a text; the last one need not be ended
   pure integer(int64) function line_sum(text)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      integer(int32) :: remainder
      integer :: i

      line_sum = 0
      remainder = not(0_int32)
      do i = 1, len(text)
         if (text(i:i) == new_line("a")) then
            line_sum = add_sums(line_sum, of_remainder(remainder))
            remainder = not(0_int32)
         else
            remainder = next_remainder(remainder, text(i:i))
         end if
      end do
      ! nothing is left behind the end of a line
      line_sum = add_sums(line_sum, of_remainder(remainder))
   end function line_sum

   !> Two sums as one
   elemental integer(int64) function add_sums(first, second)
      integer(int64), intent(in) :: first   !! One sum; a negative one is taken away
      integer(int64), intent(in) :: second  !! The other

      add_sums = modulo(first + second, shiftl(1_int64, bits))
   end function add_sums

   !> The remainder after one more byte, half a byte at a time
   pure integer(int32) function next_remainder(remainder, byte) result(next)
      integer(int32), intent(in) :: remainder  !! The remainder so far
      character(len=1), intent(in) :: byte     !! The byte
      integer :: i
      ! what four bits do to a remainder, one after the other
      integer(int32), parameter :: half_byte(0:15) = [(int(i, int32), i=0, 15)]
      integer(int32), parameter :: bits_1(0:15) = ieor(shiftr(half_byte, 1), &
         & merge(polynomial, 0_int32, btest(half_byte, 0)))
      integer(int32), parameter :: bits_2(0:15) = ieor(shiftr(bits_1, 1), &
         & merge(polynomial, 0_int32, btest(bits_1, 0)))
      integer(int32), parameter :: bits_3(0:15) = ieor(shiftr(bits_2, 1), &
         & merge(polynomial, 0_int32, btest(bits_2, 0)))
      integer(int32), parameter :: bits_4(0:15) = ieor(shiftr(bits_3, 1), &
         & merge(polynomial, 0_int32, btest(bits_3, 0)))

      next = ieor(remainder, ichar(byte, int32))
      next = ieor(shiftr(next, 4), bits_4(iand(next, 15_int32)))
      next = ieor(shiftr(next, 4), bits_4(iand(next, 15_int32)))
   end function next_remainder

   !> A remainder as CRC-32
   pure integer(int64) function of_remainder(remainder)
      integer(int32), intent(in) :: remainder

      of_remainder = iand(int(not(remainder), int64), shiftl(1_int64, bits) - 1)
   end function of_remainder
end module dda_check_sum
