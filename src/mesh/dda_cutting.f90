!> Lines to blocks (Shi: dc)
!>
!> Edges that bound no block or that conflict are removed from the network first (Shi: dc05, dc06).
module dda_cutting
   use dda_cut_model, only : bond_joint, cut_model_t, cut_remarks_t, cut_scale, cut_scale_t
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_model, only : entity_role, line_model_t
   use dda_line_network, only : crossings_t, find_crossings, half_edge_start, join_crossings, &
      & network_t
   use dda_polygon, only : contains_point
   use dda_sort, only : sorted_order
   use dda_text, only : place_text, short_text, to_text
   use dda_vector, only : cross
   implicit none
   private

   public :: check_areas, cut_blocks, cut_trees, drop_close_edges, drop_crossing_edges, loops_t

   !> Bounding boxes of blocks
   type :: boxes_t
      real(wp), allocatable :: low(:, :)   !! Lower left corners: (2, n) [m]
      real(wp), allocatable :: high(:, :)  !! Upper right corners: (2, n) [m]
   end type boxes_t

   !> Loops of half-edges. Edge e has the half-edges 2e - 1, from its first node to its second, and
   !> 2e in the opposite direction; each has its loop on its left
   type :: loops_t
      !> First item of each loop, and one past the last: (n_loop + 1)
      integer, allocatable :: first(:)
      integer, allocatable :: half_edge(:)  !! Half-edges, loop by loop
      !> Area of each loop, negative for outer loops: (n_loop) [m2]
      real(wp), allocatable :: area(:)
   end type loops_t

   interface

      !> Bounding boxes of all blocks
      pure type(boxes_t) module function block_boxes(cut)
         type(cut_model_t), intent(in) :: cut
      end function block_boxes

      !> The block that contains a point; else the nearest one within the distance that nodes may
      !> have moved, or 0
      pure integer module function block_around(cut, boxes, point)
         type(cut_model_t), intent(in) :: cut
         type(boxes_t), intent(in) :: boxes
         real(wp), intent(in) :: point(2)  !! The point relative to the origin of the cut: (2) [m]
      end function block_around

      !> Remove the blocks that contain hole points (Shi: dc11)
      pure module subroutine remove_holes(model, cut, error)
         type(line_model_t), intent(in) :: model
         type(cut_model_t), intent(inout) :: cut           !! The blocks; some may be removed
         type(error_t), allocatable, intent(out) :: error  !! Allocated for a point in no block
      end subroutine remove_holes

      !> Assign points and fixed lines to blocks. A fixed line holds the block at each edge that it
      !> crosses, or else the block of its first end (Shi: dc10, dc11)
      pure module subroutine place_points(model, cut, error)
         type(line_model_t), intent(in) :: model
         type(cut_model_t), intent(inout) :: cut
         type(error_t), allocatable, intent(out) :: error
      end subroutine place_points

      !> Find the blocks of the bolts (Shi: dc14); an end outside all blocks is fixed to the ground
      pure module subroutine place_bolts(model, cut)
         type(line_model_t), intent(in) :: model
         type(cut_model_t), intent(inout) :: cut
      end subroutine place_bolts

      !> Assign materials to blocks: from the last material line that crosses one of their edges, or
      !> that starts inside and crosses none; otherwise the first material (Shi: dc13)
      pure module subroutine assign_materials(model, cut, error)
         type(line_model_t), intent(in) :: model
         type(cut_model_t), intent(inout) :: cut
         type(error_t), allocatable, intent(out) :: error  !! Allocated for a line in no block
      end subroutine assign_materials

      !> Drop edges with a free end until there are none (Shi: dc05)
      pure module subroutine cut_trees(network, remarks)
         type(network_t), intent(inout) :: network
         type(cut_remarks_t), intent(inout) :: remarks
      end subroutine cut_trees

      !> Drop one of two edges that cross between their nodes, which happens after nodes are merged.
      !> Boundaries are kept, else the edge of the earlier line (Shi: dc06)
      pure module subroutine drop_crossing_edges(network, scale, remarks, crossing)
         type(network_t), intent(inout) :: network
         type(cut_scale_t), intent(in) :: scale  !! Scales of the cut
         type(cut_remarks_t), intent(inout) :: remarks
         !> Two boundary lines that still cross; 0 if there are none: (2)
         integer, intent(out) :: crossing(2)
      end subroutine drop_crossing_edges

      !> Drop joints closer than e00 w0 to a node of other lines (Shi: dc06)
      pure module subroutine drop_close_edges(network, scale, remarks)
         type(network_t), intent(inout) :: network
         type(cut_scale_t), intent(in) :: scale
         type(cut_remarks_t), intent(inout) :: remarks
      end subroutine drop_close_edges

      !> Cut blocks with islands into pieces without holes: adds nodes and edges. The new edges have
      !> the line number n_line + 1
      pure module subroutine cut_islands(model, origin, loops, network)
         type(line_model_t), intent(in) :: model
         real(wp), intent(in) :: origin(2)  !! Origin of the nodes: (2) [m]
         type(loops_t), intent(in) :: loops
         type(network_t), intent(inout) :: network
      end subroutine cut_islands

      !> Number the whole blocks: pieces connected by bonds are one block
      pure module subroutine find_wholes(cut)
         type(cut_model_t), intent(inout) :: cut
      end subroutine find_wholes

      !> Make blocks from the loops with positive area; scales, points and materials are set
      !> elsewhere
      pure module subroutine blocks_of_loops(network, loops, joint, cut)
         type(network_t), intent(in) :: network
         type(loops_t), intent(in) :: loops
         integer, intent(in) :: joint(:)  !! Joint material of each line: (n_line)
         !> Receives corners, edges and pairs of edges; its scales must be set
         type(cut_model_t), intent(inout) :: cut
      end subroutine blocks_of_loops

   end interface

