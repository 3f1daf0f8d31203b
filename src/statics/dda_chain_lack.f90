!> What the forces of a chain lack to lie in their cones, and the power of the loads on a collapse
!> of it: what a search over its shape goes by, found by statics alone
!>
!> Sought is the least s for which forces in balance with the loads exist that keep
!>
!>    N1 + s >= 0,  N2 + s >= 0,  limit + friction*(N1 + N2) - |T| + s >= 0
!>
!> at all joints, by the dual simplex method: the bound that is broken most comes in, the one whose
!> multiplier vanishes first goes out. A chain falls where s is positive, and the bounds that make
!> it so are its mechanism. No verdict rests on it: it tells where to decide.
!>
!> The joints that open or slide make the mechanism. Forces in balance with the loads do as much
!> work on its openings as the loads do on the blocks between: as smooth a function of the chain's
!> shape as that of any blocks.
module dda_chain_lack
   use dda_chain, only : chain_t
   use dda_chain_balance, only : carry_forces, influence, joint_force, rounding_of_forces, sum_loads
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t
   use dda_kinds, only : wp
   use dda_three_unknowns, only : hold_upright, solve_3
   implicit none
   private

   public :: lack_t, find_lack, faces_of, chain_mechanism_t, freeze_mechanism, chain_power

   !> Four bounds, and what the forces between them lack
   type :: lack_t
      real(wp) :: least = 0.0_wp  !! The least s: positive where the chain falls [N/m]
      !> Joints of the bounds; 0 for one that only keeps the unknowns finite
      integer :: joint(4) = 0
      !> Which of their bounds: 1 and 2 at the corners, 3 and 4 of shear forces along the joint and
      !> against it
      integer :: bound(4) = 0
      !> Multipliers of the bounds, of the sum 1 but for shares of no mechanism
      real(wp) :: share(4) = 0.0_wp
      real(wp) :: reaction(3) = 0.0_wp  !! The forces' unknowns: (3) [N/m, N/m, N]
      integer :: exchanges = 0          !! Bounds that came in on the way from those that were given
      logical :: known = .false.        !! Whether s was found
   end type lack_t

   !> Most bounds that come in
   integer, parameter :: max_exchanges = 40
   !> Forces beyond their bounds by less than this share of the load do not count
   real(wp), parameter :: little = 1.0e-12_wp
   !> Multipliers below this are none
   real(wp), parameter :: no_share = 1.0e-9_wp
   !> How far from zero the unknowns may go, over the load
   real(wp), parameter :: far = 1.0e3_wp

   !> The joints of a collapse that are not stuck, frozen
   type :: chain_mechanism_t
      integer, allocatable :: joint(:)  !! Their numbers, rising: (m)
      !> What their faces let open and slide: projectors (3, 3, m)
      real(wp), allocatable :: free(:, :, :)
      real(wp), allocatable :: opening(:, :)  !! Openings and slip: (3, m), the largest 1
   end type chain_mechanism_t

