!> Files of numbers in the machine's own form, whole and with a check sum at their end, by which a
!> damaged one is known
submodule (dda_restart) dda_number_file
   use dda_binary_file, only : append_integers, append_length, append_reals, append_text, &
      & binary_file_t, close_binary, open_binary, sync_binary
   use dda_table_file, only : part_name, rename_part
   use dda_text_file, only : read_bytes
   implicit none

   !> The sum is a polynomial at this place, modulo this prime: any change of a half-word changes it
   integer(int64), parameter :: place = 257, prime = 2147483647

contains

   !> Write a file
   module procedure write_numbers
      type(error_t), allocatable :: late
      type(binary_file_t) :: opened
      integer(int32) :: n(2)

      call open_binary(part_name(file), opened, error)
      if (allocated(error)) return
      n = [size(whole), size(number)]
      call append_text(opened, title)
      call append_integers(opened, n)
      call append_integers(opened, whole)
      call append_reals(opened, reshape(number, [size(number), 1]))
      call append_length(opened, check_sum(n, whole, number))
      call sync_binary(opened, error)
      call close_binary(opened, late)
      if (allocated(late) .and. .not. allocated(error)) call move_alloc(late, error)
      if (.not. allocated(error)) call rename_part(file, error)
   end procedure write_numbers

   !> Read a file that is whole
   module procedure read_numbers
      character(len=:), allocatable :: bytes
      type(error_t), allocatable :: failure
      integer(int32) :: n(2)
      integer :: at
      logical :: sound

      ! by C: two threads may read one file
      call read_bytes(file, bytes, failure)
      if (allocated(failure)) then
         call fatal_error(error, "the file cannot be read; check its name", file, 1)
      else if (index(bytes, title) /= 1) then
         call fatal_error(error, "expected a "//title//" file, got another one; write it again", &
            & file, 1)
      else
         n = -1
         if (len(bytes) >= len(title) + 16) n = transfer(bytes(len(title) + 1:), n)
         sound = all(n >= 0)
         if (sound) sound = len(bytes, int64) == len(title) + 16 + 4*int(n(1), int64) &
            & + 8*int(n(2), int64)
         if (sound) then
            at = len(title) + 8 + 4*n(1)
            whole = transfer(bytes(len(title) + 9:at), 0_int32, n(1))
            number = transfer(bytes(at + 1:at + 8*n(2)), 0.0_wp, n(2))
            sound = transfer(bytes(at + 8*n(2) + 1:), 0_int64) == check_sum(n, whole, number)
         end if
         if (.not. sound) call fatal_error(error, "expected a file as it was written, got a "// &
            & "damaged one; write it again", file, 1)
      end if
   end procedure read_numbers

   !> The check sum of a file
   pure integer(int64) function check_sum(n, whole, number)
      integer(int32), intent(in) :: n(2)  !! How many numbers there are: (2)
      integer(int32), intent(in) :: whole(:)
      real(wp), intent(in) :: number(:)
      integer :: i

      check_sum = 1
      call add_words(n, check_sum)
      call add_words(whole, check_sum)
      do i = 1, size(number)
         call add_words(transfer(number(i), n), check_sum)
      end do
   end function check_sum

   !> Add words of 32 bits to a check sum, half a word at a time: what is added is below the prime
   pure subroutine add_words(words, sum_so_far)
      integer(int32), intent(in) :: words(:)       !! The words: (:)
      integer(int64), intent(inout) :: sum_so_far  !! The check sum
      integer :: i

      do i = 1, size(words)
         sum_so_far = mod(sum_so_far*place + ibits(words(i), 0, 16), prime)
         sum_so_far = mod(sum_so_far*place + ibits(words(i), 16, 16), prime)
      end do
   end subroutine add_words

end submodule dda_number_file
