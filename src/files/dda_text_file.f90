!> A text file as one string, whatever its line ends, or a failure with a line; and the mark by
!> which another one of the same name is known
module dda_text_file
   use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_null_char, c_ptr, c_size_t
   use dda_check_sum, only : crc_32
   use dda_c_files, only : c_access, c_fclose, c_ferror, c_fopen, c_fread
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: read_bytes, read_text_file, plain_text
   public :: file_mark, text_mark

   !> One megabyte [bytes]
   integer, parameter :: megabyte = 1024**2
   !> Largest file that is read [bytes]
   integer, parameter :: max_file_size = 512*megabyte

contains

   !> Read a whole text file
   subroutine read_text_file(file, text, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Its text as plain_text makes it; empty after a failure
      character(len=:), allocatable, intent(out) :: text
      !> Missing, no plain file, too large, unreadable or not text
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: raw

      text = ""
      call read_bytes(file, raw, error)
      if (.not. allocated(error)) call plain_text(raw, text, error)
      if (.not. allocated(error)) return
      text = ""
      error%file = file
   end subroutine read_text_file

   !> Read a whole file as it is, be it a pipe
   subroutine read_bytes(file, bytes, error)
      character(len=*), intent(in) :: file
      character(len=:), allocatable, intent(out) :: bytes  !! Its bytes; empty after a failure
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: handle
      integer(c_int) :: failed

      bytes = ""
      call check_name(file, error)
      if (allocated(error)) return
      handle = c_fopen(file//c_null_char, "rb"//c_null_char)
      if (.not. c_associated(handle)) call fatal_error(error, &
         & "the file cannot be read; check its permissions")
      if (allocated(error)) return
      call read_to_end(handle, bytes)
      failed = c_ferror(handle)
      if (failed /= 0) then
         call fatal_error(error, "the file cannot be read to its end; copy it to another place")
      else if (len(bytes) == 0) then
         call fatal_error(error, "the file is empty; write into it")
      else if (len(bytes) > max_file_size) then
         call fatal_error(error, "expected a file of at most "//to_text(max_file_size/megabyte)// &
            " MB, got a larger one; split it")
      end if
      failed = c_fclose(handle)
   end subroutine read_bytes

   !> Whether a name stands for something that may be a file
   subroutine check_name(file, error)
      character(len=*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), parameter :: exists = 0

      if (len_trim(file) == 0) then
         call fatal_error(error, "expected the name of a file, got an empty one; give one")
      else if (c_access(file//"/."//c_null_char, exists) == 0) then
         call fatal_error(error, "expected a file, got a folder; name a file in it")
      else if (c_access(file//c_null_char, exists) /= 0) then
         if (c_access(file//".nml"//c_null_char, exists) == 0) then
            call fatal_error(error, "there is no such file; write "//file//".nml")
         else
            call fatal_error(error, "there is no such file; check the name and the folder")
         end if
      end if
   end subroutine check_name

   !> Read an open file to its end, or to one byte more than is allowed
   subroutine read_to_end(handle, bytes)
      type(c_ptr), intent(in) :: handle                    !! C's handle of the file
      character(len=:), allocatable, intent(out) :: bytes  !! What was read
      character(len=:), allocatable, target :: room, longer
      integer(c_size_t) :: n, got

      allocate (character(len=65536) :: room)
      n = 0
      do
         got = c_fread(c_loc(room(n + 1:n + 1)), 1_c_size_t, len(room) - n, handle)
         n = n + got
         if (n < len(room) .or. n > max_file_size) exit
         allocate (character(len=min(2*len(room), max_file_size + 1)) :: longer)
         longer(:n) = room(:n)
         call move_alloc(longer, room)
      end do
      bytes = room(:n)
   end subroutine read_to_end

   !> One kind of line end, no byte order mark, no control characters but the tab
   pure subroutine plain_text(raw, text, error)
      character(len=*), intent(in) :: raw  !! Bytes of a file
      !> The text: lines end in a line feed, whether they ended in CR LF, CR or LF
      character(len=:), allocatable, intent(out) :: text
      type(error_t), allocatable, intent(out) :: error  !! A control character, with its line
      character(len=1), parameter :: lf = achar(10), cr = achar(13), tab = achar(9)
      character(len=3), parameter :: mark = char(239)//char(187)//char(191)
      integer :: i, n, line, code

      text = raw
      n = 0
      line = 1
      do i = merge(4, 1, index(raw, mark) == 1), len(raw)
         if (raw(i:i) == lf .and. i > 1) then
            if (raw(i - 1:i - 1) == cr) cycle
         end if
         n = n + 1
         text(n:n) = merge(lf, raw(i:i), raw(i:i) == cr)
         if (text(n:n) == lf) line = line + 1
         code = ichar(text(n:n))
         if (code >= 32 .and. code /= 127 .or. text(n:n) == lf .or. text(n:n) == tab) cycle
         call fatal_error(error, "expected plain text, got a control character (code "// &
            to_text(code)//"); save the file as plain text", line=line)
         return
      end do
      text = text(:n)
   end subroutine plain_text

   !> The mark of a file: its length and check sum; a dash for one that cannot be read
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

      mark = to_text(len(text))//" "//to_text(real(crc_32(text), wp))
   end function text_mark
end module dda_text_file
