!> Joints of finite friction: the limit of collapse by rotation alone, and the required thickness
!> below it
!>
!> The thrust at the joint beta is inclined by |atan(beta/h) - beta| to the joint's normal, at the
!> springing by alpha - atan2(alpha, h). The largest inclination in between is acos(sqrt h) - beta_s
!> at beta_s = sqrt(h (1 - h)). With 1 - h = sin^2 x these are x - sin(2x)/2 and beta_s = sin(2x)/2,
!> without cancellation. A smaller thrust reduces the inclination at the springing, a greater one
!> that at the haunch. If both slide at the same thrust, the friction is mu_mixed, below which no
!> thickness is stable. Between mu_mixed and mu_rotational the sliding joint determines the thrust.
!> The thickness follows from the thrust line that touches the intrados and passes through the
!> extrados at the crown (if the springing slides) or at the springing (if the haunch slides). It
!> is the smallest that the static theorem admits.
module couplet_heyman_friction
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only : wp => real64
   use couplet_heyman_critical, only : critical_solution, is_embraced
   use couplet_heyman_equations, only : arc_excess, arm_excess, embrace_deficit, tangency_flag, &
      & versine, weight_flag
   implicit none
   private

   public :: friction_limits_t, friction_limits, friction_solution

   !> Maximum number of steps; 4 to 6 are usual
   integer, parameter :: most_steps = 40
   !> Relative step at which only round-off remains
   real(wp), parameter :: short_step = 1.0e-9_wp

   !> Smallest friction coefficients of an arch
   type :: friction_limits_t
      real(wp) :: mu_rotational  !! Above this the arch collapses by rotation alone
      real(wp) :: mu_mixed       !! Below this no thickness admits equilibrium
      real(wp) :: h_mixed        !! Thrust at mu_mixed [w r]
      real(wp) :: beta_slip  !! Joint of the haunch that slides at mu_mixed, from the crown [rad]
      real(wp) :: beta_mixed, eta_mixed  !! Inner hinge there [rad], and thickness ratio
      !> True if at mu_rotational the springing slides first, not the haunch
      logical :: springing_slides
   end type friction_limits_t

