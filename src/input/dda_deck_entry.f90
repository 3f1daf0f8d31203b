!> The values of one key: tokens of the right kind and number into a deck
submodule (dda_read_deck) dda_deck_entry
   use dda_deck, only : deck_error
   use dda_deck_key, only : key_kind, max_items, word_length
   use dda_deck_keys, only : deck_key
   use dda_deck_set, only : number_problem, put_number, put_numbers, put_text
   use dda_deck_token, only : shown, token_kind, token_text
   use dda_deck_words, only : full_name, or_leave_out, wanted
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, read_number, to_text
   implicit none

contains

   !> Read the values of one key
   module procedure read_values
      call check_values(scan, first, last, parameter, place, deck, error)
      if (allocated(error)) return
      select case (deck_key(parameter%key)%kind)
      case (key_kind%numbers)
         if (parameter%item > 0) then
            call put_number(deck, parameter, number_at(scan, first), place, error)
         else
            call put_numbers(deck, parameter%key, all_numbers(scan, first, last), place, error)
         end if
      case (key_kind%number, key_kind%whole)
         call put_number(deck, parameter, number_at(scan, first), &
            place_at(scan, first, place), error)
      case (key_kind%texts)
         deck%value(parameter%key)%texts = all_texts(scan, first, last)
         deck%value(parameter%key)%given = .true.
         deck%value(parameter%key)%place = place
      case default
         call put_text(deck, parameter, token_text(scan, first), place_at(scan, first, place), &
            error)
      end select
   end procedure read_values

   !> Whether the values of a key are of its kind and not too many
   pure subroutine check_values(scan, first, last, parameter, place, deck, error)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first, last
      type(parameter_t), intent(in) :: parameter
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: found
      logical :: takes_list
      integer :: kind, n, i

      kind = deck_key(parameter%key)%kind
      takes_list = parameter%item == 0 .and. (kind == key_kind%numbers .or. kind == key_kind%texts)
      n = nint(min(sum(real(scan%token(first:last)%count, wp)), 1.0e9_wp))
      i = first
      found = ""
      if (n == 0) then
         found = "nothing"
      else if (.not. takes_list .and. n > 1) then
         i = min(first + 1, last)
         found = to_text(n)//" values"
         if (i > first) found = found//hint(scan, i, deck_key(parameter%key)%group)
      else if (takes_list .and. n > max_items) then
         found = to_text(n)//" values (the most is "//to_text(max_items)//")"
      else
         do i = first, last
            found = mismatch(scan, i, parameter%key)
            if (len(found) > 0) exit
         end do
      end if
      if (len(found) == 0) return
      call deck_error(error, full_name(deck_key(parameter%key))//" must be "// &
         wanted(deck_key(parameter%key))//", got "//found//or_leave_out(parameter%key), deck, &
         place_at(scan, i, place))
   end subroutine check_values

   !> What a token is instead of a value of a key
   pure function mismatch(scan, i, key) result(found)
      type(deck_scan_t), intent(in) :: scan
      !> Place of the token
      integer, intent(in) :: i
      !> Place of the key in the registry
      integer, intent(in) :: key
      !> What was found; empty if the token will do
      character(len=:), allocatable :: found
      logical :: fits, needs_quotes, is_word
      integer :: whole
      real(wp) :: number

      is_word = scan%token(i)%kind == token_kind%word
      fits = is_word
      needs_quotes = .false.
      found = shown(token_text(scan, i))
      select case (deck_key(key)%kind)
      case (key_kind%whole)
         if (is_word) call read_integer(token_text(scan, i), whole, fits)
      case (key_kind%number, key_kind%numbers)
         if (is_word) call read_number(token_text(scan, i), number, fits)
         if (fits) fits = len(number_problem(key, number)) == 0
      case (key_kind%word, key_kind%text, key_kind%texts)
         fits = scan%token(i)%kind == token_kind%quoted
         needs_quotes = is_word
         if (deck_key(key)%kind == key_kind%texts) fits = fits .and. &
            len(token_text(scan, i)) <= word_length
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

   !> Where a token stands
   pure type(deck_place_t) function place_at(scan, i, place)
      type(deck_scan_t), intent(in) :: scan
      !> Place of the token; past the end if there is none
      integer, intent(in) :: i
      type(deck_place_t), intent(in) :: place

      place_at = place
      if (place%from_command .or. i > scan%n) return
      if (scan%token(i)%kind == token_kind%key .or. scan%token(i)%kind == token_kind%close) return
      place_at%line = scan%token(i)%line
   end function place_at

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
      integer, intent(in) :: first, last
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
      integer, intent(in) :: first, last
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

end submodule dda_deck_entry
