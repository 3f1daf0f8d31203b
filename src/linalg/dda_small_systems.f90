!> Small systems: elimination with column pivots, Cholesky's method, rank-revealing least squares
!>
!> Written out because cases run in threads: the serial OpenBLAS of Debian and Ubuntu, built without
!> locks, mixes up the work space of threads that call it at the same time.
module dda_small_systems
   use dda_kinds, only : wp
   implicit none
   private

   public :: eliminate_full, substitute_full, cholesky, solved, least_squares

contains

   !> Factor a matrix in its place
   pure subroutine eliminate_full(a, exchange, regular)
      real(wp), intent(inout) :: a(:, :)   !! Matrix in, factors out: (n, n)
      integer, intent(out) :: exchange(:)  !! Row that each row changed places with: (n)
      logical, intent(out) :: regular      !! Whether no pivot is 0
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
      integer, intent(in) :: exchange(:)  !! Exchanges of rows: (n)
      real(wp), intent(inout) :: x(:)     !! Right-hand side in, solution out: (n)
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

   !> Lower triangle L of a = L L'
   pure function cholesky(a) result(lower)
      real(wp), intent(in) :: a(:, :)            !! Symmetric and positive definite: (n, n)
      real(wp) :: lower(size(a, 1), size(a, 1))  !! The triangle: (n, n)
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
      real(wp), intent(in) :: lower(:, :)  !! Lower triangle: (n, n)
      real(wp), intent(in) :: b(:)         !! Right-hand side: (n)
      real(wp) :: x(size(b))               !! Solution: (n)
      integer :: r

      x = b
      do r = 1, size(b)
         x(r) = (x(r) - dot_product(lower(r, :r - 1), x(:r - 1)))/lower(r, r)
      end do
      do r = size(b), 1, -1
         x(r) = (x(r) - dot_product(lower(r + 1:, r), x(r + 1:)))/lower(r, r)
      end do
   end function solved

   !> The x that makes |A x - b| least, by modified Gram-Schmidt with the largest column first
   !> (Golub and Van Loan, Matrix Computations, 5.2.8 and 5.4.1)
   pure function least_squares(a, b, drop) result(x)
      real(wp), intent(in) :: a(:, :)  !! Matrix A: (m, n)
      real(wp), intent(in) :: b(:)     !! Right-hand side: (m)
      !> Columns of which less than this share of the largest is left take no part
      real(wp), intent(in) :: drop
      !> Solution, 0 for columns that take no part: (n)
      real(wp) :: x(size(a, 2))
      real(wp) :: q(size(a, 1), size(a, 2)), rest(size(b)), r(size(a, 2), size(a, 2))
      real(wp) :: z(size(a, 2)), length(size(a, 2)), first
      integer :: order(size(a, 2)), i, j, n, rank
      logical :: waits(size(a, 2))

      n = size(a, 2)
      q = a
      rest = b
      waits = .true.
      rank = 0
      first = 0.0_wp
      do i = 1, n
         length = [(norm2(q(:, j)), j=1, n)]
         order(i) = maxloc(length, dim=1, mask=waits)
         if (i == 1) first = length(order(1))
         if (.not. length(order(i)) > drop*first) exit
         rank = i
         waits(order(i)) = .false.
         associate (direction => q(:, order(i)))
            r(i, order(i)) = length(order(i))
            direction = direction/length(order(i))
            do j = 1, n
               if (.not. waits(j)) cycle
               r(i, j) = dot_product(direction, q(:, j))
               q(:, j) = q(:, j) - r(i, j)*direction
            end do
            z(i) = dot_product(direction, rest)
            rest = rest - z(i)*direction
         end associate
      end do
      call substitute_back(r, order(:rank), z, x)
   end function least_squares

   !> Solve with the triangle that Gram-Schmidt has left
   pure subroutine substitute_back(r, order, z, x)
      !> Row i is that of the column taken as the i-th; entries stand in the columns of A: (n, n)
      real(wp), intent(in) :: r(:, :)
      integer, intent(in) :: order(:)  !! Columns of A in the order in which they were taken: (rank)
      real(wp), intent(in) :: z(:)     !! Right-hand side: (n)
      real(wp), intent(out) :: x(:)    !! Solution: (n)
      integer :: i

      x = 0.0_wp
      do i = size(order), 1, -1
         x(order(i)) = (z(i) - dot_product(r(i, order(i + 1:)), x(order(i + 1:))))/r(i, order(i))
      end do
   end subroutine substitute_back

end module dda_small_systems
