!> Nodes that are found by their place: a table of small squares
module dda_node_table
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   implicit none
   private

   public :: node_table_t, new_node_table, add_node, nearest_node

   !> Nodes, and for each square a chain of those that lie in it
   type :: node_table_t
      !> How many nodes there are
      integer :: n = 0
      !> Their places: (2, n or more) [m]
      real(wp), allocatable :: point(:, :)
      !> Side of a square [m]
      real(wp) :: side = 1.0_wp
      !> First node of each chain, 0 if it is empty
      integer, allocatable :: first(:)
      !> Next node of the chain, 0 at its end: (n or more)
      integer, allocatable :: next(:)
   end type node_table_t

contains

   !> An empty table
   pure subroutine new_node_table(room, side, table)
      !> Most nodes
      integer, intent(in) :: room
      !> Largest distance at which a node will be looked for [m]
      real(wp), intent(in) :: side
      type(node_table_t), intent(out) :: table

      allocate (table%point(2, room), table%next(room))
      allocate (table%first(0:max(2*room, 16) - 1), source=0)
      table%side = side
   end subroutine new_node_table

   !> Add a node; the table must have room
   pure subroutine add_node(table, point)
      type(node_table_t), intent(inout) :: table
      !> Its place: (2) [m]
      real(wp), intent(in) :: point(2)
      integer :: chain

      chain = chain_of(table, square_of(table, point))
      table%n = table%n + 1
      table%point(:, table%n) = point
      table%next(table%n) = table%first(chain)
      table%first(chain) = table%n
   end subroutine add_node

   !> The node nearest to a point within a distance; the older of two
   pure integer function nearest_node(table, point, distance)
      type(node_table_t), intent(in) :: table
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      !> How far a node may be, at most the side of the table [m]
      real(wp), intent(in) :: distance
      real(wp) :: nearest, here
      integer(int64) :: square(2)
      integer :: i, j, node

      nearest_node = 0
      nearest = distance
      square = square_of(table, point)
      do i = -1, 1
         do j = -1, 1
            node = table%first(chain_of(table, square + [i, j]))
            do while (node > 0)
               here = norm2(table%point(:, node) - point)
               if (here < nearest .or. (here <= nearest .and. &
                  & (nearest_node == 0 .or. node < nearest_node))) then
                  nearest = here
                  nearest_node = node
               end if
               node = table%next(node)
            end do
         end do
      end do
   end function nearest_node

   !> The square that holds a point
   pure function square_of(table, point) result(square)
      type(node_table_t), intent(in) :: table
      real(wp), intent(in) :: point(2)
      !> Column and row: (2)
      integer(int64) :: square(2)

      square = floor(point/table%side, int64)
   end function square_of

   !> The chain that a square belongs to; several squares share one
   pure integer function chain_of(table, square)
      type(node_table_t), intent(in) :: table
      !> Column and row: (2)
      integer(int64), intent(in) :: square(2)
      integer(int64), parameter :: prime(2) = [73856093_int64, 19349663_int64]
      integer(int64), parameter :: room = 1000000007_int64

      chain_of = int(modulo(modulo(square(1), room)*prime(1) + modulo(square(2), room)*prime(2), &
         & size(table%first, kind=int64)))
   end function chain_of
end module dda_node_table
