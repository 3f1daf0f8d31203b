!> Full matrices and Gaussian elimination: what the banded solver is measured against
module dense_reference
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_block_plan, only : elimination_plan_t, plan_panels
   use dda_kinds, only : wp
   use random_numbers, only : draw, draw_index, random_t
   implicit none
   private

   public :: full_matrix, full_solution, fill_positive_definite, fill_springs, draw_pairs, shuffled
   public :: products

contains

   !> All entries of a block matrix, in the order of the blocks' numbers
   pure function full_matrix(matrix) result(full)
      type(block_matrix_t), intent(in) :: matrix
      real(wp), allocatable :: full(:, :)  !! The same: (n, n)
      integer :: b, e, n, row, column

      n = matrix%n_dof
      allocate (full(n*size(matrix%place), n*size(matrix%place)))
      full = 0.0_wp
      do b = 1, size(matrix%place)
         row = n*(b - 1)
         full(row + 1:row + n, row + 1:row + n) = matrix%diagonal(:, :, b)
      end do
      do e = 1, size(matrix%pair, 2)
         row = n*(matrix%pair(1, e) - 1)
         column = n*(matrix%pair(2, e) - 1)
         full(row + 1:row + n, column + 1:column + n) = &
            & full(row + 1:row + n, column + 1:column + n) + matrix%coupling(:, :, e)
         if (matrix%symmetric) then
            full(column + 1:column + n, row + 1:row + n) = &
               & transpose(full(row + 1:row + n, column + 1:column + n))
         else
            full(column + 1:column + n, row + 1:row + n) = &
               & full(column + 1:column + n, row + 1:row + n) + matrix%upper(:, :, e)
         end if
      end do
   end function full_matrix

   !> Gaussian elimination with the largest pivot of each column
   pure function full_solution(matrix, load) result(x)
      real(wp), intent(in) :: matrix(:, :)  !! Regular matrix: (n, n)
      real(wp), intent(in) :: load(:)       !! Right-hand side: (n)
      real(wp) :: x(size(load))             !! Solution: (n)
      real(wp) :: a(size(load), size(load) + 1), row(size(load) + 1)
      integer :: i, k, n, pivot

      n = size(load)
      a(:, :n) = matrix
      a(:, n + 1) = load
      do k = 1, n
         pivot = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         row = a(pivot, :)
         a(pivot, :) = a(k, :)
         a(k, :) = row
         do i = k + 1, n
            a(i, k:) = a(i, k:) - (a(i, k)/a(k, k))*a(k, k:)
         end do
      end do
      do k = n, 1, -1
         x(k) = (a(k, n + 1) - dot_product(a(k, k + 1:n), x(k + 1:)))/a(k, k)
      end do
   end function full_solution

   !> Random numbers for a matrix: couplings between -1 and 1, diagonals that outweigh them
   pure subroutine fill_positive_definite(random, n_dof, n_block, pair, matrix)
      type(random_t), intent(inout) :: random  !! Where the numbers come from
      integer, intent(in) :: n_dof             !! Unknowns of one block
      integer, intent(in) :: n_block           !! Number of blocks
      integer, intent(in) :: pair(:, :)        !! Coupled blocks: (2, n_entry)
      type(block_matrix_t), intent(out) :: matrix
      integer :: b, c, e

      call set_pattern(matrix, n_dof, n_block, pair)
      do e = 1, size(pair, 2)
         call draw(random, matrix%coupling(:, :, e))
      end do
      do b = 1, n_block
         call draw(random, matrix%diagonal(:, :, b))
         matrix%diagonal(:, :, b) = matrix%diagonal(:, :, b) + transpose(matrix%diagonal(:, :, b))
         do c = 1, n_dof
            matrix%diagonal(c, c, b) = 3.0_wp*real(n_dof*(1 + count(pair == b)), wp)
         end do
      end do
   end subroutine fill_positive_definite

   !> Springs between blocks whose rows of displacements are random, and one from each block to the
   !> ground: those of contacts that slide with friction are not symmetric
   pure subroutine fill_springs(random, n_dof, n_block, pair, friction, symmetric, matrix)
      type(random_t), intent(inout) :: random  !! Where the numbers come from
      integer, intent(in) :: n_dof  !! Unknowns of one block
      integer, intent(in) :: n_block  !! Number of blocks
      integer, intent(in) :: pair(:, :)  !! Coupled blocks: (2, n_entry)
      real(wp), intent(in) :: friction  !! How far a spring is from a symmetric one; 0 is symmetric
      logical, intent(in) :: symmetric  !! True if the matrix is laid out as a symmetric one
      type(block_matrix_t), intent(out) :: matrix
      real(wp) :: a(3, n_dof), b(3, n_dof), spring(3, 3), skew(3)
      integer :: c, e, i

      call set_pattern(matrix, n_dof, n_block, pair, symmetric)
      matrix%diagonal = 0.0_wp
      do i = 1, n_block
         do c = 1, n_dof
            matrix%diagonal(c, c, i) = 0.1_wp
         end do
      end do
      do e = 1, size(pair, 2)
         call draw(random, a)
         call draw(random, b)
         call draw(random, skew)
         spring = 0.0_wp
         do c = 1, 3
            spring(c, c) = 1.0_wp
            spring(c, 1 + modulo(c, 3)) = friction*skew(c)
            spring(1 + modulo(c, 3), c) = -friction*skew(c)
         end do
         associate (p => matrix%pair(1, e), q => matrix%pair(2, e))
            matrix%diagonal(:, :, p) = matrix%diagonal(:, :, p) &
               & + matmul(transpose(a), matmul(spring, a))
            matrix%diagonal(:, :, q) = matrix%diagonal(:, :, q) &
               & + matmul(transpose(b), matmul(spring, b))
         end associate
         matrix%coupling(:, :, e) = matmul(transpose(a), matmul(spring, b))
         if (.not. matrix%symmetric) &
            & matrix%upper(:, :, e) = matmul(transpose(b), matmul(spring, a))
      end do
   end subroutine fill_springs

   !> Pairs of different blocks
   pure subroutine draw_pairs(random, n_block, n_pair, pair)
      type(random_t), intent(inout) :: random          !! Where they come from
      integer, intent(in) :: n_block                   !! Number of blocks
      integer, intent(in) :: n_pair                    !! Number of pairs
      integer, allocatable, intent(out) :: pair(:, :)  !! The pairs: (2, n_pair)
      integer :: e

      allocate (pair(2, n_pair))
      do e = 1, n_pair
         call draw_index(random, n_block, pair(1, e))
         call draw_index(random, n_block - 1, pair(2, e))
         if (pair(2, e) >= pair(1, e)) pair(2, e) = pair(2, e) + 1
      end do
   end subroutine draw_pairs

   !> The numbers 1 to n in disorder
   pure subroutine shuffled(random, number)
      type(random_t), intent(inout) :: random  !! Where the disorder comes from
      integer, intent(out) :: number(:)        !! The numbers: (n)
      real(wp) :: key(size(number))
      integer :: i

      call draw(random, key)
      number = [(count(key <= key(i)), i=1, size(number))]
   end subroutine shuffled

   !> Products of two blocks that a factorisation takes
   pure real(wp) function products(matrix)
      type(block_matrix_t), intent(in) :: matrix  !! The matrix, of which the pattern counts
      type(elimination_plan_t) :: plan

      call plan_panels(matrix, plan)
      products = 0.5_wp*sum(real(plan%below, wp)*(real(plan%below, wp) + 3.0_wp))
   end function products
end module dense_reference
