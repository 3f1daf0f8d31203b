!> Interface of the three theories for f2py
!>
!> Subroutines with explicit sizes, arrays of one rank and no optional arguments, as required by
!> f2py. Each processes n elements. `fault` has the first value outside the range of validity: the
!> position of its argument in the call, from 1, and its element, from 1. Both are 0 without fault,
!> and only then are the results set. `which` is one of `theory` in couplet_heyman_equations.
module theory_api
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_critical, only : critical_solution, is_embraced, near_limit_solution, &
      small_angle_solution
   use couplet_heyman_curves, only : curve_slope, equilibrium_thickness, initial_thickness, &
      thrust_line
   use couplet_heyman_domain, only : is_half_angle, is_joint, is_thickness, set_fault
   use couplet_heyman_equations, only : limits_of, limits_t, springing_thrust, unit_angle
   use couplet_heyman_printed, only : printed_critical
   implicit none
   private

   public :: critical, critical_as_printed, critical_small, critical_near_limit
   public :: curve, curve_start, slope, line, limit_values

contains

   !> Critical solution by the stable kernels
   subroutine critical(n, alpha, which, beta, eta, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n          !! Number of elements
      real(wp), intent(in) :: alpha(n)  !! Half angle of embrace, (0, alpha_limit]: (n) [rad]
      integer, intent(in) :: which      !! Theory
      real(wp), intent(out) :: beta(n)  !! Inner hinge: (n) [rad]
      real(wp), intent(out) :: eta(n)   !! Thickness ratio: (n) [-]
      real(wp), intent(out) :: h(n)     !! Thrust: (n) [w r]
      integer, intent(out) :: fault(2)  !! First fault: (2)

      call critical_solution(alpha, which, beta, eta, h)
      fault = 0
      call set_fault(1, is_embraced(alpha, which), fault)
   end subroutine critical

   !> Critical solution by eqs. (1), (23), (24) and (16) or (14) as printed
   subroutine critical_as_printed(n, alpha, which, beta, eta, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: beta(n), eta(n), h(n)
      integer, intent(out) :: fault(2)

      call printed_critical(alpha, which, beta, eta, h)
      fault = 0
      call set_fault(1, is_embraced(alpha, which), fault)
   end subroutine critical_as_printed

   !> Critical solution by its power series at small half angles
   subroutine critical_small(n, alpha, which, beta, eta, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: beta(n), eta(n), h(n)
      integer, intent(out) :: fault(2)

      call small_angle_solution(alpha, which, beta, eta, h)
      fault = 0
      call set_fault(1, is_embraced(alpha, which), fault)
   end subroutine critical_small

   !> Leading terms of the critical solution next to the limit of validity
   subroutine critical_near_limit(n, distance, which, beta, eta, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: distance(n)  !! alpha_limit - alpha, [0, alpha_limit): (n) [rad]
      integer, intent(in) :: which
      real(wp), intent(out) :: beta(n), eta(n), h(n)
      integer, intent(out) :: fault(2)
      type(limits_t) :: limits

      limits = limits_of(which)
      fault = 0
      call set_fault(1, distance >= 0.0_wp .and. distance < limits%alpha_limit, fault)
      if (all(fault == 0)) call near_limit_solution(distance, which, beta, eta, h)
   end subroutine critical_near_limit

   !> Eqs. (14) and (16): the equilibrium curve
   subroutine curve(n, beta, alpha, which, eta, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: beta(n)  !! Inner hinge, [0, alpha]: (n) [rad]
      real(wp), intent(in) :: alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: eta(n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(2, is_embraced(alpha, which), fault)
      call set_fault(1, is_joint(beta, alpha), fault)
      if (all(fault == 0)) eta = equilibrium_thickness(beta, alpha, which)
   end subroutine curve

   !> Eq. (26): start of the equilibrium curve at the crown
   subroutine curve_start(n, alpha, which, eta, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: eta(n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(1, is_embraced(alpha, which), fault)
      if (all(fault == 0)) eta = initial_thickness(alpha, which)
   end subroutine curve_start

   !> Eq. (19): slope of the equilibrium curve
   subroutine slope(n, beta, alpha, which, rate, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: beta(n), alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: rate(n)  !! d eta/d beta: (n) [1/rad]
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(2, is_embraced(alpha, which), fault)
      call set_fault(1, is_joint(beta, alpha), fault)
      if (all(fault == 0)) rate = curve_slope(beta, alpha, which)
   end subroutine slope

   !> Eq. (11): thrust line through the extrados of crown and springing
   subroutine line(n, beta, alpha, eta, which, ratio, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: beta(n)    !! Angle of the joint, [0, alpha]: (n) [rad]
      real(wp), intent(in) :: alpha(n)   !! Half angle of embrace, (0, pi): (n) [rad]
      real(wp), intent(in) :: eta(n)     !! Thickness ratio, (0, 2), with a thrust h2 > 0: (n) [-]
      integer, intent(in) :: which
      real(wp), intent(out) :: ratio(n)  !! 2e/t: (n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(2, is_half_angle(alpha), fault)
      call set_fault(1, is_joint(beta, alpha), fault)
      call set_fault(3, is_thickness(eta), fault)
      if (any(fault > 0)) return
      call set_fault(3, springing_thrust(alpha, eta, which) > 0.0_wp, fault)
      if (all(fault == 0)) ratio = thrust_line(beta, alpha, eta, which)
   end subroutine line

   !> Limits of validity
   subroutine limit_values(which, values)
      !f2py threadsafe
      integer, intent(in) :: which
      !> alpha, A, eta, beta, h at the limit; greatest beta and alpha, A, eta, h there; alpha where
      !> A = 1: (11)
      real(wp), intent(out) :: values(11)
      type(limits_t) :: limits

      limits = limits_of(which)
      values = [limits%alpha_limit, limits%embrace_limit, limits%eta_limit, limits%beta_limit, &
                0.0_wp, limits%beta_max, limits%alpha_beta_max, limits%embrace_beta_max, &
                limits%eta_beta_max, limits%h_beta_max, unit_angle]
   end subroutine limit_values

end module theory_api
