!> What runs the tests of a .pf file where pFUnit is not installed: suites, failures, the report
!>
!> Types and procedures that the translated tests name are spelt as pFUnit spells them.
module funit_runner
   use, intrinsic :: iso_fortran_env, only : int64, output_unit
   implicit none
   private

   public :: SourceLocation, TestMethod, TestSuite, anyExceptions
   public :: tally_t, record_failure, run_suite, close_report

   !> Where an assertion stands
   type :: SourceLocation
      character(len=255) :: fileName  !! Name of the .pf file, without its folder
      integer :: lineNumber           !! Line of that file, counted from 1
   end type SourceLocation

   abstract interface
      !> A test, or what runs before or after it
      subroutine test_procedure()
      end subroutine test_procedure
   end interface

   !> One test with its surroundings
   type :: TestMethod
      character(len=63) :: name  !! Name of the subroutine
      !> The test itself
      procedure(test_procedure), pointer, nopass :: method => null()
      !> Runs before the test; null if there is none
      procedure(test_procedure), pointer, nopass :: setUp => null()
      !> Runs after the test; null if there is none
      procedure(test_procedure), pointer, nopass :: tearDown => null()
   end type TestMethod

   !> The tests of one .pf file, in the order of the file
   type :: TestSuite
      character(len=63) :: name                 !! Name of the module, followed by _suite
      type(TestMethod), allocatable :: test(:)  !! The tests
   contains
      procedure :: addTest
   end type TestSuite

   !> What has been run so far
   type :: tally_t
      integer :: n_test = 0    !! Tests that were run
      integer :: n_failed = 0  !! Tests with one failure or more
   end type tally_t

   !> Failures of the test that runs now. The one module variable of the runner: an
   !> assertion of the .pf language has no argument that could carry it.
   integer, save :: n_failure = 0

contains

   !> Put a test at the end of a suite
   subroutine addTest(this, test)
      class(TestSuite), intent(inout) :: this
      type(TestMethod), intent(in) :: test

      if (.not. allocated(this%test)) allocate (this%test(0))
      this%test = [this%test, test]
   end subroutine addTest

   !> Whether an assertion of the running test has failed
   function anyExceptions() result(yes)
      logical :: yes  !! The answer

      yes = n_failure > 0
   end function anyExceptions

   !> Report a failed assertion
   subroutine record_failure(location, headline, lines)
      type(SourceLocation), intent(in) :: location  !! Where the assertion stands
      character(len=*), intent(in) :: headline      !! Which assertion failed
      !> What was said, expected and found; empty lines are left out
      character(len=*), intent(in) :: lines(:)
      integer :: i

      if (n_failure == 0) write (output_unit, "(a)") " FAILED"
      n_failure = n_failure + 1
      write (output_unit, "(4x, 3a, i0, 2a)") &
         "[", trim(location%fileName), ":", location%lineNumber, "] ", headline
      do i = 1, size(lines)
         if (lines(i) /= "") write (output_unit, "(8x, a)") trim(lines(i))
      end do
   end subroutine record_failure

   !> Run the tests of a suite that the command line selects, all of them without -f; the name is
   !> written first, so that a crash shows whose it was
   subroutine run_suite(suite, tally)
      type(TestSuite), intent(in) :: suite
      type(tally_t), intent(inout) :: tally  !! Counts to add to
      integer(int64) :: start, end, rate
      integer :: i

      do i = 1, size(suite%test)
         if (.not. is_selected(trim(suite%name)//"."//trim(suite%test(i)%name))) cycle
         write (output_unit, "(1x, 3a)", advance="no") &
            trim(suite%name), ".", trim(suite%test(i)%name)
         flush (output_unit)
         call system_clock(start, rate)
         call run_test(suite%test(i))
         call system_clock(end)
         tally%n_test = tally%n_test + 1
         if (anyExceptions()) then
            tally%n_failed = tally%n_failed + 1
         else
            write (output_unit, "(a, f0.3, a)") " ok ", real(end - start)/real(rate), " s"
         end if
      end do
   end subroutine run_suite

   !> Whether a test is to be run: -f TEXT, given once or more, selects names that contain a text
   logical function is_selected(name)
      character(len=*), intent(in) :: name  !! Name of the suite and the test
      character(len=255) :: word, text
      integer :: i

      is_selected = command_argument_count() == 0
      do i = 1, command_argument_count() - 1
         call get_command_argument(i, word)
         call get_command_argument(i + 1, text)
         if (word == "-f") is_selected = is_selected .or. index(name, trim(text)) > 0
      end do
   end function is_selected

   !> Run one test: after a failed setUp neither the test nor tearDown is run
   subroutine run_test(test)
      type(TestMethod), intent(in) :: test

      n_failure = 0
      if (associated(test%setUp)) call test%setUp()
      if (anyExceptions()) return
      call test%method()
      if (associated(test%tearDown)) call test%tearDown()
   end subroutine run_test

   !> Write the closing line; a failure stops the program with code 2
   subroutine close_report(tally)
      type(tally_t), intent(in) :: tally  !! Counts of the tests

      if (tally%n_test == 0) then
         write (output_unit, "(a)") &
            " FAILED  (no test was selected: -f TEXT expects a part of a name)"
         stop 2
      else if (tally%n_failed == 0) then
         write (output_unit, "(a, i0, a)") " OK  (", tally%n_test, " tests)"
      else
         write (output_unit, "(2(a, i0), a)") &
            " FAILED  (", tally%n_failed, " of ", tally%n_test, " tests)"
         stop 2
      end if
   end subroutine close_report
end module funit_runner
