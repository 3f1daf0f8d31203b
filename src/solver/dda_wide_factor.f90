!> Factor of the stiffness matrix in numbers of twice the digits, for springs whose stiffness
!> spreads over more decades than working precision has
module dda_wide_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, most_columns
   use dda_joint_rays, only : joint_rays_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: wide_factor_t, factorise_wide, substitute_wide

   !> Kind of numbers with 30 digits or more; where there is none, with 18
   integer, parameter :: qp = merge(selected_real_kind(30), selected_real_kind(18), &
      & selected_real_kind(30) > 0)
   !> The kind that the panels are written for
   integer, parameter :: rk = qp

   include "../linalg/dda_panel_type.inc"

   !> The factor; its plan is that of the factor in working precision
   type :: wide_factor_t
      !> The numbers
      type(panels_t) :: panels
      !> Whether it can be used
      logical :: usable = .false.
   end type wide_factor_t

contains

   !> Assemble springs along all rays and masses, and factor
   pure subroutine factorise_wide(rays, stiffness, mass, matrix, entry, plan, wide)
      type(joint_rays_t), intent(in) :: rays
      !> Stiffness of each: (n_side, n_joint)
      real(wp), intent(in) :: stiffness(:, :)
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> The matrix, of which the pattern counts
      type(block_matrix_t), intent(in) :: matrix
      !> Entry of the matrix that each joint couples, 0 for none: (n_joint)
      integer, intent(in) :: entry(:)
      !> Plan of its factor
      type(elimination_plan_t), intent(in) :: plan
      type(wide_factor_t), intent(inout) :: wide
      real(qp), allocatable :: diagonal(:, :, :), coupling(:, :, :)
      real(qp) :: arm(3, 2), pushed(3)
      integer :: c, i, j, row, side

      allocate (diagonal(3, 3, rays%n_block), coupling(3, 3, size(matrix%pair, 2)), source=0.0_qp)
      do i = 1, 3
         diagonal(i, i, :) = mass(i, 1:)
      end do
      do j = 1, size(rays%block, 2)
         row = 0
         if (entry(j) > 0) row = merge(1, 2, matrix%pair(1, entry(j)) == rays%block(1, j))
         do i = 1, size(stiffness, 1)
            arm = reshape(real(rays%arm(i, :, j), qp), [3, 2])
            do c = 1, 3
               do side = 1, 2
                  if (rays%block(side, j) == 0) cycle
                  pushed = stiffness(i, j)*arm(:, side)*arm(c, side)
                  diagonal(:, c, rays%block(side, j)) = diagonal(:, c, rays%block(side, j)) + pushed
               end do
               if (row == 0) cycle
               pushed = stiffness(i, j)*arm(:, row)*arm(c, 3 - row)
               coupling(:, c, entry(j)) = coupling(:, c, entry(j)) + pushed
            end do
         end do
      end do
      if (.not. allocated(wide%panels%lower)) call new_panels(plan, .true., wide%panels)
      call eliminate(plan, diagonal, coupling, coupling, [(.true., i=1, size(plan%first) - 1)], &
         & wide%panels)
      wide%usable = wide%panels%usable
   end subroutine factorise_wide

   !> Solve for one right-hand side, and find the rates at which the solution opens the rays: they
   !> may be small differences of large motions
   pure subroutine substitute_wide(rays, plan, wide, x, rate)
      type(joint_rays_t), intent(in) :: rays
      type(elimination_plan_t), intent(in) :: plan
      type(wide_factor_t), intent(in) :: wide
      !> Right-hand side in, solution out: (3, n_block)
      real(wp), intent(inout) :: x(:, :)
      !> Rates of opening: (n_side, n_joint)
      real(wp), intent(out) :: rate(:, :)
      real(qp) :: motion(3, 0:size(plan%block)), y(3, size(plan%block) + plan%highest)
      integer :: j

      y(:, :size(plan%block)) = x(:, plan%block)
      call substitute_panels(plan, wide%panels, y)
      motion(:, 0) = 0.0_qp
      motion(:, plan%block) = y(:, :size(plan%block))
      x = real(motion(:, 1:), wp)
      do j = 1, size(rate, 2)
         rate(:, j) = real(matmul(real(rays%arm(:, 1:3, j), qp), motion(:, rays%block(1, j))) &
            & + matmul(real(rays%arm(:, 4:6, j), qp), motion(:, rays%block(2, j))), wp)
      end do
   end subroutine substitute_wide

   include "../linalg/dda_panels.inc"
   include "../linalg/dda_panel_factor.inc"
   include "../linalg/dda_panel_substitution.inc"
end module dda_wide_factor
