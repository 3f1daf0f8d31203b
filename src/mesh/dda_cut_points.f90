!> Blocks at points, fixed lines and material lines (Shi: dc10, dc11, dc13)
submodule (dda_cutting) dda_cut_points
   use dda_cut_model, only : block_point_t, block_vertices, cut_bolt_t
   use dda_line_model, only : entity_name
   use dda_polygon, only : polygon_distance
   use dda_segment, only : crossing_parameters
   use dda_vector, only : along, area_moments, area_moments_t, right_normal
   implicit none

   !> Depth of a fixed point inside its block, over the size of the model
   real(wp), parameter :: fixed_depth = 0.005_wp

contains

   !> Bounding boxes of all blocks
   module procedure block_boxes
      integer :: b, n

      n = size(cut%area)
      allocate (block_boxes%low(2, n), block_boxes%high(2, n))
      do b = 1, n
         associate (vertex => cut%vertex(:, cut%first_vertex(b):cut%first_vertex(b + 1) - 1))
            block_boxes%low(:, b) = minval(vertex, dim=2)
            block_boxes%high(:, b) = maxval(vertex, dim=2)
         end associate
      end do
   end procedure block_boxes

   !> The block at a point
   module procedure block_around
      real(wp) :: nearest, here
      integer :: b, next_best

      next_best = 0
      block_around = 0
      nearest = cut%scale%merge
      do b = 1, size(cut%area)
         if (any(point < boxes%low(:, b) - cut%scale%merge)) cycle
         if (any(point > boxes%high(:, b) + cut%scale%merge)) cycle
         associate (vertex => cut%vertex(:, cut%first_vertex(b):cut%first_vertex(b + 1) - 1))
            if (contains_point(vertex, point)) then
               if (block_around > 0) then  ! a block with a hole point may surround other blocks
                  if (cut%area(b) > cut%area(block_around)) cycle
               end if
               block_around = b
               cycle
            end if
            here = polygon_distance(vertex, point)
         end associate
         if (here > nearest .or. (next_best > 0 .and. .not. here < nearest)) cycle
         nearest = here
         next_best = b
      end do
      if (block_around == 0) block_around = next_best
   end procedure block_around

   !> Remove the blocks that contain hole points (Shi: dc11)
   module procedure remove_holes
      logical, allocatable :: keep(:)
      integer, allocatable :: number(:), first(:)
      type(boxes_t) :: boxes
      integer :: i, b, n, k

      if (model%of(entity_role%hole)%n == 0) return
      boxes = block_boxes(cut)
      allocate (keep(size(cut%area)), source=.true.)
      do i = 1, model%of(entity_role%hole)%n
         b = block_around(cut, boxes, model%of(entity_role%hole)%place(1:2, i) - cut%scale%origin)
         if (b == 0) call no_block(error, model, entity_role%hole, i)
         if (b == 0) return
         keep(b) = .false.
      end do
      cut%n_removed = count(.not. keep)
      allocate (number(size(keep)), first(count(keep) + 1), source=0)
      n = 0
      first(1) = 1
      do b = 1, size(keep)
         if (.not. keep(b)) cycle
         n = n + 1
         number(b) = n
         k = cut%first_vertex(b + 1) - cut%first_vertex(b)
         cut%vertex(:, first(n):first(n) + k - 1) = block_vertices(cut, b)
         cut%edge_joint(first(n):first(n) + k - 1) = &
            & cut%edge_joint(cut%first_vertex(b):cut%first_vertex(b + 1) - 1)
         first(n + 1) = first(n) + k
      end do
      cut%area = pack(cut%area, keep)
      cut%vertex = cut%vertex(:, :first(n + 1) - 1)
      cut%edge_joint = cut%edge_joint(:first(n + 1) - 1)
      call move_alloc(first, cut%first_vertex)
      n = 0
      do k = 1, size(cut%pair)
         if (any(number(cut%pair(k)%side([1, 3])) == 0)) cycle
         n = n + 1
         cut%pair(n) = cut%pair(k)
         cut%pair(n)%side([1, 3]) = number(cut%pair(k)%side([1, 3]))
      end do
      cut%pair = cut%pair(:n)
   end procedure remove_holes

   !> Assign points and fixed lines to blocks
   module procedure place_points
      type(boxes_t) :: boxes
      type(block_point_t), allocatable :: point(:)
      integer :: n, role

      boxes = block_boxes(cut)
      n = 0
      allocate (point(8))
      do role = entity_role%fix, entity_role%measure
         call add_points(model, role, boxes, cut, point, n, error)
         if (allocated(error)) return
      end do
      cut%point = point(:n)
   end procedure place_points

   !> Add the points of one role with their blocks
   pure subroutine add_points(model, role, boxes, cut, point, n, error)
      type(line_model_t), intent(in) :: model
      integer, intent(in) :: role                                  !! Fix, load or measure
      type(boxes_t), intent(in) :: boxes
      type(cut_model_t), intent(in) :: cut
      type(block_point_t), allocatable, intent(inout) :: point(:)  !! Receives the points
      integer, intent(inout) :: n                                  !! Number of points
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: place(2)
      integer :: b, before, i

      do i = 1, model%of(role)%n
         before = n
         if (role == entity_role%fix) &
            & call add_crossed(model%of(role)%place(:, i), i, boxes, cut, point, n)
         if (n > before) cycle
         place = model%of(role)%place(1:2, i) - cut%scale%origin
         b = block_around(cut, boxes, place)
         if (b == 0) call no_block(error, model, role, i)
         if (b == 0) return
         call append_point(point, n, block_point_t(role, b, i, place))
      end do
   end subroutine add_points

   !> Add a fixed point for each edge that a fixed line crosses, slightly inside the edge's block
   pure subroutine add_crossed(line, source, boxes, cut, point, n)
      real(wp), intent(in) :: line(4)                              !! The fixed line: (4) [m]
      integer, intent(in) :: source                                !! Its number
      type(boxes_t), intent(in) :: boxes
      type(cut_model_t), intent(in) :: cut
      type(block_point_t), allocatable, intent(inout) :: point(:)  !! Receives the points
      integer, intent(inout) :: n
      real(wp) :: segment(4), edge(4), share(2), crossing(2)
      logical :: crossed
      integer :: b, k

      segment = line - [cut%scale%origin, cut%scale%origin]
      do b = 1, size(cut%area)
         if (any(max(segment(1:2), segment(3:4)) < boxes%low(:, b))) cycle
         if (any(min(segment(1:2), segment(3:4)) > boxes%high(:, b))) cycle
         associate (vertex => cut%vertex(:, cut%first_vertex(b):cut%first_vertex(b + 1) - 1))
            do k = 1, size(vertex, 2)
               edge = [vertex(:, k), vertex(:, 1 + mod(k, size(vertex, 2)))]
               call crossing_parameters(edge, segment, share, crossed)
               ! an edge includes its first corner only, so that a line through a corner counts once
               if (.not. crossed .or. share(1) < 0.0_wp .or. share(1) >= 1.0_wp) cycle
               if (share(2) < 0.0_wp .or. share(2) > 1.0_wp) cycle
               crossing = edge(1:2) + share(1)*(edge(3:4) - edge(1:2))
               call append_point(point, n, block_point_t(entity_role%fix, b, source, &
                  & inside_point(vertex, crossing, edge, fixed_depth*cut%scale%size)))
            end do
         end associate
      end do
   end subroutine add_crossed

   !> A point inside a block near one of its edges; the centre of gravity if the block is too thin
   pure function inside_point(vertex, crossing, edge, depth) result(point)
      real(wp), intent(in) :: vertex(:, :)  !! Corners of the block: (2, n) [m]
      real(wp), intent(in) :: crossing(2)   !! Place on the edge: (2) [m]
      real(wp), intent(in) :: edge(4)       !! Ends of the edge: (4) [m]
      real(wp), intent(in) :: depth         !! Required distance from the edge [m]
      real(wp) :: point(2)                  !! The point: (2) [m]
      type(area_moments_t) :: moments
      real(wp) :: inward(2)
      integer :: i

      inward = -right_normal(along(edge(1:2), edge(3:4)))
      do i = 0, 20
         point = crossing + depth*0.5_wp**i*inward
         if (contains_point(vertex, point)) return
      end do
      moments = area_moments(vertex)
      point = moments%centroid
   end function inside_point

   !> Find the blocks of the bolts (Shi: dc14); an end outside all blocks is fixed to the ground
   module procedure place_bolts
      type(boxes_t) :: boxes
      type(cut_bolt_t) :: bolt(model%of(entity_role%bolt)%n)
      integer :: i, n, side

      n = 0
      boxes = block_boxes(cut)
      do i = 1, size(bolt)
         n = n + 1
         associate (drawn => model%of(entity_role%bolt))
            bolt(n)%place = drawn%place(:, i) - [cut%scale%origin, cut%scale%origin]
            bolt(n)%property = drawn%property(:, i)
            bolt(n)%row = drawn%row(i)
         end associate
         do side = 1, 2
            bolt(n)%block(side) = block_around(cut, boxes, bolt(n)%place(2*side - 1:2*side))
         end do
         if (bolt(n)%block(1) /= bolt(n)%block(2)) cycle
         n = n - 1
         cut%n_idle_bolts = cut%n_idle_bolts + 1
      end do
      cut%bolt = bolt(:n)
   end procedure place_bolts

   !> Assign materials to blocks: from the last material line that crosses one of their edges, or
   !> that starts inside and crosses none
   module procedure assign_materials
      type(boxes_t) :: boxes
      type(block_point_t), allocatable :: point(:)
      integer :: i, n, b

      allocate (cut%material(size(cut%area)), source=1)
      boxes = block_boxes(cut)
      allocate (point(8))
      associate (lines => model%of(entity_role%material))
         do i = 1, lines%n
            n = 0
            call add_crossed(lines%place(:, i), i, boxes, cut, point, n)
            call assign_material(point(:n)%block, lines%material(i), cut)
            if (n > 0) cycle
            b = block_around(cut, boxes, lines%place(1:2, i) - cut%scale%origin)
            if (b == 0) call no_block(error, model, entity_role%material, i)
            if (b == 0) return
            call assign_material([b], lines%material(i), cut)
         end do
      end associate
   end procedure assign_materials

   !> Assign a material to blocks and to all pieces of these blocks
   pure subroutine assign_material(block, material, cut)
      integer, intent(in) :: block(:)  !! Numbers of the blocks
      integer, intent(in) :: material  !! Number of the material
      type(cut_model_t), intent(inout) :: cut
      integer :: i

      do i = 1, size(block)
         where (cut%whole == cut%whole(block(i))) cut%material = material
      end do
   end subroutine assign_material

   !> Add a point to a list
   pure subroutine append_point(point, n, new)
      type(block_point_t), allocatable, intent(inout) :: point(:)  !! The list
      integer, intent(inout) :: n
      type(block_point_t), intent(in) :: new

      ! double the capacity
      if (n == size(point)) point = [point, point]
      n = n + 1
      point(n) = new
   end subroutine append_point

   !> Set the error for an entity that is in no block
   pure subroutine no_block(error, model, role, i)
      type(error_t), allocatable, intent(out) :: error
      type(line_model_t), intent(in) :: model
      integer, intent(in) :: role  !! Role of the entity
      integer, intent(in) :: i     !! Its number in its list

      associate (place => model%of(role)%place(:, i))
         call fatal_error(error, "expected a "//trim(entity_name(role))//" inside a block, got " &
            & //"one at "//place_text(place(1:2)) &
            & //" outside all; move it into one or remove it", model%file, model%of(role)%row(i))
      end associate
   end subroutine no_block

end submodule dda_cut_points
