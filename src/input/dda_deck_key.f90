!> Registry entries of keys and groups, and their description
module dda_deck_key
   use dda_kinds, only : wp
   use dda_text, only : lower_case, short_text, to_text
   implicit none
   private

   public :: key_t, key_kind, group_t, in_range, name_length, word_length, max_items
   public :: wanted, full_name, near_group, near_key, near_word, has_word, listed_words
   public :: near_one, or_leave_out, is_required

   !> Maximum length of a key name [characters]
   integer, parameter :: name_length = 32
   !> Maximum length of a word in a list [characters]
   integer, parameter :: word_length = 64
   !> Maximum number of items in a list
   integer, parameter :: max_items = 100000

   !> Kinds of values
   type :: key_kind_enum
      integer :: number = 1   !! One real number
      integer :: whole = 2    !! One whole number
      integer :: word = 3     !! One of the words of the entry
      integer :: text = 4     !! Any text on one line
      integer :: flag = 5     !! .true. or .false.
      integer :: numbers = 6  !! A list of real numbers
      integer :: texts = 7    !! A list of words
   end type key_kind_enum

   !> Names of the kinds
   type(key_kind_enum), parameter :: key_kind = key_kind_enum()

   !> One key of a deck
   type :: key_t
      character(len=16) :: group = ""          !! Group that the key belongs to
      character(len=name_length) :: name = ""  !! Name of the key
      integer :: kind = key_kind%number        !! One of key_kind
      character(len=8) :: unit = ""            !! Unit of the value; empty if none
      character(len=24) :: default = ""  !! Default as written in a deck; empty if none
      character(len=80) :: without = ""  !! Effect of omitting a key without default
      !> Smallest and largest permitted value: (2)
      real(wp) :: within(2) = [-huge(1.0_wp), huge(1.0_wp)]
      real(wp) :: above = -huge(1.0_wp)  !! Lower bound, excluded
      real(wp) :: below = huge(1.0_wp)   !! Upper bound, excluded
      character(len=72) :: words = ""    !! Permitted words, separated by blanks
      !> True if &sweep may vary the key; &search may too, if it is a real number
      logical :: varies = .true.
      !> True if the name without group refers to this key, even if other groups have the same name
      logical :: bare = .true.
      !> Requirements, separated by a comma and a blank: KEY = 'WORD' or 'WORD', KEY if it must be
      !> given, no KEY if it must not
      character(len=120) :: needs = ""
      real(wp) :: search_low = -huge(1.0_wp)  !! Default lower end of a search
      real(wp) :: search_high = huge(1.0_wp)  !! Default upper end of a search
      character(len=180) :: meaning = ""      !! Meaning of the key, in one sentence
   end type key_t

   !> One group of a deck
   type :: group_t
      character(len=16) :: name = ""     !! Name of the group
      character(len=120) :: meaning = ""  !! Meaning of the group
   end type group_t

   !> Maximum length of words compared for suggestions [characters]
   integer, parameter :: longest = 40

