!> Critical solutions of the Couplet-Heyman problem: hinge, thickness and thrust at a half angle
!>
!> The smallest thickness is the maximum of the equilibrium curve eta(beta), eqs. (14) and (18). In
!> the symbols of couplet_heyman_curves the two are
!>
!>     E(eta, beta) = 0   and   a - k(beta)/S = 4 eta m/(4 - eta^2)
!>
!> with a = 2 - A and k(x) = sin x - x cos x. The second is solved for beta by Newton's method, with
!> eta on the curve. Because eta is stationary there, the derivative of k/S suffices for quadratic
!> convergence. Near the limit of A, the unknowns are the distances of eta and A from their limits.
!> The thrust, which vanishes there with the square of the distance, then keeps its digits.
!>
!> At small half angles, and next to the limit of each theory, power series exist too. Their
!> coefficients are exact rationals, found order by order. The small-angle series have beta to
!> alpha^6, eta and h to alpha^8 relative to their leading terms (Heyman's eta to alpha^6). The
!> limit series are leading terms.
module couplet_heyman_critical
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_curves, only : embrace_difference, settle_cubic
   use couplet_heyman_equations, only : arc_excess, arm_excess, embrace_deficit, heyman_thickness, &
      & heyman_thrust, limits_of, limits_t, springing_thrust, theory, versine, weight_arm, &
      & weight_flag
   implicit none
   private

   public :: small_angle_solution, near_limit_solution, critical_solution, is_embraced

   !> beta/(alpha/sqrt(2)) by powers of alpha^2: Heyman, CCR, Milankovitch
   real(wp), parameter :: beta_series(4, 3) = reshape([ &
      1.0_wp, -19.0_wp/480.0_wp, 943.0_wp/215040.0_wp, -172279.0_wp/516096000.0_wp, &
      1.0_wp, -17.0_wp/240.0_wp, 141.0_wp/17920.0_wp, -31951.0_wp/21504000.0_wp, &
      1.0_wp, -17.0_wp/240.0_wp, 141.0_wp/17920.0_wp, -31951.0_wp/21504000.0_wp], [4, 3])

   !> eta/alpha^4 by powers of alpha^2
   real(wp), parameter :: eta_series(5, 3) = reshape([ &
      1.0_wp/48.0_wp, -1.0_wp/480.0_wp, 991.0_wp/2764800.0_wp, -21829.0_wp/580608000.0_wp, 0.0_wp, &
      1.0_wp/48.0_wp, -1.0_wp/480.0_wp, 19.0_wp/43200.0_wp, -661.0_wp/9072000.0_wp, &
      20517029.0_wp/1341204480000.0_wp, &
      1.0_wp/48.0_wp, -1.0_wp/480.0_wp, 19.0_wp/43200.0_wp, -661.0_wp/9072000.0_wp, &
      10763827.0_wp/670602240000.0_wp], [5, 3])

   !> h by powers of alpha^2
   real(wp), parameter :: h_series(5, 3) = reshape([ &
      1.0_wp, -1.0_wp/6.0_wp, 11.0_wp/1440.0_wp, -67.0_wp/60480.0_wp, 99.0_wp/1433600.0_wp, &
      1.0_wp, -1.0_wp/6.0_wp, 11.0_wp/1440.0_wp, -67.0_wp/60480.0_wp, 59.0_wp/537600.0_wp, &
      1.0_wp, -1.0_wp/6.0_wp, 11.0_wp/1440.0_wp, -67.0_wp/60480.0_wp, 89.0_wp/1209600.0_wp], [5, 3])

   !> Half angle from which quantities are relative to the limit [rad]
   real(wp), parameter :: near_the_limit = 2.2_wp
   !> Relative step at which quadratic convergence has reached round-off
   real(wp), parameter :: short_step = 1.0e-9_wp
   !> Maximum number of steps; three are usual
   integer, parameter :: most_steps = 30
   !> A quarter of a turn [rad]
   real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp)

