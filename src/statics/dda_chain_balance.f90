!> Balance of the forces of a chain: those of all joints follow from three numbers at one of them
module dda_chain_balance
   use dda_chain, only : chain_t
   use dda_friction_cone, only : cone_kind, cone_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: cone_of, sum_loads, joint_force, influence, holds, carry_forces, rounding_of_forces
   public :: add_reaction

   !> Relative error of a force that is carried from joint to joint
   real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)

contains

   !> Bounds of the force of one joint
   pure type(cone_t) function cone_of(chain, j)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: j  !! Number of the joint

      cone_of = cone_t(friction=chain%joint(j)%friction)
      if (chain%joint(j)%no_slip) cone_of = cone_t(kind=cone_kind%no_slip)
      if (chain%keystone .and. j == size(chain%joint)) cone_of = cone_t(kind=cone_kind%mirror)
   end function cone_of

   !> Sums of the loads before each joint, or of half a chain, less the sums of those behind it
   pure subroutine sum_loads(chain, load, turned)
      type(chain_t), intent(in) :: chain
      real(wp), intent(out) :: load(:, :)  !! The sums: (3, n + 1)
      !> Matrix that the weights are turned by; none leaves them as they are: (2, 2)
      real(wp), intent(in), optional :: turned(2, 2)
      real(wp) :: total(3), weight(2)
      integer :: ahead, b, n, way

      n = size(chain%block)
      total = 0.0_wp
      way = merge(-1, 1, chain%halved)
      ahead = merge(0, 1, chain%halved)
      load(:, merge(n + 1, 1, chain%halved)) = 0.0_wp
      do b = merge(n, 1, chain%halved), merge(1, n, chain%halved), way
         weight = chain%block(b)%weight
         if (present(turned)) weight = matmul(turned, weight)
         weight = real(way, wp)*weight
         associate (place => chain%block(b)%centroid)
            total(1:2) = total(1:2) + weight
            total(3) = total(3) + (place(1)*weight(2) - place(2)*weight(1))
         end associate
         load(:, b + ahead) = total
      end do
   end subroutine sum_loads

   !> Force N1, N2, T of one joint
   pure function joint_force(chain, load, reaction, j) result(force)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)   !! Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: reaction(3)  !! The unknowns
      integer, intent(in) :: j
      real(wp) :: force(3)                 !! The force
      real(wp) :: s(3), normal, moment

      s = reaction + load(:, j)
      associate (joint => chain%joint(j))
         normal = joint%tangent(2)*s(1) - joint%tangent(1)*s(2)
         force(3) = joint%tangent(1)*s(1) + joint%tangent(2)*s(2)
         moment = s(3) - joint%middle(1)*s(2) + joint%middle(2)*s(1)
         force(1) = (normal + moment/joint%half)/2.0_wp
         force(2) = (normal - moment/joint%half)/2.0_wp
      end associate
   end function joint_force

   !> What each unknown makes of the force of one joint
   pure function influence(chain, j) result(g)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: j
      real(wp) :: g(3, 3)  !! Rows N1, N2, T: (3, 3)
      real(wp) :: normal(3), moment(3)

      normal = [chain%joint(j)%tangent(2), -chain%joint(j)%tangent(1), 0.0_wp]
      moment = [chain%joint(j)%middle(2), -chain%joint(j)%middle(1), 1.0_wp]/chain%joint(j)%half
      g(1, :) = (normal + moment)/2.0_wp
      g(2, :) = (normal - moment)/2.0_wp
      g(3, :) = [chain%joint(j)%tangent, 0.0_wp]
   end function influence

   !> Whether a force lies inside the cone of a joint
   pure logical function holds(chain, force, j)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(3)  !! N1, N2, T [N/m]
      integer, intent(in) :: j

      holds = force(1) >= 0.0_wp .and. force(2) >= 0.0_wp .and. (chain%joint(j)%no_slip &
         & .or. abs(force(3)) <= chain%joint(j)%friction*(force(1) + force(2)))
   end function holds

   !> Forces of all joints after a change of the unknowns
   pure subroutine add_reaction(chain, change, before, after)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: change(3)     !! The change: (3)
      real(wp), intent(in) :: before(:, :)  !! Forces: (3, n + 1) [N/m]
      real(wp), intent(out) :: after(:, :)  !! Forces: (3, n + 1) [N/m]
      real(wp) :: normal, moment
      integer :: j

      do j = 1, size(before, 2)
         associate (joint => chain%joint(j))
            normal = joint%tangent(2)*change(1) - joint%tangent(1)*change(2)
            moment = (joint%middle(2)*change(1) - joint%middle(1)*change(2) + change(3))/joint%half
            after(1, j) = before(1, j) + (normal + moment)/2.0_wp
            after(2, j) = before(2, j) + (normal - moment)/2.0_wp
            after(3, j) = before(3, j) + joint%tangent(1)*change(1) + joint%tangent(2)*change(2)
         end associate
      end do
   end subroutine add_reaction

   !> Forces of all joints, each from that of its neighbour by the balance of the block between: the
   !> moment of a shallow arch, seen from afar, would lose its digits
   pure subroutine carry_forces(chain, load, reaction, force)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :), reaction(3)
      real(wp), intent(out) :: force(:, :)  !! The forces N1, N2, T: (3, n + 1) [N/m]
      real(wp) :: s(2), normal, along, moment
      integer :: b, from, ahead, n, side

      n = size(chain%block)
      from = merge(n + 1, 1, chain%halved)
      ahead = merge(-1, 1, chain%halved)
      side = merge(1, 2, chain%halved)
      force(:, from) = joint_force(chain, load, reaction, from)
      moment = (force(1, from) - force(2, from))*chain%joint(from)%half
      s = reaction(1:2) + load(1:2, from)
      normal = force(1, from) + force(2, from)
      along = force(3, from)
      do b = merge(n, 1, chain%halved), merge(1, n, chain%halved), ahead
         from = from + ahead
         moment = moment + chain%joint(from - ahead)%arm(1, side)*normal &
            & + chain%joint(from - ahead)%arm(2, side)*along
         s = s + real(ahead, wp)*chain%block(b)%weight
         associate (joint => chain%joint(from))
            normal = joint%tangent(2)*s(1) - joint%tangent(1)*s(2)
            along = joint%tangent(1)*s(1) + joint%tangent(2)*s(2)
            moment = moment - joint%arm(1, 3 - side)*normal - joint%arm(2, 3 - side)*along
            force(:, from) = [(normal + moment/joint%half)/2.0_wp, &
               & (normal - moment/joint%half)/2.0_wp, along]
         end associate
      end do
   end subroutine carry_forces

   !> Rounding of forces that are carried from joint to joint
   pure real(wp) function rounding_of_forces(chain, force) result(noise)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(:, :)
      integer :: j

      noise = 0.0_wp
      do j = 1, size(force, 2)
         noise = noise + max(abs(chain%joint(j)%arm(2, 1)), abs(chain%joint(j)%arm(2, 2))) &
            & *(abs(force(1, j)) + abs(force(2, j)) + abs(force(3, j)))
      end do
      noise = rounding*noise/minval(chain%joint%half)
   end function rounding_of_forces

end module dda_chain_balance
