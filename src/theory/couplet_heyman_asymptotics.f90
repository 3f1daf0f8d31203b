!> Critical solutions as power series: at small half angles, and next to the limit of each theory
!>
!> Exact rationals, found by eliminating order by order. The small-angle series hold beta to alpha^6
!> and eta and h to alpha^8 relative to their leading terms (Heyman's eta to alpha^6); the limit
!> series are leading terms.
module couplet_heyman_asymptotics
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_theories, only : limits_of, limits_t, theory, weight_flag
   implicit none
   private

   public :: small_angle_solution, near_limit_solution

   !> A quarter of a turn [rad]
   real(wp), parameter :: quarter = 0.5_wp*acos(-1.0_wp)

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

contains

   !> Critical solution at a small half angle
   elemental subroutine small_angle_solution(alpha, which, beta, eta, h)
      !> Half angle of embrace; 0.1 gives eight digits or more [rad]
      real(wp), intent(in) :: alpha
      !> One of `theory`
      integer, intent(in) :: which
      !> alpha/sqrt(2) (1 + ...) [rad]
      real(wp), intent(out) :: beta
      !> alpha^4 (1/48 + ...) [-]
      real(wp), intent(out) :: eta
      !> 1 - alpha^2/6 + ... [w r]
      real(wp), intent(out) :: h
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
      !> alpha_limit - alpha [rad]
      real(wp), intent(in) :: distance
      integer, intent(in) :: which
      !> Inner hinge [rad]
      real(wp), intent(out) :: beta
      !> Thickness ratio [-]
      real(wp), intent(out) :: eta
      !> Thrust [w r]
      real(wp), intent(out) :: h
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
      !> Coefficients, constant first: (:)
      real(wp), intent(in) :: coefficient(:)
      !> Variable
      real(wp), intent(in) :: t
      integer :: i

      power_sum = 0.0_wp
      do i = size(coefficient), 1, -1
         power_sum = coefficient(i) + t*power_sum
      end do
   end function power_sum

end module couplet_heyman_asymptotics
