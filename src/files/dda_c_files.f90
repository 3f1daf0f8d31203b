!> Files of the C library: Fortran's open cuts the blanks at the end of a name, and its flush does
!> not say when a disk is full
module dda_c_files
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_ptr, c_size_t
   implicit none
   private

   public :: c_fopen, c_fdopen, c_fwrite, c_fflush, c_fileno, c_fsync
   public :: c_ferror, c_fclose, c_fread, c_access

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

      !> C: a file that the system has opened already
      function c_fdopen(descriptor, mode) bind(c, name="fdopen") result(handle)
         import :: c_char, c_int, c_ptr
         integer(c_int), intent(in), value :: descriptor  !! The system's number of the file
         character(kind=c_char), intent(in) :: mode(*)
         !> The file, null if there is none of that number
         type(c_ptr) :: handle
      end function c_fdopen

      !> C: write items
      function c_fwrite(items, size, count, handle) bind(c, name="fwrite") result(written)
         import :: c_ptr, c_size_t
         type(c_ptr), intent(in), value :: items        !! Where the items are
         integer(c_size_t), intent(in), value :: size   !! Size of an item
         integer(c_size_t), intent(in), value :: count  !! Number of items
         type(c_ptr), intent(in), value :: handle
         integer(c_size_t) :: written                   !! Number of items written
      end function c_fwrite

      !> C: hand what is buffered to the system
      function c_fflush(handle) bind(c, name="fflush") result(failed)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: failed  !! 0 if all is well
      end function c_fflush

      !> C: the system's number of a file
      function c_fileno(handle) bind(c, name="fileno") result(descriptor)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: descriptor
      end function c_fileno

      !> C: wait until the disk has what the system was given
      function c_fsync(descriptor) bind(c, name="fsync") result(failed)
         import :: c_int
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: failed
      end function c_fsync

      !> C: whether anything has failed since the file was opened
      function c_ferror(handle) bind(c, name="ferror") result(failed)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: failed
      end function c_ferror

      !> C: close a file
      function c_fclose(handle) bind(c, name="fclose") result(failed)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: failed
      end function c_fclose

      !> C: read items
      function c_fread(items, size, count, handle) bind(c, name="fread") result(got)
         import :: c_ptr, c_size_t
         type(c_ptr), intent(in), value :: items  !! Where the items go
         integer(c_size_t), intent(in), value :: size, count
         type(c_ptr), intent(in), value :: handle
         !> Number of items read; fewer at the end of the file
         integer(c_size_t) :: got
      end function c_fread

      !> C: what may be done with a file
      function c_access(path, mode) bind(c, name="access") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: mode  !! What is wanted; 0: that it exists
         integer(c_int) :: failed                   !! 0 if it may be done
      end function c_access
   end interface
end module dda_c_files
