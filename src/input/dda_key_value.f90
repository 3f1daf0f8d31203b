!> Values of keys: defaults, numbers and texts
module dda_key_value
   use dda_deck_key, only : full_name, has_word, in_range, key_kind, key_t, near_word, &
      & or_leave_out, wanted, word_length
   use dda_deck_token, only : shown
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_number, short_text, to_text
   implicit none
   private

   public :: deck_place_t, deck_value_t, default_value, is_numeric, number_fits, number_problem
   public :: set_number, set_text, text_problem

   !> Place of a value
   type :: deck_place_t
      integer :: line = 0  !! Line of the deck, or number of the --set; 0 for a default
      logical :: from_command = .false.  !! True for a --set
   end type deck_place_t

   !> Value of a key
   type :: deck_value_t
      logical :: given = .false.             !! True if it is given in the deck, a --set or a sweep
      type(deck_place_t) :: place            !! Place of the value
      real(wp) :: number = 0.0_wp            !! Number, also for integers
      logical :: flag = .false.              !! Flag
      character(len=:), allocatable :: text  !! Text or word; unallocated for other kinds
      real(wp), allocatable :: numbers(:)    !! List of numbers; unallocated for other kinds: (n)
      !> List of words; unallocated for other kinds: (n)
      character(len=word_length), allocatable :: texts(:)
   end type deck_value_t

contains

   !> Default of a key
   pure type(deck_value_t) function default_value(key) result(value)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: default
      logical :: ok

      default = trim(key%default)
      select case (key%kind)
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
   end function default_value

   !> Set a key, or one item of its list, to a number
   pure subroutine set_number(value, key, item, number, problem)
      type(deck_value_t), intent(inout) :: value  !! The value; unchanged if there is a problem
      type(key_t), intent(in) :: key
      integer, intent(in) :: item     !! Item of a list; 0 for a single number
      real(wp), intent(in) :: number  !! The number in the unit of the registry
      !> The problem and its remedy; empty if there is none
      character(len=:), allocatable, intent(out) :: problem
      integer :: n

      problem = ""
      n = 0
      if (allocated(value%numbers)) n = size(value%numbers)
      if (item > n) then
         problem = full_name(key)//" has no item "//to_text(item)//": its list has " &
            & //to_text(n)//"; write it in &"//trim(key%group)
      else if (.not. number_fits(key, number)) then
         problem = number_problem(key, number)//or_leave_out(key)
      else if (item > 0) then
         value%numbers(item) = number
         value%given = .true.
      else
         value%number = number
         value%given = .true.
      end if
   end subroutine set_number

   !> Set a key to a text, a word or a flag
   pure subroutine set_text(value, key, text, problem)
      type(deck_value_t), intent(inout) :: value  !! The value; unchanged if there is a problem
      type(key_t), intent(in) :: key
      character(len=*), intent(in) :: text        !! The value, without quotes
      !> The problem and its remedy; empty if there is none
      character(len=:), allocatable, intent(out) :: problem
      logical :: unused

      problem = text_problem(key, text)
      if (len(problem) > 0) problem = problem//or_leave_out(key)
      if (len(problem) > 0) return
      value%given = .true.
      select case (key%kind)
      case (key_kind%flag)
         call read_flag(text, value%flag, unused)
      case (key_kind%word)
         value%text = lower_case(trim(text))
      case default
         value%text = trim(text)
      end select
   end subroutine set_text

   !> Problem of a number as the value of a key
   pure function number_problem(key, number) result(problem)
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: number  !! The number in the unit of the registry
      !> Expected and actual value; empty if there is no problem
      character(len=:), allocatable :: problem

      problem = ""
      if (number_fits(key, number)) return
      problem = full_name(key)//" must be "//wanted(key)//", got "//short_text(number)
   end function number_problem

   !> True if a number is a valid value of a key
   pure logical function number_fits(key, number)
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: number

      number_fits = is_numeric(key)
      if (number_fits) number_fits = in_range(key, number)
   end function number_fits

   !> Problem of a text as the value of a key
   pure function text_problem(key, text) result(problem)
      type(key_t), intent(in) :: key
      character(len=*), intent(in) :: text
      !> Expected and actual value; empty if there is no problem
      character(len=:), allocatable :: problem
      logical :: fits, flag

      problem = ""
      select case (key%kind)
      case (key_kind%word)
         fits = has_word(key%words, text)
      case (key_kind%flag)
         call read_flag(text, flag, fits)
      case default
         fits = key%kind == key_kind%text
      end select
      if (.not. fits) problem = full_name(key)//" must be "// &
         wanted(key)//", got '"//shown(trim(text))//"'"//near_word(key, text)
   end function text_problem

   !> Read .true., .false., T, F and similar words
   pure subroutine read_flag(text, flag, ok)
      character(len=*), intent(in) :: text
      logical, intent(inout) :: flag  !! The flag; unchanged if the text is none
      logical, intent(out) :: ok      !! True if the text is a flag

      ok = .true.
      select case (lower_case(text))
      case (".true.", "true", "t", ".t.")
         flag = .true.
      case (".false.", "false", "f", ".f.")
         flag = .false.
      case default
         ok = .false.
      end select
   end subroutine read_flag

   !> True if a key takes numbers
   pure logical function is_numeric(key)
      type(key_t), intent(in) :: key

      is_numeric = any(key%kind == [key_kind%number, key_kind%whole, key_kind%numbers])
   end function is_numeric
end module dda_key_value
