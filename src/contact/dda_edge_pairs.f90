!> Edges of different blocks that come near one another: found by a tree of boxes, and remembered
!> with a margin, so that the tree is built again only when a corner has used its margin up
!> (L. Verlet, 1967; the fattened boxes of E. Catto's Box2D)
!>
!> What is remembered is only where to look: whoever asks gets the pairs whose boxes overlap now, in
!> the same order, whether or not they were remembered.
module dda_edge_pairs
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_box_tree, only : box_pairs
   use dda_kinds, only : wp
   use dda_outline, only : outline_t
   use dda_sort, only : rising_order
   implicit none
   private

   public :: edge_pairs_t, find_edge_pairs, remember_edge_pairs

   !> Pairs of edges that were near, and how far their corners can go before others may be
   type :: edge_pairs_t
      !> The pairs in the order of their blocks: (2, n_pair)
      integer, allocatable :: pair(:, :)
      !> Corners when they were found: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Reach of each block that they were found for, margin included: (n_block) [m]
      real(wp), allocatable :: reach(:)
   end type edge_pairs_t

   !> Least and most margin over the size of a block
   real(wp), parameter :: least = 0.05_wp, most = 0.5_wp
   !> Margin over the reach, between these two: a block that moves steadily uses up two thirds of
   !> its reach in a step
   real(wp), parameter :: ahead = 4.0_wp
   !> Rounding of ways, relative, with room to spare
   real(wp), parameter :: rounding = 1.0e-12_wp

contains

   !> Edges of different blocks whose boxes overlap, in the order of their blocks
   pure subroutine find_edge_pairs(known, outline, equation, vertex, reach, pair)
      type(edge_pairs_t), intent(in) :: known
      !> How the corners follow one another
      type(outline_t), intent(in) :: outline
      !> Number of each block in the equations; 0 for a block that cannot move: (n_block)
      integer, intent(in) :: equation(:)
      !> Where the corners are: (2, n_vertex) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> How far each block can reach: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> The pairs, of two fixed blocks none: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      real(wp) :: low(2, size(vertex, 2)), high(2, size(vertex, 2))
      integer, allocatable :: near(:, :)
      integer :: i, n

      call edge_boxes(outline, vertex, reach, low, high)
      if (.not. covers(known, outline, vertex, reach)) then
         call search_pairs(outline, equation, low, high, pair)
         return
      end if
      allocate (near, mold=known%pair)
      n = 0
      do i = 1, size(known%pair, 2)
         associate (a => known%pair(1, i), b => known%pair(2, i))
            if (low(1, b) > high(1, a) .or. low(2, b) > high(2, a)) cycle
            if (high(1, b) < low(1, a) .or. high(2, b) < low(2, a)) cycle
            n = n + 1
            near(:, n) = [a, b]
         end associate
      end do
      allocate (pair(2, n))
      pair = near(:, :n)
   end subroutine find_edge_pairs

   !> Remember what is near, unless what is remembered will do
   pure subroutine remember_edge_pairs(outline, equation, area, vertex, reach, known)
      type(outline_t), intent(in) :: outline
      integer, intent(in) :: equation(:)
      !> Areas of the blocks: (n_block) [m2]
      real(wp), intent(in) :: area(:)
      real(wp), intent(in) :: vertex(:, :), reach(:)
      type(edge_pairs_t), intent(inout) :: known
      real(wp) :: low(2, size(vertex, 2)), high(2, size(vertex, 2))

      if (covers(known, outline, vertex, reach)) return
      known%vertex = vertex
      known%reach = reach + merge(min(most*sqrt(area), max(least*sqrt(area), ahead*reach)), &
         & 0.0_wp, equation > 0)
      call edge_boxes(outline, vertex, known%reach, low, high)
      call search_pairs(outline, equation, low, high, known%pair)
   end subroutine remember_edge_pairs

   !> Whether all pairs that are near are among those that are remembered
   pure logical function covers(known, outline, vertex, reach)
      type(edge_pairs_t), intent(in) :: known
      type(outline_t), intent(in) :: outline
      real(wp), intent(in) :: vertex(:, :), reach(:)
      real(wp) :: way
      integer :: v

      covers = allocated(known%pair)
      if (.not. covers) return
      do v = 1, size(vertex, 2)
         way = maxval(abs(vertex(:, v) - known%vertex(:, v)))
         associate (b => outline%block(v))
            covers = (way + reach(b))*(1.0_wp + rounding) <= known%reach(b) &
               & .or. .not. way > 0.0_wp .and. reach(b) <= known%reach(b)
         end associate
         if (.not. covers) return
      end do
   end function covers

   !> Boxes that edges can get to
   pure subroutine edge_boxes(outline, vertex, reach, low, high)
      type(outline_t), intent(in) :: outline
      real(wp), intent(in) :: vertex(:, :), reach(:)
      !> Lower left corners of the boxes: (2, n_vertex) [m]
      real(wp), intent(out) :: low(:, :)
      !> Upper right corners: (2, n_vertex) [m]
      real(wp), intent(out) :: high(:, :)
      integer :: e

      do e = 1, size(vertex, 2)
         associate (next => outline%next(e), far => reach(outline%block(e)))
            low(:, e) = min(vertex(:, e), vertex(:, next)) - far
            high(:, e) = max(vertex(:, e), vertex(:, next)) + far
         end associate
      end do
   end subroutine edge_boxes

   !> Edges of different blocks whose boxes overlap, by a tree of all boxes
   pure subroutine search_pairs(outline, equation, low, high, pair)
      type(outline_t), intent(in) :: outline
      integer, intent(in) :: equation(:)
      real(wp), intent(in) :: low(:, :), high(:, :)
      !> The pairs in the order of their blocks: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      integer :: group(size(outline%block))
      integer(int64), allocatable :: key(:)
      integer, allocatable :: found(:, :)

      group = merge(outline%block, 0, equation(outline%block) > 0)
      call box_pairs(low, high, group, found)
      associate (block => outline%block, n => size(equation) + 1)
         allocate (key(size(found, 2)))
         key = int(block(found(1, :)), int64)*n + int(block(found(2, :)), int64)
         allocate (pair(2, size(found, 2)))
         pair = found(:, rising_order(key))
      end associate
   end subroutine search_pairs
end module dda_edge_pairs
