!> Removal of edges that bound no block or that conflict (Shi: dc05, dc06). Blocks from loops: nodes
!> on straight edges are no corners, coincident edges are paired (Shi: dc08, dc09)
submodule (dda_cutting) dda_network_trim
   use dda_box_tree, only : box_tree_t, find_boxes, segment_tree
   use dda_cut_model, only : add_remark, cut_reason, edge_pair_t
   use dda_line_network, only : drop_edge, edge_place
   use dda_segment, only : crossing_parameters, segment_distance
   use dda_sort, only : list_by_owner, sort_numbers
   implicit none

contains

   !> Drop edges with a free end until there are none (Shi: dc05)
   module procedure cut_trees
      integer, allocatable :: first(:), item(:), degree(:), loose(:)
      integer :: n, node, k, e

      allocate (first(size(network%node, 2) + 1))
      call list_by_owner(reshape(merge(network%edge, 0, spread(network%alive, 1, 2)), &
         & [size(network%edge)]), first, item)
      allocate (degree, source=first(2:) - first(:size(first) - 1))
      loose = pack([(node, node=1, size(degree))], degree == 1)
      n = size(loose)
      do while (n > 0)
         node = loose(n)
         n = n - 1
         do k = first(node), first(node + 1) - 1
            e = (item(k) + 1)/2
            if (.not. network%alive(e)) cycle
            call drop_edge(network, e, cut_reason%loose_edge, 0, remarks)
            degree(network%edge(:, e)) = degree(network%edge(:, e)) - 1
            ! each loose node adds at most one other, so the list never grows
            node = sum(network%edge(:, e)) - node
            if (degree(node) == 1) then
               n = n + 1
               loose(n) = node
            end if
            exit
         end do
      end do
   end procedure cut_trees

   !> Drop one of two edges that cross between their nodes, which happens after nodes are merged
   module procedure drop_crossing_edges
      type(box_tree_t) :: tree
      real(wp), allocatable :: place(:, :)
      integer, allocatable :: number(:), near(:)
      integer :: edge(2), i, k, n

      crossing = 0
      call living_edges(network, number, place)
      call segment_tree(place, tree)
      do i = 1, size(number)
         call find_boxes(tree, min(place(1:2, i), place(3:4, i)), &
            & max(place(1:2, i), place(3:4, i)), near, n, above=i)
         call sort_numbers(near(:n))
         do k = 1, n
            edge = number([i, near(k)])
            if (.not. all(network%alive(edge))) cycle
            if (.not. edges_cross(network, scale%reach, edge, place(:, i), place(:, near(k)))) cycle
            if (network%line(edge(2)) < network%line(edge(1))) edge = edge([2, 1])
            if (network%line(edge(2)) <= network%n_boundary) then
               crossing = network%line(edge)
            else
               call drop_edge(network, edge(2), cut_reason%crossing, network%line(edge(1)), remarks)
            end if
         end do
      end do
   end procedure drop_crossing_edges

   !> True if two edges cross between their nodes
   pure logical function edges_cross(network, reach, edge, first, second)
      type(network_t), intent(in) :: network
      real(wp), intent(in) :: reach      !! Distance within which points coincide [m]
      integer, intent(in) :: edge(2)     !! Numbers of the edges: (2)
      real(wp), intent(in) :: first(4)   !! Ends of the first: (4) [m]
      real(wp), intent(in) :: second(4)  !! Ends of the second: (4) [m]
      real(wp) :: share(2), rim(2)

      edges_cross = .false.
      if (any(network%edge(:, edge(1)) == network%edge(1, edge(2)))) return
      if (any(network%edge(:, edge(1)) == network%edge(2, edge(2)))) return
      call crossing_parameters(first, second, share, edges_cross)
      rim = reach/[norm2(first(3:4) - first(1:2)), norm2(second(3:4) - second(1:2))]
      edges_cross = edges_cross .and. all(share > rim .and. share < 1.0_wp - rim)
   end function edges_cross

   !> Drop joints closer than e00 w0 to a node of other lines (Shi: dc06)
   module procedure drop_close_edges
      type(box_tree_t) :: tree
      real(wp), allocatable :: place(:, :)
      real(wp) :: point(2)
      integer, allocatable :: number(:), blocker(:), line_of(:), near(:)
      integer :: i, k, n, node

      call living_edges(network, number, place)
      call segment_tree(place, tree)
      allocate (line_of(size(network%node, 2)), blocker(size(number)), source=0)
      do k = size(number), 1, -1
         line_of(network%edge(:, number(k))) = network%line(number(k))
      end do
      do node = 1, size(line_of)
         if (line_of(node) == 0) cycle
         point = network%node(:, node)
         call find_boxes(tree, point - scale%clearance, point + scale%clearance, near, n)
         do i = 1, n
            k = near(i)
            if (network%line(number(k)) <= network%n_boundary .or. blocker(k) > 0) cycle
            if (any(network%edge(:, number(k)) == node)) cycle
            if (segment_distance(point, place(:, k)) < scale%clearance) blocker(k) = line_of(node)
         end do
      end do
      do k = 1, size(number)
         if (blocker(k) > 0) &
            & call drop_edge(network, number(k), cut_reason%too_close, blocker(k), remarks)
      end do
   end procedure drop_close_edges

   !> List the edges that were not dropped
   pure subroutine living_edges(network, number, place)
      type(network_t), intent(in) :: network
      integer, allocatable, intent(out) :: number(:)     !! Their numbers: (n)
      real(wp), allocatable, intent(out) :: place(:, :)  !! Their ends: (4, n) [m]
      integer :: e

      number = pack([(e, e=1, size(network%line))], network%alive)
      allocate (place(4, size(number)))
      do e = 1, size(number)
         place(:, e) = edge_place(network, number(e))
      end do
   end subroutine living_edges

   !> Make blocks from the loops with positive area
   module procedure blocks_of_loops
      ! block and edge of each half-edge
      integer, allocatable :: owner(:, :), corner(:)
      real(wp) :: place(4)
      integer :: k, n_block, n_vertex, from, to, line

      allocate (owner(2, 2*size(network%line)), source=0)
      allocate (cut%first_vertex(size(loops%area) + 1), cut%area(size(loops%area)))
      allocate (cut%vertex(2, size(loops%half_edge)), cut%edge_joint(size(loops%half_edge)))
      n_block = 0
      n_vertex = 0
      cut%first_vertex(1) = 1
      do k = 1, size(loops%area)
         from = loops%first(k)
         to = loops%first(k + 1) - 1
         call corners_of_loop(network, loops%half_edge(from:to), cut%scale%reach, corner)
         if (size(corner) < 3 .and. loops%area(k) > 0.0_wp) then
            line = network%line((loops%half_edge(from) + 1)/2)
            place = edge_place(network, (loops%half_edge(from) + 1)/2)
            call add_remark(cut%remarks, line, cut_reason%flat, 0, place)
         end if
         if (size(corner) < 3 .or. .not. loops%area(k) > 0.0_wp) cycle
         n_block = n_block + 1
         cut%area(n_block) = loops%area(k)
         call add_corners(network, loops%half_edge(from:to), corner, joint, n_block, n_vertex, &
            & cut, owner)
         cut%first_vertex(n_block + 1) = n_vertex + 1
      end do
      cut%first_vertex = cut%first_vertex(:n_block + 1)
      cut%area = cut%area(:n_block)
      cut%vertex = cut%vertex(:, :n_vertex)
      cut%edge_joint = cut%edge_joint(:n_vertex)
      call find_pairs(network, owner, joint, cut)
   end procedure blocks_of_loops

   !> Corners of a loop. A node is no corner if it lies on the straight line from the previous
   !> corner to the next node (Shi: dc09)
   pure subroutine corners_of_loop(network, half_edge, reach, corner)
      type(network_t), intent(in) :: network
      integer, intent(in) :: half_edge(:)  !! The half-edges of the loop: (n)
      real(wp), intent(in) :: reach        !! Distance within which points coincide [m]
      !> Half-edges of the loop that start at a corner: (n_corner)
      integer, allocatable, intent(out) :: corner(:)
      real(wp), allocatable :: node(:, :)
      logical, allocatable :: turns(:)
      integer :: k, n, last

      n = size(half_edge)
      allocate (node(2, n), turns(n))
      do k = 1, n
         node(:, k) = network%node(:, half_edge_start(network, half_edge(k)))
      end do
      turns = .true.
      last = n
      do k = 1, n
         turns(k) = .not. is_between(node(:, k), node(:, last), node(:, 1 + mod(k, n)), reach)
         if (turns(k)) last = k
      end do
      ! the first corners were tested against a node that may be no corner itself
      do k = 1, merge(n, 0, any(turns))
         if (turns(k)) then
            turns(k) = .not. is_between(node(:, k), node(:, last), node(:, next_turn(turns, k)), &
               & reach)
            if (turns(k)) exit
         end if
      end do
      corner = pack([(k, k=1, n)], turns)
   end subroutine corners_of_loop

   !> The next corner after a position in a loop
   pure integer function next_turn(turns, k)
      logical, intent(in) :: turns(:)  !! True at corners: (n)
      integer, intent(in) :: k         !! The position
      integer :: i

      next_turn = k
      do i = 1, size(turns)
         next_turn = 1 + mod(next_turn, size(turns))
         if (turns(next_turn)) return
      end do
   end function next_turn

   !> True if a point lies on the segment between two others
   pure logical function is_between(point, start, finish, reach)
      real(wp), intent(in) :: point(2)   !! The point: (2) [m]
      real(wp), intent(in) :: start(2)   !! Start of the segment: (2) [m]
      real(wp), intent(in) :: finish(2)  !! End of the segment: (2) [m]
      real(wp), intent(in) :: reach
      real(wp) :: way(2), arm(2)

      way = finish - start
      arm = point - start
      is_between = abs(cross(way, arm)) <= reach*norm2(way) .and. dot_product(way, arm) >= 0.0_wp &
         & .and. dot_product(way, finish - point) >= 0.0_wp
   end function is_between

   !> Store the corners of a block, and block and edge for each of its half-edges
   pure subroutine add_corners(network, half_edge, corner, joint, block, n_vertex, cut, owner)
      type(network_t), intent(in) :: network
      integer, intent(in) :: half_edge(:), corner(:), joint(:)
      integer, intent(in) :: block        !! Number of the block
      integer, intent(inout) :: n_vertex  !! Number of vertices so far
      type(cut_model_t), intent(inout) :: cut
      !> Receives block and edge of each half-edge: (2, n_half_edge)
      integer, intent(inout) :: owner(:, :)
      integer :: c, k, n, finish

      n = size(half_edge)
      do c = 1, size(corner)
         n_vertex = n_vertex + 1
         associate (h => half_edge(corner(c)))
            cut%vertex(:, n_vertex) = network%node(:, half_edge_start(network, h))
            cut%edge_joint(n_vertex) = joint(network%line((h + 1)/2))
         end associate
         finish = corner(1) + n
         if (c < size(corner)) finish = corner(c + 1)
         do k = corner(c), finish - 1
            owner(:, half_edge(1 + mod(k - 1, n))) = [block, c]
         end do
      end do
   end subroutine add_corners

   !> Find pairs of block edges with common network edges
   pure subroutine find_pairs(network, owner, joint, cut)
      type(network_t), intent(in) :: network
      !> Block and edge of each half-edge, 0 for none: (2, n_half_edge)
      integer, intent(in) :: owner(:, :)
      integer, intent(in) :: joint(:)
      type(cut_model_t), intent(inout) :: cut
      type(edge_pair_t), allocatable :: part(:)
      integer, allocatable :: order(:)
      integer :: e, k, n, n_pair

      allocate (part(size(network%line)))
      n = 0
      do e = 1, size(network%line)
         if (.not. network%alive(e)) cycle
         if (owner(1, 2*e - 1) == 0 .or. owner(1, 2*e) == 0) cycle
         if (owner(1, 2*e - 1) == owner(1, 2*e)) cycle
         n = n + 1
         part(n)%joint = joint(network%line(e))
         part(n)%place = edge_place(network, e)
         part(n)%side = [owner(:, 2*e - 1), owner(:, 2*e)]
      end do
      part = part(:n)
      ! vertex numbers identify the edges of all blocks
      allocate (order, source=sorted_order(cut%first_vertex(part%side(1)) + part%side(2), &
         & real(cut%first_vertex(part%side(3)) + part%side(4), wp)))
      n_pair = 0
      allocate (cut%pair(n))
      do k = 1, n
         associate (this => part(order(k)))
            if (n_pair > 0) then
               if (all(cut%pair(n_pair)%side == this%side) &
                  & .and. cut%pair(n_pair)%joint == this%joint) then
                  call join_parts(cut%pair(n_pair), this%place)
                  cycle
               end if
            end if
            n_pair = n_pair + 1
            cut%pair(n_pair) = this
         end associate
      end do
      cut%pair = cut%pair(:n_pair)
   end subroutine find_pairs

   !> Extend a pair of edges by one part
   pure subroutine join_parts(pair, place)
      type(edge_pair_t), intent(inout) :: pair
      real(wp), intent(in) :: place(4)  !! Ends of the part, in the same direction: (4) [m]
      real(wp) :: way(2)

      way = pair%place(3:4) - pair%place(1:2)
      if (dot_product(way, place(1:2) - pair%place(1:2)) < 0.0_wp) pair%place(1:2) = place(1:2)
      if (dot_product(way, place(3:4) - pair%place(3:4)) > 0.0_wp) pair%place(3:4) = place(3:4)
   end subroutine join_parts

end submodule dda_network_trim
