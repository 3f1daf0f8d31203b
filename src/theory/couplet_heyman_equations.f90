!> Equilibrium of a part of the arch and tangency of the thrust, eqs. (1) to (13), and functions of
!> an angle without cancellation
!>
!> Lengths are over the mean radius r, forces over w r with w the weight per length of the centre
!> line; beta is the angle from the crown, S = sin beta, C = cos beta, m = 1 + delta_M eta^2/12.
!> With q = 1 - C, beta S = q A(beta) and a = 2 - A every difference of the printed forms becomes a
!> sum of terms that are as small as the result. Ranges are not checked here; results are undefined
!> outside 0 < eta < 2, 0 <= beta < pi, h >= 0.
!>
!> All theories of the circular arch contain differences such as x - sin x, 1 - cos x and
!> 2 - x cot(x/2). Evaluated directly they lose two digits per digit of a smaller angle. Here each
!> is summed or factored, so that its relative error is a few units in the last place from 0 to pi.
!>
!> The three theories of the circular arch differ in two flags of the equations. delta_M = 1 if the
!> weight of a part acts in its true centre of gravity, at the radius r (1 + eta^2/12). delta_CCR =
!> 1 if the thrust line, not the resultant, touches the intrados. Heyman is (delta_CCR, delta_M) =
!> (0, 0), CCR (1, 0), Milankovitch (1, 1).
module couplet_heyman_equations
   use, intrinsic :: iso_fortran_env, only : wp => real64
   implicit none
   private

   public :: heyman_thickness, heyman_thrust, eccentricity
   public :: thrust_through, springing_thrust, tangent_thrust
   public :: arc_excess, versine, arm_excess, embrace, embrace_deficit
   public :: theory, weight_flag, tangency_flag, weight_arm
   public :: limits_t, limits_of, unit_angle, unit_angle_tail

   !> Names of the theories
   type :: theory_enum
      integer :: heyman = 1  !! Resultant tangent to the intrados, weight along the centre line
      !> Thrust line tangent to the intrados, weight along the centre line (Cocchetti, Colasante,
      !> Rizzi)
      integer :: ccr = 2
      integer :: milankovitch = 3  !! Thrust line tangent to the intrados, true centre of weight
   end type theory_enum

   !> The names in use
   type(theory_enum), parameter :: theory = theory_enum()

   !> Limit of a theory, and its largest inner hinge
   type :: limits_t
      real(wp) :: alpha_limit  !! Largest half angle of embrace; the thrust vanishes there [rad]
      real(wp) :: alpha_limit_tail  !! True angle minus alpha_limit [rad]
      real(wp) :: embrace_limit     !! A there, eq. (9)
      real(wp) :: eta_limit         !! Thickness ratio there
      real(wp) :: beta_limit        !! Inner hinge there [rad]
      real(wp) :: beta_max          !! Largest inner hinge of all half angles [rad]
      real(wp) :: alpha_beta_max    !! Half angle of the largest inner hinge [rad]
      real(wp) :: embrace_beta_max  !! A there
      real(wp) :: eta_beta_max      !! Thickness ratio there
      real(wp) :: h_beta_max        !! Thrust there
   end type limits_t

   !> Half angle at which A = 1: eta(beta) starts from 0 up to here, from eta_0 > 0 beyond, eq. (26)
   !> [rad]
   real(wp), parameter :: unit_angle = 2.331122370414422613667835955917121338269_wp
   !> True angle minus unit_angle [rad]
   real(wp), parameter :: unit_angle_tail = -2.1492054957191997e-16_wp
   !> 180 degrees [rad]
   real(wp), parameter :: pi = acos(-1.0_wp)
   !> Root of A(alpha) = 1/(2 - 2/pi) [rad]
   real(wp), parameter :: heyman_limit = 2.589570610685359957177303898711322916197_wp

   !> Heyman: the hinge moves outward all the way to pi/2, where A = h + 2/(2 + eta) with h = 0
   type(limits_t), parameter :: limits_heyman = limits_t(heyman_limit, 1.9328559307170065e-16_wp, &
      1.0_wp/(2.0_wp - 2.0_wp/pi), 2.0_wp - 4.0_wp/pi, 0.5_wp*pi, 0.5_wp*pi, heyman_limit, &
      1.0_wp/(2.0_wp - 2.0_wp/pi), 2.0_wp - 4.0_wp/pi, 0.0_wp)

   !> CCR: A = 2/3 at the end; beta_max is the root of beta^2 C^2 = 2 S (1 - C) (beta - S), the
   !> double root of eq. (24)
   type(limits_t), parameter :: limits_ccr = limits_t( &
      2.648388899151005411477459039384470488123_wp, 1.8071037322011747e-17_wp, &
      2.0_wp/3.0_wp, 1.0_wp, 0.0_wp, 1.129085087576186994051896032959304768148_wp, &
      2.230312828619945767618840353057568904543_wp, 1.092920383385939913716222971351943908588_wp, &
      0.4214141735986856039203466115754708964254_wp, 0.266956770136077484920868551242805036414_wp)

   !> Milankovitch: A = sqrt(3) - 1 at the end; beta_max is the double root of eq. (25)
   type(limits_t), parameter :: limits_milankovitch = limits_t( &
      2.590843443008954904194295853521347980521_wp, 4.3620728650857365e-17_wp, &
      sqrt(3.0_wp) - 1.0_wp, 4.0_wp*sqrt(3.0_wp) - 6.0_wp, 0.0_wp, &
      1.119864231443751759677211632949239426283_wp, 2.196404448812123636437088116361977022281_wp, &
      1.122875901494054326467406441955843226411_wp, 0.3975610062458916058061058649064443943728_wp, &
      0.2777076435564898670072228711849933559703_wp)

   !> Argument below which power series are faster and more accurate [rad]
   real(wp), parameter :: series_range = 1.5_wp
   !> Terms of the power series up to the last digit
   integer, parameter :: terms = 11

