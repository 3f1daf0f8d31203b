!> dda run --resume: finished cases of an earlier run of the same deck
!>
!> A case is finished where its row in results.csv is whole, for that row is written last, and where
!> its rows have the bytes and the check sum that sizes.record tells. Everything else of that run,
!> rows cut off by a kill among them, is left out of the tables.
submodule (dda_verbs:dda_run) dda_resume
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_binary_file, only : sync_binary
   use dda_check_sum, only : add_sums, line_sum
   use dda_disk_record, only : trusted_length
   use dda_kinds, only : wp
   use dda_result_tables, only : common_total, result_table_t, sync_tables, table
   use dda_table_file, only : close_lines, field, field_number, keep_line, next_line, open_lines, &
      & open_table, part_name, rename_part, table_lines_t, without_field
   use dda_text, only : read_integer, read_number
   use dda_text_file, only : read_text_file
   implicit none

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
      character(len=:), allocatable :: line
      integer(int64) :: bytes(2, size(whole))
      real(wp) :: told(2)
      integer :: column, i, number
      logical :: ok(2)

      bytes = 0
      do i = 1, size(tables%at)
         if (tables%at(i)%wanted .and. i /= table%sizes) call add_bytes(tables%at(i), bytes)
      end do
      whole = .false.
      column = case_column(tables%at(table%sizes)%header)
      call open_lines(tables%at(table%sizes)%file, lines)
      do
         call next_row(column, size(whole), lines, line, number)
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
      character(len=:), allocatable :: line
      integer :: column, number, seconds

      column = case_column(this%header)
      seconds = field_number(this%header, "seconds")
      call open_lines(this%file, lines)
      do
         call next_row(column, size(bytes, 2), lines, line, number)
         if (number == 0) exit
         if (seconds == 0) bytes(1, number) = bytes(1, number) + len(line) + 1
         line = without_field(line, seconds)
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
      character(len=:), allocatable :: line
      real(wp) :: seconds
      integer :: column, number, outcome, verdict
      logical :: ok

      column = case_column(this%header)
      verdict = field_number(this%header, "verdict")
      call open_lines(this%file, lines, length)
      do
         call next_row(column, size(whole), lines, line, number)
         if (number == 0) exit
         if (finished%case(number) .or. .not. whole(number)) cycle
         ! what the check sum leaves out
         call read_number(field(line, field_number(this%header, "seconds")), seconds, ok)
         if (.not. ok) cycle
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
      tables%total = common_total(tables)
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
      logical, allocatable :: wanted(:)
      integer :: column, number

      call open_table(part_name(this%file), this%header, this%open, error)
      if (allocated(error)) return
      allocate (wanted, source=finished)
      column = case_column(this%header)
      call open_lines(this%file, lines)
      do
         call next_row(column, size(finished), lines, line, number)
         if (number == 0) exit
         if (wanted(number)) call keep_line(this%open, line)
         if (once) wanted(number) = .false.
      end do
      call close_lines(lines)
      ! on the disk first: its name must not outlive its lines
      call sync_binary(this%open%file, error)
      if (.not. allocated(error)) call rename_part(this%file, error)
   end subroutine keep_rows

   !> Column of the case in a table; 0 in the log, which has blanks in place of commas
   pure integer function case_column(header)
      character(len=*), intent(in) :: header  !! First line of the table

      case_column = field_number(header, "case")
      if (index(header, " ") > 0) case_column = 0
   end function case_column

   !> The next row of a table that names a case; 0 at the end of the table
   subroutine next_row(column, total, lines, line, number)
      integer, intent(in) :: column                       !! Column of the case
      integer, intent(in) :: total                        !! Number of cases
      type(table_lines_t), intent(inout) :: lines
      character(len=:), allocatable, intent(out) :: line  !! The row
      integer, intent(out) :: number                      !! Its case
      logical :: found

      do
         number = 0
         call next_line(lines, line, found)
         if (found) number = case_of(column, line, total)
         if (number > 0 .or. .not. found) exit
      end do
   end subroutine next_row

   !> Case that a line belongs to; 0 for one that names none. Whether the line is whole shows in the
   !> check sum of the case
   pure integer function case_of(column, line, total)
      integer, intent(in) :: column
      character(len=*), intent(in) :: line  !! The line
      integer, intent(in) :: total
      logical :: ok

      if (column == 0) then
         call read_integer(line(:max(0, index(line, " ") - 1)), case_of, ok)
      else
         call read_integer(field(line, column), case_of, ok)
      end if
      if (case_of < 1 .or. case_of > total) case_of = 0
   end function case_of

end submodule dda_resume
