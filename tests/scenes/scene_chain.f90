!> How a chain falls, seen from the positions of its joints and centres of gravity alone
module scene_chain
   use dda_chain, only : chain_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: least_opening, power_of_loads

contains

   !> The least opening of any corner of a whole chain that moves, less friction times the slip of
   !> its joint; an admissible motion has none below zero
   pure real(wp) function least_opening(chain, motion)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: motion(:, :)  !! Motion of its blocks: (3, n) [m, m, 1]
      real(wp) :: corner(2), gap(2), normal(2), slip
      integer :: end, j

      least_opening = huge(1.0_wp)
      do j = 1, size(chain%joint)
         normal = [chain%joint(j)%tangent(2), -chain%joint(j)%tangent(1)]
         do end = -1, 1, 2
            corner = chain%joint(j)%middle + real(end, wp)*chain%joint(j)%half*chain%joint(j)%tangent
            gap = moved(chain, motion, j, corner) - moved(chain, motion, j - 1, corner)
            slip = 0.0_wp
            if (.not. chain%joint(j)%no_slip) &
               & slip = chain%joint(j)%friction*abs(dot_product(gap, chain%joint(j)%tangent))
            least_opening = min(least_opening, dot_product(gap, normal) - slip)
         end do
      end do
   end function least_opening

   !> How a corner moves with a block; those before the first and behind the last are fixed
   pure function moved(chain, motion, b, corner) result(way)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: motion(:, :)  !! Motion of its blocks: (3, n) [m, m, 1]
      integer, intent(in) :: b              !! Number of the block
      real(wp), intent(in) :: corner(2)     !! The corner: (2) [m]
      real(wp) :: way(2), arm(2)            !! Its motion: (2) [m]

      way = 0.0_wp
      if (b == 0 .or. b > size(motion, 2)) return
      arm = corner - chain%block(b)%centroid
      way = motion(1:2, b) + motion(3, b)*[-arm(2), arm(1)]
   end function moved

   !> Power of the loads on a motion
   pure real(wp) function power_of_loads(chain, motion)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: motion(:, :)  !! Motion of its blocks: (3, n) [m, m, 1]

      power_of_loads = sum(chain%block%weight(1)*motion(1, :) + chain%block%weight(2)*motion(2, :))
   end function power_of_loads
end module scene_chain
