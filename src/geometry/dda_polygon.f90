!> Points and polygons
module dda_polygon
   use dda_kinds, only : wp
   use dda_segment, only : segment_distance
   use dda_vector, only : cross
   implicit none
   private

   public :: contains_point, polygon_distance

contains

   !> Whether a point lies in a polygon: its boundary winds around the point
   pure logical function contains_point(vertex, point)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      real(wp) :: a(2), b(2), side
      integer :: i, turns

      turns = 0
      b = vertex(:, size(vertex, 2)) - point
      do i = 1, size(vertex, 2)
         a = b
         b = vertex(:, i) - point
         if ((a(2) <= 0.0_wp) .eqv. (b(2) <= 0.0_wp)) cycle
         side = cross(a, b)
         if (a(2) <= 0.0_wp .and. side > 0.0_wp) turns = turns + 1
         if (b(2) <= 0.0_wp .and. side < 0.0_wp) turns = turns - 1
      end do
      contains_point = turns /= 0
   end function contains_point

   !> Distance of a point from the boundary of a polygon
   pure real(wp) function polygon_distance(vertex, point)
      !> Corners in order: (2, n) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      integer :: i, n

      n = size(vertex, 2)
      polygon_distance = segment_distance(point, [vertex(:, n), vertex(:, 1)])
      do i = 2, n
         polygon_distance = min(polygon_distance, &
            & segment_distance(point, [vertex(:, i - 1), vertex(:, i)]))
      end do
   end function polygon_distance
end module dda_polygon
