!> Blocks of a file put together one after the other
module dda_plan_growth
   use dda_block_input, only : block_plan_t, law_plan_t
   use dda_error, only : error_t, fatal_error
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_polygon, only : find_crossing
   use dda_simplex, only : area_moments, area_moments_t
   use dda_text, only : to_text
   use dda_warnings, only : add_warning, warnings_t
   implicit none
   private

   public :: growing_plan_t, add_law_plan, add_plan_block, close_plan

   !> A plan whose arrays have room for more
   type :: growing_plan_t
      !> The plan; its arrays are longer than what they hold
      type(block_plan_t) :: plan
      !> Number of blocks
      integer :: n_block = 0
      !> Number of corners
      integer :: n_vertex = 0
      !> Number of laws
      integer :: n_law = 0
   end type growing_plan_t

   !> Corners nearer than this share of a block's extent are one
   real(wp), parameter :: same_corner = 1.0e-8_wp
   !> A block thinner than this share of its extent is none
   real(wp), parameter :: too_thin = 1.0e-8_wp

contains

   !> Add a block; corners given twice are merged, clockwise ones are turned
   pure subroutine add_plan_block(growing, corner, fixed, material, line, file, warnings, error)
      type(growing_plan_t), intent(inout) :: growing
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: corner(:, :)
      !> Whether it cannot move
      logical, intent(in) :: fixed
      !> Number of its material
      integer, intent(in) :: material
      !> Line of the file, 0 if there is none
      integer, intent(in) :: line
      !> Name of the file, for warnings
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      !> Allocated if the corners make no block
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp), allocatable :: vertex(:, :)
      real(wp) :: extent, point(2), perimeter
      integer :: edge(2)
      character(len=60) :: where_to

      extent = 0.0_wp
      if (size(corner) > 0) extent = norm2(maxval(corner, dim=2) - minval(corner, dim=2))
      call merge_corners(corner, same_corner*extent, vertex)
      if (size(vertex, 2) < size(corner, 2)) &
         & call add_warning(warnings, "corners given twice are merged", file, line)
      if (size(vertex, 2) < 3) then
         call fatal_error(error, "expected three different corners or more of " &
            & //next_name(growing)//", got fewer", line=line)
         return
      end if
      call find_crossing(vertex, edge, point)
      if (edge(1) > 0) then
         write (where_to, "('(', es14.7, ', ', es14.7, ')')") point
         call fatal_error(error, next_name(growing)//" is no simple polygon: its edges " &
            & //to_text(edge(1))//" and "//to_text(edge(2))//" meet at "//trim(where_to), line=line)
         return
      end if
      moments = area_moments(vertex)
      if (moments%area < 0.0_wp) vertex = vertex(:, size(vertex, 2):1:-1)
      perimeter = sum(norm2(cshift(vertex, 1, dim=2) - vertex, dim=1))
      if (.not. 2.0_wp*abs(moments%area) > too_thin*extent*perimeter) then
         call fatal_error(error, "expected a block with an area, got "//next_name(growing) &
            & //", thinner than 1e-8 of its length", line=line)
         return
      end if
      call put_block(growing, vertex, fixed, material, line)
   end subroutine add_plan_block

   !> Put a block behind the others, at rest and free of stress
   pure subroutine put_block(growing, vertex, fixed, material, line)
      type(growing_plan_t), intent(inout) :: growing
      !> Its corners, counter-clockwise: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      logical, intent(in) :: fixed
      integer, intent(in) :: material, line

      associate (plan => growing%plan, n => growing%n_block, n_vertex => growing%n_vertex)
         call make_room(plan%vertex, n_vertex + size(vertex, 2))
         call make_room(plan%first_vertex, n + 2)
         call make_room(plan%fixed, n + 1)
         call make_room(plan%material, n + 1)
         call make_room(plan%line, n + 1)
         call make_room(plan%velocity, n + 1)
         call make_room(plan%stress, n + 1)
         plan%vertex(:, n_vertex + 1:n_vertex + size(vertex, 2)) = vertex
         n_vertex = n_vertex + size(vertex, 2)
         n = n + 1
         plan%first_vertex(n + 1) = n_vertex + 1
         plan%fixed(n) = fixed
         plan%material(n) = material
         plan%line(n) = line
         plan%velocity(:, n) = 0.0_wp
         plan%stress(:, n) = 0.0_wp
      end associate
   end subroutine put_block

   !> Add a law
   pure subroutine add_law_plan(growing, law)
      type(growing_plan_t), intent(inout) :: growing
      type(law_plan_t), intent(in) :: law
      type(law_plan_t), allocatable :: longer(:)

      associate (n => growing%n_law)
         if (n == size(growing%plan%laws)) then
            allocate (longer(2*n + 8))
            longer(:n) = growing%plan%laws
            call move_alloc(longer, growing%plan%laws)
         end if
         n = n + 1
         growing%plan%laws(n) = law
      end associate
   end subroutine add_law_plan

   !> Hand over the plan, its arrays as long as what they hold
   pure subroutine close_plan(growing, plan)
      type(growing_plan_t), intent(in) :: growing
      type(block_plan_t), intent(out) :: plan

      associate (from => growing%plan, n => growing%n_block)
         plan%first_vertex = from%first_vertex(:n + 1)
         plan%vertex = from%vertex(:, :growing%n_vertex)
         plan%fixed = from%fixed(:n)
         plan%material = from%material(:n)
         plan%line = from%line(:n)
         plan%velocity = from%velocity(:, :n)
         plan%stress = from%stress(:, :n)
         plan%materials = from%materials
         plan%laws = from%laws(:growing%n_law)
         plan%water = from%water
      end associate
   end subroutine close_plan

   !> Leave out corners that follow one another at the same place
   pure subroutine merge_corners(corner, near, vertex)
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

   !> Name of the block that comes next
   pure function next_name(growing) result(name)
      type(growing_plan_t), intent(in) :: growing
      !> Such as: block 3
      character(len=:), allocatable :: name

      name = "block "//to_text(growing%n_block + 1)
   end function next_name
end module dda_plan_growth
