!> The tree of eliminations: which column of a factor each column is eliminated into, and how many
!> rows elimination leaves it (J. W. H. Liu, SIAM Journal on Matrix Analysis and Applications 11,
!> 1990, 134)
module dda_elimination_tree
   use dda_kinds, only : wp
   implicit none
   private

   public :: elimination_t, new_elimination, products, by_branches

   !> An order of elimination; a place is one in this order
   type :: elimination_t
      !> Place of each block: (n_block)
      integer, allocatable :: place(:)
      !> First coupling of each row, and one beyond the last: (n_block + 1)
      integer, allocatable :: first(:)
      !> Columns of the couplings, row by row: (n_entry)
      integer, allocatable :: column(:)
      !> The column that each column is eliminated into first; 0 for a root: (n_block)
      integer, allocatable :: parent(:)
      !> Rows below the diagonal of each column: (n_block)
      integer, allocatable :: below(:)
   end type elimination_t

contains

   !> Couplings, tree and columns of an order
   pure subroutine new_elimination(place, pair, elimination)
      !> Place of each block: (n_block)
      integer, intent(in) :: place(:)
      !> Coupled blocks: (2, n_entry)
      integer, intent(in) :: pair(:, :)
      type(elimination_t), intent(out) :: elimination

      allocate (elimination%place, source=place)
      call list_columns(place, pair, elimination)
      allocate (elimination%parent, source=tree(elimination))
      allocate (elimination%below, source=count_rows(elimination))
   end subroutine new_elimination

   !> Products of two blocks that a factorisation takes
   pure real(wp) function products(elimination)
      type(elimination_t), intent(in) :: elimination
      integer :: j

      products = 0.0_wp
      do j = 1, size(elimination%below)
         associate (below => real(elimination%below(j), wp))
            products = products + below*(below + 3.0_wp)/2.0_wp
         end associate
      end do
   end function products

   !> List couplings by rows
   pure subroutine list_columns(place, pair, elimination)
      !> Place of each block in the order of elimination: (n_block)
      integer, intent(in) :: place(:)
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
      !> The parents: (n_block)
      integer :: parent(size(elimination%first) - 1)
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
      !> Better place of each block: (n_block)
      integer :: better(size(place))
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
      !> Couplings by rows and the tree
      type(elimination_t), intent(in) :: elimination
      !> Number of rows: (n_block)
      integer :: below(size(elimination%parent))
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
end module dda_elimination_tree
