!> Block factorisation and substitution: the solver of every step (Shi: df20, df21)
!>
!>    matrix = L L',  or with a diagonal D = L D L';   matrix = L U if it is not symmetric
!>
!> Only blocks that are not zero are stored, in panels of columns with the same rows, which are
!> eliminated one after the other. The chain of an arch is eliminated from both ends, so that its
!> mirror images have the same rounding and the processor has two panels to work on. A panel whose
!> numbers and whose predecessors have not changed keeps its factor. Rows change places, where a
!> matrix is not symmetric, within three unknowns of a block alone.
module dda_block_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, plan_panels
   use dda_fronts, only : assemble_fronts, eliminate_fronts, substitute_fronts
   use dda_kinds, only : wp
   use dda_lapack, only : dlacn2
   implicit none
   private

   public :: block_factor_t, factored_condition, factorise, plan_factor, substitute

   !> Factor of a block matrix
   type :: block_factor_t
      type(elimination_plan_t) :: plan  !! Panels and their places
      real(wp), allocatable :: number(:)    !! The numbers
      integer, allocatable :: exchange(:)   !! Exchanges of rows, where the matrix is not symmetric
      !> True if the factor can be used: the matrix was positive definite, or if it is not
      !> symmetric, no pivot was zero
      logical :: usable = .false.
   end type block_factor_t

contains

   !> Lay out the factor of a matrix
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(out) :: factor  !! The factor, without numbers

      call plan_panels(matrix, factor%plan)
      allocate (factor%number(factor%plan%start(size(factor%plan%start)) - 1))
      allocate (factor%exchange(merge(1, size(matrix%diagonal(1, :, :)), matrix%symmetric)))
   end subroutine plan_factor

   !> Factor a matrix; one that is not positive definite, or not symmetric and singular, gives a
   !> factor that is not usable
   pure subroutine factorise(matrix, factor, changed)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(inout) :: factor  !! Its factor, laid out for its pattern
      !> Blocks whose diagonal block or couplings have changed since the factor was usable; all if
      !> it is not given: (n_block)
      logical, intent(in), optional :: changed(:)
      logical :: fresh(size(factor%plan%first) - 1)
      integer :: p

      fresh = .not. (present(changed) .and. factor%usable)
      associate (plan => factor%plan)
         do p = 1, size(fresh)
            if (present(changed)) fresh(p) = fresh(p) .or. &
               & any(changed(plan%block(plan%first(p):plan%first(p + 1) - 1)))
            if (fresh(p)) fresh(plan%panel(plan%row(plan%first_row(p):plan%first_row(p + 1) - 1))) &
               & = .true.
         end do
         call assemble_fronts(plan, matrix, fresh, factor%number)
         call eliminate_fronts(plan, fresh, factor%number, factor%exchange, factor%usable)
      end associate
   end subroutine factorise

   !> Solve for one right-hand side
   pure subroutine substitute(factor, x)
      !> Usable factor
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(inout) :: x(:, :)  !! Right-hand side in, solution out: (n_dof, n_block)
      real(wp) :: y(size(x, 1), size(x, 2))

      y = x(:, factor%plan%block)
      call substitute_fronts(factor%plan, factor%number, factor%exchange, y)
      x(:, factor%plan%block) = y
   end subroutine substitute

   !> Condition number in the one-norm of the matrix scaled to a unit diagonal, so that neither the
   !> unit of length nor the size of a block shows; huge if the factor is not usable
   pure function factored_condition(matrix, factor) result(condition)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(in) :: factor
      real(wp) :: condition  !! Estimate of the condition number, at least 1
      real(wp) :: root(matrix%n_dof, size(matrix%diagonal, 3))
      integer :: c

      condition = huge(condition)
      if (.not. factor%usable) return
      do c = 1, matrix%n_dof
         root(c, :) = sqrt(matrix%diagonal(c, c, :))
      end do
      condition = max(1.0_wp, scaled_norm(matrix, 1.0_wp/root)*inverse_norm(factor, root))
   end function factored_condition

   !> Largest sum of magnitudes of a column of the scaled matrix; entries of the same pair count
   !> apart, which can only enlarge it
   pure function scaled_norm(matrix, scale) result(norm)
      type(block_matrix_t), intent(in) :: matrix
      real(wp), intent(in) :: scale(:, :)  !! Factors of rows and columns: (n_dof, n_block)
      real(wp) :: norm, column(size(scale, 1), size(scale, 2))
      integer :: b, e

      do b = 1, size(scale, 2)
         column(:, b) = matmul(scale(:, b), abs(matrix%diagonal(:, :, b)))
      end do
      do e = 1, size(matrix%pair, 2)
         associate (row => matrix%pair(1, e), col => matrix%pair(2, e))
            column(:, col) = column(:, col) + matmul(scale(:, row), abs(matrix%coupling(:, :, e)))
            column(:, row) = column(:, row) + matmul(abs(matrix%coupling(:, :, e)), scale(:, col))
         end associate
      end do
      norm = maxval(scale*column)
   end function scaled_norm

   !> One-norm of the inverse of the scaled matrix from below (LAPACK's dlacn2)
   pure function inverse_norm(factor, root) result(norm)
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(in) :: root(:, :)  !! Roots of the matrix's diagonal: (n_dof, n_block)
      real(wp) :: norm, v(size(root)), x(size(root, 1), size(root, 2))
      integer :: kase, state(3), sign_of(size(root))

      kase = 0
      norm = 0.0_wp
      do
         call dlacn2(size(root), v, x, sign_of, norm, kase, state)
         if (kase == 0) return
         ! the matrix is symmetric: its transpose solves the same
         x = root*x
         call substitute(factor, x)
         x = root*x
      end do
   end function inverse_norm
end module dda_block_factor