contains

   !> Cut lines into blocks, and assign materials and points
   pure subroutine cut_blocks(model, cut, error)
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(out) :: cut
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the lines make no blocks
      type(network_t) :: network
      type(loops_t) :: loops
      integer :: n_edge

      call make_network(model, cut, network, error)
      if (allocated(error)) return
      call trace_loops(network, loops)
      n_edge = size(network%line)
      call cut_islands(model, cut%scale%origin, loops, network)
      if (size(network%line) > n_edge) call trace_loops(network, loops)
      call blocks_of_loops(network, loops, [model%line%material(:model%line%n), bond_joint], cut)
      cut%n_merged = network%n_merged
      if (size(cut%area) == 0) call fatal_error(error, "expected lines that enclose a block, got " &
         & //to_text(model%line%n)//" that enclose none; join their ends", model%file, 1)
      if (.not. allocated(error)) call check_areas(loops, cut, model%file, error)
      if (.not. allocated(error)) call remove_holes(model, cut, error)
      if (.not. allocated(error)) call find_wholes(cut)
      if (.not. allocated(error)) call assign_materials(model, cut, error)
      if (.not. allocated(error)) call place_points(model, cut, error)
      if (.not. allocated(error)) call place_bolts(model, cut)
   end subroutine cut_blocks

   !> Make the nodes and edges that bound blocks (Shi: dc04 to dc06)
   pure subroutine make_network(model, cut, network, error)
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(inout) :: cut  !! Receives the scales and the dropped parts
      type(network_t), intent(out) :: network
      type(error_t), allocatable, intent(out) :: error
      type(crossings_t) :: crossings
      real(wp), allocatable :: line(:, :)
      integer :: i, crossing(2)

      if (model%line%n > 0) cut%scale = cut_scale(model)
      if (.not. cut%scale%size > 0.0_wp) call fatal_error(error, &
         & "expected at least one line with a length, got none; add it", model%file, 1)
      if (allocated(error)) return
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
      if (all(crossing > 0)) call fatal_error(error, &
         & "expected boundary lines that do not cross between their nodes, got lines " &
         & //to_text(crossing(1))//" and "//to_text(crossing(2)) &
         & //", which do; make the edge-node distance smaller", model%file, &
         & model%line%row(crossing(2)))
      if (allocated(error)) return
      call drop_close_edges(network, cut%scale, cut%remarks)
      call cut_trees(network, cut%remarks)
   end subroutine make_network

   !> Check that the areas of the blocks add up to those inside the outer loops (Shi: dc16, dc17)
   pure subroutine check_areas(loops, cut, file, error)
      type(loops_t), intent(in) :: loops    !! All loops
      type(cut_model_t), intent(in) :: cut
      character(len=*), intent(in) :: file  !! Name of the geometry file
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: enclosed, room

      enclosed = -sum(loops%area, loops%area < 0.0_wp)
      room = 1.0e-9_wp*enclosed + 10.0_wp*cut%scale%reach*cut%scale%size
      if (abs(sum(cut%area) - enclosed) <= room) return
      call fatal_error(error, "expected block areas that add up to the enclosed area " &
         & //short_text(enclosed)//", got "//short_text(sum(cut%area)) &
         & //": lines cross without a node; make the edge-node distance smaller", file, 1)
   end subroutine check_areas

   !> Trace loops along both sides of all edges, with the leftmost turn at each node
   pure subroutine trace_loops(network, loops)
      type(network_t), intent(in) :: network
      type(loops_t), intent(out) :: loops
      integer, allocatable :: next(:)
      logical, allocatable :: seen(:)
      integer :: h, at, n_loop, n_item

      call link_half_edges(network, next)
      allocate (seen(size(next)), source=next == 0)
      allocate (loops%first(count(.not. seen) + 1), loops%half_edge(count(.not. seen)))
      n_loop = 0
      n_item = 0
      do h = 1, size(next)
         if (seen(h)) cycle
         n_loop = n_loop + 1
         loops%first(n_loop) = n_item + 1
         at = h
         do while (.not. seen(at))
            seen(at) = .true.
            n_item = n_item + 1
            loops%half_edge(n_item) = at
            at = next(at)
         end do
      end do
      loops%first = [loops%first(:n_loop), n_item + 1]
      allocate (loops%area(n_loop))
      do h = 1, n_loop
         loops%area(h) = loop_area(network, loops%half_edge(loops%first(h):loops%first(h + 1) - 1))
      end do
   end subroutine trace_loops

   !> The other half-edge of the same edge
   elemental integer function opposite(half_edge)
      integer, intent(in) :: half_edge  !! Its number

      opposite = half_edge - 1 + 2*mod(half_edge, 2)
   end function opposite

   !> The next half-edge in each loop: at the end node, the first one clockwise from the reverse
   !> direction (Shi: dc07)
   pure subroutine link_half_edges(network, next)
      type(network_t), intent(in) :: network
      !> Number of the next half-edge; 0 for dropped ones: (2 n_edge)
      integer, allocatable, intent(out) :: next(:)
      integer, allocatable :: number(:), start(:), order(:)
      real(wp), allocatable :: angle(:)
      real(wp) :: arm(2)
      integer :: h, k, n, first, before

      allocate (next(2*size(network%line)), source=0)
      n = 2*count(network%alive)
      allocate (number(n), start(n), angle(n))
      n = 0
      do h = 1, size(next)
         if (.not. network%alive((h + 1)/2)) cycle
         n = n + 1
         number(n) = h
         start(n) = half_edge_start(network, h)
         arm = network%node(:, half_edge_start(network, opposite(h))) - network%node(:, start(n))
         angle(n) = atan2(arm(2), arm(1))
      end do
      allocate (order, source=sorted_order(start, angle))
      first = 1
      do k = 1, n
         if (start(order(k)) /= start(order(first))) first = k
         before = k - 1
         if (k == first) then
            before = k
            do while (before < n)
               if (start(order(before + 1)) /= start(order(k))) exit
               before = before + 1
            end do
         end if
         next(opposite(number(order(k)))) = number(order(before))
      end do
   end subroutine link_half_edges

   !> Area inside a loop, by triangles from its first node
   pure real(wp) function loop_area(network, half_edge)
      type(network_t), intent(in) :: network
      integer, intent(in) :: half_edge(:)  !! The half-edges of the loop: (n)
      real(wp) :: start(2), a(2), b(2)
      integer :: k

      loop_area = 0.0_wp
      start = network%node(:, half_edge_start(network, half_edge(1)))
      b = 0.0_wp
      do k = 2, size(half_edge)
         a = b
         b = network%node(:, half_edge_start(network, half_edge(k))) - start
         loop_area = loop_area + cross(a, b)/2.0_wp
      end do
   end function loop_area
end module dda_cutting
