!> Intersections of lines, and their network of nodes and edges (Shi: dc04, dc05)
module dda_line_network
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_box_tree, only : box_tree_t, find_boxes, segment_tree
   use dda_cut_model, only : add_remark, cut_reason, cut_remarks_t, cut_scale_t
   use dda_error, only : error_t, fatal_error
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_segment, only : meeting_points, overshoot
   use dda_sort, only : sort_numbers, sorted_order
   use dda_text, only : to_text
   implicit none
   private

   public :: crossings_t, find_crossings, add_node, drop_edge, edge_place, join_crossings
   public :: half_edge_start, nearest_node, network_t, new_node_table, node_table_t

   !> Maximum number of crossings
   integer, parameter :: max_crossings = 30000000

   !> Common points of two lines, with the line numbers
   type :: crossings_t
      integer :: n = 0                    !! Number of crossings
      integer, allocatable :: line(:, :)  !! The two lines, the smaller number first: (2, n or more)
      real(wp), allocatable :: point(:, :)  !! The points: (2, n or more) [m]
   end type crossings_t

   !> Nodes, and edges between neighbouring nodes of a line
   type :: network_t
      real(wp), allocatable :: node(:, :)  !! Nodes: (2, n_node) [m]
      !> First and second node of each edge, along its line: (2, n_edge)
      integer, allocatable :: edge(:, :)
      integer, allocatable :: line(:)   !! Line of each edge: (n_edge)
      logical, allocatable :: alive(:)  !! Edges that were not dropped: (n_edge)
      integer :: n_boundary = 0         !! Number of boundary lines, the first ones
      integer :: n_merged = 0  !! Number of crossings merged with an existing node at another place
   end type network_t

   !> Nodes, and for each square a linked list of the nodes in it
   type :: node_table_t
      integer :: n = 0                      !! Number of nodes
      real(wp), allocatable :: point(:, :)  !! Coordinates: (2, n or more) [m]
      real(wp) :: side = 1.0_wp             !! Side of a square [m]
      integer, allocatable :: first(:)      !! First node of each list, 0 if it is empty
      integer, allocatable :: next(:)       !! Next node of the list, 0 at its end: (n or more)
   end type node_table_t

