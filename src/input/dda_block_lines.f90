!> Lines of a file of blocks as words and numbers, or a record: WORD ... file 'NAME' [columns T X
!> [Y]] [scale S]
module dda_block_lines
   use dda_deck_key, only : in_range, key_kind, key_t, wanted
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_read_record, only : read_record
   use dda_text, only : lower_case, read_number, short_text, to_text
   implicit none
   private

   public :: entry_t, line_t, split_line, take_numbers, take_words, largest_number, keep_entry
   public :: listed, take_record

   !> Maximum length of a word [characters]
   integer, parameter :: word_size = 32
   !> Maximum number of words per line
   integer, parameter :: max_words = 40
   !> One line as words
   type :: line_t
      integer :: number = 0  !! Number of the line
      integer :: n = 0       !! Number of words
      !> The words; a quoted text is replaced by a quote; padded to three words with
      !> blanks: (n or more)
      character(len=word_size), allocatable :: word(:)
      !> The quoted text, unchanged; unallocated if there is none
      character(len=:), allocatable :: quoted
   end type line_t

   !> An entry: a line, and the rows of numbers after it
   type :: entry_t
      type(line_t) :: head                !! First line
      real(wp), allocatable :: row(:, :)  !! Rows of numbers: (3, n_row or more)
      integer :: n_row = 0                !! Number of rows
      integer :: n_column = 0             !! Number of numbers per row
   end type entry_t

   !> Largest magnitude of a number, whose square does not overflow
   real(wp), parameter :: largest_number = 1.0e30_wp

