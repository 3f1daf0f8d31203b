!> Tables written line by line, each line safe on its own
module dda_table_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_binary_file, only : append_text, binary_file_t, close_binary, flush_binary, &
      & open_binary, position_of, sync_binary
   use dda_error, only : error_t, fatal_error
   use dda_line_sum, only : add_sums, line_sum
   implicit none
   private

   public :: table_file_t, open_table, append_line, close_table, remove_file
   public :: open_part, keep_line, settle_part, part_name, rename_part, sync_table, length_of
   public :: sum_of

   !> An open table
   type :: table_file_t
      private
      !> Its file
      type(binary_file_t) :: file
      !> Check sum of the lines that were appended since it was opened
      integer(int64) :: lines = 0
   end type table_file_t

   interface
      !> C: remove a file
      function c_remove(path) bind(c, name="remove") result(failed)
         import :: c_char, c_int
         !> Its name, ended by a null character
         character(kind=c_char), intent(in) :: path(*)
         !> 0 if it was removed
         integer(c_int) :: failed
      end function c_remove

      !> C: give a file another name; one of that name is replaced at once, never half
      function c_rename(from, to) bind(c, name="rename") result(failed)
         import :: c_char, c_int
         !> Its name, ended by a null character
         character(kind=c_char), intent(in) :: from(*)
         !> Its new name, likewise
         character(kind=c_char), intent(in) :: to(*)
         !> 0 if it was renamed
         integer(c_int) :: failed
      end function c_rename
   end interface

contains

   !> Begin a table with its header
   subroutine open_table(file, header, table, error)
      !> Name of the file; one that exists is replaced
      character(len=*), intent(in) :: file
      !> First line
      character(len=*), intent(in) :: header
      type(table_file_t), intent(out) :: table
      !> Allocated if the file cannot be written
      type(error_t), allocatable, intent(out) :: error

      call open_binary(file, table%file, error)
      if (.not. allocated(error)) call append_line(table, header, error)
   end subroutine open_table

   !> Write one line, or several, so that it survives the end of the program; nothing is no line
   subroutine append_line(table, line, error)
      type(table_file_t), intent(inout) :: table
      !> The line
      character(len=*), intent(in) :: line
      type(error_t), allocatable, intent(out) :: error

      if (len(line) == 0) return
      table%lines = add_sums(table%lines, line_sum(line))
      call append_text(table%file, line//new_line("a"))
      call flush_binary(table%file, error)
   end subroutine append_line

   !> Write so that every line up to here survives a loss of power
   subroutine sync_table(table, error)
      !> The table; nothing happens to one that is not open
      type(table_file_t), intent(in) :: table
      type(error_t), allocatable, intent(inout) :: error

      call sync_binary(table%file, error)
   end subroutine sync_table

   !> Length of an open table, 0 of one that is not open [bytes]
   integer(int64) function length_of(table)
      type(table_file_t), intent(in) :: table

      length_of = position_of(table%file)
   end function length_of

   !> Check sum of the lines that were appended to a table since it was opened, modulo 2**32
   pure integer(int64) function sum_of(table)
      type(table_file_t), intent(in) :: table

      sum_of = table%lines
   end function sum_of

   !> Close a table
   subroutine close_table(table, error)
      type(table_file_t), intent(inout) :: table
      !> An earlier failure, or that of closing it
      type(error_t), allocatable, intent(inout) :: error
      type(error_t), allocatable :: late

      call close_binary(table%file, late)
      if (allocated(late) .and. .not. allocated(error)) call move_alloc(late, error)
   end subroutine close_table

   !> Begin a table beside the one that it will replace
   subroutine open_part(file, header, table, error)
      !> Name of the table
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: header
      type(table_file_t), intent(out) :: table
      type(error_t), allocatable, intent(out) :: error

      call open_table(part_name(file), header, table, error)
   end subroutine open_part

   !> Name of a file that is not whole yet
   pure function part_name(file) result(name)
      !> Name that it will have
      character(len=*), intent(in) :: file
      character(len=:), allocatable :: name

      name = file//".part"
   end function part_name

   !> Write one line that need not be safe yet
   subroutine keep_line(table, line)
      type(table_file_t), intent(in) :: table
      character(len=*), intent(in) :: line

      call append_text(table%file, line//new_line("a"))
   end subroutine keep_line

   !> Put a table begun beside in the place of the one that it replaces; it stays open
   subroutine settle_part(file, table, error)
      character(len=*), intent(in) :: file
      type(table_file_t), intent(in) :: table
      type(error_t), allocatable, intent(out) :: error

      ! on the disk first: its name must not outlive its lines
      call sync_binary(table%file, error)
      if (.not. allocated(error)) call rename_part(file, error)
   end subroutine settle_part

   !> Give a file begun beside another one the other's name
   subroutine rename_part(file, error)
      character(len=*), intent(in) :: file
      !> Allocated if it cannot be replaced
      type(error_t), allocatable, intent(out) :: error

      if (c_rename(part_name(file)//c_null_char, file//c_null_char) /= 0) &
         & call fatal_error(error, "the file cannot be replaced; choose another folder with "// &
         & "--out", file)
   end subroutine rename_part

   !> Remove a file of an earlier run; one that is not there is no failure
   subroutine remove_file(file)
      character(len=*), intent(in) :: file
      integer(c_int) :: failed

      failed = c_remove(file//c_null_char)
   end subroutine remove_file
end module dda_table_file
