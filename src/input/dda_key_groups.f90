!> Groups of keys that may be repeated: from the tokens of a namelist file to values, by a registry
module dda_key_groups
   use dda_deck_key, only : group_t, key_kind, key_t, word_length
   use dda_deck_scan, only : scan_deck
   use dda_deck_token, only : deck_scan_t, shown, token_kind, token_text
   use dda_deck_words, only : near_one
   use dda_error, only : error_t, fatal_error
   use dda_input, only : input_value_t
   use dda_key_values, only : default_value, take_values
   use dda_kinds, only : wp
   use dda_text, only : lower_case
   implicit none
   private

   public :: key_group_t, read_groups, flag_in, group_error, number_in, numbers_in, texts_in
   public :: whole_in, word_in

   !> One group of the file
   type :: key_group_t
      !> Its name
      character(len=16) :: name
      !> Line of the file
      integer :: row
      !> Keys that it may have, from the registry: (n)
      type(key_t), allocatable :: key(:)
      !> Their values: (n)
      type(input_value_t), allocatable :: value(:)
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
      !> Token with its name
      integer, intent(in) :: first
      !> Token that closes it
      integer, intent(in) :: last
      !> Groups that there are
      type(group_t), intent(in) :: groups(:)
      !> Keys that there are
      type(key_t), intent(in) :: keys(:)
      !> The group, empty before
      type(key_group_t), intent(inout) :: group
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, problem
      integer :: at, i, k, next

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
      do k = 1, size(group%key)
         group%value(k) = default_value(group%key(k))
      end do
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
         else if (group%value(k)%given) then
            call fatal_error(error, "expected "//name//" once in the group, got it twice", &
               & line=scan%token(i)%line)
            return
         end if
         next = i + 1
         do while (next < last .and. scan%token(next)%kind /= token_kind%key)
            next = next + 1
         end do
         call take_values(scan, i + 1, next - 1, group%key(k), .false., group%value(k), at, problem)
         if (len(problem) > 0) call fatal_error(error, problem, &
            & line=scan%token(merge(at, i, at < next))%line)
         group%value(k)%given = .true.
         i = next
      end do
   end subroutine read_group

   !> Place of a key
   pure integer function place_in(group, name)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name

      place_in = findloc(group%key%name == name, .true., dim=1)
   end function place_in

   !> Numbers of a key; the default where it is not given, none where there is none
   pure function numbers_in(group, name) result(number)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name
      !> The numbers: (n)
      real(wp), allocatable :: number(:)

      associate (key => group%key(place_in(group, name)), &
         & value => group%value(place_in(group, name)))
         allocate (number(0))
         if (key%kind == key_kind%numbers) then
            number = value%numbers
         else if (value%given .or. len_trim(key%default) > 0) then
            number = [value%number]
         end if
      end associate
   end function numbers_in

   !> One number of a key
   pure real(wp) function number_in(group, name, without)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name
      !> Its value where it is not given and has no default
      real(wp), intent(in), optional :: without

      number_in = group%value(place_in(group, name))%number
      if (present(without) .and. size(numbers_in(group, name)) == 0) number_in = without
   end function number_in

   !> One whole number of a key
   pure integer function whole_in(group, name, without)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name
      !> Its value where it is not given and has no default
      integer, intent(in), optional :: without

      whole_in = nint(number_in(group, name))
      if (present(without) .and. size(numbers_in(group, name)) == 0) whole_in = without
   end function whole_in

   !> A word of a key, in lower case
   pure function word_in(group, name) result(word)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: word

      word = lower_case(trim(group%value(place_in(group, name))%text))
   end function word_in

   !> Words of a list
   pure function texts_in(group, name) result(text)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name
      !> The words, in lower case; none where the key is not given: (n)
      character(len=word_length), allocatable :: text(:)
      integer :: i

      text = group%value(place_in(group, name))%texts
      do i = 1, size(text)
         text(i) = lower_case(text(i))
      end do
   end function texts_in

   !> A truth value
   pure logical function flag_in(group, name)
      type(key_group_t), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: name

      flag_in = group%value(place_in(group, name))%flag
   end function flag_in

   !> An error that speaks of a group
   pure subroutine group_error(group, message, error)
      type(key_group_t), intent(in) :: group
      !> What was expected, what was found
      character(len=*), intent(in) :: message
      type(error_t), allocatable, intent(out) :: error

      call fatal_error(error, "&"//trim(group%name)//": "//message, line=group%row)
   end subroutine group_error
end module dda_key_groups
