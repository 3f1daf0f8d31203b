!> Failures are values: the last argument of whatever can fail
module dda_error
   implicit none
   private

   public :: error_t, fatal_error, require, error_line

   !> What went wrong and where; an allocated error_t means failure
   type :: error_t
      !> What was wanted, in which unit, and what was found
      character(len=:), allocatable :: message
      !> File that the message speaks of; unallocated if none
      character(len=:), allocatable :: file
      !> Line of that file, counted from 1; 0 if the whole file is meant
      integer :: line = 0
   end type error_t

contains

   !> Make an error
   pure subroutine fatal_error(error, message, file, line)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: message         !! What was wanted and what was found
      character(len=*), intent(in), optional :: file  !! File that the message speaks of
      integer, intent(in), optional :: line           !! Line of that file

      allocate (error)
      error%message = message
      if (present(file)) error%file = file
      if (present(line)) error%line = line
   end subroutine fatal_error

   !> A contract at the border of a module: the sentence must be true
   pure subroutine require(condition, sentence, error)
      !> Whether the sentence holds
      logical, intent(in) :: condition
      !> What must hold, in words
      character(len=*), intent(in) :: sentence
      !> Allocated if it does not hold; left as it was otherwise
      type(error_t), allocatable, intent(inout) :: error

      if (.not. condition .and. .not. allocated(error)) call fatal_error(error, sentence)
   end subroutine require

   !> The line a user sees: FILE:LINE: error: message
   pure function error_line(error) result(line)
      type(error_t), intent(in) :: error
      character(len=:), allocatable :: line  !! One line of text
      character(len=12) :: number

      line = "error: "//error%message
      if (.not. allocated(error%file)) return
      write (number, "(i0)") max(error%line, 1)
      line = error%file//":"//trim(number)//": "//line
   end function error_line
end module dda_error
