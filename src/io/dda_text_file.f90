!> A text file as one string, whatever its line ends, or a failure with a line
module dda_text_file
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_error, only : error_t, fatal_error
   use dda_text, only : to_text
   implicit none
   private

   public :: read_text_file, plain_text, max_file_size

   !> One megabyte [bytes]
   integer, parameter :: megabyte = 1024**2
   !> Largest file that is read [bytes]
   integer, parameter :: max_file_size = 64*megabyte

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

   !> Read a whole file as it is
   subroutine read_bytes(file, bytes, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Its bytes; empty after a failure
      character(len=:), allocatable, intent(out) :: bytes
      !> Missing, no plain file, too large or unreadable
      type(error_t), allocatable, intent(out) :: error
      character(len=200) :: reason
      integer :: unit, stat, n

      bytes = ""
      call check_file(file, n, error)
      if (allocated(error)) return
      open (newunit=unit, file=file, access="stream", form="unformatted", status="old", &
         action="read", iostat=stat, iomsg=reason)
      if (stat == 0) then
         bytes = repeat(" ", n)
         read (unit, iostat=stat, iomsg=reason) bytes
         close (unit)
      end if
      if (stat == 0) return
      bytes = ""
      call fatal_error(error, "the file cannot be read: "//trim(reason))
   end subroutine read_bytes

   !> Whether a name stands for a plain file of a size that can be read
   subroutine check_file(file, n, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Size of the file [bytes]
      integer, intent(out) :: n
      !> Missing, a folder, empty or too large
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: file_size
      logical :: exists, is_folder

      n = 0
      inquire (file=file, exist=exists, size=file_size)
      inquire (file=file//"/.", exist=is_folder)
      if (len_trim(file) == 0) then
         call fatal_error(error, "wanted the name of a file, found an empty one")
      else if (is_folder) then
         call fatal_error(error, "wanted a file, found a folder")
      else if (.not. exists) then
         call fatal_error(error, "there is no such file")
      else if (file_size <= 0) then
         call fatal_error(error, "the file is empty")
      else if (file_size > max_file_size) then
         call fatal_error(error, "wanted a file of at most "//to_text(max_file_size/megabyte)// &
            " MB, found "//to_text(int((file_size - 1)/megabyte) + 1)//" MB")
      else
         n = int(file_size)
      end if
   end subroutine check_file

   !> One kind of line end, no byte order mark, no control characters but the tab
   pure subroutine plain_text(raw, text, error)
      !> Bytes of a file
      character(len=*), intent(in) :: raw
      !> The text: lines end in a line feed, whether they ended in CR LF, CR or LF
      character(len=:), allocatable, intent(out) :: text
      !> A control character, with its line
      type(error_t), allocatable, intent(out) :: error
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
         call fatal_error(error, "wanted plain text, found a control character (code "// &
            to_text(code)//")", line=line)
         return
      end do
      text = text(:n)
   end subroutine plain_text
end module dda_text_file
