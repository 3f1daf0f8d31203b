!> A check sum of the lines of a text that does not depend on their order: the sum of their CRC-32
!>
!> The sums of several tables add up to one, however their lines were written in turns; zlib and
!> Python know CRC-32, so that others can compute it too.
module dda_line_sum
   use, intrinsic :: iso_fortran_env, only : int32, int64
   implicit none
   private

   public :: line_sum, add_sums

   !> Sums are counted modulo 2 to this power
   integer, parameter :: bits = 32
   !> The polynomial of ISO 3309, the lowest bit first
   integer(int32), parameter :: polynomial = -306674912_int32

contains

   !> Sum of the CRC-32 of the lines of a text; the last one need not be ended
   pure integer(int64) function line_sum(text)
      !> The text, lines ended by line feeds
      character(len=*), intent(in) :: text
      integer :: i
      ! what eight bits do to a remainder, one after the other
      integer(int32), parameter :: byte(0:255) = [(int(i, int32), i=0, 255)]
      integer(int32), parameter :: bits_1(0:255) = ieor(shiftr(byte, 1), &
         & merge(polynomial, 0_int32, btest(byte, 0)))
      integer(int32), parameter :: bits_2(0:255) = ieor(shiftr(bits_1, 1), &
         & merge(polynomial, 0_int32, btest(bits_1, 0)))
      integer(int32), parameter :: bits_3(0:255) = ieor(shiftr(bits_2, 1), &
         & merge(polynomial, 0_int32, btest(bits_2, 0)))
      integer(int32), parameter :: bits_4(0:255) = ieor(shiftr(bits_3, 1), &
         & merge(polynomial, 0_int32, btest(bits_3, 0)))
      integer(int32), parameter :: bits_5(0:255) = ieor(shiftr(bits_4, 1), &
         & merge(polynomial, 0_int32, btest(bits_4, 0)))
      integer(int32), parameter :: bits_6(0:255) = ieor(shiftr(bits_5, 1), &
         & merge(polynomial, 0_int32, btest(bits_5, 0)))
      integer(int32), parameter :: bits_7(0:255) = ieor(shiftr(bits_6, 1), &
         & merge(polynomial, 0_int32, btest(bits_6, 0)))
      integer(int32), parameter :: bits_8(0:255) = ieor(shiftr(bits_7, 1), &
         & merge(polynomial, 0_int32, btest(bits_7, 0)))
      integer(int32) :: remainder

      line_sum = 0
      remainder = not(0_int32)
      do i = 1, len(text)
         if (text(i:i) == new_line("a")) then
            line_sum = add_sums(line_sum, of_remainder(remainder))
            remainder = not(0_int32)
         else
            remainder = ieor(shiftr(remainder, 8), &
               & bits_8(iand(ieor(remainder, ichar(text(i:i), int32)), 255_int32)))
         end if
      end do
      if (len(text) == 0) return
      if (text(len(text):) /= new_line("a")) line_sum = add_sums(line_sum, of_remainder(remainder))
   end function line_sum

   !> Two sums as one
   elemental integer(int64) function add_sums(first, second)
      !> One sum; a negative one is taken away
      integer(int64), intent(in) :: first
      !> The other
      integer(int64), intent(in) :: second

      add_sums = modulo(first + second, shiftl(1_int64, bits))
   end function add_sums

   !> A remainder as CRC-32
   elemental integer(int64) function of_remainder(remainder)
      !> The remainder
      integer(int32), intent(in) :: remainder

      of_remainder = iand(int(not(remainder), int64), shiftl(1_int64, bits) - 1)
   end function of_remainder
end module dda_line_sum
