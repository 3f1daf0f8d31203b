!> Matrix of small square blocks, coupled both ways: pattern first, numbers second (Shi: df08)
module dda_block_matrix
   use dda_block_order, only : narrow_order
   use dda_kinds, only : wp
   implicit none
   private

   public :: block_matrix_t, set_pattern

   !> Diagonal blocks and the blocks below the diagonal of the coupled pairs
   type :: block_matrix_t
      !> Unknowns of one block
      integer :: n_dof = 0
      !> Place of each block in the order of elimination: (n_block)
      integer, allocatable :: place(:)
      !> Coupled blocks of each entry, the one placed later first: (2, n_entry)
      integer, allocatable :: pair(:, :)
      !> Largest distance of two coupled blocks in the order of elimination
      integer :: width = 0
      !> Diagonal blocks: (n_dof, n_dof, n_block)
      real(wp), allocatable :: diagonal(:, :, :)
      !> Blocks below the diagonal, rows of pair(1), columns of pair(2): (n_dof, n_dof, n_entry)
      real(wp), allocatable :: coupling(:, :, :)
      !> Whether what stands above the diagonal is the transpose of what stands below it
      logical :: symmetric = .true.
      !> Blocks above the diagonal, rows of pair(2), columns of pair(1), where they are no
      !> transposes: (n_dof, n_dof, n_entry), otherwise without entries
      real(wp), allocatable :: upper(:, :, :)
   end type block_matrix_t

contains

   !> Pattern of the matrix: one entry for each coupling, also where two couplings join the same
   !> blocks, for such entries add up
   pure subroutine set_pattern(matrix, n_dof, n_block, pair, symmetric)
      !> The matrix; its numbers are not set
      type(block_matrix_t), intent(out) :: matrix
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> Number of blocks
      integer, intent(in) :: n_block
      !> Coupled blocks, both between 1 and n_block: (2, n_entry)
      integer, intent(in) :: pair(:, :)
      !> Whether the numbers will be symmetric; they are if it is not given
      logical, intent(in), optional :: symmetric
      integer :: i

      if (present(symmetric)) matrix%symmetric = symmetric
      matrix%n_dof = n_dof
      matrix%place = narrow_order(n_block, pair)
      matrix%pair = pair
      do i = 1, size(pair, 2)
         associate (p => matrix%pair(:, i))
            if (matrix%place(p(1)) < matrix%place(p(2))) p = p([2, 1])
            matrix%width = max(matrix%width, matrix%place(p(1)) - matrix%place(p(2)))
         end associate
      end do
      allocate (matrix%diagonal(n_dof, n_dof, n_block))
      allocate (matrix%coupling(n_dof, n_dof, size(pair, 2)))
      allocate (matrix%upper(n_dof, n_dof, merge(0, size(pair, 2), matrix%symmetric)))
   end subroutine set_pattern
end module dda_block_matrix
