!> The table on the screen: one line per case, within the width of the terminal
module dda_case_table
   use dda_case, only : searched_name
   use dda_deck, only : deck_sweep_t, deck_t, keeps_velocities, source_of
   use dda_deck_sweep, only : n_cases, swept_texts
   use dda_kinds, only : wp
   use dda_process, only : error_is_terminal
   use dda_screen, only : end_watch, print_line, progress_t, report_progress, screen_t, screen_width
   use dda_text, only : read_number, to_text
   use dda_write_results, only : number_t, result_row_t
   implicit none
   private

   public :: case_table_t, new_case_table, add_case, end_case_table

   !> Lines of a case, separated by line ends; unallocated if nothing is to be printed
   type :: lines_t
      character(len=:), allocatable :: text  !! The lines
   end type lines_t

   !> Contents of columns; if two do not fit side by side, the one with the smaller number is kept
   type :: source_enum
      integer :: case = 1      !! Number of the case
      integer :: verdict = 2   !! Its verdict
      integer :: searched = 3  !! Critical value of the search
      integer :: swept = 4     !! Value of a swept parameter
      integer :: error = 5     !! Relative error of the critical value
      integer :: mode = 6      !! Collapse mode
      integer :: exact = 7     !! The exact critical value
      integer :: hinges = 8    !! Hinges at the intrados of an arch
   end type source_enum

   !> Names of the contents
   type(source_enum), parameter :: source = source_enum()

   !> One column
   type :: column_t
      character(len=64) :: title = ""  !! Header
      integer :: source = 0      !! One of source
      integer :: width = 0       !! Width of the widest value, later of the column
      integer :: sweep = 0       !! Number of the swept parameter
      logical :: left = .false.  !! True for left-aligned words
   end type column_t

   !> The table of a deck
   type :: case_table_t
      private
      type(screen_t) :: screen                  !! Screen for the table
      type(progress_t) :: progress              !! Progress of the cases
      integer :: width = 0                      !! Largest width of a line
      type(column_t), allocatable :: column(:)  !! Its columns
      logical :: begun = .false.                !! True if the header is printed
      logical :: all_cases = .true.  !! True to print all cases; otherwise only the undecided ones
      logical, allocatable :: awaited(:)  !! Cases not yet computed: (n)
      integer :: next = 1                 !! Next case to print
      !> Lines that must follow those of earlier cases, by the number of the case: (n)
      type(lines_t), allocatable :: waiting(:)
   end type case_table_t

   !> Maximum number of cases printed one by one
   integer, parameter :: max_rows = 100
   !> Largest width of a number and of a word
   integer, parameter :: number_width = 12, word_width = 20
   !> Blanks between columns
   integer, parameter :: gap = 2
   !> Smallest width of the name of a swept parameter
   integer, parameter :: short_title = 10
   !> Maximum number of digits of a number
   integer, parameter :: most_digits = 10
   !> Blanks before a remark
   integer, parameter :: indent = 6

