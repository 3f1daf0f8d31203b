!> Straight segments: distances and intersections (Shi: lns, dist, proj)
module dda_segment
   use dda_kinds, only : wp
   use dda_vector, only : cross
   implicit none
   private

   public :: segment_distance, meeting_points, crossing_parameters, overshoot

   !> Overshoot at which segments still meet, over their length
   real(wp), parameter :: overshoot = 1.0e-7_wp

contains

   !> Distance of a point from a segment
   pure real(wp) function segment_distance(point, segment)
      real(wp), intent(in) :: point(2)    !! The point: (2) [m]
      real(wp), intent(in) :: segment(4)  !! Its ends x1, y1, x2, y2: (4) [m]
      real(wp) :: direction(2), arm(2), length, along

      direction = segment(3:4) - segment(1:2)
      arm = point - segment(1:2)
      length = norm2(direction)
      along = 0.0_wp
      if (length > 0.0_wp) along = dot_product(arm, direction/length)
      if (along <= 0.0_wp) then
         segment_distance = norm2(arm)
      else if (along >= length) then
         segment_distance = norm2(point - segment(3:4))
      else
         segment_distance = abs(cross(direction/length, arm))
      end if
   end function segment_distance

   !> Intersection of the lines of two segments, as shares of their lengths
   pure subroutine crossing_parameters(first, second, share, crossed)
      real(wp), intent(in) :: first(4)   !! Ends of one segment: (4) [m]
      real(wp), intent(in) :: second(4)  !! Ends of the other: (4) [m]
      !> Position of the intersection on each, 0 at the start and 1 at the end: (2)
      real(wp), intent(out) :: share(2)
      logical, intent(out) :: crossed  !! True if the lines are not parallel
      real(wp) :: a(2), b(2), arm(2), sine

      share = 0.0_wp
      a = first(3:4) - first(1:2)
      b = second(3:4) - second(1:2)
      arm = second(1:2) - first(1:2)
      sine = cross(a, b)
      crossed = abs(sine) > 16.0_wp*epsilon(1.0_wp)*norm2(a)*norm2(b)
      if (crossed) share = [cross(arm, b), cross(arm, a)]/sine
   end subroutine crossing_parameters

   !> Common points of two segments: ends that touch the other segment, with their coordinates
   !> unchanged, else the intersection. Collinear segments have two
   pure subroutine meeting_points(first, second, reach, n, point)
      real(wp), intent(in) :: first(4), second(4)
      real(wp), intent(in) :: reach         !! Distance within which points coincide [m]
      integer, intent(out) :: n             !! Number of points, 0 to 2
      real(wp), intent(out) :: point(2, 2)  !! The points: (2, 2) [m]
      real(wp) :: share(2)
      logical :: crossed

      n = 0
      point = 0.0_wp
      call add_touching(first(1:2), second, reach, n, point)
      call add_touching(first(3:4), second, reach, n, point)
      call add_touching(second(1:2), first, reach, n, point)
      call add_touching(second(3:4), first, reach, n, point)
      if (n > 0) return
      call crossing_parameters(first, second, share, crossed)
      if (.not. crossed) return
      if (any(share < -overshoot .or. share > 1.0_wp + overshoot)) return
      n = 1
      point(:, 1) = crossing_point(first, second, share)
   end subroutine meeting_points

   !> Intersection of two segments. Each coordinate is computed on the segment along which it
   !> changes less, so that vertical and horizontal lines keep their coordinates
   pure function crossing_point(first, second, share) result(point)
      real(wp), intent(in) :: first(4), second(4), share(2)
      real(wp) :: point(2)  !! The point: (2) [m]
      real(wp) :: a(2), b(2)

      a = first(3:4) - first(1:2)
      b = second(3:4) - second(1:2)
      point = merge(first(1:2) + share(1)*a, second(1:2) + share(2)*b, abs(a) <= abs(b))
   end function crossing_point

   !> Add the end of a segment to the common points if it touches the other segment
   pure subroutine add_touching(end_point, segment, reach, n, point)
      real(wp), intent(in) :: end_point(2)  !! The end: (2) [m]
      real(wp), intent(in) :: segment(4)    !! Ends of the other segment: (4) [m]
      real(wp), intent(in) :: reach
      integer, intent(inout) :: n
      real(wp), intent(inout) :: point(2, 2)

      if (n == 2) return
      if (segment_distance(end_point, segment) > reach) return
      if (n == 1) then
         if (norm2(end_point - point(:, 1)) <= 2.0_wp*reach) return
      end if
      n = n + 1
      point(:, n) = end_point
   end subroutine add_touching
end module dda_segment
