!> Working precision of all real numbers, kinds of integers, and named constants
module dda_kinds
   use, intrinsic :: iso_fortran_env, only : int8, real64
   implicit none
   private

   public :: wp, small, pi, degree

   !> IEEE double precision
   integer, parameter :: wp = real64
   !> Kind of small integers, such as contact states
   integer, parameter :: small = int8

   !> Half a turn [rad]
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   !> One degree [rad]
   real(wp), parameter :: degree = pi/180.0_wp

end module dda_kinds
