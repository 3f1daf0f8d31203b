!> The matrix A S A' + damping*mass for any joint stiffness S, and its factor
module dda_coulomb_matrix
   use dda_block_factor, only : block_factor_t, factorise
   use dda_block_matrix, only : block_matrix_t
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: coulomb_matrix_t, add_stiffness, begin_matrix, factor_matrix

   !> The matrix and its factor
   type :: coulomb_matrix_t
      type(block_matrix_t) :: matrix
      type(block_factor_t) :: factor
      !> Number of each joint's coupling, negative where its second block has the rows: (n_joint)
      integer, allocatable :: entry(:)
      !> Number of factorisations so far
      integer :: n_factorisation = 0
   end type coulomb_matrix_t

contains

   !> Begin to add up the matrix, with a multiple of the mass
   pure subroutine begin_matrix(matrix, joints, damping)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: damping  !! The multiple
      integer :: b, k

      matrix%matrix%diagonal = 0.0_wp
      matrix%matrix%coupling = 0.0_wp
      matrix%matrix%upper = 0.0_wp
      do b = 1, joints%graph%n_block
         do k = 1, 3
            matrix%matrix%diagonal(k, k, b) = damping*joints%graph%mass(k, b)
         end do
      end do
   end subroutine begin_matrix

   !> Factor what has been added up
   pure subroutine factor_matrix(matrix)
      type(coulomb_matrix_t), intent(inout) :: matrix

      call factorise(matrix%matrix, matrix%factor)
      matrix%n_factorisation = matrix%n_factorisation + 1
   end subroutine factor_matrix

   !> Add the stiffness of a joint to the matrix
   pure subroutine add_stiffness(matrix, joints, j, stiffness)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j                 !! Number of the joint
      real(wp), intent(in) :: stiffness(3, 3)  !! Rows N1, N2, T; columns opening 1, opening 2, slip
      integer :: one, other

      associate (block => joints%graph%block(:, j), row => joints%graph%row(:, :, :, j), &
         & e => abs(matrix%entry(j)), diagonal => matrix%matrix%diagonal)
         do one = 1, 2
            if (block(one) > 0) call add_product(row(:, :, one), stiffness, row(:, :, one), &
               & diagonal(:, :, block(one)))
         end do
         if (e > 0) then
            one = merge(1, 2, matrix%entry(j) > 0)
            other = 3 - one
            call add_product(row(:, :, one), stiffness, row(:, :, other), &
               & matrix%matrix%coupling(:, :, e))
            call add_product(row(:, :, other), stiffness, row(:, :, one), &
               & matrix%matrix%upper(:, :, e))
         else if (block(1) == block(2)) then
            do one = 1, 2
               call add_product(row(:, :, one), stiffness, row(:, :, 3 - one), &
                  & diagonal(:, :, block(1)))
            end do
         end if
      end associate
   end subroutine add_stiffness

   !> sum = sum + left*middle*right'
   pure subroutine add_product(left, middle, right, sum)
      real(wp), intent(in) :: left(3, 3)    !! Rows of the block that is pushed
      real(wp), intent(in) :: middle(3, 3)  !! Stiffness of the joint
      real(wp), intent(in) :: right(3, 3)   !! Rows of the block that moves
      real(wp), intent(inout) :: sum(3, 3)  !! What is added to
      real(wp) :: force(3)
      integer :: c

      do c = 1, 3
         force = middle(:, 1)*right(c, 1) + middle(:, 2)*right(c, 2) + middle(:, 3)*right(c, 3)
         sum(:, c) = sum(:, c) + left(:, 1)*force(1) + left(:, 2)*force(2) + left(:, 3)*force(3)
      end do
   end subroutine add_product
end module dda_coulomb_matrix
