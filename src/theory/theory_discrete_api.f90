!> Interface of friction and arches of voussoirs for f2py; conventions as in theory_api
module theory_discrete_api
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_critical, only : is_embraced
   use couplet_heyman_discrete, only : chords, discrete_critical, discrete_solution_t, &
      discrete_status, equal_voussoir_joints
   use couplet_heyman_domain, only : is_facet, is_half_angle, set_fault
   use couplet_heyman_friction, only : friction_limits, friction_limits_t, friction_solution
   implicit none
   private

   public :: friction_range, friction_states, discrete_equal, discrete_joints

contains

   !> Friction coefficients at which the mode of collapse changes
   subroutine friction_range(n, alpha, which, rotational, mixed, h, slip, springing, beta, &
                             eta, fault)
      !f2py threadsafe
      integer, intent(in) :: n          !! Number of elements
      real(wp), intent(in) :: alpha(n)  !! Half angle of embrace, (0, alpha_limit]: (n) [rad]
      integer, intent(in) :: which      !! Theory
      !> Smallest coefficient for a collapse by rotation alone: (n)
      real(wp), intent(out) :: rotational(n)
      real(wp), intent(out) :: mixed(n)  !! Smallest coefficient for any equilibrium: (n)
      real(wp), intent(out) :: h(n)      !! Thrust at the latter: (n) [w r]
      real(wp), intent(out) :: slip(n)   !! Joint of the haunch that slides there: (n) [rad]
      !> 1 if the springing slides first, 0 if the haunch does: (n)
      integer, intent(out) :: springing(n)
      !> Inner hinge at the smallest coefficient for any equilibrium: (n) [rad]
      real(wp), intent(out) :: beta(n)
      real(wp), intent(out) :: eta(n)   !! Thickness ratio there: (n) [-]
      integer, intent(out) :: fault(2)  !! First fault: (2)
      type(friction_limits_t) :: limits
      integer :: i

      fault = 0
      call set_fault(1, is_embraced(alpha, which), fault)
      if (any(fault > 0)) return
      do i = 1, n
         limits = friction_limits(alpha(i), which)
         rotational(i) = limits%mu_rotational
         mixed(i) = limits%mu_mixed
         h(i) = limits%h_mixed
         slip(i) = limits%beta_slip
         springing(i) = merge(1, 0, limits%springing_slides)
         beta(i) = limits%beta_mixed
         eta(i) = limits%eta_mixed
      end do
   end subroutine friction_range

   !> Smallest thickness at a friction coefficient, with its hinge and thrust
   subroutine friction_states(n, mu, alpha, which, beta, eta, h, fault)
      !f2py threadsafe
      integer, intent(in) :: n
      real(wp), intent(in) :: mu(n)  !! Friction coefficient, [mu_mixed, infinity]: (n)
      real(wp), intent(in) :: alpha(n)
      integer, intent(in) :: which
      real(wp), intent(out) :: beta(n)
      real(wp), intent(out) :: eta(n)
      real(wp), intent(out) :: h(n)
      integer, intent(out) :: fault(2)

      fault = 0
      call set_fault(2, is_embraced(alpha, which), fault)
      if (any(fault > 0)) return
      call friction_solution(mu, alpha, which, beta, eta, h)
      call set_fault(1, eta > 0.0_wp, fault)
   end subroutine friction_states

   !> Exact critical thickness of arches of equal polygon voussoirs
   subroutine discrete_equal(n, voussoirs, alpha, facet, friction, no_slip, &
                             status, eta, h, joint, role, fault)
      !f2py threadsafe
      integer, intent(in) :: n  !! Number of arches
      !> Number of voussoirs of the whole arch, 1 to 10 000 000: (n)
      integer, intent(in) :: voussoirs(n)
      real(wp), intent(in) :: alpha(n)  !! Half angle of embrace, (0, pi): (n) [rad]
      !> Largest span of a chord, 0 for one chord per voussoir: (n) [rad]
      real(wp), intent(in) :: facet(n)
      !> Friction angle, pi/2 or more for joints that cannot slide: (n) [rad]
      real(wp), intent(in) :: friction(n)
      integer, intent(in) :: no_slip        !! Nonzero if the springings cannot slide
      integer, intent(out) :: status(n)     !! Outcome, one of discrete_status: (n)
      real(wp), intent(out) :: eta(n)       !! Critical thickness ratio, 0 unless found: (n) [-]
      real(wp), intent(out) :: h(n)         !! Thrust there: (n) [gamma r^2 eta]
      real(wp), intent(out) :: joint(5, n)  !! Angles of the active joints: (5, n) [rad]
      integer, intent(out) :: role(5, n)    !! State of each, one of joint_role, 0 for none: (5, n)
      integer, intent(out) :: fault(2)
      integer, parameter :: most_voussoirs = 10000000
      integer :: i, no_fault(2)

      fault = 0
      call set_fault(1, voussoirs >= 1 .and. voussoirs <= most_voussoirs, fault)
      call set_fault(2, is_half_angle(alpha), fault)
      if (any(fault > 0)) return
      call set_fault(3, is_facet(facet), fault)
      call set_fault(4, friction >= 0.0_wp, fault)
      if (any(fault > 0)) return
      do i = 1, n
         associate (joints => equal_voussoir_joints(voussoirs(i), alpha(i)))
            call discrete_joints(size(joints), joints, facet(i), friction(i), no_slip, &
                                 status(i), eta(i), h(i), joint(:, i), role(:, i), no_fault)
         end associate
      end do
   end subroutine discrete_equal

   !> Exact critical thickness of one arch of polygon voussoirs, from the joints of one half
   subroutine discrete_joints(n, joints, facet, friction, no_slip, &
                              status, eta, h, joint, role, fault)
      !f2py threadsafe
      integer, intent(in) :: n  !! Number of joints
      !> Joints from the crown, strictly increasing, in [0, pi): (n) [rad]
      real(wp), intent(in) :: joints(n)
      real(wp), intent(in) :: facet  !! Largest span of a chord, 0 for one chord per voussoir [rad]
      !> Friction angle, pi/2 or more for joints that cannot slide [rad]
      real(wp), intent(in) :: friction
      integer, intent(in) :: no_slip
      integer, intent(out) :: status     !! Outcome, one of discrete_status
      real(wp), intent(out) :: eta       !! Critical thickness ratio, 0 unless found [-]
      real(wp), intent(out) :: h         !! Thrust there [gamma r^2 eta]
      real(wp), intent(out) :: joint(5)  !! Angles of the active joints: (5) [rad]
      integer, intent(out) :: role(5)    !! State of each, one of joint_role, 0 for none: (5)
      integer, intent(out) :: fault(2)
      type(discrete_solution_t) :: solution
      integer :: i

      status = discrete_status%bad_input
      eta = 0.0_wp
      h = 0.0_wp
      joint = 0.0_wp
      role = 0
      fault = 0
      call set_fault(1, [n > 0], fault)
      if (any(fault > 0)) return
      call set_fault(1, [is_half_angle(joints(1)) .or. (n > 1 .and. abs(joints(1)) <= 0.0_wp), &
                     is_half_angle(joints(2:)) .and. joints(2:) > joints(:n - 1)], fault)
      call set_fault(2, [is_facet(facet)], fault)
      call set_fault(3, [friction >= 0.0_wp], fault)
      if (any(fault > 0)) return
      call discrete_critical(joints, chords(joints, facet), friction, no_slip /= 0, solution)
      status = solution%status
      eta = solution%eta
      h = solution%thrust
      role = solution%role
      do i = 1, solution%active
         joint(i) = joints(solution%joint(i))
      end do
   end subroutine discrete_joints

end module theory_discrete_api
