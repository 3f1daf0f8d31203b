!> The parts of a line that lie in rock: inside the outline, outside the openings
submodule (dda_map_lines) dda_line_clip
   use dda_growth, only : make_room
   use dda_segment, only : crossing_parameters
   use dda_sort, only : sorted_order
   implicit none

   !> Parts shorter than this share of the line are none
   real(wp), parameter :: least_share = 1.0e-12_wp

contains

   !> Cut a line at a polygon and keep what lies inside, or outside
   module procedure clip_line
      real(wp), allocatable :: part(:, :)
      integer :: i, m

      m = 0
      allocate (part(4, n + 8))
      do i = 1, n
         call clip_one(line(:, i), corner, inside, part, m)
      end do
      call move_alloc(part, line)
      n = m
   end procedure clip_line

   !> The parts of one line
   pure subroutine clip_one(line, corner, inside, part, m)
      !> Its ends: (4) [m]
      real(wp), intent(in) :: line(4)
      real(wp), intent(in) :: corner(:, :)
      logical, intent(in) :: inside
      !> Receives columns of ends: (4, m or more) [m]
      real(wp), allocatable, intent(inout) :: part(:, :)
      !> Their number
      integer, intent(inout) :: m
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
         ! parts on either side of a corner that is only touched are one
         if (start < 0.0_wp) then
            start = share(k - 1)
            m = m + 1
            call make_room(part, m)
         end if
         part(:, m) = [line(1:2) + start*along, line(1:2) + share(k)*along]
      end do
   end subroutine clip_one

   !> Where a line crosses a polygon, its own ends included, in order
   pure function crossings(line, corner) result(share)
      real(wp), intent(in) :: line(4)
      !> Corners of the polygon: (2, n) [m]
      real(wp), intent(in) :: corner(:, :)
      !> Shares of its length, ascending, 0 first and 1 last: (n)
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

   !> A point inside a polygon
   module procedure inner_point
      real(wp), allocatable :: share(:)
      real(wp) :: height(size(corner, 2)), line(4), low(2), high(2)
      integer :: k

      low = minval(corner, 2)
      high = maxval(corner, 2)
      height = corner(2, sorted_order(spread(0, 1, size(corner, 2)), corner(2, :)))
      ! the widest strip between two corners has no corner inside
      k = maxloc(height(2:) - height(:size(height) - 1), 1)
      line = [2.0_wp*low(1) - high(1), 0.5_wp*(height(k) + height(k + 1)), &
         & 2.0_wp*high(1) - low(1), 0.5_wp*(height(k) + height(k + 1))]
      allocate (share, source=crossings(line, corner))
      point = line(1:2) + 0.5_wp*(share(2) + share(3))*(line(3:4) - line(1:2))
   end procedure inner_point

   !> Where a ray leaves a polygon for the last time
   module procedure ray_exit
      real(wp) :: reach
      real(wp), allocatable :: share(:)

      reach = 2.0_wp*norm2(maxval(corner, 2) - minval(corner, 2))
      allocate (share, source=crossings([origin, origin + reach*direction], corner))
      point = origin + share(size(share) - 1)*reach*direction
   end procedure ray_exit

   !> Whether two polygons have edges that cross, or one holds the other
   module procedure outlines_cross
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
   end procedure outlines_cross

end submodule dda_line_clip
