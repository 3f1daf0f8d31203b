!> Equilibrium of a chain as a linear programme in four unknowns
!>
!> The forces of all joints follow from three unknowns at one of them. Minimised is the deficit s
!> for which forces in balance with the loads exist that keep
!>
!>    N1 + s >= 0,  N2 + s >= 0,  friction*(N1 + N2) - |T| + s >= 0
!>
!> at all joints. A chain stands where s <= 0: the forces prove it. It collapses where s > 0: the
!> multipliers of the four bounds that hold as equations are the openings and slips of a mechanism,
!> and s is the power of the loads on it.
!>
!> The dual simplex method exchanges bounds: the one that is broken most enters, the one whose
!> multiplier vanishes first leaves; if that takes long, Bland's rule ends it. The inverse is made
!> from its four rows at each exchange. Forces are those of an estimate, carried from joint to
!> joint, plus what the small change of the unknowns adds: the moments of a shallow arch about a far
!> point would lose their digits.
module dda_chain_programme
   use dda_chain, only : chain_joint_t, chain_t
   use dda_chain_balance, only : add_reaction, carry_forces, influence
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: bound_arms, deficit_t, find_deficit, mechanism_of_bounds, open_bounds

   !> Solution of the programme
   type :: deficit_t
      real(wp) :: least = 0.0_wp  !! The least s: positive where the chain collapses [N/m]
      real(wp) :: noise = 0.0_wp  !! Rounding error of s [N/m]
      !> Joints of the bounds; 0 for one that only keeps the unknowns finite
      integer :: joint(4) = 0
      !> Number of the bound: 1 and 2 at the corners, 3 and 4 of shear forces along the joint and
      !> against it
      integer :: bound(4) = 0
      real(wp) :: share(4) = 0.0_wp     !! Multipliers of the bounds, of the sum 1
      real(wp) :: reaction(3) = 0.0_wp  !! The forces' unknowns: (3) [N/m, N/m, N]
      integer :: exchanges = 0          !! Number of exchanges
      logical :: known = .false.        !! True if s is known, or at least its sign
   end type deficit_t

   !> Most exchanges; from the second number on Bland's rule chooses
   integer, parameter :: max_exchanges = 400, greedy_exchanges = 30
   !> Most estimates of the forces
   integer, parameter :: max_estimates = 4
   !> Rounding error of forces over the largest one by one component of the thrust; of 3364 random
   !> arches none had more than seven tenths of it
   real(wp), parameter :: rounding = 0.75_wp*epsilon(1.0_wp)
   !> A bound is broken by more than so many times the rounding error
   real(wp), parameter :: broken = 2.0_wp
   !> Multipliers below this are none
   real(wp), parameter :: no_share = 1.0e-12_wp
   !> Smallest pivot
   real(wp), parameter :: least_pivot = 1.0e-10_wp
   !> Largest unknowns, over the load
   real(wp), parameter :: far = 1.0e3_wp
   !> An estimate that differs from the solution by more than this share of it is replaced
   real(wp), parameter :: far_off = 0.5_wp

   !> Working data of the simplex method
   type :: tableau_t
      real(wp) :: row(4, 4) = 0.0_wp      !! The bounds as rows over the unknowns and s: (4, 4)
      real(wp) :: value(4) = 0.0_wp       !! Right-hand sides: (4)
      real(wp) :: inverse(4, 4) = 0.0_wp  !! Inverse of the rows: (4, 4)
      real(wp) :: scale(3) = 0.0_wp       !! Largest force of a corner per unit of the unknowns: (3)
      logical :: usable = .false.         !! True if the inverse exists
   end type tableau_t

