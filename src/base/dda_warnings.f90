!> Warnings are values too: what was found, what was made of it, and where
module dda_warnings
   use dda_error, only : error_t, fatal_error
   use dda_text, only : to_text
   implicit none
   private

   public :: warnings_t, add_warning, warning_line

   !> A list of warnings
   type :: warnings_t
      !> The warnings; unallocated if there is none
      type(error_t), allocatable :: item(:)
   end type warnings_t

contains

   !> Add a warning
   pure subroutine add_warning(warnings, message, file, line)
      !> The list
      type(warnings_t), intent(inout) :: warnings
      !> What was found, and what was made of it
      character(len=*), intent(in) :: message
      !> File that the message speaks of
      character(len=*), intent(in) :: file
      !> Line of that file
      integer, intent(in) :: line
      type(error_t), allocatable :: longer(:), new
      integer :: n

      n = 0
      if (allocated(warnings%item)) n = size(warnings%item)
      call fatal_error(new, message, file, line)
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = warnings%item
      longer(n + 1) = new
      call move_alloc(longer, warnings%item)
   end subroutine add_warning

   !> The line a user sees: FILE:LINE: warning: message
   pure function warning_line(warning) result(line)
      !> The warning
      type(error_t), intent(in) :: warning
      !> One line of text
      character(len=:), allocatable :: line

      line = "warning: "//warning%message
      if (allocated(warning%file)) &
         & line = warning%file//":"//to_text(max(warning%line, 1))//": "//line
   end function warning_line
end module dda_warnings
