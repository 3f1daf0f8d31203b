!> What the program asks of the operating system
module dda_process
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   implicit none
   private

   public :: exit_status, exit_status_enum, leave, worst_status, make_folder, error_is_terminal

   !> Exit statuses of the program
   type :: exit_status_enum
      !> Every case reached a verdict
      integer :: success = 0
      !> Bad input
      integer :: bad_input = 2
      !> A case ended undecided or was not finished
      integer :: undecided = 3
      !> Results could not be written
      integer :: not_written = 4
   end type exit_status_enum

   !> Names of the exit statuses
   type(exit_status_enum), parameter :: exit_status = exit_status_enum()

   interface
      !> C: end the program
      subroutine c_exit(status) bind(c, name="exit")
         import :: c_int
         !> Exit status
         integer(c_int), intent(in), value :: status
      end subroutine c_exit

      !> C: whether a file descriptor is a terminal
      function c_isatty(descriptor) bind(c, name="isatty") result(yes)
         import :: c_int
         !> 1 for standard output, 2 for standard error
         integer(c_int), intent(in), value :: descriptor
         !> 1 if it is
         integer(c_int) :: yes
      end function c_isatty

      !> C: make a folder
      function c_mkdir(path, mode) bind(c, name="mkdir") result(failed)
         import :: c_char, c_int
         !> Its name, ended by a null character
         character(kind=c_char), intent(in) :: path(*)
         !> Its permissions
         integer(c_int), intent(in), value :: mode
         !> 0 if it was made
         integer(c_int) :: failed
      end function c_mkdir
   end interface

contains

   !> End the program; Fortran's own stop takes no computed status
   subroutine leave(status)
      !> One of exit_status
      integer, intent(in) :: status

      flush (output_unit)
      flush (error_unit)
      call c_exit(int(status, c_int))
   end subroutine leave

   !> Of two statuses the one that the user must know first: 4, then 2, then 3
   pure integer function worst_status(a, b)
      !> One status
      integer, intent(in) :: a
      !> The other
      integer, intent(in) :: b
      integer, parameter :: order(*) = [exit_status%not_written, exit_status%bad_input, &
         & exit_status%undecided]
      integer :: i

      worst_status = exit_status%success
      do i = size(order), 1, -1
         if (a == order(i) .or. b == order(i)) worst_status = order(i)
      end do
   end function worst_status

   !> Make a folder and those above it; one that exists is left as it is
   subroutine make_folder(path)
      !> Its name
      character(len=*), intent(in) :: path
      integer(c_int) :: failed
      integer :: i

      do i = 2, len(path)
         if (path(i:i) == "/") failed = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
      end do
      ! whether the folder can be used shows when a file in it is opened
      failed = c_mkdir(path//c_null_char, int(o'777', c_int))
   end subroutine make_folder

   !> Whether standard error is a terminal
   logical function error_is_terminal()
      error_is_terminal = c_isatty(2_c_int) == 1
   end function error_is_terminal
end module dda_process
