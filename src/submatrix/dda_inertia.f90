!> Mass submatrix (Shi: df11)
module dda_inertia
   use dda_kinds, only : wp
   implicit none
   private

   public :: mass_matrix

contains

   !> density * integral of T'T over the block, in closed form from its central second moments
   pure function mass_matrix(density, area, second) result(mass)
      !> Mass per volume [kg/m3]
      real(wp), intent(in) :: density
      !> Area of the block [m2]
      real(wp), intent(in) :: area
      !> Sxx, Syy, Sxy about the centre of gravity: (3) [m4]
      real(wp), intent(in) :: second(3)
      !> Symmetric matrix of the unknowns u0, v0, r0, ex, ey, gxy: (6, 6)
      real(wp) :: mass(6, 6)
      real(wp) :: sxx, syy, sxy

      sxx = second(1)
      syy = second(2)
      sxy = second(3)
      mass = 0.0_wp
      mass(1, 1) = area
      mass(2, 2) = area
      mass(3, 3) = sxx + syy
      mass(4, 4) = sxx
      mass(5, 5) = syy
      mass(6, 6) = (sxx + syy)/4.0_wp
      mass(3, 4) = -sxy
      mass(3, 5) = sxy
      mass(3, 6) = (sxx - syy)/2.0_wp
      mass(4, 6) = sxy/2.0_wp
      mass(5, 6) = sxy/2.0_wp
      mass(4, 3) = mass(3, 4)
      mass(5, 3) = mass(3, 5)
      mass(6, 3) = mass(3, 6)
      mass(6, 4) = mass(4, 6)
      mass(6, 5) = mass(5, 6)
      mass = density*mass
   end function mass_matrix
end module dda_inertia
