!> Standard output with detection of errors, warnings, and progress
module dda_screen
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use dda_binary_file, only : append_text, binary_file_t, close_binary, descriptor_of, &
      & flush_binary, open_binary, open_descriptor
   use dda_error, only : error_t, warning_line, warnings_t
   use dda_kinds, only : wp
   use dda_process, only : terminal_width
   use dda_text, only : counted, read_integer, to_text
   use dda_watch, only : watch_t
   implicit none
   private

   public :: screen_t, open_screen, print_line, print_text, print_warnings, &
      & close_screen, screen_width
   public :: progress_t, report_progress, terminal_watch_t, end_watch

   !> Standard output of the program
   type :: screen_t
      private
      type(binary_file_t) :: file  !! The file of standard output
   end type screen_t

   !> Unit numbers of standard output and standard error
   integer, parameter :: standard_output = 1, standard_error = 2
   !> Columns of a file, and of a terminal of unknown width
   integer, parameter :: file_width = 100, unknown_width = 80

   !> Width of a line
   integer, parameter :: width = 60
   !> Progress line of tasks on a terminal
   type, extends(watch_t) :: terminal_watch_t
      logical :: shown = .false.             !! True if progress is shown
      logical :: visible = .false.           !! True if a line is on the screen
      integer(int64) :: start = 0, last = 0  !! Clock at the start, and at the last line
      !> Delay of the first report of a task, and interval of further ones [s]
      real(wp) :: delay = 0.5_wp, interval = 0.2_wp
   contains
      !> Report the progress of a task
      procedure :: tell => show_task
   end type terminal_watch_t

   !> Progress of the cases of a deck
   type, extends(terminal_watch_t) :: progress_t
      integer :: total = 0  !! Total number of cases
      integer :: done = 0   !! Number of finished cases
   end type progress_t

contains

   !> Open standard output; a closed one is replaced by the null device
   subroutine open_screen(screen)
      type(screen_t), intent(out) :: screen
      type(error_t), allocatable :: error

      call open_descriptor(standard_output, "standard output", screen%file)
      if (descriptor_of(screen%file) < 0) &
         & call open_binary("/dev/null", screen%file, error, keep=.true.)
      call fill_gaps()
   end subroutine open_screen

   !> Occupy closed standard descriptors, so that no table gets one of them and receives messages
   subroutine fill_gaps()
      type(binary_file_t) :: filler
      type(error_t), allocatable :: error

      do
         call open_binary("/dev/null", filler, error, keep=.true.)
         if (allocated(error)) exit
         if (descriptor_of(filler) > standard_error) exit
      end do
      call close_binary(filler, error)
   end subroutine fill_gaps

   !> Print one line
   subroutine print_line(screen, line)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: line  !! The line

      call print_text(screen, line//new_line("a"))
   end subroutine print_line

   !> Print text unchanged; a failure is reported when the screen is closed
   subroutine print_text(screen, text)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: text  !! The text
      type(error_t), allocatable :: late

      call append_text(screen%file, text)
      call flush_binary(screen%file, late)
   end subroutine print_text

   !> Print warnings
   subroutine print_warnings(warnings)
      type(warnings_t), intent(in) :: warnings
      integer :: i

      if (.not. allocated(warnings%item)) return
      do i = 1, size(warnings%item)
         write (error_unit, "(a)") warning_line(warnings%item(i))
      end do
      if (warnings%left_out > 0) &
         & write (error_unit, "(a)") "and "//counted(warnings%left_out, "more warning")
   end subroutine print_warnings

   !> Largest width of a table line: that of the terminal, otherwise that of the environment
   !> variable COLUMNS
   integer function screen_width(screen)
      type(screen_t), intent(in) :: screen
      character(len=12) :: text
      integer :: stat
      logical :: ok

      screen_width = terminal_width(descriptor_of(screen%file))
      if (screen_width == 0) screen_width = file_width
      if (screen_width > 0) return
      call get_environment_variable("COLUMNS", text, status=stat)
      ok = stat == 0
      if (ok) call read_integer(trim(text), screen_width, ok)
      if (.not. ok .or. screen_width <= 0) screen_width = unknown_width
   end function screen_width

   !> End printing
   subroutine close_screen(screen, error)
      type(screen_t), intent(inout) :: screen
      !> Allocated if anything could not be printed
      type(error_t), allocatable, intent(out) :: error

      call close_binary(screen%file, error)
   end subroutine close_screen

   !> Report the progress of a task, after a delay and at intervals
   subroutine show_task(watch, task, share)
      class(terminal_watch_t), intent(inout) :: watch
      character(len=*), intent(in) :: task  !! Name of the task
      real(wp), intent(in) :: share         !! Completed share from 0 to 1; negative if not known
      integer(int64) :: now, rate
      character(len=width) :: line

      if (.not. watch%shown) return
      call system_clock(now, rate)
      if (watch%start == 0) watch%start = now
      if (real(now - watch%start, wp) < watch%delay*real(rate, wp)) return
      if (real(now - watch%last, wp) < watch%interval*real(rate, wp)) return
      watch%last = now
      watch%visible = .true.
      line = task
      if (share >= 0.0_wp) line = task//": "//to_text(int(100.0_wp*share))//" %"
      write (error_unit, "(a)", advance="no") achar(13)//line
      flush (error_unit)
   end subroutine show_task

   !> Erase the progress line
   subroutine end_watch(watch)
      class(terminal_watch_t), intent(inout) :: watch

      if (.not. watch%visible) return
      write (error_unit, "(a)", advance="no") achar(13)//repeat(" ", width)//achar(13)
      flush (error_unit)
      watch%visible = .false.
   end subroutine end_watch

   !> Count one case, and report the number of finished cases and the time left
   subroutine report_progress(progress)
      type(progress_t), intent(inout) :: progress
      integer(int64) :: now, rate
      real(wp) :: left

      progress%done = progress%done + 1
      if (.not. progress%shown .or. progress%done == progress%total) return
      call system_clock(now, rate)
      left = real(now - progress%start, wp)/real(rate, wp) &
         & *real(progress%total - progress%done, wp)/real(progress%done, wp)
      call progress%tell("case "//to_text(progress%done)//" of "//to_text(progress%total) &
         & //", about "//to_text(ceiling(left))//" s left", -1.0_wp)
   end subroutine report_progress
end module dda_screen
