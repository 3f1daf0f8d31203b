!> Products with the rows of joints, and the matrix A + R S R' of blocks and joint springs
!>
!> Blocks have 3 or 6 unknowns: loops take three at a time, a constant length for the compiler.
module dda_joint_matrix
   use dda_block_factor, only : block_factor_t, factorise, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_matrix_t, add_row_forces, factor_joints, row_openings, lay_out_joints

   !> The matrix and its factor
   type :: joint_matrix_t
      type(block_matrix_t) :: matrix
      type(block_factor_t) :: factor
      !> Number of each joint's coupling, negative where its second block has the rows, 0 for joints
      !> that couple no blocks: (n_joint)
      integer, allocatable :: entry(:)
      !> Number of factorisations so far
      integer :: n_factorisation = 0
   end type joint_matrix_t

contains

   !> Lay out the matrix and its factor
   pure subroutine lay_out_joints(block, n_dof, n_block, symmetric, matrix, factor, entry)
      integer, intent(in) :: block(:, :)  !! The two blocks of each joint, 0 if fixed: (2, n_joint)
      integer, intent(in) :: n_dof        !! Unknowns of a block
      integer, intent(in) :: n_block      !! Number of blocks
      logical, intent(in) :: symmetric    !! True if the matrix is symmetric
      type(block_matrix_t), intent(out) :: matrix
      type(block_factor_t), intent(out) :: factor
      !> Couplings, as in the type: (n_joint)
      integer, allocatable, intent(out) :: entry(:)
      logical :: couples(size(block, 2))
      integer, allocatable :: pair(:, :)
      integer :: i

      couples = all(block /= 0, 1) .and. block(1, :) /= block(2, :)
      pair = reshape(pack(block, spread(couples, 1, 2)), [2, count(couples)])
      call set_pattern(matrix, n_dof, n_block, pair, symmetric)
      call plan_factor(matrix, factor)
      entry = unpack([(merge(i, -i, matrix%pair(1, i) == pair(1, i)), i=1, size(pair, 2))], &
         & couples, spread(0, 1, size(couples)))
   end subroutine lay_out_joints

   !> Assemble the matrix and factor it
   pure subroutine factor_joints(base, block, row, stiffness, joined, changed)
      !> Matrix of each block without springs: (n_dof, n_dof, n_block)
      real(wp), intent(in), contiguous :: base(:, :, :)
      integer, intent(in) :: block(:, :)
      !> Openings and slip by unit motion of each block: (n_dof, 3, 2, n_joint)
      real(wp), intent(in), contiguous :: row(:, :, :, :)
      !> Stiffness of the joints, rows N1, N2, T, columns opening 1, 2 and slip: (3, 3, n_joint)
      real(wp), intent(in), contiguous :: stiffness(:, :, :)
      type(joint_matrix_t), intent(inout) :: joined
      !> Blocks with a joint whose stiffness has changed since the last factor; all if it is not
      !> given: (n_block)
      logical, intent(in), optional :: changed(:)
      integer :: j

      joined%matrix%diagonal = base
      joined%matrix%coupling = 0.0_wp
      joined%matrix%upper = 0.0_wp
      do j = 1, size(block, 2)
         call add_stiffness(size(base, 1), block(:, j), row(:, :, :, j), stiffness(:, :, j), &
            & joined%entry(j), joined%matrix)
      end do
      call factorise(joined%matrix, joined%factor, changed)
      joined%n_factorisation = joined%n_factorisation + 1
   end subroutine factor_joints

   !> Add the stiffness of one joint
   pure subroutine add_stiffness(n, block, row, stiffness, entry, matrix)
      integer, intent(in) :: n                 !! Unknowns of a block
      integer, intent(in) :: block(2)          !! Its blocks
      real(wp), intent(in) :: row(n, 3, 2)     !! Its rows
      real(wp), intent(in) :: stiffness(3, 3)  !! Its stiffness
      integer, intent(in) :: entry             !! Its coupling, as in the type
      type(block_matrix_t), intent(inout) :: matrix
      integer :: one, other

      do one = 1, 2
         if (block(one) > 0) call add_product(n, row(:, :, one), stiffness, row(:, :, one), &
            & matrix%diagonal(:, :, block(one)))
      end do
      if (entry /= 0) then
         one = merge(1, 2, entry > 0)
         other = 3 - one
         call add_product(n, row(:, :, one), stiffness, row(:, :, other), &
            & matrix%coupling(:, :, abs(entry)))
         if (.not. matrix%symmetric) call add_product(n, row(:, :, other), stiffness, &
            & row(:, :, one), matrix%upper(:, :, abs(entry)))
      else if (block(1) == block(2)) then
         do one = 1, 2
            call add_product(n, row(:, :, one), stiffness, row(:, :, 3 - one), &
               & matrix%diagonal(:, :, block(1)))
         end do
      end if
   end subroutine add_stiffness

   !> sum = sum + left*middle*right'
   pure subroutine add_product(n, left, middle, right, sum)
      integer, intent(in) :: n
      real(wp), intent(in) :: left(n, 3)    !! Rows of the block that is pushed
      real(wp), intent(in) :: middle(3, 3)  !! Stiffness of the joint
      real(wp), intent(in) :: right(n, 3)   !! Rows of the block that moves
      real(wp), intent(inout) :: sum(n, n)  !! The sum
      real(wp) :: force(3)
      integer :: c, r

      do c = 1, n
         force = middle(:, 1)*right(c, 1) + middle(:, 2)*right(c, 2) + middle(:, 3)*right(c, 3)
         do r = 1, n, 3
            sum(r:r + 2, c) = sum(r:r + 2, c) + left(r:r + 2, 1)*force(1) &
               & + left(r:r + 2, 2)*force(2) + left(r:r + 2, 3)*force(3)
         end do
      end do
   end subroutine add_product

   !> Openings and slips of joints by a motion of the blocks
   pure subroutine row_openings(n, n_joint, block, row, motion, opening)
      integer, intent(in) :: n        !! Unknowns of a block
      integer, intent(in) :: n_joint  !! Number of joints
      integer, intent(in) :: block(2, n_joint)       !! Their blocks
      real(wp), intent(in) :: row(n, 3, 2, n_joint)  !! Their rows
      real(wp), intent(in) :: motion(n, *)           !! Motion of the blocks: (n_dof, n_block) [m]
      real(wp), intent(out) :: opening(3, n_joint)   !! Opening 1, opening 2, slip [m]
      real(wp) :: seen(3)
      integer :: b, c, j, k, side

      do j = 1, n_joint
         seen = 0.0_wp
         do side = 1, 2
            b = block(side, j)
            if (b == 0) cycle
            do c = 1, n, 3
               do k = 1, 3
                  seen(k) = seen(k) + row(c, k, side, j)*motion(c, b) &
                     & + row(c + 1, k, side, j)*motion(c + 1, b) &
                     & + row(c + 2, k, side, j)*motion(c + 2, b)
               end do
            end do
         end do
         opening(:, j) = seen
      end do
   end subroutine row_openings

   !> Let joint forces act on the blocks: add R f
   pure subroutine add_row_forces(n, n_joint, block, row, force, load)
      integer, intent(in) :: n, n_joint
      integer, intent(in) :: block(2, n_joint)       !! Their blocks
      real(wp), intent(in) :: row(n, 3, 2, n_joint)  !! Their rows
      real(wp), intent(in) :: force(3, n_joint)      !! N1, N2, T [N/m]
      real(wp), intent(inout) :: load(n, *)  !! Forces on the blocks: (n_dof, n_block) [N/m]
      integer :: b, c, j, side

      do j = 1, n_joint
         if (.not. any(abs(force(:, j)) > 0.0_wp)) cycle
         do side = 1, 2
            b = block(side, j)
            if (b == 0) cycle
            do c = 1, n, 3
               load(c:c + 2, b) = load(c:c + 2, b) + row(c:c + 2, 1, side, j)*force(1, j) &
                  & + row(c:c + 2, 2, side, j)*force(2, j) + row(c:c + 2, 3, side, j)*force(3, j)
            end do
         end do
      end do
   end subroutine add_row_forces
end module dda_joint_matrix
