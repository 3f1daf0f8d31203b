!> A text as words separated by blanks, each with its line. Procedures that take or check words do
!> nothing after an error, so the first error is kept
module dda_word_list
   use dda_deck_token, only : shown
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_kinds, only : wp
   use dda_text, only : read_number, short_text, to_text
   implicit none
   private

   public :: word_list_t, split_words, words_left, this_word, this_row, take_number
   public :: take_property, take_whole, take_word_numbers, largest_coordinate, largest_material
   public :: quoted, check_number, warn_of_rest

   !> Largest coordinate, whose square does not overflow
   real(wp), parameter :: largest_coordinate = 1.0e15_wp
   !> Largest material number
   integer, parameter :: largest_material = 1000000

   !> Words of a text, and the position of the next one to take
   type :: word_list_t
      character(len=:), allocatable :: text  !! The text
      character(len=:), allocatable :: file  !! Name of its file
      integer :: n = 0                       !! Number of words
      integer :: next = 1                    !! Next word to take
      integer, allocatable :: start(:)       !! First character of each word: (n)
      integer, allocatable :: finish(:)      !! Last character of each word: (n)
      integer, allocatable :: row(:)  !! Line of each word, and of the end of the text: (n + 1)
   end type word_list_t

contains

   !> Part of a file prepared for a message
   pure function quoted(text) result(piece)
      character(len=*), intent(in) :: text    !! Text of the part
      character(len=:), allocatable :: piece  !! Short, printable, in quotes

      piece = "'"//shown(text)//"'"
   end function quoted

   !> Find the words of a text
   pure subroutine split_words(text, file, first_row, words, also_blank)
      character(len=*), intent(in) :: text  !! The text; its lines end in line feeds
      character(len=*), intent(in) :: file  !! Name of its file, for messages
      integer, intent(in) :: first_row      !! Line of the file where the text begins
      type(word_list_t), intent(out) :: words
      !> Separators of words besides blanks, tabs and line ends
      character(len=*), intent(in), optional :: also_blank
      character(len=1), parameter :: lf = achar(10)
      integer :: i, row, pass
      logical :: blank, was_blank

      words%text = text
      words%file = file
      do pass = 1, 2
         words%n = 0
         row = first_row
         was_blank = .true.
         do i = 1, len(text)
            blank = text(i:i) == " " .or. text(i:i) == achar(9) .or. text(i:i) == lf
            if (present(also_blank)) blank = blank .or. scan(text(i:i), also_blank) > 0
            if (was_blank .and. .not. blank) then
               words%n = words%n + 1
               if (pass == 2) words%start(words%n) = i
               if (pass == 2) words%row(words%n) = row
            end if
            if (pass == 2 .and. .not. blank) words%finish(words%n) = i
            if (text(i:i) == lf) row = row + 1
            was_blank = blank
         end do
         if (pass == 1) &
            & allocate (words%start(words%n), words%finish(words%n), words%row(words%n + 1))
      end do
      words%row(words%n + 1) = row
      if (len(text) > 1) then
         if (text(len(text):) == lf) words%row(words%n + 1) = row - 1
      end if
   end subroutine split_words

   !> Number of words not yet taken
   pure integer function words_left(words)
      type(word_list_t), intent(in) :: words

      words_left = words%n - words%next + 1
   end function words_left

   !> The next word, without taking it
   pure function this_word(words) result(word)
      type(word_list_t), intent(in) :: words
      character(len=:), allocatable :: word  !! The word; empty at the end

      word = ""
      if (words%next <= words%n) word = words%text(words%start(words%next):words%finish(words%next))
   end function this_word

   !> Line of the next word, or of the end of the text
   pure integer function this_row(words)
      type(word_list_t), intent(in) :: words

      this_row = words%row(min(words%next, words%n + 1))
   end function this_row

   !> Take a word as a number
   pure subroutine take_number(words, what, value, error)
      type(word_list_t), intent(inout) :: words
      character(len=*), intent(in) :: what  !! Meaning of the number, for the message
      real(wp), intent(out) :: value        !! The number
      !> An earlier error; else set at the end of the text or for a word that is no number
      type(error_t), allocatable, intent(inout) :: error
      logical :: ok

      value = 0.0_wp
      if (allocated(error)) return
      if (words%next > words%n) call fatal_error(error, "expected "//what &
         & //", got the end of the text; add it", words%file, this_row(words))
      if (allocated(error)) return
      call read_number(words%text(words%start(words%next):words%finish(words%next)), value, ok)
      if (.not. ok) call fatal_error(error, "expected "//what//", got " &
         & //quoted(this_word(words))//"; write a number, with a point for decimals", words%file, &
         & this_row(words))
      words%next = words%next + 1
   end subroutine take_number

   !> Take several numbers, each within a bound
   pure subroutine take_word_numbers(words, what, bound, value, error)
      type(word_list_t), intent(inout) :: words
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: bound      !! Largest magnitude
      real(wp), intent(out) :: value(:)  !! The numbers: (n)
      !> An earlier error; else set for the first invalid number
      type(error_t), allocatable, intent(inout) :: error
      integer :: i, row

      value = 0.0_wp
      do i = 1, size(value)
         row = this_row(words)
         call take_number(words, what, value(i), error)
         if (allocated(error)) return
         if (abs(value(i)) <= bound) cycle
         call fatal_error(error, "expected "//what//" of at most "//short_text(bound)//" in " &
            & //"magnitude, got "//short_text(value(i))//"; correct it or change the unit", &
            & words%file, row)
         return
      end do
   end subroutine take_word_numbers

   !> Take a number from 0 to 1e30
   pure subroutine take_property(words, what, value, error)
      type(word_list_t), intent(inout) :: words
      character(len=*), intent(in) :: what
      real(wp), intent(out) :: value
      type(error_t), allocatable, intent(inout) :: error  !! An earlier error or an invalid number
      real(wp), parameter :: most = 1.0e30_wp
      integer :: row

      row = this_row(words)
      call take_number(words, what, value, error)
      if (.not. allocated(error) .and. .not. (value >= 0.0_wp .and. value <= most)) &
         & call fatal_error(error, "expected "//what//" from 0 to 1e30, got "//short_text(value) &
         & //"; correct it", words%file, row)
   end subroutine take_property

   !> Take an integer within bounds; 3.0 is accepted
   pure subroutine take_whole(words, what, low, high, value, error)
      type(word_list_t), intent(inout) :: words
      character(len=*), intent(in) :: what
      integer, intent(in) :: low     !! Smallest value
      integer, intent(in) :: high    !! Largest value
      integer, intent(out) :: value  !! The number
      !> An earlier error; else set for an invalid number or the end of the text
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: number
      integer :: row

      value = low
      row = this_row(words)
      call take_number(words, what, number, error)
      if (allocated(error)) return
      if (number >= real(low, wp) .and. number <= real(high, wp) &
         & .and. abs(number - aint(number)) <= 0.0_wp) then
         value = nint(number)
      else
         call fatal_error(error, "expected "//what//" as a whole number from "//to_text(low) &
            & //" to "//to_text(high)//", got "//short_text(number)//"; correct it", words%file, &
            & row)
      end if
   end subroutine take_whole

   !> Report a number that violates a rule
   pure subroutine check_number(fits, rule, value, file, row, error)
      logical, intent(in) :: fits           !! True if the rule holds
      character(len=*), intent(in) :: rule  !! The rule, such as: the unit mass must be above 0
      real(wp), intent(in) :: value
      character(len=*), intent(in) :: file
      integer, intent(in) :: row            !! Line of the file
      type(error_t), allocatable, intent(inout) :: error

      if (fits .or. allocated(error)) return
      call fatal_error(error, rule//", got "//short_text(value)//"; correct it", file, row)
   end subroutine check_number

   !> Warn of words that were not taken
   pure subroutine warn_of_rest(words, taken, warnings)
      type(word_list_t), intent(in) :: words
      character(len=*), intent(in) :: taken  !! Description of the words before them
      type(warnings_t), intent(inout) :: warnings

      if (words_left(words) > 0) call add_warning(warnings, "trailing text ignored after the " &
         & //taken//": "//quoted(this_word(words)), words%file, this_row(words))
   end subroutine warn_of_rest
end module dda_word_list
