!> Factor and substitute for a chain of blocks with 3 unknowns: each is coupled to its two
!> neighbours alone
!>
!>    matrix = L D L',  eliminated from both ends to the middle
!>
!> The two halves do not wait for one another, so that the processor has two rows to work on; and a
!> block that changes leaves the factor of all blocks between it and its end of the chain as it is.
module dda_chain_factor
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_matrix_t, chain_factor_t, new_chain_factor, factorise_chain, substitute_chain

   !> A symmetric matrix of a chain
   type :: chain_matrix_t
      !> Diagonal blocks, of which the lower triangles count: (3, 3, n_block)
      real(wp), allocatable :: diagonal(:, :, :)
      !> Rows of each block, columns of the block before it; of the first one unused:
      !> (3, 3, n_block)
      real(wp), allocatable :: coupling(:, :, :)
   end type chain_matrix_t

   !> Its factor
   type :: chain_factor_t
      !> Below the ones of L in a diagonal block, elements 21, 31, 32: (3, n_block)
      real(wp), allocatable :: lower(:, :)
      !> One over D: (3, n_block)
      real(wp), allocatable :: inverse(:, :)
      !> L between a block and the next one towards the middle, transposed: (3, 3, n_block)
      real(wp), allocatable :: onward(:, :, :)
      !> Whether the matrix was positive definite, so that the factor can be used
      logical :: usable = .false.
   end type chain_factor_t

