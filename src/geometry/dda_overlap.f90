!> Overlap of two polygons beyond a tolerance for rounded coordinates
module dda_overlap
   use dda_box_tree, only : box_tree_t, find_boxes
   use dda_kinds, only : wp
   use dda_polygon, only : depth_in, edge_ends, edges_near, has_tree
   use dda_sort, only : sorted_order
   use dda_vector, only : cross, right_normal
   implicit none
   private

   public :: find_overlap

contains

   !> Test if two polygons overlap by more than a tolerance
   pure subroutine find_overlap(first, second, tolerance, overlaps, inside, point, first_tree, &
      & second_tree, depth)
      real(wp), intent(in) :: first(:, :)   !! Corners of the first, counter-clockwise: (2, n) [m]
      real(wp), intent(in) :: second(:, :)  !! Corners of the second, counter-clockwise: (2, m) [m]
      real(wp), intent(in) :: tolerance     !! The tolerance [m]
      logical, intent(out) :: overlaps      !! True if they overlap
      !> The polygon that lies inside the other: 1, 2 or 0 for neither
      integer, intent(out) :: inside
      real(wp), intent(out) :: point(2)  !! A point inside both: (2) [m]
      !> Tree of the edges of the first, for many edges
      type(box_tree_t), intent(in), optional :: first_tree
      !> Tree of the edges of the second, for many edges
      type(box_tree_t), intent(in), optional :: second_tree
      !> Depth of the overlap: the tolerance that would accept it [m]
      real(wp), intent(out), optional :: depth
      real(wp) :: box(2, 2, 2), common(2, 2), deepest(2), place(2, 2)

      inside = 0
      overlaps = .false.
      point = first(:, 1)
      if (present(depth)) depth = 0.0_wp
      box(:, :, 1) = box_of(first, first_tree)
      box(:, :, 2) = box_of(second, second_tree)
      common(:, 1) = maxval(box(:, 1, :), dim=2)
      common(:, 2) = minval(box(:, 2, :), dim=2)
      if (any(common(:, 2) - common(:, 1) <= tolerance)) return
      if (.not. (has_tree(first_tree) .or. has_tree(second_tree))) then
         if (are_separated(first, second, tolerance)) return
         if (are_separated(second, first, tolerance)) return
      end if
      common(:, 1) = common(:, 1) - tolerance
      common(:, 2) = common(:, 2) + tolerance
      call deepest_on_outline(first, second, common, deepest(1), place(:, 1), first_tree, &
         & second_tree)
      call deepest_on_outline(second, first, common, deepest(2), place(:, 2), second_tree, &
         & first_tree)
      point = place(:, maxloc(deepest, dim=1))
      if (contains_all(second, first, box(:, :, 1), common, tolerance, second_tree)) inside = 1
      if (contains_all(first, second, box(:, :, 2), common, tolerance, first_tree)) inside = 2
      overlaps = any(deepest > tolerance) .or. inside > 0
      if (present(depth)) depth = maxval(deepest)
   end subroutine find_overlap

   !> Bounding box of a polygon
   pure function box_of(vertex, tree) result(box)
      real(wp), intent(in) :: vertex(:, :)  !! Its corners: (2, n) [m]
      type(box_tree_t), intent(in), optional :: tree
      real(wp) :: box(2, 2)                 !! Lower left and upper right corner: (2, 2) [m]

      if (has_tree(tree)) then
         box(:, 1) = tree%low(:, 1)
         box(:, 2) = tree%high(:, 1)
      else
         box(:, 1) = minval(vertex, dim=2)
         box(:, 2) = maxval(vertex, dim=2)
      end if
   end function box_of

   !> True if an edge of one polygon separates it from another, except for a strip of at most the
   !> tolerance
   pure logical function are_separated(one, other, tolerance)
      real(wp), intent(in) :: one(:, :)    !! Corners of the one: (2, n) [m]
      real(wp), intent(in) :: other(:, :)  !! Corners of the other: (2, m) [m]
      real(wp), intent(in) :: tolerance
      real(wp) :: ends(4), normal(2), top, bottom
      integer :: e, i

      are_separated = .false.
      do e = 1, size(one, 2)
         ends = edge_ends(one, e)
         normal = right_normal(ends(3:4) - ends(1:2))
         top = 0.0_wp
         do i = 1, size(one, 2)
            top = max(top, dot_product(normal, one(:, i) - ends(1:2)))
         end do
         bottom = huge(bottom)
         do i = 1, size(other, 2)
            bottom = min(bottom, dot_product(normal, other(:, i) - ends(1:2)))
         end do
         are_separated = top - bottom <= tolerance*norm2(normal)
         if (are_separated) return
      end do
   end function are_separated

   !> True if a polygon contains all corners of another
   pure logical function contains_all(vertex, other, box, common, tolerance, tree)
      real(wp), intent(in) :: vertex(:, :), other(:, :)
      real(wp), intent(in) :: box(2, 2)  !! Bounding box of the other: (2, 2) [m]
      !> Intersection of both boxes, widened by the tolerance: (2, 2) [m]
      real(wp), intent(in) :: common(2, 2)
      real(wp), intent(in) :: tolerance  !! Distance that corners may lie outside [m]
      type(box_tree_t), intent(in), optional :: tree
      integer :: i

      contains_all = all(box(:, 1) >= common(:, 1)) .and. all(box(:, 2) <= common(:, 2))
      do i = 1, size(other, 2)
         if (.not. contains_all) return
         contains_all = depth_in(vertex, other(:, i), tree) > -tolerance
      end do
   end function contains_all

   !> Deepest point of one polygon's outline in another. Candidates are its corners and the middles
   !> of its edges between the lines of near edges
   pure subroutine deepest_on_outline(outline, other, common, deepest, point, tree, other_tree)
      real(wp), intent(in) :: outline(:, :)  !! Corners of the one: (2, n) [m]
      real(wp), intent(in) :: other(:, :)
      !> Search region: lower left and upper right corner: (2, 2) [m]
      real(wp), intent(in) :: common(2, 2)
      real(wp), intent(out) :: deepest  !! Depth of the point, negative outside [m]
      real(wp), intent(out) :: point(2)
      type(box_tree_t), intent(in), optional :: tree
      !> Tree of the edges of the other, for many edges
      type(box_tree_t), intent(in), optional :: other_tree
      integer, allocatable :: edge(:), near(:)
      real(wp), allocatable :: cut(:)
      real(wp) :: ends(4), depth, middle(2)
      integer :: i, j, n, n_edge

      deepest = -huge(deepest)
      point = outline(:, 1)
      if (has_tree(tree)) then
         call find_boxes(tree, common(:, 1), common(:, 2), edge, n_edge)
      else
         n_edge = size(outline, 2)
         allocate (edge(n_edge), source=[(i, i=1, n_edge)])
      end if
      do i = 1, n_edge
         ends = edge_ends(outline, edge(i))
         if (any(max(ends(1:2), ends(3:4)) < common(:, 1))) cycle
         if (any(min(ends(1:2), ends(3:4)) > common(:, 2))) cycle
         call edges_near(other, ends, 0.0_wp, near, n, other_tree)
         call cut_edge(other, ends, near(:n), cut)
         do j = 2, size(cut)
            middle = ends(1:2) + (ends(3:4) - ends(1:2))*(cut(j - 1) + cut(j))/2.0_wp
            if (any(middle < common(:, 1) .or. middle > common(:, 2))) cycle
            depth = depth_in(other, middle, other_tree)
            if (.not. depth > deepest) cycle
            deepest = depth
            point = middle
         end do
      end do
   end subroutine deepest_on_outline

   !> Intersections of an edge with the lines of other edges, as ascending shares of its length; the
   !> last share, 1, occurs twice
   pure subroutine cut_edge(vertex, ends, near, cut)
      real(wp), intent(in) :: vertex(:, :)  !! Corners of the polygon of the other edges: (2, n) [m]
      real(wp), intent(in) :: ends(4)       !! Ends of the edge: (4) [m]
      integer, intent(in) :: near(:)        !! Numbers of the other edges: (n_near)
      real(wp), allocatable, intent(out) :: cut(:)  !! The shares: (n_cut)
      real(wp) :: share(size(near) + 3), other(4), b(2), c(2), area, way
      integer, allocatable :: order(:)
      integer :: i, n

      n = 3
      share(:3) = [0.0_wp, 1.0_wp, 1.0_wp]
      b = ends(3:4) - ends(1:2)
      do i = 1, size(near)
         other = edge_ends(vertex, near(i))
         c = other(3:4) - other(1:2)
         area = cross(b, c)
         way = sign(1.0_wp, area)*cross(other(1:2) - ends(1:2), c)
         if (way <= 0.0_wp .or. way >= abs(area)) cycle
         n = n + 1
         share(n) = way/abs(area)
      end do
      allocate (order(n), cut(n))
      order = sorted_order(spread(0, 1, n), share(:n))
      cut = share(order)
   end subroutine cut_edge
end module dda_overlap
