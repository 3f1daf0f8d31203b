!> Joints that crush on a loading path: forces of a joint whose strength is limited, by its openings
!>
!> A joint whose strength is S carries a normal force N within a strip of the share s = N/S of its
!> length: N1, N2 >= N**2/(2 S). Within these limits springs at its corners answer the openings o.
!> At the limit of corner 2 the joint turns about the edge of its strip, by y beyond the springs:
!>
!>    o1 = -c N1 - y s,    o2 = -c N2 + y (1 - s),    N1 = S (s - s**2/2),    N2 = S s**2/2
!>
!> These are the forces that lie nearest to those of the springs: there is no history. Rates of the
!> forces have the direction t = (1 - s, s), so that the joint acts as one corner at the edge of its
!> strip, with the compliance c t*t + y/S. Without a limit to strength s is zero, corner 1 bears the
!> joint, and y is the gap at corner 2.
module dda_crushed_joint
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: bear_side, can_crush, is_crushed, lean_side, place_strips, reserve
   public :: stretch_of, strip_gap_rate, turn_of_corner, weight_of

   !> Largest share of a joint in its strip: all of it
   real(wp), parameter :: most_share = 1.0_wp
   !> Rounding of that share
   real(wp), parameter :: crumbs = 1.0e-10_wp

contains

   !> True if a joint crushes
   pure logical function can_crush(joints, j)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j  !! Number of the joint

      can_crush = allocated(joints%share)
      if (can_crush) can_crush = joints%graph%crush(j) > 0.0_wp &
         & .and. joints%graph%crush(j) < huge(1.0_wp)
   end function can_crush

   !> Put the strips of all joints where the forces of a state are
   pure subroutine place_strips(joints, force, gap, faces, moved)
      type(coulomb_joints_t), intent(inout) :: joints
      real(wp), intent(in) :: force(:, :)  !! N1, N2, T of each joint: (3, n_joint)
      real(wp), intent(in) :: gap(:, :)    !! Openings beyond the springs: (2, n_joint)
      integer(small), intent(in) :: faces(:, :)  !! Faces that were in use: (3, n_joint)
      !> True if the strip of a joint has moved that one corner bore by these
      logical, intent(out) :: moved
      real(wp) :: share, slack
      integer :: j

      moved = .false.
      if (.not. allocated(joints%share)) return
      do j = 1, size(joints%share)
         if (.not. can_crush(joints, j)) cycle
         share = min(most_share, max(0.0_wp, sum(force(:2, j)))/joints%graph%crush(j))
         slack = maxval(gap(:, j))
         moved = moved .or. faces(1, j) /= faces(2, j) &
            & .and. (abs(share - joints%share(j)) > 0.0_wp &
            & .or. abs(slack - joints%slack(j)) > 0.0_wp)
         joints%share(j) = share
         joints%slack(j) = slack
      end do
   end subroutine place_strips

   !> True if the whole of a joint is crushed where a state has its strip
   pure logical function is_crushed(joints, j)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j  !! Number of the joint

      is_crushed = can_crush(joints, j)
      if (is_crushed) is_crushed = joints%share(j) >= most_share - crumbs
   end function is_crushed

   !> Distance of a corner from its limit: its force, less that of a strip as wide as it is
   pure real(wp) function reserve(joints, j, corner, force)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j         !! Number of the joint
      integer, intent(in) :: corner    !! Corner 1 or 2
      real(wp), intent(in) :: force(:) !! Its forces N1, N2
      real(wp) :: share

      reserve = force(corner)
      if (.not. can_crush(joints, j)) return
      associate (strength => joints%graph%crush(j))
         share = min(most_share, max(0.0_wp, sum(force(:2)))/strength)
         reserve = force(corner) - share*(sum(force(:2)) - 0.5_wp*share*strength)
      end associate
   end function reserve

   !> Direction of the forces of a joint of which one corner is closed: (N1, N2) per unit of their
   !> sum
   pure function weight_of(joints, j, side) result(weight)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j     !! Number of the joint
      integer, intent(in) :: side  !! Corner that is closed
      real(wp) :: weight(2)        !! Shares of both corners

      weight(side) = 1.0_wp - joints%share(j)
      weight(3 - side) = joints%share(j)
   end function weight_of

   !> Opening of a corner against the edge of the strip of the other one
   pure real(wp) function turn_of_corner(joints, j, corner, opening) result(turn)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j           !! Number of the joint
      integer, intent(in) :: corner      !! Corner 1 or 2
      real(wp), intent(in) :: opening(:) !! Opening 1, opening 2

      turn = opening(corner)
      if (.not. allocated(joints%share)) return
      associate (s => joints%share(j))
         if (s > 0.0_wp) turn = (1.0_wp - s)*opening(corner) - s*opening(3 - corner)
      end associate
   end function turn_of_corner

   !> Rate of the opening beyond the springs at an open corner
   pure real(wp) function strip_gap_rate(joints, j, corner, closed, opening, force) result(rate)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j            !! Number of the joint
      integer, intent(in) :: corner       !! The open corner
      logical, intent(in) :: closed       !! True if the other one is closed
      real(wp), intent(in) :: opening(:)  !! Rates of opening 1, opening 2
      real(wp), intent(in) :: force(:)    !! Rates of N1, N2

      rate = opening(corner)
      if (.not. closed .and. is_crushed(joints, j)) rate = -opening(3 - corner)
      if (.not. (closed .and. can_crush(joints, j))) return
      associate (other => 3 - corner)
         rate = opening(corner) - opening(other) &
            & + joints%graph%compliance(j)*(force(corner) - force(other))
      end associate
   end function strip_gap_rate

   !> Openings of a joint by its forces and its opening beyond the springs
   pure function stretch_of(joints, j, ends, force, gap) result(opening)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j                !! Number of the joint
      integer(small), intent(in) :: ends(2)   !! States of its corners, 0 for open ones
      real(wp), intent(in) :: force(:)        !! N1, N2
      real(wp), intent(in) :: gap(:)          !! Openings beyond the springs
      real(wp) :: opening(2)                  !! Opening 1, opening 2
      real(wp) :: share
      integer :: side

      opening = gap - joints%graph%compliance(j)*force(:2)
      if (ends(1) == ends(2) .and. ends(1) == 0_small .and. sum(force(:2)) > 0.0_wp) &
         & opening = -gap([2, 1]) - joints%graph%compliance(j)*force(:2)
      if (ends(1) == ends(2)) return
      side = merge(1, 2, ends(1) /= 0_small)
      share = min(most_share, max(0.0_wp, sum(force(:2)))/joints%graph%crush(j))
      opening(side) = opening(side) - share*gap(3 - side)
      opening(3 - side) = opening(3 - side) - share*gap(3 - side)
   end function stretch_of

   !> Forces of a joint that one corner bears, and its opening beyond the springs at the other one,
   !> negative where that is closed
   pure subroutine bear_side(joints, j, side, opening, force, gap)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j               !! Number of the joint
      integer, intent(in) :: side            !! The corner that bears it
      real(wp), intent(in) :: opening(2)     !! Opening 1, opening 2
      real(wp), intent(inout) :: force(:)    !! Receives N1, N2
      real(wp), intent(inout) :: gap(:)      !! Receives the openings
      integer, parameter :: most = 60
      real(wp) :: a, b, high, low, n, s, slope, y
      integer :: i

      associate (c => joints%graph%compliance(j), strength => joints%graph%crush(j))
         low = 0.0_wp
         high = most_share
         s = min(high, max(low, joints%share(j)))
         do i = 1, most
            a = opening(side) + c*strength*s*(1.0_wp - 0.5_wp*s)
            b = opening(3 - side) + c*strength*0.5_wp*s**2
            y = (1.0_wp - s)*a + s*b
            if (y > 0.0_wp) high = s
            if (.not. y > 0.0_wp) low = s
            slope = b - a + c*strength*((1.0_wp - s)**2 + s**2)
            n = s
            if (slope > 0.0_wp) s = s - y/slope
            if (.not. (slope > 0.0_wp .and. s >= low .and. s <= high)) s = 0.5_wp*(low + high)
            if (abs(s - n) <= 4.0_wp*epsilon(s)*s .or. high <= 0.0_wp .or. low >= most_share) exit
         end do
         n = s*strength
         if (low >= most_share) n = (s**2*strength*(2.0_wp*s - 1.0_wp)*0.5_wp*c &
            & - (1.0_wp - s)*opening(side) - s*opening(3 - side))/(c*((1.0_wp - s)**2 + s**2))
         force(side) = (1.0_wp - s)*n + 0.5_wp*s**2*strength
         force(3 - side) = s*n - 0.5_wp*s**2*strength
         gap(side) = 0.0_wp
         gap(3 - side) = opening(3 - side) - opening(side) &
            & + c*(force(3 - side) - force(side))
      end associate
   end subroutine bear_side

   !> Put a joint that one corner bears on the strip of a normal force. The opening that the joint
   !> would need beyond this, the same at both corners, is left: zero where `bear_side` has the
   !> same force
   pure subroutine lean_side(joints, j, side, opening, normal, force, gap, lag)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j               !! Number of the joint
      integer, intent(in) :: side            !! The corner that bears it
      real(wp), intent(in) :: opening(2)     !! Opening 1, opening 2
      real(wp), intent(in) :: normal         !! N1 + N2
      real(wp), intent(inout) :: force(:)    !! Receives N1, N2
      real(wp), intent(inout) :: gap(:)      !! Receives the openings beyond the springs
      real(wp), intent(out) :: lag           !! Opening that is left
      real(wp) :: beyond(2), s

      associate (c => joints%graph%compliance(j), strength => joints%graph%crush(j))
         s = min(most_share, max(0.0_wp, normal/strength))
         force(side) = s*(1.0_wp - 0.5_wp*s)*strength
         force(3 - side) = 0.5_wp*s**2*strength
         beyond = opening + c*force(:2)
         gap(side) = 0.0_wp
         gap(3 - side) = beyond(3 - side) - beyond(side)
         lag = (1.0_wp - s)*beyond(side) + s*beyond(3 - side)
      end associate
   end subroutine lean_side
end module dda_crushed_joint
