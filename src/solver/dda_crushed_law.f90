!> Law of joints that crush: all of a joint, or one side of it
submodule (dda_coulomb_law) dda_crushed_law
   use dda_crushed_joint, only : bear_side, lean_side, reserve, stretch_of
   implicit none

contains

   !> Normal forces, gaps and corners of a joint that crushes after an increment of openings
   module procedure crush_joint
      real(wp) :: stretch(2)
      integer :: side

      stretch = opening + stretch_of(joints, j, state%face(:2, j), state%force(:2, j), &
         & state%gap(:, j))
      associate (force => state%force(:2, j), gap => state%gap(:, j), ends => state%face(:2, j))
         force = -stretch/joints%graph%compliance(j)
         gap = 0.0_wp
         ends = face%closed
         if (min(reserve(joints, j, 1, force), reserve(joints, j, 2, force)) >= 0.0_wp) return
         if (all(force >= 0.5_wp*joints%graph%crush(j))) then
            ends = face%open
            call crush_whole(joints, j, stretch, force, gap)
            return
         end if
         side = merge(1, 2, force(1) > force(2))
         call bear_side(joints, j, side, stretch, force, gap)
         ends(3 - side) = face%open
         if (force(side) > 0.0_wp) return
         force = 0.0_wp
         gap = max(0.0_wp, stretch)
         ends = face%open
      end associate
   end procedure crush_joint

   !> Forces of a joint all of which is crushed; the opening beyond the springs at one corner limits
   !> the force at the other
   pure subroutine crush_whole(joints, j, stretch, force, gap)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j             !! Number of the joint
      real(wp), intent(in) :: stretch(2)   !! Opening 1, opening 2
      real(wp), intent(out) :: force(2)    !! N1, N2
      real(wp), intent(out) :: gap(2)      !! Openings beyond the springs

      force = 0.5_wp*joints%graph%crush(j)
      gap = -(stretch([2, 1]) + joints%graph%compliance(j)*force)
   end subroutine crush_whole

   !> Normal forces and gaps of a joint that crushes after increments of its openings and its force,
   !> while its corners stay open and closed
   module procedure yield_joint
      real(wp) :: stretch(2)

      lag = 0.0_wp

      stretch = opening + stretch_of(joints, j, state%face(:2, j), state%force(:2, j), &
         & state%gap(:, j))
      associate (force => state%force(:2, j), gap => state%gap(:, j))
         if (all(ends == face%open) .and. sum(force) > 0.5_wp*joints%graph%crush(j)) then
            call crush_whole(joints, j, stretch, force, gap)
         else if (all(ends == face%open)) then
            force = 0.0_wp
            gap = max(0.0_wp, stretch)
         else if (all(ends == face%closed)) then
            force = -stretch/joints%graph%compliance(j)
            gap = 0.0_wp
         else
            call lean_side(joints, j, merge(1, 2, ends(1) == face%closed), stretch, &
               & sum(force) + change, force, gap, lag)
         end if
      end associate
   end procedure yield_joint

end submodule dda_crushed_law
