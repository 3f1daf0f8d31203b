!> Edges that bound nothing or stand in the way are taken out of a network (Shi: dc05, dc06)
submodule (dda_cutting) dda_network_trim
   use dda_box_tree, only : box_tree_t, find_boxes, segment_tree
   use dda_cut_model, only : cut_reason
   use dda_line_network, only : drop_edge, edge_place
   use dda_segment, only : crossing_parameters, segment_distance
   use dda_sort, only : sort_numbers
   implicit none

contains

   !> Drop edges that end in nothing, until none is left
   module procedure cut_trees
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
   end procedure cut_trees

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

   !> Drop one of two edges that cross between their nodes, as happens when nodes were merged
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

   !> Whether two edges cross between their nodes
   pure logical function edges_cross(network, reach, edge, first, second)
      type(network_t), intent(in) :: network
      real(wp), intent(in) :: reach      !! Distance within which things touch [m]
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

   !> Drop joints that pass a node of other lines closer than e00 w0 (Shi
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

   !> Edges that were not dropped
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

end submodule dda_network_trim
