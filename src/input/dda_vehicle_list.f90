!> Vehicles of a list, convoys, and axle loads per metre of depth by an effective width
module dda_vehicle_list
   use dda_deck, only : add_file_mark, deck_error, deck_t, file_beside, has_group, key_error, &
      & number_or, place_of
   use dda_deck_key, only : full_name
   use dda_deck_keys, only : deck_key
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_key_names, only : fill_group, fill_height, fill_spread, search_parameter, &
      & vehicle_axles, vehicle_convoy, vehicle_convoy_gap, vehicle_effective_width, &
      & vehicle_group, vehicle_length, vehicle_list, vehicle_name, vehicle_spacings, &
      & vehicle_track_width, vehicle_wheel_width
   use dda_key_value, only : deck_place_t
   use dda_kinds, only : wp
   use dda_read_record, only : column_of, field_of, find_line, n_columns, separator_of
   use dda_text, only : read_number, short_text, to_text
   use dda_text_file, only : read_text_file, text_mark
   implicit none
   private

   public :: effective_width, parse_vehicle, read_vehicle, vehicle_words

   !> Largest magnitude of a number of a list
   real(wp), parameter :: largest = 1.0e9_wp
   !> Newtons per kilonewton
   real(wp), parameter :: kilo = 1.0e3_wp

