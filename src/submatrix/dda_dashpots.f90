!> Faces that let waves out: dashpots of the impedance of what lies behind them
!>
!> A plane wave of speed c brings the stress density*c*v at a velocity v. A dashpot of that constant
!> per length takes it up whole, if it comes straight (Lysmer and Kuhlemeyer 1969).
module dda_dashpots
   use dda_block_system, only : block_system_t
   use dda_boundary, only : absorbing_point_t, boundary_t
   use dda_deformation, only : displacement_matrix
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix
   implicit none
   private

   public :: dashpot_matrices

contains

   !> Forces of the dashpots on the blocks per unit rate of the unknowns
   pure function dashpot_matrices(system, boundary, n_dof) result(matrix)
      type(block_system_t), intent(in) :: system
      !> Where their faces let waves out
      type(boundary_t), intent(in) :: boundary
      !> Unknowns of a block
      integer, intent(in) :: n_dof
      !> The matrices, without entries where no face does: (n_dof, n_dof, n_equation or 0)
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
      !> Symmetric matrix: (2, 2) [N s/m2]
      real(wp) :: c(2, 2)
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
end module dda_dashpots
