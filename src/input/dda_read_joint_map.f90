!> Read a map of joints, the deck of `dda lines`: its outline, the surface of the ground, openings,
!> sets, points
module dda_read_joint_map
   use dda_error, only : error_t
   use dda_joint_map, only : arched_opening, bolts_t, horseshoe, joint_map_t, joint_set_t, &
      & length_law, length_t, map_line_t, opening_t, ring
   use dda_key_groups, only : flag_in, group_error, key_group_t, number_in, numbers_in, &
      & read_groups, texts_in, whole_in, word_in
   use dda_kinds, only : degree, wp
   use dda_map_keys, only : map_group, map_key
   use dda_polygon, only : find_crossing
   use dda_text, only : to_text
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
      logical, intent(out) :: is_ddaml      !! Whether lines are to be written in DDAML
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      is_ddaml = .false.
      call read_text_file(file, text, error)
      if (.not. allocated(error)) call parse_joint_map(text, file, map, is_ddaml, error)
   end subroutine read_joint_map

   !> Read a text
   pure subroutine parse_joint_map(text, file, map, is_ddaml, error)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: file  !! Name that errors show
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
      call read_groups(text, file, map_group, map_key, group, error)
      if (allocated(error)) return
      do i = 1, size(group)
         if (group(i)%name == "lines") then
            seed = whole_in(group(i), "seed")
            map%edge_node_ratio = number_in(group(i), "edge_node_ratio")
            is_ddaml = word_in(group(i), "form") == "ddaml"
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

   !> A set of joints
   pure subroutine take_set(group, seed, map, error)
      type(key_group_t), intent(in) :: group
      integer, intent(in) :: seed  !! Seed of the map
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
      type(joint_set_t) :: set
      integer :: n

      set%row = group%row
      set%dip = number_in(group, "dip_deg")*degree
      set%dip_spread = number_in(group, "dip_spread_deg")*degree
      set%spacing = length_in(group, "spacing")
      set%trace = length_in(group, "trace")
      set%bridge = length_in(group, "bridge")
      set%material = whole_in(group, "material")
      set%seed = [seed, whole_in(group, "seed", size(map%set) + 1)]
      n = size([numbers_in(group, "through_x"), numbers_in(group, "through_y")])
      if (n == 1) call group_error(group, "expected both through_x and through_y, got one", error)
      set%anchored = n == 2
      if (set%anchored) set%anchor = [number_in(group, "through_x"), number_in(group, "through_y")]
      if (.not. allocated(error) .and. size(numbers_in(group, "region_x")) > 0) &
         & call take_polygon(group, "region_x", "region_y", set%region, error)
      if (.not. allocated(error)) map%set = [map%set, set]
   end subroutine take_set

   !> A length with its law
   pure type(length_t) function length_in(group, name)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: name  !! Name of the key

      length_in%mean = number_in(group, name)
      length_in%randomness = number_in(group, name//"_randomness")
      select case (word_in(group, name//"_law"))
      case ("uniform")
         length_in%law = length_law%uniform
      case ("exponential")
         length_in%law = length_law%exponential
      case ("normal")
         length_in%law = length_law%normal
      end select
   end function length_in

   !> Lines or points placed by hand
   pure subroutine take_lines(group, map, error)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
      type(map_line_t) :: line
      real(wp), allocatable :: point(:, :)
      logical :: is_line
      integer :: i

      is_line = group%name == "line"
      call take_points(group, "x", "y", merge(2, 1, is_line), point, error)
      if (allocated(error)) return
      line%row = group%row
      line%role = findloc([character(len=8) :: "joint", "material", "fix", "load", "measure", &
         & "hole", "bolt"] == word_in(group, "role"), .true., dim=1)
      if (is_line) then
         line%material = whole_in(group, "material")
         line%bolt = [number_in(group, "stiffness"), number_in(group, "strength"), &
            & number_in(group, "prestress")]
      end if
      do i = 1, size(point, 2) - merge(1, 0, is_line)
         line%ends = [point(:, i), point(:, merge(i + 1, i, is_line))]
         map%line = [map%line, line]
      end do
   end subroutine take_lines

   !> Bolts around an opening
   pure subroutine take_bolts(group, map)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(bolts_t) :: bolts

      bolts%row = group%row
      bolts%opening = whole_in(group, "opening")
      bolts%number = whole_in(group, "number")
      bolts%fan = degree*[number_in(group, "from_deg"), number_in(group, "to_deg")]
      bolts%reach = [number_in(group, "length"), number_in(group, "inset")]
      bolts%property = [number_in(group, "stiffness"), number_in(group, "strength"), &
         & number_in(group, "prestress")]
      map%bolts = [map%bolts, bolts]
   end subroutine take_bolts

   !> Whether the openings of all bolts are there
   pure subroutine check_bolts(group, map, error)
      type(key_group_t), intent(in) :: group(:)  !! All groups
      type(joint_map_t), intent(in) :: map
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(group)
         if (group(i)%name /= "bolts") cycle
         if (whole_in(group(i), "opening") <= size(map%opening)) cycle
         call group_error(group(i), "expected the number of an opening up to " &
            & //to_text(size(map%opening))//", got "//to_text(whole_in(group(i), "opening")), error)
         return
      end do
   end subroutine check_bolts

   !> The outline: a polygon, a rectangle, or the ground below a slope
   pure subroutine take_outline(group, map, error)
      type(key_group_t), intent(in) :: group(:)
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error  !! No outline, or no simple one
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
   end subroutine take_outline

   !> The surface of the ground from the left side to the right one
   pure subroutine take_surface(group, left, right, surface, error)
      type(key_group_t), intent(in) :: group
      real(wp), intent(in) :: left, right                  !! The two sides [m]
      real(wp), allocatable, intent(out) :: surface(:, :)  !! Points from left to right: (2, n) [m]
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
   pure subroutine take_points(group, x_name, y_name, least, point, error)
      type(key_group_t), intent(in) :: group
      !> Names of the keys
      character(len=*), intent(in) :: x_name, y_name
      !> Fewest points
      integer, intent(in) :: least
      !> The points: (2, n) [m]
      real(wp), allocatable, intent(out) :: point(:, :)
      !> Lists of unequal lengths, or too short ones
      type(error_t), allocatable, intent(out) :: error
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
   end subroutine take_points

   !> A polygon of two lists, anticlockwise whichever way it was given
   pure subroutine take_polygon(group, x_name, y_name, corner, error)
      type(key_group_t), intent(in) :: group
      character(len=*), intent(in) :: x_name, y_name
      real(wp), allocatable, intent(out) :: corner(:, :)  !! Its corners: (2, n) [m]
      type(error_t), allocatable, intent(out) :: error    !! No simple polygon
      type(area_moments_t) :: moments

      call take_points(group, x_name, y_name, 3, corner, error)
      if (allocated(error)) return
      moments = area_moments(corner)
      if (moments%area < 0.0_wp) corner = corner(:, size(corner, 2):1:-1)
      call check_polygon(group, corner, error)
   end subroutine take_polygon

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
   pure subroutine take_opening(group, map, error)
      type(key_group_t), intent(in) :: group
      type(joint_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error
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
   end subroutine take_opening
end module dda_read_joint_map
