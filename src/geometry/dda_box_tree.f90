!> Search for overlapping boxes in a balanced tree, cost n log n for any sizes and positions
module dda_box_tree
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_sort, only : sort_numbers
   implicit none
   private

   public :: box_distance, box_pairs, box_tree_t, boxes_along, find_boxes, least_nearby
   public :: least_values, max_levels, new_box_tree, segment_tree

   !> Maximum number of levels of a tree
   integer, parameter :: max_levels = 64

   !> Node i holds nodes 2 i and 2 i + 1; the leaves are the last n_leaf nodes
   type :: box_tree_t
      integer :: n_leaf = 1                !! Number of leaves, a power of two
      integer, allocatable :: box(:)       !! Box of each leaf, 0 for none: (n_leaf)
      integer, allocatable :: last(:)      !! Largest box number below each node: (2*n_leaf - 1)
      real(wp), allocatable :: low(:, :)   !! Lower left corners of the nodes: (2, 2*n_leaf - 1) [m]
      real(wp), allocatable :: high(:, :)  !! Upper right corners: (2, 2*n_leaf - 1) [m]
      !> Unit normal across the segments below each node, if there are slabs: (2, 2*n_leaf - 1)
      real(wp), allocatable :: normal(:, :)
      !> Bounds of these segments along the normal: (2, 2*n_leaf - 1) [m]
      real(wp), allocatable :: slab(:, :)
   end type box_tree_t

