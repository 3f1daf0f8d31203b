!> Near edges of different blocks by a tree of boxes with margins (Verlet 1967; Box2D)
!>
!> The stored pairs only speed up the search: a query returns the pairs whose present boxes overlap,
!> in an order that does not depend on the stored pairs.
!>
!>
!> Edges that touch or may touch in the next step (Shi: df04) are examined per pair of blocks
module dda_contact_search
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_system, only : block_system_t
   use dda_box_tree, only : box_pairs, box_tree_t, least_nearby, least_values, new_box_tree
   use dda_contact_types, only : joint_t
   use dda_contacts, only : joint_search_t
   use dda_entrance, only : add_joints, joint_list_t, neighbourhood_t, take_joints
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_outline, only : measure_edges, outline_of, outline_t
   use dda_parting_line, only : add_parted_joint
   use dda_sort, only : rising_order
   implicit none
   private

   public :: find_edge_pairs, new_joint_search, store_near_edges, law_of, touching_joints
   public :: near_joints, remember_drawn

   !> Smallest and largest margin over the block size
   real(wp), parameter :: least = 0.05_wp, most = 0.5_wp
   !> Margin over the reach; steady motion then rarely rebuilds the tree
   real(wp), parameter :: ahead = 4.0_wp
   !> Relative round-off of displacements
   real(wp), parameter :: rounding = 1.0e-12_wp

