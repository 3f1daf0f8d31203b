!> Tables written line by line, and detection of incomplete lines
module dda_table_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_binary_file, only : append_text, binary_file_t, close_binary, flush_binary, &
      & open_binary
   use dda_check_sum, only : add_sums, line_sum
   use dda_error, only : error_t, fatal_error
   use dda_text_file, only : is_plain_file
   implicit none
   private

   public :: table_file_t, open_table, append_line, close_table, remove_file
   public :: keep_line, part_name, rename_part, table_lines_t, open_lines, next_line, close_lines
   public :: first_line, n_fields, field_ends, field, field_number, without_field

   !> A table open for writing
   type :: table_file_t
      type(binary_file_t) :: file   !! File of the table
      integer(int64) :: length = 0  !! Length of its lines, 0 if it is not open [bytes]
      integer(int64) :: sum = 0     !! Checksum of the lines appended since it was opened
   end type table_file_t

   interface
      !> C: remove a file
      function c_remove(path) bind(c, name="remove") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)  !! Its name, ended by a null character
         integer(c_int) :: failed                       !! 0 if it was removed
      end function c_remove

      !> C: rename a file; a file of the new name is replaced atomically
      function c_rename(from, to) bind(c, name="rename") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: from(*)  !! Its name, ended by a null character
         character(kind=c_char), intent(in) :: to(*)    !! New name, ended by a null character
         integer(c_int) :: failed                       !! 0 if it was renamed
      end function c_rename
   end interface

   !> Bytes per read
   integer, parameter :: chunk = 65536

   !> A table that is read line by line
   type :: table_lines_t
      private
      integer :: unit = 0                     !! Fortran unit
      logical :: is_open = .false.            !! True if the file is open
      integer(int64) :: left = 0              !! Bytes not read yet
      character(len=:), allocatable :: ahead  !! Bytes read but not yet returned
      integer :: first = 1                    !! First unreturned byte in ahead
   end type table_lines_t

