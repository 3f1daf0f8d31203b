!> Read a map of joints, the deck of `dda lines`: its outline, the surface of the ground, openings,
!> sets, points
module dda_read_joint_map
   use dda_error, only : error_t
   use dda_joint_map, only : bolts_t, joint_map_t, joint_set_t, length_law, length_t, map_line_t
   use dda_key_groups, only : group_error, key_group_t, number_in, numbers_in, read_groups, &
      & whole_in, word_in
   use dda_kinds, only : degree, wp
   use dda_map_keys, only : map_group, map_key
   use dda_text, only : to_text
   use dda_text_file, only : read_text_file
   implicit none
   private

   public :: parse_joint_map, read_joint_map

   interface

      !> The outline: a polygon, a rectangle, or the ground below a slope
      pure module subroutine take_outline(group, map, error)
         !> All groups
         type(key_group_t), intent(in) :: group(:)
         type(joint_map_t), intent(inout) :: map
         !> No outline, or no simple one
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_outline

      !> Points of two lists
      pure module subroutine take_points(group, x_name, y_name, least, point, error)
         type(key_group_t), intent(in) :: group
         !> Names of the keys
         character(len=*), intent(in) :: x_name, y_name
         !> Fewest points
         integer, intent(in) :: least
         !> The points: (2, n) [m]
         real(wp), allocatable, intent(out) :: point(:, :)
         !> Lists of unequal lengths, or too short ones
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_points

      !> A polygon of two lists, anticlockwise whichever way it was given
      pure module subroutine take_polygon(group, x_name, y_name, corner, error)
         type(key_group_t), intent(in) :: group
         character(len=*), intent(in) :: x_name, y_name
         !> Its corners: (2, n) [m]
         real(wp), allocatable, intent(out) :: corner(:, :)
         !> No simple polygon
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_polygon

      !> An opening
      pure module subroutine take_opening(group, map, error)
         type(key_group_t), intent(in) :: group
         type(joint_map_t), intent(inout) :: map
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_opening

   end interface

contains

   !> Read a file
   subroutine read_joint_map(file, map, is_ddaml, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      type(joint_map_t), intent(out) :: map
      !> Whether lines are to be written in DDAML
      logical, intent(out) :: is_ddaml
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      is_ddaml = .false.
      call read_text_file(file, text, error)
      if (.not. allocated(error)) call parse_joint_map(text, file, map, is_ddaml, error)
   end subroutine read_joint_map

   !> Read a text
   pure subroutine parse_joint_map(text, file, map, is_ddaml, error)
      !> The text, lines ended by line feeds
      character(len=*), intent(in) :: text
      !> Name that errors show
      character(len=*), intent(in) :: file
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
      !> Seed of the map
      integer, intent(in) :: seed
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
      !> Name of the key
      character(len=*), intent(in) :: name

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
      type(key_group_t), intent(in) :: group(:)
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
end module dda_read_joint_map
