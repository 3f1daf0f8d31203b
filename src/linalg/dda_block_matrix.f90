!> Matrix of small square blocks with symmetric pattern (Shi: df08), and its elimination tree (Liu
!> 1990)
module dda_block_matrix
   use dda_block_order, only : narrow_order
   use dda_kinds, only : wp
   implicit none
   private

   public :: elimination_t, new_elimination, by_branches, block_matrix_t, set_pattern

   !> An order of elimination; a place is one in this order
   type :: elimination_t
      integer, allocatable :: place(:)  !! Place of each block: (n_block)
      !> First coupling of each row, and one beyond the last: (n_block + 1)
      integer, allocatable :: first(:)
      integer, allocatable :: column(:)  !! Columns of the couplings, row by row: (n_entry)
      !> The column that each column is eliminated into first; 0 for a root: (n_block)
      integer, allocatable :: parent(:)
      integer, allocatable :: below(:)  !! Rows below the diagonal of each column: (n_block)
   end type elimination_t

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

   !> Couplings, tree and columns of an order
   pure subroutine new_elimination(place, pair, elimination)
      integer, intent(in) :: place(:)    !! Place of each block: (n_block)
      integer, intent(in) :: pair(:, :)  !! Coupled blocks: (2, n_entry)
      type(elimination_t), intent(out) :: elimination

      allocate (elimination%place, source=place)
      call list_columns(place, pair, elimination)
      allocate (elimination%parent, source=tree(elimination))
      allocate (elimination%below, source=count_rows(elimination))
   end subroutine new_elimination

   !> List couplings by rows
   pure subroutine list_columns(place, pair, elimination)
      integer, intent(in) :: place(:)  !! Place of each block in the order of elimination: (n_block)
      integer, intent(in) :: pair(:, :)
      type(elimination_t), intent(inout) :: elimination
      integer :: e, i, next(size(place))

      next = 0
      do e = 1, size(pair, 2)
         i = max(place(pair(1, e)), place(pair(2, e)))
         next(i) = next(i) + 1
      end do
      allocate (elimination%first(size(place) + 1), elimination%column(size(pair, 2)))
      elimination%first(1) = 1
      do i = 1, size(place)
         elimination%first(i + 1) = elimination%first(i) + next(i)
      end do
      next = elimination%first(:size(place))
      do e = 1, size(pair, 2)
         i = max(place(pair(1, e)), place(pair(2, e)))
         elimination%column(next(i)) = min(place(pair(1, e)), place(pair(2, e)))
         next(i) = next(i) + 1
      end do
   end subroutine list_columns

   !> The column that each column is eliminated into first; 0 for a root
   pure function tree(elimination) result(parent)
      type(elimination_t), intent(in) :: elimination
      integer :: parent(size(elimination%first) - 1)  !! The parents: (n_block)
      integer :: ancestor(size(parent)), above, g, i, j

      parent = 0
      ancestor = 0
      do i = 1, size(parent)
         do g = elimination%first(i), elimination%first(i + 1) - 1
            j = elimination%column(g)
            do while (ancestor(j) /= i)
               above = ancestor(j)
               ancestor(j) = i
               if (above == 0) parent(j) = i
               j = merge(i, above, above == 0)
               if (j == i) exit
            end do
         end do
      end do
   end function tree

   !> The same order as far as the fill goes, but such that what is eliminated into a block is
   !> eliminated shortly before it, and still near at hand: branch by branch of the tree
   pure function by_branches(place, pair) result(better)
      integer, intent(in) :: place(:), pair(:, :)
      integer :: better(size(place))  !! Better place of each block: (n_block)
      type(elimination_t) :: rows
      integer, dimension(0:size(place)) :: parent, last, branch
      integer :: at(size(place)), i

      call list_columns(place, pair, rows)
      parent(0) = 0
      parent(1:) = tree(rows)
      branch = 1
      do i = 1, size(place)
         branch(parent(i)) = branch(parent(i)) + branch(i)
      end do
      ! last place that is free in the branch of each column
      last(0) = size(place)
      do i = size(place), 1, -1
         at(i) = last(parent(i))
         last(parent(i)) = at(i) - branch(i)
         last(i) = at(i) - 1
      end do
      better = at(place)
   end function by_branches

   !> Rows below the diagonal of each column: a row has its couplings, and from the column of each
   !> the way to the root of the tree
   pure function count_rows(elimination) result(below)
      type(elimination_t), intent(in) :: elimination  !! Couplings by rows and the tree
      integer :: below(size(elimination%parent))      !! Number of rows: (n_block)
      integer :: seen(size(below)), g, i, j

      seen = 0
      below = 0
      do i = 1, size(below)
         do g = elimination%first(i), elimination%first(i + 1) - 1
            j = elimination%column(g)
            do while (seen(j) /= i .and. j /= i)
               seen(j) = i
               below(j) = below(j) + 1
               j = elimination%parent(j)
            end do
         end do
      end do
   end function count_rows

   !> Pattern of the matrix: one entry for each coupling, also where two couplings join the same
   !> blocks, for such entries add up
   pure subroutine set_pattern(matrix, n_dof, n_block, pair, symmetric)
      !> The matrix; its numbers are not set
      type(block_matrix_t), intent(out) :: matrix
      integer, intent(in) :: n_dof       !! Unknowns of one block
      integer, intent(in) :: n_block     !! Number of blocks
      integer, intent(in) :: pair(:, :)  !! Coupled blocks, both between 1 and n_block: (2, n_entry)
      !> Whether the numbers will be symmetric; they are if it is not given
      logical, intent(in), optional :: symmetric
      integer :: i

      if (present(symmetric)) matrix%symmetric = symmetric
      matrix%n_dof = n_dof
      matrix%place = narrow_order(n_block, pair)
      allocate (matrix%pair, source=pair)
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
