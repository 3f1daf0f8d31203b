!> Working precision of every real number of the program, and numbers with a name
module dda_kinds
   use, intrinsic :: iso_fortran_env, only : real64
   implicit none
   private

   public :: wp, pi, degree

   !> IEEE double precision
   integer, parameter :: wp = real64

   !> Half a turn [rad]
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   !> One degree [rad]
   real(wp), parameter :: degree = pi/180.0_wp

end module dda_kinds
