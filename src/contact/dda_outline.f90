!> Corners and edges of all blocks, numbered: edge i connects corner i with the next one. Vertices
!> on a straight side are no corners and have no contacts
module dda_outline
   use dda_block_system, only : block_system_t
   use dda_kinds, only : wp
   use dda_sort, only : sorted_order
   use dda_vector, only : along, cross, right_normal
   implicit none
   private

   public :: outline_t, outline_of, measure_edges, corner_view_t, view_corner, is_convex

   !> Topology of the corners: (n_vertex) each
   type :: outline_t
      integer, allocatable :: block(:)     !! Block of the corner
      logical, allocatable :: turns(:)     !! True at corners, false for vertices on a straight side
      !> True for edges between two fixed blocks, which no other block can reach: (n_vertex)
      logical, allocatable :: covered(:)
      integer, allocatable :: next(:)      !! The next corner of the block, counter-clockwise
      integer, allocatable :: previous(:)  !! The previous corner
      !> Unit vector along each edge, once measured: (2, n_vertex)
      real(wp), allocatable :: direction(:, :)
      !> Length of each edge, once measured: (n_vertex) [m]
      real(wp), allocatable :: length(:)
      logical, allocatable :: convex(:)  !! True for blocks without reflex corners: (n_block)
   end type outline_t

   !> Position of a corner relative to an edge
   type :: corner_view_t
      real(wp) :: gap = 0.0_wp        !! Height above the edge's line; negative inside [m]
      real(wp) :: way = 0.0_wp        !! Distance along the edge from its start [m]
      real(wp) :: length = 0.0_wp     !! Length of the edge [m]
      real(wp) :: normal(2) = 0.0_wp  !! Outward unit normal of the edge: (2)
      !> True if the corner points to the edge and would touch it first
      logical :: faces = .false.
   end type corner_view_t

   !> Sine of the angle by which sides of a corner may dip below an edge
   real(wp), parameter :: dip = 0.05_wp
   !> Sine of the bend below which a corner is flat
   real(wp), parameter :: flat = 1.0e-9_wp
   !> Distance between the ends of two coinciding edges, over their length
   real(wp), parameter :: same = 1.0e-9_wp
   !> Largest number of edges compared at one place; with more, blocks overlap and are refused
   integer, parameter :: most_at_place = 16

