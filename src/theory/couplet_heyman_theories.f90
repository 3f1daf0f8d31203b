!> The three theories of the circular arch, and how far each of them reaches
!>
!> They differ in two flags of the equations: delta_M = 1 where the weight of a chunk acts in its
!> true centre of gravity, at the radius r (1 + eta^2/12), and delta_CCR = 1 where the line of
!> thrust, not the resultant, touches the intrados. Heyman is (delta_CCR, delta_M) = (0, 0), CCR (1,
!> 0), Milankovitch (1, 1).
module couplet_heyman_theories
   use, intrinsic :: iso_fortran_env, only : wp => real64
   implicit none
   private

   public :: theory, weight_flag, tangency_flag, weight_arm
   public :: limits_t, limits_of, unit_angle, unit_angle_tail

   !> Names of the theories
   type :: theory_enum
      !> Resultant tangent to the intrados, weight along the centre line
      integer :: heyman = 1
      !> Line of thrust tangent to the intrados, weight along the centre line (Cocchetti, Colasante,
      !> Rizzi)
      integer :: ccr = 2
      !> Line of thrust tangent to the intrados, weight where it is
      integer :: milankovitch = 3
   end type theory_enum

   !> The names in use
   type(theory_enum), parameter :: theory = theory_enum()

   !> Where a theory ends, and where its hinge is farthest from the crown
   type :: limits_t
      !> Greatest half angle of embrace; the thrust vanishes there [rad]
      real(wp) :: alpha_limit
      !> What alpha_limit is short of the true angle by [rad]
      real(wp) :: alpha_limit_tail
      !> A there, eq. (9)
      real(wp) :: embrace_limit
      !> Thickness ratio there
      real(wp) :: eta_limit
      !> Inner hinge there [rad]
      real(wp) :: beta_limit
      !> Farthest inner hinge of all half angles [rad]
      real(wp) :: beta_max
      !> Half angle that has it [rad]
      real(wp) :: alpha_beta_max
      !> A there
      real(wp) :: embrace_beta_max
      !> Thickness ratio there
      real(wp) :: eta_beta_max
      !> Thrust there
      real(wp) :: h_beta_max
   end type limits_t

   !> Half angle at which A = 1: eta(beta) starts from 0 up to here, from eta_0 > 0 beyond, eq. (26)
   !> [rad]
   real(wp), parameter :: unit_angle = 2.331122370414422613667835955917121338269_wp
   !> What unit_angle is short of the true angle by [rad]
   real(wp), parameter :: unit_angle_tail = -2.1492054957191997e-16_wp
   !> Half a turn [rad]
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

contains

   !> delta_M: 1 where the weight acts in the true centre of gravity
   elemental real(wp) function weight_flag(which)
      integer, intent(in) :: which  !! One of `theory`

      weight_flag = merge(1.0_wp, 0.0_wp, which == theory%milankovitch)
   end function weight_flag

   !> delta_CCR: 1 where the line of thrust touches the intrados, 0 where the resultant does
   elemental real(wp) function tangency_flag(which)
      integer, intent(in) :: which

      tangency_flag = merge(0.0_wp, 1.0_wp, which == theory%heyman)
   end function tangency_flag

   !> Radius at which the weight acts, over r: 1 + delta_M eta^2/12
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

end module couplet_heyman_theories
