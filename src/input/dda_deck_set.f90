!> Put values into a deck: each one is checked against the registry first
module dda_deck_set
   use dda_key_names, only : arch_half_angle_deg, arch_joints_deg, arch_voussoirs
   use dda_kinds, only : wp
   use dda_error, only : error_t
   use dda_text, only : to_text, lower_case
   use dda_deck_key, only : in_range, key_t, key_kind
   use dda_deck_keys, only : deck_key
   use dda_deck_words, only : wanted, quoted_words, full_name, near_word, or_leave_out
   use dda_deck_token, only : shown
   use dda_deck, only : deck_t, deck_place_t, parameter_t, deck_error
   implicit none
   private

   public :: put_number, put_numbers, put_text
   public :: number_problem, number_fits, text_problem, is_numeric

contains

   !> Put a number into a key or into one item of its list
   pure subroutine put_number(deck, parameter, value, place, error)
      type(deck_t), intent(inout) :: deck
      !> The key, with the item if it is a list
      type(parameter_t), intent(in) :: parameter
      !> The number in the unit of the registry
      real(wp), intent(in) :: value
      type(deck_place_t), intent(in) :: place
      !> Not a number's key, out of range, or an item that the list lacks
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      integer :: n

      associate (held => deck%value(parameter%key))
         n = 0
         if (allocated(held%numbers)) n = size(held%numbers)
         if (parameter%item > n) then
            problem = full_name(deck_key(parameter%key))//" has no item "// &
               to_text(parameter%item)//": its list has "//to_text(n)//"; write it in &"// &
               trim(deck_key(parameter%key)%group)
         else if (.not. number_fits(parameter%key, value)) then
            problem = number_problem(parameter%key, value)//or_leave_out(parameter%key)
         end if
         if (allocated(problem)) then
            call deck_error(error, problem, deck, place)
            return
         end if
         if (parameter%item > 0) then
            held%numbers(parameter%item) = value
         else
            held%number = value
         end if
         held%given = .true.
         held%place = place
      end associate
      if (parameter%item > 0) call follow_joints(deck)
   end subroutine put_number

   !> Put a list of numbers into a key
   pure subroutine put_numbers(deck, key, values, place, error)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: key         !! Place of the key in the registry
      real(wp), intent(in) :: values(:)  !! The numbers in the unit of the registry: (n)
      type(deck_place_t), intent(in) :: place
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      integer :: i

      do i = 1, size(values)
         problem = number_problem(key, values(i))
         if (len(problem) == 0) cycle
         call deck_error(error, problem//or_leave_out(key), deck, place)
         return
      end do
      deck%value(key)%numbers = values
      deck%value(key)%given = .true.
      deck%value(key)%place = place
      call follow_joints(deck)
   end subroutine put_numbers

   !> Put a text, a word or the text of a flag into a key
   pure subroutine put_text(deck, parameter, text, place, error)
      type(deck_t), intent(inout) :: deck
      type(parameter_t), intent(in) :: parameter
      !> The text
      character(len=*), intent(in) :: text
      type(deck_place_t), intent(in) :: place
      !> Not a text's key, or a word that it does not know
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      logical :: unused

      problem = text_problem(parameter%key, text)
      if (len(problem) > 0) then
         call deck_error(error, problem//or_leave_out(parameter%key), deck, place)
         return
      end if
      associate (held => deck%value(parameter%key))
         select case (deck_key(parameter%key)%kind)
         case (key_kind%flag)
            call read_flag(text, held%flag, unused)
         case (key_kind%word)
            held%text = lower_case(trim(text))
         case default
            held%text = trim(text)
         end select
         held%given = .true.
         held%place = place
      end associate
   end subroutine put_text

   !> Why a number cannot be the value of a key
   pure function number_problem(key, value) result(problem)
      integer, intent(in) :: key
      real(wp), intent(in) :: value
      !> What was wanted and what was found; empty if the number will do
      character(len=:), allocatable :: problem

      problem = ""
      if (number_fits(key, value)) return
      problem = full_name(deck_key(key))//" must be "//wanted(deck_key(key))//", got "// &
         to_text(value)
   end function number_problem

   !> Whether a number can be the value of a key
   pure logical function number_fits(key, value)
      integer, intent(in) :: key
      real(wp), intent(in) :: value

      number_fits = is_numeric(key)
      if (number_fits) number_fits = in_range(deck_key(key), value)
   end function number_fits

   !> Why a text cannot be the value of a key
   pure function text_problem(key, text) result(problem)
      integer, intent(in) :: key
      character(len=*), intent(in) :: text
      !> What was wanted and what was found; empty if the text will do
      character(len=:), allocatable :: problem
      type(key_t) :: entry
      logical :: fits, flag

      problem = ""
      entry = deck_key(key)
      select case (entry%kind)
      case (key_kind%word)
         fits = has_word(entry%words, text)
         if (has_word(entry%later, text)) problem = full_name(entry)//" = "// &
            quoted_words(lower_case(trim(text)))//" is not yet there: this version takes "// &
            quoted_words(entry%words)
      case (key_kind%flag)
         call read_flag(text, flag, fits)
      case default
         fits = entry%kind == key_kind%text
      end select
      if (.not. fits .and. len(problem) == 0) problem = full_name(entry)//" must be "// &
         wanted(entry)//", got '"//shown(trim(text))//"'"//near_word(entry, text)
   end function text_problem

   !> Whether a list of words holds a word, whatever its case
   pure logical function has_word(words, text)
      character(len=*), intent(in) :: words  !! Words parted by one blank
      character(len=*), intent(in) :: text   !! The word

      has_word = len_trim(text) > 0 .and. index(trim(text), " ") == 0
      if (has_word) has_word = index(" "//words//" ", " "//lower_case(trim(text))//" ") > 0
   end function has_word

   !> Read .true., .false., T, F and what is like them
   pure subroutine read_flag(text, flag, ok)
      character(len=*), intent(in) :: text
      logical, intent(inout) :: flag  !! The flag; left as it was if the text is none
      logical, intent(out) :: ok      !! Whether the text is a flag

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

   !> Whether a key takes numbers
   pure logical function is_numeric(key)
      integer, intent(in) :: key

      is_numeric = any(deck_key(key)%kind == [key_kind%number, key_kind%whole, key_kind%numbers])
   end function is_numeric

   !> Half angle and number of voussoirs follow joints_deg where they are not given
   pure subroutine follow_joints(deck)
      type(deck_t), intent(inout) :: deck
      integer :: n

      associate (joints => deck%value(arch_joints_deg), &
         angle => deck%value(arch_half_angle_deg), &
         voussoirs => deck%value(arch_voussoirs))
         n = size(joints%numbers)
         if (n == 0) return
         if (.not. angle%given) angle%number = joints%numbers(n)
         if (.not. voussoirs%given) voussoirs%number = real(2*(n - 1), wp)
      end associate
   end subroutine follow_joints
end module dda_deck_set
