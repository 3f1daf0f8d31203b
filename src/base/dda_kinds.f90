!> Working precision of every real number of the program
module dda_kinds
   use, intrinsic :: iso_fortran_env, only : real64
   implicit none
   private

   public :: wp

   !> IEEE double precision
   integer, parameter :: wp = real64
end module dda_kinds
