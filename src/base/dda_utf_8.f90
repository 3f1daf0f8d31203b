!> Characters in UTF-8, the only text encoding that the program reads and writes
module dda_utf_8
   implicit none
   private

   public :: bad_byte, byte_name

   !> First bytes of characters of two or more bytes, with the bounds of the second byte. Overlong
   !> codes, UTF-16 surrogates and codes above the last character are excluded
   integer, parameter :: n_lead = 8
   !> First and last lead byte of a row, bounds of the next byte, number of bytes that follow
   integer, parameter :: lead(5, n_lead) = reshape([ &
      & 194, 223, 128, 191, 1, &
      & 224, 224, 160, 191, 2, &
      & 225, 236, 128, 191, 2, &
      & 237, 237, 128, 159, 2, &
      & 238, 239, 128, 191, 2, &
      & 240, 240, 144, 191, 3, &
      & 241, 243, 128, 191, 3, &
      & 244, 244, 128, 143, 3], [5, n_lead])

contains

   !> Place of the first byte that is not valid UTF-8; 0 if there is none
   pure integer function bad_byte(text)
      character(len=*), intent(in) :: text  !! Any bytes
      integer :: i

      i = 1
      do while (i <= len(text))
         if (ichar(text(i:i)) < 128) then
            i = i + 1
         else
            bad_byte = i
            i = i + character_length(text(i:))
            if (i == bad_byte) return
         end if
      end do
      bad_byte = 0
   end function bad_byte

   !> Number of bytes of the character, not ASCII, at the start of a text; 0 if invalid
   pure integer function character_length(text) result(length)
      character(len=*), intent(in) :: text  !! Any bytes, at least one
      integer :: code(4), i, row

      code = 0
      do i = 1, min(4, len(text))
         code(i) = ichar(text(i:i))
      end do
      length = 0
      do row = 1, n_lead
         if (code(1) >= lead(1, row) .and. code(1) <= lead(2, row)) exit
      end do
      if (row > n_lead) return
      if (code(2) < lead(3, row) .or. code(2) > lead(4, row)) return
      if (any(code(3:lead(5, row) + 1) < 128 .or. code(3:lead(5, row) + 1) > 191)) return
      length = lead(5, row) + 1
   end function character_length

   !> Hexadecimal text of a byte for messages
   pure function byte_name(byte) result(name)
      character, intent(in) :: byte  !! Any byte
      character(len=4) :: name  !! Text such as 0xE9

      write (name, "(a, z2.2)") "0x", ichar(byte)
   end function byte_name
end module dda_utf_8
