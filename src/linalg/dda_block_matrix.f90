!> Matrix of small square blocks with symmetric pattern (Shi: df08), and the order in which blocks
!> are eliminated: leaves first, and graphs that are no trees by approximate minimum degree (AMD of
!> SuiteSparse)
module dda_block_matrix
   use, intrinsic :: iso_c_binding, only : c_int, c_null_ptr, c_ptr
   use dda_kinds, only : wp
   use dda_sort, only : list_by_owner
   implicit none
   private

   public :: block_matrix_t, set_pattern

   !> Diagonal blocks and the blocks below the diagonal of the coupled pairs
   type :: block_matrix_t
      integer :: n_dof = 0                !! Unknowns of one block
      integer, allocatable :: place(:)    !! Place of each block in the elimination: (n_block)
      logical :: has_chains = .true.      !! True if the couplings join the blocks to chains
      integer, allocatable :: pair(:, :)  !! Coupled blocks, that placed later first: (2, n_entry)
      real(wp), allocatable :: diagonal(:, :, :)  !! Diagonal blocks: (n_dof, n_dof, n_block)
      !> Blocks below the diagonal, rows of pair(1), columns of pair(2): (n_dof, n_dof, n_entry)
      real(wp), allocatable :: coupling(:, :, :)
      logical :: symmetric = .true.       !! True if the blocks above the diagonal are transposes
      !> Blocks above the diagonal, rows of pair(2), columns of pair(1), where they are no
      !> transposes: (n_dof, n_dof, n_entry), otherwise without entries
      real(wp), allocatable :: upper(:, :, :)
   end type block_matrix_t

   interface
      !> Order of a symmetric matrix with little fill. The function's status is left out: where
      !> memory runs out, the order is unchanged
      pure subroutine amd_order(n, start, column, order, control, info) bind(c)
         import :: c_int, c_ptr
         integer(c_int), intent(in), value :: n         !! Rows
         integer(c_int), intent(in) :: start(*)         !! Begin of each row, from zero on: (n + 1)
         integer(c_int), intent(in) :: column(*)        !! Columns of its entries, from zero on
         integer(c_int), intent(inout) :: order(*)      !! Rows in order, from zero on: (n)
         type(c_ptr), intent(in), value :: control      !! Parameters; null for the usual ones
         type(c_ptr), intent(in), value :: info         !! Statistics; null for none
      end subroutine amd_order
   end interface

contains

   !> Pattern of the matrix: one entry for each coupling, also where two couplings join the same
   !> blocks, for such entries add up
   pure subroutine set_pattern(matrix, n_dof, n_block, pair, symmetric)
      !> The matrix; its numbers are not set
      type(block_matrix_t), intent(out) :: matrix
      integer, intent(in) :: n_dof, n_block  !! Unknowns of one block, and number of blocks
      integer, intent(in) :: pair(:, :)  !! Coupled blocks, both between 1 and n_block: (2, n_entry)
      !> True if the numbers will be symmetric; the default
      logical, intent(in), optional :: symmetric
      integer :: block(n_block), i

      if (present(symmetric)) matrix%symmetric = symmetric
      matrix%n_dof = n_dof
      call elimination_order(n_block, pair, block, matrix%has_chains)
      allocate (matrix%place(n_block), matrix%diagonal(n_dof, n_dof, n_block))
      matrix%place(block) = [(i, i=1, n_block)]
      allocate (matrix%pair, source=pair)
      do i = 1, size(pair, 2)
         associate (p => matrix%pair(:, i))
            if (matrix%place(p(1)) < matrix%place(p(2))) p = p([2, 1])
         end associate
      end do
      allocate (matrix%coupling(n_dof, n_dof, size(pair, 2)))
      allocate (matrix%upper(n_dof, n_dof, merge(0, size(pair, 2), matrix%symmetric)))
   end subroutine set_pattern

   !> Blocks in order of elimination. Chains are eliminated from both ends
   pure subroutine elimination_order(n_block, pair, block, has_chains)
      integer, intent(in) :: n_block, pair(:, :)
      integer, intent(out) :: block(:)     !! The blocks: (n_block)
      logical, intent(out) :: has_chains   !! True if the graph consists of chains
      integer, allocatable :: neighbour(:)
      integer :: i, n, start(n_block + 1)

      call list_neighbours(pair, start, neighbour)
      call peel_leaves(start, neighbour, block, n)
      has_chains = n == n_block .and. all(start(2:) - start(:n_block) <= 2)
      if (n == n_block) return
      block = [(i, i=0, n_block - 1)]
      call amd_order(n_block, start - 1, neighbour - 1, block, c_null_ptr, c_null_ptr)
      block = block + 1
   end subroutine elimination_order

   !> Neighbours of all blocks, each once
   pure subroutine list_neighbours(pair, start, neighbour)
      integer, intent(in) :: pair(:, :)
      integer, intent(out) :: start(:)  !! First of each block, and one beyond: (n_block + 1)
      integer, allocatable, intent(out) :: neighbour(:)  !! The neighbours, block by block
      integer, allocatable :: side(:)
      integer :: b, first, flat(2*size(pair, 2)), i, n, seen(size(start))

      flat = reshape(pair, [size(pair)])
      call list_by_owner(flat, start, side)
      neighbour = flat(merge(side + 1, side - 1, mod(side, 2) == 1))
      seen = 0
      n = 0
      do b = 1, size(start) - 1
         first = n + 1
         do i = start(b), start(b + 1) - 1
            if (seen(neighbour(i)) == b) cycle
            seen(neighbour(i)) = b
            n = n + 1
            neighbour(n) = neighbour(i)
         end do
         start(b) = first
      end do
      start(size(start)) = n + 1
   end subroutine list_neighbours

   !> Blocks that have one neighbour or none when those before them are gone: all of a tree
   pure subroutine peel_leaves(start, neighbour, block, n)
      integer, intent(in) :: start(:), neighbour(:)  !! Lists of all blocks
      integer, intent(out) :: block(:)  !! The blocks in order
      integer, intent(out) :: n         !! Number of them
      integer :: b, head, i, left(size(block))

      left = start(2:) - start(:size(block))
      n = count(left <= 1)
      block(:n) = pack([(b, b=1, size(block))], left <= 1)
      head = 0
      do while (head < n)
         head = head + 1
         do i = start(block(head)), start(block(head) + 1) - 1
            b = neighbour(i)
            left(b) = left(b) - 1
            if (left(b) /= 1) cycle
            n = n + 1
            block(n) = b
         end do
      end do
   end subroutine peel_leaves
end module dda_block_matrix