contains

   !> Room for a chain of n blocks
   pure subroutine new_chain_factor(n, matrix, factor)
      !> Number of blocks
      integer, intent(in) :: n
      !> The matrix
      type(chain_matrix_t), intent(out) :: matrix
      !> The factor
      type(chain_factor_t), intent(out) :: factor

      allocate (matrix%diagonal(3, 3, n), matrix%coupling(3, 3, n))
      allocate (factor%lower(3, n), factor%inverse(3, n), factor%onward(3, 3, n))
   end subroutine new_chain_factor

   !> Factor a matrix of which the blocks from first to last, and their couplings, have changed
   !> since the factor was usable
   pure subroutine factorise_chain(matrix, first, last, factor)
      !> The matrix
      type(chain_matrix_t), intent(in) :: matrix
      !> First block that has changed; 1 if the factor is new
      integer, intent(in) :: first
      !> Last block that has changed; the last of all if the factor is new
      integer, intent(in) :: last
      !> Its factor
      type(chain_factor_t), intent(inout) :: factor
      real(wp) :: left(3, 3), right(3, 3), across(3, 3)
      integer :: i, k, middle, n

      n = size(factor%lower, 2)
      middle = (n + 1)/2
      left = 0.0_wp
      right = 0.0_wp
      factor%usable = .true.
      i = min(first, middle)
      k = max(last, middle)
      if (i > 1) call repeat_update(factor, i - 1, left)
      if (k < n) call repeat_update(factor, k + 1, right)
      do while (i < middle .or. k > middle)
         if (i < middle) then
            across = matrix%coupling(:, :, i + 1)
            call eliminate(matrix%diagonal(:, :, i), across, i, left, factor)
            i = i + 1
         end if
         if (k > middle) then
            across = transpose(matrix%coupling(:, :, k))
            call eliminate(matrix%diagonal(:, :, k), across, k, right, factor)
            k = k - 1
         end if
      end do
      across = 0.0_wp
      left = left + right
      call eliminate(matrix%diagonal(:, :, middle), across, middle, left, factor)
   end subroutine factorise_chain

   !> Eliminate one block
   pure subroutine eliminate(diagonal, across, e, update, factor)
      !> Its diagonal block
      real(wp), intent(in) :: diagonal(3, 3)
      !> Rows of the next block, columns of this one
      real(wp), intent(in) :: across(3, 3)
      !> Its number
      integer, intent(in) :: e
      !> What its neighbour takes from it in, what it takes from the next one out; lower triangle
      real(wp), intent(inout) :: update(3, 3)
      !> Receives the block's part; no longer usable if a pivot is not positive
      type(chain_factor_t), intent(inout) :: factor
      real(wp) :: a, b, c, r(3), v(3, 3), w(3, 3)
      integer :: i, k

      r(1) = 1.0_wp/(diagonal(1, 1) - update(1, 1))
      b = diagonal(2, 1) - update(2, 1)
      c = diagonal(3, 1) - update(3, 1)
      factor%lower(1, e) = b*r(1)
      factor%lower(2, e) = c*r(1)
      r(2) = 1.0_wp/(diagonal(2, 2) - update(2, 2) - b*factor%lower(1, e))
      a = diagonal(3, 2) - update(3, 2) - c*factor%lower(1, e)
      factor%lower(3, e) = a*r(2)
      r(3) = 1.0_wp/(diagonal(3, 3) - update(3, 3) - c*factor%lower(2, e) - a*factor%lower(3, e))
      factor%inverse(:, e) = r
      ! false of what is no number, too
      if (.not. (min(r(1), r(2), r(3)) > 0.0_wp .and. r(1) + r(2) + r(3) < huge(1.0_wp))) &
         & factor%usable = .false.
      v(:, 1) = across(:, 1)
      v(:, 2) = across(:, 2) - factor%lower(1, e)*v(:, 1)
      v(:, 3) = across(:, 3) - factor%lower(2, e)*v(:, 1) - factor%lower(3, e)*v(:, 2)
      do k = 1, 3
         w(:, k) = v(:, k)*r(k)
      end do
      do i = 1, 3
         update(:, i) = v(:, 1)*w(i, 1) + v(:, 2)*w(i, 2) + v(:, 3)*w(i, 3)
      end do
      factor%onward(:, :, e) = w
   end subroutine eliminate

   !> What the neighbour of an eliminated block took from it
   pure subroutine repeat_update(factor, e, update)
      !> The factor
      type(chain_factor_t), intent(in) :: factor
      !> Number of the block
      integer, intent(in) :: e
      !> What was taken
      real(wp), intent(out) :: update(3, 3)
      integer :: i

      associate (w => factor%onward(:, :, e), r => factor%inverse(:, e))
         do i = 1, 3
            update(:, i) = w(:, 1)*(w(i, 1)/r(1)) + w(:, 2)*(w(i, 2)/r(2)) + w(:, 3)*(w(i, 3)/r(3))
         end do
      end associate
   end subroutine repeat_update

   !> Solve for one right-hand side
   pure subroutine substitute_chain(factor, x, work)
      !> Usable factor
      type(chain_factor_t), intent(in) :: factor
      !> Right-hand side in, solution out: (3, n_block)
      real(wp), intent(inout) :: x(:, :)
      !> Right-hand side times solution
      real(wp), intent(out) :: work
      real(wp) :: left(3), right(3), left_work, right_work
      integer :: i, k, middle, n

      n = size(x, 2)
      middle = (n + 1)/2
      left = 0.0_wp
      right = 0.0_wp
      left_work = 0.0_wp
      right_work = 0.0_wp
      do i = 1, n - middle
         k = n + 1 - i
         if (i < middle) call forward(factor%lower(:, i), factor%inverse(:, i), &
            & factor%onward(:, :, i), left, x(:, i), left_work)
         call forward(factor%lower(:, k), factor%inverse(:, k), factor%onward(:, :, k), right, &
            & x(:, k), right_work)
      end do
      left = left + right
      call forward(factor%lower(:, middle), factor%inverse(:, middle), &
         & factor%onward(:, :, middle), left, x(:, middle), left_work)
      work = left_work + right_work
      left = 0.0_wp
      call backward(factor%lower(:, middle), factor%onward(:, :, middle), left, x(:, middle))
      left = x(:, middle)
      right = left
      do i = n - middle, 1, -1
         k = n + 1 - i
         if (i < middle) call backward(factor%lower(:, i), factor%onward(:, :, i), left, x(:, i))
         call backward(factor%lower(:, k), factor%onward(:, :, k), right, x(:, k))
      end do
   end subroutine substitute_chain

   !> One block on the way to the middle
   pure subroutine forward(lower, inverse, onward, passed, x, work)
      !> Its part of L
      real(wp), intent(in) :: lower(3)
      !> One over its D
      real(wp), intent(in) :: inverse(3)
      !> L to the next block, transposed
      real(wp), intent(in) :: onward(3, 3)
      !> What the block before takes from its load in, what it takes from the next one's out
      real(wp), intent(inout) :: passed(3)
      !> Load in, load before the way back out
      real(wp), intent(inout) :: x(3)
      !> Receives the block's share of the work
      real(wp), intent(inout) :: work
      real(wp) :: x1, x2, x3

      x1 = x(1) - passed(1)
      x2 = x(2) - passed(2) - lower(1)*x1
      x3 = x(3) - passed(3) - lower(2)*x1 - lower(3)*x2
      passed(1) = onward(1, 1)*x1 + onward(1, 2)*x2 + onward(1, 3)*x3
      passed(2) = onward(2, 1)*x1 + onward(2, 2)*x2 + onward(2, 3)*x3
      passed(3) = onward(3, 1)*x1 + onward(3, 2)*x2 + onward(3, 3)*x3
      x(1) = x1*inverse(1)
      x(2) = x2*inverse(2)
      x(3) = x3*inverse(3)
      work = work + x1**2*inverse(1) + x2**2*inverse(2) + x3**2*inverse(3)
   end subroutine forward

   !> One block on the way back
   pure subroutine backward(lower, onward, next, x)
      !> Its part of L
      real(wp), intent(in) :: lower(3)
      !> L to the next block towards the middle, transposed
      real(wp), intent(in) :: onward(3, 3)
      !> Solution of that block in, of this one out
      real(wp), intent(inout) :: next(3)
      !> Load in, solution out
      real(wp), intent(inout) :: x(3)
      real(wp) :: x1, x2, x3

      x1 = x(1) - onward(1, 1)*next(1) - onward(2, 1)*next(2) - onward(3, 1)*next(3)
      x2 = x(2) - onward(1, 2)*next(1) - onward(2, 2)*next(2) - onward(3, 2)*next(3)
      x3 = x(3) - onward(1, 3)*next(1) - onward(2, 3)*next(2) - onward(3, 3)*next(3)
      x2 = x2 - lower(3)*x3
      x1 = x1 - lower(1)*x2 - lower(2)*x3
      next = [x1, x2, x3]
      x = next
   end subroutine backward
end module dda_chain_factor
