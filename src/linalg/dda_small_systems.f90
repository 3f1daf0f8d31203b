!> Small full systems by LAPACK
module dda_small_systems
   use dda_kinds, only : wp
   use dda_lapack, only : dgelsy, dgetrf, dgetrs, dpotrf, dtrsv
   implicit none
   private

   public :: eliminate_full, substitute_full, cholesky, solved, least_squares

contains

   !> Factor a matrix in its place
   pure subroutine eliminate_full(a, exchange, regular)
      real(wp), intent(inout), contiguous :: a(:, :)  !! Matrix in, factors out: (n, n)
      integer, intent(out), contiguous :: exchange(:) !! Row that each changed places with: (n)
      logical, intent(out) :: regular                 !! True if no pivot is 0
      integer :: info

      call dgetrf(size(a, 1), size(a, 1), a, max(1, size(a, 1)), exchange, info)
      regular = info == 0
   end subroutine eliminate_full

   !> Solve with the factors
   pure subroutine substitute_full(a, exchange, x)
      real(wp), intent(in), contiguous :: a(:, :)
      integer, intent(in), contiguous :: exchange(:)  !! Exchanges of rows: (n)
      real(wp), intent(inout), contiguous :: x(:)     !! Right-hand side in, solution out: (n)
      integer :: info

      call dgetrs("N", size(x), 1, a, max(1, size(x)), exchange, x, max(1, size(x)), info)
   end subroutine substitute_full

   !> Lower triangle L of a = L L'
   pure function cholesky(a) result(lower)
      real(wp), intent(in) :: a(:, :)            !! Symmetric and positive definite: (n, n)
      real(wp) :: lower(size(a, 1), size(a, 1))  !! The triangle: (n, n)
      integer :: c, info

      lower = a
      call dpotrf("L", size(a, 1), lower, size(a, 1), info)
      do c = 2, size(a, 1)
         lower(:c - 1, c) = 0.0_wp
      end do
   end function cholesky

   !> x of L L' x = b
   pure function solved(lower, b) result(x)
      real(wp), intent(in), contiguous :: lower(:, :)  !! Lower triangle: (n, n)
      real(wp), intent(in) :: b(:)                     !! Right-hand side: (n)
      real(wp) :: x(size(b))                           !! Solution: (n)

      x = b
      call dtrsv("L", "N", "N", size(b), lower, size(b), x, 1)
      call dtrsv("L", "T", "N", size(b), lower, size(b), x, 1)
   end function solved

   !> The least x among those that make |A x - b| least
   pure function least_squares(a, b, drop) result(x)
      real(wp), intent(in) :: a(:, :)  !! Matrix A: (m, n)
      real(wp), intent(in) :: b(:)     !! Right-hand side: (m)
      !> Columns of which less than this share is left take no part: the reciprocal of the largest
      !> condition number
      real(wp), intent(in) :: drop
      real(wp) :: x(size(a, 2))        !! Solution: (n)
      real(wp) :: factor(size(a, 1), size(a, 2)), y(max(size(a, 1), size(a, 2)))
      real(wp) :: work(minval(shape(a)) + 3*size(a, 2) + 1)
      integer :: column(size(a, 2)), info, rank

      factor = a
      y = 0.0_wp
      y(:size(b)) = b
      column = 0
      call dgelsy(size(a, 1), size(a, 2), 1, factor, max(1, size(a, 1)), y, max(1, size(y)), &
         & column, drop, rank, work, size(work), info)
      x = y(:size(x))
   end function least_squares
end module dda_small_systems
