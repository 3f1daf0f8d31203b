!> The factor of a matrix of small blocks, and which of its blocks are not zero
module dda_block_plan
   use dda_block_dissection, only : dissected_order, smallest_part
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: block_factor_t, plan_factor, products

   !> Factor of a block matrix; "place" is a place in the order of elimination
   type :: block_factor_t
      !> Unknowns of one block
      integer :: n_dof = 0
      !> Block at each place: (n_block)
      integer, allocatable :: block(:)
      !> First entry of each column below the diagonal, by place, and one beyond: (n_block + 1)
      integer, allocatable :: first_below(:)
      !> Row of each entry, as a place, rising within a column: (n_lower)
      integer, allocatable :: row(:)
      !> First place of each row in the two lists that follow, and one beyond: (n_block + 1)
      integer, allocatable :: start(:)
      !> Columns of the entries of a row, as places, rising: (n_lower)
      integer, allocatable :: column(:)
      !> Entries of a row: (n_lower)
      integer, allocatable :: entry(:)
      !> First coupling of the matrix that lies in each row, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_given(:)
      !> Couplings of the matrix by rows, negative where transposed: (n_entry)
      integer, allocatable :: given(:)
      !> Column that each of these lies in: (n_entry)
      integer, allocatable :: given_column(:)
      !> Entries of L below the diagonal, column by column: (n_dof, n_dof, n_lower)
      real(wp), allocatable :: lower(:, :, :)
      !> Inverse of the diagonal blocks of L, by place: (n_dof, n_dof, n_block)
      real(wp), allocatable :: inverse(:, :, :)
      !> D, by block: (n_dof, n_block)
      real(wp), allocatable :: pivot(:, :)
      !> Whether U is the transpose of L
      logical :: symmetric = .true.
      !> Where it is not, the transpose of U as L, above; otherwise without entries
      real(wp), allocatable :: upper(:, :, :)
      !> Inverse of its diagonal blocks: (n_dof, n_dof, n_block), or without entries
      real(wp), allocatable :: upper_inverse(:, :, :)
      !> Whether the diagonal block at each place was lifted until it had a factor: (n_block)
      logical, allocatable :: lifted(:)
      !> Whether the factor can be used: the matrix was positive definite, or if it is not
      !> symmetric, no pivot was zero
      logical :: usable = .false.
   end type block_factor_t

   !> A matrix that is no wider than this in the narrow order is eliminated in it without a thought:
   !> no other order does with much less
   integer, parameter :: narrow = 3
   !> Fewer blocks are not dissected
   integer, parameter :: few = 500

