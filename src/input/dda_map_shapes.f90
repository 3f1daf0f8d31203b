!> Shapes of a map of joints: the outline, the surface of the ground, openings
submodule (dda_read_joint_map) dda_map_shapes
   use dda_joint_map, only : arched_opening, horseshoe, opening_t, ring
   use dda_key_groups, only : flag_in, texts_in
   use dda_polygon, only : find_crossing
   use dda_vector, only : area_moments, area_moments_t
   implicit none

contains

   !> The outline
   module procedure take_outline
      character(len=16), allocatable :: side(:)
      character(len=*), parameter :: sides(3) = [character(len=6) :: "left", "right", "bottom"]
      real(wp), allocatable :: box(:), surface(:, :)
      integer :: i, s

      i = findloc(group%name == "outline", .true., dim=1)
      s = findloc(group%name == "slope", .true., dim=1)
      if (i == 0) then
         call group_error(group(1), "expected an &outline in the file, got none; add one " &
            & //"with left, right, bottom and top, or with x and y", error)
         return
      end if
      associate (outline => group(i))
         map%outline_material = whole_in(outline, "material")
         allocate (box, source=[numbers_in(outline, "left"), numbers_in(outline, "right"), &
            & numbers_in(outline, "bottom"), numbers_in(outline, "top")])
         if (size(numbers_in(outline, "x")) > 0) then
            if (size(box) > 0 .or. s > 0) call group_error(outline, "expected either a " &
               & //"polygon or a rectangle, got more than that", error)
            if (.not. allocated(error)) call take_polygon(outline, "x", "y", map%outline, error)
         else if (size(box) /= merge(3, 4, s > 0)) then
            call group_error(outline, "expected left, right and bottom, and top where there " &
               & //"is no &slope, got "//to_text(size(box))//" of them", error)
         else if (s == 0) then
            map%outline = reshape([box(1), box(3), box(2), box(3), box(2), box(4), box(1), &
               & box(4)], [2, 4])
         else
            call take_surface(group(s), box(1), box(2), surface, error)
            if (allocated(error)) return
            map%outline = reshape([box(1), box(3), box(2), box(3), surface(:, &
               & size(surface, 2):1:-1)], [2, size(surface, 2) + 2])
         end if
         if (.not. allocated(error)) call check_polygon(outline, map%outline, error)
         if (allocated(error)) return
         allocate (side, source=texts_in(outline, "fixed"))
         do s = 1, size(side)
            if (all(sides /= side(s))) then
               call group_error(outline, "fixed must be 'left', 'right' or 'bottom', got '" &
                  & //trim(side(s))//"'", error)
               return
            end if
            map%held_side = map%held_side .or. sides == side(s)
         end do
         ! a line so near to the side crosses all blocks along it: corners nearer than twice as much
         ! are merged with the side
         map%hold_depth = number_in(outline, "hold_depth", 0.2_wp*max(1.0e-4_wp, &
            & map%edge_node_ratio)*norm2(maxval(map%outline, 2) - minval(map%outline, 2)))
      end associate
   end procedure take_outline

   !> The surface of the ground from the left side to the right one
   pure subroutine take_surface(group, left, right, surface, error)
      type(key_group_t), intent(in) :: group
      !> The two sides [m]
      real(wp), intent(in) :: left, right
      !> Points from left to right: (2, n) [m]
      real(wp), allocatable, intent(out) :: surface(:, :)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: point(:, :)
      real(wp) :: tangent, rise
      integer :: k, n

      if (size(numbers_in(group, "x")) > 0) then
         call take_points(group, "x", "y", 2, point, error)
         if (allocated(error)) return
      else if (size([numbers_in(group, "foot_x"), numbers_in(group, "foot_y")]) == 2) then
         n = whole_in(group, "benches")
         rise = number_in(group, "bench_height")
         tangent = tan(number_in(group, "face_deg")*degree)
         allocate (point(2, 2*n))
         point(:, 1) = [number_in(group, "foot_x"), number_in(group, "foot_y")]
         do k = 1, n
            if (k > 1) point(:, 2*k - 1) = point(:, 2*k - 2) &
               & + [number_in(group, "bench_width"), 0.0_wp]
            point(:, 2*k) = point(:, 2*k - 1) + [rise/tangent, rise]
         end do
      else
         call group_error(group, "expected x and y, or foot_x and foot_y, got neither", error)
         return
      end if
      n = size(point, 2)
      if (any(point(1, 2:) < point(1, :n - 1)) .or. point(1, 1) < left &
         & .or. point(1, n) > right) then
         call group_error(group, "expected points from left to right between the outline's " &
            & //"sides, got others", error)
         return
      end if
      surface = reshape([left, point(2, 1), point, right, point(2, n)], [2, n + 2])
      if (point(1, n) >= right) surface = surface(:, :n + 1)
      if (point(1, 1) <= left) surface = surface(:, 2:)
   end subroutine take_surface

   !> Points of two lists
   module procedure take_points
      real(wp), allocatable :: x(:), y(:)

      allocate (x, source=numbers_in(group, x_name))
      allocate (y, source=numbers_in(group, y_name))
      if (size(x) /= size(y) .or. size(x) < least) then
         call group_error(group, "expected "//x_name//" and "//y_name//" of one length from " &
            & //to_text(least)//", got "//to_text(size(x))//" and "//to_text(size(y)) &
            & //" numbers", error)
         return
      end if
      point = transpose(reshape([x, y], [size(x), 2]))
   end procedure take_points

   !> A polygon of two lists, anticlockwise whichever way it was given
   module procedure take_polygon
      type(area_moments_t) :: moments

      call take_points(group, x_name, y_name, 3, corner, error)
      if (allocated(error)) return
      moments = area_moments(corner)
      if (moments%area < 0.0_wp) corner = corner(:, size(corner, 2):1:-1)
      call check_polygon(group, corner, error)
   end procedure take_polygon

   !> Whether a polygon is simple and has an area
   pure subroutine check_polygon(group, corner, error)
      type(key_group_t), intent(in) :: group
      real(wp), intent(in) :: corner(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp) :: crossing(2)
      integer :: edge(2)

      moments = area_moments(corner)
      if (.not. moments%area > 0.0_wp) then
         call group_error(group, "expected an outline with an area, got one of " &
            & //to_text(moments%area)//" m2", error)
         return
      end if
      call find_crossing(corner, edge, crossing)
      if (edge(1) > 0) call group_error(group, "expected an outline whose edges do not " &
         & //"meet, got edges "//to_text(edge(1))//" and "//to_text(edge(2))//" that do at (" &
         & //to_text(crossing(1))//", "//to_text(crossing(2))//")", error)
   end subroutine check_polygon

   !> An opening
   module procedure take_opening
      type(opening_t) :: opening
      real(wp) :: at(2), width, wall
      integer :: n

      opening%row = group%row
      opening%material = whole_in(group, "material")
      opening%excavated = flag_in(group, "excavated")
      at = [number_in(group, "x"), number_in(group, "y")]
      width = number_in(group, "width")
      wall = number_in(group, "wall")
      n = whole_in(group, "sides")
      select case (word_in(group, "shape"))
      case ("circle")
         opening%corner = ring(at, [0.5_wp, 0.5_wp]*width, n)
      case ("ellipse")
         opening%corner = ring(at, 0.5_wp*[width, number_in(group, "height", width)], n)
      case ("arch")
         opening%corner = arched_opening(at, width, wall, number_in(group, "rise", 0.5_wp*width), n)
      case ("horseshoe")
         if (wall <= 0.0_wp .or. wall >= 0.99_wp*width) then
            call group_error(group, "expected a horseshoe with a wall above 0 and below the " &
               & //"width, got "//to_text(wall), error)
            return
         end if
         opening%corner = horseshoe(at, 0.5_wp*width, wall, n)
      case default
         call take_polygon(group, "corner_x", "corner_y", opening%corner, error)
      end select
      if (.not. allocated(error)) call check_polygon(group, opening%corner, error)
      if (.not. allocated(error)) map%opening = [map%opening, opening]
   end procedure take_opening

end submodule dda_map_shapes