contains

   !> Edges of different blocks with overlapping boxes, in the order of their blocks
   pure subroutine find_edge_pairs(search, equation, vertex, reach, pair, near_alone)
      !> Outline of the blocks, and stored pairs
      type(joint_search_t), intent(in) :: search
      !> Number of each block in the equations; 0 for a fixed block: (n_block)
      integer, intent(in) :: equation(:)
      !> Corners of the blocks: (2, n_vertex) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> Reach of each block: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> The pairs, without those of two fixed blocks: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      !> True to exclude edges whose distance is beyond reach: inclined edges of thin blocks have
      !> many overlapping boxes
      logical, intent(in), optional :: near_alone
      real(wp) :: low(2, size(vertex, 2)), high(2, size(vertex, 2))
      integer, allocatable :: near(:, :)
      integer :: i, n

      call edge_boxes(search%outline, vertex, reach, low, high)
      if (.not. covers(search, vertex, reach)) then
         if (present(near_alone)) then
            if (near_alone) then
               call search_pairs(search%outline, equation, low, high, pair, vertex, reach)
               return
            end if
         end if
         call search_pairs(search%outline, equation, low, high, pair)
         return
      end if
      allocate (near, mold=search%near%pair)
      n = 0
      do i = 1, size(near, 2)
         associate (a => search%near%pair(1, i), b => search%near%pair(2, i))
            if (low(1, b) > high(1, a) .or. low(2, b) > high(2, a)) cycle
            if (high(1, b) < low(1, a) .or. high(2, b) < low(2, a)) cycle
            n = n + 1
            near(:, n) = [a, b]
         end associate
      end do
      pair = near(:, :n)
   end subroutine find_edge_pairs

   !> Store pairs of edges that may come near in this step and the following ones, unless the stored
   !> pairs suffice
   pure subroutine store_near_edges(search, system, reach)
      type(joint_search_t), intent(inout) :: search
      type(block_system_t), intent(in) :: system
      !> Largest motion of the corners of each block in this step: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      real(wp) :: low(2, size(system%moved, 2)), high(2, size(system%moved, 2))

      if (covers(search, system%moved, reach)) return
      associate (known => search%near, side => sqrt(system%area))
         known%vertex = system%moved
         known%reach = reach + merge(min(most*side, max(least*side, ahead*reach)), 0.0_wp, &
            & system%equation > 0)
         call edge_boxes(search%outline, known%vertex, known%reach, low, high)
         call search_pairs(search%outline, system%equation, low, high, known%pair)
      end associate
   end subroutine store_near_edges

   !> True if the stored pairs include all near pairs
   pure logical function covers(search, vertex, reach)
      type(joint_search_t), intent(in) :: search
      real(wp), intent(in) :: vertex(:, :), reach(:)
      real(wp) :: way
      integer :: v

      covers = allocated(search%near%pair)
      if (.not. covers) return
      do v = 1, size(vertex, 2)
         way = maxval(abs(vertex(:, v) - search%near%vertex(:, v)))
         associate (b => search%outline%block(v))
            covers = (way + reach(b))*(1.0_wp + rounding) <= search%near%reach(b) &
               & .or. .not. way > 0.0_wp .and. reach(b) <= search%near%reach(b)
         end associate
         if (.not. covers) return
      end do
   end function covers

   !> Boxes of edges, widened by the reach of their blocks
   pure subroutine edge_boxes(outline, vertex, reach, low, high)
      type(outline_t), intent(in) :: outline
      real(wp), intent(in) :: vertex(:, :), reach(:)
      real(wp), intent(out) :: low(:, :)   !! Lower left corners of the boxes: (2, n_vertex) [m]
      real(wp), intent(out) :: high(:, :)  !! Upper right corners: (2, n_vertex) [m]
      integer :: e

      do e = 1, size(vertex, 2)
         associate (next => outline%next(e), far => reach(outline%block(e)))
            low(:, e) = min(vertex(:, e), vertex(:, next)) - far
            high(:, e) = max(vertex(:, e), vertex(:, next)) + far
         end associate
      end do
   end subroutine edge_boxes

   !> Edges of different blocks with overlapping boxes, by a tree of all boxes
   pure subroutine search_pairs(outline, equation, low, high, pair, vertex, reach)
      type(outline_t), intent(in) :: outline
      integer, intent(in) :: equation(:)
      real(wp), intent(in) :: low(:, :), high(:, :)
      !> The pairs in the order of their blocks: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      !> Corners of the blocks and reach of each block, to exclude edges beyond it
      real(wp), intent(in), optional :: vertex(:, :), reach(:)
      integer :: group(size(outline%block))
      real(wp), allocatable :: segment(:, :)
      integer(int64), allocatable :: key(:)
      integer, allocatable :: found(:, :)
      integer :: i

      group = merge(outline%block, 0, equation(outline%block) > 0)
      if (present(vertex)) then
         allocate (segment(4, size(vertex, 2)))
         segment(1:2, :) = vertex
         segment(3:4, :) = vertex(:, outline%next)
         call box_pairs(low, high, group, found, segment, reach(outline%block))
      else
         call box_pairs(low, high, group, found)
      end if
      if (.not. all(outline%turns)) found = found(:, pack([(i, i=1, size(found, 2))], &
         & outline%turns(found(1, :)) .and. outline%turns(found(2, :))))
      associate (block => outline%block, n => size(equation) + 1)
         allocate (key(size(found, 2)))
         key = int(block(found(1, :)), int64)*n + int(block(found(2, :)), int64)
         allocate (pair(2, size(found, 2)))
         pair = found(:, rising_order(key))
      end associate
   end subroutine search_pairs

   !> Make the joint search of a system
   pure type(joint_search_t) function new_joint_search(system, law, tolerance)
      type(block_system_t), intent(in) :: system
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), intent(in) :: law(:, :)
      real(wp), intent(in), optional :: tolerance  !! The contact tolerance

      new_joint_search%outline = outline_of(system)
      allocate (new_joint_search%law, source=law)
      if (present(tolerance)) new_joint_search%tolerance = tolerance
   end function new_joint_search

   !> Number of the law of a joint in the laws of the contacts: that of its first edge, or that
   !> between the materials of its blocks
   pure integer function law_of(search, system, joint)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint

      if (allocated(search%edge_law)) then
         law_of = search%edge_law(joint%contact(1)%edge)
      else
         law_of = system%material(joint%block(1)) &
            & + size(search%law, 1)*(system%material(joint%block(2)) - 1)
      end if
   end function law_of

   !> Joints of blocks that touch in the reference shape: the gap is at most a share of the size of
   !> the smallest of the two blocks and those between them
   pure subroutine touching_joints(search, system, share, joint, size_of)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: share  !! The share, at least the contact tolerance
      !> The joints, in the order of their blocks: (n_joint)
      type(joint_t), allocatable, intent(out) :: joint(:)
      !> Size of the smallest block at each joint: (n_joint) [m]
      real(wp), allocatable, intent(out), optional :: size_of(:)
      type(neighbourhood_t) :: near
      real(wp) :: beside(size(system%area)), reach(size(system%area))
      integer :: j

      reach = drawn_reach(system, share)
      beside = least_beside(system, reach)
      near%vertex = system%vertex
      near%travel = 0.0_wp*system%vertex
      near%beginning = .true.
      near%ends = search%tolerance/share
      allocate (near%closed(0))
      call find_joints(search, system, reach, near, joint, beside)
      if (present(size_of)) size_of = [(least_reach(reach, beside, joint(j)%block)/share, &
         & j=1, size(joint))]
   end subroutine touching_joints

   !> Store the edges that are near one another in the reference shape, for searches with at most
   !> this share
   pure subroutine remember_drawn(search, system, share)
      type(joint_search_t), intent(inout) :: search
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: share
      integer, allocatable :: pair(:, :)
      real(wp) :: reach(size(system%area))

      reach = drawn_reach(system, share)
      call find_edge_pairs(search, system%equation, system%vertex, reach, pair, .true.)
      search%near%vertex = system%vertex
      search%near%reach = reach
      call move_alloc(pair, search%near%pair)
   end subroutine remember_drawn

   !> Share of the size of each block, at most half its thickness, so that blocks on both sides of a
   !> thin plate do not touch
   pure function drawn_reach(system, share) result(reach)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: share
      real(wp) :: reach(size(system%area))  !! Reach of each block: (n_block) [m]
      integer :: b

      do b = 1, size(reach)
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            reach(b) = min(share*sqrt(system%area(b)), system%area(b) &
               & /sum(norm2(cshift(vertex, 1, dim=2) - vertex, dim=1)))
         end associate
      end do
   end function drawn_reach

   !> Smallest reach of two blocks and of those between them [m]
   pure real(wp) function least_reach(reach, beside, block)
      real(wp), intent(in) :: reach(:)   !! Reach of each block: (n_block) [m]
      real(wp), intent(in) :: beside(:)  !! Smallest reach next to each block: (n_block) [m]
      integer, intent(in) :: block(2)    !! Numbers of the two blocks: (2)

      least_reach = min(minval(reach(block)), maxval(beside(block)))
   end function least_reach

   !> Smallest reach of each block and its neighbours. A thin plate between two blocks can be
   !> thinner than their reach, but not thinner than its own
   pure function least_beside(system, reach) result(least)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: reach(:)  !! Reach of each block: (n_block) [m]
      real(wp) :: least(size(reach))    !! Smallest reach: (n_block) [m]
      real(wp) :: high(2, size(reach)), low(2, size(reach))
      real(wp), allocatable :: least_below(:)
      type(box_tree_t) :: tree
      integer :: b

      do b = 1, size(reach)
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            low(:, b) = minval(vertex, dim=2) - reach(b)
            high(:, b) = maxval(vertex, dim=2) + reach(b)
         end associate
      end do
      call new_box_tree(low, high, tree)
      call least_values(tree, reach, least_below)
      least = reach
      do b = 1, size(reach)
         call least_nearby(tree, least_below, low(:, b), high(:, b), least(b))
      end do
   end function least_beside

   !> Joints of blocks that touch at present or may touch in a step
   pure subroutine near_joints(search, system, travel, closed, reach, in_time, joint, tried)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> Expected motion of the corners, for directions and ratios only: (2, n_vertex) [m]
      real(wp), intent(in) :: travel(:, :)
      !> Keys of the contacts that were closed, ascending: (n_closed)
      integer(int64), intent(in) :: closed(:)
      real(wp), intent(in) :: reach(:)
      !> True in dynamic runs, where convex blocks use separating axes
      logical, intent(in) :: in_time
      type(joint_t), allocatable, intent(out) :: joint(:)
      !> True if the expected motion is that of a try; false if absent
      logical, intent(in), optional :: tried
      type(neighbourhood_t) :: near

      near%vertex = system%moved
      near%travel = travel
      if (present(tried)) near%tried = tried
      if (in_time) near%ahead = system%moved + travel
      near%closed = closed
      call find_joints(search, system, reach, near, joint)
   end subroutine near_joints

   !> Joints of all pairs of blocks with near edges
   pure subroutine find_joints(search, system, reach, near, joint, beside)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> Reach of each block; of two blocks the smaller one in the reference shape, later the
      !> sum: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> Corners of the blocks; completed here
      type(neighbourhood_t), intent(inout) :: near
      type(joint_t), allocatable, intent(out) :: joint(:)
      !> Smallest reach next to each block, for the reference shape: (n_block) [m]
      real(wp), intent(in), optional :: beside(:)
      type(joint_list_t) :: list
      integer, allocatable :: pair(:, :)
      real(wp) :: far
      integer :: block(2), first, last, j

      near%outline = search%outline
      call measure_edges(near%vertex, near%outline)
      near%first_vertex = system%first_vertex
      call find_edge_pairs(search, system%equation, near%vertex, reach, pair, near%beginning)
      associate (owner => near%outline%block)
         if (allocated(search%absent)) pair = pair(:, pack([(j, j=1, size(pair, 2))], &
            & .not. (search%absent(owner(pair(1, :))) .or. search%absent(owner(pair(2, :))))))
      end associate
      first = 1
      do while (first <= size(pair, 2))
         block = near%outline%block(pair(:, first))
         last = first
         do while (last < size(pair, 2))
            if (any(near%outline%block(pair(:, last + 1)) /= block)) exit
            last = last + 1
         end do
         far = sum(reach(block))
         if (present(beside)) far = least_reach(reach, beside, block)
         near%level = search%tolerance*sqrt(minval(system%area(block)))
         if (allocated(near%ahead) .and. all(near%outline%convex(block))) then
            call add_parted_joint(near, pair(:, first:last), far, list)
         else
            call add_joints(near, pair(:, first:last), far, list)
         end if
         first = last + 1
      end do
      call take_joints(list, joint)
      do j = 1, size(joint)
         joint(j)%law = law_of(search, system, joint(j))
      end do
   end subroutine find_joints

end module dda_contact_search
