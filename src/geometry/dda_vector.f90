!> The small algebra of plane vectors
module dda_vector
   use dda_kinds, only : wp
   implicit none
   private

   public :: cross, right_normal, along

contains

   !> Signed area of the parallelogram of two vectors, positive if b lies to the left of a
   pure real(wp) function cross(a, b)
      !> First vector: (2)
      real(wp), intent(in) :: a(2)
      !> Second vector: (2)
      real(wp), intent(in) :: b(2)

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> Unit vector from the first point towards the second
   pure function along(start, finish) result(direction)
      !> First point: (2) [m]
      real(wp), intent(in) :: start(2)
      !> Second point, not the same: (2) [m]
      real(wp), intent(in) :: finish(2)
      !> Unit vector: (2)
      real(wp) :: direction(2)

      direction = (finish - start)/norm2(finish - start)
   end function along

   !> The vector turned by a quarter clockwise: outward for the edge of a counter-clockwise polygon
   pure function right_normal(direction) result(normal)
      !> Any vector: (2)
      real(wp), intent(in) :: direction(2)
      !> Vector of the same length: (2)
      real(wp) :: normal(2)

      normal = [direction(2), -direction(1)]
   end function right_normal
end module dda_vector
