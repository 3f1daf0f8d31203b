!> Loads on a block (Shi: df15, df16)
module dda_loads
   use dda_deformation, only : displacement_matrix, tangent_matrix
   use dda_kinds, only : wp
   implicit none
   private

   public :: body_load, point_load

contains

   !> Body force; it acts at the centre of gravity, so only u0 and v0 see it
   pure function body_load(force_per_volume, area) result(load)
      !> Force per volume: (2) [N/m3]
      real(wp), intent(in) :: force_per_volume(2)
      !> Area of the block [m2]
      real(wp), intent(in) :: area
      !> Generalised load: (6)
      real(wp) :: load(6)

      load = 0.0_wp
      load(1:2) = force_per_volume*area
   end function body_load

   !> Force at a point of the block
   pure function point_load(force, point, centroid, motion) result(load)
      !> Force: (2) [N/m]
      real(wp), intent(in) :: force(2)
      !> Where it acts: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Centre of gravity of the block: (2) [m]
      real(wp), intent(in) :: centroid(2)
      !> How the block has moved to where point and centre are; not at all if it is left out: (6)
      real(wp), intent(in), optional :: motion(6)
      !> Generalised load: (6)
      real(wp) :: load(6)
      real(wp) :: t(2, 6)

      t = displacement_matrix(point, centroid)
      if (present(motion)) t = tangent_matrix(point, centroid, motion)
      load = force(1)*t(1, :) + force(2)*t(2, :)
   end function point_load
end module dda_loads