contains

   !> The outline of a system
   pure type(outline_t) function outline_of(system) result(outline)
      type(block_system_t), intent(in) :: system
      integer :: b, first, last, n, v

      n = size(system%vertex, 2)
      allocate (outline%block(n), outline%next(n), outline%previous(n), outline%turns(n))
      allocate (outline%convex(size(system%first_vertex) - 1))
      do b = 1, size(system%first_vertex) - 1
         first = system%first_vertex(b)
         last = system%first_vertex(b + 1) - 1
         do v = first, last
            outline%block(v) = b
            outline%next(v) = merge(first, v + 1, v == last)
            outline%previous(v) = merge(last, v - 1, v == first)
         end do
         outline%turns(first:last) = [(turns_at(outline, system%vertex, v), v=first, last)]
         call skip_straight(first, last, outline)
         outline%convex(b) = .true.
         do v = first, last
            outline%convex(b) = outline%convex(b) .and. is_convex(outline, system%vertex, v)
         end do
      end do
      call find_covered_edges(system, outline)
   end function outline_of

   !> Find edges that two fixed blocks share, among edges with the same middle
   pure subroutine find_covered_edges(system, outline)
      type(block_system_t), intent(in) :: system
      type(outline_t), intent(inout) :: outline
      integer, allocatable :: edge(:), order(:)
      real(wp), allocatable :: middle(:)
      real(wp) :: tolerance
      integer :: i, k, v

      allocate (outline%covered(size(outline%block)), source=.false.)
      edge = pack([(v, v=1, size(outline%block))], system%equation(outline%block) == 0 &
         & .and. outline%turns)
      ! project on a direction that is unlikely to be normal to a row of blocks
      middle = matmul([1.0_wp, 0.618_wp], system%vertex(:, edge) &
         & + system%vertex(:, outline%next(edge)))
      order = sorted_order(0*edge, middle)
      edge = edge(order)
      middle = middle(order)
      do i = 1, size(edge)
         associate (a => system%vertex(:, edge(i)), b => system%vertex(:, outline%next(edge(i))))
            tolerance = same*norm2(b - a)
            do k = i + 1, min(i + most_at_place, size(edge))
               if (middle(k) - middle(i) > 4.0_wp*tolerance) exit
               if (norm2(b - system%vertex(:, edge(k))) <= tolerance .and. &
                  & norm2(a - system%vertex(:, outline%next(edge(k)))) <= tolerance) &
                  & outline%covered(edge([i, k])) = .true.
            end do
         end associate
      end do
   end subroutine find_covered_edges

   !> True if a vertex of a block is a corner
   pure logical function turns_at(outline, vertex, v)
      type(outline_t), intent(in) :: outline
      real(wp), intent(in) :: vertex(:, :)  !! Vertices: (2, n_vertex) [m]
      integer, intent(in) :: v              !! Number of the vertex
      real(wp) :: before(2), after(2)

      before = vertex(:, v) - vertex(:, outline%previous(v))
      after = vertex(:, outline%next(v)) - vertex(:, v)
      turns_at = abs(cross(before, after)) > flat*norm2(before)*norm2(after) &
         & .or. dot_product(before, after) < 0.0_wp
   end function turns_at

   !> Connect corners directly, skipping vertices on straight sides
   pure subroutine skip_straight(first, last, outline)
      integer, intent(in) :: first  !! First vertex of the block
      integer, intent(in) :: last   !! Its last vertex
      type(outline_t), intent(inout) :: outline
      integer :: v

      ! a block with many small angles keeps all its vertices
      if (count(outline%turns(first:last)) < 3) outline%turns(first:last) = .true.
      do v = first, last
         do while (.not. outline%turns(outline%next(v)))
            outline%next(v) = outline%next(outline%next(v))
         end do
      end do
      do v = last, first, -1
         do while (.not. outline%turns(outline%previous(v)))
            outline%previous(v) = outline%previous(outline%previous(v))
         end do
      end do
   end subroutine skip_straight

   !> Compute direction and length of all edges once
   pure subroutine measure_edges(vertex, outline)
      real(wp), intent(in) :: vertex(:, :)  !! Corners: (2, n_vertex) [m]
      type(outline_t), intent(inout) :: outline  !! The outline, not yet measured
      integer :: e

      allocate (outline%direction(2, size(vertex, 2)), outline%length(size(vertex, 2)))
      do e = 1, size(vertex, 2)
         associate (next => outline%next(e))
            outline%direction(:, e) = along(vertex(:, e), vertex(:, next))
            outline%length(e) = norm2(vertex(:, next) - vertex(:, e))
         end associate
      end do
   end subroutine measure_edges

   !> Position of a corner relative to an edge
   pure type(corner_view_t) function view_corner(outline, vertex, corner, edge, reach) result(view)
      type(outline_t), intent(in) :: outline  !! The outline, measured
      real(wp), intent(in) :: vertex(:, :)
      integer, intent(in) :: corner  !! Number of the corner
      integer, intent(in) :: edge    !! Number of the edge
      real(wp), intent(in) :: reach  !! A corner farther from the line does not face the edge [m]
      real(wp) :: sides(2)

      associate (direction => outline%direction)
         view%length = outline%length(edge)
         view%normal = right_normal(direction(:, edge))
         view%gap = dot_product(view%normal, vertex(:, corner) - vertex(:, edge))
         view%way = dot_product(direction(:, edge), vertex(:, corner) - vertex(:, edge))
         if (abs(view%gap) > reach) return
         sides(1) = -dot_product(view%normal, direction(:, outline%previous(corner)))
         sides(2) = dot_product(view%normal, direction(:, corner))
      end associate
      view%faces = all(sides > -dip) .and. is_convex(outline, vertex, corner)
   end function view_corner

   !> True if a corner is not reflex
   pure logical function is_convex(outline, vertex, corner)
      type(outline_t), intent(in) :: outline
      real(wp), intent(in) :: vertex(:, :)
      integer, intent(in) :: corner
      real(wp) :: before(2), after(2)

      before = vertex(:, corner) - vertex(:, outline%previous(corner))
      after = vertex(:, outline%next(corner)) - vertex(:, corner)
      is_convex = cross(before, after) > 0.0_wp
      if (.not. is_convex) is_convex = cross(before, after) > -flat*norm2(before)*norm2(after)
   end function is_convex
end module dda_outline
