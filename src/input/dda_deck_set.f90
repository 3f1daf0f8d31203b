!> Put values into a deck: each one is checked against the registry first
module dda_deck_set
   use dda_deck, only : deck_error, deck_t, parameter_t
   use dda_deck_key, only : in_range, key_kind
   use dda_deck_keys, only : deck_key, key_index
   use dda_deck_token, only : deck_scan_t, token_kind
   use dda_deck_values, only : name_values
   use dda_deck_words, only : full_name, or_leave_out
   use dda_error, only : error_t
   use dda_input, only : deck_place_t, input_value_t
   use dda_key_values, only : is_numeric, number_problem, read_flag, take_values, text_problem
   use dda_kinds, only : wp
   use dda_text, only : lower_case, to_text
   implicit none
   private

   public :: number_fits, put_number, put_text, read_values

contains

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
      type(input_value_t) :: value
      character(len=:), allocatable :: problem
      integer :: at

      call take_values(scan, first, last, deck_key(parameter%key), parameter%item > 0, value, at, &
         & problem)
      if (len(problem) > 0) then
         call deck_error(error, problem//or_leave_out(parameter%key), deck, &
            & place_at(scan, at, place))
         return
      end if
      select case (deck_key(parameter%key)%kind)
      case (key_kind%numbers)
         if (parameter%item > 0) then
            call put_number(deck, parameter, value%numbers(1), place, error)
         else
            call put_numbers(deck, parameter%key, value%numbers, place, error)
         end if
      case (key_kind%number, key_kind%whole)
         call put_number(deck, parameter, value%number, place_at(scan, first, place), error)
      case (key_kind%texts)
         deck%value(parameter%key)%texts = value%texts
         deck%value(parameter%key)%given = .true.
         deck%value(parameter%key)%place = place
      case default
         call put_text(deck, parameter, value%text, place_at(scan, first, place), error)
      end select
   end subroutine read_values

   !> Where a token stands
   pure type(deck_place_t) function place_at(scan, i, place)
      type(deck_scan_t), intent(in) :: scan
      !> Place of the token; past the end if there is none
      integer, intent(in) :: i
      !> Where its key stands
      type(deck_place_t), intent(in) :: place

      place_at = place
      if (place%from_command .or. i > scan%n) return
      if (scan%token(i)%kind == token_kind%key .or. scan%token(i)%kind == token_kind%close) return
      place_at%line = scan%token(i)%line
   end function place_at

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
            problem = number_problem(deck_key(parameter%key), value)//or_leave_out(parameter%key)
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
      call name_values(deck)
   end subroutine put_number

   !> Put a list of numbers into a key
   pure subroutine put_numbers(deck, key, values, place, error)
      type(deck_t), intent(inout) :: deck
      !> Place of the key in the registry
      integer, intent(in) :: key
      !> The numbers in the unit of the registry: (n)
      real(wp), intent(in) :: values(:)
      type(deck_place_t), intent(in) :: place
      !> One of them is out of range
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      integer :: i

      do i = 1, size(values)
         problem = number_problem(deck_key(key), values(i))
         if (len(problem) == 0) cycle
         call deck_error(error, problem//or_leave_out(key), deck, place)
         return
      end do
      deck%value(key)%numbers = values
      deck%value(key)%given = .true.
      deck%value(key)%place = place
      call follow_joints(deck)
      call name_values(deck)
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

      problem = text_problem(deck_key(parameter%key), text)
      if (len(problem) > 0) then
         call deck_error(error, problem//or_leave_out(parameter%key), deck, place)
         return
      end if
      associate (held => deck%value(parameter%key))
         select case (deck_key(parameter%key)%kind)
         case (key_kind%flag)
            call read_flag(text, held%flag)
         case (key_kind%word)
            held%text = lower_case(trim(text))
         case default
            held%text = trim(text)
         end select
         held%given = .true.
         held%place = place
      end associate
      call name_values(deck)
   end subroutine put_text

   !> Whether a number can be the value of a key
   pure logical function number_fits(key, value)
      !> Place of the key in the registry
      integer, intent(in) :: key
      !> The number in the unit of the registry
      real(wp), intent(in) :: value

      number_fits = is_numeric(deck_key(key)) .and. in_range(deck_key(key), value)
   end function number_fits

   !> Half angle and number of voussoirs follow joints_deg where they are not given
   pure subroutine follow_joints(deck)
      type(deck_t), intent(inout) :: deck
      integer :: n

      associate (joints => deck%value(key_index("arch", "joints_deg")), &
         angle => deck%value(key_index("arch", "half_angle_deg")), &
         voussoirs => deck%value(key_index("arch", "voussoirs")))
         n = size(joints%numbers)
         if (n == 0) return
         if (.not. angle%given) angle%number = joints%numbers(n)
         if (.not. voussoirs%given) voussoirs%number = real(2*(n - 1), wp)
      end associate
   end subroutine follow_joints
end module dda_deck_set
