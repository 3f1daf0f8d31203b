!> Columns of the table on the screen: which fit into its width, and what a case has in each
submodule (dda_case_table) dda_case_fields
   use dda_kinds, only : wp
   use dda_text, only : read_number
   use dda_write_results, only : number_t
   implicit none

   !> Blanks before a column
   integer, parameter :: gap = 2
   !> Names of swept parameters are cut to so many characters at least, or the width of their values
   integer, parameter :: short_title = 10
   !> Most digits that a number is shown with
   integer, parameter :: most_digits = 10
   !> Blanks before a remark
   integer, parameter :: indent = 6

contains

   !> Let columns fit into a width
   module procedure fit_columns
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
   end procedure fit_columns

   !> What a case has in a column
   module procedure field_of
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
   end procedure field_of

   !> A number, if it is known
   pure function shown_number(number, width) result(text)
      type(number_t), intent(in) :: number
      integer, intent(in) :: width  !! Width of its column
      character(len=:), allocatable :: text

      text = ""
      if (number%known) text = rounded(number%value, width)
   end function shown_number

   !> A number with as many digits as fit
   pure function rounded(value, width) result(text)
      real(wp), intent(in) :: value  !! The number
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
      character(len=*), intent(in) :: value  !! The value as the tables have it
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
      real(wp), intent(in) :: angle(:)  !! The angles: (n) [deg]
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
   module procedure padded
      integer :: rest

      rest = max(0, column%width - len(text))
      if (column%left) then
         field = text//repeat(" ", rest + gap)
      else
         field = repeat(" ", rest)//text//repeat(" ", gap)
      end if
   end procedure padded

   !> A remark in lines that are not wider than the screen, parted by line ends
   module procedure wrapped
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
   end procedure wrapped

end submodule dda_case_fields