contains

   !> Start the table of a deck; nothing is printed before the first row
   subroutine new_case_table(screen, deck, chosen, table)
      type(screen_t), intent(in) :: screen
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: chosen(:)  !! Cases to compute: (n)
      type(case_table_t), intent(out) :: table

      table%screen = screen
      table%progress%shown = error_is_terminal()
      table%progress%total = count(chosen)
      call system_clock(table%progress%start)
      table%width = screen_width(screen)
      table%all_cases = n_cases(deck) <= max_rows
      table%progress%delay = 0.0_wp
      if (table%all_cases) table%progress%interval = 0.0_wp
      allocate (table%awaited, source=chosen)
      allocate (table%waiting(size(chosen)))
      allocate (table%column(0))
      call choose_columns(deck, table%column)
      call fit_columns(table%width, table%column)
   end subroutine new_case_table

   !> Choose the columns for the scenes of a deck
   pure subroutine choose_columns(deck, column)
      type(deck_t), intent(in) :: deck
      type(column_t), allocatable, intent(inout) :: column(:)  !! The columns
      character(len=:), allocatable :: searched
      logical :: arch, can_collapse
      integer :: s

      searched = searched_name(deck)
      arch = source_of(deck) == "arch"
      associate (swept => deck%sweeps%name)
         ! a dynamic run ends at its last time, not with a collapse
         can_collapse = .not. keeps_velocities(deck) &
            & .or. any(swept == "mode" .or. swept == "dynamic")
         column = [column_t("case", source%case, len(to_text(n_cases(deck))))]
         do s = 1, size(swept)
            column = [column, column_t(swept(s), source%swept, longest(deck%sweeps(s)), s, &
               & size(deck%sweeps(s)%texts) > 0)]
         end do
      end associate
      if (searched /= "") column = [column, column_t(searched, source%searched, 14)]
      column = [column, column_t("verdict", source%verdict, 9, left=.true.)]
      if (arch .and. searched == "thickness_ratio") then
         column = [column, column_t("exact", source%exact, number_width), &
            & column_t("error", source%error, 8)]
      else if (arch .and. searched == "") then
         column = [column, column_t("exact critical", source%exact, number_width)]
      end if
      if (can_collapse) column = [column, column_t("mode", source%mode, 10, left=.true.)]
      if (can_collapse .and. arch) column = [column, &
         & column_t("intrados hinge", source%hinges, 10, left=.true.)]
   end subroutine choose_columns

   !> Width of the longest value of a sweep, up to a limit
   pure integer function longest(sweep)
      type(deck_sweep_t), intent(in) :: sweep
      integer :: i

      longest = 1
      if (size(sweep%texts) > 0) longest = min(maxval(len_trim(sweep%texts)), word_width)
      do i = 1, size(sweep%numbers)
         if (longest >= number_width) exit
         longest = min(max(longest, len(to_text(sweep%numbers(i)))), number_width)
      end do
   end function longest

   !> Add a computed case; its lines are printed after those of all cases before it
   subroutine add_case(table, deck, row, remark)
      type(case_table_t), intent(inout) :: table
      type(deck_t), intent(in) :: deck
      type(result_row_t), intent(in) :: row
      character(len=*), intent(in) :: remark  !! Additional information for the user

      table%awaited(row%number) = .false.
      if (table%all_cases .or. row%verdict == "undecided") &
         & table%waiting(row%number)%text = row_lines(table, deck, row, remark)
      do while (table%next <= size(table%awaited))
         if (table%awaited(table%next)) exit
         call print_next(table)
      end do
      call report_progress(table%progress)
   end subroutine add_case

   !> Print the remaining lines at the end of the run
   subroutine end_case_table(table)
      type(case_table_t), intent(inout) :: table

      call end_watch(table%progress)
      do while (table%next <= size(table%waiting))
         call print_next(table)
      end do
   end subroutine end_case_table

   !> Lines of a case, separated by line ends
   pure function row_lines(table, deck, row, remark) result(lines)
      type(case_table_t), intent(in) :: table
      type(deck_t), intent(in) :: deck
      type(result_row_t), intent(in) :: row
      character(len=*), intent(in) :: remark
      character(len=:), allocatable :: lines
      integer :: c

      lines = ""
      associate (swept => swept_texts(deck, row%number))
         do c = 1, size(table%column)
            lines = lines//padded(table%column(c), field_of(table%column(c), row, swept))
         end do
      end associate
      lines = lines(:min(len_trim(lines), table%width))
      if (remark /= "") lines = lines//new_line("a")//wrapped(remark, table%width)
   end function row_lines

   !> Print the next case, after the header if it is the first, and advance
   subroutine print_next(table)
      type(case_table_t), intent(inout) :: table
      character(len=:), allocatable :: head
      integer :: i

      associate (lines => table%waiting(table%next))
         table%next = table%next + 1
         if (.not. allocated(lines%text)) return
         call end_watch(table%progress)
         if (.not. table%begun) then
            head = ""
            do i = 1, size(table%column)
               head = head//padded(table%column(i), trim(table%column(i)%title))
            end do
            call print_line(table%screen, head(:min(len_trim(head), table%width)))
            table%begun = .true.
         end if
         call print_line(table%screen, lines%text)
         deallocate (lines%text)
      end associate
   end subroutine print_next

   !> Fit columns into a width: shorten names of swept parameters, then omit columns
   pure subroutine fit_columns(width, column)
      integer, intent(in) :: width                             !! Width of the screen
      type(column_t), allocatable, intent(inout) :: column(:)  !! The columns; their widths are set
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
      ! hinges get the remaining width
      c = size(column)
      if (column(c)%source == source%hinges) &
         & column(c)%width = width - sum(column(:c - 1)%width + gap)
   end subroutine fit_columns

   !> Text of a case in a column
   pure function field_of(column, row, swept) result(text)
      type(column_t), intent(in) :: column
      type(result_row_t), intent(in) :: row
      character(len=*), intent(in) :: swept(:)  !! Values of the swept parameters: (n)
      character(len=:), allocatable :: text     !! The text; empty if the case has no value
      character(len=8) :: small

      text = ""
      select case (column%source)
      case (source%case)
         text = to_text(row%number)
      case (source%verdict)
         text = trim(row%verdict)
      case (source%searched)
         if (row%critical%known) text = rounded(row%critical%value, column%width, known_digits(row))
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

   !> Text of a number, empty if unknown
   pure function shown_number(number, width) result(text)
      type(number_t), intent(in) :: number
      integer, intent(in) :: width  !! Width of its column
      character(len=:), allocatable :: text

      text = ""
      if (number%known) text = rounded(number%value, width)
   end function shown_number

   !> Number of digits of the critical value of a search: one more than its bracket determines
   pure integer function known_digits(row)
      type(result_row_t), intent(in) :: row
      real(wp) :: half

      known_digits = most_digits
      half = 0.5_wp*(row%critical_high%value - row%critical_low%value)
      if (.not. (row%critical_low%known .and. row%critical_high%known)) return
      if (.not. (half > 0.0_wp .and. half < abs(row%critical%value))) return
      known_digits = min(most_digits, 2 + floor(log10(abs(row%critical%value)/half)))
   end function known_digits

   !> Text of a number with as many digits as fit
   pure function rounded(value, width, most) result(text)
      real(wp), intent(in) :: value          !! The number
      integer, intent(in) :: width
      integer, intent(in), optional :: most  !! Largest number of its digits
      character(len=:), allocatable :: text
      character(len=30) :: buffer
      character(len=12) :: form
      real(wp) :: near
      integer :: digits, first, stat

      first = most_digits
      if (present(most)) first = most
      do digits = first, 1, -1
         write (form, "(a, i0, a)") "(es30.", digits - 1, "e3)"
         write (buffer, form) value
         read (buffer, "(f30.0)", iostat=stat) near
         if (stat /= 0) near = value
         text = to_text(near)
         if (len(text) <= width) return
      end do
   end function rounded

   !> Text of a value of a swept parameter
   pure function shown_value(value, column) result(text)
      character(len=*), intent(in) :: value  !! The value as in the result tables
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

   !> As many angles as fit, separated by blanks
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

   !> A field padded to the width of its column, followed by the gap
   pure function padded(column, text) result(field)
      type(column_t), intent(in) :: column
      character(len=*), intent(in) :: text  !! The text
      character(len=:), allocatable :: field
      integer :: rest

      rest = max(0, column%width - len(text))
      if (column%left) then
         field = text//repeat(" ", rest + gap)
      else
         field = repeat(" ", rest)//text//repeat(" ", gap)
      end if
   end function padded

   !> A remark in lines no wider than the screen, separated by line ends
   pure function wrapped(text, width) result(lines)
      character(len=*), intent(in) :: text  !! The remark
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
end module dda_case_table
