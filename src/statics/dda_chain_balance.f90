!> Balance of the forces of a chain: those of all joints follow from three numbers at one of them
module dda_chain_balance
   use dda_chain, only : chain_t
   use dda_friction_cone, only : cone_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: cone_of, sum_loads, joint_force, influence, holds, carry_forces, rounding_of_forces
   public :: find_failing, see_failing, add_reaction

   !> Relative error of a force that is carried from joint to joint
   real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)

contains

   !> Bounds of the force of one joint
   pure type(cone_t) function cone_of(chain, j)
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j

      cone_of = cone_t(friction=chain%friction(j), limit=chain%limit(j), &
         & mirror=chain%keystone .and. j == size(chain%half))
   end function cone_of

   !> Sums of the loads before each joint, or of half a chain, less the sums of those behind it
   pure subroutine sum_loads(chain, load, turned)
      type(chain_t), intent(in) :: chain
      !> The sums: (3, n + 1)
      real(wp), intent(out) :: load(:, :)
      !> Matrix that the weights are turned by; none leaves them as they are: (2, 2)
      real(wp), intent(in), optional :: turned(2, 2)
      real(wp) :: weight(2, size(chain%mass)), total(3)
      integer :: b

      total = 0.0_wp
      weight = chain%weight
      if (present(turned)) weight = matmul(turned, weight)
      if (chain%halved) then
         load(:, size(chain%half)) = 0.0_wp
         do b = size(chain%mass), 1, -1
            total(1) = total(1) - weight(1, b)
            total(2) = total(2) - weight(2, b)
            total(3) = total(3) - moment_of(chain%centroid(:, b), weight(:, b))
            load(:, b) = total
         end do
      else
         load(:, 1) = 0.0_wp
         do b = 1, size(chain%mass)
            total(1) = total(1) + weight(1, b)
            total(2) = total(2) + weight(2, b)
            total(3) = total(3) + moment_of(chain%centroid(:, b), weight(:, b))
            load(:, b + 1) = total
         end do
      end if
   end subroutine sum_loads

   !> Moment of a force about the origin [N]
   pure real(wp) function moment_of(place, force)
      !> Where it acts: (2) [m]
      real(wp), intent(in) :: place(2)
      !> The force: (2) [N/m]
      real(wp), intent(in) :: force(2)

      moment_of = place(1)*force(2) - place(2)*force(1)
   end function moment_of

   !> Force N1, N2, T of one joint
   pure function joint_force(chain, load, reaction, j) result(force)
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> The unknowns
      real(wp), intent(in) :: reaction(3)
      integer, intent(in) :: j
      !> The force
      real(wp) :: force(3)
      real(wp) :: s(3), normal, moment

      s = reaction + load(:, j)
      normal = chain%tangent(2, j)*s(1) - chain%tangent(1, j)*s(2)
      force(3) = chain%tangent(1, j)*s(1) + chain%tangent(2, j)*s(2)
      moment = s(3) - chain%middle(1, j)*s(2) + chain%middle(2, j)*s(1)
      force(1) = (normal + moment/chain%half(j))/2.0_wp
      force(2) = (normal - moment/chain%half(j))/2.0_wp
   end function joint_force

   !> What each unknown makes of the force of one joint
   pure function influence(chain, j) result(g)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: j
      !> Rows N1, N2, T: (3, 3)
      real(wp) :: g(3, 3)
      real(wp) :: normal(3), moment(3)

      normal = [chain%tangent(2, j), -chain%tangent(1, j), 0.0_wp]
      moment = [chain%middle(2, j), -chain%middle(1, j), 1.0_wp]/chain%half(j)
      g(1, :) = (normal + moment)/2.0_wp
      g(2, :) = (normal - moment)/2.0_wp
      g(3, :) = [chain%tangent(:, j), 0.0_wp]
   end function influence

   !> Whether a force lies inside the cone of a joint
   pure logical function holds(chain, force, j)
      type(chain_t), intent(in) :: chain
      !> N1, N2, T [N/m]
      real(wp), intent(in) :: force(3)
      integer, intent(in) :: j

      holds = force(1) >= 0.0_wp .and. force(2) >= 0.0_wp &
         & .and. abs(force(3)) <= chain%limit(j) + chain%friction(j)*(force(1) + force(2))
   end function holds

   !> Those of some joints whose forces lie outside their cones, with these forces
   pure subroutine find_failing(chain, load, reaction, watched, n, failing, force)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :), reaction(3)
      !> The joints
      integer, intent(in) :: watched(:)
      !> How many fail
      integer, intent(out) :: n
      !> Their numbers: (n), with room for all that are watched
      integer, intent(out) :: failing(:)
      !> Forces N1, N2, T of them: (3, n), likewise [N/m]
      real(wp), intent(out) :: force(:, :)
      real(wp) :: normal, along, moment, s(3)
      integer :: i, j

      n = 0
      do i = 1, size(watched)
         j = watched(i)
         ! as in `joint_force` and `holds`, whose calls would take most of the time
         s = reaction + load(:, j)
         normal = chain%tangent(2, j)*s(1) - chain%tangent(1, j)*s(2)
         along = chain%tangent(1, j)*s(1) + chain%tangent(2, j)*s(2)
         moment = (s(3) - chain%middle(1, j)*s(2) + chain%middle(2, j)*s(1))/chain%half(j)
         if (normal >= abs(moment) &
            & .and. abs(along) <= chain%limit(j) + chain%friction(j)*normal) cycle
         n = n + 1
         failing(n) = j
         force(:, n) = [(normal + moment)/2.0_wp, (normal - moment)/2.0_wp, along]
      end do
   end subroutine find_failing

   !> Which joints have forces outside their cones
   pure subroutine see_failing(chain, force, n, failing)
      type(chain_t), intent(in) :: chain
      !> Forces of all joints: (3, n + 1) [N/m]
      real(wp), intent(in) :: force(:, :)
      integer, intent(out) :: n, failing(:)
      integer :: j

      n = 0
      do j = 1, size(force, 2)
         if (holds(chain, force(:, j), j)) cycle
         n = n + 1
         failing(n) = j
      end do
   end subroutine see_failing

   !> Forces of all joints after a change of the unknowns
   pure subroutine add_reaction(chain, change, before, after)
      type(chain_t), intent(in) :: chain
      !> The change: (3)
      real(wp), intent(in) :: change(3)
      !> Forces: (3, n + 1) [N/m]
      real(wp), intent(in) :: before(:, :)
      !> Forces: (3, n + 1) [N/m]
      real(wp), intent(out) :: after(:, :)
      real(wp) :: normal, moment
      integer :: j

      do j = 1, size(before, 2)
         normal = chain%tangent(2, j)*change(1) - chain%tangent(1, j)*change(2)
         moment = (chain%middle(2, j)*change(1) - chain%middle(1, j)*change(2) + change(3)) &
            & /chain%half(j)
         after(1, j) = before(1, j) + (normal + moment)/2.0_wp
         after(2, j) = before(2, j) + (normal - moment)/2.0_wp
         after(3, j) = before(3, j) + chain%tangent(1, j)*change(1) + chain%tangent(2, j)*change(2)
      end do
   end subroutine add_reaction

   !> Forces of all joints, each from that of its neighbour by the balance of the block between: the
   !> moment of a shallow arch, seen from afar, would lose its digits
   pure subroutine carry_forces(chain, load, reaction, force)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :), reaction(3)
      !> The forces N1, N2, T: (3, n + 1) [N/m]
      real(wp), intent(out) :: force(:, :)
      real(wp) :: s(2), normal, along, moment
      integer :: b, from, ahead, n, side

      n = size(chain%mass)
      from = merge(n + 1, 1, chain%halved)
      ahead = merge(-1, 1, chain%halved)
      side = merge(1, 2, chain%halved)
      force(:, from) = joint_force(chain, load, reaction, from)
      moment = (force(1, from) - force(2, from))*chain%half(from)
      s = reaction(1:2) + load(1:2, from)
      normal = force(1, from) + force(2, from)
      along = force(3, from)
      do b = merge(n, 1, chain%halved), merge(1, n, chain%halved), ahead
         from = from + ahead
         moment = moment + chain%arm(1, side, from - ahead)*normal &
            & + chain%arm(2, side, from - ahead)*along
         s = s + real(ahead, wp)*chain%weight(:, b)
         normal = chain%tangent(2, from)*s(1) - chain%tangent(1, from)*s(2)
         along = chain%tangent(1, from)*s(1) + chain%tangent(2, from)*s(2)
         moment = moment - chain%arm(1, 3 - side, from)*normal - chain%arm(2, 3 - side, from)*along
         force(1, from) = (normal + moment/chain%half(from))/2.0_wp
         force(2, from) = (normal - moment/chain%half(from))/2.0_wp
         force(3, from) = along
      end do
   end subroutine carry_forces

   !> Rounding of forces that are carried from joint to joint
   pure real(wp) function rounding_of_forces(chain, force) result(noise)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(:, :)
      integer :: j

      noise = 0.0_wp
      do j = 1, size(force, 2)
         noise = noise + max(abs(chain%arm(2, 1, j)), abs(chain%arm(2, 2, j))) &
            & *(abs(force(1, j)) + abs(force(2, j)) + abs(force(3, j)))
      end do
      noise = rounding*noise/minval(chain%half)
   end function rounding_of_forces

end module dda_chain_balance
