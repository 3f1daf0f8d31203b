!> Equations of the paper that nothing but its tests asks for, as it prints them
!>
!> Symbols as in couplet_heyman_printed.
module printed_equations
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_equations, only : arm_excess, heyman_thickness, thrust_through, versine, weight_arm, weight_flag
   implicit none
   private

   public :: heyman_embrace, chunk_weight, chunk_centre, lower_thrust
   public :: stationary_polynomial, singular_embrace, singular_polynomial, crown_polynomial
   public :: embrace_polynomial, thickness_polynomial

contains

   !> Left side of eq. (1), Heyman: the A at which the hinge is at beta
   elemental function heyman_embrace(beta) result(a)
      real(wp), intent(in) :: beta  !! Inner hinge, (0, pi/2] [rad]
      !> A = h + 2/(2 + eta) with eqs. (2) and (3), which is eq. (1) without its cancelling factors
      real(wp) :: a
      real(wp) :: eta

      eta = heyman_thickness(beta)
      a = 2.0_wp - arm_excess(beta)/sin(beta) - eta/(2.0_wp + eta)
   end function heyman_embrace

   !> Eq. (5): weight of the chunk between the crown and beta
   elemental function chunk_weight(beta) result(weight)
      real(wp), intent(in) :: beta  !! Angle from the crown [rad]
      real(wp) :: weight            !! W1 [w r]

      weight = beta
   end function chunk_weight

   !> Eq. (5): centre of gravity of the chunk between the crown and beta
   pure function chunk_centre(beta, eta, which) result(centre)
      real(wp), intent(in) :: beta  !! Angle from the crown, (0, pi) [rad]
      real(wp), intent(in) :: eta   !! Thickness ratio [-]
      integer, intent(in) :: which  !! One of `theory`
      real(wp) :: centre(2)         !! x1 from the crown and y1 from the arch's centre: (2) [r]

      centre = weight_arm(eta, which)*[versine(beta), sin(beta)]/beta
   end function chunk_centre

   !> Eq. (7): h1, the lower thrust, through the crown's extrados and the intrados at beta
   elemental function lower_thrust(beta, eta, which) result(h)
      real(wp), intent(in) :: beta  !! Inner hinge, (0, pi) [rad]
      real(wp), intent(in) :: eta
      integer, intent(in) :: which
      real(wp) :: h  !! h1 [w r]

      h = thrust_through(beta, 1.0_wp, eta, which)
   end function lower_thrust

   !> Eq. (18): derivative of eq. (14) by beta; vanishes at the least thickness
   elemental real(wp) function stationary_polynomial(eta, beta, a, which) result(value)
      real(wp), intent(in) :: eta, beta, a
      integer, intent(in) :: which
      real(wp) :: s, arm

      s = sin(beta)
      arm = s + beta*cos(beta) - s*a
      value = -weight_flag(which)*s*eta**3 - 3.0_wp*arm*eta**2 - 12.0_wp*s*eta + 12.0_wp*arm
   end function stationary_polynomial

   !> Eq. (20): the A at which eq. (19) has no slope
   elemental real(wp) function singular_embrace(eta, beta, which)
      real(wp), intent(in) :: eta, beta
      integer, intent(in) :: which
      real(wp) :: c

      c = cos(beta)
      singular_embrace = weight_flag(which)*c*eta**2 - 2.0_wp*beta*sin(beta)*eta + 4.0_wp*c
      singular_embrace = singular_embrace/(4.0_wp + 2.0_wp*(1.0_wp + c)*eta)
   end function singular_embrace

   !> Eq. (21): eq. (27) at A = A_sing
   elemental real(wp) function singular_polynomial(eta, which) result(value)
      real(wp), intent(in) :: eta
      integer, intent(in) :: which
      real(wp) :: flag

      flag = weight_flag(which)
      value = -(flag*eta**2 + 4.0_wp*flag*eta - 12.0_wp)*eta**2/(2.0_wp*(1.0_wp + eta))
   end function singular_polynomial

   !> Eq. (27): eq. (14) at beta = 0
   elemental real(wp) function crown_polynomial(eta, a, which)
      real(wp), intent(in) :: eta, a
      integer, intent(in) :: which

      crown_polynomial = (weight_flag(which)*eta**2 - 6.0_wp*a*eta + 12.0_wp*(1.0_wp - a))*eta
   end function crown_polynomial

   !> Eq. (22): eta eliminated; for CCR it has the extraneous root A = -(beta + S C)/S besides those
   !> of eq. (24)
   elemental real(wp) function embrace_polynomial(beta, a, which) result(value)
      real(wp), intent(in) :: beta  !! Critical hinge [rad]
      real(wp), intent(in) :: a
      integer, intent(in) :: which  !! CCR or Milankovitch of `theory`
      real(wp) :: s, c, g, rest, head

      s = sin(beta)
      c = cos(beta)
      g = beta + s*c
      head = 0.5_wp*(3.0_wp + weight_flag(which))
      rest = 0.5_wp*(1.0_wp - weight_flag(which))*s
      value = s**2*(3.0_wp*g - head*s)*a**3 + 3.0_wp*((1.0_wp - c)*(beta - s) - rest)*g*s*a**2 &
            - 3.0_wp*(s + beta*c - rest)*g**2*a + head*g**3
   end function embrace_polynomial

   !> Eq. (25): A eliminated; for one hinge it has two thicknesses, one on either side of beta_max
   elemental real(wp) function thickness_polynomial(eta, beta, which)
      real(wp), intent(in) :: eta  !! Critical thickness ratio [-]
      real(wp), intent(in) :: beta
      integer, intent(in) :: which
      real(wp) :: s, c

      s = sin(beta)
      c = cos(beta)
      thickness_polynomial = weight_flag(which)*s*eta**3 + 3.0_wp*(1.0_wp + c)*(beta + s)*eta**2 &
            - 12.0_wp*(beta + s*c - s)*eta + 12.0_wp*(1.0_wp - c)*(beta - s)
   end function thickness_polynomial

end module printed_equations
