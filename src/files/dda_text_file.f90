!> Read a text file into one string, report errors with their line, and compute a checksum
module dda_text_file
   use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_int64_t, c_loc, &
      & c_null_char, c_null_ptr, c_ptr, c_size_t
   use dda_check_sum, only : crc_32
   use dda_c_files, only : c_access, c_close, c_fclose, c_ferror, c_fdopen, c_fopen, c_fread, &
      & c_lseek, c_open
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : to_text
   use dda_utf_8, only : bad_byte, byte_name
   implicit none
   private

   public :: read_bytes, read_text_file, plain_text, is_plain_file
   public :: file_mark, text_mark

   !> One megabyte [bytes]
   integer, parameter :: megabyte = 1024**2
   !> Maximum size of a file [bytes]
   integer, parameter :: max_file_size = 512*megabyte
   !> Message about an empty file or a device without a length
   character(len=*), parameter :: no_bytes = "the file is empty; write into it"
   !> Names that the shell uses for pipes into the program; these always have a writer
   character(len=*), parameter :: stream(*) = [character(len=14) :: "/dev/stdin", "/dev/fd/", &
      & "/proc/self/fd/"]
   !> C's O_NONBLOCK on Linux, added to O_RDONLY (0): opening a pipe does not block
   integer(c_int), parameter :: at_once = 2048

contains

   !> Read a whole text file
   subroutine read_text_file(file, text, error)
      character(len=*), intent(in) :: file  !! Name of the file
      !> Its normalised text (see plain_text); empty after a failure
      character(len=:), allocatable, intent(out) :: text
      !> Allocated if the file is missing, irregular, too large, unreadable or not text
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: raw

      text = ""
      call read_bytes(file, raw, error)
      if (.not. allocated(error)) call plain_text(raw, text, error)
      if (.not. allocated(error)) return
      text = ""
      error%file = file
   end subroutine read_text_file

   !> Read a whole file unchanged, also from a pipe of the shell
   subroutine read_bytes(file, bytes, error)
      character(len=*), intent(in) :: file
      character(len=:), allocatable, intent(out) :: bytes  !! Its bytes; empty after a failure
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: handle
      integer(c_int) :: failed

      bytes = ""
      call check_name(file, error)
      if (allocated(error)) return
      call open_to_read(file, handle, error)
      if (allocated(error)) return
      call read_to_end(handle, bytes)
      failed = c_ferror(handle)
      if (failed /= 0) then
         call fatal_error(error, "the file cannot be read to its end; copy it to another place")
      else if (len(bytes) == 0) then
         call fatal_error(error, no_bytes)
      else if (len(bytes) > max_file_size) then
         call fatal_error(error, "expected a file of at most "//to_text(max_file_size/megabyte)// &
            " MB, got a larger one; split it")
      end if
      failed = c_fclose(handle)
   end subroutine read_bytes

   !> Open a file for reading. Only names of the shell may be pipes or devices: other pipes may have
   !> no writer, and devices no end
   subroutine open_to_read(file, handle, error)
      character(len=*), intent(in) :: file
      type(c_ptr), intent(out) :: handle  !! C's handle of the file
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: descriptor, failed
      integer(c_int64_t) :: length

      handle = c_null_ptr
      if (is_stream(file)) then
         handle = c_fopen(file//c_null_char, "rb"//c_null_char)
      else
         call open_plain(file, descriptor, length)
         if (length > 0) then
            handle = c_fdopen(descriptor, "rb"//c_null_char)
         else if (descriptor >= 0) then
            failed = c_close(descriptor)
            if (length < 0) call fatal_error(error, "expected a file, got a pipe or a device; " &
               & //"write its text into a file, or send it to /dev/stdin")
            if (length == 0) call fatal_error(error, no_bytes)
         end if
      end if
      if (.not. c_associated(handle) .and. .not. allocated(error)) call fatal_error(error, &
         & "the file cannot be read; check its permissions")
   end subroutine open_to_read

   !> True if the shell uses this name for a pipe
   pure logical function is_stream(file)
      character(len=*), intent(in) :: file
      integer :: i

      is_stream = any([(index(file, trim(stream(i))) == 1, i=1, size(stream))])
   end function is_stream

   !> Open a file without waiting for a writer
   subroutine open_plain(file, descriptor, length)
      character(len=*), intent(in) :: file
      integer(c_int), intent(out) :: descriptor    !! File descriptor; negative after a failure
      !> Its length, -1 for a pipe or a terminal; 0 for other devices [bytes]
      integer(c_int64_t), intent(out) :: length
      integer(c_int), parameter :: from_begin = 0, from_end = 2

      length = -1
      descriptor = c_open(file//c_null_char, at_once)
      if (descriptor < 0) return
      length = c_lseek(descriptor, 0_c_int64_t, from_end)
      if (c_lseek(descriptor, 0_c_int64_t, from_begin) /= 0) length = -1
   end subroutine open_plain

   !> True for an existing file or device that is no pipe
   logical function is_plain_file(file)
      character(len=*), intent(in) :: file
      integer(c_int) :: descriptor, failed
      integer(c_int64_t) :: length

      call open_plain(file, descriptor, length)
      if (descriptor >= 0) failed = c_close(descriptor)
      is_plain_file = length >= 0
   end function is_plain_file

   !> Check that a name can be that of a file
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

   !> Read an open file to its end, or to one byte above the size limit
   subroutine read_to_end(handle, bytes)
      type(c_ptr), intent(in) :: handle                    !! C's handle of the file
      character(len=:), allocatable, intent(out) :: bytes  !! The bytes that were read
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

   !> Normalise a text: line feeds as line ends, no byte order mark. Only UTF-8 without control
   !> characters except tabs is accepted
   pure subroutine plain_text(raw, text, error)
      character(len=*), intent(in) :: raw  !! Bytes of a file
      !> The text; lines end in a line feed instead of CR LF, CR or LF
      character(len=:), allocatable, intent(out) :: text
      type(error_t), allocatable, intent(out) :: error  !! Allocated for invalid bytes, with line
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
      i = bad_byte(text)
      if (i == 0) return
      line = 1
      do n = 1, i - 1
         if (text(n:n) == lf) line = line + 1
      end do
      call fatal_error(error, "expected text in UTF-8, got the byte "//byte_name(text(i:i)) &
         & //"; save the file as UTF-8", line=line)
   end subroutine plain_text

   !> Identification of a file: its length and checksum; a dash if it cannot be read
   function file_mark(file) result(mark)
      character(len=*), intent(in) :: file  !! Name of the file
      character(len=:), allocatable :: mark
      character(len=:), allocatable :: bytes
      type(error_t), allocatable :: error

      mark = "-"
      call read_bytes(file, bytes, error)
      if (.not. allocated(error)) mark = text_mark(bytes)
   end function file_mark

   !> Identification of a text: its length and checksum
   pure function text_mark(text) result(mark)
      character(len=*), intent(in) :: text  !! The text
      character(len=:), allocatable :: mark

      mark = to_text(len(text))//" "//to_text(real(crc_32(text), wp))
   end function text_mark
end module dda_text_file
