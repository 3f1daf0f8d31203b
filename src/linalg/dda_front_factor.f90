!> Factors of a dense panel: of narrow ones inline, of wide ones by LAPACK
module dda_front_factor
   use dda_kinds, only : wp
   use dda_lapack, only : dgemm, dlaswp, dpotrf, dtrsm
   implicit none
   private

   public :: factor_front, narrow, take_triple

   !> Columns up to which inline elimination is faster than BLAS
   integer, parameter :: narrow = 36

contains

   !> Factor one panel: L L' of a wide one, L D L' of a narrow one, or L U
   pure subroutine factor_front(symmetric, width, below, front, exchange, info)
      logical, intent(in) :: symmetric                       !! Whether the matrix is
      integer, intent(in) :: width                           !! Columns of the panel
      integer, intent(in) :: below                           !! Rows below its diagonal
      real(wp), intent(inout) :: front(width + below, *)     !! The panel
      integer, intent(inout) :: exchange(width)              !! Exchanges of its rows
      integer, intent(out) :: info                           !! 0 if it has a factor
      integer :: height

      height = width + below
      if (.not. symmetric) then
         call factor_pair(width, height, below, front, front(1, width + 1), exchange, info)
      else if (width <= narrow) then
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

   !> Factor a narrow panel into L D L', three columns at a time: D stands on the diagonal of L,
   !> whose own is ones. Blocks that nothing holds move as their load over their mass to the last
   !> bit, which roots on the diagonal would spoil
   pure subroutine factor_narrow(width, height, front, info)
      integer, intent(in) :: width
      integer, intent(in) :: height                !! Rows of the panel
      real(wp), intent(inout) :: front(height, *)  !! Its columns
      integer, intent(out) :: info
      integer :: c, j, k

      do c = 1, width, 3
         do k = c, c + 2
            do j = c, k - 1
               front(k:height, k) = front(k:height, k) &
                  & - front(k:height, j)*(front(k, j)*front(j, j))
            end do
            info = k
            if (.not. front(k, k) > 0.0_wp) return
            front(k + 1:height, k) = front(k + 1:height, k)/front(k, k)
         end do
         do k = c + 3, width
            call take_triple(height + 1 - k, front(k, c), front(k, c + 1), front(k, c + 2), &
               & [front(k, c)*front(c, c), front(k, c + 1)*front(c + 1, c + 1), &
               & front(k, c + 2)*front(c + 2, c + 2)], front(k, k))
         end do
      end do
      info = 0
   end subroutine factor_narrow

   !> Factor a panel that is not symmetric, a few columns at a time. Rows change places within three
   !> unknowns of a block alone: pivots among blocks of which one is held far more stiffly than the
   !> other would cost the soft one its digits
   pure subroutine factor_pair(width, height, below, front, right, exchange, info)
      integer, intent(in) :: width, height, below
      real(wp), intent(inout) :: front(height, *)
      real(wp), intent(inout) :: right(width, *)   !! Its rows to the right of the diagonal
      integer, intent(inout) :: exchange(width)
      integer, intent(out) :: info
      integer :: behind, c, n

      do c = 1, width, narrow
         n = min(narrow, width + 1 - c)
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
         integer, intent(in) :: m                   !! How many others
         integer, intent(in) :: rows                !! Rows of them
         integer, intent(in) :: ld                  !! Distance of two columns
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
      integer, intent(in) :: n             !! Columns
      integer, intent(in) :: height, ld    !! Their rows, and the distance of two of them
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

   !> Take three columns from another one
   pure subroutine take_triple(n, one, two, three, factor, rest)
      integer, intent(in) :: n                            !! Rows
      real(wp), intent(in) :: one(n), two(n), three(n)    !! The columns
      real(wp), intent(in) :: factor(3)                   !! How much of each
      real(wp), intent(inout) :: rest(n)                  !! Vector that they are subtracted from
      integer :: i

      do i = 1, n
         rest(i) = rest(i) - (one(i)*factor(1) + two(i)*factor(2) + three(i)*factor(3))
      end do
   end subroutine take_triple
end module dda_front_factor
