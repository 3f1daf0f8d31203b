!> Factors, products and substitutions of dense panels: of small ones inline, else by LAPACK
!>
!> The panel has w columns with w rows on the diagonal and m rows below it. A symmetric one is
!> factored into L D L' if it is small, D on the diagonal of L, whose own is ones, otherwise into
!> L L'; another one into L U. Blocks that nothing holds move as their load over their mass to the
!> last bit, which the roots of L L' would spoil.
module dda_front
   use dda_kinds, only : wp
   use dda_lapack, only : dgemm, dgemv, dlaswp, dpotrf, dsyrk, dtrsm, dtrsv
   implicit none
   private

   public :: factor_front, multiply_front, substitute_down, substitute_up

   !> Columns, and rows below the diagonal, up to which inline elimination of symmetric panels is
   !> faster than LAPACK
   integer, parameter :: narrow = 36, most_below = 60
   integer, parameter :: few = 12  !! Columns eliminated at a time where a panel is not symmetric

contains

   !> Factor a panel
   pure subroutine factor_front(symmetric, width, below, front, exchange, info)
      logical, intent(in) :: symmetric                     !! True if the matrix is
      integer, intent(in) :: width, below                  !! Columns, and rows below the diagonal
      real(wp), intent(inout) :: front(width + below, *)   !! The panel
      integer, intent(inout) :: exchange(width)            !! Exchanges of its rows
      integer, intent(out) :: info                         !! 0 if it has a factor
      integer :: height

      height = width + below
      if (.not. symmetric) then
         call factor_pair(width, height, below, front, front(1, width + 1), exchange, info)
      else if (width <= narrow .and. below <= most_below) then
         call factor_narrow(width, height, front, info)
      else
         call dpotrf("L", width, front, height, info)
         ! OpenBLAS lets NaN pass
         if (.not. front(width, width) > 0.0_wp) info = width
         if (info /= 0 .or. below == 0) return
         call dtrsm("R", "L", "T", "N", below, width, 1.0_wp, front, height, front(width + 1, 1), &
            & height)
      end if
   end subroutine factor_front

   !> Factor a narrow panel into L D L', three columns at a time
   pure subroutine factor_narrow(width, height, front, info)
      integer, intent(in) :: width, height  !! Columns and rows of the panel
      real(wp), intent(inout) :: front(height, *)  !! The panel
      integer, intent(out) :: info
      integer :: c, k

      do k = 1, width
         if (modulo(k, 3) == 1) call subtract_square(height + 1 - k, k - 1, height, front(k, 1), &
            & front, height, front(k, k))
         do c = k - modulo(k - 1, 3), k - 1
            front(k:height, k) = front(k:height, k) - front(k:height, c)*(front(k, c)*front(c, c))
         end do
         info = k
         if (.not. front(k, k) > 0.0_wp) return
         front(k + 1:height, k) = front(k + 1:height, k)/front(k, k)
      end do
      info = 0
   end subroutine factor_narrow

   !> Factor a panel that is not symmetric, a few columns at a time. Rows change places within three
   !> unknowns of a block alone: pivots among blocks of which one is held far more stiffly than the
   !> other would cost the soft one its digits
   pure subroutine factor_pair(width, height, below, front, right, exchange, info)
      integer, intent(in) :: width, height, below  !! Columns, rows, rows below
      real(wp), intent(inout) :: front(height, *)  !! The panel
      real(wp), intent(inout) :: right(width, *)   !! Its rows to the right of the diagonal
      integer, intent(inout) :: exchange(width)
      integer, intent(out) :: info
      integer :: behind, c, n

      do c = 1, width, few
         n = min(few, width + 1 - c)
         behind = c + n
         call factor_columns(n, height + 1 - c, height, front(c, c), exchange(c:behind - 1), info)
         if (info /= 0) return
         exchange(c:behind - 1) = exchange(c:behind - 1) + c - 1
         call dlaswp(c - 1, front, height, c, behind - 1, exchange, 1)
         call eliminate_rows(width + 1 - behind, height, height, front(1, behind))
         call eliminate_rows(below, width, width, right)
      end do

   contains

      !> Take the columns from others
      pure subroutine eliminate_rows(m, rows, ld, other)
         integer, intent(in) :: m, rows, ld         !! Others, their rows, distance of two of them
         real(wp), intent(inout) :: other(ld, *)    !! The others

         if (m < 1) return
         call dlaswp(m, other, ld, c, behind - 1, exchange, 1)
         call dtrsm("L", "L", "N", "U", n, m, 1.0_wp, front(c, c), height, other(c, 1), ld)
         if (rows < behind) return
         call dgemm("N", "N", rows + 1 - behind, m, n, -1.0_wp, front(behind, c), height, &
            & other(c, 1), ld, 1.0_wp, other(behind, 1), ld)
      end subroutine eliminate_rows
   end subroutine factor_pair

   !> Factor a few columns
   pure subroutine factor_columns(n, height, ld, a, exchange, info)
      integer, intent(in) :: n, height, ld !! Columns, their rows, the distance of two of them
      real(wp), intent(inout) :: a(ld, *)  !! The columns
      integer, intent(out) :: exchange(n)  !! Exchanges of rows
      integer, intent(out) :: info
      real(wp) :: row(n)
      integer :: j, k, p

      do k = 1, n
         p = k - 1 + maxloc(abs(a(k:3*((k + 2)/3), k)), dim=1)
         exchange(k) = p
         info = k
         if (.not. abs(a(p, k)) > 0.0_wp) return
         row = a(p, :n)
         a(p, :n) = a(k, :n)
         a(k, :n) = row
         a(k + 1:height, k) = a(k + 1:height, k)/a(k, k)
         do j = k + 1, n
            a(k + 1:height, j) = a(k + 1:height, j) - a(k + 1:height, k)*a(k, j)
         end do
      end do
      info = 0
   end subroutine factor_columns

   !> Product of the rows below the diagonal that elimination takes from other panels, with its
   !> sign; of a symmetric panel the lower triangle
   pure subroutine multiply_front(symmetric, width, below, omitted, front, share)
      logical, intent(in) :: symmetric
      integer, intent(in) :: width, below
      integer, intent(in) :: omitted  !! First columns of the product that are not needed
      real(wp), intent(in) :: front(width + below, *)
      real(wp), intent(inout) :: share(below, *)  !! The product: (below, below)
      integer :: height, k

      height = width + below
      if (.not. symmetric) then
         call dgemm("N", "N", below, below, width, -1.0_wp, front(width + 1, 1), height, &
            & front(1, width + 1), width, 0.0_wp, share, below)
      else if (width > narrow .or. below > most_below) then
         call dsyrk("L", "N", below, width, -1.0_wp, front(width + 1, 1), height, 0.0_wp, share, &
            & below)
      else
         do k = omitted + 1, below, 3
            share(k:below, k:k + 2) = 0.0_wp
            call subtract_square(below + 1 - k, width, height, front(width + k, 1), front, below, &
               & share(k, k))
         end do
      end if
   end subroutine multiply_front

   !> Solve with L, and take the solution from the rows below
   pure subroutine substitute_down(symmetric, width, below, front, exchange, x, rest)
      logical, intent(in) :: symmetric
      integer, intent(in) :: width, below
      real(wp), intent(in) :: front(width + below, *)
      integer, intent(in) :: exchange(width)
      real(wp), intent(inout) :: x(width)      !! Right-hand side in, solution out
      real(wp), intent(inout) :: rest(below)   !! Zeros in, what the rows below get out
      integer :: c, height

      height = width + below
      if (.not. symmetric) call dlaswp(1, x, width, 1, width, exchange, 1)
      if (merge(width > narrow .or. below > most_below, width > few, symmetric)) then
         call dtrsv("L", "N", merge("N", "U", symmetric), width, front, height, x, 1)
      else
         do c = 1, width, 3
            x(c + 1) = x(c + 1) - front(c + 1, c)*x(c)
            x(c + 2) = x(c + 2) - front(c + 2, c)*x(c) - front(c + 2, c + 1)*x(c + 1)
            if (c + 2 < width) call subtract_product(width - c - 2, 3, height, front(c + 3, c), &
               & x(c), x(c + 3))
         end do
      end if
      if (below > 0) call subtract_product(below, width, height, front(width + 1, 1), x, rest)
   end subroutine substitute_down

   !> Solve with the transpose of L, or with U
   pure subroutine substitute_up(symmetric, width, below, front, known, x)
      logical, intent(in) :: symmetric
      integer, intent(in) :: width, below
      real(wp), intent(in) :: front(width + below, *)
      real(wp), intent(in) :: known(below)      !! Solution of the rows below
      real(wp), intent(inout) :: x(width)       !! Right-hand side in, solution out
      integer :: c, height

      height = width + below
      if (.not. symmetric) then
         if (below > 0) call subtract_product(width, below, width, front(1, width + 1), known, x)
         do c = width, 1, -1
            x(c) = x(c)/front(c, c)
            x(:c - 1) = x(:c - 1) - front(:c - 1, c)*x(c)
         end do
      else if (width > narrow .or. below > most_below) then
         if (below > 0) call dgemv("T", below, width, -1.0_wp, front(width + 1, 1), height, &
            & known, 1, 1.0_wp, x, 1)
         call dtrsv("L", "T", "N", width, front, height, x, 1)
      else
         do c = 1, width
            x(c) = x(c)/front(c, c)
         end do
         do c = width - 2, 1, -3
            if (below > 0) call subtract_rows(below, height, front(width + 1, c), known, x(c))
            if (c + 2 < width) call subtract_rows(width - c - 2, height, front(c + 3, c), &
               & x(c + 3), x(c))
            x(c + 1) = x(c + 1) - front(c + 2, c + 1)*x(c + 2)
            x(c) = x(c) - front(c + 1, c)*x(c + 1) - front(c + 2, c)*x(c + 2)
         end do
      end if
   end subroutine substitute_up

   !> x - a D a', three columns of x. Three columns of both are in the registers at a time
   pure subroutine subtract_square(n, m, ld, a, front, ldx, x)
      integer, intent(in) :: n, m, ld, ldx    !! Rows, columns of a, distances of columns of a and x
      real(wp), intent(in) :: a(ld, *)        !! Rows of the panel: (n, m)
      real(wp), intent(in) :: front(ld, *)    !! The panel, with D on its diagonal
      real(wp), intent(inout) :: x(ldx, 3)    !! Columns that the product is taken from: (n, 3)
      real(wp) :: b(3, 3)
      integer :: c, i, k

      do c = 1, m, 3
         do k = 1, 3
            b(:, k) = a(:3, c + k - 1)*front(c + k - 1, c + k - 1)
         end do
         do i = 1, n
            x(i, 1) = x(i, 1) - (a(i, c)*b(1, 1) + a(i, c + 1)*b(1, 2) + a(i, c + 2)*b(1, 3))
            x(i, 2) = x(i, 2) - (a(i, c)*b(2, 1) + a(i, c + 1)*b(2, 2) + a(i, c + 2)*b(2, 3))
            x(i, 3) = x(i, 3) - (a(i, c)*b(3, 1) + a(i, c + 1)*b(3, 2) + a(i, c + 2)*b(3, 3))
         end do
      end do
   end subroutine subtract_square

   !> x - a b, of few columns inline, three at a time
   pure subroutine subtract_product(n, m, ld, a, b, x)
      integer, intent(in) :: n, m, ld         !! Rows, columns, and the distance of two columns
      real(wp), intent(in) :: a(ld, *)        !! Matrix: (n, m)
      real(wp), intent(in) :: b(m)            !! Vector
      real(wp), intent(inout) :: x(n)         !! Vector that the product is taken from
      integer :: c, i

      if (m > narrow) then
         call dgemv("N", n, m, -1.0_wp, a, ld, b, 1, 1.0_wp, x, 1)
         return
      end if
      do c = 1, m, 3
         do i = 1, n
            x(i) = x(i) - (a(i, c)*b(c) + a(i, c + 1)*b(c + 1) + a(i, c + 2)*b(c + 2))
         end do
      end do
   end subroutine subtract_product

   !> x - a' b of three columns
   pure subroutine subtract_rows(n, ld, a, b, x)
      integer, intent(in) :: n, ld
      real(wp), intent(in) :: a(ld, *)        !! Matrix: (n, 3)
      real(wp), intent(in) :: b(n)  !! Vector
      real(wp), intent(inout) :: x(3)  !! Vector that the products are taken from
      integer :: i

      do i = 1, n
         x = x - a(i, :3)*b(i)
      end do
   end subroutine subtract_rows
end module dda_front