contains

   !> Critical solution at a small half angle
   elemental subroutine small_angle_solution(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace; 0.1 gives eight digits or more [rad]
      integer, intent(in) :: which   !! One of `theory`
      real(wp), intent(out) :: beta  !! alpha/sqrt(2) (1 + ...) [rad]
      real(wp), intent(out) :: eta   !! alpha^4 (1/48 + ...) [-]
      real(wp), intent(out) :: h     !! 1 - alpha^2/6 + ... [w r]
      real(wp) :: t

      t = alpha*alpha
      beta = alpha/sqrt(2.0_wp)*power_sum(beta_series(:, which), t)
      eta = t*t*power_sum(eta_series(:, which), t)
      h = power_sum(h_series(:, which), t)
   end subroutine small_angle_solution

   !> Leading terms of the critical solution next to the limit of validity
   !>
   !> CCR: A - A_limit = beta^2/27, eta_limit - eta = beta^2/6, h = beta^4/24. Milankovitch: (2 -
   !> sqrt 3) beta^2/12, (2 sqrt 3 - 3) beta^2/3, sqrt(3) beta^4/36. Heyman is linear in pi/2 -
   !> beta.
   elemental subroutine near_limit_solution(distance, which, beta, eta, h)
      real(wp), intent(in) :: distance  !! alpha_limit - alpha [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta  !! Inner hinge [rad]
      real(wp), intent(out) :: eta   !! Thickness ratio [-]
      real(wp), intent(out) :: h     !! Thrust [w r]
      type(limits_t) :: limits
      real(wp) :: excess, c, eta_rate

      limits = limits_of(which)
      excess = distance*(0.5_wp*limits%alpha_limit/sin(0.5_wp*limits%alpha_limit)**2 &
                         - 1.0_wp/tan(0.5_wp*limits%alpha_limit))
      if (which == theory%heyman) then
         eta_rate = limits%eta_limit*(1.0_wp/(quarter - 1.0_wp) - 1.0_wp/quarter + 2.0_wp)
         c = excess/(quarter + 2.0_wp*eta_rate/(2.0_wp + limits%eta_limit)**2)
         beta = quarter - c
         eta = limits%eta_limit - eta_rate*c
         h = quarter*c
      else if (weight_flag(which) > 0.0_wp) then
         beta = sqrt(12.0_wp*excess/(2.0_wp - sqrt(3.0_wp)))
         eta = limits%eta_limit - (2.0_wp*sqrt(3.0_wp) - 3.0_wp)/3.0_wp*beta**2
         h = sqrt(3.0_wp)/36.0_wp*beta**4
      else
         beta = sqrt(27.0_wp*excess)
         eta = limits%eta_limit - beta**2/6.0_wp
         h = beta**4/24.0_wp
      end if
   end subroutine near_limit_solution

   !> Sum of a power series
   pure real(wp) function power_sum(coefficient, t)
      real(wp), intent(in) :: coefficient(:)  !! Coefficients, constant first: (:)
      real(wp), intent(in) :: t               !! Variable
      integer :: i

      power_sum = 0.0_wp
      do i = size(coefficient), 1, -1
         power_sum = coefficient(i) + t*power_sum
      end do
   end function power_sum

   !> True if a theory has a critical solution at a half angle: 0 < alpha <= alpha_limit; false for
   !> a NaN
   elemental logical function is_embraced(alpha, which)
      real(wp), intent(in) :: alpha  !! Half angle of embrace [rad]
      integer, intent(in) :: which
      type(limits_t) :: limits

      limits = limits_of(which)
      is_embraced = alpha > 0.0_wp .and. alpha <= limits%alpha_limit
   end function is_embraced

   !> Critical hinge, thickness and thrust; NaN outside the range of validity
   elemental subroutine critical_solution(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, alpha_limit] [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta  !! Inner hinge from the crown [rad]
      real(wp), intent(out) :: eta   !! Critical thickness ratio t/r [-]
      real(wp), intent(out) :: h     !! Horizontal thrust H/(w r) [-]

      if (.not. is_embraced(alpha, which)) then
         beta = ieee_value(beta, ieee_quiet_nan)
         eta = beta
         h = beta
      else if (which == theory%heyman) then
         if (alpha < near_the_limit) call heyman_shallow(alpha, beta, eta, h)
         if (alpha >= near_the_limit) call heyman_steep(alpha, beta, eta, h)
      else
         if (alpha < near_the_limit) call tangent_shallow(alpha, which, beta, eta, h)
         if (alpha >= near_the_limit) call tangent_steep(alpha, which, beta, eta, h)
      end if
   end subroutine critical_solution

   !> First guess of the inner hinge of CCR and Milankovitch, within 0.3 percent
   !>
   !> beta^2 = a (w - w0) (polynomial in w) with w = sqrt(A - A_limit + w0^2): the form has both
   !> limits of the solution, alpha/sqrt(2) at small angles and the square root of A - A_limit; the
   !> coefficients are a fit.
   elemental function first_guess(deficit, excess, which) result(beta)
      real(wp), intent(in) :: deficit  !! 2 - A
      real(wp), intent(in) :: excess   !! A - A_limit
      integer, intent(in) :: which     !! One of `theory`, but not Heyman
      real(wp) :: beta  !! Inner hinge [rad]
      real(wp), parameter :: bend(2) = [0.0075248_wp, 0.0024009_wp]  !! w0^2 of CCR and Milankovitch
      !> Coefficients of 1 to w^4
      real(wp), parameter :: fit(5, 2) = reshape([ &
         3.86421_wp, -4.71057_wp, 7.06753_wp, -6.76118_wp, 3.00812_wp, &
         3.62088_wp, -3.67069_wp, 5.27882_wp, -5.40080_wp, 2.67822_wp], [5, 2])
      real(wp) :: w, rise, form
      integer :: i

      i = merge(2, 1, which == theory%milankovitch)
      w = sqrt(excess + bend(i))
      rise = excess/(w + sqrt(bend(i)))
      form = fit(1, i) + w*(fit(2, i) + w*(fit(3, i) + w*(fit(4, i) + w*fit(5, i))))
      beta = sqrt(deficit*rise*form)
   end function first_guess

   !> CCR and Milankovitch at moderate half angles
   elemental subroutine tangent_shallow(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, near_the_limit) [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta, eta
      real(wp), intent(out) :: h     !! Thrust [w r]
      type(limits_t) :: limits
      real(wp) :: deficit, flag, sine, cosine, q, excess, d, p, ratio, change
      integer :: step

      limits = limits_of(which)
      flag = weight_flag(which)
      deficit = embrace_deficit(alpha)
      beta = first_guess(deficit, 2.0_wp - limits%embrace_limit - deficit, which)
      do step = 1, most_steps
         sine = sin(beta)
         q = versine(beta)
         cosine = 1.0_wp - q
         excess = q*embrace_difference(beta, alpha, 0.0_wp)
         d = deficit - 1.0_wp - q
         p = beta*sine + (2.0_wp - q)*(2.0_wp - deficit)
         eta = 2.0_wp*excess/(sqrt(d*d + p*excess) - d)
         if (flag > 0.0_wp) call settle_cubic(excess, d, 0.25_wp*p, cosine/12.0_wp, eta)
         ratio = arm_excess(beta)/sine
         change = deficit - ratio - 4.0_wp*eta*weight_arm(eta, which)/(4.0_wp - eta*eta)
         change = change/(beta - ratio*cosine/sine)
         beta = beta + change
         if (abs(change) <= short_step*beta) exit
      end do
      h = springing_thrust(alpha, eta, which)
   end subroutine tangent_shallow

   !> CCR and Milankovitch near their limit, in x = A - A_limit and y = eta_limit - eta
   !>
   !> With e = eta_limit, E(e) = -(1 - e^2/4) 4 sin(beta/2) k(beta/2) - x (q (1 - e^2/4) + e (1 +
   !> e/2)), and the condition of tangency is f(e) - f(e - y) - x = k/S with f = 4 eta m/(4 -
   !> eta^2). The thrust is h1 of eq. (7).
   elemental subroutine tangent_steep(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, [near_the_limit, alpha_limit] [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta, eta, h
      type(limits_t) :: limits
      real(wp) :: x, y, e, a, flag, sine, cosine, q, p, value, slope, bend, ratio, change
      integer :: step

      limits = limits_of(which)
      flag = weight_flag(which)
      e = limits%eta_limit
      x = embrace_difference(alpha, limits%alpha_limit, limits%alpha_limit_tail)
      a = limits%embrace_limit + x
      beta = first_guess(2.0_wp - a, x, which)
      do step = 1, most_steps
         sine = sin(beta)
         q = versine(beta)
         cosine = 1.0_wp - q
         p = beta*sine + (2.0_wp - q)*a
         value = (1.0_wp - 0.25_wp*e*e)*(4.0_wp*sin(0.5_wp*beta)*arm_excess(0.5_wp*beta) + x*q) &
               + x*e*(1.0_wp + 0.5_wp*e)
         slope = cosine - a - 0.5_wp*e*p + 0.25_wp*flag*cosine*e*e
         bend = 0.25_wp*(p - flag*cosine*e)
         y = 2.0_wp*value/(sqrt(max(slope*slope - 4.0_wp*bend*value, 0.0_wp)) - slope)
         if (flag > 0.0_wp) call settle_cubic(value, slope, -bend, cosine/12.0_wp, y)
         ratio = arm_excess(beta)/sine
         change = (tangency_drop(y, e, flag) - x - ratio)/(beta - ratio*cosine/sine)
         beta = beta + change
         if (abs(change) <= short_step*beta) exit
      end do
      eta = e - y
      q = versine(beta)
      h = y*(2.0_wp + flag*(2.0_wp*e - y)/6.0_wp) - embrace_deficit(beta)*(2.0_wp - eta)
      h = q*h/(2.0_wp*eta + (2.0_wp - eta)*q)
   end subroutine tangent_steep

   !> f(e) - f(e - y) with f(eta) = 4 eta m/(4 - eta^2), without a difference of nearly equal
   !> numbers
   elemental real(wp) function tangency_drop(y, e, flag) result(drop)
      real(wp), intent(in) :: y     !! e - eta
      real(wp), intent(in) :: e     !! Thickness ratio at the limit [-]
      real(wp), intent(in) :: flag  !! delta_M
      real(wp) :: numerator, denominator

      numerator = e*(4.0_wp + flag*e*e/3.0_wp)
      denominator = 4.0_wp - e*e
      drop = numerator*(2.0_wp*e - y) + denominator*(4.0_wp + flag*(e*e - y*(e - y/3.0_wp)))
      drop = y*drop/(denominator*(4.0_wp - (e - y)**2))
   end function tangency_drop

   !> Heyman at moderate half angles: a = k(beta)/S + eta/(2 + eta) with eq. (2), a sum of positive
   !> terms
   elemental subroutine heyman_shallow(alpha, beta, eta, h)
      real(wp), intent(in) :: alpha
      real(wp), intent(out) :: beta, eta, h
      real(wp) :: deficit, change
      integer :: step

      deficit = embrace_deficit(alpha)
      beta = heyman_guess(alpha)
      do step = 1, most_steps
         eta = heyman_thickness(beta)
         change = (deficit - arm_excess(beta)/sin(beta) - eta/(2.0_wp + eta))/heyman_rate(beta, eta)
         beta = beta + change
         if (abs(change) <= short_step*beta) exit
      end do
      eta = heyman_thickness(beta)
      h = heyman_thrust(beta)
   end subroutine heyman_shallow

   !> Heyman near the limit, in c = pi/2 - beta: A - A_limit = beta tan c + eta_l/(2 + eta_l) -
   !> eta/(2 + eta)
   !>
   !> With T = tan^2(beta/2) = (1 - sin c)/(1 + sin c),
   !> (eta_l - eta)/2 = (1 - 2/pi)(1 - T) + T (2 c - pi (1 - cos c))/(pi beta).
   elemental subroutine heyman_steep(alpha, beta, eta, h)
      real(wp), intent(in) :: alpha
      real(wp), intent(out) :: beta, eta, h
      type(limits_t) :: limits
      real(wp) :: excess, c, squared, half_drop, change
      integer :: step
      logical :: settled

      limits = limits_of(theory%heyman)
      excess = embrace_difference(alpha, limits%alpha_limit, limits%alpha_limit_tail)
      c = quarter - heyman_guess(alpha)
      settled = .false.
      do step = 1, most_steps
         beta = quarter - c
         squared = (1.0_wp - sin(c))/(1.0_wp + sin(c))
         half_drop = (1.0_wp - 1.0_wp/quarter)*2.0_wp*sin(c)/(1.0_wp + sin(c)) &
                   + squared*(c - quarter*versine(c))/(quarter*beta)
         eta = limits%eta_limit - 2.0_wp*half_drop
         h = beta*tan(c)
         change = excess - h - 4.0_wp*half_drop/((2.0_wp + limits%eta_limit)*(2.0_wp + eta))
         change = change/heyman_rate(beta, eta)
         if (settled) exit
         c = c + change
         settled = abs(change) <= short_step*abs(c)
      end do
   end subroutine heyman_steep

   !> First guess of Heyman's inner hinge, a fit within 0.03 percent
   elemental function heyman_guess(alpha) result(beta)
      real(wp), intent(in) :: alpha
      real(wp) :: beta
      !> beta/alpha by powers of alpha^2
      real(wp), parameter :: fit(4) = [0.7070238_wp, -0.0273851_wp, 0.0025932_wp, -0.0001112_wp]

      beta = alpha*(fit(1) + alpha**2*(fit(2) + alpha**2*(fit(3) + alpha**2*fit(4))))
   end function heyman_guess

   !> -dA/d beta along Heyman's solution: (k/S)' + 2 eta'/(2 + eta)^2
   elemental real(wp) function heyman_rate(beta, eta) result(rate)
      real(wp), intent(in) :: beta
      real(wp), intent(in) :: eta  !! Thickness ratio there, eq. (2) [-]
      real(wp) :: eta_rate

      eta_rate = eta*(versine(beta)/arc_excess(beta) - 1.0_wp/beta + 2.0_wp/sin(beta))
      rate = beta - arm_excess(beta)*cos(beta)/sin(beta)**2 + 2.0_wp*eta_rate/(2.0_wp + eta)**2
   end function heyman_rate

end module couplet_heyman_critical
