!> What the user reads: standard output, written like every other file, for Fortran's own unit does
!> not say when it is full; warnings on standard error
module dda_screen
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_binary_file, only : append_text, binary_file_t, close_binary, descriptor_of, &
      & flush_binary, open_binary, open_descriptor
   use dda_error, only : error_t
   use dda_process, only : terminal_width
   use dda_text, only : read_integer, to_text
   use dda_warnings, only : warning_line, warnings_t
   implicit none
   private

   public :: screen_t, open_screen, print_line, print_text, print_warnings, &
      & close_screen, screen_width

   !> Where lines for the user go
   type :: screen_t
      private
      type(binary_file_t) :: file  !! Its file
   end type screen_t

   !> The system's number of standard output, and the last one that has a meaning of its own
   integer, parameter :: standard_output = 1, standard_error = 2
   !> Columns of what is no terminal, and of a terminal that does not know how many it has
   integer, parameter :: file_width = 100, unknown_width = 80

contains

   !> Take over standard output; one that is closed is no failure: nobody wants to read it
   subroutine open_screen(screen)
      type(screen_t), intent(out) :: screen
      type(error_t), allocatable :: error

      call open_descriptor(standard_output, "standard output", screen%file)
      if (descriptor_of(screen%file) < 0) call open_binary("/dev/null", screen%file, error)
      call fill_gaps()
   end subroutine open_screen

   !> Occupy closed descriptors, lest a table gets one of them, and with it what is meant for the
   !> user
   subroutine fill_gaps()
      type(binary_file_t) :: filler
      type(error_t), allocatable :: error

      do
         call open_binary("/dev/null", filler, error)
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

   !> Print text as it is; whatever fails is reported when the screen is closed
   subroutine print_text(screen, text)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: text  !! The text
      type(error_t), allocatable :: late

      call append_text(screen%file, text)
      call flush_binary(screen%file, late)
   end subroutine print_text

   !> Print what a reader warns of
   subroutine print_warnings(warnings)
      type(warnings_t), intent(in) :: warnings
      integer :: i

      if (.not. allocated(warnings%item)) return
      do i = 1, size(warnings%item)
         write (error_unit, "(a)") warning_line(warnings%item(i))
      end do
      if (warnings%left_out > 0) &
         & write (error_unit, "(a)") "and "//to_text(warnings%left_out)//" more warnings"
   end subroutine print_warnings

   !> Columns that a line of a table may have: those of the terminal, or where it does not know,
   !> what the environment says
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
end module dda_screen
