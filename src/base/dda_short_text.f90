!> Numbers formatted for messages and reports
submodule (dda_text) dda_short_text
   implicit none

contains

   !> A number for messages: at most six significant digits, exponential form from one million on
   module procedure short_text
      character(len=13) :: form
      real(wp) :: mantissa, near
      integer :: exponent, stat

      text = to_text(value)
      if (.not. ieee_is_finite(value)) return
      write (form, "(es13.5e3)") value
      read (form, "(f8.0, 1x, i4)", iostat=stat) mantissa, exponent
      if (stat == 0) read (form, "(f13.0)", iostat=stat) near
      if (stat /= 0) return
      ! adding zero removes the sign of a negative zero
      text = to_text(near + 0.0_wp)
      if (exponent >= 6) text = to_text(mantissa)//"e"//to_text(exponent)
   end procedure short_text

   !> A point for messages: coordinates of six significant digits, or to the millimetre if that is
   !> finer
   module procedure place_text
      text = "("//coordinate_text(place(1))//", "//coordinate_text(place(2))//")"
   end procedure place_text

   !> One coordinate of a point
   pure function coordinate_text(value) result(text)
      real(wp), intent(in) :: value          !! The coordinate [m]
      character(len=:), allocatable :: text  !! The coordinate
      ! within these bounds six digits are coarser than 1/1000, and 1/1000 is above round-off
      real(wp), parameter :: from = 1.0e3_wp, to = 1.0e12_wp

      if (abs(value) < from .or. abs(value) > to) then
         text = short_text(value)
      else
         text = to_text(anint(1.0e3_wp*value)/1.0e3_wp)
      end if
   end function coordinate_text

   !> A positive number, at most three significant digits, rounded up
   module procedure raised_text
      character(len=13) :: form
      real(wp) :: raised
      integer :: stat

      text = to_text(value)
      write (form, "(ru, es13.2e3)") value
      read (form, *, iostat=stat) raised
      if (stat == 0) text = to_text(raised)
   end procedure raised_text

   !> A number with its noun, in the plural for all numbers except one
   module procedure counted
      text = to_text(number)//" "//thing
      if (number /= 1) text = text//"s"
   end procedure counted

end submodule dda_short_text
