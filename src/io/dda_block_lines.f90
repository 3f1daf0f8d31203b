!> Lines of a file of blocks as words, and the words' numbers
module dda_block_lines
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_number, to_text
   implicit none
   private

   public :: entry_t, line_t, split_line, take_keys, take_numbers, word_size, largest_number
   public :: keep_entry, take_entry, waiting_entry_t

   !> Longest word of a line [characters]
   integer, parameter :: word_size = 32
   !> Most words of a line
   integer, parameter :: max_words = 40
   !> One line as words
   type :: line_t
      !> Number of the line
      integer :: number = 0
      !> Number of words
      integer :: n = 0
      !> The words
      character(len=word_size) :: word(max_words) = ""
   end type line_t

   !> The entry that is being read
   type :: entry_t
      !> Its first line
      type(line_t) :: head
      !> Rows of numbers below it: (3, n_row or more)
      real(wp), allocatable :: row(:, :)
      !> Number of rows
      integer :: n_row = 0
      !> Numbers of each row
      integer :: n_column = 0
   end type entry_t

   !> An entry that waits, in as much room as it needs
   type :: waiting_entry_t
      !> Number of its first line
      integer :: number = 0
      !> Numbers of each row
      integer :: n_column = 0
      !> Words of its first line: (n)
      character(len=word_size), allocatable :: word(:)
      !> Rows of numbers below it: (3, n_row)
      real(wp), allocatable :: row(:, :)
   end type waiting_entry_t

   !> Largest magnitude of a number, so that neither its square nor what is made of it overflows
   real(wp), parameter :: largest_number = 1.0e30_wp

contains

   !> Put an entry behind those that wait
   pure subroutine keep_entry(entry, later, n)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> Entries that wait: (n or more)
      type(waiting_entry_t), allocatable, intent(inout) :: later(:)
      !> Their number
      integer, intent(inout) :: n
      type(waiting_entry_t), allocatable :: longer(:)
      integer :: i

      if (n == size(later)) then
         allocate (longer(2*n + 8))
         do i = 1, n
            longer(i)%number = later(i)%number
            longer(i)%n_column = later(i)%n_column
            call move_alloc(later(i)%word, longer(i)%word)
            call move_alloc(later(i)%row, longer(i)%row)
         end do
         call move_alloc(longer, later)
      end if
      n = n + 1
      later(n)%number = entry%head%number
      later(n)%n_column = entry%n_column
      allocate (later(n)%word, source=entry%head%word(:entry%head%n))
      allocate (later(n)%row, source=entry%row(:, :entry%n_row))
   end subroutine keep_entry

   !> An entry that has waited as it was
   pure subroutine take_entry(waiting, entry)
      !> The entry that has waited; its rows go
      type(waiting_entry_t), intent(inout) :: waiting
      !> The entry
      type(entry_t), intent(out) :: entry

      entry%head%number = waiting%number
      entry%head%n = size(waiting%word)
      entry%head%word(:entry%head%n) = waiting%word
      entry%n_column = waiting%n_column
      entry%n_row = size(waiting%row, 2)
      call move_alloc(waiting%row, entry%row)
   end subroutine take_entry

   !> Part a line into words; what follows a ! is a comment
   pure subroutine split_line(text, number, line, error)
      !> The line
      character(len=*), intent(in) :: text
      !> Its number
      integer, intent(in) :: number
      !> The words
      type(line_t), intent(out) :: line
      !> Too many or too long words
      type(error_t), allocatable, intent(out) :: error
      integer :: i, last, first

      line%number = number
      last = index(text//"!", "!") - 1
      first = 0
      do i = 1, last + 1
         if (i <= last) then
            if (index(" "//achar(9), text(i:i)) == 0) then
               if (first == 0) first = i
               cycle
            end if
         end if
         if (first == 0) cycle
         if (line%n == max_words .or. i - first > word_size) then
            call fatal_error(error, "wanted at most "//to_text(max_words)//" words of " &
               & //to_text(word_size)//" characters, found more", line=number)
            return
         end if
         line%n = line%n + 1
         line%word(line%n) = lower_case(text(first:i - 1))
         first = 0
      end do
   end subroutine split_line

   !> Read the numbers behind a word
   pure subroutine take_numbers(line, i, number, error)
      !> The line
      type(line_t), intent(in) :: line
      !> Place of the word; then the place after the numbers
      integer, intent(inout) :: i
      !> The numbers: (n)
      real(wp), intent(inout) :: number(:)
      !> Anything else
      type(error_t), allocatable, intent(out) :: error
      logical :: ok
      integer :: k

      do k = 1, size(number)
         ok = i + k <= line%n
         if (ok) call read_number(trim(line%word(i + k)), number(k), ok)
         if (.not. ok) then
            call fatal_error(error, "wanted "//to_text(size(number))//" numbers after '" &
               & //shown(trim(line%word(i)))//"'", line=line%number)
         else if (abs(number(k)) > largest_number) then
            call fatal_error(error, "expected numbers of at most 1e30 in magnitude after '" &
               & //shown(trim(line%word(i)))//"', got "//to_text(number(k)) &
               & //"; correct them or change the unit", line=line%number)
         end if
         if (allocated(error)) return
      end do
      i = i + size(number) + 1
   end subroutine take_numbers

   !> Read words with a number each
   pure subroutine take_keys(line, first, key, value, given, error)
      !> The line
      type(line_t), intent(in) :: line
      !> Place of the first word
      integer, intent(in) :: first
      !> Words that may come: (n)
      character(len=*), intent(in) :: key(:)
      !> Their numbers: (n)
      real(wp), intent(inout) :: value(:)
      !> Which came: (n)
      logical, intent(inout) :: given(:)
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      integer :: i, k

      i = first
      do while (i <= line%n .and. .not. allocated(error))
         k = findloc(key == line%word(i), .true., dim=1)
         if (k == 0) then
            call fatal_error(error, "unknown word '"//shown(trim(line%word(i)))//"'", &
               & line=line%number)
         else if (given(k)) then
            call fatal_error(error, trim(key(k))//" is given twice", line=line%number)
         else
            given(k) = .true.
            call take_numbers(line, i, value(k:k), error)
         end if
      end do
   end subroutine take_keys
end module dda_block_lines
