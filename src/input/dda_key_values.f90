!> Values of keys: their defaults, and those that tokens of a namelist file stand for
module dda_key_values
   use dda_deck_key, only : in_range, key_kind, key_t, max_items, word_length
   use dda_deck_keys, only : key_index
   use dda_deck_token, only : deck_scan_t, shown, token_kind, token_text
   use dda_deck_words, only : full_name, near_word, wanted
   use dda_input, only : input_value_t
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, read_number, to_text
   implicit none
   private

   public :: default_value, is_numeric, number_problem, read_flag, take_values, text_problem

contains

   !> Value of a key that is not given
   pure function default_value(key) result(value)
      type(key_t), intent(in) :: key
      type(input_value_t) :: value
      logical :: ok

      select case (key%kind)
      case (key_kind%number, key_kind%whole)
         call read_number(trim(key%default), value%number, ok)
      case (key_kind%word, key_kind%text)
         value%text = key%default(2:max(1, len_trim(key%default) - 1))
      case (key_kind%flag)
         value%flag = key%default == ".true."
      case (key_kind%numbers)
         allocate (value%numbers(0))
      case (key_kind%texts)
         allocate (value%texts(0))
      end select
   end function default_value

   !> Take the values of a key from tokens
   pure subroutine take_values(scan, first, last, key, single, value, at, problem)
      type(deck_scan_t), intent(in) :: scan
      !> First token of the values
      integer, intent(in) :: first
      !> Last token; one before the first if there are none
      integer, intent(in) :: last
      type(key_t), intent(in) :: key
      !> Whether only one item of a list is set
      logical, intent(in) :: single
      !> The value; flags and words have their text too
      type(input_value_t), intent(inout) :: value
      !> The token that is none of the key's
      integer, intent(out) :: at
      !> What was wanted and what was found; empty if all is well
      character(len=:), allocatable, intent(out) :: problem

      call find_fault(scan, first, last, key, single, at, problem)
      if (len(problem) > 0) return
      select case (key%kind)
      case (key_kind%numbers)
         value%numbers = all_numbers(scan, first, last)
      case (key_kind%number, key_kind%whole)
         value%number = number_at(scan, first)
      case (key_kind%texts)
         value%texts = all_texts(scan, first, last)
      case default
         value%text = token_text(scan, first)
         problem = text_problem(key, value%text)
         if (key%kind == key_kind%flag) call read_flag(value%text, value%flag)
      end select
   end subroutine take_values

   !> Find a value that is not of a key's kind, or too many
   pure subroutine find_fault(scan, first, last, key, single, at, problem)
      type(deck_scan_t), intent(in) :: scan
      !> First token of the values
      integer, intent(in) :: first
      !> Last token; one before the first if there are none
      integer, intent(in) :: last
      type(key_t), intent(in) :: key
      !> Whether only one item of a list is set
      logical, intent(in) :: single
      !> The token that is none of the key's
      integer, intent(out) :: at
      !> What was wanted and what was found; empty if all is well
      character(len=:), allocatable, intent(out) :: problem
      logical :: takes_list
      integer :: n

      takes_list = .not. single .and. (key%kind == key_kind%numbers .or. key%kind == key_kind%texts)
      n = nint(min(sum(real(scan%token(first:last)%count, wp)), 1.0e9_wp))
      at = first
      problem = ""
      if (n == 0) then
         problem = "nothing"
      else if (.not. takes_list .and. n > 1) then
         at = min(first + 1, last)
         problem = to_text(n)//" values"
         if (at > first) problem = problem//hint(scan, at, key%group)
      else if (takes_list .and. n > max_items) then
         problem = to_text(n)//" values (the most is "//to_text(max_items)//")"
      else
         do at = first, last
            problem = mismatch(scan, at, key)
            if (len(problem) > 0) exit
         end do
      end if
      if (len(problem) > 0) problem = full_name(key)//" must be "//wanted(key)//", got "//problem
   end subroutine find_fault

   !> What a token is instead of a value of a key
   pure function mismatch(scan, i, key) result(found)
      type(deck_scan_t), intent(in) :: scan
      !> Place of the token
      integer, intent(in) :: i
      type(key_t), intent(in) :: key
      !> What was found; empty if the token will do
      character(len=:), allocatable :: found
      logical :: fits, needs_quotes, is_word
      integer :: whole
      real(wp) :: number

      is_word = scan%token(i)%kind == token_kind%word
      fits = is_word
      needs_quotes = .false.
      found = shown(token_text(scan, i))
      select case (key%kind)
      case (key_kind%whole)
         if (is_word) call read_integer(token_text(scan, i), whole, fits)
      case (key_kind%number, key_kind%numbers)
         if (is_word) call read_number(token_text(scan, i), number, fits)
         if (fits) fits = in_range(key, number)
      case (key_kind%word, key_kind%text, key_kind%texts)
         fits = scan%token(i)%kind == token_kind%quoted
         needs_quotes = is_word
         if (key%kind == key_kind%texts) fits = fits .and. len(token_text(scan, i)) <= word_length
      end select
      if (scan%token(i)%kind == token_kind%quoted) found = "'"//found//"'"
      if (scan%token(i)%kind == token_kind%nothing) found = "nothing between two commas"
      if (needs_quotes) found = found//" without quotes"
      if (fits) found = ""
   end function mismatch

   !> Why there may be a second value where one was wanted
   pure function hint(scan, i, group) result(text)
      type(deck_scan_t), intent(in) :: scan
      !> Place of the second value
      integer, intent(in) :: i
      !> Name of the group
      character(len=*), intent(in) :: group
      !> A guess in parentheses; empty if there is none
      character(len=:), allocatable :: text
      character(len=:), allocatable :: name

      text = ""
      if (scan%token(i)%kind /= token_kind%word) return
      name = lower_case(token_text(scan, i))
      if (key_index(group, name) > 0) then
         text = " (is '=' missing after "//name//"?)"
      else if (verify(name, "0123456789") == 0) then
         text = " (decimals are written with a point)"
      end if
   end function hint

   !> Number that a token stands for
   pure real(wp) function number_at(scan, i)
      type(deck_scan_t), intent(in) :: scan
      !> Place of a token that is a number
      integer, intent(in) :: i
      logical :: unused

      call read_number(token_text(scan, i), number_at, unused)
   end function number_at

   !> Numbers that tokens stand for, repeat counts written out
   pure function all_numbers(scan, first, last) result(numbers)
      type(deck_scan_t), intent(in) :: scan
      !> First token
      integer, intent(in) :: first
      !> Last token
      integer, intent(in) :: last
      !> The numbers: (n)
      real(wp), allocatable :: numbers(:)
      integer :: i, n

      allocate (numbers(sum(scan%token(first:last)%count)))
      n = 0
      do i = first, last
         numbers(n + 1:n + scan%token(i)%count) = number_at(scan, i)
         n = n + scan%token(i)%count
      end do
   end function all_numbers

   !> Words that tokens stand for, repeat counts written out
   pure function all_texts(scan, first, last) result(texts)
      type(deck_scan_t), intent(in) :: scan
      !> First token
      integer, intent(in) :: first
      !> Last token
      integer, intent(in) :: last
      !> The words: (n)
      character(len=word_length), allocatable :: texts(:)
      integer :: i, n

      allocate (texts(sum(scan%token(first:last)%count)))
      n = 0
      do i = first, last
         texts(n + 1:n + scan%token(i)%count) = token_text(scan, i)
         n = n + scan%token(i)%count
      end do
   end function all_texts

   !> Why a number cannot be the value of a key
   pure function number_problem(key, value) result(problem)
      type(key_t), intent(in) :: key
      !> The number in the unit of the registry
      real(wp), intent(in) :: value
      !> What was wanted and what was found; empty if the number will do
      character(len=:), allocatable :: problem

      problem = ""
      if (.not. (is_numeric(key) .and. in_range(key, value))) problem = full_name(key) &
         & //" must be "//wanted(key)//", got "//to_text(value)
   end function number_problem

   !> Why a text cannot be the value of a key
   pure function text_problem(key, text) result(problem)
      type(key_t), intent(in) :: key
      !> The text
      character(len=*), intent(in) :: text
      !> What was wanted and what was found; empty if the text will do
      character(len=:), allocatable :: problem
      logical :: fits, flag

      fits = key%kind == key_kind%text
      if (key%kind == key_kind%word) fits = has_word(key%words, text)
      if (key%kind == key_kind%flag) call read_flag(text, flag, fits)
      problem = ""
      if (.not. fits) problem = full_name(key)//" must be "//wanted(key)//", got '" &
         & //shown(trim(text))//"'"//near_word(key, text)
   end function text_problem

   !> Whether a list of words holds a word, whatever its case
   pure logical function has_word(words, text)
      !> Words parted by one blank
      character(len=*), intent(in) :: words
      !> The word
      character(len=*), intent(in) :: text

      has_word = len_trim(text) > 0 .and. index(trim(text), " ") == 0
      if (has_word) has_word = index(" "//words//" ", " "//lower_case(trim(text))//" ") > 0
   end function has_word

   !> Read .true., .false., T, F and what is like them
   pure subroutine read_flag(text, flag, ok)
      !> The text
      character(len=*), intent(in) :: text
      !> The flag; left as it was if the text is none
      logical, intent(inout) :: flag
      !> Whether the text is a flag
      logical, intent(out), optional :: ok

      if (present(ok)) ok = .true.
      select case (lower_case(text))
      case (".true.", "true", "t", ".t.")
         flag = .true.
      case (".false.", "false", "f", ".f.")
         flag = .false.
      case default
         if (present(ok)) ok = .false.
      end select
   end subroutine read_flag

   !> Whether a key takes numbers
   pure logical function is_numeric(key)
      type(key_t), intent(in) :: key

      is_numeric = any(key%kind == [key_kind%number, key_kind%whole, key_kind%numbers])
   end function is_numeric
end module dda_key_values
