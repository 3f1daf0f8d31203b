!> Text to numbers
submodule (dda_text) dda_read_number
   implicit none

contains

   !> Read one decimal number below 1e308, and nothing else, from a text
   module procedure read_number
      character(len=:), allocatable :: mantissa
      character(len=12) :: form
      integer :: mark, stat, point, exponent

      value = 0.0_wp
      ok = .false.
      if (len(text) == 0 .or. len(text) > 400) return
      call read_short_decimal(text, value, ok)
      if (ok) return
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
   end procedure read_number

   !> Power of ten of the first digit of a decimal number that is not zero: far below 0 if all
   !> digits are zero
   pure integer function power_of_ten(digits, point)
      !> Digits with or without a sign, the decimal point taken out
      character(len=*), intent(in) :: digits
      !> Place where the point stood, counted from 1; 0 if there was none
      integer, intent(in) :: point
      integer :: first

      first = scan(digits, "123456789")
      power_of_ten = -1000
      if (first > 0) power_of_ten = merge(point - 1, len(digits), point > 0) - first
   end function power_of_ten

   !> Read one integer, and nothing else, from a text
   module procedure read_integer
      character(len=12) :: form
      integer :: stat

      value = 0
      ok = len(text) <= 40 .and. is_digits(text, signed=.true.)
      if (.not. ok) return
      write (form, "('(i', i0, ')')") len(text)
      read (text, form, iostat=stat) value
      ok = stat == 0
      if (.not. ok) value = 0
   end procedure read_integer

   !> Whether a text is one digit or more, after a sign where signs are allowed
   pure logical function is_digits(text, signed)
      character(len=*), intent(in) :: text  !! Text to look at
      logical, intent(in) :: signed         !! Whether a leading sign may stand
      integer :: first

      first = 1
      if (signed .and. len(text) > 0) then
         if (scan(text(1:1), "+-") == 1) first = 2
      end if
      is_digits = len(text) >= first
      if (is_digits) is_digits = verify(text(first:), "0123456789") == 0
   end function is_digits

end submodule dda_read_number
