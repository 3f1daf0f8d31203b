!> Interface of eqs. (6) to (12) for f2py; conventions as in theory_api
module theory_equations_api
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_domain, only : is_finite, is_half_angle, is_joint, is_thickness, set_fault
   use couplet_heyman_equations, only : eccentricity, embrace, springing_thrust, tangent_thrust, &
      & thrust_through
   implicit none
   private

   public :: joint_eccentricity, group_a, thrust_at_joint, thrust_at_springing, thrust_at_tangent

contains

   !> Eq. (10): eccentricity of the thrust at a joint
   subroutine joint_eccentricity(n, beta, alpha, eta, h, which, ratio, fault)
      !f2py threadsafe
      integer, intent(in) :: n           !! Number of elements
      real(wp), intent(in) :: beta(n)    !! Angle of the joint, [0, alpha]: (n) [rad]
      real(wp), intent(in) :: alpha(n)   !! Half angle of embrace, (0, pi): (n) [rad]
      real(wp), intent(in) :: eta(n)     !! Thickness ratio, (0, 2): (n) [-]
      real(wp), intent(in) :: h(n)       !! Thrust, > 0: (n) [w r]
      integer, intent(in) :: which       !! Theory
      real(wp), intent(out) :: ratio(n)  !! 2e/t: (n)
      integer, intent(out) :: fault(2)   !! First fault: (2)

      fault = 0
      call set_fault(2, is_half_angle(alpha), fault)
      call set_fault(1, is_joint(beta, alpha), fault)
      call set_fault(3, is_thickness(eta), fault)
      call set_fault(4, h > 0.0_wp .and. is_finite(h), fault)
      if (all(fault == 0)) ratio = eccentricity(beta, eta, h, which)
   end subroutine joint_eccentricity

   !> Eq. (9): the group A
   subroutine group_a(n, alpha, a, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: alpha(n)
      real(wp), intent(out) :: a(n)  !! alpha cot(alpha/2): (n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(1, is_half_angle(alpha), fault)
      if (all(fault == 0)) a = embrace(alpha)
   end subroutine group_a

   !> Eqs. (6) and (7): thrust through the crown's extrados and a point of a joint
   subroutine thrust_at_joint(n, beta, ratio, eta, which, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: beta(n)   !! Angle of the joint, (0, pi): (n) [rad]
      real(wp), intent(in) :: ratio(n)  !! 2e/t of the point, [-1, 1]: (n)
      real(wp), intent(in) :: eta(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: h(n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(1, is_half_angle(beta), fault)
      call set_fault(2, abs(ratio) <= 1.0_wp, fault)
      call set_fault(3, is_thickness(eta), fault)
      if (all(fault == 0)) h = thrust_through(beta, ratio, eta, which)
   end subroutine thrust_at_joint

   !> Eq. (8): thrust through the extrados of crown and springing
   subroutine thrust_at_springing(n, alpha, eta, which, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: alpha(n), eta(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: h(n)  !! Thrust, negative if there is none: (n) [w r]
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(1, is_half_angle(alpha), fault)
      call set_fault(2, is_thickness(eta), fault)
      if (all(fault == 0)) h = springing_thrust(alpha, eta, which)
   end subroutine thrust_at_springing

   !> Eqs. (12) and (3): thrust at which the thrust line touches the intrados at a joint
   subroutine thrust_at_tangent(n, beta, eta, which, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: beta(n), eta(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: h(n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(1, is_half_angle(beta), fault)
      call set_fault(2, is_thickness(eta), fault)
      if (all(fault == 0)) h = tangent_thrust(beta, eta, which)
   end subroutine thrust_at_tangent

end module theory_equations_api
