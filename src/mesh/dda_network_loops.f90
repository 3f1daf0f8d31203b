!> The loops of a network: one around each block, anticlockwise, and one around each group of blocks
!> that hang together (Shi: dc07, dc08)
submodule (dda_cutting) dda_network_loops
   use dda_sort, only : sorted_order
   use dda_vector, only : cross
   implicit none

contains

   !> Walk along all edges on both sides, at each node turning as far left as possible
   module procedure trace_loops
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
   end procedure trace_loops

   !> Node where a half-edge starts
   module procedure half_edge_start
      half_edge_start = network%edge(2 - mod(half_edge, 2), (half_edge + 1)/2)
   end procedure half_edge_start

   !> The half-edge on the other side of the same edge
   elemental integer function opposite(half_edge)
      integer, intent(in) :: half_edge

      opposite = half_edge - 1 + 2*mod(half_edge, 2)
   end function opposite

   !> The half-edge that follows each one in its loop: around the node at its end, the first one
   !> clockwise from the way back (Shi: dc07)
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

   !> Area inside a loop, by triangles seen from its first node
   pure real(wp) function loop_area(network, half_edge)
      type(network_t), intent(in) :: network
      !> The half-edges of the loop: (n)
      integer, intent(in) :: half_edge(:)
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

end submodule dda_network_loops
