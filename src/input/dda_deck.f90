!> A deck in memory: a value for every key of the registry, and where each one came from
module dda_deck
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use dda_arch_keys, only : shape_keys
   use dda_block_input, only : block_plan_t, new_plan
   use dda_boundary, only : history_t
   use dda_cut_model, only : cut_model_t
   use dda_kinds, only : wp
   use dda_error, only : error_t, fatal_error
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_text, only : lower_case, read_number
   use dda_warnings, only : warnings_t
   use dda_deck_key, only : key_kind, word_length
   use dda_deck_keys, only : deck_key, deck_group, key_index, group_index
   implicit none
   private

   public :: deck_t, deck_value_t, deck_sweep_t, deck_place_t, parameter_t, new_deck
   public :: ground_record_t
   public :: real_of, integer_of, word_of, text_of, flag_of, list_of
   public :: geometry_of, is_given, has_group, keeps_velocities, line_of, place_of, deck_error
   public :: scene_kind
   public :: add_file_mark, file_beside

   !> Where a value was written
   type :: deck_place_t
      !> Line of the deck, or number of the --set; 0 for a default
      integer :: line = 0
      !> Whether it came from a --set
      logical :: from_command = .false.
   end type deck_place_t

   !> A key, or one item of its list
   type :: parameter_t
      !> Place in the registry
      integer :: key = 0
      !> Item of a list, counted from 1; 0 for a single value
      integer :: item = 0
   end type parameter_t

   !> Value of one key
   type :: deck_value_t
      !> Whether the deck, a --set or a sweep gives it
      logical :: given = .false.
      !> Where
      type(deck_place_t) :: place
      !> Number, whole numbers too
      real(wp) :: number = 0.0_wp
      !> Flag
      logical :: flag = .false.
      !> Text, words too; unallocated where the key takes none
      character(len=:), allocatable :: text
      !> List of numbers; unallocated where the key takes none: (n)
      real(wp), allocatable :: numbers(:)
      !> List of words; unallocated where the key takes none: (n)
      character(len=word_length), allocatable :: texts(:)
   end type deck_value_t

   !> One &sweep
   type :: deck_sweep_t
      !> What it varies
      type(parameter_t) :: parameter
      !> Where the values were written
      type(deck_place_t) :: place
      !> Whether it advances together with the sweep before it
      logical :: linked = .false.
      !> Numbers that the parameter takes; empty if it takes words: (n)
      real(wp), allocatable :: numbers(:)
      !> Words that the parameter takes; empty if it takes numbers: (n)
      character(len=word_length), allocatable :: texts(:)
   end type deck_sweep_t

   !> A record of the ground's motion that the deck names
   type :: ground_record_t
      !> Its name in the deck
      character(len=:), allocatable :: name
      !> The motion as the file has it
      type(history_t) :: motion
   end type ground_record_t

   !> A deck
   type :: deck_t
      !> Name of the file
      character(len=:), allocatable :: file
      !> Values, in the order of the registry: (0:n), 0 stands for a key that does not exist
      type(deck_value_t), allocatable :: value(:)
      !> Where each group begins, line 0 if it is not there: (n)
      type(deck_place_t), allocatable :: group(:)
      !> The sweeps in their order: (n)
      type(deck_sweep_t), allocatable :: sweep(:)
      !> Blocks cut from the file that scene%geometry names; allocated for kind = 'lines' alone
      type(cut_model_t), allocatable :: cut
      !> What the file that scene%analysis names says; unallocated if none is named
      type(limerick_analysis_t), allocatable :: analysis
      !> Lengths and check sums of all files that the deck names, each with a blank before it, for a
      !> record of the deck; unallocated without files
      character(len=:), allocatable :: file_marks
      !> What those files hold that is not read
      type(warnings_t) :: warnings
      !> The blocks of that file
      type(block_plan_t) :: plan
      !> Records of the ground's motion; unallocated if none is named: (n)
      type(ground_record_t), allocatable :: ground_record(:)
   end type deck_t

