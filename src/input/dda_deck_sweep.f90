!> Sweeps to cases: the last &sweep varies fastest, linked ones advance together; selection by
!> --cases
module dda_deck_sweep
   use dda_deck, only : deck_error, deck_sweep_t, deck_t, find_parameter, key_error, &
      & parameter_name, put_number, put_text
   use dda_deck_key, only : full_name, key_kind, key_t, wanted, word_length
   use dda_deck_keys, only : deck_key
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_key_names, only : sweep_count, sweep_first, sweep_last, sweep_linked, sweep_parameter, &
      & sweep_texts, sweep_values
   use dda_key_value, only : deck_place_t, default_value, is_numeric, number_fits, number_problem, &
      & text_problem
   use dda_kinds, only : wp
   use dda_text, only : lower_case, read_integer, to_text
   implicit none
   private

   public :: add_sweep, few_cases, max_sweeps, n_cases, swept_texts, turn_to_case
   public :: choose_cases

   !> Maximum number of &sweep groups
   integer, parameter :: max_sweeps = 8

   !> Number of cases up to which detail tables are written by default
   integer, parameter :: few_cases = 100

contains

   !> Add the keys of the last &sweep as the next sweep of the deck
   pure subroutine add_sweep(deck, place, error)
      !> The deck; the keys of &sweep are reset to their defaults
      type(deck_t), intent(inout) :: deck
      type(deck_place_t), intent(in) :: place  !! Place of the group
      !> Allocated for contradicting keys, or a value that the parameter cannot have
      type(error_t), allocatable, intent(out) :: error
      type(deck_sweep_t) :: sweep
      type(deck_sweep_t), allocatable :: longer(:)
      character(len=:), allocatable :: problem
      integer :: i

      sweep%place = place
      if (size(deck%sweeps) == max_sweeps) call deck_error(error, "expected at most " &
         & //to_text(max_sweeps)//" &sweep groups, got one more; split the deck", deck, place)
      if (allocated(error)) return
      if (.not. deck%value(sweep_parameter)%given) call deck_error(error, &
         & "expected sweep%parameter, the name of a key, got none; " &
         & //"give it, such as parameter = 'voussoirs'", deck, place)
      if (allocated(error)) return
      call find_parameter(deck%value(sweep_parameter)%text, sweep%parameter, problem)
      if (len(problem) > 0) call key_error(error, "sweep%parameter: "//problem, deck, &
         & sweep_parameter)
      if (allocated(error)) return
      sweep%name = parameter_name(sweep%parameter)
      sweep%linked = deck%value(sweep_linked)%flag
      call take_values(deck, sweep, error)
      if (.not. allocated(error)) call check_values(deck, sweep, error)
      if (allocated(error)) return
      ! gfortran loses the memory of values in an array constructor
      allocate (longer(size(deck%sweeps) + 1))
      longer(:size(deck%sweeps)) = deck%sweeps
      longer(size(longer)) = sweep
      call move_alloc(longer, deck%sweeps)
      do i = sweep_parameter, sweep_linked
         deck%value(i) = default_value(deck_key(i))
      end do
   end subroutine add_sweep

   !> Set the values of a sweep from exactly one of: values, texts, (first, last, count)
   pure subroutine take_values(deck, sweep, error)
      type(deck_t), intent(in) :: deck
      type(deck_sweep_t), intent(inout) :: sweep
      type(error_t), allocatable, intent(out) :: error
      logical :: has_values, has_texts, has_any, has_all
      character(len=26) :: found
      integer :: i, s

      has_values = deck%value(sweep_values)%given
      has_texts = deck%value(sweep_texts)%given
      has_any = deck%value(sweep_first)%given .or. deck%value(sweep_last)%given &
         & .or. deck%value(sweep_count)%given
      has_all = deck%value(sweep_first)%given .and. deck%value(sweep_last)%given &
         & .and. deck%value(sweep_count)%given
      if (count([has_values, has_texts, has_any]) /= 1 .or. (has_any .neqv. has_all)) then
         found = "more than one"
         if (has_any .and. .not. has_all) found = "one of these three missing"
         if (.not. any([has_values, has_texts, has_any])) found = "none"
         call deck_error(error, "expected exactly one of: values, texts, or first with last "// &
            "and count, got "//trim(found)//"; give one of them", deck, sweep%place)
         return
      end if
      allocate (sweep%numbers(0), sweep%texts(0))
      if (has_values) then
         i = sweep_values
         sweep%numbers = deck%value(i)%numbers
      else if (has_texts) then
         i = sweep_texts
         sweep%texts = deck%value(i)%texts
         do s = 1, size(sweep%texts)
            if (deck_key(sweep%parameter%key)%kind /= key_kind%text) &
               sweep%texts(s) = lower_case(sweep%texts(s))
         end do
      else
         i = sweep_first
         call space_evenly(deck, sweep, error)
      end if
      sweep%place = deck%value(i)%place
   end subroutine take_values

   !> Make equally spaced values from first to last
   pure subroutine space_evenly(deck, sweep, error)
      type(deck_t), intent(in) :: deck
      type(deck_sweep_t), intent(inout) :: sweep
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: first, last
      integer :: n, i

      first = deck%value(sweep_first)%number
      last = deck%value(sweep_last)%number
      n = nint(deck%value(sweep_count)%number)
      if (n == 1 .and. abs(last - first) > 0.0_wp) then
         call key_error(error, "sweep%count = 1 needs the same first and last, got "// &
            to_text(first)//" and "//to_text(last)//"; make them equal, or count larger", deck, &
            & sweep_count)
      else
         sweep%numbers = [(first + (last - first)*real(i - 1, wp)/real(max(n - 1, 1), wp), i=1, n)]
         sweep%numbers(n) = last
      end if
   end subroutine space_evenly

   !> Check that the parameter of a sweep can have all its values
   pure subroutine check_values(deck, sweep, error)
      type(deck_t), intent(in) :: deck
      type(deck_sweep_t), intent(in) :: sweep
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(key_t) :: key
      integer :: i
      character(len=*), parameter :: advice = "; change or remove that value of the sweep"

      problem = ""
      key = deck_key(sweep%parameter%key)
      if (is_numeric(key) .neqv. size(sweep%numbers) > 0) problem = "expected " &
         & //trim(merge("values, got texts", "texts, got values", is_numeric(key)))//": " &
         & //full_name(key)//" must be "//wanted(key)//"; write " &
         & //trim(merge("values", "texts ", is_numeric(key)))//" = ..."
      do i = 1, size(sweep%numbers)
         if (len(problem) == 0 .and. .not. number_fits(key, sweep%numbers(i))) &
            & problem = number_problem(key, sweep%numbers(i))//advice
      end do
      do i = 1, size(sweep%texts)
         if (len(problem) > 0) exit
         problem = text_problem(key, sweep%texts(i))
         if (len(problem) > 0) problem = problem//advice
      end do
      if (len(problem) > 0) call deck_error(error, problem, deck, sweep%place)
   end subroutine check_values

   !> Number of values of a sweep
   pure integer function n_values(sweep)
      type(deck_sweep_t), intent(in) :: sweep

      n_values = size(sweep%numbers) + size(sweep%texts)
   end function n_values

   !> Number of cases of a deck
   pure function n_cases(deck) result(n)
      type(deck_t), intent(in) :: deck
      !> Product over the sweeps that are not linked; 1 without a sweep; at most huge(1)
      integer :: n
      integer :: s

      n = 1
      do s = 1, size(deck%sweeps)
         if (deck%sweeps(s)%linked) cycle
         if (n > huge(1)/max(n_values(deck%sweeps(s)), 1)) then
            n = huge(1)
         else
            n = n*n_values(deck%sweeps(s))
         end if
      end do
   end function n_cases

   !> Index of the value of each sweep in a case
   pure function positions(deck, number) result(position)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number           !! Number of the case, from 1 to n_cases
      integer :: position(size(deck%sweeps))  !! Index of the value in each sweep: (n)
      integer :: s, rest

      rest = number - 1
      do s = size(deck%sweeps), 1, -1
         if (deck%sweeps(s)%linked) cycle
         position(s) = mod(rest, n_values(deck%sweeps(s))) + 1
         rest = rest/n_values(deck%sweeps(s))
      end do
      do s = 2, size(deck%sweeps)
         if (deck%sweeps(s)%linked) position(s) = position(s - 1)
      end do
   end function positions

   !> Set the swept values of a case in a deck
   pure subroutine put_case(swept, number, deck, error)
      type(deck_t), intent(in) :: swept  !! A deck with the sweeps
      integer, intent(in) :: number
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      integer :: position(size(swept%sweeps)), s

      position = positions(swept, number)
      do s = 1, size(swept%sweeps)
         associate (sweep => swept%sweeps(s))
            if (size(sweep%numbers) > 0) then
               call put_number(deck, sweep%parameter, sweep%numbers(position(s)), &
                  sweep%place, error)
            else
               call put_text(deck, sweep%parameter, sweep%texts(position(s)), sweep%place, error)
            end if
         end associate
         if (allocated(error)) return
      end do
   end subroutine put_case

   !> Change the deck of one case into that of another: the first time the whole deck is copied,
   !> later the swept values only
   pure subroutine turn_to_case(deck, number, result, error)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number
      !> Deck of a case without sweeps; new, or from an earlier call
      type(deck_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(result%value)) then
         result = deck
         deallocate (result%sweeps)
         allocate (result%sweeps(0))
      end if
      call put_case(deck, number, result, error)
   end subroutine turn_to_case

   !> Values of the swept parameters in a case, as text
   pure function swept_texts(deck, number) result(texts)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number  !! Number of the case
      !> One text per sweep; numbers read back as the same doubles: (n)
      character(len=word_length) :: texts(size(deck%sweeps))
      integer :: position(size(deck%sweeps)), s

      position = positions(deck, number)
      do s = 1, size(deck%sweeps)
         associate (sweep => deck%sweeps(s))
            if (size(sweep%numbers) > 0) then
               texts(s) = to_text(sweep%numbers(position(s)))
            else
               texts(s) = sweep%texts(position(s))
            end if
         end associate
      end do
   end function swept_texts

   !> Select cases by their numbers
   pure subroutine choose_cases(text, total, chosen, error)
      !> Numbers and ranges separated by commas, such as 1-500,812; empty for all cases
      character(len=*), intent(in) :: text
      integer, intent(in) :: total                    !! Number of cases of the deck
      logical, allocatable, intent(out) :: chosen(:)  !! True for selected cases: (total)
      !> Allocated for an invalid list, or a case that does not exist
      type(error_t), allocatable, intent(out) :: error
      integer :: first, comma, low, high
      logical :: ok

      allocate (chosen(total), source=text == "")
      if (text == "") return
      first = 1
      do while (first <= len(text) + 1)
         comma = index(text(first:)//",", ",")
         call read_range(text(first:first + comma - 2), low, high, ok)
         if (ok) ok = low >= 1 .and. low <= high .and. high <= total
         if (.not. ok) call fatal_error(error, "expected cases from 1 to "//to_text(total) &
            & //", got '"//shown(text(first:first + comma - 2))//"'; write them like 1-4,7", &
            & "--cases", 1)
         if (allocated(error)) return
         chosen(low:high) = .true.
         first = first + comma
      end do
   end subroutine choose_cases

   !> Read a number, or two numbers with a dash between them
   pure subroutine read_range(text, low, high, ok)
      character(len=*), intent(in) :: text
      integer, intent(out) :: low   !! First number
      integer, intent(out) :: high  !! Last number
      logical, intent(out) :: ok    !! True if the text is valid
      integer :: dash

      dash = index(text, "-")
      if (dash == 0) then
         call read_integer(text, low, ok)
         high = low
      else
         call read_integer(text(dash + 1:), high, ok)
         if (ok) call read_integer(text(:dash - 1), low, ok)
      end if
   end subroutine read_range
end module dda_deck_sweep
