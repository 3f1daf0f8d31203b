!> Blocks as a user gives them, checked: what makes no block is refused by its number
module dda_check_plan
   use dda_block_input, only : block_plan_t
   use dda_box_tree, only : box_pairs
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_polygon, only : find_crossing, find_overlap
   use dda_simplex, only : area_moments, area_moments_t
   use dda_text, only : to_text
   implicit none
   private

   public :: add_plan_block, check_plan, warn

   !> Corners nearer than this share of a block's extent are one
   real(wp), parameter :: same_corner = 1.0e-8_wp
   !> A block thinner than this share of its extent is none
   real(wp), parameter :: too_thin = 1.0e-8_wp
   !> Blocks may overlap by this share of the smaller one's size, for coordinates are rounded
   real(wp), parameter :: rounded = 1.0e-4_wp
   !> Corners rounded to this share of their block's extent are doubtful
   real(wp), parameter :: few_digits = 1.0e-9_wp
   !> Blocks farther from zero than this multiple of their extent get an origin of their own
   real(wp), parameter :: far_away = 100.0_wp

contains

   !> Add a block; corners given twice are merged, clockwise ones are turned
   pure subroutine add_plan_block(plan, corner, fixed, material, line, error)
      !> Receives the block as its last
      type(block_plan_t), intent(inout) :: plan
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: corner(:, :)
      !> Whether it cannot move
      logical, intent(in) :: fixed
      !> Number of its material
      integer, intent(in) :: material
      !> Line of the file, 0 if there is none
      integer, intent(in) :: line
      !> Allocated if the corners make no block
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp), allocatable :: vertex(:, :)
      real(wp) :: extent, point(2), perimeter
      integer :: edge(2)
      character(len=60) :: where_to

      extent = norm2(maxval(corner, dim=2) - minval(corner, dim=2))
      call merge_corners(corner, same_corner*extent, vertex)
      if (size(vertex, 2) < size(corner, 2)) &
         & call warn(plan, line, block_name(plan)//": corners given twice are merged")
      if (size(vertex, 2) < 3) then
         call fatal_error(error, "wanted three different corners or more of " &
            & //block_name(plan)//", found fewer", line=line)
         return
      end if
      call find_crossing(vertex, edge, point)
      if (edge(1) > 0) then
         write (where_to, "('(', es14.7, ', ', es14.7, ')')") point
         call fatal_error(error, block_name(plan)//" is no simple polygon: its edges " &
            & //to_text(edge(1))//" and "//to_text(edge(2))//" meet at "//trim(where_to), line=line)
         return
      end if
      moments = area_moments(vertex)
      if (moments%area < 0.0_wp) vertex = vertex(:, size(vertex, 2):1:-1)
      perimeter = sum(norm2(cshift(vertex, 1, dim=2) - vertex, dim=1))
      if (.not. 2.0_wp*abs(moments%area) > too_thin*extent*perimeter) then
         call fatal_error(error, "wanted a block with an area, "//block_name(plan) &
            & //" is thinner than 1e-8 of its length", line=line)
         return
      end if
      plan%first_vertex = [plan%first_vertex, plan%first_vertex(size(plan%first_vertex)) &
         & + size(vertex, 2)]
      plan%vertex = reshape([plan%vertex, vertex], [2, size(plan%vertex, 2) + size(vertex, 2)])
      plan%fixed = [plan%fixed, fixed]
      plan%material = [plan%material, material]
      plan%line = [plan%line, line]
      plan%velocity = reshape([plan%velocity, [0.0_wp, 0.0_wp, 0.0_wp]], [3, size(plan%fixed)])
      plan%stress = reshape([plan%stress, [0.0_wp, 0.0_wp, 0.0_wp]], [3, size(plan%fixed)])
   end subroutine add_plan_block

   !> Leave out corners that follow one another at the same place
   pure subroutine merge_corners(corner, near, vertex)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: corner(:, :)
      !> Corners nearer than this are one [m]
      real(wp), intent(in) :: near
      !> The corners that are left: (2, m) [m]
      real(wp), allocatable, intent(out) :: vertex(:, :)
      logical :: kept(size(corner, 2))
      integer :: i, last

      kept = .true.
      last = 1
      do i = 2, size(kept)
         kept(i) = norm2(corner(:, i) - corner(:, last)) > near
         if (kept(i)) last = i
      end do
      if (last > 1) kept(last) = norm2(corner(:, last) - corner(:, 1)) > near
      vertex = reshape(pack(corner, spread(kept, 1, 2)), [2, count(kept)])
   end subroutine merge_corners

   !> Check a plan as a whole and move its origin to where coordinates keep their digits
   pure subroutine check_plan(plan, error)
      !> The plan
      type(block_plan_t), intent(inout) :: plan
      !> Allocated if blocks overlap
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: low(:, :), high(:, :), size_of(:)
      integer, allocatable :: pair(:, :)
      real(wp) :: extent(2), point(2)
      logical :: overlaps
      integer :: b, inside, k, n

      n = size(plan%fixed)
      if (n == 0) then
         call fatal_error(error, "wanted a block or more, found none", line=1)
         return
      end if
      do b = 1, n
         if (plan%material(b) == 1 .or. any(plan%materials%number == plan%material(b))) cycle
         call fatal_error(error, "block "//to_text(b)//" wants material " &
            & //to_text(plan%material(b))//", which is not given", line=plan%line(b))
         return
      end do
      call check_digits(plan)
      extent = maxval(plan%vertex, dim=2) - minval(plan%vertex, dim=2)
      point = minval(plan%vertex, dim=2)
      if (maxval(abs(point)) > far_away*maxval(extent)) then
         plan%origin = anint(point)
         plan%vertex = plan%vertex - spread(plan%origin, 2, size(plan%vertex, 2))
      end if
      allocate (low(2, n), high(2, n), size_of(n))
      do b = 1, n
         associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
            low(:, b) = minval(vertex, dim=2)
            high(:, b) = maxval(vertex, dim=2)
            size_of(b) = sqrt(polygon_area(vertex))
         end associate
      end do
      call box_pairs(low, high, [(b, b=1, n)], pair)
      do k = 1, size(pair, 2)
         associate (i => pair(1, k), j => pair(2, k))
            if (plan%fixed(i) .and. plan%fixed(j)) cycle
            call find_overlap(plan%vertex(:, plan%first_vertex(i):plan%first_vertex(i + 1) - 1), &
               & plan%vertex(:, plan%first_vertex(j):plan%first_vertex(j + 1) - 1), &
               & rounded*min(size_of(i), size_of(j)), overlaps, inside, point)
            if (.not. overlaps) cycle
            call refuse_overlap(plan, [i, j], inside, point, error)
            return
         end associate
      end do
      if (all(plan%fixed)) call warn(plan, 1, "all blocks are fixed: nothing can move")
   end subroutine check_plan

   !> Warn of coordinates so large that their spacing shows in a block
   pure subroutine check_digits(plan)
      !> The plan; receives the warning
      type(block_plan_t), intent(inout) :: plan
      real(wp) :: extent, farthest
      integer :: b

      do b = 1, size(plan%fixed)
         associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
            extent = norm2(maxval(vertex, dim=2) - minval(vertex, dim=2))
            farthest = maxval(abs(vertex))
         end associate
         if (spacing(farthest) <= few_digits*extent) cycle
         call warn(plan, plan%line(b), "block "//to_text(b)//" has corners of few digits: "// &
            & "so far from zero coordinates are rounded to 1e-9 of its size or more")
         return
      end do
   end subroutine check_digits

   !> Area of a polygon [m2]
   pure real(wp) function polygon_area(vertex)
      !> Corners, counter-clockwise: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      type(area_moments_t) :: moments

      moments = area_moments(vertex)
      polygon_area = moments%area
   end function polygon_area

   !> Say which blocks overlap and where
   pure subroutine refuse_overlap(plan, block, inside, point, error)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> The two blocks
      integer, intent(in) :: block(2)
      !> Which of them lies wholly inside the other: 1, 2 or 0 for none
      integer, intent(in) :: inside
      !> A point that both hold: (2) [m]
      real(wp), intent(in) :: point(2)
      !> The failure
      type(error_t), allocatable, intent(out) :: error
      character(len=60) :: where_to

      write (where_to, "('(', es14.7, ', ', es14.7, ')')") point + plan%origin
      if (inside > 0) then
         call fatal_error(error, "block "//to_text(block(inside))//" lies inside block " &
            & //to_text(block(3 - inside)), line=plan%line(block(inside)))
      else
         call fatal_error(error, "blocks "//to_text(block(1))//" and "//to_text(block(2)) &
            & //" overlap near "//trim(where_to), line=plan%line(block(2)))
      end if
   end subroutine refuse_overlap

   !> Tell the user something
   pure subroutine warn(plan, line, message)
      !> Receives the warning
      type(block_plan_t), intent(inout) :: plan
      !> Line that it speaks of
      integer, intent(in) :: line
      !> The warning
      character(len=*), intent(in) :: message
      character(len=160) :: text

      text = message
      plan%warning = [character(len=len(text)) :: plan%warning, text]
      plan%warning_line = [plan%warning_line, line]
   end subroutine warn

   !> Name of the block that comes next
   pure function block_name(plan) result(name)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> Such as: block 3
      character(len=:), allocatable :: name

      name = "block "//to_text(size(plan%fixed) + 1)
   end function block_name
end module dda_check_plan
