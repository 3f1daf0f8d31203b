!> Which of many boxes overlap: a balanced tree of boxes over the curve that visits near ones one
!> after the other; n log n whatever their sizes
module dda_box_tree
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_kinds, only : wp
   use dda_sort, only : rising_order
   implicit none
   private

   public :: box_pairs

   !> Steps of the curve along each side
   integer, parameter :: curve_bits = 20
   !> Levels that a tree can have
   integer, parameter :: max_levels = 64

   !> Node i holds nodes 2 i and 2 i + 1; the leaves are the last n_leaf nodes
   type :: box_tree_t
      !> Number of leaves, a power of two
      integer :: n_leaf = 1
      !> Box of each leaf, 0 for none: (n_leaf)
      integer, allocatable :: box(:)
      !> Largest number of a box below each node: (2*n_leaf - 1)
      integer, allocatable :: last(:)
      !> Lower left corners of the nodes: (2, 2*n_leaf - 1) [m]
      real(wp), allocatable :: low(:, :)
      !> Upper right corners: (2, 2*n_leaf - 1) [m]
      real(wp), allocatable :: high(:, :)
   end type box_tree_t

contains

   !> Pairs of boxes of different groups that overlap or touch, sorted
   pure subroutine box_pairs(low, high, group, pair)
      !> Lower left corners: (2, n) [m]
      real(wp), intent(in) :: low(:, :)
      !> Upper right corners: (2, n) [m]
      real(wp), intent(in) :: high(:, :)
      !> Boxes of one group are not compared: (n)
      integer, intent(in) :: group(:)
      !> The pairs, the first smaller than the second: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      type(box_tree_t) :: tree
      integer, allocatable :: found(:, :), wider(:, :)
      integer :: stack(max_levels), top, node, i, j, n

      allocate (found(2, 8*size(group) + 8))
      n = 0
      if (size(group) > 1) call build_tree(low, high, tree)
      do i = 1, merge(size(group), 0, size(group) > 1)
         top = 1
         stack(1) = 1
         do while (top > 0)
            node = stack(top)
            top = top - 1
            if (tree%last(node) <= i) cycle
            if (tree%low(1, node) > high(1, i) .or. tree%low(2, node) > high(2, i)) cycle
            if (tree%high(1, node) < low(1, i) .or. tree%high(2, node) < low(2, i)) cycle
            if (node < tree%n_leaf) then
               stack(top + 1:top + 2) = [2*node + 1, 2*node]
               top = top + 2
               cycle
            end if
            j = tree%box(node - tree%n_leaf + 1)
            if (group(j) == group(i)) cycle
            if (n == size(found, 2)) then
               allocate (wider(2, 2*n))
               wider(:, :n) = found
               call move_alloc(wider, found)
            end if
            n = n + 1
            found(:, n) = [i, j]
         end do
      end do
      call sort_pairs(found(:, :n), size(group), pair)
   end subroutine box_pairs

   !> Put pairs in rising order
   pure subroutine sort_pairs(found, n_box, pair)
      !> The pairs: (2, n_pair)
      integer, intent(in) :: found(:, :)
      !> Number of boxes
      integer, intent(in) :: n_box
      !> The pairs, sorted: (2, n_pair)
      integer, allocatable, intent(out) :: pair(:, :)
      integer(int64) :: key(size(found, 2))

      key = int(found(1, :), int64)*int(n_box + 1, int64) + int(found(2, :), int64)
      allocate (pair(2, size(found, 2)))
      pair = found(:, rising_order(key))
   end subroutine sort_pairs

   !> Leaves in the order of the curve, and above them the boxes that hold them
   pure subroutine build_tree(low, high, tree)
      !> Lower left corners: (2, n), n >= 1 [m]
      real(wp), intent(in) :: low(:, :)
      !> Upper right corners: (2, n) [m]
      real(wp), intent(in) :: high(:, :)
      !> The tree
      type(box_tree_t), intent(out) :: tree
      integer :: order(size(low, 2)), i, n, leaf

      n = size(low, 2)
      do while (tree%n_leaf < n)
         tree%n_leaf = 2*tree%n_leaf
      end do
      allocate (tree%box(tree%n_leaf), source=0)
      allocate (tree%low(2, 2*tree%n_leaf - 1), source=huge(1.0_wp))
      allocate (tree%high(2, 2*tree%n_leaf - 1), source=-huge(1.0_wp))
      allocate (tree%last(2*tree%n_leaf - 1), source=0)
      order = rising_order(curve_places((low + high)/2.0_wp))
      tree%box(:n) = order
      do i = 1, n
         leaf = tree%n_leaf - 1 + i
         tree%last(leaf) = order(i)
         tree%low(:, leaf) = low(:, order(i))
         tree%high(:, leaf) = high(:, order(i))
      end do
      do i = tree%n_leaf - 1, 1, -1
         tree%last(i) = max(tree%last(2*i), tree%last(2*i + 1))
         tree%low(:, i) = min(tree%low(:, 2*i), tree%low(:, 2*i + 1))
         tree%high(:, i) = max(tree%high(:, 2*i), tree%high(:, 2*i + 1))
      end do
   end subroutine build_tree

   !> Places of points on Morton's curve: the bits of x and y taken in turn
   pure function curve_places(point) result(place)
      !> The points: (2, n) [m]
      real(wp), intent(in) :: point(:, :)
      !> Their places: (n)
      integer(int64) :: place(size(point, 2))
      integer(int64) :: cell(2)
      real(wp) :: origin(2), extent
      integer :: bit, i

      origin = minval(point, dim=2)
      extent = maxval(maxval(point, dim=2) - origin)
      place = 0_int64
      if (.not. extent > 0.0_wp) return
      do i = 1, size(place)
         cell = int((point(:, i) - origin)/extent*real(2**curve_bits - 1, wp), int64)
         do bit = 0, curve_bits - 1
            place(i) = ior(place(i), ishft(ibits(cell(1), bit, 1), 2*bit))
            place(i) = ior(place(i), ishft(ibits(cell(2), bit, 1), 2*bit + 1))
         end do
      end do
   end function curve_places
end module dda_box_tree
