!> Eqs. (14) to (27) term by term as printed in the paper, and their critical solutions
!>
!> For comparison and checks: these forms lose digits for shallow arches
!> (docs/theory.md has the table), unlike couplet_heyman_curves and couplet_heyman_critical. A is
!> eq. (9), S = sin beta, C = cos beta.
module couplet_heyman_printed
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_critical, only : is_embraced
   use couplet_heyman_equations, only : theory, weight_flag
   implicit none
   private

   public :: equilibrium_polynomial, growth_polynomial, embrace_cubic, embrace_quadratic
   public :: heyman_quotient, printed_thickness, printed_critical

contains

   !> Eq. (1), left side: beta cot beta times a quotient; equals A for Heyman's hinge
   elemental real(wp) function heyman_quotient(beta)
      real(wp), intent(in) :: beta  !! Inner hinge, (0, pi/2) [rad]
      real(wp) :: s, c, common

      s = sin(beta)
      c = cos(beta)
      common = 2.0_wp*beta*c + s*c**2
      heyman_quotient = beta*c/s*(common + s)/(common - s*c)
   end function heyman_quotient

   !> Eq. (14): vanishes on the equilibrium curve
   elemental real(wp) function equilibrium_polynomial(eta, beta, a, which) result(value)
      real(wp), intent(in) :: eta   !! Thickness ratio [-]
      real(wp), intent(in) :: beta
      real(wp), intent(in) :: a     !! A, eq. (9)
      integer, intent(in) :: which  !! One of `theory`
      real(wp) :: s, c

      s = sin(beta)
      c = cos(beta)
      value = weight_flag(which)*c*eta**3 - 3.0_wp*(beta*s + (1.0_wp + c)*a)*eta**2 &
            + 12.0_wp*(c - a)*eta + 12.0_wp*(beta*s - (1.0_wp - c)*a)
   end function equilibrium_polynomial

   !> Denominator of eq. (19): derivative of eq. (14) by eta
   elemental real(wp) function growth_polynomial(eta, beta, a, which) result(value)
      real(wp), intent(in) :: eta, beta, a
      integer, intent(in) :: which
      real(wp) :: s, c

      s = sin(beta)
      c = cos(beta)
      value = 3.0_wp*weight_flag(which)*c*eta**2 - 6.0_wp*(beta*s + (1.0_wp + c)*a)*eta &
            + 12.0_wp*(c - a)
   end function growth_polynomial

   !> Eq. (23): eq. (22) for Milankovitch
   elemental real(wp) function embrace_cubic(beta, a)
      real(wp), intent(in) :: beta, a
      real(wp) :: s, c, g

      s = sin(beta)
      c = cos(beta)
      g = beta + s*c
      embrace_cubic = s**2*(3.0_wp*g - 2.0_wp*s)*a**3 + 3.0_wp*(1.0_wp - c)*(beta - s)*g*s*a**2 &
            - 3.0_wp*(s + beta*c)*g**2*a + 2.0_wp*g**3
   end function embrace_cubic

   !> Eq. (24): eq. (22) for CCR without its extraneous factor
   elemental real(wp) function embrace_quadratic(beta, a)
      real(wp), intent(in) :: beta, a
      real(wp) :: s, c, g

      s = sin(beta)
      c = cos(beta)
      g = beta + s*c
      embrace_quadratic = s*(2.0_wp*g - s)*a**2 - 2.0_wp*(s + beta*c)*g*a + g**2
   end function embrace_quadratic

   !> Eq. (16): the equilibrium curve of Heyman and CCR in closed form
   elemental function printed_thickness(beta, a) result(eta)
      real(wp), intent(in) :: beta, a
      real(wp) :: eta
      real(wp) :: s, c, radicand

      s = sin(beta)
      c = cos(beta)
      radicand = c*(c - (2.0_wp - c*a)*a) + beta*s*(beta*s + 2.0_wp*c*a)
      eta = 2.0_wp*(c - a + sqrt(radicand))/(beta*s + (1.0_wp + c)*a)
   end function printed_thickness

   !> Critical solution by the printed forms: bisection on eq. (1), (24) or (23), then (2), (16) or
   !> (14), then (3) or (8)
   elemental subroutine printed_critical(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, alpha_limit] [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta, eta
      real(wp), intent(out) :: h     !! Thrust [w r]
      real(wp) :: a, s, c

      beta = ieee_value(beta, ieee_quiet_nan)
      eta = beta
      h = beta
      if (.not. is_embraced(alpha, which)) return
      a = alpha/tan(0.5_wp*alpha)
      beta = printed_hinge(alpha, a, which)
      s = sin(beta)
      c = cos(beta)
      if (which == theory%heyman) then
         eta = 2.0_wp*(beta - s)*(1.0_wp - c)/(beta*(1.0_wp + c))
         h = beta*c/s
      else
         eta = printed_thickness(beta, a)
         if (which == theory%milankovitch) eta = printed_cubic_root(eta, beta, a)
         h = a - 2.0_wp/(2.0_wp + eta)*(1.0_wp + weight_flag(which)*eta**2/12.0_wp)
      end if
   end subroutine printed_critical

   !> Root in beta of eq. (1), (24) or (23), by bisection to the last bit
   elemental function printed_hinge(alpha, a, which) result(beta)
      real(wp), intent(in) :: alpha, a
      integer, intent(in) :: which
      real(wp) :: beta  !! Inner hinge [rad]
      !> The only root below 90 degrees [rad]
      real(wp), parameter :: farthest = 0.5_wp*acos(-1.0_wp)
      real(wp) :: low, high, value

      low = merge(0.5_wp*alpha, 0.0_wp, which == theory%heyman)
      high = min(alpha, farthest)
      do
         beta = low + 0.5_wp*(high - low)
         if (beta <= low .or. beta >= high) exit
         select case (which)
         case (theory%heyman)
            value = a - heyman_quotient(beta)
         case (theory%ccr)
            value = embrace_quadratic(beta, a)
         case default
            value = embrace_cubic(beta, a)
         end select
         if (value < 0.0_wp) low = beta
         if (.not. value < 0.0_wp) high = beta
      end do
   end function printed_hinge

   !> Root of the cubic (14) next to that of its quadratic part, by Newton's method
   elemental function printed_cubic_root(start, beta, a) result(eta)
      real(wp), intent(in) :: start     !! Root of eq. (16) [-]
      real(wp), intent(in) :: beta, a
      real(wp) :: eta
      integer, parameter :: steps = 12  !! Twice the number for full convergence
      integer :: i

      eta = start
      do i = 1, steps
         eta = eta - equilibrium_polynomial(eta, beta, a, theory%milankovitch) &
                    /growth_polynomial(eta, beta, a, theory%milankovitch)
      end do
   end function printed_cubic_root

end module couplet_heyman_printed
