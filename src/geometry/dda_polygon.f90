!> Polygons: contents, depth of a point inside, intersections of edges
module dda_polygon
   use dda_box_tree, only : box_distance, box_pairs, box_tree_t, find_boxes, max_levels, &
      & new_box_tree
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_segment, only : meeting_points, segment_distance
   use dda_sort, only : sorted_order
   use dda_vector, only : cross
   implicit none
   private

   public :: contains_point, polygon_distance, depth_in, find_crossing, parts_inside
   public :: edge_ends, edge_tree, edges_near, has_tree

   !> Tangent of the angle below which a corner counts as straight
   real(wp), parameter :: flat = 1.0e-9_wp

contains

   !> True if a point lies in a polygon, by the winding number
   pure logical function contains_point(vertex, point)
      real(wp), intent(in) :: vertex(:, :)  !! Corners in order: (2, n) [m]
      real(wp), intent(in) :: point(2)      !! The point: (2) [m]
      real(wp) :: a(2), b(2), side
      integer :: i, turns

      turns = 0
      b = vertex(:, size(vertex, 2)) - point
      do i = 1, size(vertex, 2)
         a = b
         b = vertex(:, i) - point
         if ((a(2) <= 0.0_wp) .eqv. (b(2) <= 0.0_wp)) cycle
         side = cross(a, b)
         if (a(2) <= 0.0_wp .and. side > 0.0_wp) turns = turns + 1
         if (b(2) <= 0.0_wp .and. side < 0.0_wp) turns = turns - 1
      end do
      contains_point = turns /= 0
   end function contains_point

   !> Distance of a point from the boundary of a polygon
   pure real(wp) function polygon_distance(vertex, point)
      real(wp), intent(in) :: vertex(:, :), point(2)
      integer :: edge

      call nearest_edge(vertex, point, edge, polygon_distance)
   end function polygon_distance

   !> Depth of a point inside a polygon, negative outside [m]
   pure real(wp) function depth_in(vertex, point, tree)
      real(wp), intent(in) :: vertex(:, :)  !! Corners, counter-clockwise: (2, n) [m]
      real(wp), intent(in) :: point(2)
      type(box_tree_t), intent(in), optional :: tree
      real(wp) :: distance
      integer :: edge

      if (has_tree(tree)) then
         call search_nearest(vertex, point, tree, edge, distance)
      else
         call nearest_edge(vertex, point, edge, distance)
      end if
      depth_in = merge(distance, -distance, is_left_of(vertex, point, edge))
   end function depth_in

   !> True if a tree of the edges is present
   pure logical function has_tree(tree)
      type(box_tree_t), intent(in), optional :: tree  !! The tree; absent or empty if there is none

      has_tree = present(tree)
      if (has_tree) has_tree = allocated(tree%box)
   end function has_tree

   !> Build a tree of the edges of a polygon
   pure subroutine edge_tree(vertex, tree)
      real(wp), intent(in) :: vertex(:, :)
      type(box_tree_t), intent(out) :: tree
      real(wp) :: next(2, size(vertex, 2))

      next = cshift(vertex, 1, dim=2)
      call new_box_tree(min(vertex, next), max(vertex, next), tree)
   end subroutine edge_tree

   !> Ends of an edge
   pure function edge_ends(vertex, edge) result(ends)
      real(wp), intent(in) :: vertex(:, :)
      integer, intent(in) :: edge  !! Number of the edge, that of its first corner
      real(wp) :: ends(4)          !! The ends: (4) [m]
      integer :: next

      next = edge + 1
      if (next > size(vertex, 2)) next = 1
      ends(1:2) = vertex(:, edge)
      ends(3:4) = vertex(:, next)
   end function edge_ends

   !> Edge of a polygon nearest to a point
   pure subroutine nearest_edge(vertex, point, edge, distance)
      real(wp), intent(in) :: vertex(:, :), point(2)
      integer, intent(out) :: edge
      real(wp), intent(out) :: distance  !! Distance of that edge [m]
      real(wp) :: here
      integer :: i

      edge = 1
      distance = huge(distance)
      do i = 1, size(vertex, 2)
         here = segment_distance(point, edge_ends(vertex, i))
         if (here >= distance) cycle
         distance = here
         edge = i
      end do
   end subroutine nearest_edge

   !> Nearest edge by a tree of the edges
   pure subroutine search_nearest(vertex, point, tree, edge, distance)
      real(wp), intent(in) :: vertex(:, :), point(2)
      type(box_tree_t), intent(in) :: tree
      integer, intent(out) :: edge  !! Number of the nearest edge
      real(wp), intent(out) :: distance
      integer :: stack(max_levels), top, node
      real(wp) :: here

      edge = 1
      distance = huge(distance)
      top = 1
      stack(1) = 1
      do while (top > 0)
         node = stack(top)
         top = top - 1
         if (tree%last(node) == 0) cycle
         if (box_distance(tree, node, point) >= distance) cycle
         if (node < tree%n_leaf) then
            ! the nearer half first
            stack(top + 1:top + 2) = [2*node + 1, 2*node]
            if (box_distance(tree, 2*node, point) > box_distance(tree, 2*node + 1, point)) &
               & stack(top + 1:top + 2) = [2*node, 2*node + 1]
            top = top + 2
            cycle
         end if
         here = segment_distance(point, edge_ends(vertex, tree%last(node)))
         if (here >= distance) cycle
         distance = here
         edge = tree%last(node)
      end do
   end subroutine search_nearest

   !> True if a point lies on the inner side of its nearest edge. If a corner is nearest, a point at
   !> a notch is inside and a point at a convex corner outside
   pure logical function is_left_of(vertex, point, edge)
      real(wp), intent(in) :: vertex(:, :), point(2)
      integer, intent(in) :: edge
      real(wp) :: ends(4), beside(4), before(2), after(2), arm(2), turn
      logical :: straight

      ends = edge_ends(vertex, edge)
      before = ends(3:4) - ends(1:2)
      arm = point - ends(1:2)
      is_left_of = cross(before, arm) > 0.0_wp
      if (dot_product(arm, before) <= 0.0_wp) then
         after = before
         beside = edge_ends(vertex, merge(edge - 1, size(vertex, 2), edge > 1))
         before = beside(3:4) - beside(1:2)
      else if (dot_product(point - ends(3:4), before) >= 0.0_wp) then
         beside = edge_ends(vertex, merge(edge + 1, 1, edge < size(vertex, 2)))
         after = beside(3:4) - beside(1:2)
      else
         return
      end if
      turn = cross(before, after)
      straight = abs(turn) <= flat*dot_product(before, after)
      if (.not. straight) is_left_of = turn < 0.0_wp
   end function is_left_of

   !> Parts of a segment inside a polygon or on its outline, in order along the segment; adjacent
   !> parts are merged
   pure function parts_inside(vertex, segment, reach, tree) result(part)
      real(wp), intent(in) :: vertex(:, :)
      real(wp), intent(in) :: segment(4)   !! Ends of the segment: (4) [m]
      real(wp), intent(in) :: reach        !! Distance within which points coincide [m]
      type(box_tree_t), intent(in), optional :: tree
      real(wp), allocatable :: part(:, :)  !! Ends of each part: (2, 2*n_part) [m]
      real(wp), allocatable :: place(:)
      integer, allocatable :: near(:), order(:)
      real(wp) :: point(2, 2), along(2), from, length
      integer :: i, j, n, n_near, met

      along = segment(3:4) - segment(1:2)
      length = norm2(along)
      along = along/length
      call edges_near(vertex, segment, reach, near, n_near, tree)
      allocate (place(2*n_near + 2))
      place(1:2) = [0.0_wp, length]
      n = 2
      do i = 1, n_near
         call meeting_points(segment, edge_ends(vertex, near(i)), reach, met, point)
         do j = 1, met
            n = n + 1
            place(n) = dot_product(point(:, j) - segment(1:2), along)
         end do
      end do
      allocate (order(n))
      order = sorted_order(spread(0, 1, n), place(:n))
      place(:n) = place(order)
      allocate (part(2, 2*n))
      j = 0
      from = 0.0_wp
      do i = 2, n
         if (place(i) - place(i - 1) <= reach) cycle
         if (depth_in(vertex, segment(1:2) + (place(i) + place(i - 1))/2.0_wp*along, tree) &
            & < -reach) cycle
         if (j == 0 .or. .not. abs(from - place(i - 1)) <= reach) then
            part(:, j + 1) = segment(1:2) + place(i - 1)*along
            j = j + 2
         end if
         part(:, j) = segment(1:2) + place(i)*along
         from = place(i)
      end do
      part = part(:, :j)
   end function parts_inside

   !> First two edges of a polygon that cross, or that touch without being neighbours
   pure subroutine find_crossing(vertex, edge, point)
      real(wp), intent(in) :: vertex(:, :)
      integer, intent(out) :: edge(2)    !! Numbers of the edges, 0 if none cross: (2)
      real(wp), intent(out) :: point(2)  !! Intersection: (2) [m]
      integer, allocatable :: pair(:, :)
      real(wp) :: next(2, size(vertex, 2)), a(2), b(2), area
      integer :: i, k, n

      n = size(vertex, 2)
      next = cshift(vertex, 1, dim=2)
      edge = 0
      point = 0.0_wp
      call box_pairs(min(vertex, next), max(vertex, next), [(i, i=1, n)], pair)
      do k = 1, size(pair, 2)
         associate (i1 => pair(1, k), i2 => pair(2, k))
            if (i2 == i1 + 1 .or. i1 == 1 .and. i2 == n) cycle
            if (.not. segments_meet(vertex(:, i1), next(:, i1), vertex(:, i2), next(:, i2))) cycle
            edge = [i1, i2]
            a = next(:, i1) - vertex(:, i1)
            b = next(:, i2) - vertex(:, i2)
            area = cross(a, b)
            point = vertex(:, i2)
            if (abs(area) > 0.0_wp) point = vertex(:, i1) &
               & + a*cross(vertex(:, i2) - vertex(:, i1), b)/area
            return
         end associate
      end do
   end subroutine find_crossing

   !> True if two segments have a common point
   pure logical function segments_meet(a, b, c, d)
      real(wp), intent(in) :: a(2)  !! Start of the first: (2) [m]
      real(wp), intent(in) :: b(2)  !! Its end: (2) [m]
      real(wp), intent(in) :: c(2)  !! Start of the second: (2) [m]
      real(wp), intent(in) :: d(2)  !! Its end: (2) [m]
      real(wp) :: side(4)

      side = [cross(b - a, c - a), cross(b - a, d - a), cross(d - c, a - c), cross(d - c, b - c)]
      segments_meet = side(1)*side(2) <= 0.0_wp .and. side(3)*side(4) <= 0.0_wp
      if (.not. all(abs(side) <= 0.0_wp)) return
      segments_meet = all(max(min(a, b), min(c, d)) <= min(max(a, b), max(c, d)))
   end function segments_meet

   !> Edges of a polygon that may touch a segment; all edges without a tree
   pure subroutine edges_near(vertex, segment, reach, near, n, tree)
      real(wp), intent(in) :: vertex(:, :), segment(4), reach
      !> Numbers of the edges in the first n entries; reused storage
      integer, allocatable, intent(inout) :: near(:)
      integer, intent(out) :: n  !! Number of edges
      type(box_tree_t), intent(in), optional :: tree
      integer :: i

      if (has_tree(tree)) then
         call find_boxes(tree, min(segment(1:2), segment(3:4)) - reach, &
            & max(segment(1:2), segment(3:4)) + reach, near, n, segment=segment, margin=reach)
      else
         n = size(vertex, 2)
         call make_room(near, n)
         near(:n) = [(i, i=1, n)]
      end if
   end subroutine edges_near
end module dda_polygon
