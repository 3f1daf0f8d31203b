!> Least squares of a few columns that may depend on one another
!>
!> Written out because cases run in threads: the serial OpenBLAS of Debian and Ubuntu, built without
!> locks, mixes up the work space of threads that call it at the same time.
module dda_least_squares
   use dda_kinds, only : wp
   implicit none
   private

   public :: least_squares

contains

   !> The x that makes |A x - b| least, by modified Gram-Schmidt with the largest column first
   !> (Golub and Van Loan, Matrix Computations, 5.2.8 and 5.4.1)
   pure function least_squares(a, b, drop) result(x)
      !> Matrix A: (m, n)
      real(wp), intent(in) :: a(:, :)
      !> Right-hand side: (m)
      real(wp), intent(in) :: b(:)
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
      !> Columns of A in the order in which they were taken: (rank)
      integer, intent(in) :: order(:)
      !> Right-hand side: (n)
      real(wp), intent(in) :: z(:)
      !> Solution: (n)
      real(wp), intent(out) :: x(:)
      integer :: i

      x = 0.0_wp
      do i = size(order), 1, -1
         x(order(i)) = (z(i) - dot_product(r(i, order(i + 1:)), x(order(i + 1:))))/r(i, order(i))
      end do
   end subroutine substitute_back
end module dda_least_squares
