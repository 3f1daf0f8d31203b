!> Plane vectors, and areas and moments of polygons by simplex integration (Shi: area)
module dda_vector
   use dda_kinds, only : wp
   implicit none
   private

   public :: cross, right_normal, along, area_moments_t, area_moments

   !> Integrals over a polygon
   type :: area_moments_t
      real(wp) :: area = 0.0_wp         !! Area, positive for a counter-clockwise polygon [m2]
      real(wp) :: centroid(2) = 0.0_wp  !! Centre of gravity: (2) [m]
      real(wp) :: second(3) = 0.0_wp    !! Sxx, Syy, Sxy about the centre of gravity: (3) [m4]
   end type area_moments_t

contains

   !> Signed area of the parallelogram of two vectors, positive if b lies to the left of a
   pure real(wp) function cross(a, b)
      real(wp), intent(in) :: a(2)  !! First vector: (2)
      real(wp), intent(in) :: b(2)  !! Second vector: (2)

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> Unit vector from the first point towards the second
   pure function along(start, finish) result(direction)
      real(wp), intent(in) :: start(2)   !! First point: (2) [m]
      real(wp), intent(in) :: finish(2)  !! Second point, distinct from the first: (2) [m]
      real(wp) :: direction(2)           !! Unit vector: (2)

      direction = (finish - start)/norm2(finish - start)
   end function along

   !> Vector rotated clockwise by 90 degrees: outward for the edge of a counter-clockwise polygon
   pure function right_normal(direction) result(normal)
      real(wp), intent(in) :: direction(2)  !! Any vector: (2)
      real(wp) :: normal(2)                 !! Vector of the same length: (2)

      normal = [direction(2), -direction(1)]
   end function right_normal

   !> Area, centre of gravity and central second moments. Triangles start at the first vertex, so
   !> that a polygon far from the origin loses no digits
   pure type(area_moments_t) function area_moments(vertex) result(moments)
      real(wp), intent(in) :: vertex(:, :)  !! Corners in order: (2, n), n >= 3 [m]
      real(wp) :: a(2), b(2), twice, first(2), second(3)
      integer :: i

      first = 0.0_wp
      second = 0.0_wp
      b = vertex(:, 2) - vertex(:, 1)
      do i = 3, size(vertex, 2)
         a = b
         b = vertex(:, i) - vertex(:, 1)
         twice = cross(a, b)
         moments%area = moments%area + twice/2.0_wp
         first = first + twice*(a + b)/6.0_wp
         second(1:2) = second(1:2) + twice*(a*a + a*b + b*b)/12.0_wp
         second(3) = second(3) &
            & + twice*(2.0_wp*(a(1)*a(2) + b(1)*b(2)) + a(1)*b(2) + a(2)*b(1))/24.0_wp
      end do
      if (abs(moments%area) > tiny(1.0_wp)) then
         first = first/moments%area
      else  ! without area: the first vertex
         first = 0.0_wp
      end if
      moments%centroid = vertex(:, 1) + first
      moments%second(1:2) = second(1:2) - moments%area*first*first
      moments%second(3) = second(3) - moments%area*first(1)*first(2)
   end function area_moments

end module dda_vector
