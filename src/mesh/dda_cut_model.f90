!> Blocks cut from lines: polygons, materials, actions, common edges; scales of a cut (Shi: dc02),
!> and dropped parts
!>
!> Edges that coincide in part are split, so that they coincide as a whole.
module dda_cut_model
   use dda_kinds, only : wp
   use dda_line_model, only : line_model_t
   use dda_sort, only : sorted_order
   implicit none
   private

   public :: cut_bolt_t, cut_model_t, block_point_t, edge_pair_t, block_vertices
   public :: bond_joint, split_edges
   public :: cut_remark_t, cut_remarks_t, cut_reason, cut_reason_enum, add_remark
   public :: cut_scale_t, cut_scale

   !> Joint material between the pieces of one block
   integer, parameter :: bond_joint = 0

   !> Scales of a cut
   type :: cut_scale_t
      !> Origin of the coordinates, near the model, so that they keep their digits: (2) [m]
      real(wp) :: origin(2) = 0.0_wp
      !> Size w0 of the model: 1.02 times the larger of height/2 and width/2.6 [m]
      real(wp) :: size = 0.0_wp
      real(wp) :: reach = 0.0_wp  !! Distance within which points coincide [m]
      !> Distance within which a crossing is merged with an existing node [m]
      real(wp) :: merge = 0.0_wp
      !> Distance within which an edge is too close to a node of other lines [m]
      real(wp) :: clearance = 0.0_wp
   end type cut_scale_t

   !> Reasons to drop a part of a line
   type :: cut_reason_enum
      integer :: point = 1       !! The line has no length
      integer :: loose_line = 2  !! The line meets fewer than two others
      integer :: loose_edge = 3  !! The part has a free end
      integer :: doubled = 4     !! The part coincides with a part of another line
      integer :: crossing = 5    !! The part crosses another line without a common node
      integer :: too_close = 6   !! The part is too close to a node of other lines
      integer :: flat = 7        !! The lines enclose a block of zero area
   end type cut_reason_enum

   !> Names of the reasons
   type(cut_reason_enum), parameter :: cut_reason = cut_reason_enum()

   !> A part of a line that was dropped
   type :: cut_remark_t
      integer :: line = 0            !! Number of the line
      integer :: reason = 0          !! One of cut_reason
      integer :: other = 0           !! Number of the conflicting line; 0 if there is none
      real(wp) :: place(4) = 0.0_wp  !! Ends of the part relative to the origin of the cut: (4) [m]
   end type cut_remark_t

   !> A list of remarks
   type :: cut_remarks_t
      integer :: n = 0                            !! Number of remarks
      type(cut_remark_t), allocatable :: item(:)  !! The remarks: (n or more)
   end type cut_remarks_t

   !> A point that belongs to a block
   type :: block_point_t
      integer :: kind = 0   !! Role: fix, load or measure
      integer :: block = 0  !! Number of the block
      !> Number of the point, or of the fixed line, among its kind in the file
      integer :: source = 0
      real(wp) :: place(2) = 0.0_wp  !! Coordinates relative to the origin of the cut: (2) [m]
   end type block_point_t

   !> Two edges of two blocks that coincide, wholly or in part
   type :: edge_pair_t
      !> Block and edge on the left of the line as drawn, block and edge on its right: (4)
      integer :: side(4) = 0
      integer :: joint = 0  !! Material of the joint
      !> Ends of the common part, along the first block's edge: (4) [m]
      real(wp) :: place(4) = 0.0_wp
   end type edge_pair_t

   !> A bolt between two blocks
   type :: cut_bolt_t
      integer :: block(2) = 0        !! The blocks, 0 for the ground: (2)
      real(wp) :: place(4) = 0.0_wp  !! Ends relative to the origin of the cut: (4) [m]
      !> Stiffness, strength and prestress, negative if given in the analysis file: (3)
      real(wp) :: property(3) = 0.0_wp
      integer :: row = 0  !! Line of the file
   end type cut_bolt_t

   !> The blocks
   type :: cut_model_t
      !> Scales of the cut; all coordinates here are relative to their origin
      type(cut_scale_t) :: scale
      !> First vertex of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      real(wp), allocatable :: vertex(:, :)  !! Corners, anticlockwise: (2, n_vertex) [m]
      !> Joint material of the edge from each vertex to the next: (n_vertex)
      integer, allocatable :: edge_joint(:)
      real(wp), allocatable :: area(:)     !! Area of each block: (n_block) [m2]
      integer, allocatable :: material(:)  !! Material of each block: (n_block)
      !> Number of the block that represents all pieces of a block with islands: (n_block)
      integer, allocatable :: whole(:)
      !> Fixed points, load points, monitoring points, in this order: (n_point)
      type(block_point_t), allocatable :: point(:)
      type(cut_bolt_t), allocatable :: bolt(:)   !! Bolts: (n_bolt)
      type(edge_pair_t), allocatable :: pair(:)  !! Coincident edges: (n_pair)
      type(cut_remarks_t) :: remarks             !! Dropped parts
      integer :: n_merged = 0  !! Number of crossings merged with an existing node at another place
      integer :: n_idle_bolts = 0  !! Bolts omitted because both ends are in one block
      integer :: n_removed = 0     !! Blocks removed because of hole points
   end type cut_model_t

   !> Corners of split edges
   type :: corners_t
      integer :: n = 0                      !! Number of corners
      real(wp), allocatable :: point(:, :)  !! Coordinates: (2, n or more) [m]
      integer, allocatable :: edge(:)       !! First vertex of the edge of each corner: (n or more)
      real(wp), allocatable :: along(:)     !! Distance from that vertex: (n or more) [m]
   end type corners_t

