!> Small full matrices: Gaussian elimination with the largest pivot of each column
module dda_full_matrix
   use dda_kinds, only : wp
   implicit none
   private

   public :: eliminate_full, substitute_full

contains

   !> Factor a matrix in its place
   pure subroutine eliminate_full(a, exchange, regular)
      !> Matrix in, factors out: (n, n)
      real(wp), intent(inout) :: a(:, :)
      !> Row that each row changed places with: (n)
      integer, intent(out) :: exchange(:)
      !> Whether no pivot is 0
      logical, intent(out) :: regular
      real(wp) :: row(size(a, 1))
      integer :: c, k, n, p

      n = size(a, 1)
      regular = .false.
      do k = 1, n
         p = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         exchange(k) = p
         if (.not. abs(a(p, k)) > 0.0_wp) return
         row = a(p, :)
         a(p, :) = a(k, :)
         a(k, :) = row
         a(k + 1:, k) = a(k + 1:, k)/a(k, k)
         do c = k + 1, n
            a(k + 1:, c) = a(k + 1:, c) - a(k + 1:, k)*a(k, c)
         end do
      end do
      regular = .true.
   end subroutine eliminate_full

   !> Solve with the factors
   pure subroutine substitute_full(a, exchange, x)
      real(wp), intent(in) :: a(:, :)
      !> Exchanges of rows: (n)
      integer, intent(in) :: exchange(:)
      !> Right-hand side in, solution out: (n)
      real(wp), intent(inout) :: x(:)
      integer :: k

      ! the exchanges first: those of a later column move factors of earlier ones, too
      do k = 1, size(x)
         x([k, exchange(k)]) = x([exchange(k), k])
      end do
      do k = 1, size(x)
         x(k + 1:) = x(k + 1:) - a(k + 1:, k)*x(k)
      end do
      do k = size(x), 1, -1
         x(k) = x(k)/a(k, k)
         x(:k - 1) = x(:k - 1) - a(:k - 1, k)*x(k)
      end do
   end subroutine substitute_full
end module dda_full_matrix
