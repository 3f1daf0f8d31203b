!> Directions and angles of all corners, and what they say about two of them (Shi: angl)
module dda_limerick_corners
   use dda_constants, only : degree
   use dda_kinds, only : wp
   use dda_limerick_state, only : limerick_blocks_t
   implicit none
   private

   public :: corners_t, measure_corners, turn, overlap, entrance_lines

   !> Shape of all corners of a step
   type :: corners_t
      !> Direction of the edge that starts at each vertex: (n_vertex) [deg, 0 to 360]
      real(wp), allocatable :: direction(:)
      !> Inner angle: (n_vertex) [deg]
      real(wp), allocatable :: angle(:)
      !> Length of the edge that starts there: (n_vertex) [m]
      real(wp), allocatable :: length(:)
   end type corners_t

contains

   !> Directions, inner angles and lengths of all corners
   pure subroutine measure_corners(blocks, corners)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(out) :: corners
      real(wp) :: edge(2)
      integer :: v, n

      n = size(blocks%next)
      allocate (corners%direction(n), corners%angle(n), corners%length(n))
      do v = 1, n
         edge = blocks%vertex(:, blocks%next(v)) - blocks%vertex(:, v)
         corners%length(v) = sqrt(edge(1)**2 + edge(2)**2)
         corners%direction(v) = modulo(atan2(edge(2), edge(1))/degree, 360.0_wp)
      end do
      do v = 1, n
         corners%angle(v) = turn(corners%direction(v), &
            & corners%direction(blocks%previous(v)) - 180.0_wp)
      end do
   end subroutine measure_corners

   !> Anticlockwise angle from one direction to another
   pure real(wp) function turn(from, to)
      !> First direction [deg]
      real(wp), intent(in) :: from
      !> Second direction [deg]
      real(wp), intent(in) :: to

      turn = modulo(to - from, 360.0_wp)
   end function turn

   !> Whether two sectors overlap by more than is overlooked
   pure logical function overlap(start_a, angle_a, start_b, angle_b, least)
      !> Where the first sector starts [deg]
      real(wp), intent(in) :: start_a
      !> Its angle [deg]
      real(wp), intent(in) :: angle_a
      !> Where the second sector starts [deg]
      real(wp), intent(in) :: start_b
      !> Its angle [deg]
      real(wp), intent(in) :: angle_b
      !> What is overlooked [deg]
      real(wp), intent(in) :: least
      real(wp) :: ray(3), wide

      if (angle_a > angle_b) then
         wide = angle_a
         ray = start_b - start_a + [0.0_wp, angle_b/2.0_wp, angle_b]
      else
         wide = angle_b
         ray = start_a - start_b + [0.0_wp, angle_a/2.0_wp, angle_a]
      end if
      ray = modulo(ray, 360.0_wp)
      overlap = any(ray > least .and. ray < wide - least)
   end function overlap

   !> The two lines that a pair of corners may cross, the steeper first: mirrored meshes stay so
   pure function entrance_lines(blocks, corners, i, j, overlap_deg) result(line)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      !> Vertex of the first block
      integer, intent(in) :: i
      !> Vertex of the second block
      integer, intent(in) :: j
      !> Overlap that is overlooked [deg]
      real(wp), intent(in) :: overlap_deg
      !> Vertex and ends of the edge: (3, 2)
      integer :: line(3, 2)
      real(wp) :: start, finish, slack, steep_i, steep_j, steep(2)

      slack = 0.3_wp*overlap_deg
      start = turn(corners%direction(i), corners%direction(j))
      finish = turn(corners%direction(blocks%previous(i)), corners%direction(blocks%previous(j)))
      steep_i = steepness(corners%direction(i) + corners%angle(i)/2.0_wp)
      steep_j = steepness(corners%direction(j) + corners%angle(j)/2.0_wp)
      if (start <= 180.0_wp - slack .or. (start <= 180.0_wp + slack .and. steep_j >= steep_i)) then
         line(:, 1) = [i, blocks%next(j), j]
         steep(1) = steepness(corners%direction(j))
      else
         line(:, 1) = [j, blocks%next(i), i]
         steep(1) = steepness(corners%direction(i))
      end if
      if (finish <= 180.0_wp - slack &
         & .or. (finish <= 180.0_wp + slack .and. steep_i >= steep_j)) then
         line(:, 2) = [j, i, blocks%previous(i)]
         steep(2) = steepness(corners%direction(blocks%previous(i)))
      else
         line(:, 2) = [i, j, blocks%previous(j)]
         steep(2) = steepness(corners%direction(blocks%previous(j)))
      end if
      if (steep(1) < steep(2)) line = line(:, [2, 1])
   end function entrance_lines

   !> How steep a direction is, from 0 to 1
   pure real(wp) function steepness(direction)
      !> The direction [deg]
      real(wp), intent(in) :: direction

      steepness = abs(sin(direction*degree))
   end function steepness
end module dda_limerick_corners
