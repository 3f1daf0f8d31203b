!> Reading of a joint map, the deck of `dda lines`: outline, ground surface, openings, sets, points
module dda_read_joint_map
   use dda_error, only : error_t
   use dda_joint_map, only : arched_opening, bolts_t, horseshoe, joint_map_t, joint_set_t, &
      & length_law, length_t, map_line_t, opening_t, ring
   use dda_key_entry, only : group_error, key_group_t, read_groups
   use dda_key_value, only : deck_value_t
   use dda_kinds, only : degree, wp
   use dda_line_model, only : role_name
   use dda_map_keys, only : map_group, map_key
   use dda_map_names, only : bolts_from_deg, bolts_inset, bolts_length, bolts_number, &
      & bolts_opening, bolts_prestress, bolts_stiffness, bolts_to_deg, joint_set_bridge, &
      & joint_set_bridge_randomness, joint_set_dip_deg, joint_set_dip_spread_deg, &
      & joint_set_material, joint_set_region_x, joint_set_region_y, joint_set_seed, &
      & joint_set_spacing, joint_set_spacing_randomness, joint_set_through_x, &
      & joint_set_through_y, joint_set_trace, joint_set_trace_randomness, line_material, &
      & line_prestress, line_role, line_stiffness, line_x, line_y, lines_edge_node_ratio, &
      & lines_form, lines_seed, opening_corner_x, opening_corner_y, opening_excavated, &
      & opening_height, opening_material, opening_rise, opening_shape, opening_sides, &
      & opening_wall, opening_width, opening_x, opening_y, outline_fixed, outline_hold_depth, &
      & outline_left, outline_material, outline_top, outline_x, outline_y, point_role, point_x, &
      & point_y, slope_bench_height, slope_bench_width, slope_benches, slope_face_deg, &
      & slope_foot_x, slope_foot_y, slope_x, slope_y
   use dda_polygon, only : find_crossing
   use dda_text, only : lower_case, place_text, short_text, to_text
   use dda_text_file, only : read_text_file
   use dda_vector, only : area_moments, area_moments_t
   implicit none
   private

   public :: parse_joint_map, read_joint_map

