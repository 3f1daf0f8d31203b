!> dda run --resume: what an earlier run of the same deck has finished
!>
!> A case is finished where its row in results.csv is whole, for that row is written last, and where
!> its rows have the bytes and the check sum that sizes.record tells. Everything else of that run,
!> rows cut off by a kill among them, is left out of the tables.
submodule (dda_verbs:dda_run) dda_resume
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_check_sum, only : add_sums, line_sum
   use dda_disk_record, only : trusted_length
   use dda_kinds, only : wp
   use dda_result_tables, only : common_length, common_sum, result_table_t, sync_tables, table
   use dda_table_file, only : close_lines, field, field_number, keep_line, n_fields, next_line, &
      & open_lines, open_part, settle_part, table_lines_t, &
      & without_field
   use dda_text, only : read_integer, read_number
   use dda_text_file, only : read_text_file
   implicit none

   !> Where a table has what tells a whole row of a case
   type :: layout_t
      !> Number of columns; 0 for the log, which has blanks in place of commas and free remarks
      integer :: columns = 0
      integer :: case = 1     !! Column of the case
      integer :: seconds = 0  !! Column of the seconds of results.csv; 0 in other tables
      !> Column of the unknowns of results.csv, the last one that is never empty; 0 in other tables
      integer :: unknowns = 0
   end type layout_t

