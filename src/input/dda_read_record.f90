!> Records of motion: files of numbers in columns, separated by commas or blanks, below a header
module dda_read_record
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error, place_error
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_table_file, only : field, n_fields
   use dda_text, only : lower_case, read_integer, read_number, to_text
   use dda_text_file, only : read_text_file, text_mark
   implicit none
   private

   public :: read_record, parse_record, column_size

   !> Longest name of a column [characters]
   integer, parameter :: column_size = 32
   !> Most columns of a record
   integer, parameter :: most_columns = 10000
   !> Largest magnitude of a number
   real(wp), parameter :: largest = 1.0e30_wp
   !> What begins a line of comment
   character(len=*), parameter :: comment = "#!%"

contains

   !> Read a record
   subroutine read_record(file, column, scale, row, mark, error)
      character(len=*), intent(in) :: file  !! Name of the file
      !> Columns of time, x and y: numbers from 1, 0 for none, or names of the header: (3)
      character(len=*), intent(in) :: column(3)
      real(wp), intent(in) :: scale                    !! What the two components are multiplied by
      real(wp), allocatable, intent(out) :: row(:, :)  !! Time and components: (3, n)
      !> Length and check sums of the file
      character(len=:), allocatable, intent(out) :: mark
      !> Bad input, with file and line; without a line if the file cannot be read
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      mark = ""
      call read_text_file(file, text, error)
      if (allocated(error)) return
      call parse_record(text, column, scale, row, error)
      if (allocated(error)) error%file = file
      mark = text_mark(text)
   end subroutine read_record

   !> A record from its text. Lines before the first that begins with a number are its header
   pure subroutine parse_record(text, column, scale, row, error)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: column(3)
      real(wp), intent(in) :: scale
      real(wp), allocatable, intent(out) :: row(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer :: place(3), start, finish, number, n, header(2)

      allocate (row(3, 64))
      header = [1, 0]
      n = 0
      number = 0
      start = 1
      do while (start <= len(text))
         finish = start + index(text(start:), achar(10)) - 2
         if (finish < start - 1) finish = len(text)
         number = number + 1
         associate (line => text(start:finish))
            if (is_blank(line)) then
               continue
            else if (n == 0 .and. .not. begins_with_number(line)) then
               header = [start, finish]
            else
               if (n == 0) call find_columns(text(header(1):header(2)), column, place, error)
               if (allocated(error)) exit
               call make_room(row, n + 1)
               n = n + 1
               call take_row(line, place, scale, row(:, n), error)
               if (.not. allocated(error) .and. n > 1) call check_time(row(1, n - 1:n), error)
               if (allocated(error)) exit
            end if
         end associate
         start = finish + 2
      end do
      row = row(:, :n)
      if (n < 2 .and. .not. allocated(error)) call fatal_error(error, "expected a record of at " &
         & //"least two rows that begin with a number, got "//to_text(n))
      call place_error(error, max(1, number))
   end subroutine parse_record

   !> Whether a line says nothing
   pure logical function is_blank(line)
      character(len=*), intent(in) :: line  !! The line
      integer :: first

      first = verify(line, " "//achar(9))
      is_blank = first == 0
      if (.not. is_blank) is_blank = scan(line(first:first), comment) > 0
   end function is_blank

   !> Whether the first field of a line is a number
   pure logical function begins_with_number(line)
      character(len=*), intent(in) :: line
      real(wp) :: value

      call read_number(field_of(line, 1), value, begins_with_number)
   end function begins_with_number

   !> One field of a line: between commas if there are any, else between blanks
   pure function field_of(line, number) result(text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number  !! Its number, from 1
      !> The field without blanks and double quotes around it; empty if there is none
      character(len=:), allocatable :: text
      character(len=2), parameter :: blanks = " "//achar(9)
      integer :: first, last, k

      if (index(line, ",") > 0) then
         text = field(line, number)
      else
         text = ""
         last = 0
         do k = 1, number
            first = last + verify(line(last + 1:)//"|", blanks)
            if (first > len(line)) return
            last = first + scan(line(first:)//" ", blanks) - 2
         end do
         text = line(first:last)
      end if
      text = text(max(1, verify(text, blanks//"""")):verify(text, blanks//"""", back=.true.))
   end function field_of

   !> Numbers of the columns; a name is looked for in the last line of the header
   pure subroutine find_columns(header, column, place, error)
      character(len=*), intent(in) :: header  !! That line; empty if there is none
      character(len=*), intent(in) :: column(3)
      integer, intent(out) :: place(3)        !! Their numbers, 0 for none: (3)
      type(error_t), allocatable, intent(out) :: error
      integer :: i, k
      logical :: ok

      do i = 1, 3
         call read_integer(trim(column(i)), place(i), ok)
         if (ok) ok = place(i) >= merge(1, 0, i == 1) .and. place(i) <= most_columns
         if (ok) cycle
         do k = n_columns(header), 1, -1
            if (lower_case(field_of(header, k)) == column(i)) exit
         end do
         place(i) = k
         if (k > 0) cycle
         call fatal_error(error, "expected column '"//shown(trim(column(i)))//"', a number from " &
            & //"1 to "//to_text(most_columns)//" or a name in the header, got none; " &
            & //"name another")
         return
      end do
   end subroutine find_columns

   !> Number of fields of a line
   pure integer function n_columns(line)
      character(len=*), intent(in) :: line

      n_columns = n_fields(line)
      if (index(line, ",") > 0) return
      n_columns = 0
      do while (field_of(line, n_columns + 1) /= "")
         n_columns = n_columns + 1
      end do
   end function n_columns

   !> Take the numbers of a row
   pure subroutine take_row(line, place, scale, row, error)
      character(len=*), intent(in) :: line
      integer, intent(in) :: place(3)  !! Columns of time, x and y; 0 for none: (3)
      real(wp), intent(in) :: scale
      real(wp), intent(out) :: row(3)  !! Time and components: (3)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      logical :: ok

      row = 0.0_wp
      do i = 1, 3
         if (place(i) == 0) cycle
         call read_number(field_of(line, place(i)), row(i), ok)
         if (i > 1) row(i) = scale*row(i)
         if (ok) ok = abs(row(i)) <= largest
         if (ok) cycle
         call fatal_error(error, "expected a number of at most 1e30 in column " &
            & //to_text(place(i))//", got '"//shown(field_of(line, place(i)))//"'")
         return
      end do
   end subroutine take_row

   !> Check that time goes on
   pure subroutine check_time(time, error)
      real(wp), intent(in) :: time(2)  !! Time of the row before and of this one: (2) [s]
      type(error_t), allocatable, intent(out) :: error

      if (.not. time(2) > time(1)) call fatal_error(error, "expected a time after " &
         & //to_text(time(1))//" s, got "//to_text(time(2))//"; sort the rows, each time once")
   end subroutine check_time
end module dda_read_record
