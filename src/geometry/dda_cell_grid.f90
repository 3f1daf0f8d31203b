!> A grid of cells that knows which segments pass through each cell, so that neighbours are found
!> without asking all pairs
module dda_cell_grid
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: cell_grid_t, new_cell_grid, cell_of

   !> Most entries of a grid
   integer(int64), parameter :: max_entries = 50000000_int64
   !> Most cells along one side
   integer, parameter :: max_side = 4096

   !> Cells, row by row; cell c holds the segments item(first(c):first(c + 1) - 1)
   type :: cell_grid_t
      !> Lower left corner: (2) [m]
      real(wp) :: corner(2) = 0.0_wp
      !> Width and height of a cell: (2) [m]
      real(wp) :: width(2) = 1.0_wp
      !> Number of columns and rows: (2)
      integer :: n(2) = 1
      !> First item of each cell, and one beyond the last: (n(1)*n(2) + 1)
      integer, allocatable :: first(:)
      !> Numbers of the segments
      integer, allocatable :: item(:)
   end type cell_grid_t

contains

   !> A grid of about as many cells as there are segments; a single cell where more would mean more
   !> pairs of neighbours
   pure subroutine new_cell_grid(segment, margin, grid)
      real(wp), intent(in) :: segment(:, :)  !! Ends x1, y1, x2, y2: (4, n) [m]
      real(wp), intent(in) :: margin         !! A segment also belongs to cells closer than this [m]
      type(cell_grid_t), intent(out) :: grid
      real(wp) :: box(2, 2), side(2), span
      integer(int64) :: n, pairs, entries

      n = size(segment, 2)
      call bounding_box(segment, margin, box)
      grid%corner = box(:, 1)
      side = box(:, 2) - box(:, 1)
      span = sqrt(max(side(1), 1.0e-6_wp*side(2))*max(side(2), 1.0e-6_wp*side(1)) &
         & /real(max(n, 1_int64), wp))
      grid%n = 1
      if (span > 0.0_wp) grid%n = min(max_side, max(1, int(min(side/span, real(max_side, wp)))))
      do
         grid%width = max(side/grid%n, tiny(1.0_wp))
         call count_cells(segment, margin, grid, entries)
         if (entries <= max_entries .or. all(grid%n == 1)) exit
         grid%n = max(1, grid%n/2)
      end do
      pairs = sum(int(grid%first(2:), int64)**2)/2
      if (pairs > n*n/2 .and. any(grid%n > 1)) then
         grid%n = 1
         grid%width = max(side, tiny(1.0_wp))
         call count_cells(segment, margin, grid, entries)
      end if
      call fill_cells(segment, margin, grid)
   end subroutine new_cell_grid

   !> Number of the cell that holds a point; the nearest one for points outside
   pure integer function cell_of(grid, point)
      type(cell_grid_t), intent(in) :: grid
      real(wp), intent(in) :: point(2)  !! The point: (2) [m]
      integer :: at(2)

      at = place_of(grid, point)
      cell_of = at(1) + grid%n(1)*(at(2) - 1)
   end function cell_of

   !> Column and row of a point
   pure function place_of(grid, point) result(at)
      type(cell_grid_t), intent(in) :: grid
      real(wp), intent(in) :: point(2)
      integer :: at(2)  !! Column and row: (2)

      at = 1 + int(max(0.0_wp, min((point - grid%corner)/grid%width, real(grid%n - 1, wp))))
   end function place_of

   !> The box around all segments
   pure subroutine bounding_box(segment, margin, box)
      real(wp), intent(in) :: segment(:, :)
      real(wp), intent(in) :: margin      !! Room around them [m]
      real(wp), intent(out) :: box(2, 2)  !! Lower left and upper right corner: (2, 2) [m]
      integer :: i

      box = 0.0_wp
      if (size(segment, 2) == 0) return
      do i = 1, 2
         box(i, 1) = min(minval(segment(i, :)), minval(segment(i + 2, :))) - margin
         box(i, 2) = max(maxval(segment(i, :)), maxval(segment(i + 2, :))) + margin
      end do
   end subroutine bounding_box

   !> Columns of a segment
   pure subroutine column_range(segment, margin, grid, from, to)
      real(wp), intent(in) :: segment(4)  !! Ends: (4) [m]
      real(wp), intent(in) :: margin
      type(cell_grid_t), intent(in) :: grid
      integer, intent(out) :: from        !! First column
      integer, intent(out) :: to          !! Last column
      integer :: at(2)

      at = place_of(grid, [min(segment(1), segment(3)) - margin, segment(2)])
      from = at(1)
      at = place_of(grid, [max(segment(1), segment(3)) + margin, segment(2)])
      to = at(1)
   end subroutine column_range

   !> Rows that a segment passes within one column
   pure subroutine row_range(segment, margin, grid, column, from, to)
      real(wp), intent(in) :: segment(4), margin
      type(cell_grid_t), intent(in) :: grid
      integer, intent(in) :: column  !! The column
      integer, intent(out) :: from   !! First row
      integer, intent(out) :: to     !! Last row
      real(wp) :: left, room, y(2), slope
      integer :: at(2)

      ! rounding of a place in the grid must not part a segment from its cells
      room = margin + 1.0e-9_wp*maxval(grid%width)
      left = grid%corner(1) + (column - 1)*grid%width(1) - room
      y = segment([2, 4])
      if (abs(segment(3) - segment(1)) > 1.0e-3_wp*abs(segment(4) - segment(2))) then
         slope = (segment(4) - segment(2))/(segment(3) - segment(1))
         y = segment(2) + slope*([left, left + grid%width(1) + 2.0_wp*room] - segment(1))
         y = max(min(segment(2), segment(4)), min(y, max(segment(2), segment(4))))
      end if
      at = place_of(grid, [segment(1), minval(y) - room])
      from = at(2)
      at = place_of(grid, [segment(1), maxval(y) + room])
      to = at(2)
   end subroutine row_range

   !> Count the segments of each cell; first(c + 1) receives the number of cell c
   pure subroutine count_cells(segment, margin, grid, entries)
      real(wp), intent(in) :: segment(:, :), margin
      type(cell_grid_t), intent(inout) :: grid
      integer(int64), intent(out) :: entries  !! Number of all entries
      integer :: i, column, row, from, to, low, high, cell

      if (allocated(grid%first)) deallocate (grid%first)
      allocate (grid%first(grid%n(1)*grid%n(2) + 1), source=0)
      entries = 0
      do i = 1, size(segment, 2)
         call column_range(segment(:, i), margin, grid, from, to)
         do column = from, to
            call row_range(segment(:, i), margin, grid, column, low, high)
            do row = low, high
               cell = column + grid%n(1)*(row - 1)
               grid%first(cell + 1) = grid%first(cell + 1) + 1
            end do
            entries = entries + high - low + 1
         end do
         if (entries > max_entries .and. any(grid%n > 1)) return
      end do
   end subroutine count_cells

   !> Put the segments into their cells
   pure subroutine fill_cells(segment, margin, grid)
      real(wp), intent(in) :: segment(:, :), margin
      type(cell_grid_t), intent(inout) :: grid
      integer, allocatable :: next(:)
      integer :: i, c, column, row, from, to, low, high

      grid%first(1) = 1
      do c = 2, size(grid%first)
         grid%first(c) = grid%first(c - 1) + grid%first(c)
      end do
      allocate (next, source=grid%first)
      allocate (grid%item(grid%first(size(grid%first)) - 1))
      do i = 1, size(segment, 2)
         call column_range(segment(:, i), margin, grid, from, to)
         do column = from, to
            call row_range(segment(:, i), margin, grid, column, low, high)
            do row = low, high
               c = column + grid%n(1)*(row - 1)
               grid%item(next(c)) = i
               next(c) = next(c) + 1
            end do
         end do
      end do
   end subroutine fill_cells
end module dda_cell_grid
