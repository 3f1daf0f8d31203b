!> Joint maps to lines and points for dda cut (Shi: DL)
!>
!> Parts of lines inside the outline and outside the openings are kept.
module dda_map_lines
   use dda_error, only : error_t, fatal_error
   use dda_growth, only : make_room
   use dda_joint_map, only : bolts_t, joint_map_t, joint_set_t, length_t, map_line_t
   use dda_kinds, only : wp
   use dda_line_model, only : add_entity, entity_role, line_model_t
   use dda_polygon, only : contains_point
   use dda_random, only : random_t
   use dda_segment, only : crossing_parameters
   use dda_sort, only : sorted_order
   use dda_text, only : place_text, to_text
   implicit none
   private

   public :: clip_line, draw_covering_length, draw_length, inner_point, joint_count
   public :: map_lines, outlines_cross, ray_exit, set_traces

   !> Maximum number of traces of a map
   integer, parameter :: most_traces = 1000000
   !> Smallest part of a line, over its length
   real(wp), parameter :: least_share = 1.0e-12_wp

   interface

      !> Approximate number of joints of a set across a circle
      pure real(wp) module function joint_count(set, radius)
         type(joint_set_t), intent(in) :: set
         real(wp), intent(in) :: radius  !! Radius of the circle [m]
      end function joint_count

      !> Traces of a set within a circle
      pure module subroutine set_traces(set, centre, radius, trace, n)
         type(joint_set_t), intent(in) :: set
         real(wp), intent(in) :: centre(2)  !! Centre of the circle: (2) [m]
         real(wp), intent(in) :: radius
         !> Columns of ends x1, y1, x2, y2: (4, n or more) [m]
         real(wp), allocatable, intent(out) :: trace(:, :)
         integer, intent(out) :: n  !! Number of traces
      end subroutine set_traces

      !> Random length with a given distribution
      pure module subroutine draw_length(length, random, value)
         type(length_t), intent(in) :: length
         type(random_t), intent(inout) :: random  !! Random numbers
         real(wp), intent(out) :: value           !! The length [m]
      end subroutine draw_length

      !> Random length of the piece that covers a given point; long pieces are more likely. A
      !> position within the piece that is uniformly distributed makes all places of an axis
      !> equivalent, so that means hold in any window
      pure module subroutine draw_covering_length(length, random, value)
         type(length_t), intent(in) :: length
         type(random_t), intent(inout) :: random
         real(wp), intent(out) :: value
      end subroutine draw_covering_length

   end interface