contains

   !> Lay out the factor of a matrix: order of elimination, and the entries that it fills. The
   !> narrow order is eliminated from both ends to the middle; where minimum degree or dissection do
   !> with fewer products, they give the order
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts
      type(block_matrix_t), intent(in) :: matrix
      !> The factor, without numbers
      type(block_factor_t), intent(out) :: factor
      integer :: n

      n = size(matrix%place)
      if (matrix%width <= narrow) then
         call lay_out(matrix, merge(2*matrix%place - 1, 2*(n + 1 - matrix%place), &
            & 2*matrix%place <= n + 1), factor)
      else
         call lay_out_least(matrix, factor)
      end if
      factor%n_dof = matrix%n_dof
      call list_rows(factor)
      factor%symmetric = matrix%symmetric
      associate (nd => matrix%n_dof, other => merge(0, 1, matrix%symmetric))
         allocate (factor%lower(nd, nd, size(factor%row)), factor%inverse(nd, nd, n))
         allocate (factor%upper(nd, nd, other*size(factor%row)))
         allocate (factor%upper_inverse(nd, nd, other*n))
         allocate (factor%pivot(nd, n), source=1.0_wp)
      end associate
      allocate (factor%lifted(n), source=.false.)
   end subroutine plan_factor

   !> Lay out the factor in the order that takes the fewest products
   pure subroutine lay_out_least(matrix, factor)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> The factor, without numbers
      type(block_factor_t), intent(inout) :: factor
      type(block_factor_t) :: other
      integer :: n

      n = size(matrix%place)
      call lay_out(matrix, by_branches(matrix, dissected_order(n, matrix%pair, n)), factor)
      if (n < few) return
      call lay_out(matrix, &
         & by_branches(matrix, dissected_order(n, matrix%pair, smallest_part)), other)
      if (products(other) < products(factor)) factor = other
   end subroutine lay_out_least

   !> Products of two blocks that a factorisation takes
   pure real(wp) function products(factor)
      !> The factor, of which the columns count
      type(block_factor_t), intent(in) :: factor
      integer :: j

      products = 0.0_wp
      do j = 1, size(factor%block)
         associate (below => real(factor%first_below(j + 1) - factor%first_below(j), wp))
            products = products + below*(below + 3.0_wp)/2.0_wp
         end associate
      end do
   end function products

   !> The same order as far as the fill goes, but such that what is eliminated into a block is
   !> eliminated shortly before it, and still near at hand: branch by branch of the tree of
   !> eliminations
   pure function by_branches(matrix, place) result(better)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Place of each block: (n_block)
      integer, intent(in) :: place(:)
      !> Better place of each block: (n_block)
      integer :: better(size(place))
      type(block_factor_t) :: rows
      integer, dimension(0:size(place)) :: parent, ancestor, room, branch
      integer :: g, i, j, above

      call list_couplings(matrix, place, rows)
      parent = 0
      ancestor = 0
      do i = 1, size(place)
         do g = rows%first_given(i), rows%first_given(i + 1) - 1
            j = rows%given_column(g)
            do while (ancestor(j) /= i)
               above = ancestor(j)
               ancestor(j) = i
               if (above == 0) parent(j) = i
               j = merge(i, above, above == 0)
               if (j == i) exit
            end do
         end do
      end do
      branch = 1
      do i = 1, size(place)
         branch(parent(i)) = branch(parent(i)) + branch(i)
      end do
      room(0) = size(place)
      do i = size(place), 1, -1
         j = room(parent(i))
         room(parent(i)) = j - branch(i)
         room(i) = j - 1
         ancestor(i) = j
      end do
      better = ancestor(place)
   end function by_branches

   !> Couplings and columns of the factor in an order of elimination
   pure subroutine lay_out(matrix, place, factor)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Place of each block: (n_block)
      integer, intent(in) :: place(:)
      !> Receives them
      type(block_factor_t), intent(inout) :: factor
      integer :: i

      allocate (factor%block(size(place)))
      factor%block(place) = [(i, i=1, size(place))]
      call list_couplings(matrix, place, factor)
      call fill_columns(size(place), factor)
   end subroutine lay_out

   !> The couplings of the matrix by the rows of the factor
   pure subroutine list_couplings(matrix, place, factor)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Place of each block: (n_block)
      integer, intent(in) :: place(:)
      !> Receives the lists
      type(block_factor_t), intent(inout) :: factor
      integer :: e, i, row(size(matrix%pair, 2)), next(size(place))

      allocate (factor%first_given(size(place) + 1), factor%given(size(row)))
      factor%first_given = 0
      do e = 1, size(row)
         row(e) = maxval(place(matrix%pair(:, e)))
         factor%first_given(row(e) + 1) = factor%first_given(row(e) + 1) + 1
      end do
      factor%first_given(1) = 1
      do i = 1, size(place)
         factor%first_given(i + 1) = factor%first_given(i) + factor%first_given(i + 1)
      end do
      next = factor%first_given(:size(place))
      do e = 1, size(row)
         factor%given(next(row(e))) = merge(e, -e, place(matrix%pair(1, e)) == row(e))
         next(row(e)) = next(row(e)) + 1
      end do
      allocate (factor%given_column(size(row)))
      do e = 1, size(row)
         factor%given_column(e) = minval(place(matrix%pair(:, abs(factor%given(e)))))
      end do
   end subroutine list_couplings

   !> Rows of each column: the couplings, and what elimination fills. A row has its couplings, and
   !> from the column of each the way to the root of the tree of eliminations (J. W. H. Liu, 1990);
   !> it is gone twice, to count and to list
   pure subroutine fill_columns(n, factor)
      !> Number of blocks
      integer, intent(in) :: n
      !> Receives the rows of the columns
      type(block_factor_t), intent(inout) :: factor
      integer, dimension(n) :: parent, seen, next
      integer :: g, i, j, pass

      allocate (factor%first_below(n + 1))
      parent = 0
      next = 0
      do pass = 1, 2
         seen = 0
         do i = 1, n
            do g = factor%first_given(i), factor%first_given(i + 1) - 1
               j = factor%given_column(g)
               do while (seen(j) /= i .and. j /= i)
                  seen(j) = i
                  if (parent(j) == 0) parent(j) = i
                  if (pass == 2) factor%row(next(j)) = i
                  next(j) = next(j) + 1
                  j = parent(j)
               end do
            end do
         end do
         if (pass == 2) exit
         factor%first_below(1) = 1
         do i = 1, n
            factor%first_below(i + 1) = factor%first_below(i) + next(i)
         end do
         next = factor%first_below(:n)
         allocate (factor%row(factor%first_below(n + 1) - 1))
      end do
   end subroutine fill_columns

   !> The entries by rows
   pure subroutine list_rows(factor)
      !> The factor with its columns
      type(block_factor_t), intent(inout) :: factor
      integer :: next(size(factor%block)), i, j, k, n

      n = size(factor%block)
      allocate (factor%start(n + 1), source=0)
      allocate (factor%column(size(factor%row)), factor%entry(size(factor%row)))
      do k = 1, size(factor%row)
         factor%start(factor%row(k) + 1) = factor%start(factor%row(k) + 1) + 1
      end do
      factor%start(1) = 1
      do i = 1, n
         factor%start(i + 1) = factor%start(i) + factor%start(i + 1)
      end do
      next = factor%start(:n)
      do j = 1, n
         do k = factor%first_below(j), factor%first_below(j + 1) - 1
            i = factor%row(k)
            factor%column(next(i)) = j
            factor%entry(next(i)) = k
            next(i) = next(i) + 1
         end do
      end do
   end subroutine list_rows
end module dda_block_plan
