!> From the unknowns of a block to the displacement of its points (Shi: dspl)
module dda_deformation
   use dda_kinds, only : wp
   implicit none
   private

   public :: displacement_matrix

contains

   !> Matrix T that carries the six block unknowns to the displacement of a point
   pure function displacement_matrix(point, centroid) result(t)
      !> Where the displacement is wanted: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Centre of gravity of the block: (2) [m]
      real(wp), intent(in) :: centroid(2)
      !> Rows u, v; columns u0, v0, r0, ex, ey, gxy: (2, 6)
      real(wp) :: t(2, 6)
      real(wp) :: x, y

      x = point(1) - centroid(1)
      y = point(2) - centroid(2)
      t(1, :) = [1.0_wp, 0.0_wp, -y, x, 0.0_wp, y/2.0_wp]
      t(2, :) = [0.0_wp, 1.0_wp, x, 0.0_wp, y, x/2.0_wp]
   end function displacement_matrix
end module dda_deformation
