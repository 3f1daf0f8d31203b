!> Groups of keys that may be repeated: from the tokens of a namelist file to values, by a registry
module dda_key_groups
   use dda_deck_key, only : group_t, in_range, key_kind, key_t
   use dda_deck_scan, only : scan_deck
   use dda_deck_token, only : deck_scan_t, shown, token_kind, token_text
   use dda_deck_words, only : near_one, wanted
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, read_number, to_text
   implicit none
   private

   public :: key_group_t, read_groups, flag_in, group_error, number_in, numbers_in, texts_in
   public :: whole_in, word_in

   !> Longest value; of a title, which says nothing that is drawn, only so much is kept
   integer, parameter :: value_length = 64

   !> Values of one key
   type :: key_value_t
      !> The tokens as texts, repeat counts carried out: (n)
      character(len=value_length), allocatable :: text(:)
      !> Line of the file; 0 if the key is not given
      integer :: row = 0
   end type key_value_t

   !> One group of the file
   type :: key_group_t
      character(len=16) :: name                   !! Its name
      integer :: row                              !! Line of the file
      type(key_t), allocatable :: key(:)          !! Keys that it may have, from the registry: (n)
      type(key_value_t), allocatable :: value(:)  !! Their values: (n)
   end type key_group_t

contains

   !> Read all groups of a text
   pure subroutine read_groups(text, file, groups, keys, group, error)
      !> The text, lines ended by line feeds
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Groups that there are
      type(group_t), intent(in) :: groups(:)
      !> Keys that there are
      type(key_t), intent(in) :: keys(:)
      !> The groups of the text, in their order
      type(key_group_t), allocatable, intent(out) :: group(:)
      type(error_t), allocatable, intent(out) :: error
      type(deck_scan_t) :: scan
      integer :: i, g, last

      call scan_deck(text, scan, error)
      last = 0
      if (.not. allocated(error)) last = count(scan%token(:scan%n)%kind == token_kind%group)
      allocate (group(last))
      i = 1
      do g = 1, size(group)
         last = i
         do while (last < scan%n .and. scan%token(last)%kind /= token_kind%close)
            last = last + 1
         end do
         call read_group(scan, i, last, groups, keys, group(g), error)
         if (allocated(error)) exit
         i = last + 1
      end do
      if (allocated(error)) error%file = file
   end subroutine read_groups

   !> Read one group
   pure subroutine read_group(scan, first, last, groups, keys, group, error)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first               !! Token with its name
      integer, intent(in) :: last                !! Token that closes it
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: keys(:)
      type(key_group_t), intent(inout) :: group  !! The group, empty before
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name
      integer :: i, k, next

      name = token_text(scan, first)
      group%row = scan%token(first)%line
      if (all(groups%name /= name)) then
         call fatal_error(error, "expected a group such as &"//trim(groups(1)%name)//", got &" &
            & //shown(name)//near_one(name, groups%name), line=group%row)
         return
      end if
      group%name = name
      allocate (group%key, source=pack(keys, keys%group == name))
      allocate (group%value(size(group%key)))
      i = first + 1
      do while (i < last .and. .not. allocated(error))
         name = token_text(scan, i)
         if (scan%token(i)%kind /= token_kind%key) then
            call fatal_error(error, "expected key = value, got '"//shown(name)//"'", &
               & line=scan%token(i)%line)
            return
         end if
         k = findloc(group%key%name == name, .true., dim=1)
         if (k == 0) then
            call fatal_error(error, "&"//trim(group%name)//" has no key '"//shown(name)//"'" &
               & //near_one(name, group%key%name)//"; 'dda help lines' lists all", &
               & line=scan%token(i)%line)
            return
         else if (group%value(k)%row > 0) then
            call fatal_error(error, "expected "//name//" once in the group, got it twice", &
               & line=scan%token(i)%line)
            return
         end if
         next = i + 1
         do while (next < last .and. scan%token(next)%kind /= token_kind%key)
            next = next + 1
         end do
         call read_value(scan, i, next - 1, group%key(k), group%value(k), error)
         i = next
      end do
   end subroutine read_group

   !> Read and check the values of one key
   pure subroutine read_value(scan, first, last, key, value, error)
      type(deck_scan_t), intent(in) :: scan
      integer, intent(in) :: first
      integer, intent(in) :: last  !! Last token of its values
      type(key_t), intent(in) :: key
      type(key_value_t), intent(out) :: value
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      integer :: i, n

      value%row = scan%token(first)%line
      n = sum(scan%token(first + 1:last)%count)
      if (n == 0 .or. n > 100000 .or. (n > 1 .and. key%kind /= key_kind%numbers &
         & .and. key%kind /= key_kind%texts)) then
         call fatal_error(error, trim(key%name)//" must be "//wanted(key)//", got " &
            & //to_text(n)//" values", line=value%row)
         return
      end if
      allocate (value%text(n))
      n = 0
      do i = first + 1, last
         text = token_text(scan, i)
         value%text(n + 1:n + scan%token(i)%count) = text
         n = n + scan%token(i)%count
         if (fits(key, text, scan%token(i)%kind)) cycle
         call fatal_error(error, trim(key%name)//" must be "//wanted(key)//", got '" &
            & //shown(text)//"'", line=scan%token(i)%line)
         return
      end do
   end subroutine read_value

   !> Whether a text is a value of a key
   pure logical function fits(key, text, kind)
      type(key_t), intent(in) :: key
      character(len=*), intent(in) :: text
      integer, intent(in) :: kind  !! Kind of its token
      real(wp) :: number
      integer :: whole

      select case (key%kind)
      case (key_kind%number, key_kind%numbers, key_kind%whole)
         fits = kind == token_kind%word
         if (fits) call read_number(text, number, fits)
         if (fits .and. key%kind == key_kind%whole) call read_integer(text, whole, fits)
         if (fits) fits = in_range(key, number)
      case (key_kind%word)
         fits = kind == token_kind%quoted .and. len_trim(text) > 0 &
            & .and. index(" "//trim(key%words)//" ", " "//trim(lower_case(text))//" ") > 0
      case (key_kind%flag)
         fits = kind == token_kind%word .and. (is_flag(text, "t") .or. is_flag(text, "f"))
      case default
         fits = kind == token_kind%quoted
      end select
      if (key%kind /= key_kind%text) fits = fits .and. len(text) <= value_length
   end function fits

   !> Whether a text is one form of a truth value
   pure logical function is_flag(text, letter)
      character(len=*), intent(in) :: text
      character(len=1), intent(in) :: letter  !! Its letter, t or f

      is_flag = lower_case(text) == letter .or. lower_case(text) == "."//letter//"." &
         & .or. lower_case(text) == trim(merge(".true. ", ".false.", letter == "t"))
   end function is_flag

   !> Numbers of a key; the default where it is not given, none where there is none
   pure function numbers_in(group, name) result(number)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name  !! Name of the key
      real(wp), allocatable :: number(:)    !! The numbers: (n)
      logical :: ok
      integer :: i, k

      k = findloc(group%key%name == name, .true., dim=1)
      if (group%value(k)%row == 0) then
         allocate (number(merge(1, 0, len_trim(group%key(k)%default) > 0)))
         if (size(number) > 0) call read_number(trim(group%key(k)%default), number(1), ok)
         return
      end if
      allocate (number(size(group%value(k)%text)))
      do i = 1, size(number)
         call read_number(trim(group%value(k)%text(i)), number(i), ok)
      end do
   end function numbers_in

   !> One number of a key
   pure real(wp) function number_in(group, name, without)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name
      !> Its value where it is not given and has no default
      real(wp), intent(in), optional :: without
      real(wp), allocatable :: number(:)

      allocate (number, source=numbers_in(group, name))
      number_in = 0.0_wp
      if (present(without)) number_in = without
      if (size(number) > 0) number_in = number(1)
   end function number_in

   !> One whole number of a key
   pure integer function whole_in(group, name, without)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name
      !> Its value where it is not given and has no default
      integer, intent(in), optional :: without

      if (present(without)) then
         whole_in = nint(number_in(group, name, real(without, wp)))
      else
         whole_in = nint(number_in(group, name))
      end if
   end function whole_in

   !> A word of a key, in lower case
   pure function word_in(group, name) result(word)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: word
      integer :: k

      k = findloc(group%key%name == name, .true., dim=1)
      if (group%value(k)%row > 0) then
         word = trim(lower_case(group%value(k)%text(1)))
      else
         word = trim(group%key(k)%default)
         word = word(2:len(word) - 1)
      end if
   end function word_in

   !> Words of a list
   pure function texts_in(group, name) result(text)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name
      !> The words, in lower case; none where the key is not given: (n)
      character(len=16), allocatable :: text(:)
      integer :: i, k

      k = findloc(group%key%name == name, .true., dim=1)
      allocate (text(0))
      if (group%value(k)%row == 0) return
      deallocate (text)
      allocate (text(size(group%value(k)%text)))
      do i = 1, size(text)
         text(i) = trim(lower_case(group%value(k)%text(i)))
      end do
   end function texts_in

   !> A truth value
   pure logical function flag_in(group, name)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name
      integer :: k

      k = findloc(group%key%name == name, .true., dim=1)
      flag_in = is_flag(trim(group%key(k)%default), "t")
      if (group%value(k)%row > 0) flag_in = is_flag(trim(group%value(k)%text(1)), "t")
   end function flag_in

   !> An error that speaks of a group
   pure subroutine group_error(group, message, error)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: message  !! What was expected, what was found
      type(error_t), allocatable, intent(out) :: error

      call fatal_error(error, "&"//trim(group%name)//": "//message, line=group%row)
   end subroutine group_error
end module dda_key_groups
