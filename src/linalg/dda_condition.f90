!> Condition number of a factored matrix, estimated with its own factor: a case that runs beside
!> others must not call LAPACK
module dda_condition
   use dda_block_factor, only : block_factor_t, substitute
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: factored_condition

   !> Most steps of the ascent; two or three do
   integer, parameter :: max_steps = 5

contains

   !> Condition number in the one-norm of the matrix scaled to a unit diagonal, so that neither the
   !> unit of length nor the size of a block shows; huge if the factor is not usable
   pure function factored_condition(matrix, factor) result(condition)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(in) :: factor
      !> Estimate of the condition number, at least 1
      real(wp) :: condition
      real(wp) :: root(matrix%n_dof, size(matrix%diagonal, 3))
      integer :: b, c

      condition = huge(condition)
      if (.not. factor%usable) return
      do b = 1, size(root, 2)
         do c = 1, matrix%n_dof
            root(c, b) = sqrt(matrix%diagonal(c, c, b))
         end do
      end do
      condition = max(1.0_wp, scaled_norm(matrix, root)*inverse_norm(factor, root))
   end function factored_condition

   !> Largest sum of magnitudes of a column of the scaled matrix
   pure function scaled_norm(matrix, root) result(norm)
      !> The matrix; entries of the same pair count apart, which can only enlarge the norm
      type(block_matrix_t), intent(in) :: matrix
      !> Roots of its diagonal: (n_dof, n_block)
      real(wp), intent(in) :: root(:, :)
      !> The norm
      real(wp) :: norm
      real(wp) :: column(size(root, 1), size(root, 2)), one(size(root, 1))
      integer :: b, e

      one = 1.0_wp
      do b = 1, size(root, 2)
         column(:, b) = matmul(one/root(:, b), abs(matrix%diagonal(:, :, b)))/root(:, b)
      end do
      do e = 1, size(matrix%pair, 2)
         associate (row => matrix%pair(1, e), col => matrix%pair(2, e))
            column(:, col) = column(:, col) &
               & + matmul(one/root(:, row), abs(matrix%coupling(:, :, e)))/root(:, col)
            column(:, row) = column(:, row) &
               & + matmul(abs(matrix%coupling(:, :, e)), one/root(:, col))/root(:, row)
         end associate
      end do
      norm = maxval(column)
   end function scaled_norm

   !> One-norm of the inverse of the scaled matrix from below, by Hager's ascent with Higham's
   !> safeguard (ACM Transactions on Mathematical Software 14, 1988, 381)
   pure function inverse_norm(factor, root) result(norm)
      type(block_factor_t), intent(in) :: factor
      !> Roots of the matrix's diagonal: (n_dof, n_block)
      real(wp), intent(in) :: root(:, :)
      !> The norm
      real(wp) :: norm
      real(wp) :: x(size(root, 1), size(root, 2)), y(size(root, 1), size(root, 2))
      integer :: i, place(2), step

      norm = 0.0_wp
      x = 1.0_wp/real(size(x), wp)
      do step = 1, max_steps
         y = scaled_solution(factor, root, x)
         if (.not. sum(abs(y)) > norm) exit
         norm = sum(abs(y))
         y = scaled_solution(factor, root, sign(1.0_wp, y))
         place = maxloc(abs(y))
         if (abs(y(place(1), place(2))) <= sum(x*y)) exit
         x = 0.0_wp
         x(place(1), place(2)) = 1.0_wp
      end do
      x = reshape([((-1.0_wp)**i*(1.0_wp + real(i, wp)/real(max(1, size(x) - 1), wp)), &
         & i=0, size(x) - 1)], shape(x))
      y = scaled_solution(factor, root, x)
      norm = max(norm, 2.0_wp*sum(abs(y))/(3.0_wp*real(size(x), wp)))
   end function inverse_norm

   !> Solution with the scaled matrix
   pure function scaled_solution(factor, root, load) result(x)
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(in) :: root(:, :)
      !> The right-hand side: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The solution: (n_dof, n_block)
      real(wp) :: x(size(load, 1), size(load, 2))

      x = root*load
      call substitute(factor, x)
      x = root*x
   end function scaled_solution
end module dda_condition
