!> Files written through the C library, which detects a full disk. Write errors are reported when
!> the file is flushed or closed
module dda_binary_file
   use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_null_char, c_null_ptr, &
      & c_ptr, c_size_t
   use dda_c_files, only : c_fopen, c_fdopen, c_fwrite, c_fflush, c_fileno, &
      & c_ferror, c_fclose, c_readlink, c_unlink
   use dda_error, only : error_t, fatal_error
   implicit none
   private

   public :: binary_file_t, open_binary, open_descriptor, flush_binary, close_binary
   public :: descriptor_of, write_file
   public :: append_text, is_link, remove_link

   !> A file open for writing
   type :: binary_file_t
      private
      type(c_ptr) :: handle = c_null_ptr     !! C's handle of the file
      character(len=:), allocatable :: name  !! Name of the file, for messages
   end type binary_file_t

   !> Folder of devices, which are never removed
   character(len=*), parameter :: devices = "/dev/"
   !> Message about a failed write
   character(len=*), parameter :: no_room = "cannot write the results: no space left on the "// &
      & "disk, or above the limit of a file (ulimit -f); make room or write elsewhere"

contains

   !> Open a file for writing. A symbolic link of that name is replaced; its target is not changed
   subroutine open_binary(name, file, error, keep)
      character(len=*), intent(in) :: name   !! Name of the file; one that exists is replaced
      type(binary_file_t), intent(out) :: file
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: keep  !! True to append to the present contents
      character(len=:), allocatable :: mode
      integer(c_int) :: failed
      logical :: kept

      kept = .false.
      if (present(keep)) kept = keep
      if (kept) then
         mode = "ab"
      else if (index(name, devices) == 1) then
         mode = "wb"
      else
         ! C's x fails if the name still exists, so the file is a new one
         mode = "wbx"
         failed = c_unlink(name//c_null_char)
      end if
      file%name = name
      file%handle = c_fopen(name//c_null_char, mode//c_null_char)
      if (.not. c_associated(file%handle)) &
         & call fatal_error(error, "the file cannot be written; choose another folder with --out", &
         & name, 1)
   end subroutine open_binary

   !> Remove a symbolic link; files and folders of that name are kept
   subroutine remove_link(name)
      character(len=*), intent(in) :: name  !! Name of the link
      integer(c_int) :: failed

      if (is_link(name)) failed = c_unlink(name//c_null_char)
   end subroutine remove_link

   !> True if a name is that of a symbolic link
   logical function is_link(name)
      character(len=*), intent(in) :: name
      character(len=1) :: target(1)

      is_link = c_readlink(name//c_null_char, target, 1_c_size_t) >= 0
   end function is_link

   !> Use a file that the system has already opened
   subroutine open_descriptor(descriptor, name, file)
      integer, intent(in) :: descriptor         !! File descriptor
      character(len=*), intent(in) :: name      !! Name for messages
      type(binary_file_t), intent(out) :: file  !! The file; not open if the descriptor is invalid

      file%name = name
      file%handle = c_fdopen(int(descriptor, c_int), "w"//c_null_char)
   end subroutine open_descriptor

   !> File descriptor; negative if the file is not open
   integer function descriptor_of(file)
      type(binary_file_t), intent(in) :: file

      descriptor_of = -1
      if (c_associated(file%handle)) descriptor_of = int(c_fileno(file%handle))
   end function descriptor_of

   !> Flush a file, so that its contents survive the end of the program
   subroutine flush_binary(file, error)
      type(binary_file_t), intent(in) :: file
      !> Allocated if any write since opening failed
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: failed(2)

      failed = [c_fflush(file%handle), c_ferror(file%handle)]
      if (any(failed /= 0)) call fatal_error(error, no_room, file%name, 1)
   end subroutine flush_binary

   !> Close a file
   subroutine close_binary(file, error)
      type(binary_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: failed

      if (.not. c_associated(file%handle)) return
      call flush_binary(file, error)
      failed = c_fclose(file%handle)
      if (failed /= 0 .and. .not. allocated(error)) call fatal_error(error, no_room, file%name, 1)
      file%handle = c_null_ptr
   end subroutine close_binary

   !> Write a whole file
   subroutine write_file(name, text, error)
      character(len=*), intent(in) :: name  !! Name of the file; one that exists is replaced
      character(len=*), intent(in) :: text  !! Contents of the file
      type(error_t), allocatable, intent(out) :: error
      type(binary_file_t) :: file

      call open_binary(name, file, error)
      if (allocated(error)) return
      call append_text(file, text)
      call close_binary(file, error)
   end subroutine write_file

   !> Append characters; a failure is reported by flush_binary or close_binary
   subroutine append_text(file, text)
      type(binary_file_t), intent(in) :: file
      character(len=*), intent(in), target :: text  !! The characters
      integer(c_size_t) :: written

      if (len(text) == 0 .or. .not. c_associated(file%handle)) return
      written = c_fwrite(c_loc(text(1:1)), 1_c_size_t, len(text, c_size_t), file%handle)
   end subroutine append_text
end module dda_binary_file