contains

   !> Make the lines and points of a map
   pure subroutine map_lines(map, model, error)
      type(joint_map_t), intent(in) :: map
      type(line_model_t), intent(out) :: model
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the map is invalid
      real(wp) :: inside(2)
      integer :: i

      model%file = map%file
      model%edge_node_ratio = map%edge_node_ratio
      call check_openings(map, error)
      if (allocated(error)) return
      call add_outline(map%outline, map%outline_material, 1, model)
      do i = 1, size(map%opening)
         call add_outline(map%opening(i)%corner, map%opening(i)%material, map%opening(i)%row, model)
         if (.not. map%opening(i)%excavated) cycle
         inside = inner_point(map%opening(i)%corner)
         call add_entity(model%of(entity_role%hole), [inside, inside], 0, map%opening(i)%row)
      end do
      model%n_boundary = model%line%n
      call hold_sides(map, model)
      do i = 1, size(map%set)
         if (.not. allocated(error)) call add_set(map, i, model, error)
      end do
      do i = 1, size(map%line)
         if (.not. allocated(error)) call add_line(map, map%line(i), model, error)
      end do
      do i = 1, size(map%bolts)
         if (.not. allocated(error)) call add_bolts(map, map%bolts(i), model, error)
      end do
   end subroutine map_lines

   !> Check that all openings are separate and inside the outline
   pure subroutine check_openings(map, error)
      type(joint_map_t), intent(in) :: map
      type(error_t), allocatable, intent(out) :: error
      integer :: i, k, j

      do i = 1, size(map%opening)
         associate (corner => map%opening(i)%corner)
            do k = 1, size(corner, 2)
               if (contains_point(map%outline, corner(:, k))) cycle
               call fatal_error(error, "expected an opening inside the outline, got one with a " &
                  & //"corner at "//place_text(corner(:, k)) &
                  & //"; make the outline larger", map%file, map%opening(i)%row)
               return
            end do
            do j = 1, i - 1
               if (.not. outlines_cross(corner, map%opening(j)%corner)) cycle
               call fatal_error(error, "expected openings that lie apart, got one that meets " &
                  & //"opening "//to_text(j)//" of line "//to_text(map%opening(j)%row) &
                  & //"; draw both as one polygon", map%file, map%opening(i)%row)
               return
            end do
         end associate
      end do
   end subroutine check_openings

   !> Add the edges of a polygon as lines
   pure subroutine add_outline(corner, material, row, model)
      real(wp), intent(in) :: corner(:, :)  !! Corners: (2, n) [m]
      integer, intent(in) :: material       !! Number of the joint material
      integer, intent(in) :: row            !! Line of the file
      type(line_model_t), intent(inout) :: model
      integer :: i

      do i = 1, size(corner, 2)
         call add_entity(model%line, [corner(:, i), corner(:, modulo(i, size(corner, 2)) + 1)], &
            & material, row)
      end do
   end subroutine add_outline

   !> Add fixed lines along sides of the outline
   pure subroutine hold_sides(map, model)
      type(joint_map_t), intent(in) :: map
      type(line_model_t), intent(inout) :: model
      real(wp) :: low(2), high(2), side(4, 3)
      integer :: k

      low = minval(map%outline, 2)
      high = maxval(map%outline, 2)
      associate (left => low(1) + map%hold_depth, right => high(1) - map%hold_depth, &
         & bottom => low(2) + map%hold_depth)
         side = reshape([left, low(2), left, high(2), right, low(2), right, high(2), &
            & low(1), bottom, high(1), bottom], [4, 3])
      end associate
      do k = 1, 3
         if (map%held_side(k)) call add_entity(model%of(entity_role%fix), side(:, k), 0, 1)
      end do
   end subroutine hold_sides

   !> Add the traces of a joint set
   pure subroutine add_set(map, i, model, error)
      type(joint_map_t), intent(in) :: map
      integer, intent(in) :: i  !! Number of the set
      type(line_model_t), intent(inout) :: model
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: trace(:, :)
      real(wp) :: centre(2), radius
      integer :: k, n

      centre = 0.5_wp*(minval(map%outline, 2) + maxval(map%outline, 2))
      radius = 0.5_wp*norm2(maxval(map%outline, 2) - minval(map%outline, 2))
      associate (set => map%set(i))
         if (joint_count(set, norm2(centre - set%anchor) + radius) > real(most_traces, wp)) &
            & call fatal_error(error, "expected a set of at most "//to_text(most_traces) &
            & //" traces, got one with more; make the spacing larger", map%file, set%row)
         if (allocated(error)) return
         call set_traces(set, centre, radius, trace, n)
         if (allocated(set%region)) call clip_line(trace, n, set%region, .true.)
         call clip_to_rock(map, trace, n)
         do k = 1, n
            call add_entity(model%line, trace(:, k), set%material, set%row)
         end do
      end associate
   end subroutine add_set

   !> Clip lines to the rock
   pure subroutine clip_to_rock(map, line, n)
      type(joint_map_t), intent(in) :: map
      real(wp), allocatable, intent(inout) :: line(:, :)  !! Columns of ends: (4, n or more) [m]
      integer, intent(inout) :: n  !! Number of lines
      integer :: i

      call clip_line(line, n, map%outline, .true.)
      do i = 1, size(map%opening)
         if (map%opening(i)%excavated) call clip_line(line, n, map%opening(i)%corner, .false.)
      end do
   end subroutine clip_to_rock

   !> Add a line or a point given explicitly
   pure subroutine add_line(map, line, model, error)
      type(joint_map_t), intent(in) :: map
      type(map_line_t), intent(in) :: line
      type(line_model_t), intent(inout) :: model
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: part(:, :)
      integer :: k, n

      select case (line%role)
      case (entity_role%joint)
         allocate (part(4, 1))
         part(:, 1) = line%ends
         n = 1
         call clip_to_rock(map, part, n)
         if (n == 0) call fatal_error(error, "expected a line in the rock inside the outline, " &
            & //"got one outside it", map%file, line%row)
         do k = 1, n
            call add_entity(model%line, part(:, k), line%material, line%row)
         end do
      case (entity_role%bolt)
         call add_entity(model%of(entity_role%bolt), line%ends, 0, line%row, line%bolt)
      case default
         call add_entity(model%of(line%role), line%ends, &
            & merge(line%material, 0, line%role == entity_role%material), line%row)
      end select
   end subroutine add_line

   !> Add the bolts of a pattern
   pure subroutine add_bolts(map, bolts, model, error)
      type(joint_map_t), intent(in) :: map
      type(bolts_t), intent(in) :: bolts
      type(line_model_t), intent(inout) :: model
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: centre(2), head(2), tip(2), along(2), angle
      integer :: i

      associate (corner => map%opening(bolts%opening)%corner)
         centre = 0.5_wp*(minval(corner, 2) + maxval(corner, 2))
         if (.not. contains_point(corner, centre)) centre = inner_point(corner)
         do i = 1, bolts%number
            angle = bolts%fan(1) + (bolts%fan(2) - bolts%fan(1))*real(i - 1, wp) &
               & /real(max(1, bolts%number - 1), wp)
            along = [cos(angle), sin(angle)]
            head = ray_exit(corner, centre, along) + bolts%reach(2)*along
            tip = head + bolts%reach(1)*along
            if (.not. contains_point(map%outline, tip)) call fatal_error(error, &
               & "expected bolts inside the outline, got one that ends at " &
               & //place_text(tip), map%file, bolts%row)
            if (allocated(error)) return
            call add_entity(model%of(entity_role%bolt), [head, tip], 0, bolts%row, &
               & bolts%property)
         end do
      end associate
   end subroutine add_bolts

   !> Clip lines at a polygon
   pure subroutine clip_line(line, n, corner, inside)
      !> Columns of ends, replaced by those of the parts: (4, n or more) [m]
      real(wp), allocatable, intent(inout) :: line(:, :)
      integer, intent(inout) :: n    !! Number of lines
      real(wp), intent(in) :: corner(:, :)
      logical, intent(in) :: inside  !! True to keep the parts inside, false for those outside
      real(wp), allocatable :: part(:, :)
      integer :: i, m

      m = 0
      allocate (part(4, n + 8))
      do i = 1, n
         call clip_one(line(:, i), corner, inside, part, m)
      end do
      call move_alloc(part, line)
      n = m
   end subroutine clip_line

   !> Append the parts of one line
   pure subroutine clip_one(line, corner, inside, part, m)
      real(wp), intent(in) :: line(4)  !! Ends: (4) [m]
      real(wp), intent(in) :: corner(:, :)
      logical, intent(in) :: inside
      !> Receives columns of ends: (4, m or more) [m]
      real(wp), allocatable, intent(inout) :: part(:, :)
      integer, intent(inout) :: m  !! Number of parts
      real(wp), allocatable :: share(:)
      real(wp) :: along(2), start
      integer :: k

      allocate (share, source=crossings(line, corner))
      along = line(3:4) - line(1:2)
      start = -1.0_wp
      do k = 2, size(share)
         if (share(k) - share(k - 1) <= least_share) cycle
         if (contains_point(corner, line(1:2) + 0.5_wp*(share(k - 1) + share(k))*along) &
            & .neqv. inside) then
            start = -1.0_wp
            cycle
         end if
         ! merge the parts on either side of a corner that is only touched
         if (start < 0.0_wp) then
            start = share(k - 1)
            m = m + 1
            call make_room(part, m)
         end if
         part(:, m) = [line(1:2) + start*along, line(1:2) + share(k)*along]
      end do
   end subroutine clip_one

   !> Intersections of a line with a polygon, including the ends of the line
   pure function crossings(line, corner) result(share)
      real(wp), intent(in) :: line(4), corner(:, :)
      !> Positions as shares of the line's length, ascending, 0 first and 1 last: (n)
      real(wp), allocatable :: share(:)
      real(wp) :: place(size(corner, 2) + 2), at(2)
      integer :: i, n
      logical :: crossed

      place(:2) = [0.0_wp, 1.0_wp]
      n = 2
      do i = 1, size(corner, 2)
         call crossing_parameters(line, [corner(:, i), corner(:, modulo(i, size(corner, 2)) + 1)], &
            & at, crossed)
         if (.not. crossed) cycle
         if (at(1) <= 0.0_wp .or. at(1) >= 1.0_wp) cycle
         if (at(2) < -least_share .or. at(2) > 1.0_wp + least_share) cycle
         n = n + 1
         place(n) = at(1)
      end do
      share = place(sorted_order(spread(0, 1, n), place(:n)))
   end function crossings

   !> A point inside a polygon: midway between its first two intersections with a horizontal line
   pure function inner_point(corner) result(point)
      real(wp), intent(in) :: corner(:, :)
      real(wp) :: point(2)  !! The point: (2) [m]
      real(wp), allocatable :: share(:)
      real(wp) :: height(size(corner, 2)), line(4), low(2), high(2)
      integer :: k

      low = minval(corner, 2)
      high = maxval(corner, 2)
      height = corner(2, sorted_order(spread(0, 1, size(corner, 2)), corner(2, :)))
      ! no corner is in the widest strip between the heights of two corners
      k = maxloc(height(2:) - height(:size(height) - 1), 1)
      line = [2.0_wp*low(1) - high(1), 0.5_wp*(height(k) + height(k + 1)), &
         & 2.0_wp*high(1) - low(1), 0.5_wp*(height(k) + height(k + 1))]
      allocate (share, source=crossings(line, corner))
      point = line(1:2) + 0.5_wp*(share(2) + share(3))*(line(3:4) - line(1:2))
   end function inner_point

   !> Last intersection of a ray with a polygon
   pure function ray_exit(corner, origin, direction) result(point)
      real(wp), intent(in) :: corner(:, :)
      real(wp), intent(in) :: origin(2)     !! A point inside: (2) [m]
      real(wp), intent(in) :: direction(2)  !! Unit vector: (2)
      real(wp) :: point(2)
      real(wp) :: reach
      real(wp), allocatable :: share(:)

      reach = 2.0_wp*norm2(maxval(corner, 2) - minval(corner, 2))
      allocate (share, source=crossings([origin, origin + reach*direction], corner))
      point = origin + share(size(share) - 1)*reach*direction
   end function ray_exit

   !> True if two polygons intersect or one contains the other
   pure logical function outlines_cross(one, other)
      real(wp), intent(in) :: one(:, :)    !! Corners: (2, n) [m]
      real(wp), intent(in) :: other(:, :)  !! Corners: (2, n) [m]
      real(wp) :: at(2)
      integer :: i, k
      logical :: crossed

      outlines_cross = .true.
      if (contains_point(one, other(:, 1)) .or. contains_point(other, one(:, 1))) return
      do i = 1, size(one, 2)
         do k = 1, size(other, 2)
            call crossing_parameters([one(:, i), one(:, modulo(i, size(one, 2)) + 1)], &
               & [other(:, k), other(:, modulo(k, size(other, 2)) + 1)], at, crossed)
            if (crossed .and. all(at >= 0.0_wp) .and. all(at <= 1.0_wp)) return
         end do
      end do
      outlines_cross = .false.
   end function outlines_cross
end module dda_map_lines
