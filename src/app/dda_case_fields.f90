!> Columns of the table on the screen: which fit into its width, and what a case has in each
module dda_case_fields
   use dda_kinds, only : wp
   use dda_text, only : read_number, to_text
   use dda_write_results, only : number_t, result_row_t
   implicit none
   private

   public :: column_t, field_of, fit_columns, padded, source, source_enum, wrapped

   !> What a column shows; of two that do not fit beside one another the one with the smaller number
   !> stays
   type :: source_enum
      !> Number of the case
      integer :: case = 1
      !> Its verdict
      integer :: verdict = 2
      !> What the search has found
      integer :: searched = 3
      !> Value of a swept parameter
      integer :: swept = 4
      !> Error of what was found
      integer :: error = 5
      !> How the blocks collapse
      integer :: mode = 6
      !> The exact critical value
      integer :: exact = 7
      !> Hinges at the intrados of an arch
      integer :: hinges = 8
   end type source_enum

   !> The sources by name
   type(source_enum), parameter :: source = source_enum()

   !> One column
   type :: column_t
      !> Its head
      character(len=64) :: title = ""
      !> One of source
      integer :: source = 0
      !> Widest value, then width of the column
      integer :: width = 0
      !> Number of the swept parameter
      integer :: sweep = 0
      !> Whether its values are words
      logical :: left = .false.
   end type column_t

   !> Blanks before a column
   integer, parameter :: gap = 2
   !> Names of swept parameters are cut to so many characters at least, or the width of their values
   integer, parameter :: short_title = 10
   !> Most digits that a number is shown with
   integer, parameter :: most_digits = 10
   !> Blanks before a remark
   integer, parameter :: indent = 6

contains

   !> Let columns fit into a width: names of swept parameters are cut, then columns left out
   pure subroutine fit_columns(width, column)
      !> Width of the screen
      integer, intent(in) :: width
      !> The columns; their widths are set
      type(column_t), allocatable, intent(inout) :: column(:)
      integer :: values(size(column)), c, least, last

      values = column%width
      column%width = max(values, len_trim(column%title))
      do c = 1, size(column)
         if (sum(column%width + gap) - gap <= width) exit
         least = max(values(c), short_title)
         if (column(c)%source /= source%swept .or. column(c)%width <= least) cycle
         column(c)%title(least - 1:) = ".."
         column(c)%width = least
      end do
      do while (sum(column%width + gap) - gap > width .and. size(column) > 2)
         last = maxloc(column%source, dim=1, back=.true.)
         column = [column(:last - 1), column(last + 1:)]
      end do
      ! hinges have all that is left
      c = size(column)
      if (column(c)%source == source%hinges) &
         & column(c)%width = width - sum(column(:c - 1)%width + gap)
   end subroutine fit_columns

   !> What a case has in a column
   pure function field_of(column, row, swept) result(text)
      type(column_t), intent(in) :: column
      type(result_row_t), intent(in) :: row
      !> Values of the swept parameters: (n)
      character(len=*), intent(in) :: swept(:)
      !> The text; empty where the case has nothing
      character(len=:), allocatable :: text
      character(len=8) :: small

      text = ""
      select case (column%source)
      case (source%case)
         text = to_text(row%number)
      case (source%verdict)
         text = trim(row%verdict)
      case (source%searched)
         text = shown_number(row%critical, column%width)
      case (source%swept)
         text = shown_value(trim(swept(column%sweep)), column)
      case (source%error)
         if (row%relative_error%known) then
            write (small, "(es8.1)") row%relative_error%value
            text = trim(adjustl(small))
         end if
      case (source%mode)
         text = trim(row%collapse_mode)
      case (source%exact)
         text = shown_number(row%exact, column%width)
      case (source%hinges)
         if (allocated(row%intrados_hinge_deg)) &
            & text = shown_angles(row%intrados_hinge_deg, column%width)
      end select
   end function field_of

   !> A number, if it is known
   pure function shown_number(number, width) result(text)
      type(number_t), intent(in) :: number
      !> Width of its column
      integer, intent(in) :: width
      character(len=:), allocatable :: text

      text = ""
      if (number%known) text = rounded(number%value, width)
   end function shown_number

   !> A number with as many digits as fit
   pure function rounded(value, width) result(text)
      !> The number
      real(wp), intent(in) :: value
      integer, intent(in) :: width
      character(len=:), allocatable :: text
      character(len=30) :: buffer
      character(len=12) :: form
      real(wp) :: near
      integer :: digits, stat

      do digits = most_digits, 1, -1
         write (form, "(a, i0, a)") "(es30.", digits - 1, "e3)"
         write (buffer, form) value
         read (buffer, "(f30.0)", iostat=stat) near
         if (stat /= 0) near = value
         text = to_text(near)
         if (len(text) <= width) return
      end do
   end function rounded

   !> A value of a swept parameter
   pure function shown_value(value, column) result(text)
      !> The value as the tables have it
      character(len=*), intent(in) :: value
      type(column_t), intent(in) :: column
      character(len=:), allocatable :: text
      real(wp) :: number
      logical :: ok

      text = value
      if (len(text) <= column%width) return
      ok = .not. column%left
      if (ok) call read_number(value, number, ok)
      if (ok) then
         text = rounded(number, column%width)
      else
         text = value(:column%width - 2)//".."
      end if
   end function shown_value

   !> Angles, parted by blanks, as many as fit
   pure function shown_angles(angle, width) result(text)
      !> The angles: (n) [deg]
      real(wp), intent(in) :: angle(:)
      integer, intent(in) :: width
      character(len=:), allocatable :: text
      character(len=:), allocatable :: next
      integer :: i, left_over

      text = ""
      do i = 1, size(angle)
         next = " "//to_text(anint(angle(i)*1.0e6_wp)/1.0e6_wp)
         left_over = merge(0, len(" .."), i == size(angle))
         if (len(text) + len(next) + left_over > width + 1) then
            text = text//" .."
            exit
         end if
         text = text//next
      end do
      text = text(2:)
   end function shown_angles

   !> A field in its column, with the gap behind it
   pure function padded(column, text) result(field)
      type(column_t), intent(in) :: column
      !> The text
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: field
      integer :: rest

      rest = max(0, column%width - len(text))
      if (column%left) then
         field = text//repeat(" ", rest + gap)
      else
         field = repeat(" ", rest)//text//repeat(" ", gap)
      end if
   end function padded

   !> A remark in lines that are not wider than the screen, parted by line ends
   pure function wrapped(text, width) result(lines)
      !> The remark
      character(len=*), intent(in) :: text
      integer, intent(in) :: width
      character(len=:), allocatable :: lines
      integer :: blank, finish, margin, start

      lines = ""
      margin = min(indent, width/4)
      start = 1
      do while (start <= len_trim(text))
         finish = min(len_trim(text), start + width - margin - 1)
         if (finish < len_trim(text)) then
            blank = index(text(start:finish + 1), " ", back=.true.)
            if (blank > 1) finish = start + blank - 2
         end if
         if (lines /= "") lines = lines//new_line("a")
         lines = lines//repeat(" ", margin)//text(start:finish)
         start = finish + 1
         if (start <= len(text)) start = start + max(0, verify(text(start:)//"x", " ") - 1)
      end do
   end function wrapped
end module dda_case_fields
