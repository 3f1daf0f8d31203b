!> Groups and keys of a deck, and --set GROUP%KEY=VALUE, into values
submodule (dda_read_deck) dda_deck_groups
   use dda_deck, only : deck_error
   use dda_deck_key, only : key_kind, max_items, word_length
   use dda_deck_keys, only : deck_key
   use dda_deck_parameter, only : split_name
   use dda_deck_scan, only : scan_values
   use dda_deck_set, only : number_problem, put_number, put_numbers, put_text
   use dda_deck_sweep, only : add_sweep
   use dda_deck_token, only : shown, token_kind, token_text
   use dda_deck_words, only : full_name, near_group, near_key, or_leave_out, wanted
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, read_number, to_text
   implicit none

contains

   !> Read one group
   module procedure read_group
      character(len=:), allocatable :: name
      type(deck_place_t) :: place
      integer :: g

      name = token_text(scan, i)
      place%line = scan%token(i)%line
      g = group_index(name)
      if (g == 0) then
         call deck_error(error, "unknown group &"//shown(name)//": "//near_group(name), deck, place)
         return
      else if (deck%group(g)%line > 0 .and. name /= "sweep") then
         call deck_error(error, "group &"//name//" is repeated: the first is in line "// &
            to_text(deck%group(g)%line)//"; join the two", deck, place)
         return
      end if
      deck%group(g) = place
      i = i + 1
      do while (scan%token(i)%kind /= token_kind%close)
         call read_entry(scan, i, name, deck, error)
         if (allocated(error)) return
      end do
      i = i + 1
      if (name == "sweep") call add_sweep(deck, place, error)
   end procedure read_group

   !> Read one key and its values
   pure subroutine read_entry(scan, i, group, deck, error)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(inout) :: i            !! Token of the key; then the token after its values
      character(len=*), intent(in) :: group  !! Name of the group
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(deck_place_t) :: place
      integer :: key, first

      place%line = scan%token(i)%line
      if (scan%token(i)%kind /= token_kind%key) then
         call deck_error(error, "expected key = value in &"//group//", got '"// &
            shown(token_text(scan, i))//"'; write a key, '=' and its value", deck, place)
         return
      end if
      call find_key(group, token_text(scan, i), deck, place, key, error)
      if (allocated(error)) return
      if (deck%value(key)%given) then
         call deck_error(error, full_name(deck_key(key))//" is repeated: the first is in line "// &
            to_text(deck%value(key)%place%line)//"; remove one of them", deck, place)
         return
      end if
      first = i + 1
      i = first
      do while (is_value(scan, i))
         i = i + 1
      end do
      call read_values(scan, first, i - 1, parameter_t(key, 0), place, deck, error)
   end subroutine read_entry

   !> Whether a token stands for a value, be it an empty one
   pure logical function is_value(scan, i)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i  !! Place of the token

      is_value = any(scan%token(i)%kind == [token_kind%word, token_kind%quoted, token_kind%nothing])
   end function is_value

   !> Find a key of a known group
   pure subroutine find_key(group, name, deck, place, key, error)
      character(len=*), intent(in) :: group
      character(len=*), intent(in) :: name  !! Name of the key
      type(deck_t), intent(in) :: deck
      type(deck_place_t), intent(in) :: place
      integer, intent(out) :: key           !! Place in the registry
      type(error_t), allocatable, intent(out) :: error
      integer :: open

      key = key_index(group, name)
      open = index(name//"(", "(")
      if (key == 0 .and. key_index(group, name(:open - 1)) > 0) then
         call deck_error(error, "expected the whole list, "//name(:open - 1)//" = ..., got "// &
            shown(name)//"; write all of its items", deck, place)
      else if (key == 0) then
         call deck_error(error, "unknown key '"//shown(name)//"' in &"//group//": "// &
            near_key(name, group), deck, place)
      else if (deck_key(key)%kind == key_kind%later) then
         call deck_error(error, full_name(deck_key(key))//" is not yet there. It will be: "// &
            trim(deck_key(key)%meaning)//" Remove it", deck, place)
      end if
   end subroutine find_key

   !> Put the value of a --set into the deck
   module procedure apply_setting
      character(len=:), allocatable :: group, name
      type(parameter_t) :: parameter
      integer :: equals
      logical :: ok

      equals = index(setting, "=")
      call split_name(setting(:max(equals - 1, 0)), group, name, parameter%item, ok)
      if (.not. ok .or. equals == 0 .or. len(group) == 0 .or. has_control(setting)) then
         call deck_error(error, "expected group%key=value, got '"//shown(setting)// &
            "'; write it like arch%radius=5.0", deck, place)
      else if (group == "sweep") then
         call deck_error(error, "&sweep cannot be set; change the deck", deck, place)
      else if (group_index(group) == 0) then
         call deck_error(error, "unknown group &"//shown(group)//": "//near_group(group), &
            deck, place)
      else
         call find_key(group, name, deck, place, parameter%key, error)
         if (.not. allocated(error)) call set_value(setting(equals + 1:), parameter, place, &
            deck, error)
      end if
   end procedure apply_setting

   !> Whether a text holds control characters
   pure logical function has_control(text)
      character(len=*), intent(in) :: text  !! Any text
      integer :: i

      has_control = any([(ichar(text(i:i)) < 32 .or. ichar(text(i:i)) == 127, i=1, len(text))])
   end function has_control

   !> Put the text after the equals sign of a --set into its key
   pure subroutine set_value(text, parameter, place, deck, error)
      !> The value as a namelist would have it; a word or a text may lack its quotes
      character(len=*), intent(in) :: text
      !> The key, with its item if one is set
      type(parameter_t), intent(in) :: parameter
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(deck_scan_t) :: scan
      logical :: is_text, has_quotes
      integer :: g

      is_text = any(deck_key(parameter%key)%kind == [key_kind%text, key_kind%word])
      has_quotes = index(adjustl(text), "'") == 1 .or. index(adjustl(text), """") == 1
      if (is_text .and. .not. has_quotes) then
         call put_text(deck, parameter, trim(adjustl(text)), place, error)
      else if (parameter%item > 0 .and. deck_key(parameter%key)%kind /= key_kind%numbers) then
         call deck_error(error, full_name(deck_key(parameter%key))//" has no items; remove "// &
            "the parentheses", deck, place)
      else
         call scan_values(text, scan, error)
         if (allocated(error)) then
            error%file = "--set"
            error%line = place%line
            return
         end if
         call read_values(scan, 1, scan%n, parameter, place, deck, error)
      end if
      if (allocated(error)) return
      g = group_index(deck_key(parameter%key)%group)
      if (deck%group(g)%line == 0) deck%group(g) = place
   end subroutine set_value

   !> Read the values of one key
   pure subroutine read_values(scan, first, last, parameter, place, deck, error)
      type(deck_scan_t), intent(in) :: scan
      !> First token of the values
      integer, intent(in) :: first
      !> Last token; one before the first if there are none
      integer, intent(in) :: last
      !> The key, with the item if only that one is set
      type(parameter_t), intent(in) :: parameter
      !> Where the key stands
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      !> Wrong type, wrong number of values, or a value out of range
      type(error_t), allocatable, intent(out) :: error

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
   end subroutine read_values

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
      integer, intent(in) :: i                !! Place of the token
      integer, intent(in) :: key              !! Place of the key in the registry
      character(len=:), allocatable :: found  !! What was found; empty if the token will do
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
      integer, intent(in) :: i               !! Place of the second value
      character(len=*), intent(in) :: group  !! Name of the group
      character(len=:), allocatable :: text  !! A guess in parentheses; empty if there is none
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
      integer, intent(in) :: i  !! Place of the token; past the end if there is none
      type(deck_place_t), intent(in) :: place

      place_at = place
      if (place%from_command .or. i > scan%n) return
      if (scan%token(i)%kind == token_kind%key .or. scan%token(i)%kind == token_kind%close) return
      place_at%line = scan%token(i)%line
   end function place_at

   !> Number that a token stands for
   pure real(wp) function number_at(scan, i)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i  !! Place of a token that is a number
      logical :: unused

      call read_number(token_text(scan, i), number_at, unused)
   end function number_at

   !> Numbers that tokens stand for, repeat counts written out
   pure function all_numbers(scan, first, last) result(numbers)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first, last
      real(wp), allocatable :: numbers(:)  !! The numbers: (n)
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
      character(len=word_length), allocatable :: texts(:)  !! The words: (n)
      integer :: i, n

      allocate (texts(sum(scan%token(first:last)%count)))
      n = 0
      do i = first, last
         texts(n + 1:n + scan%token(i)%count) = token_text(scan, i)
         n = n + scan%token(i)%count
      end do
   end function all_texts
end submodule dda_deck_groups
