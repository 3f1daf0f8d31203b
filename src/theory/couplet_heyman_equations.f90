!> Equilibrium of a chunk of the arch and tangency of the thrust: eqs. (1) to (13) of the paper
!>
!> Lengths are over the mean radius r, forces over w r with w the weight per length of the centre
!> line; beta is the angle from the crown, S = sin beta, C = cos beta, m = 1 + delta_M eta^2/12.
!> With q = 1 - C, beta S = q A(beta) and a = 2 - A every difference of the printed forms becomes a
!> sum of terms that are as small as the result. No range is checked here; outside 0 < eta < 2, 0 <=
!> beta < pi, h >= 0 the results mean nothing.
module couplet_heyman_equations
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_kernels, only : arc_excess, embrace_deficit, versine
   use couplet_heyman_theories, only : theory, tangency_flag, weight_arm, weight_flag
   implicit none
   private

   public :: heyman_thickness, heyman_thrust, eccentricity
   public :: thrust_through, springing_thrust, tangent_thrust

contains

   !> Eq. (2), Heyman: eta = 2 (beta - S)(1 - C)/(beta (1 + C))
   elemental function heyman_thickness(beta) result(eta)
      real(wp), intent(in) :: beta  !! Inner hinge, (0, pi/2] [rad]
      real(wp) :: eta               !! Thickness ratio [-]

      eta = 2.0_wp*arc_excess(beta)/beta*tan(0.5_wp*beta)**2
   end function heyman_thickness

   !> Eq. (3), Heyman: h = beta cot beta, the resultant tangent to the intrados
   elemental function heyman_thrust(beta) result(h)
      real(wp), intent(in) :: beta  !! Inner hinge, [0, pi/2] [rad]
      real(wp) :: h                 !! Horizontal thrust [w r]

      h = 1.0_wp
      if (beta > 0.0_wp) h = beta*cos(beta)/sin(beta)
   end function heyman_thrust

   !> Eq. (6): thrust that makes the line of thrust pass through the crown's extrados and a given
   !> point of a joint
   elemental function thrust_through(beta, eccentricity_ratio, eta, which) result(h)
      real(wp), intent(in) :: beta                !! Angle of the joint, (0, pi) [rad]
      real(wp), intent(in) :: eccentricity_ratio  !! 2e/t, -1 at the extrados, 1 at the intrados
      real(wp), intent(in) :: eta                 !! Thickness ratio [-]
      integer, intent(in) :: which                !! One of `theory`
      real(wp) :: h
      real(wp) :: reach, numerator, denominator

      reach = 2.0_wp - eccentricity_ratio*eta
      numerator = reach*(2.0_wp - embrace_deficit(beta)) - 2.0_wp*weight_arm(eta, which)
      denominator = eta*(1.0_wp + eccentricity_ratio) + reach*versine(beta)
      h = versine(beta)*numerator/denominator
   end function thrust_through

   !> Eq. (8): h2 = A - 2 m/(2 + eta), through the extrados of crown and springing
   elemental function springing_thrust(alpha, eta, which) result(h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, pi) [rad]
      real(wp), intent(in) :: eta
      integer, intent(in) :: which
      real(wp) :: h                  !! h2 = 1 - a + (eta - delta_M eta^2/6)/(2 + eta) [w r]

      h = eta*(1.0_wp - weight_flag(which)*eta/6.0_wp)/(2.0_wp + eta)
      h = 1.0_wp - embrace_deficit(alpha) + h
   end function springing_thrust

   !> Eq. (12): h_e, the thrust at which the line of thrust touches the intrados at beta; for Heyman
   !> eq. (3)
   elemental function tangent_thrust(beta, eta, which) result(h)
      real(wp), intent(in) :: beta  !! Inner hinge, [0, pi) [rad]
      real(wp), intent(in) :: eta   !! Thickness ratio, below 2 [-]
      integer, intent(in) :: which
      real(wp) :: h                 !! h_e [w r]

      h = heyman_thrust(beta)
      if (which == theory%heyman) return
      h = h - tangency_flag(which)*eta*(1.0_wp + weight_flag(which)*eta/6.0_wp)/(2.0_wp - eta)
   end function tangent_thrust

   !> Eq. (10): where the line of thrust through the crown's extrados cuts the joint at beta
   !>
   !> 1 + e = q ((2 + eta)(A(beta) - h) - 2 m)/(eta (beta S + h C)): the crown keeps all its digits;
   !> 2e/t, -1 at the extrados, 1 at the intrados
   elemental real(wp) function eccentricity(beta, eta, h, which)
      real(wp), intent(in) :: beta  !! Angle of the joint, [0, pi) [rad]
      real(wp), intent(in) :: eta
      real(wp), intent(in) :: h     !! Horizontal thrust, positive where beta is 0 [w r]
      integer, intent(in) :: which
      real(wp) :: drop

      drop = (2.0_wp + eta)*((1.0_wp - h) - embrace_deficit(beta)) &
           + eta*(1.0_wp - weight_flag(which)*eta/6.0_wp)
      eccentricity = versine(beta)*drop/(eta*(beta*sin(beta) + h*cos(beta))) - 1.0_wp
   end function eccentricity

end module couplet_heyman_equations
