!> Interfaces of LAPACK and BLAS. Names, arguments and their order are those of LAPACK
module dda_lapack
   use dda_kinds, only : wp
   implicit none
   private

   public :: dgelsy, dgemm, dgemv, dgetrf, dgetrs, dlacn2, dlaswp, dpotrf, dsyrk, dtrsm, dtrsv

   interface
      !> Least squares by factors that show the rank
      pure subroutine dgelsy(m, n, nrhs, a, lda, b, ldb, jpvt, rcond, rank, work, lwork, info)
         import :: wp
         integer, intent(in) :: m, n                !! Rows; columns, or order of a matrix
         !> Right-hand sides, rows of a and b, size of the work space
         integer, intent(in) :: nrhs, lda, ldb, lwork
         real(wp), intent(inout) :: a(lda, *)       !! Matrix in, its factors out: (lda, n)
         real(wp), intent(inout) :: b(ldb, *)       !! Loads in, solutions out: (ldb, nrhs)
         integer, intent(inout) :: jpvt(*)          !! 0 for columns that may change places: (n)
         real(wp), intent(in) :: rcond              !! Reciprocal of the largest condition number
         integer, intent(out) :: rank               !! Columns that count
         real(wp), intent(out) :: work(lwork)       !! Work space
         !> 0, or the number of the argument or pivot that ends the work
         integer, intent(out) :: info
      end subroutine dgelsy

      !> c = alpha a b + beta c, with transposes where transa or transb is "T"
      pure subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: wp
         character, intent(in) :: transa, transb    !! "T": the transpose
         integer, intent(in) :: m, n, lda, ldb
         integer, intent(in) :: k, ldc              !! Columns of the first factor, rows of c
         real(wp), intent(in) :: alpha, beta        !! Factors
         real(wp), intent(in) :: a(lda, *)          !! First factor: (lda, k)
         real(wp), intent(in) :: b(ldb, *)          !! Second factor: (ldb, n)
         real(wp), intent(inout) :: c(ldc, *)       !! Sum: (ldc, n)
      end subroutine dgemm

      !> y = alpha a x + beta y
      pure subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
         import :: wp
         character, intent(in) :: trans             !! "T": with the transpose
         integer, intent(in) :: m, n, lda
         integer, intent(in) :: incx, incy          !! Strides of x and y
         real(wp), intent(in) :: alpha, beta
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(in) :: x(*)               !! Vector: (n)
         real(wp), intent(inout) :: y(*)            !! Sum: (m)
      end subroutine dgemv

      !> Factor a matrix with exchanges of rows
      pure subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: wp
         integer, intent(in) :: m, n, lda
         real(wp), intent(inout) :: a(lda, *)       !! Matrix in, factor out: (lda, n)
         integer, intent(out) :: ipiv(*)            !! Exchanges of rows: (n)
         integer, intent(out) :: info
      end subroutine dgetrf

      !> Solve with the factor of dgetrf
      pure subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         character, intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(in) :: a(lda, *)
         integer, intent(in) :: ipiv(*)
         real(wp), intent(inout) :: b(ldb, *)       !! Loads in, solutions out: (ldb, nrhs)
         integer, intent(out) :: info
      end subroutine dgetrs

      !> Estimate the one-norm of a matrix from products with it, asked for one after the other
      pure subroutine dlacn2(n, v, x, isgn, est, kase, isave)
         import :: wp
         integer, intent(in) :: n
         real(wp), intent(out) :: v(*)              !! Work space: (n)
         real(wp), intent(inout) :: x(*)            !! Vector to multiply, and the product: (n)
         integer, intent(out) :: isgn(*)            !! Work space: (n)
         real(wp), intent(inout) :: est             !! Estimate
         !> 0 at first and at the end; 1: multiply by the matrix, 2: by its transpose
         integer, intent(inout) :: kase
         integer, intent(inout) :: isave(3)         !! Where the estimate has got to
      end subroutine dlacn2

      !> Exchange rows as a factorisation did
      pure subroutine dlaswp(n, a, lda, k1, k2, ipiv, incx)
         import :: wp
         integer, intent(in) :: n, lda, incx, ipiv(*)
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(in) :: k1, k2              !! First and last exchange
      end subroutine dlaswp

      !> Factor a symmetric, positive definite matrix
      pure subroutine dpotrf(uplo, n, a, lda, info)
         import :: wp
         character, intent(in) :: uplo              !! "L": the lower triangle
         integer, intent(in) :: n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine dpotrf

      !> c = alpha a a' + beta c, one triangle of it
      pure subroutine dsyrk(uplo, trans, n, k, alpha, a, lda, beta, c, ldc)
         import :: wp
         character, intent(in) :: uplo, trans
         integer, intent(in) :: n, k, lda, ldc
         real(wp), intent(in) :: alpha, beta
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: c(ldc, *)
      end subroutine dsyrk

      !> Solve with a triangle for many right-hand sides
      pure subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
         import :: wp
         character, intent(in) :: side              !! "R": the triangle stands to the right of b
         character, intent(in) :: uplo
         character, intent(in) :: transa            !! "T": with the transpose
         character, intent(in) :: diag              !! "U": ones on the diagonal
         integer, intent(in) :: m, n, lda, ldb
         real(wp), intent(in) :: alpha
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
      end subroutine dtrsm

      !> Solve with a triangle
      pure subroutine dtrsv(uplo, trans, diag, n, a, lda, x, incx)
         import :: wp
         character, intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, lda
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: x(*)            !! Right-hand side in, solution out: (n)
         integer, intent(in) :: incx
      end subroutine dtrsv
   end interface
end module dda_lapack
