!> The lines of a table that a run may have left unfinished, and their fields
module dda_table_lines
   use, intrinsic :: iso_fortran_env, only : int64
   implicit none
   private

   public :: table_lines_t, open_lines, next_line, close_lines, n_fields, field

   !> Bytes read at a time
   integer, parameter :: chunk = 65536

   !> A table that is read line by line
   type :: table_lines_t
      private
      !> Fortran's unit
      integer :: unit = 0
      !> Whether there is a file
      logical :: is_open = .false.
      !> Bytes not read yet
      integer(int64) :: left = 0
      !> Bytes read but not handed out
      character(len=:), allocatable :: ahead
      !> Place of the first of them
      integer :: first = 1
   end type table_lines_t

contains

   !> Begin to read; a file that is not there has no lines
   subroutine open_lines(file, lines, most)
      !> Name of the file
      character(len=*), intent(in) :: file
      type(table_lines_t), intent(out) :: lines
      !> How much of it is read at most [bytes]; all of it without this
      integer(int64), intent(in), optional :: most
      integer :: stat

      lines%ahead = ""
      inquire (file=file, size=lines%left)
      if (present(most)) lines%left = min(lines%left, most)
      open (newunit=lines%unit, file=file, access="stream", form="unformatted", status="old", &
         & action="read", iostat=stat)
      lines%is_open = stat == 0
   end subroutine open_lines

   !> The next line that has its end; what follows the last line end was cut off and is no line
   subroutine next_line(lines, line, found)
      type(table_lines_t), intent(inout) :: lines
      !> The line without its end
      character(len=:), allocatable, intent(out) :: line
      !> Whether there was one
      logical, intent(out) :: found
      integer :: length

      found = .false.
      if (.not. lines%is_open) return
      length = index(lines%ahead(lines%first:), new_line("a"))
      do while (length == 0 .and. lines%left > 0)
         call read_ahead(lines)
         length = index(lines%ahead(lines%first:), new_line("a"))
      end do
      found = length > 0
      if (.not. found) return
      line = lines%ahead(lines%first:lines%first + length - 2)
      lines%first = lines%first + length
   end subroutine next_line

   !> Read more of the file
   subroutine read_ahead(lines)
      type(table_lines_t), intent(inout) :: lines
      character(len=:), allocatable :: more
      integer :: stat

      more = repeat(" ", int(min(int(chunk, int64), lines%left)))
      read (lines%unit, iostat=stat) more
      if (stat /= 0) then
         lines%left = 0
         return
      end if
      lines%left = lines%left - len(more)
      lines%ahead = lines%ahead(lines%first:)//more
      lines%first = 1
   end subroutine read_ahead

   !> End reading
   subroutine close_lines(lines)
      type(table_lines_t), intent(inout) :: lines

      if (lines%is_open) close (lines%unit)
      lines%is_open = .false.
   end subroutine close_lines

   !> Number of fields of a line
   pure integer function n_fields(line)
      !> Fields parted by commas; commas between double quotes part nothing
      character(len=*), intent(in) :: line
      logical :: quoted
      integer :: i

      quoted = .false.
      n_fields = 1
      do i = 1, len(line)
         if (line(i:i) == """") quoted = .not. quoted
         if (line(i:i) == "," .and. .not. quoted) n_fields = n_fields + 1
      end do
   end function n_fields

   !> One field of a line as it stands there; empty if there is none of that number
   pure function field(line, number) result(text)
      character(len=*), intent(in) :: line
      !> Which, from 1
      integer, intent(in) :: number
      character(len=:), allocatable :: text
      logical :: quoted
      integer :: i, n, start

      quoted = .false.
      n = 1
      start = 1
      text = ""
      do i = 1, len(line)
         if (line(i:i) == """") quoted = .not. quoted
         if (line(i:i) /= "," .or. quoted) cycle
         if (n == number) text = line(start:i - 1)
         if (n == number) return
         n = n + 1
         start = i + 1
      end do
      if (n == number) text = line(start:)
   end function field
end module dda_table_lines
