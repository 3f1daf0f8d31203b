!> The comparisons behind the assertions: every overload of funit ends here, on lists of one kind
module funit_compare
   use, intrinsic :: ieee_arithmetic, only : ieee_all, ieee_get_status, &
      ieee_set_halting_mode, ieee_set_status, ieee_status_type
   use, intrinsic :: iso_fortran_env, only : int64, real64
   use funit_runner, only : SourceLocation, record_failure
   implicit none
   private

   public :: claim_t, claim, judge, judge_truth

   !> Compare two lists element by element and report the first pair that does not hold
   interface judge
      module procedure judge_reals
      module procedure judge_integers
      module procedure judge_texts
   end interface judge

   !> An assertion as it stands in a test
   type :: claim_t
      character(len=:), allocatable :: assertion  !! Name of the assertion
      !> What the author says when it fails; empty if nothing
      character(len=:), allocatable :: message
      type(SourceLocation) :: location  !! Where it stands
   end type claim_t

   !> Room for one line of a report, but for a longer text
   integer, parameter :: line_length = 80

contains

   !> Make a claim
   function claim(assertion, message, location)
      character(len=*), intent(in) :: assertion          !! Name of the assertion
      character(len=*), intent(in), optional :: message  !! What the author says when it fails
      type(SourceLocation), intent(in) :: location       !! Where it stands
      type(claim_t) :: claim

      claim%assertion = assertion
      claim%message = ""
      if (present(message)) claim%message = message
      claim%location = location
   end function claim

   !> Judge a claim on reals
   subroutine judge_reals(claim, expected, expected_shape, actual, actual_shape, tolerance)
      type(claim_t), intent(in) :: claim
      !> Expected values in array element order: one for all, or as many as actual
      real(real64), intent(in) :: expected(:)
      integer, intent(in) :: expected_shape(:)         !! Their shape; empty for a scalar
      real(real64), intent(in) :: actual(:)            !! Values found
      integer, intent(in) :: actual_shape(:)           !! Their shape
      real(real64), intent(in), optional :: tolerance  !! Room between them; 0 if absent
      character(len=line_length) :: left, right, rest
      type(ieee_status_type) :: status
      real(real64) :: e, room
      integer :: i

      if (.not. conformable(claim, expected_shape, actual_shape)) return
      room = 0.0_real64
      if (present(tolerance)) room = tolerance
      ! NaN and infinity are to fail here, not to stop a build that traps them.
      call ieee_get_status(status)
      call ieee_set_halting_mode(ieee_all, .false.)
      do i = 1, size(actual)
         e = expected(merge(1, i, size(expected_shape) == 0))
         if (real_holds(claim%assertion, e, actual(i), room)) cycle
         write (left, "(g0)") e
         write (right, "(g0)") actual(i)
         write (rest, "('difference: ', g0, ', tolerance: ', g0)") actual(i) - e, room
         if (claim%assertion == "AssertRelativelyEqual" .and. .not. abs(e) > 0.0_real64) &
            rest = "nothing is relatively equal to zero"
         call report(claim, left, right, rest, element(i, actual_shape))
         exit
      end do
      call ieee_set_status(status)
   end subroutine judge_reals

   !> Judge a claim on integers
   subroutine judge_integers(claim, expected, expected_shape, actual, actual_shape)
      type(claim_t), intent(in) :: claim
      !> Expected values in array element order: one for all, or as many as actual
      integer(int64), intent(in) :: expected(:)
      integer, intent(in) :: expected_shape(:)  !! Their shape; empty for a scalar
      integer(int64), intent(in) :: actual(:)   !! Values found
      integer, intent(in) :: actual_shape(:)    !! Their shape
      character(len=line_length) :: left, right
      integer(int64) :: e
      integer :: i

      if (.not. conformable(claim, expected_shape, actual_shape)) return
      do i = 1, size(actual)
         e = expected(merge(1, i, size(expected_shape) == 0))
         if (integer_holds(claim%assertion, e, actual(i))) cycle
         write (left, "(i0)") e
         write (right, "(i0)") actual(i)
         call report(claim, left, right, "", element(i, actual_shape))
         return
      end do
   end subroutine judge_integers

   !> Judge that texts are equal; blanks and tabs at either end do not count
   subroutine judge_texts(claim, expected, expected_shape, actual, actual_shape)
      type(claim_t), intent(in) :: claim
      !> Expected texts: one for all, or as many as actual
      character(len=*), intent(in) :: expected(:)
      integer, intent(in) :: expected_shape(:)   !! Their shape; empty for a scalar
      character(len=*), intent(in) :: actual(:)  !! Texts found
      integer, intent(in) :: actual_shape(:)     !! Their shape
      integer :: i, j

      if (.not. conformable(claim, expected_shape, actual_shape)) return
      do i = 1, size(actual)
         j = merge(1, i, size(expected_shape) == 0)
         if (core(expected(j)) == core(actual(i))) cycle
         call report(claim, '"'//trim(expected(j))//'"', '"'//trim(actual(i))//'"', "", &
            element(i, actual_shape))
         return
      end do
   end subroutine judge_texts

   !> Judge that every condition has the wanted truth
   subroutine judge_truth(claim, conditions, wanted)
      type(claim_t), intent(in) :: claim
      logical, intent(in) :: conditions(:)  !! Conditions found
      logical, intent(in) :: wanted         !! What each must be

      if (all(conditions .eqv. wanted)) return
      call report(claim, trim(merge("true ", "false", wanted)), &
         trim(merge("false", "true ", wanted)), "", "")
   end subroutine judge_truth

   !> Whether two reals are as an assertion says; NaN never is
   pure function real_holds(assertion, left, right, tolerance) result(yes)
      character(len=*), intent(in) :: assertion  !! Name of the assertion
      real(real64), intent(in) :: left           !! First argument of the assertion
      real(real64), intent(in) :: right          !! Second argument of the assertion
      real(real64), intent(in) :: tolerance      !! Room between them
      logical :: yes                             !! The answer

      yes = .false.
      select case (assertion)
      case ("AssertEqual")
         yes = left <= right .and. left >= right
         if (.not. yes) yes = abs(right - left) <= tolerance
      case ("AssertRelativelyEqual")
         if (abs(left) > 0.0_real64) yes = abs(right - left) <= tolerance*abs(left)
      case ("AssertLessThan")
         yes = left < right + tolerance
      case ("AssertLessThanOrEqual")
         yes = left <= right + tolerance
      case ("AssertGreaterThan")
         yes = left > right - tolerance
      case ("AssertGreaterThanOrEqual")
         yes = left >= right - tolerance
      end select
   end function real_holds

   !> Whether two integers are as an assertion says
   pure function integer_holds(assertion, left, right) result(yes)
      character(len=*), intent(in) :: assertion  !! Name of the assertion
      integer(int64), intent(in) :: left         !! First argument of the assertion
      integer(int64), intent(in) :: right        !! Second argument of the assertion
      logical :: yes                             !! The answer

      yes = .false.
      select case (assertion)
      case ("AssertEqual")
         yes = left == right
      case ("AssertLessThan")
         yes = left < right
      case ("AssertLessThanOrEqual")
         yes = left <= right
      case ("AssertGreaterThan")
         yes = left > right
      case ("AssertGreaterThanOrEqual")
         yes = left >= right
      end select
   end function integer_holds

   !> Whether two shapes can be compared: one is a scalar's or both are the same; reports if not
   function conformable(claim, expected_shape, actual_shape) result(yes)
      type(claim_t), intent(in) :: claim
      integer, intent(in) :: expected_shape(:)  !! One shape
      integer, intent(in) :: actual_shape(:)    !! The other shape
      logical :: yes                            !! The answer
      character(len=line_length) :: left, right

      yes = size(expected_shape) == 0
      if (.not. yes) yes = all(expected_shape == actual_shape)
      if (yes) return
      write (left, "('shape', *(1x, i0))") expected_shape
      write (right, "('shape', *(1x, i0))") actual_shape
      call report(claim, left, right, "", "")
   end function conformable

   !> Report a claim that does not hold
   subroutine report(claim, left, right, rest, where_found)
      type(claim_t), intent(in) :: claim
      character(len=*), intent(in) :: left         !! First argument of the assertion
      character(len=*), intent(in) :: right        !! Second argument of the assertion
      character(len=*), intent(in) :: rest         !! More to say; may be empty
      character(len=*), intent(in) :: where_found  !! Which element of an array; may be empty
      character(len=len(claim%message) + len(left) + len(right) + 2*line_length) :: lines(5)

      lines = [character(len=len(lines)) :: claim%message, "expected: "//left, &
         "found:    "//right, rest, where_found]
      if (index(claim%assertion, "Than") > 0) then
         lines(2) = "left:  "//left
         lines(3) = "right: "//right
      end if
      call record_failure(claim%location, claim%assertion, lines)
   end subroutine report

   !> Which element of an array is meant; empty for a scalar
   pure function element(i, extents) result(text)
      integer, intent(in) :: i            !! Place in array element order, from 1
      integer, intent(in) :: extents(:)   !! Shape of the array, of rank 2 at most
      character(len=line_length) :: text  !! Such as "element: 3 1"

      text = ""
      if (size(extents) == 1) write (text, "('element: ', i0)") i
      if (size(extents) == 2) write (text, "('element: ', i0, 1x, i0)") &
         1 + mod(i - 1, extents(1)), 1 + (i - 1)/extents(1)
   end function element

   !> A text without the blanks and tabs at its ends
   pure function core(text) result(inner)
      character(len=*), intent(in) :: text    !! Any text
      character(len=:), allocatable :: inner  !! Its core; of length 0 if there is none
      character(len=2), parameter :: white = " "//achar(9)

      inner = text(max(1, verify(text, white)):verify(text, white, back=.true.))
   end function core
end module funit_compare