contains

   !> True if a number is in the range of a key
   elemental logical function in_range(key, number)
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: number  !! The number in the unit of the key

      in_range = number >= key%within(1) .and. number <= key%within(2) .and. number > key%above &
         & .and. number < key%below
      if (in_range .and. key%kind == key_kind%whole) &
         & in_range = .not. abs(number - anint(number)) > 0.0_wp
   end function in_range

   !> Description of valid values of a key: kind, unit and range
   pure function wanted(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text  !! Words such as: a number [m] from 1e-9 to 1e9

      select case (key%kind)
      case (key_kind%number)
         text = "a number"//unit_text(key)//range_text(key)
      case (key_kind%whole)
         text = "a whole number"//unit_text(key)//range_text(key)
      case (key_kind%numbers)
         text = "a list of numbers"//unit_text(key)//range_text(key)
      case (key_kind%word)
         text = quoted_words(key%words)
      case (key_kind%texts)
         text = "a list of words in quotes, each of at most "//to_text(word_length)//" characters"
      case (key_kind%flag)
         text = ".true. or .false."
      case default
         text = "a text in quotes"
      end select
   end function wanted

   !> Unit in brackets
   pure function unit_text(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text  !! Unit after a blank; empty if there is none

      text = ""
      if (len_trim(key%unit) > 0) text = " ["//trim(key%unit)//"]"
   end function unit_text

   !> Range of a number
   pure function range_text(key) result(text)
      type(key_t), intent(in) :: key
      !> Range after a blank, such as: from 0 to 90; empty if unlimited
      character(len=:), allocatable :: text
      real(wp), parameter :: none = huge(1.0_wp)
      character(len=:), allocatable :: comma

      text = ""
      comma = ""
      if (key%within(1) > -none) text = " from "//short_text(key%within(1))
      if (key%above > -none) text = " above "//short_text(key%above)
      if (len(text) > 0) comma = ","
      if (key%below < none) then
         text = text//comma//" below "//short_text(key%below)
      else if (key%within(2) < none) then
         text = text//" to "//short_text(key%within(2))
      end if
   end function range_text

   !> A list of words, each in quotes
   pure function quoted_words(words) result(text)
      character(len=*), intent(in) :: words  !! Words separated by one blank
      character(len=:), allocatable :: text  !! Text such as: 'stress', 'strain' or 'shear'
      character(len=word_length), allocatable :: list(:)
      integer :: i

      allocate (list, source=listed_words(words))
      text = "'"//trim(list(1))//"'"
      do i = 2, size(list)
         text = text//trim(merge(" or", ",  ", i == size(list)))//" '"//trim(list(i))//"'"
      end do
   end function quoted_words

   !> Words of a list
   pure function listed_words(words) result(list)
      character(len=*), intent(in) :: words               !! Words separated by one blank
      character(len=word_length), allocatable :: list(:)  !! The words: (n)
      integer :: i

      allocate (list(1 + count([(words(i:i) == " ", i=1, len_trim(words))])))
      read (words, *) list
   end function listed_words

   !> True if a list contains a word, in upper or lower case
   pure logical function has_word(words, text)
      character(len=*), intent(in) :: words  !! Words separated by one blank
      character(len=*), intent(in) :: text   !! The word

      has_word = len_trim(text) > 0 .and. index(trim(text), " ") == 0
      if (has_word) has_word = index(" "//words//" ", " "//lower_case(trim(text))//" ") > 0
   end function has_word

   !> Name of a key with its group
   pure function full_name(key) result(name)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: name  !! Text such as: arch%radius

      name = trim(key%group)//"%"//trim(key%name)
   end function full_name

   !> Suggestion for an unknown group
   pure function near_group(name, groups, topic) result(text)
      character(len=*), intent(in) :: name    !! The unknown name
      type(group_t), intent(in) :: groups(:)  !! Groups of the registry
      character(len=*), intent(in) :: topic   !! Page of the help with the list of groups
      character(len=:), allocatable :: text   !! Sentence with the nearest group

      text = "the nearest known group is &"//nearest_word(name, groups%name)//"; 'dda help " &
         & //topic//"' lists all"
   end function near_group

   !> Suggestion for an unknown key
   pure function near_key(name, group, keys, topic) result(text)
      character(len=*), intent(in) :: name   !! The unknown name
      character(len=*), intent(in) :: group  !! Name of the group; empty for any group
      type(key_t), intent(in) :: keys(:)     !! Keys of the registry
      character(len=*), intent(in) :: topic  !! Page of the help with the list of keys
      !> Sentence with the group of the key, or the nearest key
      character(len=:), allocatable :: text
      logical :: fits(size(keys))
      integer :: i

      i = findloc(keys%name == name .and. keys%bare, .true., dim=1)
      if (i > 0) then
         text = "it is a key of &"//trim(keys(i)%group)//"; move it there"
         return
      end if
      fits = keys%group == group .or. (len(group) == 0 .and. keys%varies)
      text = "the nearest known key is "//nearest_word(name, pack(keys%name, fits)) &
         & //"; 'dda help "//topic//"' lists all"
   end function near_key

   !> Suggestion for an invalid word of a key
   pure function near_word(key, text) result(near)
      type(key_t), intent(in) :: key
      character(len=*), intent(in) :: text  !! The invalid word
      !> Words after a colon with the nearest word; empty for a key without words
      character(len=:), allocatable :: near

      near = ""
      if (len_trim(key%words) > 0) near = near_one(lower_case(trim(text)), listed_words(key%words))
   end function near_word

   !> Suggestion from a list of words
   pure function near_one(word, list) result(near)
      character(len=*), intent(in) :: word     !! The word, which is not in the list
      character(len=*), intent(in) :: list(:)  !! Words to choose from: (n)
      !> Words after a colon with the suggestion; empty if more than half of the letters differ
      character(len=:), allocatable :: near

      near = nearest_word(word, list)
      if (2*edit_distance(word, near) <= len(near) + 1) then
         near = ": did you mean '"//near//"'?"
      else
         near = ""
      end if
   end function near_one

   !> Advice for a key with an invalid value
   pure function or_leave_out(key) result(advice)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: advice  !! Words after a semicolon

      advice = "; correct it"
      if (len_trim(key%default) > 0) then
         advice = advice//", or leave it out for "//trim(key%default)
      else if (len_trim(key%without) > 0 .and. key%group /= "sweep" &
         & .and. .not. is_required(key)) then
         advice = advice//", or leave it out: "//trim(key%without)
      end if
   end function or_leave_out

   !> True if a key is required in its group, at least in some cases
   pure logical function is_required(key)
      type(key_t), intent(in) :: key

      is_required = index(key%without, "required") == 1
   end function is_required

   !> The nearest word of a list; the given word may be its beginning
   pure function nearest_word(word, list) result(found)
      character(len=*), intent(in) :: word    !! Word to compare
      character(len=*), intent(in) :: list(:)
      character(len=:), allocatable :: found  !! The first of the nearest ones
      integer :: i, changes, fewest

      found = ""
      fewest = huge(1)
      do i = 1, size(list)
         changes = min(edit_distance(word, trim(list(i))), 1 + edit_distance(word, &
            list(i)(:min(len(word), len_trim(list(i))))))
         if (changes >= fewest) cycle
         fewest = changes
         found = trim(list(i))
      end do
   end function nearest_word

   !> Smallest number of inserted, deleted or replaced letters between two words (Levenshtein)
   pure integer function edit_distance(a, b)
      !> First word; only its beginning is used if it is very long
      character(len=*), intent(in) :: a
      character(len=*), intent(in) :: b  !! Second word
      integer :: row(0:len(b)), diagonal, above, i, j

      row = [(j, j=0, len(b))]
      do i = 1, min(len(a), longest)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
            diagonal = above
         end do
      end do
      edit_distance = row(len(b))
   end function edit_distance
end module dda_deck_key
