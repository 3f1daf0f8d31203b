!> Assembly and checks of the blocks of a file; errors have the number of the block
submodule (dda_read_blocks) dda_block_plan_check
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_box_tree, only : find_boxes
   use dda_deck_keys, only : deck_key
   use dda_key_names, only : scene_contact_tolerance
   use dda_overlap, only : find_overlap
   use dda_polygon, only : find_crossing
   use dda_sort, only : rising_order
   use dda_text, only : place_text, raised_text, short_text
   use dda_vector, only : area_moments, area_moments_t
   use dda_error, only : add_warning
   implicit none

   !> Distance below which corners coincide, over the extent of the block
   real(wp), parameter :: same_corner = 1.0e-8_wp
   !> Smallest thickness of a block over its extent
   real(wp), parameter :: too_thin = 1.0e-8_wp

   !> Permitted overlap over the contact tolerance: coordinates of both blocks are rounded
   real(wp), parameter :: both = 2.0_wp
   !> Relative round-off of corners that causes a warning
   real(wp), parameter :: few_digits = 1.0e-9_wp
   !> Distance from zero over the extent from which blocks have a local origin
   real(wp), parameter :: far_away = 100.0_wp

contains

   !> Add a block
   module procedure add_plan_block
      type(area_moments_t) :: moments
      real(wp), allocatable :: vertex(:, :)
      real(wp) :: extent, point(2), perimeter
      character(len=:), allocatable :: name
      integer :: edge(2)

      name = "block "//to_text(reading%n_block + 1)
      associate (corner => reading%entry%row(:2, :reading%entry%n_row), &
         & line => reading%entry%head%number)
         extent = 0.0_wp
         if (size(corner) > 0) extent = norm2(maxval(corner, dim=2) - minval(corner, dim=2))
         call merge_corners(corner, same_corner*extent, vertex)
         if (size(vertex, 2) < size(corner, 2)) &
            & call add_warning(warnings, "corners given twice are merged", reading%file, line)
      end associate
      if (size(vertex, 2) < 3) call fatal_error(error, &
         & "expected three different corners or more of "//name//", got fewer")
      if (allocated(error)) return
      call find_crossing(vertex, edge, point)
      if (edge(1) > 0) then
         call fatal_error(error, name//" is no simple polygon: its edges " &
            & //to_text(edge(1))//" and "//to_text(edge(2))//" meet at "//place_text(point))
         return
      end if
      moments = area_moments(vertex)
      if (moments%area < 0.0_wp) vertex = vertex(:, size(vertex, 2):1:-1)
      perimeter = sum(norm2(cshift(vertex, 1, dim=2) - vertex, dim=1))
      if (.not. 2.0_wp*abs(moments%area) > too_thin*extent*perimeter) call fatal_error(error, &
         & "expected a block with an area, got "//name &
         & //", thinner than 1e-8 of its length")
      if (allocated(error)) return
      call put_block(reading, vertex, fixed, material)
   end procedure add_plan_block

   !> Append a block at rest and free of stress
   pure subroutine put_block(reading, vertex, fixed, material)
      type(reading_t), intent(inout) :: reading
      real(wp), intent(in) :: vertex(:, :)  !! Corners, counter-clockwise: (2, n) [m]
      logical, intent(in) :: fixed
      integer, intent(in) :: material

      associate (plan => reading%plan, n => reading%n_block, n_vertex => reading%n_vertex)
         call make_room(plan%vertex, n_vertex + size(vertex, 2))
         call make_room(plan%first_vertex, n + 2)
         call make_room(plan%fixed, n + 1)
         call make_room(plan%material, n + 1)
         call make_room(plan%line, n + 1)
         plan%vertex(:, n_vertex + 1:n_vertex + size(vertex, 2)) = vertex
         n_vertex = n_vertex + size(vertex, 2)
         n = n + 1
         plan%first_vertex(n + 1) = n_vertex + 1
         plan%fixed(n) = fixed
         plan%material(n) = material
         plan%line(n) = reading%entry%head%number
      end associate
   end subroutine put_block

   !> Merge consecutive corners at the same place
   pure subroutine merge_corners(corner, near, vertex)
      real(wp), intent(in) :: corner(:, :)                !! Corners in order: (2, n) [m]
      real(wp), intent(in) :: near                        !! Smallest distance of corners [m]
      real(wp), allocatable, intent(out) :: vertex(:, :)  !! The remaining corners: (2, m) [m]
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

   !> Check a plan as a whole, and move its origin near the blocks, so that coordinates keep their
   !> digits
   module procedure check_plan
      real(wp) :: extent(2), point(2)

      if (size(plan%fixed) == 0) call fatal_error(error, "expected at least one block, got none", &
         & line=1)
      if (allocated(error)) return
      call check_materials(plan, file, warnings, error)
      if (.not. allocated(error)) call check_laws(plan, error)
      if (allocated(error)) return
      call check_digits(plan, file, warnings)
      extent = maxval(plan%vertex, dim=2) - minval(plan%vertex, dim=2)
      point = minval(plan%vertex, dim=2)
      if (maxval(abs(point)) > far_away*maxval(extent)) then
         plan%origin = anint(point)
         plan%vertex = plan%vertex - spread(plan%origin, 2, size(plan%vertex, 2))
      end if
      if (all(plan%fixed)) &
         & call add_warning(warnings, "all blocks are fixed: nothing can move", file, 1)
   end procedure check_plan

   !> Check that all materials of blocks exist; warn of laws of other materials
   pure subroutine check_materials(plan, file, warnings, error)
      type(block_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      logical :: known(most_materials)
      integer :: b, i

      known = .false.
      known(1) = .true.
      known(plan%materials%number) = .true.
      do b = 1, size(plan%fixed)
         if (known(plan%material(b))) cycle
         call fatal_error(error, "block "//to_text(b)//" needs material " &
            & //to_text(plan%material(b))//", which is not given", line=plan%line(b))
         return
      end do
      do i = 1, size(plan%laws)
         if (.not. all(known(plan%laws(i)%material))) call add_warning(warnings, "no joint has " &
            & //"this law, for one of its two materials is not given", file, plan%laws(i)%line)
      end do
   end subroutine check_materials

   !> Check that two materials have at most one law
   pure subroutine check_laws(plan, error)
      type(block_plan_t), intent(in) :: plan
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: key(size(plan%laws))
      integer :: order(size(plan%laws)), i

      do i = 1, size(key)
         associate (pair => plan%laws(i)%material)
            key(i) = int(most_materials*(minval(pair) - 1) + maxval(pair), int64)
         end associate
      end do
      order = rising_order(key)
      do i = 2, size(order)
         if (key(order(i)) /= key(order(i - 1))) cycle
         associate (law => plan%laws(order(i)))
            call fatal_error(error, "joint "//to_text(law%material(1))//" " &
               & //to_text(law%material(2))//" is given twice, first in line " &
               & //to_text(plan%laws(order(i - 1))%line), line=law%line)
         end associate
         return
      end do
   end subroutine check_laws

   !> Check that no two blocks overlap
   module procedure check_overlaps
      real(wp) :: size_of(size(plan%fixed)), depth, point(2), smaller
      type(area_moments_t) :: moments
      integer, allocatable :: near(:)
      logical :: overlaps
      integer :: i, inside, j, k, n_near

      do i = 1, size(size_of)
         moments = area_moments(plan%vertex(:, plan%first_vertex(i):plan%first_vertex(i + 1) - 1))
         size_of(i) = sqrt(moments%area)
      end do
      do i = 1, size(size_of)
         if (present(watch) .and. modulo(i, 1000) == 0) call watch%tell( &
            & "looking for blocks that overlap", real(i, wp)/real(size(size_of), wp))
         if (plan%fixed(i)) cycle
         associate (vertex => plan%vertex(:, plan%first_vertex(i):plan%first_vertex(i + 1) - 1))
            call find_boxes(site%tree, minval(vertex, dim=2), maxval(vertex, dim=2), near, n_near)
            do k = 1, n_near
               j = near(k)
               if (j == i .or. j < i .and. .not. plan%fixed(j)) cycle
               smaller = min(size_of(i), size_of(j))
               call find_overlap(vertex, &
                  & plan%vertex(:, plan%first_vertex(j):plan%first_vertex(j + 1) - 1), &
                  & both*plan%tolerance*smaller, overlaps, inside, point, &
                  & site%edges(site%edges_of(i)), site%edges(site%edges_of(j)), depth)
               if (.not. overlaps) cycle
               call refuse_overlap(plan, [i, j], inside, point, depth, depth/smaller, error)
               return
            end do
         end associate
      end do
   end procedure check_overlaps

   !> Warn of coordinates whose spacing of floating-point numbers is not small compared with a block
   pure subroutine check_digits(plan, file, warnings)
      type(block_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      real(wp) :: extent, farthest
      integer :: b

      do b = 1, size(plan%fixed)
         associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
            extent = norm2(maxval(vertex, dim=2) - minval(vertex, dim=2))
            farthest = maxval(abs(vertex))
         end associate
         if (spacing(farthest) <= few_digits*extent) cycle
         call add_warning(warnings, "block "//to_text(b)//" has corners of few digits: so far " &
            & //"from zero coordinates are rounded to 1e-9 of its size or more", file, plan%line(b))
         return
      end do
   end subroutine check_digits

   !> Set the error for overlapping blocks: numbers, place, depth, and the contact tolerance that
   !> would accept them
   pure subroutine refuse_overlap(plan, block, inside, point, depth, share, error)
      type(block_plan_t), intent(in) :: plan
      integer, intent(in) :: block(2)  !! Numbers of the two blocks
      integer, intent(in) :: inside  !! The block that lies inside the other: 1, 2 or 0 for neither
      real(wp), intent(in) :: point(2)  !! A point inside both: (2) [m]
      real(wp), intent(in) :: depth     !! Depth of the overlap [m]
      real(wp), intent(in) :: share     !! Depth over the size of the smaller block
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: advice
      real(wp) :: largest

      largest = maxval(deck_key(scene_contact_tolerance)%within)
      advice = "; correct the corners"
      if (share <= largest) advice = advice//" or set scene%contact_tolerance = " &
         & //raised_text(share)
      if (inside > 0) then
         call fatal_error(error, "block "//to_text(block(inside))//" lies inside block " &
            & //to_text(block(3 - inside)), line=plan%line(block(inside)))
      else
         call fatal_error(error, "blocks "//to_text(minval(block))//" and " &
            & //to_text(maxval(block))//" overlap by "//short_text(depth)//" m near " &
            & //place_text(point + plan%origin)//advice, line=maxval(plan%line(block)))
      end if
   end subroutine refuse_overlap

end submodule dda_block_plan_check
