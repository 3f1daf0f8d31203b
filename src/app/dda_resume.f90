!> dda run --resume: finished cases of an earlier run of the same deck
!>
!> A case is finished if its row in results.csv is complete, because that row is written last, and
!> if its rows have the bytes and checksum in sizes.record. All other rows of that run are removed
!> from the tables, including incomplete ones.
submodule (dda_verbs:dda_run) dda_resume
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_binary_file, only : flush_binary
   use dda_check_sum, only : add_sums, line_sum
   use dda_kinds, only : wp
   use dda_result_tables, only : common_total, result_table_t, table
   use dda_table_file, only : close_lines, field, field_number, keep_line, next_line, open_lines, &
      & open_table, part_name, rename_part, table_lines_t, without_field
   use dda_text, only : read_integer, read_number
   use dda_text_file, only : read_text_file
   implicit none

contains

   !> Find the finished cases
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
      call read_results(tables%at(table%results), whole, finished)
   end procedure find_finished

   !> Compare bytes and checksum of each case with its record
   subroutine compare_sizes(tables, whole)
      type(result_tables_t), intent(in) :: tables
      logical, intent(out) :: whole(:)  !! True for equal values: (n)
      type(table_lines_t) :: lines
      character(len=:), allocatable :: line
      integer(int64) :: bytes(2, size(whole))
      real(wp) :: saved(2)
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
            call read_number(field(line, i + 1), saved(i), ok(i))
         end do
         whole(number) = all(ok) .and. .not. any(abs(saved - real(bytes(:, number), wp)) > 0.0_wp)
      end do
      call close_lines(lines)
   end subroutine compare_sizes

   !> Add bytes and checksums of the lines of each case in a table; for results.csv only checksums,
   !> without the seconds
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

   !> Find the cases with a valid row in results.csv
   subroutine read_results(this, whole, finished)
      type(result_table_t), intent(in) :: this
      logical, intent(in) :: whole(:)  !! True for cases complete in other tables: (n)
      type(finished_t), intent(inout) :: finished
      type(table_lines_t) :: lines
      character(len=:), allocatable :: line
      real(wp) :: seconds
      integer :: column, number, outcome, verdict
      logical :: ok

      column = case_column(this%header)
      verdict = field_number(this%header, "verdict")
      call open_lines(this%file, lines)
      do
         call next_row(column, size(whole), lines, line, number)
         if (number == 0) exit
         if (finished%case(number) .or. .not. whole(number)) cycle
         ! the checksum excludes this field
         call read_number(field(line, field_number(this%header, "seconds")), seconds, ok)
         if (.not. ok) cycle
         finished%case(number) = .true.
         outcome = merge(2, 1, field(line, verdict) == "undecided")
         finished%count(outcome) = finished%count(outcome) + 1
      end do
      call close_lines(lines)
   end subroutine read_results

   !> Reopen all tables with the rows of finished cases only
   module procedure reopen_tables
      integer :: i

      do i = 1, size(tables%at)
         if (tables%at(i)%wanted) call keep_rows(tables%at(i), &
            & any(i == [table%results, table%sizes]), finished%case, error)
         if (allocated(error)) return
      end do
      tables%total = common_total(tables)
   end procedure reopen_tables

   !> Rewrite a table with the rows of finished cases only
   subroutine keep_rows(this, once, finished, error)
      type(result_table_t), intent(inout) :: this  !! The table, opened here
      logical, intent(in) :: once                  !! True if a case has at most one row
      logical, intent(in) :: finished(:)           !! True for finished cases: (n)
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
      ! a full disk must not replace the table
      call flush_binary(this%open%file, error)
      if (.not. allocated(error)) call rename_part(this%file, error)
   end subroutine keep_rows

   !> Column with the case number; 0 in the log, which is separated by blanks
   pure integer function case_column(header)
      character(len=*), intent(in) :: header  !! First line of the table

      case_column = field_number(header, "case")
      if (index(header, " ") > 0) case_column = 0
   end function case_column

   !> Return the next row with a case number; 0 at the end of the table
   subroutine next_row(column, total, lines, line, number)
      integer, intent(in) :: column                       !! Column with the case number
      integer, intent(in) :: total                        !! Number of cases
      type(table_lines_t), intent(inout) :: lines
      character(len=:), allocatable, intent(out) :: line  !! The row
      integer, intent(out) :: number                      !! Case of the row
      logical :: found

      do
         number = 0
         call next_line(lines, line, found)
         if (found) number = case_of(column, line, total)
         if (number > 0 .or. .not. found) exit
      end do
   end subroutine next_row

   !> Case of a line; 0 without a valid number. Incomplete lines are detected by the checksum of the
   !> case
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
