!> Groups, keys and values from the tokens of a namelist file
module dda_key_entry
   use dda_deck_key, only : full_name, group_t, key_kind, key_t, max_items, near_group, near_key, &
      & or_leave_out, wanted, word_length
   use dda_deck_scan, only : scan_deck
   use dda_deck_token, only : deck_scan_t, shown, token_kind, token_text
   use dda_error, only : error_t, fatal_error
   use dda_key_value, only : deck_place_t, deck_value_t, default_value, number_problem, &
      & set_number, set_text
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, read_number, to_text
   implicit none
   private

   public :: find_key, group_error, key_group_t, read_entry, read_groups, read_value

   !> One group of the file
   type :: key_group_t
      character(len=16) :: name                    !! Name of the group
      integer :: row                               !! Line of the file
      type(deck_value_t), allocatable :: value(:)  !! Values, indexed by the keys of the registry
   end type key_group_t

contains

   !> Read all groups of a text
   pure subroutine read_groups(text, file, groups, keys, topic, group, error)
      character(len=*), intent(in) :: text    !! The text, lines ended by line feeds
      character(len=*), intent(in) :: file    !! Name of the file
      type(group_t), intent(in) :: groups(:)  !! Groups of the registry
      type(key_t), intent(in) :: keys(:)      !! Keys of the registry, by group
      character(len=*), intent(in) :: topic   !! Page of the help with the list of groups and keys
      type(key_group_t), allocatable, intent(out) :: group(:)  !! Groups of the text, in order
      type(error_t), allocatable, intent(out) :: error
      type(deck_scan_t) :: scan
      character(len=:), allocatable :: problem
      integer :: i, g, k, first, line

      call scan_deck(text, scan, error)
      allocate (group(count(scan%token(:scan%n)%kind == token_kind%group)))
      i = 1
      do g = 1, size(group)
         if (allocated(error)) exit
         group(g)%name = token_text(scan, i)
         group(g)%row = scan%token(i)%line
         first = findloc(keys%group == group(g)%name, .true., dim=1)
         if (first == 0) then
            call fatal_error(error, "unknown group &"//shown(token_text(scan, i))//": " &
               & //near_group(token_text(scan, i), groups, topic), line=group(g)%row)
            exit
         end if
         allocate (group(g)%value(first:first + count(keys%group == group(g)%name) - 1))
         do k = first, ubound(group(g)%value, 1)
            group(g)%value(k) = default_value(keys(k))
         end do
         i = i + 1
         do while (scan%token(i)%kind /= token_kind%close .and. .not. allocated(error))
            call read_entry(scan, i, trim(group(g)%name), keys, topic, group(g)%value, problem, &
               & line)
            if (len(problem) > 0) call fatal_error(error, problem, line=line)
         end do
         i = i + 1
      end do
      if (allocated(error)) error%file = file
   end subroutine read_groups

   !> Set an error at a group
   pure subroutine group_error(group, message, error)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: message  !! Expected and actual value
      type(error_t), allocatable, intent(out) :: error

      call fatal_error(error, "&"//trim(group%name)//": "//message, line=group%row)
   end subroutine group_error

   !> Read one key and its values
   pure subroutine read_entry(scan, i, group, keys, topic, value, problem, line)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(inout) :: i            !! Token of the key; moved past its values
      character(len=*), intent(in) :: group  !! Name of the group
      type(key_t), intent(in) :: keys(:)     !! Keys of the registry
      character(len=*), intent(in) :: topic  !! Page of the help with the list of keys
      !> Values, indexed by keys; those of other groups may be missing
      type(deck_value_t), allocatable, intent(inout) :: value(:)
      !> The problem and its remedy; empty if there is none
      character(len=:), allocatable, intent(out) :: problem
      integer, intent(out) :: line  !! Line of the problem
      integer :: first, key

      line = scan%token(i)%line
      if (scan%token(i)%kind /= token_kind%key) then
         problem = "expected key = value in &"//group//", got '"//shown(token_text(scan, i)) &
            & //"'; write a key, '=' and its value"
         return
      end if
      call find_key(keys, group, token_text(scan, i), topic, key, problem)
      if (len(problem) > 0) return
      if (value(key)%given) then
         problem = full_name(keys(key))//" is repeated: the first is in line " &
            & //to_text(value(key)%place%line)//"; remove one of them"
         return
      end if
      first = i + 1
      i = first
      do while (any(scan%token(i)%kind == [token_kind%word, token_kind%quoted, &
         & token_kind%nothing]))
         i = i + 1
      end do
      call read_value(scan, first, i - 1, keys, key, 0, deck_place_t(line), value(key), problem)
      line = value(key)%place%line
   end subroutine read_entry

   !> Find a key of a group by its name
   pure subroutine find_key(keys, group, name, topic, key, problem)
      type(key_t), intent(in) :: keys(:)
      character(len=*), intent(in) :: group
      character(len=*), intent(in) :: name  !! Name of the key
      character(len=*), intent(in) :: topic
      integer, intent(out) :: key           !! Index in the registry
      character(len=:), allocatable, intent(out) :: problem
      integer :: open

      problem = ""
      key = findloc(keys%group == group .and. keys%name == name, .true., dim=1)
      open = index(name//"(", "(")
      if (key == 0 .and. any(keys%group == group .and. keys%name == name(:open - 1))) then
         problem = "expected the whole list, "//name(:open - 1)//" = ..., got "//shown(name) &
            & //"; write all of its items"
      else if (key == 0) then
         problem = "unknown key '"//shown(name)//"' in &"//group//": " &
            & //near_key(name, group, keys, topic)
      end if
   end subroutine find_key

   !> Read the values of one key
   pure subroutine read_value(scan, first, last, keys, key, item, place, value, problem)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first  !! First token of the values
      integer, intent(in) :: last   !! Last token; precedes the first if there are none
      type(key_t), intent(in) :: keys(:)
      integer, intent(in) :: key               !! Index of the key
      integer, intent(in) :: item              !! Item of the list, or 0 for the whole value
      type(deck_place_t), intent(in) :: place  !! Place of the key
      !> Receives the value and its place, or the place of the problem
      type(deck_value_t), intent(inout) :: value
      !> The problem: wrong kind, number of values, or range; empty if there is none
      character(len=:), allocatable, intent(out) :: problem
      integer :: i, k

      call check_values(scan, first, last, keys, key, item, place, value%place, problem)
      if (len(problem) > 0) return
      select case (keys(key)%kind)
      case (key_kind%numbers)
         if (item > 0) then
            call set_number(value, keys(key), item, number_at(scan, first), problem)
         else
            value%numbers = [((number_at(scan, k), i=1, scan%token(k)%count), k=first, last)]
         end if
         value%place = place
      case (key_kind%texts)
         value%texts = [character(len=word_length) :: ((token_text(scan, k), &
            & i=1, scan%token(k)%count), k=first, last)]
         value%place = place
      case (key_kind%number, key_kind%whole)
         call set_number(value, keys(key), 0, number_at(scan, first), problem)
         value%place = place_at(scan, first, place)
      case default
         call set_text(value, keys(key), token_text(scan, first), problem)
         value%place = place_at(scan, first, place)
      end select
      value%given = len(problem) == 0
   end subroutine read_value

   !> Check kind and number of the values of a key
   pure subroutine check_values(scan, first, last, keys, key, item, place, at, problem)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first, last
      type(key_t), intent(in) :: keys(:)
      integer, intent(in) :: key, item
      type(deck_place_t), intent(in) :: place
      type(deck_place_t), intent(out) :: at                  !! Place of the first invalid value
      character(len=:), allocatable, intent(out) :: problem  !! The problem; empty if there is none
      character(len=:), allocatable :: found
      logical :: takes_list
      integer :: n, i

      takes_list = item == 0 .and. any(keys(key)%kind == [key_kind%numbers, key_kind%texts])
      n = nint(min(sum(real(scan%token(first:last)%count, wp)), 1.0e9_wp))
      i = first
      found = ""
      if (n == 0) then
         found = "nothing"
      else if (.not. takes_list .and. n > 1) then
         i = min(first + 1, last)
         found = to_text(n)//" values"
         if (i > first) found = found//hint(scan, i, pack(keys%name, &
            & keys%group == keys(key)%group))
      else if (takes_list .and. n > max_items) then
         found = to_text(n)//" values (the most is "//to_text(max_items)//")"
      else
         do i = first, last
            found = mismatch(scan, i, keys(key))
            if (len(found) > 0) exit
         end do
      end if
      at = place_at(scan, i, place)
      problem = ""
      if (len(found) > 0) problem = full_name(keys(key))//" must be "//wanted(keys(key)) &
         & //", got "//found//or_leave_out(keys(key))
   end subroutine check_values

   !> Text of a token that is no valid value of a key
   pure function mismatch(scan, i, key) result(found)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i                !! Place of the token
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: found  !! The text; empty if the token is valid
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
         if (fits) fits = len(number_problem(key, number)) == 0
      case (key_kind%word, key_kind%text, key_kind%texts)
         fits = scan%token(i)%kind == token_kind%quoted
         needs_quotes = is_word
         if (key%kind == key_kind%texts) fits = fits .and. &
            len(token_text(scan, i)) <= word_length
      end select
      if (scan%token(i)%kind == token_kind%quoted) found = "'"//found//"'"
      if (scan%token(i)%kind == token_kind%nothing) found = "nothing between two commas"
      if (needs_quotes) found = found//" without quotes"
      if (fits) found = ""
   end function mismatch

   !> Hint about a second value where one is expected
   pure function hint(scan, i, names) result(text)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i                  !! Place of the second value
      character(len=*), intent(in) :: names(:)  !! Names of the keys of the group
      character(len=:), allocatable :: text     !! Hint in parentheses; empty if there is none
      character(len=:), allocatable :: name

      text = ""
      if (scan%token(i)%kind /= token_kind%word) return
      name = lower_case(token_text(scan, i))
      if (any(names == name)) then
         text = " (is '=' missing after "//name//"?)"
      else if (verify(name, "0123456789") == 0) then
         text = " (decimals are written with a point)"
      end if
   end function hint

   !> Place of a token
   pure type(deck_place_t) function place_at(scan, i, place)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i  !! Place of the token; past the end if there is none
      type(deck_place_t), intent(in) :: place

      place_at = place
      if (place%from_command .or. i > scan%n) return
      if (scan%token(i)%kind == token_kind%key .or. scan%token(i)%kind == token_kind%close) return
      place_at%line = scan%token(i)%line
   end function place_at

   !> Number of a token
   pure real(wp) function number_at(scan, i)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: i  !! Place of a token that is a number
      logical :: unused

      call read_number(token_text(scan, i), number_at, unused)
   end function number_at

end module dda_key_entry
