!> Water below a piezometric line: its pressure on the edges of blocks
!>
!> The pressure at a point is the weight of the water between it and the line above; seepage is not
!> computed. It is applied as forces at both ends of an edge, which do the same work for any motion
!> with constant strain.
module dda_water
   use dda_kinds, only : wp
   implicit none
   private

   public :: edge_forces, water_t

   !> A piezometric line
   type :: water_t
      real(wp), allocatable :: x(:)        !! Abscissae, ascending: (n) [m]
      real(wp), allocatable :: head(:)     !! Height of the line there: (n) [m]
      real(wp) :: unit_weight = 9810.0_wp  !! Weight per volume [N/m3]
      real(wp) :: factor = 1.0_wp          !! Factor of the pressure in joints
      !> Times of the rises, ascending; unallocated or empty for a constant line: (n_time) [s]
      real(wp), allocatable :: time(:)
      real(wp), allocatable :: rise(:)  !! Rise of the line at these times: (n_time) [m]
      integer :: line = 0               !! Line of the file
   end type water_t

   !> Distance below which positions coincide, over the length of the piezometric line
   real(wp), parameter :: touching = 1.0e-12_wp

contains

   !> Pressure forces at both ends of a part of an edge, with the block on its left
   pure function edge_forces(water, rise, part) result(force)
      type(water_t), intent(in) :: water
      real(wp), intent(in) :: rise     !! Rise of the piezometric line [m]
      real(wp), intent(in) :: part(4)  !! Ends of the part: (4) [m]
      real(wp) :: force(2, 2)          !! Forces at its start and at its end: (2, 2) [N/m]
      real(wp) :: low, high, share(2), way, reach
      integer :: k

      force = 0.0_wp
      way = part(3) - part(1)
      reach = touching*(water%x(size(water%x)) - water%x(1))
      if (abs(way) <= reach) way = 0.0_wp
      do k = 2, size(water%x)
         low = water%x(k - 1)
         high = water%x(k)
         share = [0.0_wp, 1.0_wp]
         if (way > 0.0_wp) then
            share = ([low, high] - part(1))/way
         else if (way < 0.0_wp) then
            share = ([high, low] - part(1))/way
         else if (part(1) <= low - merge(reach, 0.0_wp, k == 2) &
            & .or. part(1) > high + merge(reach, 0.0_wp, k == size(water%x))) then
            ! a vertical edge at a point of the line belongs to the segment before it
            cycle
         end if
         share = [max(0.0_wp, share(1)), min(1.0_wp, share(2))]
         if (share(1) < share(2)) call add_leg(water, rise, part, k, share, force)
      end do
   end function edge_forces

   !> Add the pressure below one segment of the piezometric line
   pure subroutine add_leg(water, rise, part, leg, share, force)
      type(water_t), intent(in) :: water
      real(wp), intent(in) :: rise
      real(wp), intent(in) :: part(4)         !! Ends of the part of the edge: (4) [m]
      integer, intent(in) :: leg              !! Number of the point at the end of the segment
      real(wp), intent(in) :: share(2)        !! Start and end along the part, as shares: (2)
      real(wp), intent(inout) :: force(2, 2)  !! Receives the forces at both ends: (2, 2) [N/m]
      real(wp) :: depth(2), s(2), place(2), inward(2), at, pressure, weight
      integer :: i

      do i = 1, 2
         place = part(1:2) + share(i)*(part(3:4) - part(1:2))
         depth(i) = water%head(leg - 1) + (water%head(leg) - water%head(leg - 1)) &
            & *(place(1) - water%x(leg - 1))/(water%x(leg) - water%x(leg - 1)) + rise - place(2)
      end do
      if (all(depth <= 0.0_wp)) return
      s = share
      if (depth(1) < 0.0_wp) s(1) = share(1) + (share(2) - share(1))*depth(1)/(depth(1) - depth(2))
      if (depth(2) < 0.0_wp) s(2) = share(1) + (share(2) - share(1))*depth(1)/(depth(1) - depth(2))
      inward = [part(2) - part(4), part(3) - part(1)]
      ! Simpson's rule is exact: pressure times share is quadratic
      do i = 0, 2
         at = s(1) + 0.5_wp*real(i, wp)*(s(2) - s(1))
         pressure = max(0.0_wp, depth(1) + (depth(2) - depth(1))*(at - share(1)) &
            & /(share(2) - share(1)))*water%unit_weight
         weight = (s(2) - s(1))*merge(4.0_wp, 1.0_wp, i == 1)/6.0_wp*pressure
         force(:, 1) = force(:, 1) + weight*(1.0_wp - at)*inward
         force(:, 2) = force(:, 2) + weight*at*inward
      end do
   end subroutine add_leg
end module dda_water