contains

   !> Read a file
   subroutine read_joint_map(file, map, is_ddaml, error)
      character(len=*), intent(in) :: file  !! Name of the file
      type(joint_map_t), intent(out) :: map
      logical, intent(out) :: is_ddaml      !! True to write lines in DDAML
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      is_ddaml = .false.
      call read_text_file(file, text, error)
      if (.not. allocated(error)) call parse_joint_map(text, file, map, is_ddaml, error)
   end subroutine read_joint_map

   !> Read a text
   pure subroutine parse_joint_map(text, file, map, is_ddaml, error)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: file  !! Name for messages
      type(joint_map_t), intent(out) :: map
      logical, intent(out) :: is_ddaml
      type(error_t), allocatable, intent(out) :: error
      type(key_group_t), allocatable :: group(:)
      integer :: i, seed

      is_ddaml = .false.
      map%file = file
      seed = 1
      allocate (map%set(0), map%opening(0), map%line(0), map%bolts(0))
      map%edge_node_ratio = 1.0e-3_wp
      call read_groups(text, file, map_group, map_key, "lines", group, error)
      if (allocated(error)) return
      do i = 1, size(group)
         if (group(i)%name == "lines") then
            seed = nint(group(i)%value(lines_seed)%number)
            map%edge_node_ratio = group(i)%value(lines_edge_node_ratio)%number
            is_ddaml = group(i)%value(lines_form)%text == "ddaml"
         end if
         if (any(group(i)%name == [character(len=7) :: "lines", "outline", "slope"]) &
            & .and. any(group(:i - 1)%name == group(i)%name)) then
            call group_error(group(i), "expected once in the file, got it twice", error)
            exit
         end if
      end do
      if (.not. allocated(error)) call take_outline(group, map, error)
      do i = 1, size(group)
         if (allocated(error)) exit
         select case (group(i)%name)
         case ("opening")
            call take_opening(group(i), map, error)
         case ("joint_set")
            call take_set(group(i), seed, map, error)
         case ("line", "point")
            call take_lines(group(i), map, error)
         case ("bolts")
            call take_bolts(group(i), map)
         end select
      end do
      if (.not. allocated(error)) call check_bolts(group, map, error)
      if (allocated(error)) error%file = file
   end subroutine parse_joint_map

   !> Read a set of joints
   pure subroutine take_set(group, seed, map, error)
      type(key_group_t), intent(in) :: group
      integer, intent(in) :: seed  !! Seed of the map
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
      type(joint_set_t) :: set

      set%row = group%row
      set%dip = group%value(joint_set_dip_deg)%number*degree
      set%dip_spread = group%value(joint_set_dip_spread_deg)%number*degree
      set%spacing = length_of(group%value(joint_set_spacing:joint_set_spacing_randomness))
      set%trace = length_of(group%value(joint_set_trace:joint_set_trace_randomness))
      set%bridge = length_of(group%value(joint_set_bridge:joint_set_bridge_randomness))
      set%material = nint(group%value(joint_set_material)%number)
      set%seed = [seed, size(map%set) + 1]
      if (group%value(joint_set_seed)%given) &
         & set%seed(2) = nint(group%value(joint_set_seed)%number)
      associate (through => group%value(joint_set_through_x:joint_set_through_y))
         if (count(through%given) == 1) call group_error(group, &
            & "expected both through_x and through_y, got one", error)
         set%anchored = all(through%given)
         if (set%anchored) set%anchor = through%number
      end associate
      if (.not. allocated(error) .and. group%value(joint_set_region_x)%given) &
         & call take_polygon(group, joint_set_region_x, joint_set_region_y, set%region, error)
      if (.not. allocated(error)) map%set = [map%set, set]
   end subroutine take_set

   !> Make a length with its distribution
   pure type(length_t) function length_of(value)
      type(deck_value_t), intent(in) :: value(3)  !! Mean, distribution and randomness

      length_of%mean = value(1)%number
      length_of%randomness = value(3)%number
      select case (value(2)%text)
      case ("uniform")
         length_of%law = length_law%uniform
      case ("exponential")
         length_of%law = length_law%exponential
      case ("normal")
         length_of%law = length_law%normal
      end select
   end function length_of

   !> Read lines or points given explicitly
   pure subroutine take_lines(group, map, error)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
      type(map_line_t) :: line
      real(wp), allocatable :: point(:, :)
      logical :: is_line
      integer :: i, role

      is_line = group%name == "line"
      if (is_line) call take_points(group, line_x, line_y, 2, point, error)
      if (.not. is_line) call take_points(group, point_x, point_y, 1, point, error)
      if (allocated(error)) return
      role = merge(line_role, point_role, is_line)
      line%row = group%row
      line%role = findloc(role_name == group%value(role)%text, .true., dim=1)
      if (is_line) then
         line%material = nint(group%value(line_material)%number)
         line%bolt = group%value(line_stiffness:line_prestress)%number
      end if
      do i = 1, size(point, 2) - merge(1, 0, is_line)
         line%ends = [point(:, i), point(:, merge(i + 1, i, is_line))]
         map%line = [map%line, line]
      end do
   end subroutine take_lines

   !> Read bolts around an opening
   pure subroutine take_bolts(group, map)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(bolts_t) :: bolts

      bolts%row = group%row
      bolts%opening = nint(group%value(bolts_opening)%number)
      bolts%number = nint(group%value(bolts_number)%number)
      bolts%fan = degree*group%value(bolts_from_deg:bolts_to_deg)%number
      bolts%reach = group%value(bolts_length:bolts_inset)%number
      bolts%property = group%value(bolts_stiffness:bolts_prestress)%number
      map%bolts = [map%bolts, bolts]
   end subroutine take_bolts

   !> Check that the openings of all bolts exist
   pure subroutine check_bolts(group, map, error)
      type(key_group_t), intent(in) :: group(:)  !! All groups
      type(joint_map_t), intent(in) :: map
      type(error_t), allocatable, intent(out) :: error
      integer :: i, opening

      do i = 1, size(group)
         if (group(i)%name /= "bolts") cycle
         opening = nint(group(i)%value(bolts_opening)%number)
         if (opening <= size(map%opening)) cycle
         call group_error(group(i), "expected the number of an opening up to " &
            & //to_text(size(map%opening))//", got "//to_text(opening), error)
         return
      end do
   end subroutine check_bolts

   !> Read the outline: a polygon, a rectangle, or the ground below a slope
   pure subroutine take_outline(group, map, error)
      type(key_group_t), intent(in) :: group(:)
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid outline
      character(len=:), allocatable :: side
      character(len=*), parameter :: sides(3) = [character(len=6) :: "left", "right", "bottom"]
      real(wp), allocatable :: box(:), surface(:, :)
      integer :: i, s

      i = findloc(group%name == "outline", .true., dim=1)
      s = findloc(group%name == "slope", .true., dim=1)
      if (i == 0) call group_error(group(1), &
         & "expected an &outline in the file, got none; add one " &
         & //"with left, right, bottom and top, or with x and y", error)
      if (allocated(error)) return
      associate (outline => group(i))
         map%outline_material = nint(outline%value(outline_material)%number)
         associate (side => outline%value(outline_left:outline_top))
            box = pack(side%number, side%given)
         end associate
         if (outline%value(outline_x)%given) then
            if (size(box) > 0 .or. s > 0) call group_error(outline, "expected either a " &
               & //"polygon or a rectangle, got more than that", error)
            if (.not. allocated(error)) &
               & call take_polygon(outline, outline_x, outline_y, map%outline, error)
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
         do s = 1, size(outline%value(outline_fixed)%texts)
            side = lower_case(trim(outline%value(outline_fixed)%texts(s)))
            if (all(sides /= side)) call group_error(outline, &
               & "fixed must be 'left', 'right' or 'bottom', got '"//side//"'", error)
            if (allocated(error)) return
            map%held_side = map%held_side .or. sides == side
         end do
         ! a line this close to the side crosses all blocks along it: corners within twice this
         ! distance are merged with the side
         map%hold_depth = 0.2_wp*max(1.0e-4_wp, map%edge_node_ratio) &
            & *norm2(maxval(map%outline, 2) - minval(map%outline, 2))
         if (outline%value(outline_hold_depth)%given) &
            & map%hold_depth = outline%value(outline_hold_depth)%number
      end associate
   end subroutine take_outline

   !> Read the ground surface from the left side to the right side
   pure subroutine take_surface(group, left, right, surface, error)
      type(key_group_t), intent(in) :: group
      real(wp), intent(in) :: left, right                  !! Abscissae of the two sides [m]
      real(wp), allocatable, intent(out) :: surface(:, :)  !! Points from left to right: (2, n) [m]
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: point(:, :)
      real(wp) :: tangent, rise
      integer :: k, n

      if (group%value(slope_x)%given) then
         call take_points(group, slope_x, slope_y, 2, point, error)
         if (allocated(error)) return
      else if (all(group%value(slope_foot_x:slope_foot_y)%given)) then
         n = nint(group%value(slope_benches)%number)
         rise = group%value(slope_bench_height)%number
         tangent = tan(group%value(slope_face_deg)%number*degree)
         allocate (point(2, 2*n))
         point(:, 1) = group%value(slope_foot_x:slope_foot_y)%number
         do k = 1, n
            if (k > 1) point(:, 2*k - 1) = point(:, 2*k - 2) &
               & + [group%value(slope_bench_width)%number, 0.0_wp]
            point(:, 2*k) = point(:, 2*k - 1) + [rise/tangent, rise]
         end do
      else
         call group_error(group, "expected x and y, or foot_x and foot_y, got neither", error)
         return
      end if
      n = size(point, 2)
      if (any(point(1, 2:) < point(1, :n - 1)) .or. point(1, 1) < left .or. point(1, n) > right) &
         & call group_error(group, "expected points from left to right between the outline's " &
         & //"sides, got others", error)
      if (allocated(error)) return
      surface = reshape([left, point(2, 1), point, right, point(2, n)], [2, n + 2])
      if (point(1, n) >= right) surface = surface(:, :n + 1)
      if (point(1, 1) <= left) surface = surface(:, 2:)
   end subroutine take_surface

   !> Read points from two lists
   pure subroutine take_points(group, x_key, y_key, least, point, error)
      type(key_group_t), intent(in) :: group
      integer, intent(in) :: x_key, y_key                !! Indices of the keys
      integer, intent(in) :: least                       !! Smallest number of points
      real(wp), allocatable, intent(out) :: point(:, :)  !! The points: (2, n) [m]
      !> Allocated for lists of different lengths, or too short ones
      type(error_t), allocatable, intent(out) :: error

      associate (x => group%value(x_key)%numbers, y => group%value(y_key)%numbers)
         if (size(x) /= size(y) .or. size(x) < least) call group_error(group, "expected " &
            & //trim(map_key(x_key)%name)//" and "//trim(map_key(y_key)%name) &
            & //" of one length from "//to_text(least)//", got "//to_text(size(x))//" and " &
            & //to_text(size(y))//" numbers", error)
         if (allocated(error)) return
         point = transpose(reshape([x, y], [size(x), 2]))
      end associate
   end subroutine take_points

   !> Read a polygon from two lists, in either order; the result is anticlockwise
   pure subroutine take_polygon(group, x_key, y_key, corner, error)
      type(key_group_t), intent(in) :: group
      integer, intent(in) :: x_key, y_key
      real(wp), allocatable, intent(out) :: corner(:, :)  !! Corners: (2, n) [m]
      type(error_t), allocatable, intent(out) :: error    !! Allocated if the polygon is not simple
      type(area_moments_t) :: moments

      call take_points(group, x_key, y_key, 3, corner, error)
      if (allocated(error)) return
      moments = area_moments(corner)
      if (moments%area < 0.0_wp) corner = corner(:, size(corner, 2):1:-1)
      call check_polygon(group, corner, error)
   end subroutine take_polygon

   !> Check that a polygon is simple and has an area
   pure subroutine check_polygon(group, corner, error)
      type(key_group_t), intent(in) :: group
      real(wp), intent(in) :: corner(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp) :: crossing(2)
      integer :: edge(2)

      moments = area_moments(corner)
      if (.not. moments%area > 0.0_wp) call group_error(group, &
         & "expected an outline with an area, got one of "//short_text(moments%area)//" m2", error)
      if (allocated(error)) return
      call find_crossing(corner, edge, crossing)
      if (edge(1) > 0) call group_error(group, "expected an outline whose edges do not " &
         & //"meet, got edges "//to_text(edge(1))//" and "//to_text(edge(2))//" that do at " &
         & //place_text(crossing), error)
   end subroutine check_polygon

   !> Read an opening
   pure subroutine take_opening(group, map, error)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
      type(opening_t) :: opening
      real(wp) :: at(2), height, rise, width, wall
      integer :: n

      opening%row = group%row
      opening%material = nint(group%value(opening_material)%number)
      opening%excavated = group%value(opening_excavated)%flag
      at = group%value(opening_x:opening_y)%number
      width = group%value(opening_width)%number
      height = width
      if (group%value(opening_height)%given) height = group%value(opening_height)%number
      rise = 0.5_wp*width
      if (group%value(opening_rise)%given) rise = group%value(opening_rise)%number
      wall = group%value(opening_wall)%number
      n = nint(group%value(opening_sides)%number)
      select case (group%value(opening_shape)%text)
      case ("circle")
         opening%corner = ring(at, [0.5_wp, 0.5_wp]*width, n)
      case ("ellipse")
         opening%corner = ring(at, 0.5_wp*[width, height], n)
      case ("arch")
         opening%corner = arched_opening(at, width, wall, rise, n)
      case ("horseshoe")
         if (wall <= 0.0_wp .or. wall >= 0.99_wp*width) call group_error(group, &
            & "expected a horseshoe with a wall above 0 and below the width, got " &
            & //short_text(wall), error)
         if (allocated(error)) return
         opening%corner = horseshoe(at, 0.5_wp*width, wall, n)
      case default
         call take_polygon(group, opening_corner_x, opening_corner_y, opening%corner, error)
      end select
      if (.not. allocated(error)) call check_polygon(group, opening%corner, error)
      if (.not. allocated(error)) map%opening = [map%opening, opening]
   end subroutine take_opening
end module dda_read_joint_map
