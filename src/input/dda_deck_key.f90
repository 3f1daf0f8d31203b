!> What the registry says of a key and of a group
module dda_deck_key
   use dda_kinds, only : wp
   implicit none
   private

   public :: key_t, key_kind, group_t, in_range, name_length, word_length, max_items

   !> Longest name of a key [characters]
   integer, parameter :: name_length = 32
   !> Longest word of a list of words [characters]
   integer, parameter :: word_length = 64
   !> Most items that a list may have
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
      integer :: later = 8    !! Known, but refused: a later version of the program reads it
   end type key_kind_enum

   !> The kinds of value by name
   type(key_kind_enum), parameter :: key_kind = key_kind_enum()

   !> One key of a deck
   type :: key_t
      !> Group that the key belongs to
      character(len=16) :: group = ""
      !> Name of the key
      character(len=name_length) :: name = ""
      !> One of key_kind
      integer :: kind = key_kind%number
      !> Unit of the value; empty if it has none
      character(len=8) :: unit = ""
      !> Default as one would write it in a deck; empty if there is none
      character(len=24) :: default = ""
      !> What happens without the key where it has no default
      character(len=56) :: without = ""
      !> Smallest and largest value that is allowed: (2)
      real(wp) :: within(2) = [-huge(1.0_wp), huge(1.0_wp)]
      !> Bound of these that the value must exceed
      real(wp) :: above = -huge(1.0_wp)
      !> Bound of these that the value must stay below
      real(wp) :: below = huge(1.0_wp)
      !> Words that are allowed, separated by blanks
      character(len=72) :: words = ""
      !> Words that a later version of the program allows, separated by blanks
      character(len=40) :: later = ""
      !> Whether &sweep may name the key; &search may, if it is also a real number
      logical :: varies = .true.
      !> Whether its name alone means it where groups share the name
      logical :: bare = .true.
      !> Lower end of a search that gives none
      real(wp) :: search_low = -huge(1.0_wp)
      !> Upper end of a search that gives none
      real(wp) :: search_high = huge(1.0_wp)
      !> What the key means, in one sentence
      character(len=100) :: meaning = ""
   end type key_t

   !> One group of a deck
   type :: group_t
      character(len=16) :: name = ""     !! Name of the group
      character(len=72) :: meaning = ""  !! What the group describes
   end type group_t
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
end module dda_deck_key
