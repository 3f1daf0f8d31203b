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

   !> What kind of value a key takes
   type :: key_kind_enum
      integer :: number = 1   !! One real number
      integer :: whole = 2    !! One whole number
      integer :: word = 3     !! One of the words of the entry
      integer :: text = 4     !! Any text on one line
      integer :: flag = 5     !! .true. or .false.
      integer :: numbers = 6  !! A list of real numbers
      integer :: texts = 7    !! A list of words
   end type key_kind_enum

   !> The kinds of value by name
   type(key_kind_enum), parameter :: key_kind = key_kind_enum()

   !> One key of a deck
   type :: key_t
      character(len=16) :: group = ""          !! Group that the key belongs to
      character(len=name_length) :: name = ""  !! Name of the key
      integer :: kind = key_kind%number        !! One of key_kind
      character(len=8) :: unit = ""            !! Unit of the value; empty if it has none
      !> Default as one would write it in a deck; empty if there is none
      character(len=24) :: default = ""
      character(len=80) :: without = ""  !! What happens without the key where it has no default
      !> Smallest and largest value that is allowed: (2)
      real(wp) :: within(2) = [-huge(1.0_wp), huge(1.0_wp)]
      real(wp) :: above = -huge(1.0_wp)  !! Bound of these that the value must exceed
      real(wp) :: below = huge(1.0_wp)   !! Bound of these that the value must stay below
      character(len=72) :: words = ""    !! Words that are allowed, separated by blanks
      !> Whether &sweep may name the key; &search may, if it is also a real number
      logical :: varies = .true.
      !> Whether its name alone means it where groups share the name
      logical :: bare = .true.
      !> What it requires, separated by a comma and a blank: KEY = 'WORD' or 'WORD', KEY for one
      !> that must be given, no KEY for one that must not
      character(len=120) :: needs = ""
      real(wp) :: search_low = -huge(1.0_wp)  !! Lower end of a search that gives none
      real(wp) :: search_high = huge(1.0_wp)  !! Upper end of a search that gives none
      character(len=180) :: meaning = ""      !! What the key means, in one sentence
   end type key_t

   !> One group of a deck
   type :: group_t
      character(len=16) :: name = ""     !! Name of the group
      character(len=120) :: meaning = ""  !! What the group describes
   end type group_t

   !> Maximum length of words compared for suggestions [characters]
   integer, parameter :: longest = 40

contains

   !> Whether a number is one that a key takes
   elemental logical function in_range(key, number)
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: number  !! The number in the unit of the key

      in_range = number >= key%within(1) .and. number <= key%within(2) .and. number > key%above &
         & .and. number < key%below
      if (in_range .and. key%kind == key_kind%whole) &
         & in_range = .not. abs(number - anint(number)) > 0.0_wp
   end function in_range

   !> What a key takes: kind of value, unit and range
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
      character(len=:), allocatable :: text  !! The unit after a blank; empty if there is none

      text = ""
      if (len_trim(key%unit) > 0) text = " ["//trim(key%unit)//"]"
   end function unit_text

   !> Range of a number
   pure function range_text(key) result(text)
      type(key_t), intent(in) :: key
      !> The range after a blank, such as: from 0 to 90; empty if all numbers will do
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
      character(len=*), intent(in) :: words  !! Words parted by one blank
      character(len=:), allocatable :: text  !! Such as: 'stress', 'strain' or 'shear'
      character(len=word_length), allocatable :: list(:)
      integer :: i

      list = listed_words(words)
      text = "'"//trim(list(1))//"'"
      do i = 2, size(list)
         text = text//trim(merge(" or", ",  ", i == size(list)))//" '"//trim(list(i))//"'"
      end do
   end function quoted_words

   !> Words one by one
   pure function listed_words(words) result(list)
      character(len=*), intent(in) :: words               !! Words parted by one blank
      character(len=word_length), allocatable :: list(:)  !! The words: (n)
      integer :: i

      allocate (list(1 + count([(words(i:i) == " ", i=1, len_trim(words))])))
      read (words, *) list
   end function listed_words

   !> Whether a list of words holds a word, whatever its case
   pure logical function has_word(words, text)
      character(len=*), intent(in) :: words  !! Words parted by one blank
      character(len=*), intent(in) :: text   !! The word

      has_word = len_trim(text) > 0 .and. index(trim(text), " ") == 0
      if (has_word) has_word = index(" "//words//" ", " "//lower_case(trim(text))//" ") > 0
   end function has_word

   !> Name of a key with its group
   pure function full_name(key) result(name)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: name  !! Such as: arch%radius

      name = trim(key%group)//"%"//trim(key%name)
   end function full_name

   !> The group that was meant
   pure function near_group(name, groups, topic) result(text)
      character(len=*), intent(in) :: name    !! Name that is no group
      type(group_t), intent(in) :: groups(:)  !! Groups of the registry
      character(len=*), intent(in) :: topic   !! Page of the help that lists them
      character(len=:), allocatable :: text   !! Sentence that names the nearest group

      text = "the nearest known group is &"//nearest_word(name, groups%name)//"; 'dda help " &
         & //topic//"' lists all"
   end function near_group

   !> The key that was meant
   pure function near_key(name, group, keys, topic) result(text)
      character(len=*), intent(in) :: name   !! Name that is no key of the group
      character(len=*), intent(in) :: group  !! Name of the group; empty if any group will do
      type(key_t), intent(in) :: keys(:)     !! Keys of the registry
      character(len=*), intent(in) :: topic  !! Page of the help that lists them
      !> Sentence that names the group of that key, or the nearest key
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

   !> The word that was meant, of those that a key takes
   pure function near_word(key, text) result(near)
      type(key_t), intent(in) :: key
      character(len=*), intent(in) :: text  !! Word that the key does not take
      !> Words after a colon that name the nearest one; empty for a key that takes no words
      character(len=:), allocatable :: near

      near = ""
      if (len_trim(key%words) > 0) near = near_one(lower_case(trim(text)), listed_words(key%words))
   end function near_word

   !> A word of a list that is much like another
   pure function near_one(word, list) result(near)
      character(len=*), intent(in) :: word     !! Word that is not on the list
      character(len=*), intent(in) :: list(:)  !! Words to choose from: (n)
      !> Words after a colon that name it; empty if more than half of the letters differ
      character(len=:), allocatable :: near

      near = nearest_word(word, list)
      if (2*edit_distance(word, near) <= len(near) + 1) then
         near = ": did you mean '"//near//"'?"
      else
         near = ""
      end if
   end function near_one

   !> What a deck may do instead of giving a key a value that it can take
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

   !> Whether a deck that has the group needs the key, at least in some cases
   pure logical function is_required(key)
      type(key_t), intent(in) :: key

      is_required = index(key%without, "required") == 1
   end function is_required

   !> The word of a list that is nearest to a word, which may be the beginning of one
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

   !> Fewest letters to insert, delete or replace to turn one word into another (Levenshtein)
   pure integer function edit_distance(a, b)
      !> First word; only its beginning counts where it is very long
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
