!> Outlines of openings: circle and ellipse, arch on walls, horseshoe
module dda_opening_shapes
   use dda_kinds, only : wp
   implicit none
   private

   public :: arched_opening, horseshoe, ring

   !> Half a turn [rad]
   real(wp), parameter :: pi = 4.0_wp*atan(1.0_wp)

contains

   !> A circle or an ellipse with its corners on the curve
   pure function ring(centre, half_axis, n) result(corner)
      !> Its centre: (2) [m]
      real(wp), intent(in) :: centre(2)
      !> Half axes along x and y: (2) [m]
      real(wp), intent(in) :: half_axis(2)
      !> Number of corners
      integer, intent(in) :: n
      !> The corners, anticlockwise: (2, n) [m]
      real(wp) :: corner(2, n)

      corner = arc(centre, half_axis, 0.0_wp, 2.0_wp*pi*real(n - 1, wp)/real(n, wp), n)
   end function ring

   !> Walls on a level floor with half an ellipse above them
   pure function arched_opening(middle, width, wall, rise, n) result(corner)
      !> Middle of the floor: (2) [m]
      real(wp), intent(in) :: middle(2)
      !> Distance of the walls [m]
      real(wp), intent(in) :: width
      !> Height of the walls [m]
      real(wp), intent(in) :: wall
      !> Height of the arch above the walls [m]
      real(wp), intent(in) :: rise
      !> Number of edges of the arch
      integer, intent(in) :: n
      !> The corners, anticlockwise: (2, n_corner) [m]
      real(wp), allocatable :: corner(:, :)
      real(wp) :: roof(2, n + 1)

      roof = arc(middle + [0.0_wp, wall], [0.5_wp*width, rise], 0.0_wp, pi, n + 1)
      if (wall <= 0.0_wp) then
         corner = roof
      else
         corner = reshape([middle + [-0.5_wp*width, 0.0_wp], middle + [0.5_wp*width, 0.0_wp], &
            & roof], [2, n + 3])
      end if
   end function arched_opening

   !> A horseshoe: half a circle above, walls that draw in to the floor on arcs of twice its radius
   pure function horseshoe(middle, radius, wall, n) result(corner)
      real(wp), intent(in) :: middle(2)
      !> Radius of the roof [m]
      real(wp), intent(in) :: radius
      !> Height of the roof's centre above the floor, less than twice the radius [m]
      real(wp), intent(in) :: wall
      !> Number of edges of the roof; each wall has half as many
      integer, intent(in) :: n
      real(wp), allocatable :: corner(:, :)
      real(wp) :: centre(2), fall, right(2, max(1, n/2) + 1), left(2, max(1, n/2) + 1)
      integer :: m

      m = max(1, n/2)
      centre = middle + [0.0_wp, wall]
      fall = asin(wall/(2.0_wp*radius))
      right = arc(centre - [radius, 0.0_wp], [2.0_wp, 2.0_wp]*radius, -fall, 0.0_wp, m + 1)
      left = arc(centre + [radius, 0.0_wp], [2.0_wp, 2.0_wp]*radius, pi, pi + fall, m + 1)
      corner = reshape([right(:, :m), arc(centre, [radius, radius], 0.0_wp, pi, n + 1), &
         & left(:, 2:)], [2, 2*m + n + 1])
   end function horseshoe

   !> Points on an ellipse
   pure function arc(centre, half_axis, from, to, n) result(point)
      real(wp), intent(in) :: centre(2), half_axis(2)
      !> First and last angle [rad]
      real(wp), intent(in) :: from, to
      !> Number of points
      integer, intent(in) :: n
      !> The points: (2, n) [m]
      real(wp) :: point(2, n)
      real(wp) :: angle
      integer :: i

      do i = 1, n
         angle = from + (to - from)*real(i - 1, wp)/real(max(1, n - 1), wp)
         point(:, i) = centre + half_axis*[cos(angle), sin(angle)]
      end do
   end function arc
end module dda_opening_shapes
