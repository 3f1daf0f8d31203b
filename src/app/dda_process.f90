!> Requests to the operating system
module dda_process
   use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_intptr_t, c_long, &
      & c_null_char, c_null_funptr, c_short
   use, intrinsic :: iso_fortran_env, only : error_unit
   implicit none
   private

   public :: exit_status, exit_status_enum, leave, worst_status, make_folder, error_is_terminal
   public :: survive_file_limit, terminal_width, deck_stem

   !> Exit statuses of the program
   type :: exit_status_enum
      integer :: success = 0      !! Every case reached a verdict
      integer :: bad_input = 2    !! Bad input
      integer :: undecided = 3    !! A case ended undecided or was not finished
      integer :: not_written = 4  !! Results could not be written
   end type exit_status_enum

   !> Names of the exit statuses
   type(exit_status_enum), parameter :: exit_status = exit_status_enum()

   !> Signal of a file that exceeds its size limit: the same number on Linux, BSD and macOS
   integer(c_int), parameter :: file_limit_signal = 25
   !> C's SIG_IGN: the address for an ignored signal
   integer(c_intptr_t), parameter :: ignored = 1

   !> C's TIOCGWINSZ of ioctl, on Linux
   integer(c_long), parameter :: ask_for_size = int(z'5413', c_long)

   !> C's struct winsize: the size of a terminal
   type, bind(c) :: terminal_size_t
      integer(c_short) :: lines = 0, columns = 0  !! Lines and columns; 0 if not known
      integer(c_short) :: dots(2) = 0             !! Width and height in pixels
   end type terminal_size_t

   interface
      !> C: request to a terminal; the third argument depends on the request
      function c_ioctl(descriptor, request, answer) bind(c, name="ioctl") result(failed)
         import :: c_int, c_long, terminal_size_t
         integer(c_int), intent(in), value :: descriptor  !! File descriptor of the terminal
         integer(c_long), intent(in), value :: request    !! Number of the request
         type(terminal_size_t), intent(inout) :: answer
         integer(c_int) :: failed                         !! 0 on success
      end function c_ioctl

      !> C: set the handler of a signal
      function c_signal(number, handler) bind(c, name="signal") result(before)
         import :: c_funptr, c_int
         integer(c_int), intent(in), value :: number  !! Number of the signal
         type(c_funptr), intent(in), value :: handler
         type(c_funptr) :: before                     !! The previous handler
      end function c_signal

      !> C: end the program
      subroutine c_exit(status) bind(c, name="exit")
         import :: c_int
         integer(c_int), intent(in), value :: status  !! Exit status
      end subroutine c_exit

      !> C: 1 if a file descriptor is a terminal
      function c_isatty(descriptor) bind(c, name="isatty") result(yes)
         import :: c_int
         !> 1 for standard output, 2 for standard error
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: yes  !! 1 if it is
      end function c_isatty

      !> C: make a folder
      function c_mkdir(path, mode) bind(c, name="mkdir") result(failed)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)  !! Its name, ended by a null character
         integer(c_int), intent(in), value :: mode      !! Permissions of the folder
         integer(c_int) :: failed                       !! 0 on success
      end function c_mkdir
   end interface

contains

   !> End the program; Fortran's own stop takes no computed status
   subroutine leave(status)
      integer, intent(in) :: status  !! One of exit_status

      flush (error_unit)
      call c_exit(int(status, c_int))
   end subroutine leave

   !> Ignore the signal of the file size limit (ulimit -f), so that exceeding it is a write error
   subroutine survive_file_limit()
      type(c_funptr) :: before

      before = c_signal(file_limit_signal, transfer(ignored, c_null_funptr))
   end subroutine survive_file_limit

   !> The more important of two statuses: 4 before 2 before 3
   pure integer function worst_status(a, b)
      integer, intent(in) :: a  !! One status
      integer, intent(in) :: b  !! The other
      integer, parameter :: order(*) = [exit_status%not_written, exit_status%bad_input, &
         & exit_status%undecided]
      integer :: i

      worst_status = exit_status%success
      do i = size(order), 1, -1
         if (a == order(i) .or. b == order(i)) worst_status = order(i)
      end do
   end function worst_status

   !> Make a folder and its parents; an existing one is unchanged
   subroutine make_folder(path)
      character(len=*), intent(in) :: path  !! Name of the folder
      integer(c_int) :: failed
      integer :: i

      do i = 2, len(path)
         if (path(i:i) == "/") failed = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
      end do
      ! an unusable folder is reported when a file in it is opened
      failed = c_mkdir(path//c_null_char, int(o'777', c_int))
   end subroutine make_folder

   !> Number of columns of a terminal: 0 if the descriptor is none, -1 if its size is not known
   integer function terminal_width(descriptor)
      integer, intent(in) :: descriptor  !! The descriptor
      type(terminal_size_t) :: size

      terminal_width = 0
      if (c_isatty(int(descriptor, c_int)) /= 1) return
      terminal_width = -1
      if (c_ioctl(int(descriptor, c_int), ask_for_size, size) /= 0) return
      if (size%columns > 0) terminal_width = int(size%columns)
   end function terminal_width

   !> True if standard error is a terminal
   logical function error_is_terminal()
      error_is_terminal = c_isatty(2_c_int) == 1
   end function error_is_terminal

   !> Name of a deck without folder and extension; an extension is added if the name would be that
   !> of the deck or of an existing file
   pure function deck_stem(name) result(stem)
      character(len=*), intent(in) :: name  !! Name of the file
      character(len=:), allocatable :: stem
      integer :: dot

      stem = name(index(name, "/", back=.true.) + 1:)
      dot = index(stem, ".", back=.true.)
      if (dot > 1) then
         stem = stem(:dot - 1)
      else
         stem = stem//".results"
      end if
      if (verify(stem, ".") == 0) stem = stem//"results"
   end function deck_stem
end module dda_process