contains

   !> Pairs of boxes of different groups that overlap or touch, sorted. Group 0 may be large, and
   !> its boxes may overlap one another. With segments, pairs whose segments are farther apart than
   !> their margins are omitted: long inclined edges have many overlapping boxes
   pure subroutine box_pairs(low, high, group, pair, segment, margin)
      real(wp), intent(in) :: low(:, :)   !! Lower left corners: (2, n) [m]
      real(wp), intent(in) :: high(:, :)  !! Upper right corners: (2, n) [m]
      integer, intent(in) :: group(:)     !! Group of each box; pairs within one are omitted: (n)
      !> The pairs, the smaller number first: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      real(wp), intent(in), optional :: segment(:, :)  !! Ends x1, y1, x2, y2: (4, n) [m]
      !> Distance from each segment to the sides of its box: (n) [m]
      real(wp), intent(in), optional :: margin(:)
      type(box_tree_t) :: tree
      integer, allocatable :: found(:, :), wider(:, :), near(:), other_last(:), wanted_last(:, :)
      integer :: i, k, n, n_near

      allocate (found(2, 8*size(group) + 8))
      n = 0
      if (size(group) > 1) then
         call new_box_tree(low, high, tree)
         call last_numbers(tree, group /= 0, other_last)
         wanted_last = reshape([other_last, tree%last], [size(tree%last), 2])
         if (present(segment)) call add_slabs(segment, margin, tree)
      end if
      do i = 1, merge(size(group), 0, size(group) > 1)
         associate (last => wanted_last(:, merge(1, 2, group(i) == 0)))
            if (present(segment)) then
               call find_boxes(tree, low(:, i), high(:, i), near, n_near, i, last, &
                  & segment(:, i), margin(i))
            else
               call find_boxes(tree, low(:, i), high(:, i), near, n_near, i, last)
            end if
         end associate
         call sort_numbers(near(:n_near))
         if (n + n_near > size(found, 2)) then
            allocate (wider(2, 2*n + n_near))
            wider(:, :n) = found(:, :n)
            call move_alloc(wider, found)
         end if
         do k = 1, n_near
            if (group(near(k)) == group(i)) cycle
            n = n + 1
            found(:, n) = [i, near(k)]
         end do
      end do
      pair = found(:, :n)
   end subroutine box_pairs

   !> Find boxes that overlap or touch a given box, or meet a segment
   pure subroutine find_boxes(tree, low, high, found, n, above, last, segment, margin)
      type(box_tree_t), intent(in) :: tree
      real(wp), intent(in) :: low(2)   !! Lower left corner of the given box: (2) [m]
      real(wp), intent(in) :: high(2)  !! Upper right corner: (2) [m]
      !> Numbers of the boxes in the first n entries; reused storage
      integer, allocatable, intent(inout) :: found(:)
      integer, intent(out) :: n               !! Number of boxes found
      integer, intent(in), optional :: above  !! Only boxes with a number above this one
      !> Largest number below each node of the boxes to be searched; all boxes if absent: (2*n_leaf
      !> - 1)
      integer, intent(in), optional :: last(:)
      !> Only boxes that meet this segment inside the given box: (4) [m]
      real(wp), intent(in), optional :: segment(4)
      real(wp), intent(in), optional :: margin  !! Largest distance from the segment [m]
      real(wp) :: wide
      integer :: stack(max_levels), top, node, least

      least = 0
      if (present(above)) least = above
      wide = 0.0_wp
      if (present(margin)) wide = margin
      call make_room(found, 1)
      n = 0
      top = 1
      stack(1) = 1
      do while (top > 0)
         node = stack(top)
         top = top - 1
         if (tree%last(node) <= least) cycle
         if (present(last)) then
            if (last(node) <= least) cycle
         end if
         if (tree%low(1, node) > high(1) .or. tree%low(2, node) > high(2)) cycle
         if (tree%high(1, node) < low(1) .or. tree%high(2, node) < low(2)) cycle
         if (present(segment)) then
            if (allocated(tree%slab)) then
               if (.not. meets_slab(tree, node, segment, wide)) cycle
            end if
            if (.not. meets_line(tree%low(1:2, node) - wide, tree%high(1:2, node) + wide, &
               & segment)) cycle
         end if
         if (node < tree%n_leaf) then
            stack(top + 1:top + 2) = [2*node + 1, 2*node]
            top = top + 2
            cycle
         end if
         call make_room(found, n + 1)
         n = n + 1
         found(n) = tree%box(node - tree%n_leaf + 1)
      end do
   end subroutine find_boxes

   !> Reduce a value to the least one of the boxes that overlap or touch a given box
   pure subroutine least_nearby(tree, least, low, high, value)
      type(box_tree_t), intent(in) :: tree
      real(wp), intent(in) :: least(:)  !! Least value below each node: (2*n_leaf - 1)
      real(wp), intent(in) :: low(2), high(2)
      real(wp), intent(inout) :: value  !! An upper bound on entry, the least value on return
      integer :: stack(max_levels), top, node

      top = 1
      stack(1) = 1
      do while (top > 0)
         node = stack(top)
         top = top - 1
         if (least(node) >= value) cycle
         if (any(tree%low(:, node) > high .or. tree%high(:, node) < low)) cycle
         if (node < tree%n_leaf) then
            stack(top + 1:top + 2) = [2*node + 1, 2*node]
            top = top + 2
         else
            value = least(node)
         end if
      end do
   end subroutine least_nearby

   !> Least value of the boxes below each node; huge if there are none
   pure subroutine least_values(tree, value, least)
      type(box_tree_t), intent(in) :: tree
      real(wp), intent(in) :: value(:)                !! Value of each box: (n)
      real(wp), allocatable, intent(out) :: least(:)  !! The least values: (2*n_leaf - 1)
      integer :: i

      allocate (least(2*tree%n_leaf - 1), source=huge(1.0_wp))
      do i = 1, tree%n_leaf
         if (tree%box(i) > 0) least(tree%n_leaf - 1 + i) = value(tree%box(i))
      end do
      do i = tree%n_leaf - 1, 1, -1
         least(i) = min(least(2*i), least(2*i + 1))
      end do
   end subroutine least_values

   !> Boxes that meet a segment (or a point if both ends coincide), ascending
   pure function boxes_along(tree, segment) result(box)
      type(box_tree_t), intent(in) :: tree
      real(wp), intent(in) :: segment(4)  !! Ends of the segment: (4) [m]
      integer, allocatable :: box(:)      !! Numbers of the boxes: (n)
      integer, allocatable :: found(:)
      integer :: n

      call find_boxes(tree, min(segment(1:2), segment(3:4)), max(segment(1:2), segment(3:4)), &
         & found, n, segment=segment)
      allocate (box(n))
      if (n > 0) box = found(:n)
      call sort_numbers(box)
   end function boxes_along

   !> Distance of a point from the box of a node; huge for an empty node [m]
   pure real(wp) function box_distance(tree, node, point)
      type(box_tree_t), intent(in) :: tree
      integer, intent(in) :: node       !! Number of the node
      real(wp), intent(in) :: point(2)  !! The point: (2) [m]

      box_distance = huge(box_distance)
      if (tree%last(node) > 0) box_distance = &
         & norm2(max(tree%low(:, node) - point, point - tree%high(:, node), 0.0_wp))
   end function box_distance

   !> True if the line of a segment meets a box within round-off
   pure logical function meets_line(low, high, segment)
      real(wp), intent(in) :: low(2), high(2), segment(4)
      real(wp) :: along(2), arm(2), half(2), room

      along = segment(3:4) - segment(1:2)
      arm = (low + high)/2.0_wp - segment(1:2)
      half = (high - low)/2.0_wp
      room = abs(along(1))*half(2) + abs(along(2))*half(1)
      room = room + 64.0_wp*epsilon(room)*(abs(along(1)*arm(2)) + abs(along(2)*arm(1)))
      meets_line = abs(along(1)*arm(2) - along(2)*arm(1)) <= room
   end function meets_line

   !> True if a segment is within a margin, or round-off, of the slab of a node
   pure logical function meets_slab(tree, node, segment, margin)
      type(box_tree_t), intent(in) :: tree
      integer, intent(in) :: node
      real(wp), intent(in) :: segment(4), margin
      real(wp) :: height(2), room

      associate (normal => tree%normal(:, node), slab => tree%slab(:, node))
         height = [dot_product(normal, segment(1:2)), dot_product(normal, segment(3:4))]
         room = margin + 64.0_wp*epsilon(room)*(abs(slab(1)) + abs(slab(2)) + sum(abs(segment)))
         meets_slab = minval(height) <= slab(2) + room .and. maxval(height) >= slab(1) - room
      end associate
   end function meets_slab

   !> Add slabs around the segments below each node, across their mean direction
   pure subroutine add_slabs(segment, margin, tree)
      real(wp), intent(in) :: segment(:, :), margin(:)
      type(box_tree_t), intent(inout) :: tree
      real(wp) :: along(2, 2*tree%n_leaf - 1), height(2), length
      integer :: i, leaf, node

      along = 0.0_wp
      do i = 1, tree%n_leaf
         if (tree%box(i) == 0) cycle
         along(:, tree%n_leaf - 1 + i) = segment(3:4, tree%box(i)) - segment(1:2, tree%box(i))
      end do
      do node = tree%n_leaf - 1, 1, -1
         ! segments are undirected
         associate (first => along(:, 2*node), second => along(:, 2*node + 1))
            along(:, node) = first + sign(1.0_wp, dot_product(first, second))*second
         end associate
      end do
      allocate (tree%normal(2, 2*tree%n_leaf - 1), source=0.0_wp)
      allocate (tree%slab(2, 2*tree%n_leaf - 1), source=0.0_wp)
      tree%slab(1, :) = huge(1.0_wp)
      tree%slab(2, :) = -huge(1.0_wp)
      do node = 1, 2*tree%n_leaf - 1
         length = norm2(along(:, node))
         if (length > 0.0_wp) tree%normal(:, node) = [along(2, node), -along(1, node)]/length
      end do
      do leaf = 1, tree%n_leaf
         if (tree%box(leaf) == 0) cycle
         node = tree%n_leaf - 1 + leaf
         do while (node > 0)
            associate (item => tree%box(leaf), normal => tree%normal(:, node))
               height = [dot_product(normal, segment(1:2, item)), &
                  & dot_product(normal, segment(3:4, item))]
               tree%slab(1, node) = min(tree%slab(1, node), minval(height) - margin(item))
               tree%slab(2, node) = max(tree%slab(2, node), maxval(height) + margin(item))
            end associate
            node = node/2
         end do
      end do
   end subroutine add_slabs

   !> Build a tree of segments, each in its bounding box
   pure subroutine segment_tree(segment, tree)
      real(wp), intent(in) :: segment(:, :)  !! Ends x1, y1, x2, y2: (4, n) [m]
      type(box_tree_t), intent(out) :: tree

      call new_box_tree(min(segment(1:2, :), segment(3:4, :)), &
         & max(segment(1:2, :), segment(3:4, :)), tree)
   end subroutine segment_tree

   !> Build a tree of boxes: each node is divided across its longer side into equal halves
   pure subroutine new_box_tree(low, high, tree)
      real(wp), intent(in) :: low(:, :)  !! Lower left corners: (2, n) [m]
      real(wp), intent(in) :: high(:, :)
      type(box_tree_t), intent(out) :: tree
      real(wp), allocatable :: centre(:, :)
      integer, allocatable :: item(:)
      integer :: i

      do while (tree%n_leaf < size(low, 2))
         tree%n_leaf = 2*tree%n_leaf
      end do
      allocate (tree%box(tree%n_leaf), source=0)
      allocate (tree%low(2, 2*tree%n_leaf - 1), source=huge(1.0_wp))
      allocate (tree%high(2, 2*tree%n_leaf - 1), source=-huge(1.0_wp))
      allocate (centre(2, size(low, 2)), item(size(low, 2)))
      centre = low/2.0_wp + high/2.0_wp
      item = [(i, i=1, size(item))]
      call fill_leaves(centre, item, 1, tree)
      do i = 1, tree%n_leaf
         if (tree%box(i) == 0) cycle
         associate (leaf => tree%n_leaf - 1 + i, box => tree%box(i))
            tree%low(:, leaf) = low(:, box)
            tree%high(:, leaf) = high(:, box)
         end associate
      end do
      do i = tree%n_leaf - 1, 1, -1
         tree%low(:, i) = min(tree%low(:, 2*i), tree%low(:, 2*i + 1))
         tree%high(:, i) = max(tree%high(:, 2*i), tree%high(:, 2*i + 1))
      end do
      call last_numbers(tree, [(.true., i=1, size(item))], tree%last)
   end subroutine new_box_tree

   !> Largest number below each node of the selected boxes; 0 if there is none
   pure subroutine last_numbers(tree, counts, last)
      type(box_tree_t), intent(in) :: tree
      logical, intent(in) :: counts(:)              !! True for selected boxes: (n)
      integer, allocatable, intent(out) :: last(:)  !! The numbers: (2*n_leaf - 1)
      integer :: i

      allocate (last(2*tree%n_leaf - 1), source=0)
      do i = 1, tree%n_leaf
         if (tree%box(i) == 0) cycle
         if (counts(tree%box(i))) last(tree%n_leaf - 1 + i) = tree%box(i)
      end do
      do i = tree%n_leaf - 1, 1, -1
         last(i) = max(last(2*i), last(2*i + 1))
      end do
   end subroutine last_numbers

   !> Assign boxes to the leaves below a node
   pure recursive subroutine fill_leaves(centre, item, node, tree)
      real(wp), intent(inout) :: centre(:, :)  !! Centres of the boxes, reordered here: (2, n) [m]
      integer, intent(inout) :: item(:)        !! Numbers of the boxes in the same order: (n)
      integer, intent(in) :: node              !! The node; it has at least n leaves
      type(box_tree_t), intent(inout) :: tree
      integer :: axis, half

      if (size(item) == 0) return
      if (node >= tree%n_leaf) then
         tree%box(node - tree%n_leaf + 1) = item(1)
         return
      end if
      half = (size(item) + 1)/2
      axis = merge(1, 2, maxval(centre(1, :)) - minval(centre(1, :)) &
         & >= maxval(centre(2, :)) - minval(centre(2, :)))
      call partition(centre, item, axis, half)
      call fill_leaves(centre(:, :half), item(:half), 2*node, tree)
      call fill_leaves(centre(:, half + 1:), item(half + 1:), 2*node + 1, tree)
   end subroutine fill_leaves

   !> Move the n boxes with the smallest coordinates to the front (Hoare 1961). The pivot is chosen
   !> at random, so that no order of the input is a bad one
   pure subroutine partition(centre, item, axis, n)
      real(wp), intent(inout) :: centre(:, :)  !! Centres of the boxes: (2, :) [m]
      integer, intent(inout) :: item(:)
      integer, intent(in) :: axis  !! Axis of the coordinate, 1 or 2
      integer, intent(in) :: n     !! Number of boxes to move
      real(wp) :: kept(2), middle
      integer(int64) :: lot
      integer :: first, last, i, j

      lot = 20080301_int64
      first = 1
      last = size(item)
      do while (first < last)
         lot = modulo(48271_int64*lot, 2147483647_int64)
         middle = centre(axis, first + int(modulo(lot, int(last - first + 1, int64))))
         i = first
         j = last
         do
            do while (centre(axis, i) < middle)
               i = i + 1
            end do
            do while (centre(axis, j) > middle)
               j = j - 1
            end do
            if (i <= j) then
               kept = centre(:, i)
               centre(:, i) = centre(:, j)
               centre(:, j) = kept
               item([i, j]) = item([j, i])
               i = i + 1
               j = j - 1
            end if
            if (i > j) exit
         end do
         if (n <= j) then
            last = j
         else if (n >= i) then
            first = i
         else
            exit
         end if
      end do
   end subroutine partition
end module dda_box_tree
