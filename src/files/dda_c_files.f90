!> Files of the C library: names may end with blanks, and a full disk is reported
module dda_c_files
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_int64_t, c_intptr_t, c_ptr, c_size_t
   implicit none
   private

   public :: c_fopen, c_fdopen, c_fwrite, c_fflush, c_fileno
   public :: c_ferror, c_fclose, c_fread, c_access, c_open, c_close, c_lseek, c_unlink, c_readlink

   interface
      !> C: open a file
      function c_fopen(path, mode) bind(c, name="fopen") result(handle)
         import :: c_char, c_ptr
         character(kind=c_char), intent(in) :: path(*)  !! Its name, ended by a null character
         character(kind=c_char), intent(in) :: mode(*)  !! Access mode, ended by a null character
         type(c_ptr) :: handle                          !! The file, null if it cannot be opened
      end function c_fopen

      !> C: use a file that the system has already opened
      function c_fdopen(descriptor, mode) bind(c, name="fdopen") result(handle)
         import :: c_char, c_int, c_ptr
         integer(c_int), intent(in), value :: descriptor  !! File descriptor
         character(kind=c_char), intent(in) :: mode(*)
         type(c_ptr) :: handle  !! The file, null if the descriptor is invalid
      end function c_fdopen

      !> C: write items
      function c_fwrite(items, size, count, handle) bind(c, name="fwrite") result(written)
         import :: c_ptr, c_size_t
         type(c_ptr), intent(in), value :: items        !! Address of the items
         integer(c_size_t), intent(in), value :: size   !! Size of an item
         integer(c_size_t), intent(in), value :: count  !! Number of items
         type(c_ptr), intent(in), value :: handle
         integer(c_size_t) :: written                   !! Number of items written
      end function c_fwrite

      !> C: pass buffered data to the system
      function c_fflush(handle) bind(c, name="fflush") result(failed)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: failed  !! 0 on success
      end function c_fflush

      !> C: file descriptor
      function c_fileno(handle) bind(c, name="fileno") result(descriptor)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int) :: descriptor
      end function c_fileno

      !> C: error indicator of a file
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
         type(c_ptr), intent(in), value :: items  !! Address that receives the items
         integer(c_size_t), intent(in), value :: size, count
         type(c_ptr), intent(in), value :: handle
         integer(c_size_t) :: got  !! Number of items read; fewer at the end of the file
      end function c_fread

      !> C: check access to a file
      function c_access(path, mode) bind(c, name="access") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: mode  !! Access to check; 0 for existence
         integer(c_int) :: failed                   !! 0 if the access is allowed
      end function c_access

      !> C: open a file without buffer
      function c_open(path, flags) bind(c, name="open") result(descriptor)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: flags  !! Open mode
         integer(c_int) :: descriptor                !! File descriptor; negative after a failure
      end function c_open

      !> C: close a file descriptor
      function c_close(descriptor) bind(c, name="close") result(failed)
         import :: c_int
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: failed
      end function c_close

      !> C: move to a position in a file
      function c_lseek(descriptor, offset, origin) bind(c, name="lseek") result(place)
         import :: c_int, c_int64_t
         integer(c_int), intent(in), value :: descriptor
         integer(c_int64_t), intent(in), value :: offset  !! Distance from the origin [bytes]
         integer(c_int), intent(in), value :: origin      !! 0: from the beginning, 2: from the end
         !> Position from the beginning [bytes]; negative for a pipe or a terminal
         integer(c_int64_t) :: place
      end function c_lseek

      !> C: remove a file or a link, but no folder
      function c_unlink(path) bind(c, name="unlink") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: failed  !! 0 if it was removed
      end function c_unlink

      !> C: read the target of a symbolic link
      function c_readlink(path, target, size) bind(c, name="readlink") result(length)
         import :: c_char, c_intptr_t, c_size_t
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(out) :: target(*)  !! Receives the target
         integer(c_size_t), intent(in), value :: size      !! Size of target
         integer(c_intptr_t) :: length  !! Length of the target; negative if the path is no link
      end function c_readlink
   end interface
end module dda_c_files
