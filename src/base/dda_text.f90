!> Numbers to text, text to numbers, string functions, text built line by line
module dda_text
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: to_text, short_text, place_text, raised_text, counted, print_number, lower_case
   public :: read_number, read_integer, growing_text_t, add_line, bytes_of, fields, lines_of

   !> Shortest text that reads back as the same number
   interface to_text
      module procedure real_to_text
      module procedure integer_to_text
   end interface to_text

   !> Formats of 15, 16 and 17 significant digits
   character(len=11), parameter :: scientific_form(15:17) = &
      & ["(es24.14e3)", "(es24.15e3)", "(es24.16e3)"]

   !> Length that fits every number
   integer, parameter :: longest = 32

   !> Round-off of a product with a power of ten, over the 17th digit
   real(wp), parameter :: rounding = 1.0e-6_wp

   interface

      !> Read one decimal number below 1e308 from a text that has nothing else
      pure module subroutine read_number(text, value, ok)
         character(len=*), intent(in) :: text  !! Text such as -1.5e-3 or 1d3
         real(wp), intent(out) :: value        !! The number; 0 if ok is false
         logical, intent(out) :: ok            !! True if the whole text is one such number
      end subroutine read_number

      !> Read one integer from a text that has nothing else
      pure module subroutine read_integer(text, value, ok)
         character(len=*), intent(in) :: text  !! Text such as -12
         integer, intent(out) :: value         !! The number; 0 if ok is false
         logical, intent(out) :: ok            !! True if the whole text is one integer in range
      end subroutine read_integer

      !> A number for messages: at most six significant digits, exponential form from one million on
      pure module function short_text(value) result(text)
         real(wp), intent(in) :: value          !! Number to write
         character(len=:), allocatable :: text  !! Text without blanks, such as -1e12 or 0.107426
      end function short_text

      !> A point for messages: coordinates of six significant digits, or to the millimetre if that
      !> is finer
      pure module function place_text(place) result(text)
         real(wp), intent(in) :: place(2)       !! Its coordinates: (2) [m]
         character(len=:), allocatable :: text  !! Text such as (1.5, -2)
      end function place_text

      !> A positive number with at most three significant digits, rounded up: an upper bound
      pure module function raised_text(value) result(text)
         real(wp), intent(in) :: value          !! Number to write
         character(len=:), allocatable :: text  !! Text without blanks
      end function raised_text

      !> A number with its noun, in the plural for all numbers except one
      pure module function counted(number, thing) result(text)
         integer, intent(in) :: number          !! The number
         character(len=*), intent(in) :: thing  !! The noun, with a plural in s
         character(len=:), allocatable :: text
      end function counted

   end interface

   !> A text built line by line
   type :: growing_text_t
      private
      character(len=:), allocatable :: text  !! The lines with their ends, and spare room
      integer :: length = 0                  !! Length of the lines
   end type growing_text_t

