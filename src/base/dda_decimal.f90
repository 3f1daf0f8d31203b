!> Decimal numbers of few digits to the nearest double, without the run-time library
submodule (dda_text) dda_decimal
   implicit none

   !> Most digits whose number fits into a whole number of 64 bits
   integer, parameter :: most_digits = 18
   !> Powers of ten that are doubles
   real(wp), parameter :: ten_to(0:22) = [1.0e0_wp, 1.0e1_wp, 1.0e2_wp, 1.0e3_wp, 1.0e4_wp, &
      & 1.0e5_wp, 1.0e6_wp, 1.0e7_wp, 1.0e8_wp, 1.0e9_wp, 1.0e10_wp, 1.0e11_wp, 1.0e12_wp, &
      & 1.0e13_wp, 1.0e14_wp, 1.0e15_wp, 1.0e16_wp, 1.0e17_wp, 1.0e18_wp, 1.0e19_wp, 1.0e20_wp, &
      & 1.0e21_wp, 1.0e22_wp]
   !> Share by which the small part of a result may be off
   real(wp), parameter :: slack = 1.0e-10_wp

contains

   !> Product of two doubles as the sum of two (Dekker 1971)
   module procedure exact_product
      real(wp) :: high(2), low(2)

      ! numbers of half the digits that add up to each
      high = 134217729.0_wp*[a, b]
      high = high - (high - [a, b])
      low = [a, b] - high
      product = a*b
      rest = ((high(1)*high(2) - product) + high(1)*low(2) + low(1)*high(2)) + low(1)*low(2)
   end procedure exact_product

   !> Read a decimal number of usual size, rounded to the nearest double
   module procedure read_short_decimal
      integer(int64) :: digits
      integer :: power
      real(wp) :: high, low, rest, product, error

      value = 0.0_wp
      call split_decimal(text, digits, power, known)
      known = known .and. (digits == 0 .or. abs(power) <= 22)
      if (.not. known) return
      if (digits > 0) then
         ! high and low add up to the digits; value and low to the number
         high = real(digits, wp)
         low = real(digits - int(high, int64), wp)
         if (power >= 0) then
            call exact_product(high, ten_to(power), value, rest)
            low = low*ten_to(power)
            error = slack*(abs(rest) + abs(low))
            low = rest + low
         else
            value = high/ten_to(-power)
            call exact_product(value, ten_to(-power), product, rest)
            rest = (high - product) - rest
            error = slack*(abs(rest) + abs(low))/ten_to(-power)
            low = (rest + low)/ten_to(-power)
         end if
         known = .not. abs((value + (low + error)) - (value + (low - error))) > 0.0_wp
         value = merge(value + low, 0.0_wp, known)
      end if
      if (text(1:1) == "-") value = -value
   end procedure read_short_decimal

   !> Digits of a decimal number as a whole number, and its power of ten
   pure subroutine split_decimal(text, digits, power, ok)
      character(len=*), intent(in) :: text
      integer(int64), intent(out) :: digits  !! All digits, without sign
      integer, intent(out) :: power          !! Power of ten of the last of them
      !> Whether the text is a number of at most 18 digits, its exponent of at most 4
      logical, intent(out) :: ok
      integer :: i, n, point, code, first

      digits = 0
      power = 0
      n = 0
      point = 0
      first = 1
      ok = .false.
      if (len(text) == 0) return
      if (text(1:1) == "-" .or. text(1:1) == "+") first = 2
      do i = first, len(text)
         code = iachar(text(i:i)) - iachar("0")
         if (code >= 0 .and. code <= 9) then
            if (digits > 0 .or. code > 0) n = n + 1
            ok = n <= most_digits
            if (.not. ok) return
            digits = 10_int64*digits + int(code, int64)
         else if (text(i:i) == "." .and. point == 0) then
            point = i
         else
            exit
         end if
      end do
      if (point > 0) power = point + 1 - i
      if (ok .and. i <= len(text)) call add_exponent(text(i:), power, ok)
   end subroutine split_decimal

   !> Add what stands behind the digits of a number to its power of ten
   pure subroutine add_exponent(text, power, ok)
      !> Text such as e-3, not empty
      character(len=*), intent(in) :: text
      integer, intent(inout) :: power
      logical, intent(out) :: ok  !! Whether it is a letter and a whole number of at most 4 digits
      integer :: exponent, first, i

      ok = scan(text(1:1), "eEdD") == 1 .and. len(text) > 1
      if (.not. ok) return
      first = 2
      if (scan(text(2:2), "+-") == 1) first = 3
      ok = len(text) >= first .and. len(text) - first < 4
      if (ok) ok = verify(text(first:), "0123456789") == 0
      if (.not. ok) return
      exponent = 0
      do i = first, len(text)
         exponent = 10*exponent + iachar(text(i:i)) - iachar("0")
      end do
      power = power + merge(-exponent, exponent, text(2:2) == "-")
   end subroutine add_exponent

end submodule dda_decimal
