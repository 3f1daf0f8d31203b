!> Where lines meet (Shi: dc04)
module dda_line_crossings
   use dda_cell_grid, only : cell_grid_t, cell_of, new_cell_grid
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_segment, only : meeting_points
   use dda_sort, only : sorted_order
   use dda_text, only : to_text
   implicit none
   private

   public :: crossings_t, find_crossings

   !> Most crossings of a model
   integer, parameter :: max_crossings = 30000000

   !> Points that two lines have in common, by the numbers of the lines
   type :: crossings_t
      !> How many there are
      integer :: n = 0
      !> The two lines, the smaller number first: (2, n or more)
      integer, allocatable :: line(:, :)
      !> The points: (2, n or more) [m]
      real(wp), allocatable :: point(:, :)
   end type crossings_t

contains

   !> All crossings, ordered by the first line, then by the second
   pure subroutine find_crossings(line, reach, crossings, error)
      !> Ends of the lines: (4, n) [m]
      real(wp), intent(in) :: line(:, :)
      !> Distance within which things touch [m]
      real(wp), intent(in) :: reach
      type(crossings_t), intent(out) :: crossings
      !> Allocated if there are too many
      type(error_t), allocatable, intent(out) :: error
      type(cell_grid_t) :: grid
      integer, allocatable :: order(:)
      integer :: cell

      call new_cell_grid(line, 2.0_wp*reach, grid)
      allocate (crossings%line(2, 64), crossings%point(2, 64))
      do cell = 1, grid%n(1)*grid%n(2)
         call cross_in_cell(line, reach, grid, cell, crossings)
         if (crossings%n <= max_crossings) cycle
         call fatal_error(error, "expected fewer than "//to_text(max_crossings) &
            & //" crossings of lines, got more; remove lines")
         return
      end do
      associate (n => crossings%n)
         allocate (order, source=sorted_order(crossings%line(1, :n), &
            & real(crossings%line(2, :n), wp)))
         crossings%line = crossings%line(:, order)
         crossings%point = crossings%point(:, order)
      end associate
   end subroutine find_crossings

   !> Crossings that lie in one cell: each point belongs to one cell, so that none is found twice
   pure subroutine cross_in_cell(line, reach, grid, cell, crossings)
      real(wp), intent(in) :: line(:, :), reach
      type(cell_grid_t), intent(in) :: grid
      !> Number of the cell
      integer, intent(in) :: cell
      type(crossings_t), intent(inout) :: crossings
      real(wp) :: point(2, 2), low(2), high(2)
      integer :: a, b, i, j, k, n

      do a = grid%first(cell), grid%first(cell + 1) - 2
         i = grid%item(a)
         low = min(line(1:2, i), line(3:4, i)) - reach
         high = max(line(1:2, i), line(3:4, i)) + reach
         do b = a + 1, grid%first(cell + 1) - 1
            j = grid%item(b)
            if (any(max(line(1:2, j), line(3:4, j)) < low)) cycle
            if (any(min(line(1:2, j), line(3:4, j)) > high)) cycle
            call meeting_points(line(:, i), line(:, j), reach, n, point)
            do k = 1, n
               if (cell_of(grid, point(:, k)) == cell) &
                  & call add_crossing(crossings, i, j, point(:, k))
            end do
         end do
         if (crossings%n > max_crossings) return
      end do
   end subroutine cross_in_cell

   !> Add a crossing
   pure subroutine add_crossing(crossings, i, j, point)
      type(crossings_t), intent(inout) :: crossings
      !> One line
      integer, intent(in) :: i
      !> The other, with a larger number
      integer, intent(in) :: j
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      type(crossings_t) :: longer

      if (crossings%n == size(crossings%point, 2)) then
         allocate (longer%line(2, 2*crossings%n), longer%point(2, 2*crossings%n))
         longer%line(:, :crossings%n) = crossings%line
         longer%point(:, :crossings%n) = crossings%point
         call move_alloc(longer%line, crossings%line)
         call move_alloc(longer%point, crossings%point)
      end if
      crossings%n = crossings%n + 1
      crossings%line(:, crossings%n) = [i, j]
      crossings%point(:, crossings%n) = point
   end subroutine add_crossing
end module dda_line_crossings
