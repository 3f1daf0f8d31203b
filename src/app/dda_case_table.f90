!> The table that a run shows: a line a case, in their order, and no wider than the screen
module dda_case_table
   use dda_case, only : searched_name
   use dda_deck, only : deck_sweep_t, deck_t, keeps_velocities, source_of
   use dda_deck_sweep, only : n_cases, swept_texts
   use dda_process, only : error_is_terminal
   use dda_screen, only : end_watch, print_line, progress_t, report_progress, screen_t, screen_width
   use dda_text, only : to_text
   use dda_write_results, only : result_row_t
   implicit none
   private

   public :: case_table_t, new_case_table, add_case, end_case_table

   !> Lines of a case, parted by line ends; unallocated where nothing of it is to be printed
   type :: lines_t
      character(len=:), allocatable :: text  !! The lines
   end type lines_t

   !> What a column shows; of two that do not fit beside one another the one with the smaller number
   !> stays
   type :: source_enum
      integer :: case = 1      !! Number of the case
      integer :: verdict = 2   !! Its verdict
      integer :: searched = 3  !! What the search has found
      integer :: swept = 4     !! Value of a swept parameter
      integer :: error = 5     !! Error of what was found
      integer :: mode = 6      !! How the blocks collapse
      integer :: exact = 7     !! The exact critical value
      integer :: hinges = 8    !! Hinges at the intrados of an arch
   end type source_enum

   !> The sources by name
   type(source_enum), parameter :: source = source_enum()

   !> One column
   type :: column_t
      character(len=64) :: title = ""  !! Its head
      integer :: source = 0            !! One of source
      integer :: width = 0             !! Widest value, then width of the column
      integer :: sweep = 0             !! Number of the swept parameter
      logical :: left = .false.        !! Whether its values are words
   end type column_t

   !> The table of a deck
   type :: case_table_t
      private
      !> Where it goes
      type(screen_t) :: screen
      !> How far the cases are
      type(progress_t) :: progress
      !> Widest line that it may have
      integer :: width = 0
      !> Its columns
      type(column_t), allocatable :: column(:)
      !> Whether its head is printed
      logical :: begun = .false.
      !> Whether all cases are printed, or of many only those that are undecided
      logical :: all_cases = .true.
      !> Cases that are not computed yet: (n)
      logical, allocatable :: awaited(:)
      !> The first case that is not printed yet
      integer :: next = 1
      !> What waits for the lines of an earlier case, by the number of the case: (n)
      type(lines_t), allocatable :: waiting(:)
   end type case_table_t

   !> Most cases that are printed one by one
   integer, parameter :: max_rows = 100
   !> Widest number and word of a swept parameter
   integer, parameter :: number_width = 12, word_width = 20

   interface

      !> Let columns fit into a width: names of swept parameters are cut, then columns left out
      pure module subroutine fit_columns(width, column)
         !> Width of the screen
         integer, intent(in) :: width
         !> The columns; their widths are set
         type(column_t), allocatable, intent(inout) :: column(:)
      end subroutine fit_columns

      !> What a case has in a column
      pure module function field_of(column, row, swept) result(text)
         type(column_t), intent(in) :: column
         type(result_row_t), intent(in) :: row
         character(len=*), intent(in) :: swept(:)  !! Values of the swept parameters: (n)
         character(len=:), allocatable :: text     !! The text; empty where the case has nothing
      end function field_of

      !> A field in its column, with the gap behind it
      pure module function padded(column, text) result(field)
         type(column_t), intent(in) :: column
         character(len=*), intent(in) :: text  !! The text
         character(len=:), allocatable :: field
      end function padded

      !> A remark in lines that are not wider than the screen, parted by line ends
      pure module function wrapped(text, width) result(lines)
         character(len=*), intent(in) :: text  !! The remark
         integer, intent(in) :: width
         character(len=:), allocatable :: lines
      end function wrapped

   end interface

contains

   !> Begin the table of a deck; nothing is printed before its first row
   subroutine new_case_table(screen, deck, chosen, table)
      type(screen_t), intent(in) :: screen
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: chosen(:)  !! Cases that will be computed: (n)
      type(case_table_t), intent(out) :: table

      table%screen = screen
      table%progress%shown = error_is_terminal()
      table%progress%total = count(chosen)
      call system_clock(table%progress%start)
      table%width = screen_width(screen)
      table%all_cases = n_cases(deck) <= max_rows
      table%progress%patience = 0.0_wp
      if (table%all_cases) table%progress%interval = 0.0_wp
      allocate (table%awaited, source=chosen)
      allocate (table%waiting(size(chosen)))
      allocate (table%column(0))
      call choose_columns(deck, table%column)
      call fit_columns(table%width, table%column)
   end subroutine new_case_table

   !> The columns that the scenes of a deck have
   pure subroutine choose_columns(deck, column)
      type(deck_t), intent(in) :: deck
      type(column_t), allocatable, intent(inout) :: column(:)  !! Receives the columns
      character(len=:), allocatable :: searched
      logical :: arch, falls
      integer :: s

      searched = searched_name(deck)
      arch = source_of(deck) == "arch"
      associate (swept => deck%sweeps%name)
         ! a run in time ends when it is over, not with a collapse
         falls = .not. keeps_velocities(deck) .or. any(swept == "mode" .or. swept == "dynamic")
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
      if (falls) column = [column, column_t("mode", source%mode, 10, left=.true.)]
      if (falls .and. arch) column = [column, &
         & column_t("intrados hinge", source%hinges, 10, left=.true.)]
   end subroutine choose_columns

   !> Width of the longest value of a sweep, as far as it is shown
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

   !> Take a computed case; its lines are printed when all before it are computed
   subroutine add_case(table, deck, row, remark)
      type(case_table_t), intent(inout) :: table
      type(deck_t), intent(in) :: deck
      type(result_row_t), intent(in) :: row
      character(len=*), intent(in) :: remark  !! What the user should know beside the row

      table%awaited(row%number) = .false.
      if (table%all_cases .or. row%verdict == "undecided") &
         & table%waiting(row%number)%text = row_lines(table, deck, row, remark)
      do while (table%next <= size(table%awaited))
         if (table%awaited(table%next)) exit
         call print_next(table)
      end do
      call report_progress(table%progress)
   end subroutine add_case

   !> Print what still waits, if the run ends before its cases
   subroutine end_case_table(table)
      type(case_table_t), intent(inout) :: table

      call end_watch(table%progress)
      do while (table%next <= size(table%waiting))
         call print_next(table)
      end do
   end subroutine end_case_table

   !> Lines of a case, parted by line ends
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

   !> Print the next case, below the head of the table, and go on to the one after it
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
end module dda_case_table
