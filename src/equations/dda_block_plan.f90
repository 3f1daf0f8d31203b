!> The factor of a symmetric matrix of small blocks, and which of its blocks are not zero
module dda_block_plan
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: block_factor_t, plan_factor

   !> Factor of a block matrix; "place" is a place in the order of elimination
   type :: block_factor_t
      !> Unknowns of one block
      integer :: n_dof = 0
      !> Block at each place: (n_block)
      integer, allocatable :: block(:)
      !> First entry below the diagonal of each row, by place, and one beyond: (n_block + 1)
      integer, allocatable :: start(:)
      !> Column of each entry, as a place, rising within a row: (n_lower)
      integer, allocatable :: column(:)
      !> First coupling of the matrix that lies in each row, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_given(:)
      !> Couplings of the matrix by rows, negative where transposed: (n_entry)
      integer, allocatable :: given(:)
      !> Entry that each of these adds to: (n_entry)
      integer, allocatable :: target(:)
      !> Entries of L below the diagonal: (n_dof, n_dof, n_lower)
      real(wp), allocatable :: lower(:, :, :)
      !> Inverse of the diagonal blocks of L, by place: (n_dof, n_dof, n_block)
      real(wp), allocatable :: inverse(:, :, :)
      !> D, by block: (n_dof, n_block)
      real(wp), allocatable :: pivot(:, :)
      !> Whether the matrix was positive definite, so that the factor can be used
      logical :: usable = .false.
   end type block_factor_t

contains

   !> Lay out the factor of a matrix: order of elimination, and the entries that it fills
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts
      type(block_matrix_t), intent(in) :: matrix
      !> The factor, without numbers
      type(block_factor_t), intent(out) :: factor
      integer :: place(size(matrix%place)), n

      n = size(place)
      factor%n_dof = matrix%n_dof
      place = merge(2*matrix%place - 1, 2*(n + 1 - matrix%place), 2*matrix%place <= n + 1)
      allocate (factor%block(n))
      factor%block(place) = [(n, n=1, size(place))]
      call list_couplings(matrix, place, factor)
      call fill_rows(matrix, place, factor)
      n = size(place)
      allocate (factor%lower(matrix%n_dof, matrix%n_dof, size(factor%column)))
      allocate (factor%inverse(matrix%n_dof, matrix%n_dof, n), factor%pivot(matrix%n_dof, n))
   end subroutine plan_factor

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
   end subroutine list_couplings

   !> Entries of each row: its couplings, and what the elimination of these columns fills, which is
   !> the way from each to the root of the tree of eliminations (J. W. H. Liu, 1990)
   pure subroutine fill_rows(matrix, place, factor)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Place of each block: (n_block)
      integer, intent(in) :: place(:)
      !> Receives the entries
      type(block_factor_t), intent(inout) :: factor
      integer :: parent(size(place)), seen(size(place))
      integer :: g, i, j, m, at

      allocate (factor%start(size(place) + 1), factor%column(size(factor%given)))
      allocate (factor%target(size(factor%given)))
      parent = 0
      seen = 0
      factor%start(1) = 1
      do i = 1, size(place)
         at = factor%start(i)
         do g = factor%first_given(i), factor%first_given(i + 1) - 1
            j = minval(place(matrix%pair(:, abs(factor%given(g)))))
            do while (seen(j) /= i .and. j /= i)
               seen(j) = i
               call insert(j, factor%start(i), at, factor%column)
               if (parent(j) == 0) parent(j) = i
               j = parent(j)
            end do
         end do
         factor%start(i + 1) = at
         do g = factor%first_given(i), factor%first_given(i + 1) - 1
            j = minval(place(matrix%pair(:, abs(factor%given(g)))))
            do m = factor%start(i), at - 1
               if (factor%column(m) == j) factor%target(g) = m
            end do
         end do
      end do
      factor%column = factor%column(:factor%start(size(place) + 1) - 1)
   end subroutine fill_rows

   !> Insert a number into the rising end of a list, which grows where it is too short
   pure subroutine insert(number, first, next, list)
      !> The number
      integer, intent(in) :: number
      !> Where the rising end begins
      integer, intent(in) :: first
      !> Where the list is free; moves on
      integer, intent(inout) :: next
      !> The list
      integer, allocatable, intent(inout) :: list(:)
      integer :: at

      if (next > size(list)) list = [list, spread(0, 1, size(list) + 1)]
      at = next
      do while (at > first)
         if (list(at - 1) < number) exit
         list(at) = list(at - 1)
         at = at - 1
      end do
      list(at) = number
      next = next + 1
   end subroutine insert
end module dda_block_plan