contains

   !> A deck of defaults
   pure subroutine new_deck(deck, file)
      type(deck_t), intent(out) :: deck
      !> Name that errors will show
      character(len=*), intent(in) :: file
      integer :: i

      deck%file = file
      call new_plan(deck%plan)
      allocate (deck%value(0:size(deck_key)), deck%group(size(deck_group)), deck%sweep(0))
      deck%value(0)%number = ieee_value(1.0_wp, ieee_quiet_nan)
      do i = 0, size(deck_key)
         call put_default(deck%value(i), i)
      end do
   end subroutine new_deck

   !> Give a value its default
   pure subroutine put_default(value, i)
      type(deck_value_t), intent(inout) :: value
      !> Place of its key in the registry
      integer, intent(in) :: i
      character(len=:), allocatable :: default
      logical :: ok

      if (i == 0) return
      default = trim(deck_key(i)%default)
      select case (deck_key(i)%kind)
      case (key_kind%number, key_kind%whole)
         call read_number(default, value%number, ok)
      case (key_kind%word, key_kind%text)
         value%text = ""
         if (len(default) > 2) value%text = default(2:len(default) - 1)
      case (key_kind%flag)
         value%flag = default == ".true."
      case (key_kind%numbers)
         allocate (value%numbers(0))
      case (key_kind%texts)
         allocate (value%texts(0))
      end select
   end subroutine put_default

   !> A number of the deck
   pure function real_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The number in the unit of the registry; 0 without value and default, NaN for no such key
      real(wp) :: value

      value = deck%value(key_index(group, key))%number
   end function real_of

   !> A whole number of the deck
   pure function integer_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The number; 0 without value and default
      integer :: value

      value = nint(deck%value(key_index(group, key))%number)
   end function integer_of

   !> A word of the deck
   pure function word_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The word, lower case; of fixed length, for gfortran keeps the length of a result that has
      !> none in memory that threads share
      character(len=word_length) :: value

      associate (held => deck%value(key_index(group, key)))
         value = ""
         if (allocated(held%text)) value = held%text
      end associate
   end function word_of

   !> A text of the deck
   pure function text_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The text as it was written, blanks at its end cut
      character(len=:), allocatable :: value

      associate (held => deck%value(key_index(group, key)))
         value = ""
         if (allocated(held%text)) value = held%text
      end associate
   end function text_of

   !> A flag of the deck
   pure function flag_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The flag
      logical :: value

      value = deck%value(key_index(group, key))%flag
   end function flag_of

   !> A list of numbers of the deck
   pure function list_of(deck, group, key) result(value)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The numbers in the unit of the registry; none if the key is not given: (n)
      real(wp), allocatable :: value(:)

      associate (held => deck%value(key_index(group, key)))
         allocate (value(0))
         if (allocated(held%numbers)) value = held%numbers
      end associate
   end function list_of

   !> Whether the deck, a --set or a sweep gives a key
   pure function is_given(deck, group, key) result(given)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> The answer; no for a key that follows from others
      logical :: given

      given = deck%value(key_index(group, key))%given
   end function is_given

   !> Whether a group is there: in the deck, or because a --set names one of its keys
   pure function has_group(deck, group) result(yes)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> The answer
      logical :: yes
      integer :: i

      i = group_index(group)
      yes = .false.
      if (i > 0) yes = deck%group(i)%line > 0
   end function has_group

   !> Whether velocities are kept from step to step: asked by the mode, and in that of the original
   !> by its key, or else by the analysis file
   pure function keeps_velocities(deck) result(yes)
      !> The deck of a case
      type(deck_t), intent(in) :: deck
      !> The answer
      logical :: yes

      yes = word_of(deck, "analysis", "mode") == "dynamic"
      if (word_of(deck, "analysis", "mode") /= "limerick") return
      yes = flag_of(deck, "limerick", "dynamic")
      if (allocated(deck%analysis) .and. .not. is_given(deck, "limerick", "dynamic")) &
         & yes = deck%analysis%dynamic
   end function keeps_velocities

   !> What the blocks of a case are made from, the word of scene%kind: but for arches that are more
   !> than a circular ring of voussoirs, which are a shape
   pure function scene_kind(deck) result(kind)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> arch, shape, lines or blocks
      character(len=word_length) :: kind
      character(len=word_length) :: name
      integer :: first, last
      logical :: shaped

      kind = word_of(deck, "scene", "kind")
      if (kind /= "arch") return
      first = key_index("arch", "shape")
      last = key_index("arch", "lune_deg")
      shaped = any(deck%value(first + 1:last)%given) .or. has_group(deck, "fill") &
         & .or. has_group(deck, "tie") .or. is_given(deck, "material", "compressive_strength") &
         & .or. word_of(deck, "arch", "shape") /= "circular"
      if (.not. shaped .and. has_group(deck, "search")) then
         ! of fixed length, as in word_of
         name = lower_case(word_of(deck, "search", "parameter"))
         name = name(index(name, "%") + 1:)
         shaped = any(name == shape_keys) .or. name == "compressive_strength"
      end if
      if (shaped) kind = "shape"
   end function scene_kind

   !> Geometry of a case; in the mode of the original blocks always move
   pure function geometry_of(deck) result(word)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> reference or current
      character(len=word_length) :: word

      word = word_of(deck, "analysis", "geometry")
      if (word_of(deck, "analysis", "mode") == "limerick" &
         & .and. .not. is_given(deck, "analysis", "geometry")) word = "current"
   end function geometry_of

   !> Line where a key was given
   pure function line_of(deck, group, key) result(line)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=*), intent(in) :: group
      !> Name of the key
      character(len=*), intent(in) :: key
      !> Line of the deck, or number of the --set; 0 for a default
      integer :: line

      line = deck%value(key_index(group, key))%place%line
   end function line_of

   !> Where a key was given, or else its group
   pure function place_of(deck, key) result(place)
      type(deck_t), intent(in) :: deck
      !> Place of the key in the registry
      integer, intent(in) :: key
      !> The place; line 0 if neither was given
      type(deck_place_t) :: place

      place = deck%value(key)%place
      if (place%line == 0) place = deck%group(group_index(deck_key(key)%group))
   end function place_of

   !> Make an error that names the deck and the line, or --set and its number
   pure subroutine deck_error(error, message, deck, place)
      type(error_t), allocatable, intent(out) :: error
      !> What was wanted and what was found
      character(len=*), intent(in) :: message
      type(deck_t), intent(in) :: deck
      !> Where it was found
      type(deck_place_t), intent(in) :: place

      if (place%from_command) then
         call fatal_error(error, message, file="--set", line=place%line)
      else
         call fatal_error(error, message, file=deck%file, line=max(place%line, 1))
      end if
   end subroutine deck_error

   !> Remember what a file that a deck names holds
   pure subroutine add_file_mark(mark, deck)
      !> Mark of the file
      character(len=*), intent(in) :: mark
      type(deck_t), intent(inout) :: deck

      if (.not. allocated(deck%file_marks)) deck%file_marks = ""
      deck%file_marks = deck%file_marks//" "//mark
   end subroutine add_file_mark

   !> Name of a file that a deck names: beside the deck unless it begins with a slash
   pure function file_beside(deck, name) result(path)
      type(deck_t), intent(in) :: deck
      !> The name in the deck
      character(len=*), intent(in) :: name
      !> The name for all
      character(len=:), allocatable :: path

      path = name
      if (index(path, "/") /= 1) path = deck%file(:index(deck%file, "/", back=.true.))//path
   end function file_beside
end module dda_deck
