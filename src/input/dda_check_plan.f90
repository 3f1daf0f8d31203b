!> Blocks as a user gives them, checked: what makes no block is refused by its number
module dda_check_plan
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_input, only : block_plan_t, most_materials
   use dda_block_sites, only : site_t
   use dda_box_tree, only : find_boxes
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_overlap, only : find_overlap
   use dda_simplex, only : area_moments, area_moments_t
   use dda_sort, only : rising_order
   use dda_text, only : to_text
   use dda_warnings, only : add_warning, warnings_t
   use dda_watch, only : watch_t
   implicit none
   private

   public :: check_overlaps, check_plan

   !> Blocks may overlap by this share of the smaller one's size, for coordinates are rounded
   real(wp), parameter :: rounded = 1.0e-4_wp
   !> Corners rounded to this share of their block's extent are doubtful
   real(wp), parameter :: few_digits = 1.0e-9_wp
   !> Blocks farther from zero than this multiple of their extent get an origin of their own
   real(wp), parameter :: far_away = 100.0_wp

contains

   !> Check a plan as a whole and move its origin to where coordinates keep their digits
   pure subroutine check_plan(plan, file, warnings, error)
      type(block_plan_t), intent(inout) :: plan
      !> Name of the file, for warnings
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      !> Allocated if there is no block, or one material or law too few or too many
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: extent(2), point(2)

      if (size(plan%fixed) == 0) then
         call fatal_error(error, "expected at least one block, got none", line=1)
         return
      end if
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
   end subroutine check_plan

   !> Whether all materials of blocks are given; a law of others is of no use
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

   !> Whether two materials have one law
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

   !> Whether no two blocks overlap; two fixed ones may
   subroutine check_overlaps(plan, site, error, watch)
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(in) :: site
      !> Blocks that do
      type(error_t), allocatable, intent(out) :: error
      class(watch_t), intent(inout), optional :: watch
      real(wp) :: size_of(size(plan%fixed)), point(2)
      integer, allocatable :: near(:)
      logical :: overlaps
      integer :: i, inside, j, k, n_near

      do i = 1, size(size_of)
         size_of(i) = sqrt(polygon_area(plan%vertex(:, plan%first_vertex(i): &
            & plan%first_vertex(i + 1) - 1)))
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
               call find_overlap(vertex, &
                  & plan%vertex(:, plan%first_vertex(j):plan%first_vertex(j + 1) - 1), &
                  & rounded*min(size_of(i), size_of(j)), overlaps, inside, point, &
                  & site%edges(site%edges_of(i)), site%edges(site%edges_of(j)))
               if (.not. overlaps) cycle
               call refuse_overlap(plan, [i, j], inside, point, error)
               return
            end do
         end associate
      end do
   end subroutine check_overlaps

   !> Warn of coordinates so large that their spacing shows in a block
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
      type(block_plan_t), intent(in) :: plan
      !> The two blocks
      integer, intent(in) :: block(2)
      !> Which of them lies wholly inside the other: 1, 2 or 0 for none
      integer, intent(in) :: inside
      !> A point that both hold: (2) [m]
      real(wp), intent(in) :: point(2)
      type(error_t), allocatable, intent(out) :: error
      character(len=60) :: where_to

      write (where_to, "('(', es14.7, ', ', es14.7, ')')") point + plan%origin
      if (inside > 0) then
         call fatal_error(error, "block "//to_text(block(inside))//" lies inside block " &
            & //to_text(block(3 - inside)), line=plan%line(block(inside)))
      else
         call fatal_error(error, "blocks "//to_text(minval(block))//" and " &
            & //to_text(maxval(block))//" overlap near "//trim(where_to), &
            & line=maxval(plan%line(block)))
      end if
   end subroutine refuse_overlap
end module dda_check_plan