contains

   !> Shortest decimal text that reads back as the same double
   pure function real_to_text(value) result(text)
      real(wp), intent(in) :: value          !! Number to write
      character(len=:), allocatable :: text  !! Text without blanks
      character(len=longest) :: buffer
      integer :: n

      call print_number(value, buffer, n)
      text = buffer(:n)
   end function real_to_text

   !> Write the shortest decimal text that reads back as the same double
   pure subroutine print_number(value, text, n)
      real(wp), intent(in) :: value
      character(len=longest), intent(out) :: text  !! Receives the number, left-aligned
      integer, intent(out) :: n                    !! Its length
      character(len=24) :: buffer
      integer(int64) :: digits
      integer :: exponent
      real(wp) :: beyond, doubt
      logical :: known

      if (.not. ieee_is_finite(value)) then
         text = merge("Infinity ", "-Infinity", sign(1.0_wp, value) > 0.0_wp)
         if (ieee_is_nan(value)) text = "NaN"
         n = len_trim(text)
         return
      end if
      known = abs(value) < 1.0e15_wp
      if (known) known = .not. abs(value - aint(value)) > 0.0_wp
      if (known) then
         digits = int(abs(value), int64)
         exponent = count_digits(digits) - 1
      else
         call scale(abs(value), digits, exponent, beyond, known)
         doubt = rounding
         if (.not. known) then
            write (buffer, scientific_form(17)) value
            call take_digits(buffer, digits, exponent)
            beyond = 0.0_wp
            doubt = 0.5_wp
         end if
         call shorten(value, beyond, doubt, digits, exponent, known)
         if (.not. known) call try_forms(value, digits, exponent)
      end if
      n = merge(1, 0, sign(1.0_wp, value) < 0.0_wp)
      text(:n) = "-"
      call put_plain(digits, exponent, text, n)
   end subroutine print_number

   !> Compute the 17 digits of a number of common size. A power of ten up to the 22nd is a double,
   !> up to the 44th the sum of two doubles, and so is the product of two doubles
   pure subroutine scale(value, digits, exponent, beyond, known)
      real(wp), intent(in) :: value          !! The number, positive
      integer(int64), intent(out) :: digits  !! Its digits, rounded, as an integer
      integer, intent(out) :: exponent       !! Power of ten of the first digit
      real(wp), intent(out) :: beyond        !! Rounding error of the digits
      logical, intent(out) :: known          !! True if the digits were found
      real(wp) :: high, low, product, rest
      integer :: k
      real(wp), parameter :: power(0:22) = [(10.0_wp**k, k=0, 22)]

      digits = 0
      beyond = 0.0_wp
      exponent = floor(log10(max(value, tiny(value))))
      known = exponent <= 16 .and. exponent >= 16 - 44
      if (.not. known) return
      high = power(min(16 - exponent, 22))
      low = 0.0_wp
      if (16 - exponent > 22) call exact_product(1.0e22_wp, power(-6 - exponent), high, low)
      call exact_product(value, high, product, rest)
      rest = rest + value*low
      ! above 2**53 the product is an integer; its rounding error decides the last digit, except in
      ! a tie
      known = product > 1.0e16_wp .and. product < 0.9999e17_wp &
         & .and. abs(rest - anint(rest)) < 0.5_wp - rounding
      if (.not. known) return
      digits = int(product, int64) + nint(rest, int64)
      beyond = rest - anint(rest)
   end subroutine scale

   !> Product of two doubles as the sum of two (Dekker 1971)
   pure subroutine exact_product(a, b, product, rest)
      real(wp), intent(in) :: a         !! First factor
      real(wp), intent(in) :: b         !! Second factor
      real(wp), intent(out) :: product  !! The product, rounded
      real(wp), intent(out) :: rest     !! Rounding error of the product
      real(wp) :: high(2), low(2)

      ! split into two halves of the digits; the halves add up to the number
      high = 134217729.0_wp*[a, b]
      high = high - (high - [a, b])
      low = [a, b] - high
      product = a*b
      rest = ((high(1)*high(2) - product) + high(1)*low(2) + low(1)*high(2)) + low(1)*low(2)
   end subroutine exact_product

   !> Remove trailing digits of 17 that are not needed to read the number back
   pure subroutine shorten(value, beyond, doubt, digits, exponent, known)
      real(wp), intent(in) :: value, beyond
      real(wp), intent(in) :: doubt            !! Bound on the error of beyond
      integer(int64), intent(inout) :: digits  !! 17 digits on entry, the shorter ones on return
      integer, intent(in) :: exponent
      logical, intent(out) :: known  !! True if the digits were shortened without reading them back
      integer(int64) :: short, unit
      real(wp) :: off, half_step
      integer :: places

      known = abs(exponent) < 280
      if (.not. known) return
      ! half the distance to the next double, and all distances, in units of the 17th digit
      half_step = 0.5_wp*spacing(value)*10.0_wp**(16 - exponent)
      do places = 15, 16
         unit = 10_int64**(17 - places)
         short = (digits + unit/2)/unit
         if (beyond < 0.0_wp .and. mod(digits, unit) == unit/2) short = short - 1
         off = abs(real(digits - short*unit, wp) + beyond)
         if (off - doubt > 1.000001_wp*half_step) cycle
         ! the next double below a power of two is only half as far; a tie may round either way
         known = off + doubt < 0.499999_wp*half_step .or. off + doubt < 0.999999_wp*half_step &
            & .and. abs(fraction(value)) > 0.5_wp
         known = known .and. 2.0_wp*off < real(unit, wp) .and. short < 10_int64**places
         if (known) digits = short
         return
      end do
   end subroutine shorten

   !> Find the fewest digits that read back as the same number, by trial
   pure subroutine try_forms(value, digits, exponent)
      real(wp), intent(in) :: value
      integer(int64), intent(out) :: digits
      integer, intent(out) :: exponent
      character(len=24) :: buffer
      real(wp) :: again
      integer :: places, stat

      do places = 15, 17
         write (buffer, scientific_form(places)) value
         read (buffer, "(f24.0)", iostat=stat) again
         if (stat /= 0) exit
         if (.not. abs(again - value) > 0.0_wp) exit
      end do
      call take_digits(buffer, digits, exponent)
   end subroutine try_forms

   !> Digits and exponent of a text written with an ES edit descriptor
   pure subroutine take_digits(scientific, digits, exponent)
      character(len=*), intent(in) :: scientific  !! The text
      integer(int64), intent(out) :: digits       !! All digits before the exponent, as an integer
      integer, intent(out) :: exponent            !! The exponent
      integer :: code, e, i

      digits = 0
      exponent = 0
      e = scan(scientific, "E")
      do i = 1, len(scientific)
         code = iachar(scientific(i:i)) - iachar("0")
         if (code < 0 .or. code > 9) cycle
         if (i < e) digits = 10_int64*digits + int(code, int64)
         if (i > e) exponent = 10*exponent + code
      end do
      if (scientific(e + 1:e + 1) == "-") exponent = -exponent
   end subroutine take_digits

   !> Write plain decimals where they are as short as scientific notation
   pure subroutine put_plain(number, exponent, text, n)
      !> Significant digits as an integer, trailing zeros allowed
      integer(int64), intent(in) :: number
      integer, intent(in) :: exponent
      !> Receives the text without trailing zeros, with at least one digit after a point
      character(len=*), intent(inout) :: text
      integer, intent(inout) :: n
      character(len=20) :: digits
      integer(int64), parameter :: power(5) = 10_int64**[16, 8, 4, 2, 1]
      integer(int64) :: rest
      integer :: i, n_digits, whole

      rest = number
      do i = 1, 5
         if (mod(rest, power(i)) == 0 .and. rest > 9) rest = rest/power(i)
      end do
      call put_digits(rest, digits, n_digits)
      if (exponent < 0 .and. exponent > -5) then
         text(n + 1:n + 1 - exponent) = "0.000"
         n = n + 1 - exponent + n_digits
         text(n - n_digits + 1:n) = digits
         return
      end if
      whole = merge(exponent + 1, 1, exponent >= 0 .and. exponent < 16)
      text(n + 1:n + whole) = digits
      n = n + whole
      if (n_digits > whole) then
         text(n + 1:n + 1) = "."
         text(n + 2:n + 1 + n_digits - whole) = digits(whole + 1:)
         n = n + 1 + n_digits - whole
      end if
      if (exponent > -5 .and. exponent < 16) return
      text(n + 1:n + 2) = merge("e-", "e ", exponent < 0)
      n = n + merge(2, 1, exponent < 0)
      call put_digits(abs(int(exponent, int64)), digits, n_digits)
      text(n + 1:n + n_digits) = digits
      n = n + n_digits
   end subroutine put_plain

   !> Number of decimal digits of an integer
   pure integer function count_digits(number)
      integer(int64), intent(in) :: number  !! The integer, not negative
      integer :: k
      integer(int64), parameter :: power(18) = [(10_int64**k, k=1, 18)]

      do count_digits = 1, 18
         if (number < power(count_digits)) exit
      end do
   end function count_digits

   !> Write the digits of an integer
   pure subroutine put_digits(number, digits, n)
      integer(int64), intent(in) :: number
      character(len=20), intent(out) :: digits  !! The digits, left-aligned, followed by zeros
      integer, intent(out) :: n                 !! Number of digits
      integer(int64) :: rest
      integer :: i

      n = count_digits(number)
      digits = "00000000000000000000"
      rest = number
      do i = n, 1, -1
         digits(i:i) = achar(iachar("0") + int(mod(rest, 10_int64)))
         rest = rest/10_int64
      end do
   end subroutine put_digits

   !> Decimal text of an integer
   pure function integer_to_text(value) result(text)
      integer, intent(in) :: value  !! Number to write
      character(len=:), allocatable :: text
      character(len=20) :: digits
      integer :: n

      call put_digits(abs(int(value, int64)), digits, n)
      text = repeat("-", merge(1, 0, value < 0))//digits(:n)
   end function integer_to_text

   !> The text in lower case (ASCII letters only)
   pure function lower_case(text) result(lower)
      character(len=*), intent(in) :: text  !! Any text
      character(len=len(text)) :: lower     !! Text of the same length
      integer :: i, code

      lower = text
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) lower(i:i) = achar(code + 32)
      end do
   end function lower_case

   !> Append a line
   pure subroutine add_line(lines, line)
      type(growing_text_t), intent(inout) :: lines
      character(len=*), intent(in) :: line  !! The line
      character(len=:), allocatable :: longer
      integer :: room

      if (.not. allocated(lines%text)) lines%text = repeat(" ", 4096)
      room = lines%length + len(line) + 1
      if (room > len(lines%text)) then
         allocate (character(len=max(2*len(lines%text), room)) :: longer)
         longer(:lines%length) = lines%text(:lines%length)
         call move_alloc(longer, lines%text)
      end if
      lines%text(lines%length + 1:room - 1) = line
      lines%text(room:room) = new_line("a")
      lines%length = room
   end subroutine add_line

   !> The lines separated by line ends, none after the last
   pure function lines_of(lines) result(text)
      type(growing_text_t), intent(in) :: lines
      character(len=:), allocatable :: text  !! The text; empty if there are none

      text = ""
      if (lines%length > 0) text = lines%text(:lines%length - 1)
   end function lines_of

   !> Bytes of the lines with their line ends
   pure integer function bytes_of(lines)
      type(growing_text_t), intent(in) :: lines

      bytes_of = lines%length
   end function bytes_of

   !> Numbers joined by a separator
   pure function fields(value, between) result(text)
      real(wp), intent(in) :: value(:)            !! The numbers: (n), one or more
      character, intent(in), optional :: between  !! Separator; a comma if absent
      character(len=:), allocatable :: text
      character(len=33*size(value)) :: buffer
      character :: separator
      integer :: i, k, n

      separator = ","
      if (present(between)) separator = between
      n = 0
      do i = 1, size(value)
         if (i > 1) then
            n = n + 1
            buffer(n:n) = separator
         end if
         call print_number(value(i), buffer(n + 1:n + 32), k)
         n = n + k
      end do
      text = buffer(:n)
   end function fields
end module dda_text