contains

   !> Replace the vehicle of a deck by its axles per metre of depth: those of a list, in a convoy,
   !> over an effective width
   subroutine read_vehicle(deck, error)
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error  !! Bad input, with file and line
      character(len=:), allocatable :: file, message, text

      if (.not. has_group(deck, vehicle_group)) return
      call check_varied(deck, error)
      if (allocated(error)) return
      if (deck%value(vehicle_list)%given) then
         file = file_beside(deck, deck%value(vehicle_list)%text)
         call read_text_file(file, text, error)
         if (allocated(error)) then
            message = "vehicle%list = '"//shown(deck%value(vehicle_list)%text)//"': "//error%message
            call key_error(error, message, deck, vehicle_list)
            return
         end if
         call add_file_mark(text_mark(text), deck)
         call parse_vehicle(text, file, deck, error)
         if (allocated(error)) return
      end if
      call form_convoy(deck)
      if (.not. is_converted(deck)) return
      associate (axle => deck%value(vehicle_axles)%numbers, &
         & width => deck%value(vehicle_effective_width))
         width%number = effective_width(deck)
         width%given = .true.
         axle = axle/width%number
      end associate
   end subroutine read_vehicle

   !> Check that no sweep or search varies a key that goes into the axle loads
   pure subroutine check_varied(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(deck_place_t) :: place
      integer :: key, s

      do s = 0, size(deck%sweeps)
         key = deck%searched%key
         place = place_of(deck, search_parameter)
         if (s > 0) then
            key = deck%sweeps(s)%parameter%key
            place = deck%sweeps(s)%place
         end if
         if (any(key == [vehicle_axles, vehicle_spacings]) .and. (is_converted(deck) &
            & .or. deck%value(vehicle_convoy)%given)) then
            call deck_error(error, full_name(deck_key(key))//" is varied beside a list, a "// &
               & "convoy or an effective width; write one deck per value", deck, place)
         else if (any(key == [fill_height, fill_spread]) .and. is_converted(deck) &
            & .and. .not. deck%value(vehicle_effective_width)%given) then
            call deck_error(error, full_name(deck_key(key))//" is varied, and changes "// &
               & "the effective width; give vehicle%effective_width", deck, place)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_varied

   !> True if axle loads are those of a whole vehicle [N], not yet per metre of depth
   pure logical function is_converted(deck)
      type(deck_t), intent(in) :: deck

      is_converted = any(deck%value([vehicle_list, vehicle_track_width, vehicle_wheel_width, &
         & vehicle_effective_width])%given)
   end function is_converted

   !> Width that carries the vehicle: given, or of both wheels, each spread by the fill to either
   !> side [m]
   pure real(wp) function effective_width(deck) result(width)
      type(deck_t), intent(in) :: deck
      real(wp) :: strip

      strip = deck%value(vehicle_wheel_width)%number
      if (has_group(deck, fill_group)) strip = strip + 2.0_wp*deck%value(fill_spread)%number &
         & *deck%value(fill_height)%number
      width = number_or(deck, vehicle_effective_width, &
         & strip + min(deck%value(vehicle_track_width)%number, strip))
   end function effective_width

   !> Vehicles of the deck one behind the other
   pure subroutine form_convoy(deck)
      type(deck_t), intent(inout) :: deck
      integer :: i, n

      n = nint(deck%value(vehicle_convoy)%number)
      associate (axle => deck%value(vehicle_axles), spacing => deck%value(vehicle_spacings), &
         & gap => deck%value(vehicle_convoy_gap)%number)
         axle%numbers = [(axle%numbers, i=1, n)]
         spacing%numbers = [spacing%numbers, (gap, spacing%numbers, i=2, n)]
         spacing%given = size(spacing%numbers) > 0
      end associate
   end subroutine form_convoy

   !> Take the vehicle of a deck from the text of its list
   pure subroutine parse_vehicle(text, file, deck, error)
      character(len=*), intent(in) :: text  !! Text of the list, lines ended by line feeds
      character(len=*), intent(in) :: file  !! Name that errors will show
      type(deck_t), intent(inout) :: deck
      !> Bad input, with file and line, or a name that the list does not have
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: header, line, names
      integer :: first, last, number, start

      header = ""
      names = ""
      number = 0
      start = 1
      do while (start <= len(text))
         call find_line(text, start, first, last, number)
         line = text(first:last)
         if (line == "") cycle
         if (header == "") then
            header = line
            call check_header(header, file, number, error)
            if (allocated(error)) return
         else if (cell(header, line, "name") == trim(deck%value(vehicle_name)%text)) then
            call take_row(header, line, deck, error)
            if (allocated(error)) error%file = file
            if (allocated(error)) error%line = number
            return
         else
            names = names//", "//cell(header, line, "name")
         end if
      end do
      call key_error(error, "expected a vehicle of "//file//", one of "//shown(names(3:)) &
         & //", got '"//shown(trim(deck%value(vehicle_name)%text))//"'", deck, vehicle_name)
   end subroutine parse_vehicle

   !> Check that a list has the columns that it needs
   pure subroutine check_header(header, file, number, error)
      character(len=*), intent(in) :: header  !! Its first line
      character(len=*), intent(in) :: file
      integer, intent(in) :: number           !! Number of that line
      type(error_t), allocatable, intent(out) :: error
      character(len=10), parameter :: needed(3) = ["name      ", "axles_kN  ", "spacings_m"]
      integer :: i

      do i = 1, size(needed)
         if (column_of(header, needed(i), separator_of(header)) == 0) then
            call fatal_error(error, "expected the columns name, axles_kN, spacings_m, got none "// &
               & "named "//trim(needed(i)), file, number)
            return
         end if
      end do
   end subroutine check_header

   !> Take axles, spacings and sizes of a row; keys of the deck take precedence over its sizes
   pure subroutine take_row(header, line, deck, error)
      character(len=*), intent(in) :: header
      character(len=*), intent(in) :: line  !! The row
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=13), parameter :: sizes(3) = &
         & ["track_m      ", "wheel_width_m", "length_m     "]
      integer, parameter :: keys(3) = [vehicle_track_width, vehicle_wheel_width, vehicle_length]
      real(wp), allocatable :: axle(:), spacing(:), given(:)
      integer :: i

      call read_numbers(header, line, "axles_kN", axle, error)
      if (.not. allocated(error)) call read_numbers(header, line, "spacings_m", spacing, error)
      if (allocated(error)) return
      if (size(axle) == 0 .or. size(spacing) /= size(axle) - 1) then
         call fatal_error(error, "expected one spacing fewer than axles, got " &
            & //to_text(size(axle))//" axles and "//to_text(size(spacing))//" spacings")
         return
      end if
      deck%value(vehicle_axles)%numbers = kilo*axle
      deck%value(vehicle_axles)%given = .true.
      deck%value(vehicle_spacings)%numbers = spacing
      do i = 1, size(keys)
         call read_numbers(header, line, trim(sizes(i)), given, error)
         if (allocated(error)) return
         if (size(given) == 0 .or. deck%value(keys(i))%given) cycle
         if (size(given) > 1) call fatal_error(error, "expected one number as "//trim(sizes(i)) &
            & //", got "//to_text(size(given)))
         if (allocated(error)) return
         deck%value(keys(i))%number = given(1)
         deck%value(keys(i))%given = .true.
      end do
   end subroutine take_row

   !> Numbers above 0 of a cell, separated by blanks
   pure subroutine read_numbers(header, line, name, numbers, error)
      character(len=*), intent(in) :: header
      character(len=*), intent(in) :: line
      character(len=*), intent(in) :: name              !! Name of the column
      real(wp), allocatable, intent(out) :: numbers(:)  !! The numbers: (n)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      integer :: i
      logical :: ok

      text = cell(header, line, name)
      allocate (numbers(n_columns(text, " ")))
      do i = 1, size(numbers)
         call read_number(field_of(text, i, " "), numbers(i), ok)
         if (ok) ok = numbers(i) > 0.0_wp .and. numbers(i) < largest
         if (ok) cycle
         call fatal_error(error, "expected numbers above 0 as "//name//", got '" &
            & //shown(field_of(text, i, " "))//"'")
         return
      end do
   end subroutine read_numbers

   !> Text of a row in a column; empty where there is none
   pure function cell(header, line, name) result(text)
      character(len=*), intent(in) :: header
      character(len=*), intent(in) :: line
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: text
      integer :: column

      text = ""
      column = column_of(header, name, separator_of(header))
      if (column > 0) text = field_of(line, column, separator_of(header))
   end function cell

   !> The vehicle of a deck in words, with three digits; empty where it has no effective width
   pure function vehicle_words(deck) result(words)
      type(deck_t), intent(in) :: deck  !! The deck, read
      character(len=:), allocatable :: words
      real(wp) :: load

      words = ""
      if (.not. deck%value(vehicle_effective_width)%given) return
      load = sum(deck%value(vehicle_axles)%numbers)/kilo
      if (deck%value(vehicle_name)%given) words = trim(deck%value(vehicle_name)%text)//", "
      if (nint(deck%value(vehicle_convoy)%number) > 1) words = &
         & to_text(nint(deck%value(vehicle_convoy)%number))//" x "//words
      associate (width => deck%value(vehicle_effective_width)%number)
         words = words//short_text(rounded(load*width))//" kN over an effective width of " &
            & //short_text(rounded(width))//" m: "//short_text(rounded(load)) &
            & //" kN per metre of depth"
      end associate
   end function vehicle_words

   !> A positive number in three significant digits
   pure elemental real(wp) function rounded(value)
      real(wp), intent(in) :: value  !! The number
      integer :: power

      power = 2 - floor(log10(value))
      rounded = anint(value*10.0_wp**power)/10.0_wp**power
   end function rounded
end module dda_vehicle_list
