!> Numbers to text, text to numbers, small words on strings
module dda_text
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use dda_kinds, only : wp
   implicit none
   private

   public :: to_text, lower_case, read_number, read_integer

   !> Shortest text that reads back as the same number
   interface to_text
      module procedure real_to_text
      module procedure integer_to_text
   end interface to_text

   !> Formats of 15, 16 and 17 significant digits
   character(len=11), parameter :: scientific_form(15:17) = &
      & ["(es24.14e3)", "(es24.15e3)", "(es24.16e3)"]

contains

   !> Shortest decimal text that reads back as the same double
   pure function real_to_text(value) result(text)
      !> Number to write
      real(wp), intent(in) :: value
      !> Text without blanks
      character(len=:), allocatable :: text
      character(len=24) :: buffer
      real(wp) :: again
      integer :: digits, stat

      do digits = 15, 17
         write (buffer, scientific_form(digits)) value
         read (buffer, "(f24.0)", iostat=stat) again
         if (stat /= 0) exit
         if (.not. abs(again - value) > 0.0_wp) exit
      end do
      text = plain_form(trim(adjustl(buffer)), value)
   end function real_to_text

   !> Turn scientific notation into plain decimals where that is as short
   pure function plain_form(scientific, value) result(text)
      !> Number as written by an ES edit descriptor
      character(len=*), intent(in) :: scientific
      !> The number itself
      real(wp), intent(in) :: value
      !> Text without trailing zeros
      character(len=:), allocatable :: text
      character(len=:), allocatable :: digits, sign
      integer :: e, exponent, stat

      e = scan(scientific, "E")
      text = scientific
      if (e == 0 .or. .not. ieee_is_finite(value)) return
      read (scientific(e + 1:), "(i4)", iostat=stat) exponent
      if (stat /= 0) return
      sign = ""
      if (scientific(1:1) == "-") sign = "-"
      digits = scientific(len(sign) + 1:len(sign) + 1)//scientific(len(sign) + 3:e - 1)
      digits = digits(1:max(1, verify(digits, "0", back=.true.)))
      if (exponent >= 0 .and. exponent < 16) then
         text = sign//left_of_point(digits, exponent)
      else if (exponent < 0 .and. exponent > -5) then
         text = sign//"0."//repeat("0", -exponent - 1)//digits
      else if (len(digits) == 1) then
         text = sign//digits//"e"//integer_to_text(exponent)
      else
         text = sign//digits(1:1)//"."//digits(2:)//"e"//integer_to_text(exponent)
      end if
   end function plain_form

   !> Place the decimal point of a number not below one
   pure function left_of_point(digits, exponent) result(text)
      !> Significant digits
      character(len=*), intent(in) :: digits
      !> Power of ten of the first digit
      integer, intent(in) :: exponent
      !> Text with at least one digit after the point where there is a point
      character(len=:), allocatable :: text

      if (len(digits) <= exponent + 1) then
         text = digits//repeat("0", exponent + 1 - len(digits))
      else
         text = digits(1:exponent + 1)//"."//digits(exponent + 2:)
      end if
   end function left_of_point

   !> Decimal text of an integer
   pure function integer_to_text(value) result(text)
      !> Number to write
      integer, intent(in) :: value
      !> Text without blanks
      character(len=:), allocatable :: text
      character(len=12) :: buffer

      write (buffer, "(i0)") value
      text = trim(buffer)
   end function integer_to_text

   !> The same text with A-Z turned into a-z
   pure function lower_case(text) result(lower)
      !> Any text
      character(len=*), intent(in) :: text
      !> Text of the same length
      character(len=len(text)) :: lower
      integer :: i, code

      lower = text
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) lower(i:i) = achar(code + 32)
      end do
   end function lower_case

   !> Read one decimal number below 1e308, and nothing else, from a text
   pure subroutine read_number(text, value, ok)
      !> Text such as -1.5e-3 or 1d3
      character(len=*), intent(in) :: text
      !> The number; 0 if the text is none
      real(wp), intent(out) :: value
      !> Whether the whole text is one such number
      logical, intent(out) :: ok
      character(len=:), allocatable :: mantissa
      character(len=12) :: form
      integer :: mark, stat, point, exponent

      value = 0.0_wp
      ok = .false.
      if (len(text) == 0 .or. len(text) > 400) return
      mark = scan(text, "eEdD")
      mantissa = text
      if (mark > 0) mantissa = text(:mark - 1)
      point = index(mantissa, ".")
      if (point > 0) mantissa = mantissa(:point - 1)//mantissa(point + 1:)
      if (.not. is_digits(mantissa, signed=.true.)) return
      exponent = 0
      if (mark > 0) then
         call read_integer(text(mark + 1:), exponent, ok)
         if (.not. ok) return
      end if
      ok = power_of_ten(mantissa, point) + min(max(exponent, -1000), 1000) < 308
      if (.not. ok) return
      write (form, "('(f', i0, '.0)')") len(text)
      read (text, form, iostat=stat) value
      ok = stat == 0 .and. ieee_is_finite(value)
      if (.not. ok) value = 0.0_wp
   end subroutine read_number

   !> Power of ten of the first digit of a decimal number that is not zero
   pure function power_of_ten(digits, point) result(power)
      !> Digits with or without a sign, the decimal point taken out
      character(len=*), intent(in) :: digits
      !> Place where the point stood, counted from 1; 0 if there was none
      integer, intent(in) :: point
      !> The power; far below 0 if all digits are zero
      integer :: power
      integer :: first

      first = scan(digits, "123456789")
      power = -1000
      if (first > 0) power = merge(point - 1, len(digits), point > 0) - first
   end function power_of_ten

   !> Read one integer, and nothing else, from a text
   pure subroutine read_integer(text, value, ok)
      !> Text such as 36 or +4
      character(len=*), intent(in) :: text
      !> The number; 0 if the text is none
      integer, intent(out) :: value
      !> Whether the whole text is one integer that fits
      logical, intent(out) :: ok
      character(len=12) :: form
      integer :: stat

      value = 0
      ok = len(text) <= 40 .and. is_digits(text, signed=.true.)
      if (.not. ok) return
      write (form, "('(i', i0, ')')") len(text)
      read (text, form, iostat=stat) value
      ok = stat == 0
      if (.not. ok) value = 0
   end subroutine read_integer

   !> Whether a text is one digit or more, after a sign where signs are allowed
   pure function is_digits(text, signed) result(yes)
      !> Text to look at
      character(len=*), intent(in) :: text
      !> Whether a leading sign may stand
      logical, intent(in) :: signed
      !> The answer
      logical :: yes
      integer :: first

      first = 1
      if (signed .and. len(text) > 0) then
         if (scan(text(1:1), "+-") == 1) first = 2
      end if
      yes = len(text) >= first
      if (yes) yes = verify(text(first:), "0123456789") == 0
   end function is_digits
end module dda_text
