!> Files written through the C library, which reports a full disk. Whatever fails on the way is
!> reported when the file is flushed or closed
module dda_binary_file
   use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_null_char, c_null_ptr, &
      & c_ptr, c_size_t
   use dda_c_files, only : c_fopen, c_fdopen, c_fwrite, c_fflush, c_fileno, c_fsync, &
      & c_ferror, c_fclose, c_readlink, c_unlink
   use dda_error, only : error_t, fatal_error
   implicit none
   private

   public :: binary_file_t, open_binary, open_descriptor, flush_binary, sync_binary, close_binary
   public :: descriptor_of, write_file
   public :: append_text, is_link, remove_link

   !> A file open for writing
   type :: binary_file_t
      private
      type(c_ptr) :: handle = c_null_ptr     !! C's handle of the file
      character(len=:), allocatable :: name  !! Name of the file, for messages
   end type binary_file_t

   !> Folder whose files are devices, and never removed
   character(len=*), parameter :: devices = "/dev/"
   !> What a write that failed may have met
   character(len=*), parameter :: no_room = "cannot write the results: no space left on the "// &
      & "disk, or above the limit of a file (ulimit -f); make room or write elsewhere"

contains

   !> Begin a file. A link of its name is replaced, and where it leads stays as it is
   subroutine open_binary(name, file, error, keep)
      character(len=*), intent(in) :: name   !! Name of the file; one that exists is replaced
      type(binary_file_t), intent(out) :: file
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: keep  !! Whether what it holds is kept and added to instead
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
         ! a file of its own: C's x refuses whatever still has the name
         mode = "wbx"
         failed = c_unlink(name//c_null_char)
      end if
      file%name = name
      file%handle = c_fopen(name//c_null_char, mode//c_null_char)
      if (.not. c_associated(file%handle)) &
         & call fatal_error(error, "the file cannot be written; choose another folder with --out", &
         & name, 1)
   end subroutine open_binary

   !> Remove a link; files and folders of that name stay
   subroutine remove_link(name)
      character(len=*), intent(in) :: name  !! Name of the link
      integer(c_int) :: failed

      if (is_link(name)) failed = c_unlink(name//c_null_char)
   end subroutine remove_link

   !> Whether a name is that of a symbolic link
   logical function is_link(name)
      character(len=*), intent(in) :: name
      character(len=1) :: target(1)

      is_link = c_readlink(name//c_null_char, target, 1_c_size_t) >= 0
   end function is_link

   !> Take over a file that the system has opened already
   subroutine open_descriptor(descriptor, name, file)
      integer, intent(in) :: descriptor     !! The system's number of the file
      character(len=*), intent(in) :: name  !! Name that messages will show
      !> The file; not open if there is none of that number
      type(binary_file_t), intent(out) :: file

      file%name = name
      file%handle = c_fdopen(int(descriptor, c_int), "w"//c_null_char)
   end subroutine open_descriptor

   !> The system's number of a file; negative for one that is not open
   integer function descriptor_of(file)
      type(binary_file_t), intent(in) :: file

      descriptor_of = -1
      if (c_associated(file%handle)) descriptor_of = int(c_fileno(file%handle))
   end function descriptor_of

   !> Write so that all up to here survives the end of the program
   subroutine flush_binary(file, error)
      type(binary_file_t), intent(in) :: file
      !> Allocated if anything could not be written since the file was opened
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: failed(2)

      failed = [c_fflush(file%handle), c_ferror(file%handle)]
      if (any(failed /= 0)) call fatal_error(error, no_room, file%name, 1)
   end subroutine flush_binary

   !> Write so that all up to here survives a loss of power
   subroutine sync_binary(file, error)
      type(binary_file_t), intent(in) :: file  !! The file; nothing happens to one that is not open
      type(error_t), allocatable, intent(inout) :: error

      if (.not. c_associated(file%handle) .or. allocated(error)) return
      call flush_binary(file, error)
      if (allocated(error)) return
      if (c_fsync(c_fileno(file%handle)) /= 0) call fatal_error(error, "cannot write the "// &
         & "results: fsync failed; check the disk or write elsewhere", file%name, 1)
   end subroutine sync_binary

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
      character(len=*), intent(in) :: text  !! What it holds
      type(error_t), allocatable, intent(out) :: error
      type(binary_file_t) :: file

      call open_binary(name, file, error)
      if (allocated(error)) return
      call append_text(file, text)
      call close_binary(file, error)
   end subroutine write_file

   !> Write characters as they are; C keeps in mind whether that failed
   subroutine append_text(file, text)
      type(binary_file_t), intent(in) :: file
      character(len=*), intent(in), target :: text  !! The characters
      integer(c_size_t) :: written

      if (len(text) == 0 .or. .not. c_associated(file%handle)) return
      written = c_fwrite(c_loc(text(1:1)), 1_c_size_t, len(text, c_size_t), file%handle)
   end subroutine append_text
end module dda_binary_file
