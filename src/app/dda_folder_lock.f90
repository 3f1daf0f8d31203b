!> One run a folder: a lock that the system takes back when the program ends, however it ends
module dda_folder_lock
   use, intrinsic :: iso_c_binding, only : c_int
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_binary_file, only : binary_file_t, close_binary, descriptor_of, open_binary
   use dda_error, only : error_t, fatal_error
   use dda_table_file, only : remove_file
   use dda_text, only : to_text
   implicit none
   private

   public :: lock_folder

   !> C's LOCK_EX and LOCK_NB: alone, and without waiting
   integer(c_int), parameter :: alone = 2, at_once = 4

   interface
      !> C: lock an open file; whoever opens it anew has no part in the lock
      function c_flock(descriptor, operation) bind(c, name="flock") result(failed)
         import :: c_int
         !> The system's number of the file
         integer(c_int), intent(in), value :: descriptor
         !> How to lock it
         integer(c_int), intent(in), value :: operation
         !> 0 if it is locked
         integer(c_int) :: failed
      end function c_flock

      !> C: number of this process
      function c_getpid() bind(c, name="getpid") result(number)
         import :: c_int
         integer(c_int) :: number
      end function c_getpid
   end interface

contains

   !> Take a folder for the rest of the program; nothing of it is touched before
   subroutine lock_folder(folder, quiet, error)
      !> Name of the folder, which exists
      character(len=*), intent(in) :: folder
      !> Whether no warning is printed
      logical, intent(in) :: quiet
      !> Allocated if another run has it, or no file can be written there
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: file
      type(binary_file_t) :: held

      file = folder//"/run.lock"
      call open_binary(file, held, error, keep=.true.)
      if (allocated(error)) return
      if (is_locked(held)) return
      if (has_locks(file)) then
         call fatal_error(error, "expected a folder that no other run or deck writes to, got "// &
            & "one in use; choose another folder with --out, or wait for that run to end", file, 1)
      else if (.not. quiet) then
         write (error_unit, "(a)") file//":1: warning: this file system knows no locks: "// &
            & "nothing keeps another run from writing to "//folder
      end if
   end subroutine lock_folder

   !> Lock an open file, if nobody else has
   logical function is_locked(file)
      !> The file; stays locked until it is closed, at the end of the program
      type(binary_file_t), intent(in) :: file
      integer(c_int) :: failed

      failed = c_flock(int(descriptor_of(file), c_int), ior(alone, at_once))
      is_locked = failed == 0
   end function is_locked

   !> Whether files of a folder can be locked at all: one that nobody else knows of must
   logical function has_locks(file)
      !> Name of the file that could not be locked
      character(len=*), intent(in) :: file
      character(len=:), allocatable :: name
      type(binary_file_t) :: probe
      type(error_t), allocatable :: error

      name = file//"."//to_text(int(c_getpid()))
      call open_binary(name, probe, error)
      has_locks = .true.
      if (allocated(error)) return
      has_locks = is_locked(probe)
      call close_binary(probe, error)
      call remove_file(name)
   end function has_locks
end module dda_folder_lock