contains

   !> Scales of a model with at least one line of nonzero length
   pure type(cut_scale_t) function cut_scale(model) result(scale)
      type(line_model_t), intent(in) :: model
      real(wp) :: low(2), high(2), largest
      integer :: i

      associate (place => model%line%place(:, :model%line%n))
         low = minval(min(place(1:2, :), place(3:4, :)), dim=2)
         high = maxval(max(place(1:2, :), place(3:4, :)), dim=2)
      end associate
      scale%size = 1.02_wp*max((high(2) - low(2))/2.0_wp, (high(1) - low(1))/2.6_wp)
      do i = 1, 2
         scale%origin(i) = far_origin(low(i), high(i), scale%size)
      end do
      largest = maxval(max(abs(low), abs(high)))
      scale%reach = max(1.0e-9_wp*scale%size, 4.0_wp*spacing(largest))
      scale%merge = max(1.25_wp*model%edge_node_ratio*scale%size, scale%reach)
      scale%clearance = max(model%edge_node_ratio*scale%size, scale%reach)
   end function cut_scale

   !> Origin of a coordinate: 0 near zero; far from it a power of two near the model, which is
   !> subtracted without round-off
   pure real(wp) function far_origin(low, high, size)
      real(wp), intent(in) :: low   !! Smallest coordinate [m]
      real(wp), intent(in) :: high  !! Largest coordinate [m]
      real(wp), intent(in) :: size  !! Size of the model [m]
      real(wp) :: middle, step

      far_origin = 0.0_wp
      middle = low/2.0_wp + high/2.0_wp
      if (abs(middle) < 8.0_wp*size) return
      step = set_exponent(1.0_wp, exponent(size))
      far_origin = anint(middle/step)*step
   end function far_origin

   !> Add a remark
   pure subroutine add_remark(remarks, line, reason, other, place)
      type(cut_remarks_t), intent(inout) :: remarks
      integer, intent(in) :: line       !! Number of the line
      integer, intent(in) :: reason     !! One of cut_reason
      integer, intent(in) :: other      !! Number of the conflicting line, or 0
      real(wp), intent(in) :: place(4)  !! Ends of the part: (4) [m]

      if (.not. allocated(remarks%item)) allocate (remarks%item(16))
      ! double the capacity
      if (remarks%n == size(remarks%item)) remarks%item = [remarks%item, remarks%item]
      remarks%n = remarks%n + 1
      remarks%item(remarks%n) = cut_remark_t(line, reason, other, place)
   end subroutine add_remark

   !> Corners of one block
   pure function block_vertices(cut, block) result(vertex)
      type(cut_model_t), intent(in) :: cut
      integer, intent(in) :: block           !! Number of the block
      real(wp), allocatable :: vertex(:, :)  !! Its corners, anticlockwise: (2, n) [m]

      allocate (vertex, source=cut%vertex(:, cut%first_vertex(block): &
         & cut%first_vertex(block + 1) - 1))
   end function block_vertices

   !> Split edges at the ends of all joints
   pure subroutine split_edges(cut, split)
      type(cut_model_t), intent(in) :: cut
      !> The blocks with more corners; paired edges have the same ends
      type(cut_model_t), intent(out) :: split
      type(corners_t) :: corners
      integer, allocatable :: start(:)
      integer :: k

      split = cut
      call collect_corners(cut, corners)
      call sort_corners(corners, cut%scale%reach)
      split%vertex = corners%point(:, :corners%n)
      split%edge_joint = cut%edge_joint(corners%edge(:corners%n))
      ! first new edge of each old edge
      allocate (start(size(cut%vertex, 2) + 1))
      start(size(start)) = corners%n + 1
      do k = corners%n, 1, -1
         start(corners%edge(k)) = k
      end do
      split%first_vertex = start(cut%first_vertex)
      do k = 1, size(cut%pair)
         associate (old => cut%pair(k), new => split%pair(k))
            new%side(2) = edge_at(split, start, cut%first_vertex(old%side(1)) + old%side(2) - 1, &
               & old%place(1:2), old%side(1))
            new%side(4) = edge_at(split, start, cut%first_vertex(old%side(3)) + old%side(4) - 1, &
               & old%place(3:4), old%side(3))
         end associate
      end do
   end subroutine split_edges

   !> Collect the present corners and the ends of joints
   pure subroutine collect_corners(cut, corners)
      type(cut_model_t), intent(in) :: cut
      type(corners_t), intent(out) :: corners
      integer :: room, i, k

      corners%n = size(cut%vertex, 2)
      room = corners%n + 4*size(cut%pair)
      allocate (corners%point(2, room), corners%edge(room), corners%along(room))
      corners%along = 0.0_wp
      do i = 1, corners%n
         corners%point(:, i) = cut%vertex(:, i)
         corners%edge(i) = i
      end do
      do k = 1, size(cut%pair)
         associate (pair => cut%pair(k))
            do i = 1, 3, 2
               call add_corner(cut, pair%side(1:2), pair%place(i:i + 1), corners)
               call add_corner(cut, pair%side(3:4), pair%place(i:i + 1), corners)
            end do
         end associate
      end do
   end subroutine collect_corners

   !> Add a corner on an edge, unless it is at one of its ends
   pure subroutine add_corner(cut, side, point, corners)
      type(cut_model_t), intent(in) :: cut
      integer, intent(in) :: side(2)    !! Block and edge: (2)
      real(wp), intent(in) :: point(2)  !! The place: (2) [m]
      type(corners_t), intent(inout) :: corners
      integer :: first, n, at
      real(wp) :: finish(2)

      first = cut%first_vertex(side(1))
      n = cut%first_vertex(side(1) + 1) - first
      at = first + side(2) - 1
      finish = cut%vertex(:, first + mod(side(2), n))
      if (norm2(point - cut%vertex(:, at)) <= cut%scale%reach) return
      if (norm2(point - finish) <= cut%scale%reach) return
      corners%n = corners%n + 1
      corners%point(:, corners%n) = point
      corners%edge(corners%n) = at
      corners%along(corners%n) = norm2(point - cut%vertex(:, at))
   end subroutine add_corner

   !> Sort corners along the outlines of the blocks, without duplicates
   pure subroutine sort_corners(corners, reach)
      type(corners_t), intent(inout) :: corners
      real(wp), intent(in) :: reach  !! Distance within which points coincide [m]
      integer, allocatable :: order(:)
      integer :: k, n

      allocate (order, source=sorted_order(corners%edge(:corners%n), corners%along(:corners%n)))
      corners%point = corners%point(:, order)
      corners%edge = corners%edge(order)
      corners%along = corners%along(order)
      n = 1
      do k = 2, corners%n
         if (corners%edge(k) == corners%edge(n) &
            & .and. corners%along(k) - corners%along(n) <= reach) cycle
         n = n + 1
         corners%point(:, n) = corners%point(:, k)
         corners%edge(n) = corners%edge(k)
         corners%along(n) = corners%along(k)
      end do
      corners%n = n
   end subroutine sort_corners

   !> Number within its block of the new edge that starts at a point of an old edge
   pure integer function edge_at(split, start, old, place, block)
      type(cut_model_t), intent(in) :: split
      !> First new edge of each old one, and one past the last: (n_old + 1)
      integer, intent(in) :: start(:)
      integer, intent(in) :: old        !! The old edge
      real(wp), intent(in) :: place(2)  !! The place: (2) [m]
      integer, intent(in) :: block
      real(wp) :: nearest, here
      integer :: k

      edge_at = 0
      nearest = huge(nearest)
      do k = start(old), start(old + 1) - 1
         here = norm2(split%vertex(:, k) - place)
         if (.not. here < nearest) cycle
         nearest = here
         edge_at = k - split%first_vertex(block) + 1
      end do
   end function edge_at
end module dda_cut_model
