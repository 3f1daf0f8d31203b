!> Polygons: what they hold, how deep a point lies inside, where their edges cross
module dda_polygon
   use dda_box_tree, only : box_pairs
   use dda_kinds, only : wp
   use dda_segment, only : meeting_points, segment_distance
   use dda_vector, only : cross
   implicit none
   private

   public :: contains_point, polygon_distance, depth_in, find_crossing, find_overlap, parts_inside

contains

   !> Whether a point lies in a polygon: its boundary winds around the point
   pure logical function contains_point(vertex, point)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
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
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      integer :: i, n

      n = size(vertex, 2)
      polygon_distance = segment_distance(point, [vertex(:, n), vertex(:, 1)])
      do i = 2, n
         polygon_distance = min(polygon_distance, &
            & segment_distance(point, [vertex(:, i - 1), vertex(:, i)]))
      end do
   end function polygon_distance

   !> How deep a point lies inside a polygon, negative outside [m]
   pure real(wp) function depth_in(vertex, point)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)

      depth_in = polygon_distance(vertex, point)
      if (.not. contains_point(vertex, point)) depth_in = -depth_in
   end function depth_in

   !> Ends of the parts of a segment that lie in a polygon or on its outline, in order along it;
   !> parts that follow one another count as one
   pure function parts_inside(vertex, segment, reach) result(part)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> Ends of the segment: (4) [m]
      real(wp), intent(in) :: segment(4)
      !> Distance within which things touch [m]
      real(wp), intent(in) :: reach
      !> Ends of each part: (2, 2*n_part) [m]
      real(wp), allocatable :: part(:, :)
      real(wp) :: place(2*size(vertex, 2) + 2), point(2, 2), along(2), length, from
      integer :: i, j, n, met

      along = segment(3:4) - segment(1:2)
      length = norm2(along)
      along = along/length
      place(1:2) = [0.0_wp, length]
      n = 2
      do i = 1, size(vertex, 2)
         j = modulo(i, size(vertex, 2)) + 1
         call meeting_points(segment, [vertex(:, i), vertex(:, j)], reach, met, point)
         do j = 1, met
            n = n + 1
            place(n) = dot_product(point(:, j) - segment(1:2), along)
         end do
      end do
      do i = 1, n - 1
         j = i - 1 + minloc(place(i:n), dim=1)
         place([i, j]) = place([j, i])
      end do
      allocate (part(2, 0))
      from = -1.0_wp
      do i = 2, n
         if (place(i) - place(i - 1) <= reach) cycle
         if (depth_in(vertex, segment(1:2) + (place(i) + place(i - 1))/2.0_wp*along) < -reach) cycle
         if (.not. abs(from - place(i - 1)) <= reach) &
            & part = reshape([part, segment(1:2) + place(i - 1)*along], [2, size(part, 2) + 1])
         if (abs(from - place(i - 1)) <= reach) part = part(:, :size(part, 2) - 1)
         part = reshape([part, segment(1:2) + place(i)*along], [2, size(part, 2) + 1])
         from = place(i)
      end do
   end function parts_inside

   !> The first two edges of a polygon that cross, or touch where they do not follow one another
   pure subroutine find_crossing(vertex, edge, point)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The edges, 0 if none cross: (2)
      integer, intent(out) :: edge(2)
      !> Where they cross: (2) [m]
      real(wp), intent(out) :: point(2)
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

   !> Whether two segments have a point in common
   pure logical function segments_meet(a, b, c, d)
      !> Start of the first: (2) [m]
      real(wp), intent(in) :: a(2)
      !> Its end: (2) [m]
      real(wp), intent(in) :: b(2)
      !> Start of the second: (2) [m]
      real(wp), intent(in) :: c(2)
      !> Its end: (2) [m]
      real(wp), intent(in) :: d(2)
      real(wp) :: side(4)

      side = [cross(b - a, c - a), cross(b - a, d - a), cross(d - c, a - c), cross(d - c, b - c)]
      segments_meet = side(1)*side(2) <= 0.0_wp .and. side(3)*side(4) <= 0.0_wp
      if (.not. all(abs(side) <= 0.0_wp)) return
      segments_meet = all(max(min(a, b), min(c, d)) <= min(max(a, b), max(c, d)))
   end function segments_meet

   !> The point of one polygon's outline that lies deepest in another, of the corners and the
   !> middles of the pieces into which the other cuts the edges
   pure subroutine deepest_on_outline(outline, other, deepest, point)
      !> Corners of the one: (2, n) [m]
      real(wp), intent(in) :: outline(:, :)
      !> Corners of the other: (2, m) [m]
      real(wp), intent(in) :: other(:, :)
      !> How deep it lies, negative outside [m]
      real(wp), intent(out) :: deepest
      !> The point: (2) [m]
      real(wp), intent(out) :: point(2)
      real(wp) :: a(2), b(2), c(2), area, cut(size(other, 2) + 2), depth, middle(2)
      integer :: i, j, n

      deepest = -huge(deepest)
      point = outline(:, 1)
      do i = 1, size(outline, 2)
         a = outline(:, i)
         b = outline(:, modulo(i, size(outline, 2)) + 1) - a
         n = 2
         cut(:2) = [0.0_wp, 1.0_wp]
         do j = 1, size(other, 2)
            c = other(:, modulo(j, size(other, 2)) + 1) - other(:, j)
            area = cross(b, c)
            if (.not. abs(area) > 0.0_wp) cycle
            n = n + 1
            cut(n) = min(max(cross(other(:, j) - a, c)/area, 0.0_wp), 1.0_wp)
         end do
         do j = 1, n
            middle = a + b
            if (cut(j) < 1.0_wp) &
               & middle = a + b*(cut(j) + minval(cut(:n), mask=cut(:n) > cut(j)))/2.0_wp
            depth = depth_in(other, middle)
            if (.not. depth > deepest) cycle
            deepest = depth
            point = middle
         end do
      end do
   end subroutine deepest_on_outline

   !> Whether two polygons overlap by more than a tolerance
   pure subroutine find_overlap(first, second, tolerance, overlaps, inside, point)
      !> Corners of the first: (2, n) [m]
      real(wp), intent(in) :: first(:, :)
      !> Corners of the second: (2, m) [m]
      real(wp), intent(in) :: second(:, :)
      !> The tolerance [m]
      real(wp), intent(in) :: tolerance
      !> Whether they overlap
      logical, intent(out) :: overlaps
      !> Which of them lies wholly inside the other: 1, 2 or 0 for none
      integer, intent(out) :: inside
      !> A point that both hold: (2) [m]
      real(wp), intent(out) :: point(2)
      real(wp) :: depth(size(first, 2)), other_depth(size(second, 2)), deepest(2)
      real(wp) :: place(2, 2)
      integer :: i

      inside = 0
      depth = [(depth_in(second, first(:, i)), i=1, size(first, 2))]
      other_depth = [(depth_in(first, second(:, i)), i=1, size(second, 2))]
      call deepest_on_outline(first, second, deepest(1), place(:, 1))
      call deepest_on_outline(second, first, deepest(2), place(:, 2))
      overlaps = any(deepest > tolerance)
      point = place(:, maxloc(deepest, dim=1))
      if (all(depth > -tolerance)) inside = 1
      if (all(other_depth > -tolerance)) inside = 2
      if (inside == 0) return
      overlaps = .true.
   end subroutine find_overlap
end module dda_polygon
