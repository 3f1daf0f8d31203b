!> The matrix A S A' + damping*mass of joints with any stiffness S, and its factor
module dda_coulomb_matrix
   use dda_block_factor, only : block_factor_t, factorise, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: coulomb_matrix_t, new_matrix, factor_stiffness

   !> Matrix and factor
   type :: coulomb_matrix_t
      !> The matrix
      type(block_matrix_t) :: matrix
      !> Its factor
      type(block_factor_t) :: factor
      !> Coupling of each joint in the matrix, 0 for one to what cannot move: (n_joint)
      integer, allocatable :: entry(:)
      !> Number of factorisations so far
      integer :: n_factorisation = 0
   end type coulomb_matrix_t

contains

   !> Pattern of the matrix
   pure subroutine new_matrix(joints, matrix)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_matrix_t), intent(out) :: matrix
      logical :: couples(size(joints%shear_role))
      integer, allocatable :: pair(:, :)
      integer :: j

      associate (graph => joints%graph)
         couples = all(graph%block /= 0, 1) .and. graph%block(1, :) /= graph%block(2, :)
         pair = reshape(pack(graph%block, spread(couples, 1, 2)), [2, count(couples)])
         call set_pattern(matrix%matrix, graph%n_dof, graph%n_block, pair, symmetric=.false.)
      end associate
      call plan_factor(matrix%matrix, matrix%factor)
      matrix%entry = unpack([(j, j=1, count(couples))], couples, spread(0, 1, size(couples)))
   end subroutine new_matrix

   !> Assemble and factor
   pure subroutine factor_stiffness(matrix, joints, stiffness, damping)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      !> S of each joint, rows N1, N2, T, columns opening 1, opening 2, slip: (3, 3, n_joint)
      real(wp), intent(in) :: stiffness(:, :, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      integer :: b, d, j

      associate (m => matrix%matrix)
         m%diagonal = 0.0_wp
         m%coupling = 0.0_wp
         m%upper = 0.0_wp
         do b = 1, joints%graph%n_block
            do d = 1, joints%graph%n_dof
               m%diagonal(d, d, b) = damping*joints%graph%mass(d, b)
            end do
         end do
      end associate
      do j = 1, size(stiffness, 3)
         call add_stiffness(matrix%matrix, matrix%entry(j), joints, j, stiffness(:, :, j))
      end do
      call factorise(matrix%matrix, matrix%factor)
      matrix%n_factorisation = matrix%n_factorisation + 1
   end subroutine factor_stiffness

   !> Add the stiffness of a joint to the matrix
   pure subroutine add_stiffness(matrix, entry, joints, j, stiffness)
      type(block_matrix_t), intent(inout) :: matrix
      integer, intent(in) :: entry             !! Coupling of the joint, or 0
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j                 !! Number of the joint
      real(wp), intent(in) :: stiffness(3, 3)  !! Rows N1, N2, T; columns opening 1, opening 2, slip
      integer :: b, one, other

      associate (block => joints%graph%block(:, j), row => joints%graph%row(:, :, :, j))
         do one = 1, 2
            b = block(one)
            if (b > 0) call add_product(row(:, :, one), stiffness, row(:, :, one), &
               & matrix%diagonal(:, :, b))
         end do
         if (entry > 0) then
            one = merge(1, 2, matrix%pair(1, entry) == block(1))
            other = 3 - one
            call add_product(row(:, :, one), stiffness, row(:, :, other), &
               & matrix%coupling(:, :, entry))
            call add_product(row(:, :, other), stiffness, row(:, :, one), matrix%upper(:, :, entry))
         else if (block(1) == block(2)) then
            do one = 1, 2
               call add_product(row(:, :, one), stiffness, row(:, :, 3 - one), &
                  & matrix%diagonal(:, :, b))
            end do
         end if
      end associate
   end subroutine add_stiffness

   !> sum = sum + left*middle*right'
   pure subroutine add_product(left, middle, right, sum)
      real(wp), intent(in) :: left(:, :)    !! Rows of the block that is pushed: (n_dof, 3)
      real(wp), intent(in) :: middle(3, 3)  !! Stiffness of the joint
      real(wp), intent(in) :: right(:, :)   !! Rows of the block that moves: (n_dof, 3)
      real(wp), intent(inout) :: sum(:, :)  !! What is added to: (n_dof, n_dof)
      real(wp) :: force(3)
      integer :: c

      do c = 1, size(sum, 2)
         force = middle(:, 1)*right(c, 1) + middle(:, 2)*right(c, 2) + middle(:, 3)*right(c, 3)
         sum(:, c) = sum(:, c) + left(:, 1)*force(1) + left(:, 2)*force(2) + left(:, 3)*force(3)
      end do
   end subroutine add_product
end module dda_coulomb_matrix
