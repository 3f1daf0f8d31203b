!> Absorbing faces of a file of blocks
module dda_absorb_entries
   use dda_block_input, only : block_plan_t
   use dda_block_lines, only : entry_t, take_numbers
   use dda_block_sites, only : blocks_along, site_t
   use dda_boundary, only : absorbing_point_t
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_polygon, only : parts_inside
   use dda_text, only : to_text
   implicit none
   private

   public :: take_absorbing

   !> Points nearer than this share of the block's size are one
   real(wp), parameter :: touching = 1.0e-8_wp

contains

   !> Take in absorb x1 y1 x2 y2 [x or y] [p_speed V] [s_speed V]: two points of its part along each
   !> block, those of Gauss, at which forces that are linear along it have their exact work
   pure subroutine take_absorbing(entry, plan, site, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(site_t), intent(in) :: site
      type(error_t), allocatable, intent(out) :: error
      type(absorbing_point_t) :: point
      real(wp), allocatable :: part(:, :)
      real(wp) :: ends(4), half(2), middle(2)
      integer, allocatable :: near(:)
      integer :: b, i, k, n_before

      i = 1
      ends = 0.0_wp
      point%line = entry%head%number
      call take_numbers(entry%head, i, ends, error)
      if (.not. allocated(error)) call take_words(entry, i, point, error)
      if (allocated(error)) return
      ends = ends - [plan%origin, plan%origin]
      if (.not. allocated(plan%boundary%absorbing)) allocate (plan%boundary%absorbing(0))
      n_before = size(plan%boundary%absorbing)
      allocate (near(0))
      if (norm2(ends(3:4) - ends(1:2)) > 0.0_wp) then
         near = blocks_along(site, ends)
         point%tangent = (ends(3:4) - ends(1:2))/norm2(ends(3:4) - ends(1:2))
      end if
      do i = 1, size(near)
         b = near(i)
         part = parts_inside(plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1), &
            & ends, touching*site%size_of(b), site%edges(site%edges_of(b)))
         point%block = b
         do k = 1, size(part, 2), 2
            middle = (part(:, k) + part(:, k + 1))/2.0_wp
            half = (part(:, k + 1) - part(:, k))/2.0_wp
            point%length = norm2(half)
            if (.not. point%length > touching*site%size_of(b)) cycle
            point%point = middle - half/sqrt(3.0_wp)
            plan%boundary%absorbing = [plan%boundary%absorbing, point]
            point%point = middle + half/sqrt(3.0_wp)
            plan%boundary%absorbing = [plan%boundary%absorbing, point]
         end do
      end do
      if (size(plan%boundary%absorbing) == n_before) call fatal_error(error, &
         & "expected a line along faces of blocks, got one along none", line=point%line)
   end subroutine take_absorbing

   !> What waves it absorbs
   pure subroutine take_words(entry, first, point, error)
      type(entry_t), intent(in) :: entry
      !> Place of the first word
      integer, intent(in) :: first
      type(absorbing_point_t), intent(inout) :: point
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: word(4) = [character(len=7) :: "p_speed", "s_speed", "x", "y"]
      logical :: given(4)
      real(wp) :: value(1)
      integer :: i, k

      given = .false.
      i = first
      do while (i <= entry%head%n)
         k = findloc(word == entry%head%word(i), .true., dim=1)
         if (k == 0) then
            call fatal_error(error, "expected x, y, p_speed or s_speed after the numbers, got '" &
               & //shown(trim(entry%head%word(i)))//"'", line=point%line)
         else if (given(k) .or. k > 2 .and. any(given(3:))) then
            call fatal_error(error, "expected one direction and each speed once, got '" &
               & //trim(word(k))//"' once more", line=point%line)
         else if (k > 2) then
            i = i + 1
            point%along = [k == 3, k == 4]
         else
            call take_numbers(entry%head, i, value, error)
            if (.not. allocated(error) .and. .not. value(1) > 0.0_wp) call fatal_error(error, &
               & "expected a speed above 0 [m/s], got "//to_text(value(1)), line=point%line)
            if (.not. allocated(error)) point%speed(k) = value(1)
         end if
         if (allocated(error)) return
         given(k) = .true.
      end do
   end subroutine take_words
end module dda_absorb_entries
