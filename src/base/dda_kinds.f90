!> Working precision of every real number of the program, small integers, and numbers with a name
module dda_kinds
   use, intrinsic :: iso_fortran_env, only : int8, real64
   implicit none
   private

   public :: wp, small, pi, degree

   !> IEEE double precision
   integer, parameter :: wp = real64
   !> Integers that stay small and are many: what joints do
   integer, parameter :: small = int8

   !> Half a turn [rad]
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   !> One degree [rad]
   real(wp), parameter :: degree = pi/180.0_wp

end module dda_kinds
