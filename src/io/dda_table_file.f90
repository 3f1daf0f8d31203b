!> Tables written line by line through the C library, which tells when a disk is full; Fortran's
!> flush does not
module dda_table_file
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_int, c_null_char, c_null_ptr, &
      & c_ptr, c_size_t
   use dda_error, only : error_t, fatal_error
   implicit none
   private

   public :: table_file_t, open_table, append_line, close_table, remove_file

   !> An open table
   type :: table_file_t
      private
      !> C's handle of the file
      type(c_ptr) :: handle = c_null_ptr
      !> Name of the file, for messages
      character(len=:), allocatable :: name
   end type table_file_t

   interface
      !> C: open a file
      function c_fopen(path, mode) bind(c, name="fopen") result(handle)
         import :: c_char, c_ptr
         !> Its name, ended by a null character
         character(kind=c_char), intent(in) :: path(*)
         !> What is wanted of it, ended by a null character
         character(kind=c_char), intent(in) :: mode(*)
         !> The file, null if it cannot be opened
         type(c_ptr) :: handle
      end function c_fopen

      !> C: write items
      function c_fwrite(items, size, count, handle) bind(c, name="fwrite") result(written)
         import :: c_char, c_ptr, c_size_t
         !> The items
         character(kind=c_char), intent(in) :: items(*)
         !> Size of an item
         integer(c_size_t), intent(in), value :: size
         !> Number of items
         integer(c_size_t), intent(in), value :: count
         !> The file
         type(c_ptr), intent(in), value :: handle
         !> Number of items written
         integer(c_size_t) :: written
      end function c_fwrite

      !> C: hand what is buffered to the system
      function c_fflush(handle) bind(c, name="fflush") result(failed)
         import :: c_int, c_ptr
         !> The file
         type(c_ptr), intent(in), value :: handle
         !> 0 if all is well
         integer(c_int) :: failed
      end function c_fflush

      !> C: remove a file
      function c_remove(path) bind(c, name="remove") result(failed)
         import :: c_char, c_int
         !> Its name, ended by a null character
         character(kind=c_char), intent(in) :: path(*)
         !> 0 if it was removed
         integer(c_int) :: failed
      end function c_remove

      !> C: close a file
      function c_fclose(handle) bind(c, name="fclose") result(failed)
         import :: c_int, c_ptr
         !> The file
         type(c_ptr), intent(in), value :: handle
         !> 0 if all is well
         integer(c_int) :: failed
      end function c_fclose
   end interface

contains

   !> Begin a table with its header
   subroutine open_table(file, header, table, error)
      !> Name of the file; one that exists is replaced
      character(len=*), intent(in) :: file
      !> First line
      character(len=*), intent(in) :: header
      !> The table
      type(table_file_t), intent(out) :: table
      !> Allocated if the file cannot be written
      type(error_t), allocatable, intent(out) :: error

      table%name = file
      table%handle = c_fopen(file//c_null_char, "w"//c_null_char)
      if (.not. c_associated(table%handle)) then
         call fatal_error(error, "a file that can be written is wanted, this one cannot", file, 1)
         return
      end if
      call append_line(table, header, error)
   end subroutine open_table

   !> Write one line, or several, so that it survives the end of the program
   subroutine append_line(table, line, error)
      !> The table
      type(table_file_t), intent(in) :: table
      !> The line
      character(len=*), intent(in) :: line
      !> Allocated if it cannot be written
      type(error_t), allocatable, intent(out) :: error
      integer(c_size_t) :: length, written
      integer(c_int) :: failed

      length = len(line) + 1
      written = c_fwrite(line//new_line("a"), 1_c_size_t, length, table%handle)
      failed = c_fflush(table%handle)
      if (written /= length .or. failed /= 0) &
         & call fatal_error(error, "the results find no room here", table%name, 1)
   end subroutine append_line

   !> Close a table
   subroutine close_table(table)
      !> The table; nothing happens to one that is not open
      type(table_file_t), intent(inout) :: table
      integer(c_int) :: failed

      if (c_associated(table%handle)) failed = c_fclose(table%handle)
      table%handle = c_null_ptr
   end subroutine close_table

   !> Remove a file of an earlier run; one that is not there is no failure
   subroutine remove_file(file)
      !> Name of the file
      character(len=*), intent(in) :: file
      integer(c_int) :: failed

      failed = c_remove(file//c_null_char)
   end subroutine remove_file
end module dda_table_file
