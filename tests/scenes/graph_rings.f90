!> Brick arches of several rings as joint graphs
module graph_rings
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : degree, wp
   use graph_shapes, only : new_graph
   use graph_wall, only : add_joint
   implicit none
   private

   public :: new_rings

contains

   !> Rings of mean radius 1, one on the other, of voussoirs with straight edges whose radial joints
   !> go through all rings; the springings cannot move. Unit area has unit weight and unit mass
   pure subroutine new_rings(embrace_deg, thickness, voussoirs, rings, friction, loaded, graph, &
      & weight, load)
      real(wp), intent(in) :: embrace_deg  !! Angle of embrace [degrees]
      real(wp), intent(in) :: thickness  !! Of all rings together
      integer, intent(in) :: voussoirs  !! Voussoirs of a ring
      integer, intent(in) :: rings  !! Rings
      real(wp), intent(in) :: friction  !! Coefficient of friction
      integer, intent(in) :: loaded  !! Voussoir of the uppermost ring that is loaded, from the left
      type(joint_graph_t), intent(out) :: graph
      !> Weight of each voussoir, ring by ring from inside, from left to right: (3, n_block)
      real(wp), allocatable, intent(out) :: weight(:, :)
      !> The weight of the whole arch on the middle of the upper edge of one voussoir: (3, n_block)
      real(wp), allocatable, intent(out) :: load(:, :)
      real(wp) :: corner(2, 0:voussoirs, 0:rings), centre(2, voussoirs*rings)
      real(wp) :: area(voussoirs*rings)
      integer :: b, i, j, k

      do k = 0, rings
         do i = 0, voussoirs
            corner(:, i, k) = (1.0_wp + thickness*(real(k, wp)/real(rings, wp) - 0.5_wp)) &
               & *direction(embrace_deg*(real(i, wp)/real(voussoirs, wp) - 0.5_wp))
         end do
      end do
      call new_graph(voussoirs*rings, rings*(voussoirs + 1) + (rings - 1)*voussoirs, graph)
      do k = 1, rings
         do i = 1, voussoirs
            b = (k - 1)*voussoirs + i
            call take_area(reshape([corner(:, i - 1, k - 1), corner(:, i, k - 1), corner(:, i, k), &
               & corner(:, i - 1, k)], [2, 4]), area(b), centre(:, b), graph%mass(3, b))
         end do
      end do
      graph%mass(1, :) = area
      graph%mass(2, :) = area
      allocate (weight(3, size(area)), source=0.0_wp)
      weight(2, :) = -area
      allocate (load(3, size(area)), source=0.0_wp)
      b = (rings - 1)*voussoirs + loaded
      load(2, b) = -sum(area)
      load(3, b) = load(2, b)*(0.5_wp*(corner(1, loaded - 1, rings) + corner(1, loaded, rings)) &
         & - centre(1, b))
      j = 0
      do k = 1, rings
         do i = 0, voussoirs
            j = j + 1
            b = (k - 1)*voussoirs + i
            call add_joint(graph, centre, j, [merge(b, 0, i > 0), merge(b + 1, 0, i < voussoirs)], &
               & corner(:, i, k - 1), corner(:, i, k), friction)
         end do
         do i = 1, merge(voussoirs, 0, k < rings)
            j = j + 1
            b = (k - 1)*voussoirs + i
            call add_joint(graph, centre, j, [b, b + voussoirs], corner(:, i, k), &
               & corner(:, i - 1, k), friction)
         end do
      end do
   end subroutine new_rings

   !> Direction at an angle from upright, positive to the right
   pure function direction(angle_deg)
      real(wp), intent(in) :: angle_deg  !! The angle [degrees]
      real(wp) :: direction(2)           !! Unit vector

      direction = [sin(angle_deg*degree), cos(angle_deg*degree)]
   end function direction

   !> Area, centre and polar moment of area of a polygon about its centre
   pure subroutine take_area(corner, area, centre, polar)
      real(wp), intent(in) :: corner(:, :)  !! Corners in order: (2, n)
      real(wp), intent(out) :: area         !! Area
      real(wp), intent(out) :: centre(2)    !! Centre
      real(wp), intent(out) :: polar        !! Polar moment
      real(wp) :: cross, next(2), here(2)
      integer :: i, n

      n = size(corner, 2)
      area = 0.0_wp
      centre = 0.0_wp
      polar = 0.0_wp
      do i = 1, n
         here = corner(:, i)
         next = corner(:, modulo(i, n) + 1)
         cross = here(1)*next(2) - here(2)*next(1)
         area = area + 0.5_wp*cross
         centre = centre + cross*(here + next)/6.0_wp
         polar = polar + cross*(sum(here**2) + sum(next**2) + sum(here*next))/12.0_wp
      end do
      centre = centre/area
      polar = abs(polar) - abs(area)*sum(centre**2)
      area = abs(area)
   end subroutine take_area
end module graph_rings