contains

   !> Friction coefficients at which the collapse mode changes; NaN outside the range of validity
   pure type(friction_limits_t) function friction_limits(alpha, which) result(limits)
      real(wp), intent(in) :: alpha  !! Half angle of embrace, (0, alpha_limit] [rad]
      integer, intent(in) :: which   !! One of `theory`
      real(wp) :: x, eta, h

      limits%mu_mixed = ieee_value(x, ieee_quiet_nan)
      limits%mu_rotational = limits%mu_mixed
      limits%h_mixed = limits%mu_mixed
      limits%beta_slip = limits%mu_mixed
      limits%beta_mixed = limits%mu_mixed
      limits%eta_mixed = limits%mu_mixed
      limits%springing_slides = .false.
      if (.not. is_embraced(alpha, which)) return
      call critical_solution(alpha, which, limits%beta_mixed, eta, h)
      call limit_rotation(alpha, which, limits%beta_mixed, eta, h, x, limits%mu_rotational, &
         & limits%springing_slides)
      x = double_slip(alpha, x)
      limits%mu_mixed = mixed_friction(x)
      limits%h_mixed = cos(x)**2
      limits%beta_slip = 0.5_wp*sin(2.0_wp*x)
      call mixed_hinge(alpha, sin(x)**2, limits%springing_slides, which, limits%beta_mixed, &
         & limits%eta_mixed)
   end function friction_limits

   !> Smallest thickness, with its hinge and thrust, at a friction coefficient; NaN below mu_mixed
   elemental subroutine friction_solution(mu, alpha, which, beta, eta, h)
      real(wp), intent(in) :: mu     !! Friction coefficient of the joints
      real(wp), intent(in) :: alpha
      integer, intent(in) :: which
      real(wp), intent(out) :: beta  !! Inner hinge [rad]
      real(wp), intent(out) :: eta   !! Thickness ratio [-]
      real(wp), intent(out) :: h     !! Thrust [w r]
      real(wp) :: deficit, mu_rotational, x
      logical :: springing_slides

      call critical_solution(alpha, which, beta, eta, h)
      if (.not. is_embraced(alpha, which)) return
      call limit_rotation(alpha, which, beta, eta, h, x, mu_rotational, springing_slides)
      if (mu >= mu_rotational) return
      if (.not. mu >= mixed_friction(double_slip(alpha, x))) then
         beta = ieee_value(beta, ieee_quiet_nan)
         eta = beta
         h = beta
         return
      end if
      if (springing_slides) then
         deficit = arm_excess(alpha) - mu*(cos(alpha) + alpha*sin(alpha))
         deficit = deficit/(sin(alpha) - mu*cos(alpha))
      else
         deficit = haunch_deficit(mu)
      end if
      h = 1.0_wp - deficit
      call mixed_hinge(alpha, deficit, springing_slides, which, beta, eta)
   end subroutine friction_solution

   !> Friction coefficient above which the arch collapses by rotation alone
   elemental subroutine limit_rotation(alpha, which, beta, eta, h, x, mu, springing_slides)
      real(wp), intent(in) :: alpha
      integer, intent(in) :: which
      real(wp), intent(in) :: beta, eta, h      !! Critical hinge, thickness and thrust
      real(wp), intent(out) :: x                !! Its thrust, as asin(sqrt(1 - h)) [rad]
      real(wp), intent(out) :: mu               !! The coefficient
      logical, intent(out) :: springing_slides  !! True if the springing slides first there
      real(wp) :: springing, haunch

      x = asin(sqrt(rotational_deficit(alpha, which, beta, eta, h)))
      springing = springing_lean(alpha, x)
      haunch = 0.5_wp*arc_excess(2.0_wp*x)
      springing_slides = springing >= haunch
      mu = tan(max(springing, haunch))
   end subroutine limit_rotation

   !> Smallest friction coefficient at which the haunch does not slide
   elemental real(wp) function mixed_friction(x)
      real(wp), intent(in) :: x  !! The thrust, as asin(sqrt(1 - h)) [rad]

      mixed_friction = tan(0.5_wp*arc_excess(2.0_wp*x))
   end function mixed_friction

   !> 1 - h of the rotational mode, exact to the last digits also for shallow arches
   elemental real(wp) function rotational_deficit(alpha, which, beta, eta, h)
      real(wp), intent(in) :: alpha
      integer, intent(in) :: which
      real(wp), intent(in) :: beta, eta, h

      if (h < 0.5_wp) then
         rotational_deficit = 1.0_wp - h
      else if (tangency_flag(which) > 0.0_wp) then
         rotational_deficit = eta*(1.0_wp - weight_flag(which)*eta/6.0_wp)/(2.0_wp + eta)
         rotational_deficit = embrace_deficit(alpha) - rotational_deficit
      else
         rotational_deficit = arm_excess(beta)/sin(beta)
      end if
   end function rotational_deficit

   !> Inclination of the thrust to the normal at the springing: alpha - atan2(alpha, h)
   elemental function springing_lean(alpha, x) result(lean)
      real(wp), intent(in) :: alpha
      real(wp), intent(in) :: x  !! asin(sqrt(1 - h)) [rad]
      real(wp) :: lean           !! Positive towards the outside of the arch [rad]

      lean = atan2(arm_excess(alpha) - sin(x)**2*sin(alpha), &
                   cos(x)**2*cos(alpha) + alpha*sin(alpha))
   end function springing_lean

   !> Thrust with equal inclinations at springing and haunch
   elemental function double_slip(alpha, guess) result(x)
      real(wp), intent(in) :: alpha
      real(wp), intent(in) :: guess  !! Any initial thrust, as asin(sqrt(1 - h)) [rad]
      real(wp) :: x
      real(wp) :: change
      integer :: step

      x = guess
      do step = 1, most_steps
         change = 0.5_wp*arc_excess(2.0_wp*x) - springing_lean(alpha, x)
         change = change/(versine(2.0_wp*x) + alpha*sin(2.0_wp*x)/(alpha**2 + cos(x)**4))
         x = x - change
         if (abs(change) <= short_step*x) exit
      end do
   end function double_slip

   !> 1 - h at which the haunch is about to slide
   elemental function haunch_deficit(mu) result(deficit)
      real(wp), intent(in) :: mu
      real(wp) :: deficit  !! sin^2 x with x - sin(2x)/2 = atan(mu)
      real(wp) :: x, change
      integer :: step

      x = 1.0_wp
      do step = 1, most_steps
         change = (0.5_wp*arc_excess(2.0_wp*x) - atan(mu))/versine(2.0_wp*x)
         x = x - change
         if (abs(change) <= short_step*x) exit
      end do
      deficit = sin(x)**2
   end function haunch_deficit

   !> Hinge and thickness of the thrust line at the thrust given by a sliding joint
   !>
   !> Eq. (12) with eq. (7) or its equivalent. If no line touches the intrados below the crown, the
   !> hinge is at the crown and opens outwards: beta is 0.
   elemental subroutine mixed_hinge(alpha, deficit, through_crown, which, beta, eta)
      real(wp), intent(in) :: alpha
      real(wp), intent(in) :: deficit  !! 1 - h
      !> True if the line passes through the extrados at the crown, false at the springing
      logical, intent(in) :: through_crown
      integer, intent(in) :: which
      real(wp), intent(inout) :: beta  !! A first guess of the inner hinge; then the hinge [rad]
      real(wp), intent(out) :: eta
      real(wp) :: ratio, change
      integer :: step

      eta = thickness_at(0.0_wp, alpha, deficit, through_crown, which)
      if (deficit <= tangency_excess(eta, which)) then
         beta = 0.0_wp
         return
      end if
      do step = 1, most_steps
         eta = thickness_at(beta, alpha, deficit, through_crown, which)
         ratio = arm_excess(beta)/sin(beta)
         change = deficit - ratio - tangency_excess(eta, which)
         change = change/(beta - ratio*cos(beta)/sin(beta))
         beta = max(beta + change, 0.1_wp*beta)
         if (abs(change) <= short_step*beta) exit
      end do
      eta = thickness_at(beta, alpha, deficit, through_crown, which)
   end subroutine mixed_hinge

   !> beta cot beta - h_e of eq. (12)
   elemental real(wp) function tangency_excess(eta, which) result(excess)
      real(wp), intent(in) :: eta
      integer, intent(in) :: which

      excess = tangency_flag(which)*eta*(1.0_wp + weight_flag(which)*eta/6.0_wp)/(2.0_wp - eta)
   end function tangency_excess

   !> Thickness ratio at which the thrust line passes through the intrados at beta and one extrados
   !> point
   !>
   !> Twice the moment of the forces between the two points: with v(x) = 1 - h - a(x), N(x) = h +
   !> q(x)(1 + v(x)), 2 q v(beta) = eta (2 h + q (1 + v)) + delta_M q eta^2/6 from the crown, and 2
   !> (q v(beta) - q v(alpha)) = eta (N(alpha) + N(beta)) - delta_M (q(alpha) - q(beta)) eta^2/6
   !> from the springing.
   elemental function thickness_at(beta, alpha, deficit, through_crown, which) result(eta)
      real(wp), intent(in) :: beta, alpha, deficit
      !> True if the other point is at the crown, false at the springing
      logical, intent(in) :: through_crown
      integer, intent(in) :: which
      real(wp) :: eta
      real(wp) :: q, v, q_end, v_end, h, rise, width, bend

      h = 1.0_wp - deficit
      q = versine(beta)
      v = deficit - embrace_deficit(beta)
      q_end = 0.0_wp
      v_end = 0.0_wp
      if (.not. through_crown) then
         q_end = versine(alpha)
         v_end = deficit - embrace_deficit(alpha)
      end if
      rise = 2.0_wp*(q*v - q_end*v_end)
      width = 2.0_wp*h + q*(1.0_wp + v) + q_end*(1.0_wp + v_end)
      bend = weight_flag(which)*(q - q_end)/6.0_wp
      eta = 2.0_wp*rise/(width + sqrt(width**2 + 4.0_wp*bend*rise))
   end function thickness_at

end module couplet_heyman_friction