contains

   !> Begin a table with its header
   subroutine open_table(file, header, table, error)
      character(len=*), intent(in) :: file    !! Name of the file; one that exists is replaced
      character(len=*), intent(in) :: header  !! First line
      type(table_file_t), intent(out) :: table
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the file cannot be written

      call open_binary(file, table%file, error)
      if (.not. allocated(error)) call append_line(table, header, error)
   end subroutine open_table

   !> Write and flush one or several lines; an empty text writes nothing
   subroutine append_line(table, line, error)
      type(table_file_t), intent(inout) :: table
      character(len=*), intent(in) :: line  !! The line
      type(error_t), allocatable, intent(out) :: error

      if (len(line) == 0) return
      table%sum = add_sums(table%sum, line_sum(line))
      call keep_line(table, line)
      call flush_binary(table%file, error)
   end subroutine append_line

   !> Close a table
   subroutine close_table(table, error)
      type(table_file_t), intent(inout) :: table
      !> Kept if allocated; otherwise set if closing fails
      type(error_t), allocatable, intent(inout) :: error
      type(error_t), allocatable :: late

      call close_binary(table%file, late)
      if (allocated(late) .and. .not. allocated(error)) call move_alloc(late, error)
   end subroutine close_table

   !> Name of an incomplete file
   pure function part_name(file) result(name)
      character(len=*), intent(in) :: file  !! Name of the complete file
      character(len=:), allocatable :: name

      name = file//".part"
   end function part_name

   !> Write one line without flushing
   subroutine keep_line(table, line)
      type(table_file_t), intent(inout) :: table
      character(len=*), intent(in) :: line

      table%length = table%length + len(line) + 1
      call append_text(table%file, line//new_line("a"))
   end subroutine keep_line

   !> Rename a complete file from its temporary name, replacing an older file
   subroutine rename_part(file, error)
      character(len=*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error  !! Allocated if it cannot be replaced

      if (c_rename(part_name(file)//c_null_char, file//c_null_char) /= 0) &
         & call fatal_error(error, "the file cannot be replaced; choose another folder with "// &
         & "--out", file)
   end subroutine rename_part

   !> Remove a file of an earlier run; a missing file is no error
   subroutine remove_file(file)
      character(len=*), intent(in) :: file
      integer(c_int) :: failed

      failed = c_remove(file//c_null_char)
   end subroutine remove_file

   !> Start reading; a missing file has no lines
   subroutine open_lines(file, lines, most)
      character(len=*), intent(in) :: file  !! Name of the file
      type(table_lines_t), intent(out) :: lines
      !> Maximum number of bytes to read [bytes]; the whole file if absent
      integer(int64), intent(in), optional :: most
      integer :: stat

      lines%ahead = ""
      if (.not. is_plain_file(file)) return
      inquire (file=file, size=lines%left)
      if (present(most)) lines%left = min(lines%left, most)
      open (newunit=lines%unit, file=file, access="stream", form="unformatted", status="old", &
         & action="read", iostat=stat)
      lines%is_open = stat == 0
   end subroutine open_lines

   !> Return the next complete line; text after the last line end is incomplete and ignored
   subroutine next_line(lines, line, found)
      type(table_lines_t), intent(inout) :: lines
      character(len=:), allocatable, intent(out) :: line  !! The line without its end
      logical, intent(out) :: found                       !! True if there was a line
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

   !> First line of a file, at most one chunk; empty if there is none
   function first_line(file) result(line)
      character(len=*), intent(in) :: file
      character(len=:), allocatable :: line  !! The line with its line end, if it has one
      type(table_lines_t) :: lines
      logical :: found

      call open_lines(file, lines, int(chunk, int64))
      call next_line(lines, line, found)
      if (found) then
         line = line//new_line("a")
      else
         line = lines%ahead
      end if
      call close_lines(lines)
   end function first_line

   !> Read the next chunk
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

   !> Close the file
   subroutine close_lines(lines)
      type(table_lines_t), intent(inout) :: lines

      if (lines%is_open) close (lines%unit)
      lines%is_open = .false.
   end subroutine close_lines

   !> Number of fields of a line
   pure integer function n_fields(line, separator)
      !> Fields separated by commas; commas in double quotes do not separate
      character(len=*), intent(in) :: line
      character, intent(in), optional :: separator  !! Separator; a comma if absent
      character :: mark
      logical :: quoted
      integer :: i

      mark = ","
      if (present(separator)) mark = separator
      quoted = .false.
      n_fields = 1
      do i = 1, len(line)
         if (line(i:i) == """") quoted = .not. quoted
         if (line(i:i) == mark .and. .not. quoted) n_fields = n_fields + 1
      end do
   end function n_fields

   !> Text of a field; empty if there is no such field
   pure function field(line, number) result(text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number  !! Number of the field, from 1
      character(len=:), allocatable :: text
      integer :: ends(2)

      ends = field_ends(line, number)
      text = line(ends(1):ends(2))
   end function field

   !> A line with the contents of one field removed; unchanged if there is no such field
   pure function without_field(line, number) result(text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number  !! Number of the field, from 1
      character(len=:), allocatable :: text
      integer :: ends(2)

      ends = field_ends(line, number)
      text = line(:ends(1) - 1)//line(ends(2) + 1:)
   end function without_field

   !> First and last character of a field; the last precedes the first if it is empty or missing
   pure function field_ends(line, number, separator) result(ends)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number                 !! Number of the field, from 1
      character, intent(in), optional :: separator  !! Separator; a comma if absent
      integer :: ends(2)
      character :: mark
      logical :: quoted
      integer :: i, n

      mark = ","
      if (present(separator)) mark = separator
      quoted = .false.
      n = 1
      ends = [1, len(line)]
      do i = 1, len(line)
         if (line(i:i) == """") quoted = .not. quoted
         if (line(i:i) /= mark .or. quoted) cycle
         if (n == number) ends(2) = i - 1
         if (n == number) return
         n = n + 1
         ends(1) = i + 1
      end do
      if (n /= number) ends = [1, 0]
   end function field_ends

   !> Number of the field that holds a name, 0 if there is none
   pure integer function field_number(header, name) result(number)
      character(len=*), intent(in) :: header
      character(len=*), intent(in) :: name  !! Name of the column

      do number = n_fields(header), 1, -1
         if (field(header, number) == name) return
      end do
   end function field_number

end module dda_table_file
