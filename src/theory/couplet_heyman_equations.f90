!> Equilibrium of a chunk of the arch and tangency of the thrust: eqs. (1) to (13) of the paper; and
!> small functions of an angle that keep every digit where the textbook form cancels
!>
!> Lengths are over the mean radius r, forces over w r with w the weight per length of the centre
!> line; beta is the angle from the crown, S = sin beta, C = cos beta, m = 1 + delta_M eta^2/12.
!> With q = 1 - C, beta S = q A(beta) and a = 2 - A every difference of the printed forms becomes a
!> sum of terms that are as small as the result. No range is checked here; outside 0 < eta < 2, 0 <=
!> beta < pi, h >= 0 the results mean nothing.
!>
!> All theories of the circular arch are written with differences such as x - sin x, 1 - cos x and 2
!> - x cot(x/2). Taken literally they lose two digits with every digit by which the angle gets
!> smaller. Here each is summed or factored so that its relative error stays at a few units in the
!> last place from 0 to pi.
module couplet_heyman_equations
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_theories, only : tangency_flag, theory, weight_arm, weight_flag
   implicit none
   private

   public :: heyman_thickness, heyman_thrust, eccentricity
   public :: thrust_through, springing_thrust, tangent_thrust
   public :: arc_excess, versine, arm_excess, embrace, embrace_deficit

   !> Below this argument [rad] the power series are shorter and sharper than sine and cosine
   real(wp), parameter :: series_range = 1.5_wp
   !> Terms that reach the last digit there
   integer, parameter :: terms = 11

contains

   !> p(x) = x - sin x: what an arc of the unit circle is longer than its half chord
   elemental real(wp) function arc_excess(x)
      !> Angle [rad]
      real(wp), intent(in) :: x
      !> Ratios of the series, 1/(2i (2i + 1))
      real(wp), parameter :: ratio(terms) = &
         1.0_wp/real([20, 42, 72, 110, 156, 210, 272, 342, 420, 506, 600], wp)

      if (abs(x) < series_range) then
         arc_excess = x*x*x/6.0_wp*nested_series(x*x, ratio)
      else
         arc_excess = x - sin(x)
      end if
   end function arc_excess

   !> q(x) = 1 - cos x = 2 sin^2(x/2)
   elemental real(wp) function versine(x)
      real(wp), intent(in) :: x

      versine = 2.0_wp*sin(0.5_wp*x)**2
   end function versine

   !> k(x) = sin x - x cos x
   elemental real(wp) function arm_excess(x)
      real(wp), intent(in) :: x
      !> Ratios of the series, 1/(2i (2i + 3))
      real(wp), parameter :: ratio(terms) = &
         1.0_wp/real([10, 28, 54, 88, 130, 180, 238, 304, 378, 460, 550], wp)

      if (abs(x) < series_range) then
         arm_excess = x*x*x/3.0_wp*nested_series(x*x, ratio)
      else
         arm_excess = sin(x) - x*cos(x)
      end if
   end function arm_excess

   !> A(x) = x cot(x/2), eq. (9), the group through which the half angle of embrace enters every
   !> theory
   elemental function embrace(x) result(a)
      real(wp), intent(in) :: x  !! Angle in (-pi, pi); 0 is allowed [rad]
      real(wp) :: a              !! x cot(x/2), from 2 at 0 down to 0 at pi

      if (abs(x) < 1.0_wp) then
         a = 2.0_wp - embrace_deficit(x)
      else
         a = x/tan(0.5_wp*x)
      end if
   end function embrace

   !> a(x) = 2 - A(x) = 2 - x cot(x/2) = 2 k(x/2)/sin(x/2)
   elemental function embrace_deficit(x) result(a)
      real(wp), intent(in) :: x
      real(wp) :: a  !! 2 - x cot(x/2), from 0 at 0 up to 2 at pi

      a = 0.0_wp
      if (abs(x) > 0.0_wp) a = 2.0_wp*arm_excess(0.5_wp*x)/sin(0.5_wp*x)
   end function embrace_deficit

   !> 1 - y r(1) (1 - y r(2) (1 - ...)): an alternating series from its last term
   pure real(wp) function nested_series(y, ratio)
      real(wp), intent(in) :: y             !! Square of the argument
      real(wp), intent(in) :: ratio(terms)  !! Each term over the one before it and over -y: (terms)
      integer :: i

      nested_series = 1.0_wp
      do i = terms, 1, -1
         nested_series = 1.0_wp - y*ratio(i)*nested_series
      end do
   end function nested_series

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
