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

   !> CRC-32 of a text
   pure integer(int64) function crc_32(text)
      character(len=*), intent(in) :: text  !! Any bytes
      integer(int32) :: rest
      integer :: i

      rest = not(0_int32)
      do i = 1, len(text)
         rest = with_byte(rest, ichar(text(i:i), int32))
      end do
      crc_32 = checksum_of(rest)
   end function crc_32

   !> Sum of the CRC-32 of the lines of a text; the last line may lack a line feed
   pure integer(int64) function line_sum(text)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      integer(int32) :: rest
      integer :: i

      line_sum = 0
      rest = not(0_int32)
      do i = 1, len(text)
         if (text(i:i) /= new_line("a")) rest = with_byte(rest, ichar(text(i:i), int32))
         if (text(i:i) /= new_line("a") .and. i < len(text)) cycle
         line_sum = add_sums(line_sum, checksum_of(rest))
         rest = not(0_int32)
      end do
   end function line_sum

   !> Remainder of a text with one byte more
   elemental integer(int32) function with_byte(rest, byte)
      integer(int32), intent(in) :: rest  !! Remainder of the text before it
      integer(int32), intent(in) :: byte  !! The byte
      integer :: k
      ! a remainder of half a byte after one, two, three and four of its bits: (0:15)
      integer(int32), parameter :: half_byte(0:15) = [(int(k, int32), k=0, 15)]
      integer(int32), parameter :: bits_1(0:15) = ieor(shiftr(half_byte, 1), &
         & merge(polynomial, 0_int32, btest(half_byte, 0)))
      integer(int32), parameter :: bits_2(0:15) = ieor(shiftr(bits_1, 1), &
         & merge(polynomial, 0_int32, btest(bits_1, 0)))
      integer(int32), parameter :: bits_3(0:15) = ieor(shiftr(bits_2, 1), &
         & merge(polynomial, 0_int32, btest(bits_2, 0)))
      integer(int32), parameter :: bits_4(0:15) = ieor(shiftr(bits_3, 1), &
         & merge(polynomial, 0_int32, btest(bits_3, 0)))
      ! a remainder of one byte after four and after eight of its bits: (0:255)
      integer(int32), parameter :: half(0:255) = [(ieor(int(shiftr(k, 4), int32), &
         & bits_4(iand(k, 15))), k=0, 255)]
      integer(int32), parameter :: whole(0:255) = ieor(shiftr(half, 4), bits_4(iand(half, 15)))

      with_byte = ieor(shiftr(rest, 8), whole(iand(ieor(rest, byte), 255_int32)))
   end function with_byte

   !> Checksum of a text from its remainder
   elemental integer(int64) function checksum_of(rest)
      integer(int32), intent(in) :: rest  !! The remainder

      checksum_of = iand(int(not(rest), int64), shiftl(1_int64, bits) - 1)
   end function checksum_of

   !> Combine two sums
   elemental integer(int64) function add_sums(first, second)
      integer(int64), intent(in) :: first   !! One sum; a negative one is subtracted
      integer(int64), intent(in) :: second  !! The other sum

      add_sums = modulo(first + second, shiftl(1_int64, bits))
   end function add_sums
end module dda_check_sum
