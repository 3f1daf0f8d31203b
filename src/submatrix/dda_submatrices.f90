!> Submatrices and loads of one block: mass (Shi: df11), stiffness and stress (df13, df14), forces
!> (df15, df16), absorbing boundaries
!>
!> A plane wave of speed c causes the stress density*c*v at a velocity v. A dashpot of that constant
!> per area absorbs it completely at normal incidence (Lysmer and Kuhlemeyer 1969).
module dda_submatrices
   use dda_block_system, only : block_system_t
   use dda_boundary, only : absorbing_point_t, boundary_t
   use dda_deformation, only : displacement_matrix, tangent_matrix
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix, material_t
   implicit none
   private

   public :: mass_matrix, elastic_matrix, stress_load, body_load, point_load, dashpot_matrices

contains

   !> Mass matrix: density * integral of T'T over the block, in closed form from its central second
   !> moments
   pure function mass_matrix(density, area, second) result(mass)
      real(wp), intent(in) :: density    !! Mass per volume [kg/m3]
      real(wp), intent(in) :: area       !! Area of the block [m2]
      real(wp), intent(in) :: second(3)  !! Sxx, Syy, Sxy about the centre of gravity: (3) [m4]
      real(wp) :: mass(6, 6)  !! Symmetric matrix of the unknowns u0, v0, r0, ex, ey, gxy: (6, 6)

      mass = 0.0_wp
      associate (sxx => second(1), syy => second(2), sxy => second(3))
         mass(1, 1) = area
         mass(2, 2) = area
         mass(3, 3:) = [sxx + syy, -sxy, sxy, (sxx - syy)/2.0_wp]
         mass(4, 3:) = [-sxy, sxx, 0.0_wp, sxy/2.0_wp]
         mass(5, 3:) = [sxy, 0.0_wp, syy, sxy/2.0_wp]
         mass(6, 3:) = [(sxx - syy)/2.0_wp, sxy/2.0_wp, sxy/2.0_wp, (sxx + syy)/4.0_wp]
      end associate
      mass = density*mass
   end function mass_matrix

   !> Stiffness of the strain unknowns: area * D
   pure function elastic_matrix(material, area) result(stiffness)
      type(material_t), intent(in) :: material
      real(wp), intent(in) :: area
      !> Symmetric matrix, zero outside rows and columns 4 to 6: (6, 6) [N/m]
      real(wp) :: stiffness(6, 6)

      stiffness = 0.0_wp
      stiffness(4:6, 4:6) = area*elasticity_matrix(material)
   end function elastic_matrix

   !> Load on the strain unknowns by the present stress of the block
   pure function stress_load(stress, area) result(load)
      real(wp), intent(in) :: stress(3)  !! Stress sx, sy, txy: (3) [Pa]
      real(wp), intent(in) :: area
      real(wp) :: load(6)                !! Generalised load: (6)

      load(1:3) = 0.0_wp
      load(4:6) = -area*stress
   end function stress_load

   !> Body force; it acts at the centre of gravity, on u0 and v0 only
   pure function body_load(force_per_volume, area) result(load)
      real(wp), intent(in) :: force_per_volume(2)  !! Force per volume: (2) [N/m3]
      real(wp), intent(in) :: area
      real(wp) :: load(6)                          !! Generalised load: (6)

      load = 0.0_wp
      load(1:2) = force_per_volume*area
   end function body_load

   !> Force at a point of the block
   pure function point_load(force, point, centroid, motion) result(load)
      real(wp), intent(in) :: force(2)     !! Force: (2) [N/m]
      real(wp), intent(in) :: point(2)     !! Point of application: (2) [m]
      real(wp), intent(in) :: centroid(2)  !! Centre of gravity of the block: (2) [m]
      !> Motion of the block to this point and centre; absent for none: (6)
      real(wp), intent(in), optional :: motion(6)
      real(wp) :: load(6)  !! Generalised load: (6)
      real(wp) :: t(2, 6)

      t = displacement_matrix(point, centroid)
      if (present(motion)) t = tangent_matrix(point, centroid, motion)
      load = force(1)*t(1, :) + force(2)*t(2, :)
   end function point_load

   !> Forces of the dashpots on the blocks per unit rate of the unknowns
   pure function dashpot_matrices(system, boundary, n_dof) result(matrix)
      type(block_system_t), intent(in) :: system
      type(boundary_t), intent(in) :: boundary  !! Absorbing boundaries
      integer, intent(in) :: n_dof              !! Unknowns of a block
      !> The matrices, without entries if nothing absorbs: (n_dof, n_dof, n_equation or 0)
      real(wp), allocatable :: matrix(:, :, :)
      real(wp) :: t(2, 6)
      integer :: e, i

      if (.not. allocated(boundary%absorbing)) then
         allocate (matrix(n_dof, n_dof, 0))
         return
      end if
      allocate (matrix(n_dof, n_dof, maxval(system%equation)), source=0.0_wp)
      do i = 1, size(boundary%absorbing)
         associate (point => boundary%absorbing(i))
            e = system%equation(point%block)
            if (e == 0) cycle
            t = displacement_matrix(point%point, system%centroid(:, point%block))
            matrix(:, :, e) = matrix(:, :, e) + matmul(transpose(t(:, :n_dof)), &
               & matmul(impedance(system, point), t(:, :n_dof)))
         end associate
      end do
   end function dashpot_matrices

   !> Force of the dashpots of a point per velocity along x and y
   pure function impedance(system, point) result(c)
      type(block_system_t), intent(in) :: system
      type(absorbing_point_t), intent(in) :: point
      real(wp) :: c(2, 2)  !! Symmetric matrix: (2, 2) [N s/m2]
      real(wp) :: d(3, 3), speed(2)
      integer :: i, j

      associate (density => system%density(point%block), t => point%tangent, &
         & n => [-point%tangent(2), point%tangent(1)])
         d = elasticity_matrix(system%materials(system%material(point%block)))
         speed = point%speed
         if (.not. speed(1) > 0.0_wp) speed(1) = sqrt(d(1, 1)/density)
         if (.not. speed(2) > 0.0_wp) speed(2) = sqrt(d(3, 3)/density)
         do j = 1, 2
            do i = 1, 2
               c(i, j) = density*point%length*(speed(1)*n(i)*n(j) + speed(2)*t(i)*t(j))
               if (.not. (point%along(i) .and. point%along(j))) c(i, j) = 0.0_wp
            end do
         end do
      end associate
   end function impedance

end module dda_submatrices
