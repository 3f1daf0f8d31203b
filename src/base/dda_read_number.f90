!> Text to numbers
submodule (dda_text) dda_read_number
   use, intrinsic :: iso_c_binding, only : c_char, c_double, c_null_char, c_null_ptr, c_ptr
   implicit none

   !> Maximum length of a number [characters]
   integer, parameter :: longest_number = 400
   !> Upper limit of decimal exponents, excluded
   integer, parameter :: border = 308

   interface
      !> C: the double that is nearest to a decimal number
      pure function c_strtod(text, rest) bind(c, name="strtod") result(value)
         import :: c_char, c_double, c_ptr
         character(kind=c_char), intent(in) :: text(*)  !! The number, ended by a null character
         type(c_ptr), intent(in), value :: rest         !! Receives the end of the number, or null
         real(c_double) :: value
      end function c_strtod
   end interface

contains

   !> Read one decimal number below 1e308 from a text that has nothing else
   module procedure read_number
      character(len=len(text) + 1) :: c_text
      integer :: exponent, first, mark, point, power

      value = 0.0_wp
      exponent = 0
      mark = scan(text, "eEdD")
      if (mark == 0) mark = len(text) + 1
      ok = len(text) <= longest_number .and. is_decimal(text(:mark - 1))
      if (ok .and. mark <= len(text)) call read_integer(text(mark + 1:), exponent, ok)
      if (.not. ok) return
      ! power of ten of the first nonzero digit: checked first, because an overflow could trap
      first = scan(text(:mark - 1), "123456789")
      point = index(text(:mark - 1), ".")
      if (point == 0) point = mark
      power = point - first - merge(1, 0, first < point)
      ok = first == 0 .or. power + min(max(exponent, -1000), 1000) < border
      if (.not. ok) return
      c_text = text//c_null_char
      if (mark <= len(text)) c_text(mark:mark) = "e"
      value = c_strtod(c_text, c_null_ptr)
   end procedure read_number

   !> Read one integer from a text that has nothing else
   module procedure read_integer
      character(len=12) :: form
      integer :: stat

      value = 0
      ok = len(text) <= 40 .and. is_decimal(text) .and. index(text, ".") == 0
      if (.not. ok) return
      write (form, "('(i', i0, ')')") len(text)
      read (text, form, iostat=stat) value
      ok = stat == 0
      if (.not. ok) value = 0
   end procedure read_integer

   !> True for digits with at most one decimal point and an optional sign
   pure logical function is_decimal(text)
      character(len=*), intent(in) :: text  !! Text to check
      character(len=*), parameter :: digits = "0123456789"
      integer :: first

      first = 1
      if (len(text) > 0) first = 1 + scan(text(1:1), "+-")
      associate (body => text(first:))
         is_decimal = scan(body, digits) > 0 .and. verify(body, digits//".") == 0 &
            & .and. index(body, ".") == index(body, ".", back=.true.)
      end associate
   end function is_decimal

end submodule dda_read_number
