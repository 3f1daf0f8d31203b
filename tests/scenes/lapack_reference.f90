!> LAPACK's banded Cholesky: solutions and condition numbers from a source other than the program
module lapack_reference
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: band_factor_t, factorise, substitute, condition_estimate
   public :: fill_band, factor_band

   !> Cholesky factor in LAPACK's band storage
   type :: band_factor_t
      integer :: n_dof = 0  !! Unknowns of one block
      !> Lower factor: (width of the band + 1, number of unknowns)
      real(wp), allocatable :: band(:, :)
      !> Whether the matrix was positive definite, so that the factor can be used
      logical :: usable = .false.
   end type band_factor_t

   interface
      !> LAPACK: Cholesky factorisation of a band matrix
      pure subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
         import :: wp
         character(len=1), intent(in) :: uplo  !! "L": the lower triangle is stored
         integer, intent(in) :: n  !! Number of unknowns
         integer, intent(in) :: kd  !! Number of diagonals below the main one
         integer, intent(in) :: ldab  !! Rows of ab
         real(wp), intent(inout) :: ab(ldab, *)  !! Matrix in, factor out: (ldab, n)
         integer, intent(out) :: info  !! 0, or the order of the minor that is not positive definite
      end subroutine dpbtrf

      !> LAPACK: substitution with a band factor
      pure subroutine dpbtrs(uplo, n, kd, nrhs, ab, ldab, b, ldb, info)
         import :: wp
         character(len=1), intent(in) :: uplo  !! "L": the lower factor is stored
         integer, intent(in) :: n              !! Number of unknowns
         integer, intent(in) :: kd             !! Number of diagonals below the main one
         integer, intent(in) :: nrhs           !! Number of right-hand sides
         integer, intent(in) :: ldab           !! Rows of ab
         integer, intent(in) :: ldb            !! Rows of b
         real(wp), intent(in) :: ab(ldab, *)   !! Factor: (ldab, n)
         real(wp), intent(inout) :: b(ldb, *)  !! Right-hand sides in, solutions out: (ldb, nrhs)
         integer, intent(out) :: info          !! 0 if all is well
      end subroutine dpbtrs

      !> LAPACK: estimate of the reciprocal condition number of a factored band matrix
      pure subroutine dpbcon(uplo, n, kd, ab, ldab, anorm, rcond, work, iwork, info)
         import :: wp
         character(len=1), intent(in) :: uplo  !! "L": the lower factor is stored
         integer, intent(in) :: n              !! Number of unknowns
         integer, intent(in) :: kd             !! Number of diagonals below the main one
         integer, intent(in) :: ldab           !! Rows of ab
         real(wp), intent(in) :: ab(ldab, *)   !! Factor: (ldab, n)
         real(wp), intent(in) :: anorm         !! One-norm of the matrix
         real(wp), intent(out) :: rcond        !! Reciprocal condition number in the one-norm
         real(wp), intent(out) :: work(*)      !! Work space: (3*n)
         integer, intent(out) :: iwork(*)      !! Work space: (n)
         integer, intent(out) :: info          !! 0 if all is well
      end subroutine dpbcon
   end interface