contains

   !> Append an entry to a list, without spare memory
   pure subroutine keep_entry(entry, list, n)
      type(entry_t), intent(in) :: entry
      type(entry_t), allocatable, intent(inout) :: list(:)  !! The list: (n or more)
      integer, intent(inout) :: n                           !! Number of entries
      type(entry_t), allocatable :: longer(:)

      if (n == size(list)) then
         allocate (longer(2*n + 8))
         longer(:n) = list
         call move_alloc(longer, list)
      end if
      n = n + 1
      list(n)%head = entry%head
      list(n)%n_row = entry%n_row
      list(n)%n_column = entry%n_column
      list(n)%row = entry%row(:, :entry%n_row)
   end subroutine keep_entry

   !> Split a line into words; a comment starts at !. One text and names of columns may be quoted
   pure subroutine split_line(text, number, line, error)
      character(len=*), intent(in) :: text  !! The line
      integer, intent(in) :: number         !! Number of the line
      type(line_t), intent(out) :: line
      !> Allocated for too many or too long words, or a quote without end
      type(error_t), allocatable, intent(out) :: error
      character(len=word_size) :: word(max_words)
      integer :: first, last, next

      line%number = number
      next = 1
      word(:3) = ""
      do
         first = next
         do while (first <= len(text))
            if (index(" "//achar(9), text(first:first)) == 0) exit
            first = first + 1
         end do
         if (first > len(text)) exit
         if (text(first:first) == "!") exit
         last = first
         if (scan(text(first:first), "'""") == 0) then
            next = first + scan(text(first:)//"!", " "//achar(9)//"!") - 1
            last = next - 1
         else if (any(word(:line%n) == "columns")) then
            call find_quote(text, first, next, error)
            first = first + 1
            last = next - 2
         else
            call take_quoted(text, first, next, line, error)
         end if
         if (last - first >= word_size .or. line%n == max_words) call fatal_error(error, too_much())
         if (allocated(error)) return
         line%n = line%n + 1
         word(line%n) = lower_case(text(first:last))
         if (word(line%n) == """") word(line%n) = "'"
      end do
      line%word = word(:max(line%n, 3))

   contains

      !> Message about too many or too long words
      pure function too_much() result(message)
         character(len=:), allocatable :: message

         message = "expected at most "//to_text(max_words)//" words of "//to_text(word_size) &
            & //" characters, got more"
      end function too_much
   end subroutine split_line

   !> Find the closing quote of a text
   pure subroutine find_quote(text, first, next, error)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first  !! Position of the opening quote
      integer, intent(out) :: next  !! Position after the closing quote
      type(error_t), allocatable, intent(out) :: error
      integer :: length

      length = index(text(first + 1:), text(first:first)) - 1
      next = first + length + 2
      if (length < 0) call fatal_error(error, "expected a second quote, got none; close the text")
   end subroutine find_quote

   !> Read a quoted text
   pure subroutine take_quoted(text, first, next, line, error)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first  !! Position of the opening quote
      integer, intent(out) :: next  !! Position after the closing quote
      type(line_t), intent(inout) :: line
      type(error_t), allocatable, intent(out) :: error

      call find_quote(text, first, next, error)
      if (allocated(error)) then
         return
      else if (allocated(line%quoted)) then
         call fatal_error(error, "expected one text in quotes, got two; remove one")
      else
         line%quoted = text(first + 1:next - 2)
      end if
   end subroutine take_quoted

   !> Read the numbers after a word
   pure subroutine take_numbers(line, i, number, error)
      type(line_t), intent(in) :: line
      integer, intent(inout) :: i                       !! Index of the word; moved past the numbers
      real(wp), intent(inout) :: number(:)              !! The numbers: (n)
      type(error_t), allocatable, intent(out) :: error  !! Allocated if there are other words
      logical :: ok
      integer :: k

      do k = 1, size(number)
         ok = i + k <= line%n
         if (ok) call read_number(trim(line%word(i + k)), number(k), ok)
         if (.not. ok) then
            call fatal_error(error, "expected "//to_text(size(number))//" numbers after '" &
               & //shown(trim(line%word(i)))//"'")
         else if (abs(number(k)) > largest_number) then
            call fatal_error(error, "expected numbers of at most 1e30 in magnitude after '" &
               & //shown(trim(line%word(i)))//"', got "//short_text(number(k)) &
               & //"; correct them or change the unit")
         end if
         if (allocated(error)) return
      end do
      i = i + size(number) + 1
   end subroutine take_numbers

   !> Read optional words in any order, each at most once, with their numbers: one for a number,
   !> three for a list, none for a flag
   pure subroutine take_words(line, first, key, value, given, error)
      type(line_t), intent(in) :: line
      integer, intent(in) :: first         !! Index of the first word
      type(key_t), intent(in) :: key(:)    !! Allowed words and their kinds of numbers: (n)
      real(wp), intent(inout) :: value(:)  !! Numbers of all words: (total number of numbers)
      logical, intent(out) :: given(:)     !! True for words that are present: (n)
      !> Allocated for an unknown or repeated word, or a number out of range
      type(error_t), allocatable, intent(out) :: error
      integer :: i, k, width(size(key))

      width = 1
      where (key%kind == key_kind%numbers) width = 3
      where (key%kind == key_kind%flag) width = 0
      given = .false.
      i = first
      do while (i <= line%n)
         k = findloc(key%name == line%word(i), .true., dim=1)
         if (k == 0) then
            call fatal_error(error, "expected "//listed(key%name)//", got '" &
               & //shown(trim(line%word(i)))//"'")
            return
         else if (given(k)) then
            call fatal_error(error, trim(key(k)%name)//" is given twice")
            return
         end if
         given(k) = .true.
         associate (own => value(sum(width(:k - 1)) + 1:sum(width(:k))))
            call take_numbers(line, i, own, error)
            if (allocated(error)) return
            if (all(in_range(key(k), own))) cycle
            call fatal_error(error, trim(key(k)%name)//" must be "//wanted(key(k))//", got " &
               & //short_text(own(1)))
            return
         end associate
      end do
   end subroutine take_words

   !> Words as a list: a, b or c
   pure function listed(word) result(text)
      character(len=*), intent(in) :: word(:)  !! The words: (n)
      character(len=:), allocatable :: text
      integer :: k

      text = trim(word(1))
      do k = 2, size(word)
         text = text//trim(merge(" or", ",  ", k == size(word)))//" "//trim(word(k))
      end do
   end function listed

   !> Read the record named in an entry into its rows, and remove the words; other entries are
   !> unchanged
   subroutine take_record(entry, file, marks, error)
      type(entry_t), intent(inout) :: entry
      !> Name of the file of blocks; the record is in the same folder
      character(len=*), intent(in) :: file
      !> Receives the length and the checksum of the record
      character(len=:), allocatable, intent(inout) :: marks
      !> Allocated if the words or the record are invalid
      type(error_t), allocatable, intent(out) :: error
      character(len=word_size) :: column(3)
      character(len=:), allocatable :: message, mark, name
      real(wp) :: scale
      integer :: i

      i = findloc(entry%head%word(:entry%head%n) == "file", .true., dim=1)
      if (i == 0) return
      call take_columns(entry, i, column, scale, error)
      if (allocated(error)) return
      name = entry%head%quoted
      if (index(name, "/") /= 1) name = file(:index(file, "/", back=.true.))//name
      deallocate (entry%row)
      call read_record(name, column, scale, entry%row, mark, error)
      if (allocated(error)) then
         if (error%line > 0) return
         message = "record '"//shown(entry%head%quoted)//"': "//error%message
         call fatal_error(error, message)
         return
      end if
      entry%n_row = size(entry%row, 2)
      entry%head%n = i - 1
      if (.not. allocated(marks)) marks = ""
      marks = marks//" "//mark
   end subroutine take_record

   !> Read the words from 'file' on
   pure subroutine take_columns(entry, first, column, scale, error)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: first                        !! Index of that word
      character(len=word_size), intent(out) :: column(3)  !! Columns of time, x and y: (3)
      real(wp), intent(out) :: scale                      !! Factor of the components
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: number(1)
      integer :: i, n
      logical :: has_columns, has_scale

      column = [character(len=word_size) :: "1", "2", "0"]
      scale = 1.0_wp
      has_columns = .false.
      has_scale = .false.
      i = first + 2
      associate (head => entry%head)
         if (entry%n_column /= 3) then
            call fatal_error(error, "unknown word 'file'")
         else if (head%word(min(first + 1, size(head%word))) /= "'") then
            call fatal_error(error, "expected the name of a record in quotes after 'file', got " &
               & //"none; write it as in file 'quake.csv'")
         else if (entry%n_row > 0) then
            call fatal_error(error, "expected a record or rows of time and components, got both; " &
               & //"remove one of them")
         end if
         do while (i <= head%n .and. .not. allocated(error))
            if (head%word(i) == "columns" .and. .not. has_columns) then
               has_columns = .true.
               n = findloc(head%word(i + 1:head%n) == "scale", .true., dim=1) - 1
               if (n < 0) n = head%n - i
               if (n < 2 .or. n > 3) call fatal_error(error, &
                  & "expected two or three columns, of time, x and y, " &
                  & //"after 'columns'; 0 stands for none")
               if (allocated(error)) return
               column(:n) = head%word(i + 1:i + n)
               i = i + n + 1
            else if (head%word(i) == "scale" .and. .not. has_scale) then
               has_scale = .true.
               call take_numbers(head, i, number, error)
               scale = number(1)
            else
               call fatal_error(error, "expected columns or scale, once each, got '" &
                  & //shown(trim(head%word(i)))//"'")
            end if
         end do
      end associate
   end subroutine take_columns

end module dda_block_lines
