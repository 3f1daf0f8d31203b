!> Islands: blocks inside another block. The outer block is cut along vertical lines through its
!> islands into pieces without holes, connected by bonds
submodule (dda_cutting) dda_islands
   use dda_cut_model, only : bond_joint
   implicit none

   !> Crossings of edges with vertical lines through islands
   type :: crossed_t
      integer :: n = 0                 !! Number of crossings
      integer, allocatable :: edge(:)  !! Crossed edge: (n)
      integer, allocatable :: node(:)  !! New node at the crossing: (n)
   end type crossed_t

contains

   !> Cut blocks with islands into pieces
   module procedure cut_islands
      integer, allocatable :: around(:), island(:), number(:)
      integer, allocatable :: bond(:, :)
      type(crossed_t) :: crossed
      integer :: k, i, before

      if (count(loops%area < 0.0_wp) < 2) return
      call find_islands(model, origin, network, loops, around)
      if (all(around == 0)) return
      allocate (bond(2, 0), crossed%edge(0), crossed%node(0))
      number = [(k, k=1, size(around))]
      do k = 1, size(around)
         if (.not. any(around == k)) cycle
         island = pack(number, around == k)
         before = crossed%n
         do i = 1, size(island)
            if (is_crossed(crossed, before, edges_of(loops, island(i:i)))) cycle
            call cut_through(edges_of(loops, [k, island]), edges_of(loops, island(i:i)), network, &
               & crossed, bond)
         end do
      end do
      call insert_nodes(crossed, network)
      call add_bonds(bond, model%line%n + 1, network)
   end procedure cut_islands

   !> The loop that directly surrounds each island loop; 0 for all other loops, and for islands of
   !> blocks that a hole point removes
   pure subroutine find_islands(model, origin, network, loops, around)
      type(line_model_t), intent(in) :: model
      real(wp), intent(in) :: origin(2)  !! Origin of the nodes: (2) [m]
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      integer, allocatable, intent(out) :: around(:)  !! Number of the outer loop: (n_loop)
      type(boxes_t) :: boxes
      integer :: k, i, node, hole

      call loop_boxes(network, loops, boxes)
      allocate (around(size(loops%area)), source=0)
      do k = 1, size(around)
         if (.not. loops%area(k) < 0.0_wp) cycle
         node = half_edge_start(network, loops%half_edge(loops%first(k)))
         around(k) = smallest_around(network, loops, boxes, network%node(:, node), node)
      end do
      do i = 1, model%of(entity_role%hole)%n
         hole = smallest_around(network, loops, boxes, &
            & model%of(entity_role%hole)%place(1:2, i) - origin, 0)
         if (hole > 0) where (around == hole) around = 0
      end do
   end subroutine find_islands

   !> Bounding boxes of loops
   pure subroutine loop_boxes(network, loops, boxes)
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      type(boxes_t), intent(out) :: boxes
      real(wp), allocatable :: vertex(:, :)
      integer :: k

      allocate (boxes%low(2, size(loops%area)), boxes%high(2, size(loops%area)))
      do k = 1, size(loops%area)
         vertex = loop_vertices(network, loops, k)
         boxes%low(:, k) = minval(vertex, dim=2)
         boxes%high(:, k) = maxval(vertex, dim=2)
      end do
   end subroutine loop_boxes

   !> Coordinates of the nodes of a loop
   pure function loop_vertices(network, loops, k) result(vertex)
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: k               !! Number of the loop
      real(wp), allocatable :: vertex(:, :)  !! Coordinates: (2, n) [m]
      integer :: i

      allocate (vertex(2, loops%first(k + 1) - loops%first(k)))
      do i = 1, size(vertex, 2)
         vertex(:, i) = network%node(:, half_edge_start(network, &
            & loops%half_edge(loops%first(k) + i - 1)))
      end do
   end function loop_vertices

   !> Smallest loop that contains a point and does not pass through a node; 0 if there is none
   pure integer function smallest_around(network, loops, boxes, point, node)
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      type(boxes_t), intent(in) :: boxes  !! Bounding boxes of the loops
      real(wp), intent(in) :: point(2)    !! The point: (2) [m]
      integer, intent(in) :: node         !! Number of the node, or 0
      integer :: j, i

      smallest_around = 0
      do j = 1, size(loops%area)
         if (.not. loops%area(j) > 0.0_wp) cycle
         if (any(point <= boxes%low(:, j) .or. point >= boxes%high(:, j))) cycle
         if (smallest_around > 0) then
            if (loops%area(j) >= loops%area(smallest_around)) cycle
         end if
         if (any([(half_edge_start(network, loops%half_edge(i)) == node, &
            & i=loops%first(j), loops%first(j + 1) - 1)])) cycle
         if (contains_point(loop_vertices(network, loops, j), point)) smallest_around = j
      end do
   end function smallest_around

   !> True if a line added since then crosses one of the edges
   pure logical function is_crossed(crossed, before, edge)
      type(crossed_t), intent(in) :: crossed
      integer, intent(in) :: before   !! Number of crossings before that line
      integer, intent(in) :: edge(:)  !! Numbers of the edges: (n)
      integer :: i

      is_crossed = any([(any(edge == crossed%edge(i)), i=before + 1, crossed%n)])
   end function is_crossed

   !> Cut a block along a vertical line through one of its islands, as far from nodes as possible
   pure subroutine cut_through(block, island, network, crossed, bond)
      integer, intent(in) :: block(:)   !! Edges of the block and of its islands: (n)
      integer, intent(in) :: island(:)  !! Edges of the island: (n)
      type(network_t), intent(inout) :: network  !! Receives nodes at crossings
      type(crossed_t), intent(inout) :: crossed  !! Receives the crossings
      integer, allocatable, intent(inout) :: bond(:, :)  !! Receives end nodes of cuts: (2, n)
      integer, allocatable :: edge(:), node(:), order(:)
      real(wp), allocatable :: height(:)
      real(wp) :: x
      integer :: i

      x = free_place(network, island, block, crossed)
      edge = pack(block, (network%node(1, network%edge(1, block)) < x) &
         & .neqv. (network%node(1, network%edge(2, block)) < x))
      allocate (height(size(edge)), node(size(edge)))
      do i = 1, size(edge)
         associate (a => network%node(:, network%edge(1, edge(i))), &
            & b => network%node(:, network%edge(2, edge(i))))
            height(i) = a(2) + (x - a(1))/(b(1) - a(1))*(b(2) - a(2))
         end associate
      end do
      allocate (order, source=sorted_order(spread(1, 1, size(edge)), height))
      do i = 1, size(order)
         if (i > 1) then  ! both sides of one edge may be in the loops
            if (edge(order(i)) == edge(order(i - 1))) then
               node(i) = node(i - 1)
               cycle
            end if
         end if
         call add_crossing_node([x, height(order(i))], edge(order(i)), network, crossed, node(i))
      end do
      ! crossings alternate from the outside: in, out, in, out
      do i = 1, size(order) - 1, 2
         bond = reshape([bond, node(i), node(i + 1)], [2, size(bond, 2) + 1])
      end do
   end subroutine cut_through

   !> Edges of loops
   pure function edges_of(loops, member) result(edge)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: member(:)   !! Numbers of the loops
      integer, allocatable :: edge(:)    !! Numbers of their edges: (n)
      integer :: k, i, n

      allocate (edge(sum(loops%first(member + 1) - loops%first(member))))
      n = 0
      do k = 1, size(member)
         do i = loops%first(member(k)), loops%first(member(k) + 1) - 1
            n = n + 1
            edge(n) = (loops%half_edge(i) + 1)/2
         end do
      end do
   end function edges_of

   !> Middle of the widest gap in x between nodes of a block, within an island [m]
   pure real(wp) function free_place(network, island, block, crossed)
      type(network_t), intent(in) :: network
      integer, intent(in) :: island(:)        !! Edges of the island: (n)
      integer, intent(in) :: block(:)         !! Edges of the block and of its islands: (n)
      type(crossed_t), intent(in) :: crossed  !! The crossings so far; these are nodes too
      real(wp), allocatable :: x(:)
      integer, allocatable :: order(:)
      integer :: i, inner(2*size(island)), at(2*size(block) + size(crossed%node))

      inner = [network%edge(1, island), network%edge(2, island)]
      at = [network%edge(1, block), network%edge(2, block), crossed%node]
      associate (low => minval(network%node(1, inner)), high => maxval(network%node(1, inner)))
         x = pack(network%node(1, at), network%node(1, at) >= low .and. network%node(1, at) <= high)
      end associate
      allocate (order, source=sorted_order(spread(1, 1, size(x)), x))
      x = x(order)
      i = maxloc(x(2:) - x(:size(x) - 1), 1)
      free_place = (x(i) + x(i + 1))/2.0_wp
   end function free_place

   !> Add a node at a crossing
   pure subroutine add_crossing_node(place, edge, network, crossed, node)
      real(wp), intent(in) :: place(2)  !! Coordinates of the crossing: (2) [m]
      integer, intent(in) :: edge       !! The crossed edge
      type(network_t), intent(inout) :: network
      type(crossed_t), intent(inout) :: crossed
      integer, intent(out) :: node      !! Number of the new node

      node = size(network%node, 2) + 1
      network%node = reshape([network%node, place], [2, node])
      crossed%edge = [crossed%edge, edge]
      crossed%node = [crossed%node, node]
      crossed%n = crossed%n + 1
   end subroutine add_crossing_node

   !> Split edges at the nodes of their crossings
   pure subroutine insert_nodes(crossed, network)
      type(crossed_t), intent(in) :: crossed
      type(network_t), intent(inout) :: network
      integer, allocatable :: order(:), edge(:, :), line(:)
      real(wp), allocatable :: along(:)
      integer :: i, n, e, last

      allocate (along(crossed%n))
      do i = 1, crossed%n
         along(i) = norm2(network%node(:, crossed%node(i)) &
            & - network%node(:, network%edge(1, crossed%edge(i))))
      end do
      allocate (order, source=sorted_order(crossed%edge, along))
      n = size(network%line)
      allocate (edge(2, n + crossed%n), line(n + crossed%n))
      edge(:, :n) = network%edge
      line(:n) = network%line
      do i = crossed%n, 1, -1  ! from the end of an edge to its start
         e = crossed%edge(order(i))
         last = edge(2, e)
         n = n + 1
         edge(:, n) = [crossed%node(order(i)), last]
         line(n) = line(e)
         edge(2, e) = crossed%node(order(i))
      end do
      network%edge = edge
      network%line = line
      network%alive = [network%alive, spread(.true., 1, crossed%n)]
   end subroutine insert_nodes

   !> Add edges for bonds
   pure subroutine add_bonds(bond, line, network)
      integer, intent(in) :: bond(:, :)  !! End nodes: (2, n)
      integer, intent(in) :: line        !! Line number of the edges
      type(network_t), intent(inout) :: network
      integer :: n

      n = size(network%line) + size(bond, 2)
      network%edge = reshape([network%edge, bond], [2, n])
      network%line = [network%line, spread(line, 1, size(bond, 2))]
      network%alive = [network%alive, spread(.true., 1, size(bond, 2))]
   end subroutine add_bonds

   !> Whole block of each piece, by the smallest number of its pieces
   module procedure find_wholes
      integer :: k, low, high

      cut%whole = [(k, k=1, size(cut%area))]
      do k = 1, size(cut%pair)
         if (cut%pair(k)%joint /= bond_joint) cycle
         low = minval(cut%whole(cut%pair(k)%side([1, 3])))
         high = maxval(cut%whole(cut%pair(k)%side([1, 3])))
         if (low < high) where (cut%whole == high) cut%whole = low
      end do
   end procedure find_wholes
end submodule dda_islands
