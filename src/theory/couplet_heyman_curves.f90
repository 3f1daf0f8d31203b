!> Equilibrium curve eta(beta) at one half angle, eqs. (14) to (16), (19), (26), and the thrust
!> line, eq. (11)
!>
!> Eq. (14) divided by 12 is E = Q + eta (D - eta (P/4 - delta_M C eta/12)) = 0 with
!>     Q = beta S - (1 - C) A = q (A(beta) - A),   D = C - A = a - 1 - q,   P = beta S + (1 + C) A.
!> A(beta) - A is a difference of two cotangents and has the exact form (d p(s) - s
!> p(d))/(sin(alpha/2) sin(beta/2)), s and d half the sum and half the difference of the two angles,
!> p(x) = x - sin x.
module couplet_heyman_curves
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_equations, only : arc_excess, arm_excess, embrace_deficit, springing_thrust, &
      & unit_angle, unit_angle_tail, versine, weight_arm, weight_flag
   implicit none
   private

   public :: equilibrium_thickness, initial_thickness, curve_slope, thrust_line
   public :: embrace_difference, settle_cubic

contains

   !> A(beta) - A(alpha), exact to the last digits for any two angles
   elemental real(wp) function embrace_difference(beta, alpha, alpha_tail) result(difference)
      real(wp), intent(in) :: beta        !! One angle, (0, pi) [rad]
      real(wp), intent(in) :: alpha       !! The other, (0, pi) [rad]
      real(wp), intent(in) :: alpha_tail  !! True half angle minus alpha; 0 if alpha is exact [rad]
      real(wp) :: s, d

      if (4.0_wp*beta < alpha) then
         difference = embrace_deficit(alpha) - embrace_deficit(beta)
      else
         s = 0.5_wp*(alpha + beta)
         d = 0.5_wp*((alpha - beta) + alpha_tail)
         difference = (d*arc_excess(s) - s*arc_excess(d))/(sin(0.5_wp*alpha)*sin(0.5_wp*beta))
      end if
   end function embrace_difference

   !> Eqs. (14) and (16): thickness ratio required for equilibrium with the inner hinge at beta
   !>
   !> Heyman and CCR: the positive root of the quadratic, rationalised. Milankovitch: Newton's
   !> method on the cubic from there. At beta = 0 it is eq. (26).
   elemental function equilibrium_thickness(beta, alpha, which) result(eta)
      real(wp), intent(in) :: beta   !! Inner hinge, [0, alpha] [rad]
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, alpha_limit] [rad]
      integer, intent(in) :: which   !! One of `theory`
      real(wp) :: eta                !! Thickness ratio [-]
      real(wp) :: q, excess, d, p, root, cubic

      if (beta <= 0.0_wp) then
         eta = initial_thickness(alpha, which)
         return
      end if
      q = versine(beta)
      excess = q*embrace_difference(beta, alpha, 0.0_wp)
      d = unit_shortfall(alpha) - q
      p = beta*sin(beta) + (2.0_wp - q)*(2.0_wp - embrace_deficit(alpha))
      root = sqrt(d*d + p*excess)
      if (d < 0.0_wp) then
         eta = 2.0_wp*excess/(root - d)
      else
         eta = 2.0_wp*(d + root)/p
      end if
      cubic = weight_flag(which)*cos(beta)/12.0_wp
      if (abs(cubic) > 0.0_wp) call settle_cubic(excess, d, 0.25_wp*p, cubic, eta)
   end function equilibrium_thickness

   !> Smallest positive root of excess + d eta - p eta^2 + c eta^3, near a first guess
   elemental subroutine settle_cubic(excess, d, p, c, eta)
      real(wp), intent(in) :: excess  !! Coefficient of 1, not negative
      real(wp), intent(in) :: d       !! Coefficient of eta
      real(wp), intent(in) :: p       !! Coefficient of -eta^2
      real(wp), intent(in) :: c       !! Coefficient of eta^3
      real(wp), intent(inout) :: eta  !! First guess, the root for c = 0; then the root
      !> Newton's method doubles the digits: 3 to 6 are needed
      integer, parameter :: most_steps = 30
      real(wp) :: change, last_change
      integer :: step

      last_change = huge(last_change)
      do step = 1, most_steps
         change = -(excess + eta*(d - eta*(p - c*eta)))/(d - eta*(2.0_wp*p - 3.0_wp*c*eta))
         eta = eta + change
         if (abs(last_change) <= 1.0e-8_wp*eta .or. abs(change) <= 0.0_wp) exit
         last_change = change
      end do
   end subroutine settle_cubic

   !> 1 - A(alpha), exact to the last digits also where A is close to 1
   elemental real(wp) function unit_shortfall(alpha)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, pi) [rad]

      if (abs(alpha - unit_angle) < 0.5_wp) then
         unit_shortfall = -embrace_difference(alpha, unit_angle, unit_angle_tail)
      else
         unit_shortfall = embrace_deficit(alpha) - 1.0_wp
      end if
   end function unit_shortfall

   !> Eq. (26), and (15) from below: eta_0, the equilibrium curve at beta = 0
   elemental function initial_thickness(alpha, which) result(eta)
      real(wp), intent(in) :: alpha
      integer, intent(in) :: which
      !> 0 if A >= 1; else 2 (1/A - 1), or 3 (A - sqrt((A + 2)(A - 2/3))) for Milankovitch [-]
      real(wp) :: eta
      real(wp) :: a, shortfall

      shortfall = max(unit_shortfall(alpha), 0.0_wp)
      a = 1.0_wp - shortfall
      if (weight_flag(which) > 0.0_wp) then
         eta = 4.0_wp*shortfall/(a + sqrt(a*a - 4.0_wp/3.0_wp*shortfall))
      else
         eta = 2.0_wp*shortfall/a
      end if
   end function initial_thickness

   !> Eq. (19): slope d eta/d beta of the equilibrium curve
   !>
   !> -S ((a - k/S)(1 - eta^2/4) - eta m)/(D - eta P/2 + delta_M C eta^2/4) with eta on the curve; 0
   !> at beta = 0, except for A = 1, where it tends to 1.
   elemental function curve_slope(beta, alpha, which) result(slope)
      real(wp), intent(in) :: beta  !! Inner hinge, (0, alpha] [rad]
      real(wp), intent(in) :: alpha
      integer, intent(in) :: which
      real(wp) :: slope             !! d eta/d beta [1/rad]
      real(wp) :: eta, deficit, q, d, p, stationary, growth

      eta = equilibrium_thickness(beta, alpha, which)
      deficit = embrace_deficit(alpha)
      q = versine(beta)
      d = unit_shortfall(alpha) - q
      p = beta*sin(beta) + (2.0_wp - q)*(2.0_wp - deficit)
      stationary = (sin(beta)*deficit - arm_excess(beta))*(1.0_wp - 0.25_wp*eta*eta) &
                 - sin(beta)*eta*weight_arm(eta, which)
      growth = d - 0.5_wp*eta*p + 0.25_wp*weight_flag(which)*cos(beta)*eta*eta
      slope = -stationary/growth
   end function curve_slope

   !> Eq. (11): thrust line through the extrados of crown and springing
   !>
   !> 1 + e = (2 + eta) Q/(eta (beta S + h2 C)) with h2 of eq. (8): 2e/t, -1 at the extrados, 1 at
   !> the intrados
   elemental real(wp) function thrust_line(beta, alpha, eta, which)
      real(wp), intent(in) :: beta  !! Angle of the joint, [0, alpha] [rad]
      real(wp), intent(in) :: alpha
      real(wp), intent(in) :: eta   !! Thickness ratio, large enough for a thrust h2 > 0 [-]
      integer, intent(in) :: which
      real(wp) :: excess, normal

      thrust_line = -1.0_wp
      if (beta <= 0.0_wp) return
      excess = versine(beta)*embrace_difference(beta, alpha, 0.0_wp)
      normal = beta*sin(beta) + springing_thrust(alpha, eta, which)*cos(beta)
      thrust_line = (2.0_wp + eta)*excess/(eta*normal) - 1.0_wp
   end function thrust_line

end module couplet_heyman_curves