contains

   !> Find the cases that are finished
   module procedure find_finished
      character(len=:), allocatable :: earlier
      type(error_t), allocatable :: none_left
      logical, allocatable :: whole(:)

      allocate (finished%case(total), source=.false.)
      call read_text_file(tables%record_file, earlier, none_left)
      if (.not. allocated(none_left)) finished%same_deck = earlier == record//new_line("a")
      if (.not. finished%same_deck) return
      allocate (whole(total))
      call compare_sizes(tables, whole)
      call read_results(tables%at(table%results), trusted_length(tables%disk_file), whole, finished)
   end procedure find_finished

   !> Whether each case has the bytes and the check sum that were written down of it
   subroutine compare_sizes(tables, whole)
      type(result_tables_t), intent(in) :: tables
      logical, intent(out) :: whole(:)  !! Whether it has: (n)
      type(table_lines_t) :: lines
      type(layout_t) :: layout
      character(len=:), allocatable :: line
      integer(int64) :: bytes(2, size(whole))
      real(wp) :: told(2)
      integer :: i, number
      logical :: ok(2)

      bytes = 0
      do i = 1, size(tables%at)
         if (tables%at(i)%wanted .and. i /= table%sizes) call add_bytes(tables%at(i), bytes)
      end do
      whole = .false.
      layout = layout_of(tables%at(table%sizes)%header)
      call open_lines(tables%at(table%sizes)%file, lines)
      do
         call next_row(layout, size(whole), lines, line, number)
         if (number == 0) exit
         do i = 1, 2
            call read_number(field(line, i + 1), told(i), ok(i))
         end do
         whole(number) = all(ok) .and. .not. any(abs(told - real(bytes(:, number), wp)) > 0.0_wp)
      end do
      call close_lines(lines)
   end subroutine compare_sizes

   !> Add the bytes that each case has in a table, and the check sums of its lines; of results.csv
   !> these sums without the seconds
   subroutine add_bytes(this, bytes)
      type(result_table_t), intent(in) :: this
      integer(int64), intent(inout) :: bytes(:, :)  !! Bytes and sum: (2, n)
      type(table_lines_t) :: lines
      type(layout_t) :: layout
      character(len=:), allocatable :: line
      integer :: number

      layout = layout_of(this%header)
      call open_lines(this%file, lines)
      do
         call next_row(layout, size(bytes, 2), lines, line, number)
         if (number == 0) exit
         if (layout%seconds > 0) then
            line = without_field(line, layout%seconds)
         else
            bytes(1, number) = bytes(1, number) + len(line) + 1
         end if
         bytes(2, number) = add_sums(bytes(2, number), line_sum(line))
      end do
      call close_lines(lines)
   end subroutine add_bytes

   !> Read which cases have a whole row in results.csv
   subroutine read_results(this, length, whole, finished)
      type(result_table_t), intent(in) :: this
      integer(int64), intent(in) :: length  !! Length up to which its rows count [bytes]
      logical, intent(in) :: whole(:)       !! Whether a case is whole in the other tables: (n)
      type(finished_t), intent(inout) :: finished
      type(table_lines_t) :: lines
      type(layout_t) :: layout
      character(len=:), allocatable :: line
      integer :: number, outcome, verdict

      layout = layout_of(this%header)
      verdict = field_number(this%header, "verdict")
      call open_lines(this%file, lines, length)
      do
         call next_row(layout, size(whole), lines, line, number)
         if (number == 0) exit
         if (finished%case(number) .or. .not. whole(number)) cycle
         finished%case(number) = .true.
         outcome = merge(2, 1, field(line, verdict) == "undecided")
         finished%count(outcome) = finished%count(outcome) + 1
      end do
      call close_lines(lines)
   end subroutine read_results

   !> Begin all tables with what they hold of finished cases, in place of what they hold now
   module procedure reopen_tables
      integer :: i

      do i = 1, size(tables%at)
         if (tables%at(i)%wanted) call keep_rows(tables%at(i), &
            & any(i == [table%results, table%sizes]), finished%case, error)
         if (allocated(error)) return
      end do
      tables%length = common_length(tables)
      tables%sum = common_sum(tables)
      call sync_tables(tables, error)
   end procedure reopen_tables

   !> Write a table anew with the rows of finished cases alone
   subroutine keep_rows(this, once, finished, error)
      type(result_table_t), intent(inout) :: this  !! The table; is open afterwards
      logical, intent(in) :: once                  !! Whether a case has no more than one row
      logical, intent(in) :: finished(:)           !! Whether a case is finished: (n)
      type(error_t), allocatable, intent(out) :: error
      type(table_lines_t) :: lines
      character(len=:), allocatable :: line
      type(layout_t) :: layout
      logical, allocatable :: wanted(:)
      integer :: number

      call open_part(this%file, this%header, this%open, error)
      if (allocated(error)) return
      allocate (wanted, source=finished)
      layout = layout_of(this%header)
      call open_lines(this%file, lines)
      do
         call next_row(layout, size(finished), lines, line, number)
         if (number == 0) exit
         if (wanted(number)) call keep_line(this%open, line)
         if (once) wanted(number) = .false.
      end do
      call close_lines(lines)
      call settle_part(this%file, this%open, error)
   end subroutine keep_rows

   !> Where a table has what tells a whole row
   pure type(layout_t) function layout_of(header) result(layout)
      character(len=*), intent(in) :: header  !! First line of the table

      if (index(header, " ") > 0) return
      layout%columns = n_fields(header)
      layout%case = field_number(header, "case")
      layout%seconds = field_number(header, "seconds")
      layout%unknowns = field_number(header, "unknowns")
   end function layout_of

   !> The next whole row of a table, and its case; 0 at the end of the table
   subroutine next_row(layout, total, lines, line, number)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: total                        !! Number of cases
      type(table_lines_t), intent(inout) :: lines
      character(len=:), allocatable, intent(out) :: line  !! The row
      integer, intent(out) :: number                      !! Its case
      logical :: found

      do
         number = 0
         call next_line(lines, line, found)
         if (found) number = case_of(layout, line, total)
         if (number > 0 .or. .not. found) exit
      end do
   end subroutine next_row

   !> Case that a line belongs to; 0 for one that is no whole row of the table
   pure integer function case_of(layout, line, total)
      type(layout_t), intent(in) :: layout
      character(len=*), intent(in) :: line  !! The line
      integer, intent(in) :: total
      real(wp) :: seconds
      integer :: unknowns
      logical :: ok

      if (layout%columns == 0) then
         call read_integer(line(:max(0, index(line, " ") - 1)), case_of, ok)
      else
         ok = n_fields(line) == layout%columns
         if (ok) call read_integer(field(line, layout%case), case_of, ok)
         if (ok .and. layout%seconds > 0) call read_number(field(line, layout%seconds), seconds, ok)
         if (ok .and. layout%unknowns > 0) &
            & call read_integer(field(line, layout%unknowns), unknowns, ok)
      end if
      if (ok) ok = case_of >= 1 .and. case_of <= total
      if (.not. ok) case_of = 0
   end function case_of

end submodule dda_resume
