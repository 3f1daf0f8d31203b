!> Interface of the theory for f2py
!>
!> Subroutines with explicit sizes, arrays of explicit shape and no optional arguments, as required
!> by f2py. Python checks the ranges of validity before each call: results of arguments outside them
!> have no meaning. `which` is one of `theory` in couplet_heyman_equations.
module theory_api
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_critical, only : critical_solution, near_limit_solution, small_angle_solution
   use couplet_heyman_curves, only : curve_slope, equilibrium_thickness, initial_thickness, &
      thrust_line
   use couplet_heyman_discrete, only : chords, discrete_critical, discrete_solution_t, &
      equal_voussoir_joints
   use couplet_heyman_equations, only : eccentricity, embrace, limits_of, limits_t, &
      springing_thrust, tangent_thrust, thrust_through, unit_angle
   use couplet_heyman_friction, only : friction_limits, friction_limits_t, friction_solution
   use couplet_heyman_printed, only : printed_critical
   implicit none
   private

   public :: discrete_equal, discrete_joints, formula, limit_values

contains

   !> Values of a formula, by its name in Python, which documents arguments and values
   subroutine formula(n_value, name, which, x, n, n_argument, y)
      !f2py threadsafe
      integer, intent(in) :: n_value            !! Number of values
      character(len=*), intent(in) :: name      !! Name of the formula
      integer, intent(in) :: which              !! Theory
      integer, intent(in) :: n                  !! Number of elements
      integer, intent(in) :: n_argument         !! Number of arguments
      real(wp), intent(in) :: x(n, n_argument)  !! Arguments in the order of Python: (n, n_argument)
      real(wp), intent(out) :: y(n, n_value)    !! Values: (n, n_value)
      type(friction_limits_t) :: limits
      integer :: i

      select case (name)
      case ("critical")
         call critical_solution(x(:, 1), which, y(:, 1), y(:, 2), y(:, 3))
      case ("critical_as_printed")
         call printed_critical(x(:, 1), which, y(:, 1), y(:, 2), y(:, 3))
      case ("critical_small")
         call small_angle_solution(x(:, 1), which, y(:, 1), y(:, 2), y(:, 3))
      case ("critical_near_limit")
         call near_limit_solution(x(:, 1), which, y(:, 1), y(:, 2), y(:, 3))
      case ("friction_critical")
         call friction_solution(x(:, 1), x(:, 2), which, y(:, 1), y(:, 2), y(:, 3))
      case ("friction")
         ! mu_rotational; mu_mixed with thrust, slipping joint, 1 if the springing slides, hinge
         do i = 1, n
            limits = friction_limits(x(i, 1), which)
            y(i, :) = [limits%mu_rotational, limits%mu_mixed, limits%h_mixed, limits%beta_slip, &
               & merge(1.0_wp, 0.0_wp, limits%springing_slides), limits%beta_mixed, &
               & limits%eta_mixed]
         end do
      case ("equilibrium_thickness")
         y(:, 1) = equilibrium_thickness(x(:, 1), x(:, 2), which)
      case ("initial_thickness")
         y(:, 1) = initial_thickness(x(:, 1), which)
      case ("curve_slope")
         y(:, 1) = curve_slope(x(:, 1), x(:, 2), which)
      case ("thrust_line")
         y(:, 1) = thrust_line(x(:, 1), x(:, 2), x(:, 3), which)
      case ("eccentricity")
         y(:, 1) = eccentricity(x(:, 1), x(:, 3), x(:, 4), which)
      case ("embrace")
         y(:, 1) = embrace(x(:, 1))
      case ("thrust_through")
         y(:, 1) = thrust_through(x(:, 1), x(:, 2), x(:, 3), which)
      case ("springing_thrust")
         y(:, 1) = springing_thrust(x(:, 1), x(:, 2), which)
      case ("tangent_thrust")
         y(:, 1) = tangent_thrust(x(:, 1), x(:, 2), which)
      end select
   end subroutine formula

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

   !> Exact critical thickness of arches of equal polygon voussoirs
   subroutine discrete_equal(n, voussoirs, alpha, facet, friction, no_slip, &
                             status, eta, h, joint, role)
      !f2py threadsafe
      integer, intent(in) :: n             !! Number of arches
      integer, intent(in) :: voussoirs(n)  !! Number of voussoirs of the whole arch: (n)
      real(wp), intent(in) :: alpha(n)     !! Half angle of embrace: (n) [rad]
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
      integer :: i

      do i = 1, n
         associate (joints => equal_voussoir_joints(voussoirs(i), alpha(i)))
            call discrete_joints(size(joints), joints, facet(i), friction(i), no_slip, &
                                 status(i), eta(i), h(i), joint(:, i), role(:, i))
         end associate
      end do
   end subroutine discrete_equal

   !> Exact critical thickness of one arch of polygon voussoirs, from the joints of one half
   subroutine discrete_joints(n, joints, facet, friction, no_slip, &
                              status, eta, h, joint, role)
      !f2py threadsafe
      integer, intent(in) :: n           !! Number of joints
      real(wp), intent(in) :: joints(n)  !! Joints from the crown: (n) [rad]
      real(wp), intent(in) :: facet      !! Largest span of a chord, 0 for one per voussoir [rad]
      real(wp), intent(in) :: friction   !! Friction angle [rad]
      integer, intent(in) :: no_slip
      integer, intent(out) :: status     !! Outcome, one of discrete_status
      real(wp), intent(out) :: eta       !! Critical thickness ratio [-]
      real(wp), intent(out) :: h         !! Thrust there [gamma r^2 eta]
      real(wp), intent(out) :: joint(5)  !! Angles of the active joints: (5) [rad]
      integer, intent(out) :: role(5)    !! State of each: (5)
      type(discrete_solution_t) :: solution
      integer :: i

      call discrete_critical(joints, chords(joints, facet), friction, no_slip /= 0, solution)
      status = solution%status
      eta = solution%eta
      h = solution%thrust
      role = solution%role
      joint = 0.0_wp
      do i = 1, solution%active
         joint(i) = joints(solution%joint(i))
      end do
   end subroutine discrete_joints

end module theory_api
