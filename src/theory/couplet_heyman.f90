!> The Couplet-Heyman problem: how thin may a circular masonry arch be under its own weight
!>
!> Contents page of the three theories. Angles are in radians, lengths over the mean radius r,
!> forces over w r. docs/theory.md holds the equations with their numbers in the paper, their
!> corrections, and the accuracy.
module couplet_heyman
   use couplet_heyman_critical, only : critical_solution, is_embraced, near_limit_solution, &
      & small_angle_solution
   use couplet_heyman_curves, only : curve_slope, equilibrium_thickness, initial_thickness, &
      thrust_line
   use couplet_heyman_equations, only : chunk_centre, chunk_weight, eccentricity, heyman_embrace, &
      heyman_thickness, heyman_thrust, lower_thrust, springing_thrust, tangent_thrust, &
      thrust_through
   use couplet_heyman_friction, only : friction_limits, friction_limits_t, friction_solution
   use couplet_heyman_kernels, only : embrace, embrace_deficit
   use couplet_heyman_printed, only : crown_polynomial, embrace_cubic, embrace_polynomial, &
      embrace_quadratic, equilibrium_polynomial, growth_polynomial, heyman_quotient, &
      printed_critical, printed_thickness, singular_embrace, singular_polynomial, &
      stationary_polynomial, thickness_polynomial
   use couplet_heyman_theories, only : is_theory, limits_of, limits_t, tangency_flag, theory, &
      unit_angle, weight_arm, weight_flag
   implicit none
   private

   ! The theories and their reach
   public :: theory, is_theory, weight_flag, tangency_flag, weight_arm
   public :: limits_t, limits_of, unit_angle, is_embraced
   ! Eqs. (1) to (13)
   public :: heyman_embrace, heyman_thickness, heyman_thrust, chunk_weight, chunk_centre
   public :: thrust_through, lower_thrust, springing_thrust, tangent_thrust
   public :: embrace, embrace_deficit, eccentricity, thrust_line
   ! Eqs. (14) to (27): the equilibrium curve and its top
   public :: equilibrium_thickness, initial_thickness, curve_slope, critical_solution
   ! The same as printed
   public :: equilibrium_polynomial, stationary_polynomial, growth_polynomial, crown_polynomial
   public :: singular_embrace, singular_polynomial, embrace_polynomial, embrace_cubic
   public :: embrace_quadratic, thickness_polynomial
   public :: heyman_quotient, printed_thickness, printed_critical
   ! Beyond the paper
   public :: small_angle_solution, near_limit_solution
   public :: friction_limits_t, friction_limits, friction_solution

end module couplet_heyman
