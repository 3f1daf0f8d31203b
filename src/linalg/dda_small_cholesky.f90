!> Systems of equations of a few unknowns, those of one block, by Cholesky's method
module dda_small_cholesky
   use dda_kinds, only : wp
   implicit none
   private

   public :: cholesky, solved

contains

   !> Lower triangle L of a = L L'
   pure function cholesky(a) result(lower)
      !> Symmetric and positive definite: (n, n)
      real(wp), intent(in) :: a(:, :)
      !> The triangle: (n, n)
      real(wp) :: lower(size(a, 1), size(a, 1))
      integer :: c, r

      lower = 0.0_wp
      do c = 1, size(a, 1)
         lower(c, c) = sqrt(a(c, c) - sum(lower(c, :c - 1)**2))
         do r = c + 1, size(a, 1)
            lower(r, c) = (a(r, c) - dot_product(lower(r, :c - 1), lower(c, :c - 1)))/lower(c, c)
         end do
      end do
   end function cholesky

   !> x of L L' x = b
   pure function solved(lower, b) result(x)
      !> Lower triangle: (n, n)
      real(wp), intent(in) :: lower(:, :)
      !> Right-hand side: (n)
      real(wp), intent(in) :: b(:)
      !> Solution: (n)
      real(wp) :: x(size(b))
      integer :: r

      x = b
      do r = 1, size(b)
         x(r) = (x(r) - dot_product(lower(r, :r - 1), x(:r - 1)))/lower(r, r)
      end do
      do r = size(b), 1, -1
         x(r) = (x(r) - dot_product(lower(r + 1:, r), x(r + 1:)))/lower(r, r)
      end do
   end function solved
end module dda_small_cholesky
