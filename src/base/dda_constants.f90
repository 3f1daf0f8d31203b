!> Numbers with a name
module dda_constants
   use dda_kinds, only : wp
   implicit none
   private

   public :: pi, degree

   !> Half a turn [rad]
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   !> One degree [rad]
   real(wp), parameter :: degree = pi/180.0_wp
end module dda_constants
