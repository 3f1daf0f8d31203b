!> Ranges of validity of arguments, and the first array element outside them
module couplet_heyman_domain
   use, intrinsic :: iso_fortran_env, only : wp => real64
   implicit none
   private

   public :: is_half_angle, is_thickness, is_joint, is_finite, is_facet, set_fault

   !> Shortest chord; shorter ones change no digit [rad]
   real(wp), parameter :: shortest_chord = 1.0e-7_wp
   !> 180 degrees [rad]
   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Record the first invalid element, unless a fault is recorded already
   pure subroutine set_fault(argument, valid, fault)
      integer, intent(in) :: argument     !! Place of the argument in the call, from 1
      logical, intent(in) :: valid(:)     !! True for valid elements: (:)
      integer, intent(inout) :: fault(2)  !! Argument and element, 0 and 0 if there is no fault: (2)

      if (fault(1) > 0 .or. all(valid)) return
      fault(1) = argument
      fault(2) = findloc(valid, .false., dim=1)
   end subroutine set_fault

   !> True if an angle can be a half angle of embrace: 0 < alpha < pi; false for a NaN
   elemental logical function is_half_angle(alpha)
      real(wp), intent(in) :: alpha  !! Angle [rad]

      is_half_angle = alpha > 0.0_wp .and. alpha < pi
   end function is_half_angle

   !> True if a number can be a thickness ratio: 0 < eta < 2; false for a NaN
   elemental logical function is_thickness(eta)
      real(wp), intent(in) :: eta  !! Number

      is_thickness = eta > 0.0_wp .and. eta < 2.0_wp
   end function is_thickness

   !> True if an angle is that of a joint of one half of an arch: 0 <= beta <= alpha; false for a
   !> NaN
   elemental logical function is_joint(beta, alpha)
      real(wp), intent(in) :: beta   !! Angle [rad]
      real(wp), intent(in) :: alpha  !! Half angle of embrace [rad]

      is_joint = beta >= 0.0_wp .and. beta <= alpha
   end function is_joint

   !> True if a number is neither infinite nor a NaN: |x| <= huge
   elemental logical function is_finite(x)
      real(wp), intent(in) :: x  !! Number

      is_finite = abs(x) <= huge(x)
   end function is_finite

   !> True if a number can limit the span of a chord: 0, or finite and not too short; false for a
   !> NaN
   elemental logical function is_facet(facet)
      real(wp), intent(in) :: facet  !! Number; 0 stands for no limit [rad]

      is_facet = abs(facet) <= 0.0_wp .or. (facet >= shortest_chord .and. is_finite(facet))
   end function is_facet

end module couplet_heyman_domain
