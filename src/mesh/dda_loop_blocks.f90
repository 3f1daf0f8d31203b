!> From loops to blocks: corners on a straight edge go, coincident edges are found
!> (Shi: dc08, dc09)
submodule (dda_cutting) dda_loop_blocks
   use dda_cut_model, only : add_remark, cut_reason, edge_pair_t
   use dda_line_network, only : edge_place, half_edge_start
   use dda_sort, only : sorted_order
   use dda_vector, only : cross
   implicit none

contains

   !> Blocks of the loops that run around an area
   module procedure blocks_of_loops
      ! block and edge that each half-edge is a part of
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

   !> Places in a loop where it turns: a node is no corner if it lies on the straight way from the
   !> corner before it to the next node (Shi: dc09)
   pure subroutine corners_of_loop(network, half_edge, reach, corner)
      type(network_t), intent(in) :: network
      !> The half-edges of the loop: (n)
      integer, intent(in) :: half_edge(:)
      !> Distance within which things touch [m]
      real(wp), intent(in) :: reach
      !> Half-edges of the loop that start at a corner: (n_corner)
      integer, allocatable, intent(out) :: corner(:)
      real(wp), allocatable :: node(:, :)
      logical, allocatable :: turns(:)
      integer :: k, n, last

      n = size(half_edge)
      allocate (node(2, 0:n), turns(n))
      do k = 1, n
         node(:, k) = network%node(:, half_edge_start(network, half_edge(k)))
      end do
      node(:, 0) = node(:, n)
      turns = .true.
      last = 0
      do k = 1, n
         turns(k) = .not. is_between(node(:, k), node(:, last), node(:, 1 + mod(k, n)), reach)
         if (turns(k)) last = k
      end do
      ! the first corners were judged against a node that may be none itself
      do k = 1, n
         if (last == 0) exit
         if (turns(k)) then
            turns(k) = .not. is_between(node(:, k), node(:, last), node(:, next_turn(turns, k)), &
               & reach)
            if (turns(k)) exit
         end if
      end do
      corner = pack([(k, k=1, n)], turns)
   end subroutine corners_of_loop

   !> The corner that follows a place of a loop
   pure integer function next_turn(turns, k)
      logical, intent(in) :: turns(:)  !! Which places are corners: (n)
      integer, intent(in) :: k         !! The place
      integer :: i

      next_turn = k
      do i = 1, size(turns)
         next_turn = 1 + mod(next_turn, size(turns))
         if (turns(next_turn)) return
      end do
   end function next_turn

   !> Whether a point lies on the straight way between two others
   pure logical function is_between(point, start, finish, reach)
      real(wp), intent(in) :: point(2)   !! The point: (2) [m]
      real(wp), intent(in) :: start(2)   !! Where the way starts: (2) [m]
      real(wp), intent(in) :: finish(2)  !! Where it ends: (2) [m]
      real(wp), intent(in) :: reach
      real(wp) :: way(2), arm(2)

      way = finish - start
      arm = point - start
      is_between = abs(cross(way, arm)) <= reach*norm2(way) .and. dot_product(way, arm) >= 0.0_wp &
         & .and. dot_product(way, finish - point) >= 0.0_wp
   end function is_between

   !> Store the corners of a block and tell its half-edges which edge they belong to
   pure subroutine add_corners(network, half_edge, corner, joint, block, n_vertex, cut, owner)
      type(network_t), intent(in) :: network
      integer, intent(in) :: half_edge(:), corner(:), joint(:)
      !> Number of the block
      integer, intent(in) :: block
      !> Number of vertices so far
      integer, intent(inout) :: n_vertex
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

   !> Pairs of edges that the same edges of the network are parts of
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
      ! vertices number the edges of all blocks
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

   !> Let a pair of edges reach over one more part
   pure subroutine join_parts(pair, place)
      type(edge_pair_t), intent(inout) :: pair
      real(wp), intent(in) :: place(4)  !! Ends of the part, in the same direction: (4) [m]
      real(wp) :: way(2)

      way = pair%place(3:4) - pair%place(1:2)
      if (dot_product(way, place(1:2) - pair%place(1:2)) < 0.0_wp) pair%place(1:2) = place(1:2)
      if (dot_product(way, place(3:4) - pair%place(3:4)) > 0.0_wp) pair%place(3:4) = place(3:4)
   end subroutine join_parts

end submodule dda_loop_blocks
