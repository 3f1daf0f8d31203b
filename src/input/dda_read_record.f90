!> Records of motion: columns of numbers after a header
module dda_read_record
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error, place_error
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_table_file, only : field_ends, n_fields
   use dda_text, only : lower_case, read_integer, read_number, to_text
   use dda_text_file, only : read_text_file, text_mark
   implicit none
   private

   public :: read_record, parse_record, column_of, column_size, separator_of, field_of, find_line
   public :: n_columns

   !> Maximum length of a column name [characters]
   integer, parameter :: column_size = 80
   !> Maximum number of columns of a record
   integer, parameter :: most_columns = 10000
   !> Largest magnitude of a number
   real(wp), parameter :: largest = 1.0e30_wp
   !> First characters of comment lines
   character(len=*), parameter :: comment = "#!%"

contains

   !> Read a record
   subroutine read_record(file, column, scale, row, mark, error)
      character(len=*), intent(in) :: file  !! Name of the file
      !> Columns of time, x and y: numbers from 1, 0 for none, or names in the header: (3)
      character(len=*), intent(in) :: column(3)
      real(wp), intent(in) :: scale                       !! Factor of the two components
      real(wp), allocatable, intent(out) :: row(:, :)     !! Time and components: (3, n)
      character(len=:), allocatable, intent(out) :: mark  !! Length and checksum of the file
      !> Allocated for bad input, with file and line; without a line if the file cannot be read
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      mark = ""
      call read_text_file(file, text, error)
      if (allocated(error)) return
      call parse_record(text, column, scale, row, error)
      if (allocated(error)) error%file = file
      mark = text_mark(text)
   end subroutine read_record

   !> Read a record from a text. Lines before the first that begins with a number are its header
   pure subroutine parse_record(text, column, scale, row, error)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: column(3)
      real(wp), intent(in) :: scale
      real(wp), allocatable, intent(out) :: row(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer :: place(3), start, first, last, number, n, header(2), header_line

      allocate (row(3, 64))
      header = [1, 0]
      header_line = 0
      n = 0
      number = 0
      start = 1
      do while (start <= len(text))
         call find_line(text, start, first, last, number)
         associate (line => text(first:last))
            if (is_blank(line)) then
               continue
            else if (n == 0 .and. .not. begins_with_number(line)) then
               header = [first, last]
               header_line = number
            else
               if (n == 0) call find_columns(text(header(1):header(2)), column, place, error)
               if (allocated(error)) then
                  ! names are missing in the header, not in the first row
                  if (header_line > 0) number = header_line
                  exit
               end if
               call make_room(row, n + 1)
               n = n + 1
               call take_row(line, place, scale, row(:, n), error)
               if (.not. allocated(error) .and. n > 1) call check_time(row(1, n - 1:n), error)
               if (allocated(error)) exit
            end if
         end associate
      end do
      row = row(:, :n)
      if (n < 2 .and. .not. allocated(error)) call fatal_error(error, "expected at least two " &
         & //"rows of numbers, separated by semicolons, commas or blanks, with a point for " &
         & //"decimals, got "//to_text(n)//last_row(text, header, n))
      call place_error(error, max(1, number))
   end subroutine parse_record

   !> Find the next line of a text, and go on behind it
   pure subroutine find_line(text, start, first, last, number)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: start   !! Where the line begins in, where the next one begins out
      integer, intent(out) :: first     !! First character of the line
      integer, intent(out) :: last      !! Last character, without the line feed
      integer, intent(inout) :: number  !! Number of the line before in, of this line out

      first = start
      last = start + index(text(start:), achar(10)) - 2
      if (last < first - 1) last = len(text)
      start = last + 2
      number = number + 1
   end subroutine find_line

   !> Words about the last line of the header, if the file has nothing else
   pure function last_row(text, header, n) result(words)
      character(len=*), intent(in) :: text
      integer, intent(in) :: header(2)  !! First and last character of the header's last line: (2)
      integer, intent(in) :: n          !! Number of rows
      character(len=:), allocatable :: words

      words = ""
      if (n == 0 .and. header(2) >= header(1)) &
         & words = "; the last line is '"//shown(text(header(1):header(2)))//"'"
   end function last_row

   !> True if a line is blank or a comment
   pure logical function is_blank(line)
      character(len=*), intent(in) :: line  !! The line
      integer :: first

      first = verify(line, " "//achar(9))
      is_blank = first == 0
      if (.not. is_blank) is_blank = scan(line(first:first), comment) > 0
   end function is_blank

   !> True if the first field of a line is a number
   pure logical function begins_with_number(line)
      character(len=*), intent(in) :: line
      real(wp) :: value

      call read_number(field_of(line, 1, separator_of(line)), value, begins_with_number)
   end function begins_with_number

   !> Separator of the fields of a line: a semicolon, else a comma, outside double quotes, else
   !> blanks
   pure character function separator_of(line)
      character(len=*), intent(in) :: line
      logical :: quoted
      integer :: i

      separator_of = " "
      quoted = .false.
      do i = 1, len(line)
         if (line(i:i) == """") quoted = .not. quoted
         if (quoted .or. scan(line(i:i), ";,") == 0) cycle
         separator_of = line(i:i)
         if (separator_of == ";") return
      end do
   end function separator_of

   !> One field of a line
   pure function field_of(line, number, separator) result(text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number       !! Number of the field, from 1
      character, intent(in) :: separator  !! Semicolon, comma or tab; a blank for blanks and tabs
      !> The field without surrounding blanks and double quotes; empty if there is none
      character(len=:), allocatable :: text
      character(len=2), parameter :: blanks = " "//achar(9)
      integer :: ends(2)

      if (separator == " ") then
         ends = word_ends(line, number)
      else
         ends = field_ends(line, number, separator)
      end if
      text = line(ends(1):ends(2))
      text = text(max(1, verify(text, blanks//"""")):verify(text, blanks//"""", back=.true.))
   end function field_of

   !> First and last character of a word between blanks; the last precedes the first if there is
   !> none
   pure function word_ends(line, number) result(ends)
      character(len=*), intent(in) :: line
      integer, intent(in) :: number
      integer :: ends(2)
      character(len=2), parameter :: blanks = " "//achar(9)
      integer :: k

      ends = 0
      do k = 1, number
         ends(1) = ends(2) + verify(line(ends(2) + 1:)//"|", blanks)
         if (ends(1) > len(line)) then
            ends = [1, 0]
            return
         end if
         ends(2) = ends(1) + scan(line(ends(1):)//" ", blanks) - 2
      end do
   end function word_ends

   !> Find the columns; names are searched in the last line of the header
   pure subroutine find_columns(header, column, place, error)
      character(len=*), intent(in) :: header  !! Last line of the header; empty if there is none
      character(len=*), intent(in) :: column(3)
      integer, intent(out) :: place(3)        !! Numbers of the columns, 0 for none: (3)
      type(error_t), allocatable, intent(out) :: error
      character :: separator
      integer :: i
      logical :: ok

      separator = separator_of(header)
      ! names may contain blanks if numbers are separated by tabs
      if (separator == " " .and. index(trim(header), achar(9)) > 0) separator = achar(9)
      do i = 1, 3
         call read_integer(trim(column(i)), place(i), ok)
         if (ok) ok = place(i) >= merge(1, 0, i == 1) .and. place(i) <= most_columns
         if (ok) cycle
         place(i) = column_of(header, column(i), separator)
         if (place(i) > 0) cycle
         call fatal_error(error, "expected column '"//shown(trim(column(i)))//"', a number from " &
            & //"1 to "//to_text(most_columns)//" or a name in the header, got " &
            & //names_of(header, separator)//"; name another")
         return
      end do
   end subroutine find_columns

   !> Number of a column; 0 if there is none
   pure integer function column_of(header, name, separator) result(column)
      character(len=*), intent(in) :: header
      character(len=*), intent(in) :: name    !! Name of the column, in any case
      character, intent(in) :: separator

      do column = n_columns(header, separator), 1, -1
         if (lower_case(field_of(header, column, separator)) == lower_case(name)) return
      end do
   end function column_of

   !> Names in a header for a message; of many the first
   pure function names_of(header, separator) result(words)
      character(len=*), intent(in) :: header
      character, intent(in) :: separator
      character(len=:), allocatable :: words  !! Names in quotes, or "none"
      integer, parameter :: most = 8
      integer :: k, n

      n = n_columns(header, separator)
      if (len_trim(header) == 0) n = 0
      words = "none"
      do k = 1, min(n, most)
         if (k == 1) words = ""
         if (k > 1) words = words//", "
         words = words//"'"//shown(field_of(header, k, separator))//"'"
      end do
      if (n > most) words = words//" and others"
   end function names_of

   !> Number of fields of a line
   pure integer function n_columns(line, separator)
      character(len=*), intent(in) :: line
      character, intent(in) :: separator

      n_columns = n_fields(line, separator)
      if (separator /= " ") return
      n_columns = 0
      do while (field_of(line, n_columns + 1, separator) /= "")
         n_columns = n_columns + 1
      end do
   end function n_columns

   !> Read the numbers of a row
   pure subroutine take_row(line, place, scale, row, error)
      character(len=*), intent(in) :: line
      integer, intent(in) :: place(3)  !! Columns of time, x and y; 0 for none: (3)
      real(wp), intent(in) :: scale
      real(wp), intent(out) :: row(3)  !! Time and components: (3)
      type(error_t), allocatable, intent(out) :: error
      character :: separator
      integer :: i
      logical :: ok

      row = 0.0_wp
      separator = separator_of(line)
      do i = 1, 3
         if (place(i) == 0) cycle
         call read_number(field_of(line, place(i), separator), row(i), ok)
         if (i > 1) row(i) = scale*row(i)
         if (ok) ok = abs(row(i)) <= largest
         if (ok) cycle
         call fatal_error(error, "expected a number of at most 1e30 in column " &
            & //to_text(place(i))//", got '"//shown(field_of(line, place(i), separator))//"'" &
            & //comma_hint(field_of(line, place(i), separator)))
         return
      end do
   end subroutine take_row

   !> Hint for a number with a decimal comma; empty for others
   pure function comma_hint(field) result(words)
      character(len=*), intent(in) :: field   !! Field of a line
      character(len=:), allocatable :: words  !! The hint, in parentheses

      words = ""
      if (index(field, ",") > 0 .and. verify(field, "0123456789,+-eE ") == 0) &
         & words = " (decimals are written with a point)"
   end function comma_hint

   !> Check that time increases
   pure subroutine check_time(time, error)
      real(wp), intent(in) :: time(2)  !! Time of the previous row and of this one: (2) [s]
      type(error_t), allocatable, intent(out) :: error

      if (.not. time(2) > time(1)) call fatal_error(error, "expected a time after " &
         & //to_text(time(1))//" s, got "//to_text(time(2))//"; write one row per time, sorted")
   end subroutine check_time
end module dda_read_record