contains

   !> Find all crossings, ordered by the first line, then by the second
   pure subroutine find_crossings(line, reach, crossings, error)
      real(wp), intent(in) :: line(:, :)  !! Ends of the lines: (4, n) [m]
      real(wp), intent(in) :: reach       !! Distance within which points coincide [m]
      type(crossings_t), intent(out) :: crossings
      type(error_t), allocatable, intent(out) :: error  !! Allocated if there are too many
      type(box_tree_t) :: tree
      integer, allocatable :: near(:)
      real(wp) :: point(2, 2), margin
      integer :: i, k, m, n, n_near

      call segment_tree(line, tree)
      margin = reach + overshoot*norm2(tree%high(:, 1) - tree%low(:, 1))
      allocate (crossings%line(2, 64), crossings%point(2, 64))
      do i = 1, size(line, 2)
         call find_boxes(tree, min(line(1:2, i), line(3:4, i)) - reach, &
            & max(line(1:2, i), line(3:4, i)) + reach, near, n_near, above=i, segment=line(:, i), &
            & margin=margin)
         call sort_numbers(near(:n_near))
         do k = 1, n_near
            call meeting_points(line(:, i), line(:, near(k)), reach, n, point)
            do m = 1, n
               call add_crossing(crossings, i, near(k), point(:, m))
            end do
         end do
         if (crossings%n <= max_crossings) cycle
         call fatal_error(error, "expected fewer than "//to_text(max_crossings) &
            & //" crossings of lines, got more; remove lines")
         return
      end do
   end subroutine find_crossings

   !> Add a crossing
   pure subroutine add_crossing(crossings, i, j, point)
      type(crossings_t), intent(inout) :: crossings
      integer, intent(in) :: i          !! Number of one line
      integer, intent(in) :: j          !! Number of the other line, larger than i
      real(wp), intent(in) :: point(2)  !! The point: (2) [m]

      ! double the capacity
      if (crossings%n == size(crossings%line, 2)) crossings%line = reshape([crossings%line, &
         & crossings%line], [2, 2*crossings%n])
      call make_room(crossings%point, crossings%n + 1)
      crossings%n = crossings%n + 1
      crossings%line(:, crossings%n) = [i, j]
      crossings%point(:, crossings%n) = point
   end subroutine add_crossing

   !> Make nodes from crossings and edges from lines
   pure subroutine join_crossings(line, n_boundary, scale, crossings, network, remarks)
      real(wp), intent(in) :: line(:, :)      !! Ends of the lines: (4, n_line) [m]
      integer, intent(in) :: n_boundary       !! Number of boundary lines, the first ones
      type(cut_scale_t), intent(in) :: scale  !! Scales of the cut
      type(crossings_t), intent(in) :: crossings
      type(network_t), intent(out) :: network
      !> Receives lines without edges and duplicate edges
      type(cut_remarks_t), intent(inout) :: remarks
      integer, allocatable :: node_of(:)

      network%n_boundary = n_boundary
      call merge_nodes(scale, crossings, network, node_of)
      call chain_lines(line, crossings, node_of, network, remarks)
      call drop_doubled(network, remarks)
   end subroutine join_crossings

   !> Ends of an edge
   pure function edge_place(network, edge) result(place)
      type(network_t), intent(in) :: network
      integer, intent(in) :: edge  !! Number of the edge
      real(wp) :: place(4)         !! Ends: (4) [m]

      place(1:2) = network%node(:, network%edge(1, edge))
      place(3:4) = network%node(:, network%edge(2, edge))
   end function edge_place

   !> Drop an edge and record the reason
   pure subroutine drop_edge(network, edge, reason, other, remarks)
      type(network_t), intent(inout) :: network
      integer, intent(in) :: edge
      integer, intent(in) :: reason  !! One of cut_reason
      integer, intent(in) :: other   !! Number of the conflicting line, or 0
      type(cut_remarks_t), intent(inout) :: remarks

      network%alive(edge) = .false.
      call add_remark(remarks, network%line(edge), reason, other, edge_place(network, edge))
   end subroutine drop_edge

   !> Node of each crossing: the nearest existing one within 1.25 e00 w0, else a new one. A node of
   !> two boundary lines is shared only by crossings at exactly the same place
   pure subroutine merge_nodes(scale, crossings, network, node_of)
      type(cut_scale_t), intent(in) :: scale
      type(crossings_t), intent(in) :: crossings
      type(network_t), intent(inout) :: network
      integer, allocatable, intent(out) :: node_of(:)  !! Node of each crossing: (n)
      type(node_table_t) :: table
      real(wp) :: distance
      integer :: k

      allocate (node_of(crossings%n))
      call new_node_table(crossings%n, 1.001_wp*scale%merge, table)
      do k = 1, crossings%n
         distance = scale%merge
         if (all(crossings%line(:, k) <= network%n_boundary)) distance = scale%reach
         node_of(k) = nearest_node(table, crossings%point(:, k), distance)
         if (node_of(k) == 0) then
            call add_node(table, crossings%point(:, k))
            node_of(k) = table%n
         else if (norm2(crossings%point(:, k) - table%point(:, node_of(k))) > scale%reach) then
            network%n_merged = network%n_merged + 1
         end if
      end do
      allocate (network%node, source=table%point(:, :table%n))
   end subroutine merge_nodes

   !> Make edges between neighbouring nodes of each line
   pure subroutine chain_lines(line, crossings, node_of, network, remarks)
      real(wp), intent(in) :: line(:, :)
      type(crossings_t), intent(in) :: crossings
      integer, intent(in) :: node_of(:)
      type(network_t), intent(inout) :: network
      type(cut_remarks_t), intent(inout) :: remarks
      integer, allocatable :: on_line(:), node(:), order(:), seen(:), last(:)
      real(wp), allocatable :: along(:)
      integer :: i, k, n, n_edge

      n = crossings%n
      allocate (on_line(2*n), node(2*n), along(2*n))
      on_line(:n) = crossings%line(1, :n)
      on_line(n + 1:) = crossings%line(2, :n)
      node(:n) = node_of
      node(n + 1:) = node_of
      do k = 1, 2*n
         i = on_line(k)
         along(k) = dot_product(network%node(:, node(k)) - line(1:2, i), &
            & line(3:4, i) - line(1:2, i))
      end do
      allocate (order, source=sorted_order(on_line, along))
      allocate (seen(size(network%node, 2)), last(size(line, 2)), source=0)
      allocate (network%edge(2, 2*n), network%line(2*n))
      n_edge = 0
      do k = 1, 2*n
         i = on_line(order(k))
         associate (here => node(order(k)))
            if (seen(here) == i) cycle
            seen(here) = i
            if (last(i) > 0) then
               n_edge = n_edge + 1
               network%edge(:, n_edge) = [last(i), here]
               network%line(n_edge) = i
            end if
            last(i) = here
         end associate
      end do
      network%edge = network%edge(:, :n_edge)
      network%line = network%line(:n_edge)
      allocate (network%alive(n_edge), source=.true.)
      call record_loose_lines(line, network, remarks)
   end subroutine chain_lines

   !> Record the lines with fewer than two nodes, which have no edges
   pure subroutine record_loose_lines(line, network, remarks)
      real(wp), intent(in) :: line(:, :)
      type(network_t), intent(in) :: network
      type(cut_remarks_t), intent(inout) :: remarks
      logical, allocatable :: has_edge(:)
      integer :: i

      allocate (has_edge(size(line, 2)), source=.false.)
      has_edge(network%line) = .true.
      do i = 1, size(line, 2)
         if (has_edge(i)) cycle
         call add_remark(remarks, i, merge(cut_reason%point, cut_reason%loose_line, &
            & all(abs(line(3:4, i) - line(1:2, i)) <= 0.0_wp)), 0, line(:, i))
      end do
   end subroutine record_loose_lines

   !> Drop duplicate edges between the same two nodes; that of the first line is kept
   pure subroutine drop_doubled(network, remarks)
      type(network_t), intent(inout) :: network
      type(cut_remarks_t), intent(inout) :: remarks
      integer, allocatable :: order(:)
      integer :: k, kept

      if (size(network%line) == 0) return
      allocate (order, source=sorted_order(minval(network%edge, 1), &
         & real(maxval(network%edge, 1), wp)))
      kept = order(1)
      do k = 2, size(order)
         associate (edge => order(k))
            if (minval(network%edge(:, edge)) == minval(network%edge(:, kept)) &
               & .and. maxval(network%edge(:, edge)) == maxval(network%edge(:, kept))) then
               call drop_edge(network, edge, cut_reason%doubled, network%line(kept), remarks)
            else
               kept = edge
            end if
         end associate
      end do
   end subroutine drop_doubled

   !> Make an empty table of small squares
   pure subroutine new_node_table(room, side, table)
      integer, intent(in) :: room   !! Maximum number of nodes
      real(wp), intent(in) :: side  !! Largest search distance [m]
      type(node_table_t), intent(out) :: table

      allocate (table%point(2, room), table%next(room))
      allocate (table%first(0:max(2*room, 16) - 1), source=0)
      table%side = side
   end subroutine new_node_table

   !> Add a node; the table must have room
   pure subroutine add_node(table, point)
      type(node_table_t), intent(inout) :: table
      real(wp), intent(in) :: point(2)  !! Coordinates: (2) [m]
      integer :: chain

      chain = chain_of(table, square_of(table, point))
      table%n = table%n + 1
      table%point(:, table%n) = point
      table%next(table%n) = table%first(chain)
      table%first(chain) = table%n
   end subroutine add_node

   !> The node nearest to a point within a distance; the older of two equally near ones
   pure integer function nearest_node(table, point, distance)
      type(node_table_t), intent(in) :: table
      real(wp), intent(in) :: point(2)
      real(wp), intent(in) :: distance  !! Search distance, at most the side of the table [m]
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

   !> The square that contains a point
   pure function square_of(table, point) result(square)
      type(node_table_t), intent(in) :: table
      real(wp), intent(in) :: point(2)
      integer(int64) :: square(2)  !! Column and row: (2)

      square = floor(point/table%side, int64)
   end function square_of

   !> List of a square; several squares share one list
   pure integer function chain_of(table, square)
      type(node_table_t), intent(in) :: table
      integer(int64), intent(in) :: square(2)  !! Column and row: (2)
      integer(int64), parameter :: prime(2) = [73856093_int64, 19349663_int64]
      integer(int64), parameter :: room = 1000000007_int64

      chain_of = int(modulo(modulo(square(1), room)*prime(1) + modulo(square(2), room)*prime(2), &
         & size(table%first, kind=int64)))
   end function chain_of

   !> Node where a half-edge starts
   pure integer function half_edge_start(network, half_edge)
      type(network_t), intent(in) :: network
      integer, intent(in) :: half_edge  !! Number of the half-edge

      half_edge_start = network%edge(2 - mod(half_edge, 2), (half_edge + 1)/2)
   end function half_edge_start
end module dda_line_network
