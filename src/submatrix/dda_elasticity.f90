!> Stiffness of a block and the load of its stress (Shi: df13, df14)
module dda_elasticity
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix, material_t
   implicit none
   private

   public :: elastic_matrix, stress_load

contains

   !> Stiffness of the strain unknowns: area * D
   pure function elastic_matrix(material, area) result(stiffness)
      type(material_t), intent(in) :: material
      !> Area of the block [m2]
      real(wp), intent(in) :: area
      !> Symmetric matrix, zero outside rows and columns 4 to 6: (6, 6) [N/m]
      real(wp) :: stiffness(6, 6)

      stiffness = 0.0_wp
      stiffness(4:6, 4:6) = area*elasticity_matrix(material)
   end function elastic_matrix

   !> Load on the strain unknowns by the stress that the block already has
   pure function stress_load(stress, area) result(load)
      !> Stress sx, sy, txy: (3) [Pa]
      real(wp), intent(in) :: stress(3)
      real(wp), intent(in) :: area
      !> Generalised load: (6)
      real(wp) :: load(6)

      load(1:3) = 0.0_wp
      load(4:6) = -area*stress
   end function stress_load
end module dda_elasticity
