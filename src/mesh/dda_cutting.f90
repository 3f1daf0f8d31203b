!> From lines to blocks (Shi: dc)
!>
!> Edges that bound nothing or stand in the way are taken out of the network first (Shi: dc05,
!> dc06).
module dda_cutting
   use dda_cell_grid, only : cell_grid_t, cell_of, new_cell_grid
   use dda_cut_model, only : cut_model_t
   use dda_cut_points, only : block_around, block_boxes, boxes_t, give_materials, place_bolts, &
      & place_points, remove_holes
   use dda_cut_report, only : cut_reason, cut_remarks_t
   use dda_cut_scale, only : cut_scale, cut_scale_t
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_model, only : line_model_t
   use dda_line_network, only : crossings_t, drop_edge, edge_place, find_crossings, &
      & join_crossings, network_t
   use dda_loop_blocks, only : blocks_of_loops
   use dda_network_loops, only : half_edge_start, loops_t, trace_loops
   use dda_polygon, only : contains_point
   use dda_segment, only : crossing_parameters, segment_distance
   use dda_sort, only : sorted_order
   use dda_text, only : to_text
   implicit none
   private

   public :: cut_trees, drop_crossing_edges, drop_close_edges, check_areas, cut_blocks

contains

   !> Drop edges that end in nothing, until none is left: trees hang on no block (Shi: dc05)
   pure subroutine cut_trees(network, remarks)
      type(network_t), intent(inout) :: network
      type(cut_remarks_t), intent(inout) :: remarks
      integer, allocatable :: first(:), item(:), degree(:), loose(:)
      integer :: n, node, k, e

      call edges_of_nodes(network, first, item)
      allocate (degree, source=first(2:) - first(:size(first) - 1))
      loose = pack([(node, node=1, size(degree))], degree == 1)
      n = size(loose)
      do while (n > 0)
         node = loose(n)
         n = n - 1
         do k = first(node), first(node + 1) - 1
            e = item(k)
            if (.not. network%alive(e)) cycle
            call drop_edge(network, e, cut_reason%loose_edge, 0, remarks)
            degree(network%edge(:, e)) = degree(network%edge(:, e)) - 1
            ! one loose node gives way to one other at most, so the list never grows
            node = sum(network%edge(:, e)) - node
            if (degree(node) == 1) then
               n = n + 1
               loose(n) = node
            end if
            exit
         end do
      end do
   end subroutine cut_trees

   !> The living edges of each node
   pure subroutine edges_of_nodes(network, first, item)
      type(network_t), intent(in) :: network
      !> First item of each node, and one beyond the last: (n_node + 1)
      integer, allocatable, intent(out) :: first(:)
      !> Numbers of edges
      integer, allocatable, intent(out) :: item(:)
      integer, allocatable :: next(:)
      integer :: e, k, node

      allocate (first(size(network%node, 2) + 1), source=0)
      do e = 1, size(network%line)
         if (network%alive(e)) first(network%edge(:, e) + 1) = first(network%edge(:, e) + 1) + 1
      end do
      first(1) = 1
      do node = 2, size(first)
         first(node) = first(node) + first(node - 1)
      end do
      allocate (item(first(size(first)) - 1))
      allocate (next, source=first)
      do e = 1, size(network%line)
         if (.not. network%alive(e)) cycle
         do k = 1, 2
            node = network%edge(k, e)
            item(next(node)) = e
            next(node) = next(node) + 1
         end do
      end do
   end subroutine edges_of_nodes

   !> Drop one of two edges that cross between their nodes, as happens when nodes were merged: the
   !> one that is no boundary, else that of the later line (Shi: dc06)
   pure subroutine drop_crossing_edges(network, scale, remarks, crossing)
      type(network_t), intent(inout) :: network
      !> Scales of the cut
      type(cut_scale_t), intent(in) :: scale
      type(cut_remarks_t), intent(inout) :: remarks
      !> Two boundary lines that still cross; 0 if none do: (2)
      integer, intent(out) :: crossing(2)
      type(cell_grid_t) :: grid
      real(wp), allocatable :: place(:, :)
      integer, allocatable :: number(:), pair(:, :), order(:)
      integer :: k, e, f

      crossing = 0
      call living_edges(network, number, place)
      call new_cell_grid(place, 2.0_wp*scale%reach, grid)
      call crossing_pairs(network, scale%reach, number, place, grid, pair)
      allocate (order, source=sorted_order(pair(1, :), real(pair(2, :), wp)))
      do k = 1, size(order)
         e = pair(1, order(k))
         f = pair(2, order(k))
         if (.not. all(network%alive([e, f]))) cycle
         if (network%line(f) < network%line(e)) then
            e = pair(2, order(k))
            f = pair(1, order(k))
         end if
         if (network%line(f) <= network%n_boundary) then
            crossing = network%line([e, f])
         else
            call drop_edge(network, f, cut_reason%crossing, network%line(e), remarks)
         end if
      end do
   end subroutine drop_crossing_edges

   !> Pairs of edges that cross between their nodes; a pair may come several times
   pure subroutine crossing_pairs(network, reach, number, place, grid, pair)
      type(network_t), intent(in) :: network
      !> Distance within which things touch [m]
      real(wp), intent(in) :: reach
      !> Numbers of the living edges: (n)
      integer, intent(in) :: number(:)
      !> Their ends: (4, n) [m]
      real(wp), intent(in) :: place(:, :)
      type(cell_grid_t), intent(in) :: grid
      !> Edges, the smaller number first: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      integer, allocatable :: longer(:, :)
      integer :: cell, a, b, n

      allocate (pair(2, 16))
      n = 0
      do cell = 1, grid%n(1)*grid%n(2)
         do a = grid%first(cell), grid%first(cell + 1) - 2
            do b = a + 1, grid%first(cell + 1) - 1
               if (.not. edges_cross(network, reach, number(grid%item([a, b])), &
                  & place(:, grid%item(a)), place(:, grid%item(b)))) cycle
               if (n == size(pair, 2)) then
                  allocate (longer(2, 2*n))
                  longer(:, :n) = pair
                  call move_alloc(longer, pair)
               end if
               n = n + 1
               pair(:, n) = number(grid%item([a, b]))
            end do
         end do
      end do
      pair = pair(:, :n)
   end subroutine crossing_pairs

   !> Whether two edges cross between their nodes
   pure logical function edges_cross(network, reach, edge, first, second)
      type(network_t), intent(in) :: network
      real(wp), intent(in) :: reach
      !> Numbers of the edges: (2)
      integer, intent(in) :: edge(2)
      !> Ends of the first: (4) [m]
      real(wp), intent(in) :: first(4)
      !> Ends of the second: (4) [m]
      real(wp), intent(in) :: second(4)
      real(wp) :: share(2), rim(2)

      edges_cross = .false.
      if (max(first(1), first(3)) < min(second(1), second(3))) return
      if (min(first(1), first(3)) > max(second(1), second(3))) return
      if (max(first(2), first(4)) < min(second(2), second(4))) return
      if (min(first(2), first(4)) > max(second(2), second(4))) return
      if (any(network%edge(:, edge(1)) == network%edge(1, edge(2)))) return
      if (any(network%edge(:, edge(1)) == network%edge(2, edge(2)))) return
      call crossing_parameters(first, second, share, edges_cross)
      rim = reach/[norm2(first(3:4) - first(1:2)), norm2(second(3:4) - second(1:2))]
      edges_cross = edges_cross .and. all(share > rim .and. share < 1.0_wp - rim)
   end function edges_cross

   !> Drop joints that pass a node of other lines closer than e00 w0 (Shi: dc06)
   pure subroutine drop_close_edges(network, scale, remarks)
      type(network_t), intent(inout) :: network
      type(cut_scale_t), intent(in) :: scale
      type(cut_remarks_t), intent(inout) :: remarks
      type(cell_grid_t) :: grid
      real(wp), allocatable :: place(:, :)
      integer, allocatable :: number(:), blocker(:), line_of(:)
      integer :: k, a, cell, node

      call living_edges(network, number, place)
      call new_cell_grid(place, scale%clearance, grid)
      allocate (line_of(size(network%node, 2)), blocker(size(number)), source=0)
      do k = size(number), 1, -1
         line_of(network%edge(:, number(k))) = network%line(number(k))
      end do
      do node = 1, size(line_of)
         if (line_of(node) == 0) cycle
         cell = cell_of(grid, network%node(:, node))
         do a = grid%first(cell), grid%first(cell + 1) - 1
            k = grid%item(a)
            if (network%line(number(k)) <= network%n_boundary .or. blocker(k) > 0) cycle
            if (any(network%edge(:, number(k)) == node)) cycle
            if (segment_distance(network%node(:, node), place(:, k)) < scale%clearance) &
               & blocker(k) = line_of(node)
         end do
      end do
      do k = 1, size(number)
         if (blocker(k) > 0) &
            & call drop_edge(network, number(k), cut_reason%too_close, blocker(k), remarks)
      end do
   end subroutine drop_close_edges

   !> Edges that were not dropped
   pure subroutine living_edges(network, number, place)
      type(network_t), intent(in) :: network
      integer, allocatable, intent(out) :: number(:)
      real(wp), allocatable, intent(out) :: place(:, :)
      integer :: e, n

      allocate (number(count(network%alive)))
      n = 0
      do e = 1, size(network%line)
         if (.not. network%alive(e)) cycle
         n = n + 1
         number(n) = e
      end do
      allocate (place(4, n))
      do e = 1, n
         place(:, e) = edge_place(network, number(e))
      end do
   end subroutine living_edges

   !> Cut lines into blocks, and give each block its material and its points
   pure subroutine cut_blocks(model, cut, error)
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(out) :: cut
      !> What keeps the lines from making blocks
      type(error_t), allocatable, intent(out) :: error
      type(network_t) :: network
      type(loops_t) :: loops

      call make_network(model, cut, network, error)
      if (allocated(error)) return
      call trace_loops(network, loops)
      call blocks_of_loops(network, loops, model%line%material(:model%line%n), cut)
      cut%n_merged = network%n_merged
      if (size(cut%area) == 0) call fatal_error(error, "expected lines that enclose a block, got " &
         & //to_text(model%line%n)//" that enclose none; join their ends", model%file, 1)
      if (.not. allocated(error)) call check_areas(loops, cut, model%file, error)
      if (.not. allocated(error)) call check_nesting(model, network, loops, cut, error)
      if (.not. allocated(error)) call remove_holes(model, cut, error)
      if (.not. allocated(error)) call give_materials(model, cut, error)
      if (.not. allocated(error)) call place_points(model, cut, error)
      if (.not. allocated(error)) call place_bolts(model, cut)
   end subroutine cut_blocks

   !> Nodes and edges that bound blocks (Shi: dc04 to dc06)
   pure subroutine make_network(model, cut, network, error)
      type(line_model_t), intent(in) :: model
      !> Receives the scales and what was dropped
      type(cut_model_t), intent(inout) :: cut
      type(network_t), intent(out) :: network
      type(error_t), allocatable, intent(out) :: error
      type(crossings_t) :: crossings
      real(wp), allocatable :: line(:, :)
      integer :: i, crossing(2)

      if (model%line%n > 0) cut%scale = cut_scale(model)
      if (.not. cut%scale%size > 0.0_wp) then
         call fatal_error(error, "expected at least one line with a length, got none; add it", &
            & model%file, 1)
         return
      end if
      allocate (line, source=model%line%place(:, :model%line%n))
      do i = 1, 4
         line(i, :) = line(i, :) - cut%scale%origin(2 - mod(i, 2))
      end do
      call find_crossings(line, cut%scale%reach, crossings, error)
      if (allocated(error)) then
         error%file = model%file
         return
      end if
      call join_crossings(line, model%n_boundary, cut%scale, crossings, network, cut%remarks)
      call cut_trees(network, cut%remarks)
      call drop_crossing_edges(network, cut%scale, cut%remarks, crossing)
      if (all(crossing > 0)) then
         call fatal_error(error, "expected boundary lines that do not cross between their nodes, " &
            & //"got lines "//to_text(crossing(1))//" and "//to_text(crossing(2)) &
            & //", which do; make the edge-node distance smaller", model%file, &
            & model%line%row(crossing(2)))
         return
      end if
      call drop_close_edges(network, cut%scale, cut%remarks)
      call cut_trees(network, cut%remarks)
   end subroutine make_network

   !> Areas of blocks add up to those that the outer loops enclose (Shi: dc16, dc17)
   pure subroutine check_areas(loops, cut, file, error)
      !> All loops
      type(loops_t), intent(in) :: loops
      type(cut_model_t), intent(in) :: cut
      !> Name of the geometry file
      character(len=*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: enclosed, room

      enclosed = -sum(loops%area, loops%area < 0.0_wp)
      room = 1.0e-9_wp*enclosed + 10.0_wp*cut%scale%reach*cut%scale%size
      if (abs(sum(cut%area) - enclosed) <= room) return
      call fatal_error(error, "expected block areas that add up to the enclosed area " &
         & //to_text(enclosed)//", got "//to_text(sum(cut%area)) &
         & //": lines cross without a node; make the edge-node distance smaller", file, 1)
   end subroutine check_areas

   !> No group of blocks may lie inside a block of another group, unless that block is taken out: a
   !> block is one polygon, without holes
   pure subroutine check_nesting(model, network, loops, cut, error)
      type(line_model_t), intent(in) :: model
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(boxes_t) :: boxes
      logical, allocatable :: hole(:)
      real(wp) :: node(2)
      integer :: i, k, b

      if (count(loops%area < 0.0_wp) < 2) return
      boxes = block_boxes(cut)
      allocate (hole(size(cut%area)), source=.false.)
      do i = 1, model%hole%n
         b = block_around(cut, boxes, model%hole%place(1:2, i) - cut%scale%origin)
         if (b > 0) hole(b) = .true.
      end do
      do k = 1, size(loops%area)
         if (.not. loops%area(k) < 0.0_wp) cycle
         node = network%node(:, half_edge_start(network, loops%half_edge(loops%first(k))))
         do b = 1, size(cut%area)
            if (hole(b) .or. any(node <= boxes%low(:, b) .or. node >= boxes%high(:, b))) cycle
            associate (vertex => cut%vertex(:, cut%first_vertex(b):cut%first_vertex(b + 1) - 1))
               if (any(abs(vertex(1, :) - node(1)) <= 0.0_wp &
                  & .and. abs(vertex(2, :) - node(2)) <= 0.0_wp)) cycle
               if (.not. contains_point(vertex, node)) cycle
            end associate
            call tell_nested(model, network, loops, k, cut, b, error)
            return
         end do
      end do
   end subroutine check_nesting

   !> Say which block holds what
   pure subroutine tell_nested(model, network, loops, inner, cut, block, error)
      type(line_model_t), intent(in) :: model
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      !> Number of the loop around the inner group
      integer, intent(in) :: inner
      type(cut_model_t), intent(in) :: cut
      !> Number of the outer block
      integer, intent(in) :: block
      type(error_t), allocatable, intent(out) :: error
      integer :: h, line

      h = loops%half_edge(loops%first(inner))
      line = network%line((h + 1)/2)
      call fatal_error(error, "expected blocks without holes, got line "//to_text(line) &
         & //" of blocks that lie wholly inside block "//to_text(block) &
         & //", whose corner 1 "// &
         & "is at ("//to_text(cut%vertex(1, cut%first_vertex(block)) + cut%scale%origin(1))//", " &
         & //to_text(cut%vertex(2, cut%first_vertex(block)) + cut%scale%origin(2)) &
         & //"); join the two by a line or put a hole point into the outer block", &
         & model%file, model%line%row(line))
   end subroutine tell_nested

end module dda_cutting