contains

   !> delta_M: 1 if the weight acts in the true centre of gravity
   elemental real(wp) function weight_flag(which)
      integer, intent(in) :: which  !! One of `theory`

      weight_flag = merge(1.0_wp, 0.0_wp, which == theory%milankovitch)
   end function weight_flag

   !> delta_CCR: 1 if the thrust line touches the intrados, 0 if the resultant does
   elemental real(wp) function tangency_flag(which)
      integer, intent(in) :: which

      tangency_flag = merge(0.0_wp, 1.0_wp, which == theory%heyman)
   end function tangency_flag

   !> Radius of the line of action of the weight, over r: 1 + delta_M eta^2/12
   elemental real(wp) function weight_arm(eta, which)
      real(wp), intent(in) :: eta  !! Thickness ratio [-]
      integer, intent(in) :: which

      weight_arm = 1.0_wp + weight_flag(which)*eta*eta/12.0_wp
   end function weight_arm

   !> Limits of validity of a theory
   pure type(limits_t) function limits_of(which)
      integer, intent(in) :: which

      limits_of = limits_ccr
      if (which == theory%heyman) limits_of = limits_heyman
      if (which == theory%milankovitch) limits_of = limits_milankovitch
   end function limits_of

   !> p(x) = x - sin x: length of an arc of the unit circle minus its half chord
   elemental real(wp) function arc_excess(x)
      real(wp), intent(in) :: x  !! Angle [rad]
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
      real(wp), intent(in) :: ratio(terms)  !! Ratios of terms over -y: (terms)
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

   !> Eq. (6): thrust of the thrust line through the crown's extrados and a given point of a joint
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

   !> Eq. (12): h_e, the thrust at which the thrust line touches the intrados at beta; for Heyman
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

   !> Eq. (10): position in the joint at beta of the thrust line through the crown's extrados
   !>
   !> 1 + e = q ((2 + eta)(A(beta) - h) - 2 m)/(eta (beta S + h C)): the crown keeps all its digits;
   !> 2e/t, -1 at the extrados, 1 at the intrados
   elemental real(wp) function eccentricity(beta, eta, h, which)
      real(wp), intent(in) :: beta  !! Angle of the joint, [0, pi) [rad]
      real(wp), intent(in) :: eta
      real(wp), intent(in) :: h     !! Horizontal thrust, positive if beta is 0 [w r]
      integer, intent(in) :: which
      real(wp) :: drop

      drop = (2.0_wp + eta)*((1.0_wp - h) - embrace_deficit(beta)) &
           + eta*(1.0_wp - weight_flag(which)*eta/6.0_wp)
      eccentricity = versine(beta)*drop/(eta*(beta*sin(beta) + h*cos(beta))) - 1.0_wp
   end function eccentricity
end module couplet_heyman_equations