contains

   !> Find what the forces of a chain lack
   pure subroutine find_lack(chain, lack)
      type(chain_t), intent(in) :: chain
      !> Bounds to begin with, of a chain much like this one, or none; those of this one out
      type(lack_t), intent(inout) :: lack
      real(wp) :: load(3, size(chain%joint)), inverse(4, 4), value(4), row(5), change(4), place(4)
      integer :: joint, bound, leaving

      call sum_loads(chain, load)
      call begin(chain, load, lack, inverse, value)
      lack%known = .false.
      do
         place = matmul(inverse, value)
         call find_worst(chain, load, place, joint, bound)
         if (joint == 0) exit
         row = bound_row(chain, load, joint, bound)
         change = matmul(row(:4), inverse)
         leaving = first_to_vanish(inverse(4, :), change)
         if (leaving == 0 .or. lack%exchanges == max_exchanges) return
         call exchange(leaving, change, inverse)
         value(leaving) = row(5)
         lack%joint(leaving) = joint
         lack%bound(leaving) = bound
         lack%exchanges = lack%exchanges + 1
      end do
      lack%least = place(4)
      lack%reaction = place(:3)
      lack%share = inverse(4, :)
      lack%known = .not. any(lack%joint == 0 .and. abs(lack%share) > no_share)
   end subroutine find_lack

   !> Faces of the joints on which a mechanism turns and slides
   pure function faces_of(chain, lack) result(face)
      type(chain_t), intent(in) :: chain
      type(lack_t), intent(in) :: lack
      type(joint_face_t) :: face(size(chain%joint))  !! The faces: (n + 1)
      integer :: r

      do r = 1, 4
         if (lack%joint(r) == 0 .or. lack%share(r) <= no_share) cycle
         associate (this => face(lack%joint(r)))
            if (lack%bound(r) <= 2) then
               this%open(lack%bound(r)) = .true.
            else
               this%slip = merge(1, -1, lack%bound(r) == 3)
            end if
         end associate
      end do
   end function faces_of

   !> Begin with the given bounds, or if these are none to begin with, with such as keep the
   !> unknowns finite
   pure subroutine begin(chain, load, lack, inverse, value)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)      !! Sums of the loads: (3, n + 1)
      type(lack_t), intent(inout) :: lack
      real(wp), intent(out) :: inverse(4, 4)  !! Inverse of the rows of the bounds: (4, 4)
      real(wp), intent(out) :: value(4)       !! What these rows times the unknowns are
      type(lack_t) :: given
      real(wp) :: change(4), row(5)
      integer :: i, r

      given = lack
      lack = lack_t()
      call keep_finite(chain, inverse, value)
      do i = 1, 4
         if (given%joint(i) == 0) cycle
         row = bound_row(chain, load, given%joint(i), given%bound(i))
         change = matmul(row(:4), inverse)
         r = maxloc(abs(change), mask=lack%joint == 0, dim=1)
         if (.not. abs(change(r)) > no_share) exit
         call exchange(r, change, inverse)
         value(r) = row(5)
         lack%joint(r) = given%joint(i)
         lack%bound(r) = given%bound(i)
      end do
      if (i > 4 .and. all(inverse(4, :) >= -no_share)) return
      lack = lack_t()
      call keep_finite(chain, inverse, value)
   end subroutine begin

   !> Bounds of the unknowns alone; a smooth plane of symmetry bears no weight
   pure subroutine keep_finite(chain, inverse, value)
      type(chain_t), intent(in) :: chain
      real(wp), intent(out) :: inverse(4, 4), value(4)
      integer :: i

      inverse = 0.0_wp
      do i = 1, 4
         inverse(i, i) = 1.0_wp
      end do
      value = -far*chain%whole_load
      value(3) = value(3)*maxval(max(abs(chain%joint%middle(1)), abs(chain%joint%middle(2))))
      if (chain%halved) value(2) = 0.0_wp
   end subroutine keep_finite

   !> The bound that is broken most; joint 0 if none is
   pure subroutine find_worst(chain, load, place, joint, bound)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: place(4)  !! The unknowns, and s
      integer, intent(out) :: joint     !! Its joint
      integer, intent(out) :: bound     !! Which of its bounds
      real(wp) :: along, force(3), least, moment, normal, room, s(3)
      integer :: j

      least = -place(4) - little*chain%whole_load
      joint = 0
      bound = 0
      do j = 1, last_joint(chain)
         s = place(:3) + load(:, j)
         associate (this => chain%joint(j))
            normal = this%tangent(2)*s(1) - this%tangent(1)*s(2)
            along = abs(this%tangent(1)*s(1) + this%tangent(2)*s(2))
            moment = abs(s(3) - this%middle(1)*s(2) + this%middle(2)*s(1))
            room = (normal - moment/this%half)/2.0_wp
            if (is_rough(chain, j)) room = min(room, this%friction*normal - along)
         end associate
         if (.not. room < least) cycle
         least = room
         joint = j
      end do
      if (joint == 0) return
      force = joint_force(chain, load, place(:3), joint)
      bound = merge(1, 2, force(1) < force(2))
      if (is_rough(chain, joint) .and. minval(force(:2)) > least &
         & + little*chain%whole_load) bound = merge(3, 4, force(3) > 0.0_wp)
   end subroutine find_worst

   !> The last joint that can fail: a plane of symmetry through a block does not open
   pure integer function last_joint(chain)
      type(chain_t), intent(in) :: chain

      last_joint = size(chain%joint) - merge(1, 0, chain%keystone)
   end function last_joint

   !> Whether the shear force of a joint is bounded, and not zero as on a plane of symmetry
   pure logical function is_rough(chain, j)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: j  !! Number of the joint

      is_rough = .not. chain%joint(j)%no_slip &
         & .and. .not. (chain%halved .and. j == size(chain%joint))
   end function is_rough

   !> A bound as a row over the unknowns and s, and its value: (5)
   pure function bound_row(chain, load, joint, bound) result(row)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      integer, intent(in) :: joint  !! Number of the joint
      integer, intent(in) :: bound
      real(wp) :: row(5)            !! The row
      real(wp), parameter :: nothing(3) = 0.0_wp
      real(wp) :: force(3), g(3, 3)

      g = influence(chain, joint)
      force = joint_force(chain, load, nothing, joint)
      if (bound <= 2) then
         row(:3) = g(bound, :)
         row(5) = -force(bound)
      else
         row(:3) = chain%joint(joint)%friction*(g(1, :) + g(2, :)) &
            & + merge(-1, 1, bound == 3)*g(3, :)
         row(5) = -chain%joint(joint)%friction*(force(1) + force(2)) &
            & - merge(-1, 1, bound == 3)*force(3)
      end if
      if (chain%halved) row(2) = 0.0_wp
      row(4) = 1.0_wp
   end function bound_row

   !> The bound whose multiplier vanishes first as another one's grows; 0 if none does
   pure integer function first_to_vanish(share, change) result(first)
      real(wp), intent(in) :: share(4)   !! Multipliers: (4)
      real(wp), intent(in) :: change(4)  !! What of each goes into the other one's: (4)
      real(wp) :: least
      integer :: r

      first = 0
      least = 0.0_wp
      do r = 1, 4
         if (.not. change(r) > no_share) cycle
         if (first > 0 .and. .not. max(share(r), 0.0_wp) < least*change(r)) cycle
         first = r
         least = max(share(r), 0.0_wp)/change(r)
      end do
   end function first_to_vanish

   !> Put another row in the place of one
   pure subroutine exchange(r, change, inverse)
      integer, intent(in) :: r           !! The place
      real(wp), intent(in) :: change(4)  !! The other row times the inverse: (4)
      real(wp), intent(inout) :: inverse(4, 4)
      integer :: i

      inverse(:, r) = inverse(:, r)/change(r)
      do i = 1, 4
         if (i /= r) inverse(:, i) = inverse(:, i) - change(i)*inverse(:, r)
      end do
   end subroutine exchange

   !> Freeze the joints of a collapse. Their openings are what the forces that least hinder it leave
   pure subroutine freeze_mechanism(chain, face, mechanism)
      type(chain_t), intent(in) :: chain
      type(joint_face_t), intent(in) :: face(:)  !! Faces of its joints: (n + 1)
      type(chain_mechanism_t), intent(out) :: mechanism
      type(joint_face_t) :: held(size(face))
      real(wp) :: tangent(3, 3), constant(3), force(3, size(face)), carried
      integer :: i, j, k, m

      held = face
      ! what slides along a smooth plane of symmetry closes by itself
      if (chain%halved) held(size(face))%slip = 0
      m = count(.not. is_stuck(held))
      allocate (mechanism%joint(m), mechanism%free(3, 3, m), mechanism%opening(3, m))
      i = 0
      do j = 1, size(face)
         if (is_stuck(held(j))) cycle
         i = i + 1
         mechanism%joint(i) = j
         call apply_face(cone_t(friction=chain%joint(j)%friction), held(j), tangent, constant)
         mechanism%free(:, :, i) = -tangent
         do k = 1, 3
            mechanism%free(k, k, i) = 1.0_wp - tangent(k, k)
         end do
      end do
      if (m == 0) return
      call find_forces(mechanism, chain, force, carried)
      do i = 1, m
         mechanism%opening(:, i) = -matmul(mechanism%free(:, :, i), force(:, mechanism%joint(i)))
      end do
      mechanism%opening = mechanism%opening/max(maxval(abs(mechanism%opening)), tiny(1.0_wp))
   end subroutine freeze_mechanism

   !> Power of the loads on a frozen mechanism: that of any forces in balance with them, on its
   !> openings. The forces taken are those that least hinder it, small numbers at its joints, as the
   !> weights times their motions are not; and openings that do not quite close the row in this
   !> shape do no harm
   pure subroutine chain_power(mechanism, chain, power, noise, usable)
      type(chain_mechanism_t), intent(in) :: mechanism
      type(chain_t), intent(in) :: chain
      !> Power over the mass: positive where the mechanism moves by itself
      real(wp), intent(out) :: power
      real(wp), intent(out) :: noise  !! What rounding makes of it
      logical, intent(out) :: usable  !! Whether there is a mechanism
      real(wp) :: carried, force(3, size(chain%joint)), mass
      integer :: i, j

      power = 0.0_wp
      noise = 0.0_wp
      usable = size(mechanism%joint) > 0
      if (.not. usable) return
      call find_forces(mechanism, chain, force, carried)
      do i = 1, size(mechanism%joint)
         j = mechanism%joint(i)
         power = power - dot_product(mechanism%opening(:, i), force(:, j))
         noise = noise + sum(abs(mechanism%opening(:, i)))*carried
      end do
      mass = chain%mean_mass*real(size(chain%block), wp)
      power = power/mass
      noise = noise/mass
   end subroutine chain_power

   !> Forces in balance with the loads that least hinder a mechanism
   pure subroutine find_forces(mechanism, chain, force, noise)
      type(chain_mechanism_t), intent(in) :: mechanism
      type(chain_t), intent(in) :: chain
      !> Forces of its joints; of the others not to the last digit: (3, n + 1) [N/m]
      real(wp), intent(out) :: force(3, size(chain%joint))
      real(wp), intent(out) :: noise  !! What rounding makes of one [N/m]
      real(wp) :: load(3, size(force, 2)), reaction(3), change(3)
      integer :: i, j

      call sum_loads(chain, load)
      reaction = 0.0_wp
      do i = 1, size(mechanism%joint)
         j = mechanism%joint(i)
         force(:, j) = joint_force(chain, load, reaction, j)
      end do
      call find_reaction(mechanism, chain, force, reaction)
      call carry_forces(chain, load, reaction, force)
      noise = rounding_of_forces(chain, force)
      call find_reaction(mechanism, chain, force, change)
      do i = 1, size(mechanism%joint)
         j = mechanism%joint(i)
         force(:, j) = force(:, j) + matmul(influence(chain, j), change)
      end do
   end subroutine find_forces

   !> Change of the unknowns that brings the forces nearest to what the open joints let pass
   pure subroutine find_reaction(mechanism, chain, force, change)
      type(chain_mechanism_t), intent(in) :: mechanism
      type(chain_t), intent(in) :: chain
      !> Forces of the joints; those of the mechanism count: (3, n + 1) [N/m]
      real(wp), intent(in) :: force(:, :)
      real(wp), intent(out) :: change(3)  !! The change: (3) [N/m, N/m, N]
      real(wp) :: free(3), g(3, 3), matrix(3, 3), slope(3)
      integer :: c, i, r

      slope = 0.0_wp
      matrix = 0.0_wp
      do i = 1, size(mechanism%joint)
         g = influence(chain, mechanism%joint(i))
         do c = 1, 3
            free = mechanism%free(:, 1, i)*g(1, c) + mechanism%free(:, 2, i)*g(2, c) &
               & + mechanism%free(:, 3, i)*g(3, c)
            slope(c) = slope(c) + dot_product(force(:, mechanism%joint(i)), free)
            do r = 1, 3
               matrix(r, c) = matrix(r, c) + dot_product(g(:, r), free)
            end do
         end do
      end do
      if (chain%halved) call hold_upright(slope, matrix)
      call solve_3(matrix, -slope, change)
   end subroutine find_reaction

end module dda_chain_lack