contains

   !> Solve the programme
   pure subroutine find_deficit(chain, deficit, force)
      type(chain_t), intent(in) :: chain
      !> Bounds and unknowns to begin with, of a chain much like this one, or none; the solution out
      type(deficit_t), intent(inout) :: deficit
      !> The forces N1, N2, T at the solution: (3, n + 1) [N/m]
      real(wp), intent(out), optional :: force(3, size(chain%joint))
      type(tableau_t) :: tableau
      real(wp) :: resultant(3, size(chain%joint)), change(4), magnitude(2)
      logical :: found
      integer :: estimate, r

      deficit%known = .false.
      deficit%exchanges = 0
      call begin(chain, deficit, tableau)
      if (.not. tableau%usable) return
      do estimate = 1, max_estimates
         call carry_forces(chain, deficit%reaction, resultant, magnitude)
         call descend(chain, resultant, rounding*magnitude, deficit, tableau, change, found)
         if (.not. found) return
         deficit%reaction = deficit%reaction + change(:3)
         if (sum(tableau%scale*abs(change(:3))) <= far_off*magnitude(2)) exit
      end do
      deficit%least = change(4)
      deficit%share = tableau%inverse(4, :)
      deficit%noise = noise_of(chain, deficit, rounding*magnitude)
      deficit%known = .not. deficit%least > 0.0_wp &
         & .or. .not. any(deficit%joint == 0 .and. deficit%share > no_share)
      if (.not. present(force)) return
      resultant(:2, :) = reshape([(resultant(1, r) + resultant(2, r), &
         & resultant(1, r) - resultant(2, r), r=1, size(force, 2))], [2, size(force, 2)])/2.0_wp
      call add_reaction(chain, change(:3), resultant, force)
   end subroutine find_deficit

   !> Rounding error of the deficit: those of its bounds by their multipliers
   pure real(wp) function noise_of(chain, deficit, noise) result(total)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(in) :: deficit
      real(wp), intent(in) :: noise(2)  !! Those of corners and of resultants: (2) [N/m]
      integer :: r

      total = 0.0_wp
      do r = 1, 4
         if (deficit%joint(r) == 0) cycle
         total = total + deficit%share(r)*merge(noise(1), &
            & (1.0_wp + chain%joint(deficit%joint(r))%friction)*noise(2), deficit%bound(r) <= 2)
      end do
   end function noise_of

   !> Openings and slips of the mechanism, the largest 1, and the faces of the joints
   pure subroutine mechanism_of_bounds(chain, deficit, face, opening, power)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(in) :: deficit
      type(joint_face_t), intent(out) :: face(:)  !! The faces: (n + 1)
      !> Opening 1, opening 2 and slip: (3, n + 1)
      real(wp), intent(out) :: opening(3, size(chain%joint))
      real(wp), intent(out) :: power  !! Power of the loads on it
      real(wp) :: largest

      call open_bounds(chain, deficit%joint, deficit%bound, deficit%share, face, opening)
      largest = max(maxval(abs(opening)), tiny(1.0_wp))
      opening = opening/largest
      power = deficit%least/largest
   end subroutine mechanism_of_bounds

   !> Openings and slips of joints whose bounds open, and the faces of the joints
   pure subroutine open_bounds(chain, joint, bound, share, face, opening)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: joint(:), bound(:)   !! Joints and numbers of the bounds: (n)
      real(wp), intent(in) :: share(:)            !! Their openings: (n) [m]
      type(joint_face_t), intent(out) :: face(:)  !! The faces: (n + 1)
      !> Opening 1, opening 2 and slip: (3, n + 1) [m]
      real(wp), intent(out) :: opening(3, size(chain%joint))
      integer :: r

      opening = 0.0_wp
      do r = 1, size(joint)
         if (joint(r) == 0 .or. share(r) <= no_share*maxval(share)) cycle
         associate (j => joint(r))
            if (bound(r) <= 2) then
               face(j)%open(bound(r)) = .true.
               opening(bound(r), j) = opening(bound(r), j) + share(r)
            else
               face(j)%slip = merge(1, -1, bound(r) == 3)
               opening(:, j) = opening(:, j) + share(r)*[chain%joint(j)%friction, &
                  & chain%joint(j)%friction, -real(face(j)%slip, wp)]
            end if
         end associate
      end do
   end subroutine open_bounds

   !> Begin with the given bounds, or where they do not do with such as keep the unknowns finite; a
   !> smooth plane of symmetry bears no weight
   pure subroutine begin(chain, deficit, tableau)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(inout) :: deficit
      type(tableau_t), intent(out) :: tableau
      real(wp) :: half
      integer :: r

      half = chain%joint(1)%half
      tableau%scale = [chain%reach/half + 1.0_wp, chain%reach/half + 1.0_wp, 1.0_wp/half]
      if (any(deficit%joint > 0)) then
         do r = 1, 4
            call set_row(chain, deficit%joint(r), deficit%bound(r), r, tableau)
         end do
         call invert(tableau)
         if (tableau%usable .and. all(tableau%inverse(4, :) >= -no_share)) return
      end if
      deficit%joint = 0
      deficit%bound = 0
      do r = 1, 4
         call set_row(chain, 0, 0, r, tableau)
      end do
      call invert(tableau)
   end subroutine begin

   !> Set one row of the tableau
   pure subroutine set_row(chain, joint, bound, r, tableau)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: joint  !! Joint of its bound; 0 for one that keeps unknown r finite
      integer, intent(in) :: bound  !! Number of its bound
      integer, intent(in) :: r      !! Number of the row
      type(tableau_t), intent(inout) :: tableau

      if (joint > 0) then
         tableau%row(r, :) = bound_row(chain, joint, bound)
      else
         tableau%row(r, :) = 0.0_wp
         tableau%row(r, r) = 1.0_wp
         if (r < 4) tableau%row(r, r) = tableau%scale(r)
      end if
   end subroutine set_row

   !> Exchange bounds until none is broken
   pure subroutine descend(chain, resultant, noise, deficit, tableau, place, found)
      type(chain_t), intent(in) :: chain
      !> Normal force, moment over half the joint and shear force by the estimate: (3, n + 1) [N/m]
      real(wp), intent(in) :: resultant(3, size(chain%joint))
      !> Rounding errors of corners and of normal and shear forces: (2) [N/m]
      real(wp), intent(in) :: noise(2)
      type(deficit_t), intent(inout) :: deficit
      type(tableau_t), intent(inout) :: tableau
      real(wp), intent(out) :: place(4)  !! Change of the unknowns, and s: (4)
      logical, intent(out) :: found      !! True if the exchanges came to an end
      real(wp) :: change(4)
      integer :: bound, joint, leaving, n, r

      found = .false.
      ! a plane of symmetry is smooth, and one through a block does not open
      n = size(chain%joint)
      do r = 1, 4
         tableau%value(r) = value_of(chain, resultant, deficit, r, tableau%scale)
      end do
      do
         place = matmul(tableau%inverse, tableau%value)
         call find_worst(n - merge(1, 0, chain%keystone), n - merge(1, 0, chain%halved), &
            & chain%joint, resultant, place, broken*(noise + rounding &
            & *sum(tableau%scale*abs(place(:3)))), deficit%exchanges >= greedy_exchanges, joint, &
            & bound)
         if (joint == 0) exit
         change = matmul(bound_row(chain, joint, bound), tableau%inverse)
         leaving = first_to_vanish(deficit, tableau%inverse(4, :), change)
         if (leaving == 0 .or. deficit%exchanges == max_exchanges) return
         deficit%joint(leaving) = joint
         deficit%bound(leaving) = bound
         deficit%exchanges = deficit%exchanges + 1
         call set_row(chain, joint, bound, leaving, tableau)
         tableau%value(leaving) = value_of(chain, resultant, deficit, leaving, tableau%scale)
         call invert(tableau)
         if (.not. tableau%usable) return
      end do
      found = .true.
   end subroutine descend

   !> Right-hand side of one row
   pure real(wp) function value_of(chain, resultant, deficit, r, scale) result(value)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: resultant(3, size(chain%joint))
      type(deficit_t), intent(in) :: deficit
      integer, intent(in) :: r
      real(wp), intent(in) :: scale(3)  !! As in the tableau: (3)

      if (deficit%joint(r) > 0) then
         associate (this => resultant(:, deficit%joint(r)))
            if (deficit%bound(r) <= 2) then
               value = -(this(1) + merge(1, -1, deficit%bound(r) == 1)*this(2))/2.0_wp
            else
               value = merge(1, -1, deficit%bound(r) == 3)*this(3) &
                  & - chain%joint(deficit%joint(r))%friction*this(1)
            end if
         end associate
      else if (r == 4) then
         value = -far*chain%whole_load
      else
         value = -scale(r)*deficit%reaction(r)
         if (.not. (chain%halved .and. r == 2)) value = value - scale(r)*far*chain%whole_load
      end if
   end function value_of

   !> The bound that is broken most, or by Bland's rule the first that is broken; joint 0 if none is
   pure subroutine find_worst(n, rough, joint, resultant, place, noise, first, worst, bound)
      integer, intent(in) :: n      !! Number of joints that can fail
      integer, intent(in) :: rough  !! Number of those among which shear forces are bounded
      type(chain_joint_t), intent(in) :: joint(n)  !! The joints
      real(wp), intent(in) :: resultant(3, n)  !! As above [N/m]
      !> Tolerances of a corner, and of a normal or shear force: (2) [N/m]
      real(wp), intent(in) :: noise(2)
      real(wp), intent(in) :: place(4)  !! Change of the unknowns, and s
      logical, intent(in) :: first      !! True if the first suffices
      integer, intent(out) :: worst     !! Its joint
      integer, intent(out) :: bound     !! Number of its bound
      real(wp) :: along, least, moment, normal, room
      integer :: j

      least = -place(4) - noise(1)
      worst = 0
      bound = 0
      do j = 1, n
         normal = resultant(1, j) + joint(j)%tangent(2)*place(1) - joint(j)%tangent(1)*place(2)
         moment = resultant(2, j) + (joint(j)%middle(2)*place(1) &
            & - joint(j)%middle(1)*place(2) + place(3))/joint(j)%half
         room = (normal - abs(moment))/2.0_wp
         if (room < least) then
            least = room
            worst = j
            bound = merge(1, 2, moment < 0.0_wp)
            if (first) return
         end if
         if (j > rough .or. joint(j)%no_slip) cycle
         along = resultant(3, j) + joint(j)%tangent(1)*place(1) + joint(j)%tangent(2)*place(2)
         room = joint(j)%friction*normal - abs(along) &
            & + ((1.0_wp + joint(j)%friction)*noise(2) - noise(1))
         if (.not. room < least) cycle
         least = room
         worst = j
         bound = merge(3, 4, along > 0.0_wp)
         if (first) return
      end do
   end subroutine find_worst

   !> A bound as a row over the unknowns and s: (4)
   pure function bound_row(chain, joint, bound) result(row)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: joint  !! Number of the joint
      integer, intent(in) :: bound
      real(wp) :: row(4)            !! The row

      row = [bound_arms(chain, joint, bound), 1.0_wp]
      if (chain%halved) row(2) = 0.0_wp
   end function bound_row

   !> Coefficients of the unknowns in the force of a bound. They are the motion, about the origin,
   !> of the blocks behind the joint as the bound opens
   pure function bound_arms(chain, joint, bound) result(arms)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: joint, bound  !! Numbers of the joint and of its bound
      real(wp) :: arms(3)                  !! The coefficients: (3)
      real(wp) :: g(3, 3)

      g = influence(chain, joint)
      if (bound <= 2) then
         arms = g(bound, :)
      else
         arms = chain%joint(joint)%friction*(g(1, :) + g(2, :)) &
            & + merge(-1, 1, bound == 3)*g(3, :)
      end if
   end function bound_arms

   !> The bound whose multiplier vanishes first as another one's grows, of several the first in
   !> order; 0 if none does
   pure integer function first_to_vanish(deficit, share, change) result(first)
      type(deficit_t), intent(in) :: deficit
      real(wp), intent(in) :: share(4)   !! Multipliers: (4)
      real(wp), intent(in) :: change(4)  !! Share of each in the growth of the other one's: (4)
      real(wp) :: least, ratio
      integer :: r

      first = 0
      least = huge(1.0_wp)
      do r = 1, 4
         if (.not. change(r) > least_pivot) cycle
         ratio = 0.0_wp
         if (share(r) > no_share) ratio = share(r)/change(r)
         if (ratio > least) cycle
         if (first > 0 .and. .not. ratio < least) then
            if (4*deficit%joint(r) + deficit%bound(r) > 4*deficit%joint(first) &
               & + deficit%bound(first)) cycle
         end if
         first = r
         least = ratio
      end do
   end function first_to_vanish

   !> Invert the rows by elimination with pivots
   pure subroutine invert(tableau)
      type(tableau_t), intent(inout) :: tableau
      real(wp) :: a(8, 4), swap(8)
      integer :: c, p, r

      a = 0.0_wp
      do r = 1, 4
         a(:4, r) = tableau%row(r, :)
         a(4 + r, r) = 1.0_wp
      end do
      tableau%usable = .false.
      do c = 1, 4
         p = c
         do r = c + 1, 4
            if (abs(a(c, r)) > abs(a(c, p))) p = r
         end do
         if (.not. abs(a(c, p)) > tiny(1.0_wp)) return
         swap = a(:, p)
         a(:, p) = a(:, c)
         a(:, c) = swap*(1.0_wp/swap(c))
         do r = 1, 4
            if (r /= c) a(:, r) = a(:, r) - a(c, r)*a(:, c)
         end do
      end do
      tableau%inverse = transpose(a(5:, :))
      tableau%usable = .true.
   end subroutine invert
end module dda_chain_programme
