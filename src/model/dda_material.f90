!> Materials of blocks and laws of joints
module dda_material
   use dda_kinds, only : degree, wp
   implicit none
   private

   public :: material_t, joint_law_t, elasticity_matrix, friction_coefficient
   public :: breaks_at_once, friction_left, loses_strength, no_slip_deg, set_friction, weakens

   !> Friction angle from which a closed joint does not slide [deg]
   real(wp), parameter :: no_slip_deg = 89.9_wp

   !> Material properties of a block
   type :: material_t
      real(wp) :: density = 2240.0_wp      !! Mass per volume [kg/m3]
      real(wp) :: young = 5.0e9_wp         !! Young's modulus [Pa]
      real(wp) :: poisson = 0.2_wp         !! Poisson's ratio
      real(wp) :: strength = huge(1.0_wp)  !! Compressive strength; huge if unlimited [Pa]
      logical :: plane_strain = .false.    !! True for plane strain, otherwise plane stress
   end type material_t

   !> Mohr-Coulomb law of a joint: -N <= tension*length, |T| <= cohesion*length + friction*N
   type :: joint_law_t
      real(wp) :: friction = 0.0_wp  !! Coefficient of friction tan(phi)
      logical :: no_slip = .false.   !! True if the joint cannot slide
      real(wp) :: cohesion = 0.0_wp  !! Cohesion [Pa]
      real(wp) :: tension = 0.0_wp   !! Tensile strength [Pa]
      !> Coefficient of friction after sliding or opening; huge if unchanged
      real(wp) :: residual = huge(1.0_wp)
      !> Slip over which cohesion, tensile strength and friction drop to their residual values; 0
      !> for a sudden drop [m]
      real(wp) :: slip_length = 0.0_wp
      !> Compressive strength of the weaker of the two blocks; huge if unlimited [Pa]
      real(wp) :: strength = huge(1.0_wp)
   end type joint_law_t

contains

   !> Hooke's law of the plane: stress (sx, sy, txy) from strain (ex, ey, gxy)
   pure function elasticity_matrix(material) result(d)
      type(material_t), intent(in) :: material
      real(wp) :: d(3, 3)  !! Symmetric matrix: (3, 3) [Pa]
      real(wp) :: young, poisson

      young = material%young
      poisson = material%poisson
      if (material%plane_strain) then
         young = young/(1.0_wp - poisson**2)
         poisson = poisson/(1.0_wp - poisson)
      end if
      d = 0.0_wp
      d(1, 1) = young/(1.0_wp - poisson**2)
      d(2, 2) = d(1, 1)
      d(1, 2) = poisson*d(1, 1)
      d(2, 1) = d(1, 2)
      d(3, 3) = young/(2.0_wp*(1.0_wp + poisson))
   end function elasticity_matrix

   !> True if sliding or opening weakens a joint
   elemental logical function loses_strength(law)
      type(joint_law_t), intent(in) :: law

      loses_strength = law%cohesion > 0.0_wp .or. law%tension > 0.0_wp .or. weakens(law)
   end function loses_strength

   !> True if sliding reduces the friction of a joint
   elemental logical function weakens(law)
      type(joint_law_t), intent(in) :: law

      weakens = law%residual < law%friction
   end function weakens

   !> True if all strength other than friction is lost at the first slip
   elemental logical function breaks_at_once(law)
      type(joint_law_t), intent(in) :: law

      breaks_at_once = .not. (law%residual < law%friction .or. law%slip_length > 0.0_wp &
         & .or. law%strength < huge(1.0_wp))
   end function breaks_at_once

   !> Coefficient of friction of a joint with partly lost strength
   elemental real(wp) function friction_left(law, intact)
      type(joint_law_t), intent(in) :: law
      real(wp), intent(in) :: intact  !! Remaining share of the strength

      friction_left = law%friction - (1.0_wp - intact)*max(0.0_wp, law%friction - law%residual)
   end function friction_left

   !> Set the friction of a joint from its angle
   elemental subroutine set_friction(friction_deg, law)
      real(wp), intent(in) :: friction_deg  !! Angle of friction [deg]
      type(joint_law_t), intent(inout) :: law

      law%no_slip = friction_deg >= no_slip_deg
      law%friction = 0.0_wp
      if (.not. law%no_slip) law%friction = friction_coefficient(friction_deg)
   end subroutine set_friction

   !> Coefficient of friction from the friction angle
   elemental function friction_coefficient(friction_deg) result(coefficient)
      real(wp), intent(in) :: friction_deg  !! Angle of friction, 0 <= angle < 90 [deg]
      real(wp) :: coefficient               !! tan(phi)

      coefficient = tan(friction_deg*degree)
   end function friction_coefficient
end module dda_material
