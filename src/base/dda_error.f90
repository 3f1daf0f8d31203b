!> Errors and warnings as values; an error is the last argument of every procedure that can fail
module dda_error
   use dda_text, only : to_text
   implicit none
   private

   public :: error_t, fatal_error, place_error, error_line
   public :: warning_t, warnings_t, add_warning, warning_line

   !> An error with its place; an allocated error_t means failure
   type :: error_t
      !> Expected and actual value, with the unit, and the correction
      character(len=:), allocatable :: message
      character(len=:), allocatable :: file  !! File that the message refers to; unallocated if none
      integer :: line = 0  !! Line of that file, counted from 1; 0 for the whole file
   end type error_t

   !> A warning with the number of its repetitions
   type, extends(error_t) :: warning_t
      integer :: repeats = 0  !! Number of later lines with the same message
   end type warning_t

   !> A list of warnings, of limited length for any number of faults
   type :: warnings_t
      !> The warnings, each message once; unallocated if there are none
      type(warning_t), allocatable :: item(:)
      integer :: left_out = 0  !! Number of other warnings that exceed the limit
   end type warnings_t

   !> Maximum length of a list in a message
   integer, parameter :: most_items = 50

contains

   !> Make an error
   pure subroutine fatal_error(error, message, file, line)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: message         !! Expected and actual value
      character(len=*), intent(in), optional :: file  !! File that the message refers to
      integer, intent(in), optional :: line           !! Line of that file

      allocate (error)
      error%message = message
      if (present(file)) error%file = file
      if (present(line)) error%line = line
   end subroutine fatal_error

   !> Set the line of an error that has none
   pure subroutine place_error(error, line)
      type(error_t), allocatable, intent(inout) :: error
      integer, intent(in) :: line

      if (.not. allocated(error)) return
      if (error%line == 0) error%line = line
   end subroutine place_error

   !> Line on the screen: FILE:LINE: error: message
   pure function error_line(error) result(line)
      type(error_t), intent(in) :: error
      character(len=:), allocatable :: line  !! One line of text

      line = "error: "//error%message
      if (allocated(error%file)) line = error%file//":"//to_text(max(error%line, 1))//": "//line
   end function error_line

   !> Add a warning
   pure subroutine add_warning(warnings, message, file, line)
      type(warnings_t), intent(inout) :: warnings
      character(len=*), intent(in) :: message  !! The fault and its consequence
      character(len=*), intent(in) :: file
      integer, intent(in) :: line
      type(error_t), allocatable :: new
      type(warning_t), allocatable :: longer(:)
      integer :: i, n

      if (.not. allocated(warnings%item)) allocate (warnings%item(0))
      n = size(warnings%item)
      do i = 1, n
         associate (item => warnings%item(i))
            if (item%message /= message .or. item%file /= file) cycle
            item%repeats = item%repeats + 1
            return
         end associate
      end do
      if (n == most_items) then
         warnings%left_out = warnings%left_out + 1
         return
      end if
      call fatal_error(new, message, file, line)
      allocate (longer(n + 1))
      longer(:n) = warnings%item
      longer(n + 1)%error_t = new
      call move_alloc(longer, warnings%item)
   end subroutine add_warning

   !> Line on the screen: FILE:LINE: warning: message
   pure function warning_line(warning) result(line)
      type(warning_t), intent(in) :: warning
      character(len=:), allocatable :: line  !! One line of text

      line = "warning: "//warning%message
      if (warning%repeats > 0) line = line//" (and "//to_text(warning%repeats)//" more like it)"
      if (allocated(warning%file)) &
         & line = warning%file//":"//to_text(max(warning%line, 1))//": "//line
   end function warning_line
end module dda_error