contains

   !> Factor a symmetric matrix; one that is not positive definite gives a factor that is not usable
   pure subroutine factorise(matrix, factor)
      type(block_matrix_t), intent(in) :: matrix
      !> Its factor; storage of an earlier factor of the same pattern is used again
      type(band_factor_t), intent(inout) :: factor

      call fill_band(matrix, factor)
      call factor_band(factor)
   end subroutine factorise

   !> Factor a matrix that lies in its band
   pure subroutine factor_band(factor)
      type(band_factor_t), intent(inout) :: factor  !! The band in, the factor out
      integer :: info, kd, n

      kd = size(factor%band, 1) - 1
      n = size(factor%band, 2)
      call dpbtrf("L", n, kd, factor%band, kd + 1, info)
      factor%usable = info == 0
   end subroutine factor_band

   !> Lay the blocks of a matrix into the band
   pure subroutine fill_band(matrix, factor)
      type(block_matrix_t), intent(in) :: matrix
      type(band_factor_t), intent(inout) :: factor  !! Receives the band
      real(wp) :: block(matrix%n_dof, matrix%n_dof)
      integer :: b, c, e, first, offset, nd, kd

      nd = matrix%n_dof
      kd = nd*(maxval([0, abs(matrix%pair(1, :) - matrix%pair(2, :))]) + 1) - 1
      factor%n_dof = nd
      if (allocated(factor%band)) then
         if (any(shape(factor%band) /= [kd + 1, nd*size(matrix%place)])) deallocate (factor%band)
      end if
      if (.not. allocated(factor%band)) allocate (factor%band(kd + 1, nd*size(matrix%place)))
      factor%band = 0.0_wp
      do b = 1, size(matrix%place)
         first = nd*(b - 1)
         do c = 1, nd
            factor%band(1:nd - c + 1, first + c) = matrix%diagonal(c:nd, c, b)
         end do
      end do
      do e = 1, size(matrix%pair, 2)
         first = nd*(minval(matrix%pair(:, e)) - 1)
         offset = nd*(maxval(matrix%pair(:, e)) - 1) - first
         block = matrix%coupling(:, :, e)
         if (matrix%pair(1, e) < matrix%pair(2, e)) block = transpose(block)
         do c = 1, nd
            associate (column => factor%band(offset - c + 2:offset - c + 1 + nd, first + c))
               column = column + block(:, c)
            end associate
         end do
      end do
   end subroutine fill_band

   !> Solve for one right-hand side
   pure subroutine substitute(factor, x)
      type(band_factor_t), intent(in) :: factor  !! Usable factor
      real(wp), intent(inout) :: x(:, :)  !! Right-hand side in, solution out: (n_dof, n_block)
      integer :: info, n, kd

      kd = size(factor%band, 1) - 1
      n = size(factor%band, 2)
      call dpbtrs("L", n, kd, 1, factor%band, kd + 1, x, n, info)
   end subroutine substitute

   !> Condition number in the one-norm of the matrix scaled to a unit diagonal, so that neither the
   !> unit of length nor the size of a block shows; huge if the matrix is not positive definite
   pure function condition_estimate(matrix) result(condition)
      type(block_matrix_t), intent(in) :: matrix
      real(wp) :: condition  !! Estimate of the condition number, at least 1
      type(block_matrix_t) :: scaled
      type(band_factor_t) :: factor
      real(wp) :: scale(matrix%n_dof, size(matrix%place)), norm, reciprocal
      real(wp), allocatable :: work(:)
      integer, allocatable :: iwork(:)
      integer :: b, c, e, n, kd, info

      scaled = matrix
      condition = huge(condition)
      do b = 1, size(matrix%place)
         do c = 1, matrix%n_dof
            if (.not. matrix%diagonal(c, c, b) > 0.0_wp) return
            scale(c, b) = 1.0_wp/sqrt(matrix%diagonal(c, c, b))
         end do
         scaled%diagonal(:, :, b) = outer(scale(:, b), scale(:, b))*matrix%diagonal(:, :, b)
      end do
      do e = 1, size(matrix%pair, 2)
         scaled%coupling(:, :, e) = matrix%coupling(:, :, e) &
            & *outer(scale(:, matrix%pair(1, e)), scale(:, matrix%pair(2, e)))
      end do
      norm = one_norm(scaled)
      call factorise(scaled, factor)
      if (.not. factor%usable) return
      kd = size(factor%band, 1) - 1
      n = size(factor%band, 2)
      allocate (work(3*n), iwork(n))
      call dpbcon("L", n, kd, factor%band, kd + 1, norm, reciprocal, work, iwork, info)
      if (reciprocal > 0.0_wp) condition = max(1.0_wp, 1.0_wp/reciprocal)
   end function condition_estimate

   !> Largest sum of magnitudes of a column
   pure function one_norm(matrix) result(norm)
      !> The matrix; entries of the same pair count apart, which can only enlarge the norm
      type(block_matrix_t), intent(in) :: matrix
      real(wp) :: norm  !! The norm
      real(wp) :: column(matrix%n_dof, size(matrix%place))
      integer :: e

      column = sum(abs(matrix%diagonal), dim=1)
      do e = 1, size(matrix%pair, 2)
         associate (row => matrix%pair(1, e), col => matrix%pair(2, e))
            column(:, col) = column(:, col) + sum(abs(matrix%coupling(:, :, e)), dim=1)
            column(:, row) = column(:, row) + sum(abs(matrix%coupling(:, :, e)), dim=2)
         end associate
      end do
      norm = maxval(column)
   end function one_norm

   !> Product of a column and a row
   pure function outer(a, b) result(product)
      real(wp), intent(in) :: a(:)           !! Column: (n)
      real(wp), intent(in) :: b(:)           !! Row: (m)
      real(wp) :: product(size(a), size(b))  !! a b': (n, m)

      product = spread(a, 2, size(b))*spread(b, 1, size(a))
   end function outer
end module lapack_reference
