!> Balance of the forces of a chain: those of all joints follow from three numbers at one of them.
!> Equations for these three numbers
module dda_chain_balance
   use dda_chain, only : chain_block_t, chain_joint_t, chain_t
   use dda_friction_cone, only : cone_kind, cone_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: add_reaction, carry_forces, cone_of, hold_upright, influence, solve_3, sum_loads

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

   !> Coefficients of the unknowns in the force of one joint
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

   !> Forces of all joints after a change of the unknowns
   pure subroutine add_reaction(chain, change, before, after)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: change(3)     !! The change: (3)
      !> Forces before it: (3, n + 1) [N/m]
      real(wp), intent(in) :: before(3, size(chain%joint))
      !> Forces after it: (3, n + 1) [N/m]
      real(wp), intent(out) :: after(3, size(chain%joint))
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

   !> Resultants of all joints, each from that of its neighbour by the balance of the block between:
   !> the moment of a shallow arch about a far point would lose its digits, and the normal force of
   !> a thin one as the sum of those at its corners
   pure subroutine carry_forces(chain, reaction, resultant, magnitude)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: reaction(3)  !! The unknowns: (3) [N/m, N/m, N]
      !> Normal force, moment over half the joint, and shear force: (3, n + 1) [N/m]
      real(wp), intent(out) :: resultant(3, size(chain%joint))
      !> Largest force of a corner by one component of the thrust alone, and the largest thrust: the
      !> rounding of coordinates changes forces of corners by a share of the first, normal and shear
      !> forces by one of the second: (2) [N/m]
      real(wp), intent(out) :: magnitude(2)

      call carry_on(chain%halved, size(chain%block), chain%block, chain%joint, reaction, &
         & resultant, magnitude)
   end subroutine carry_forces

   !> The same of arrays of known shapes
   pure subroutine carry_on(halved, n, block, joint, reaction, resultant, magnitude)
      logical, intent(in) :: halved  !! True if the first joint is the last one
      integer, intent(in) :: n       !! Number of blocks
      type(chain_block_t), intent(in) :: block(n)      !! The blocks
      type(chain_joint_t), intent(in) :: joint(n + 1)  !! The joints
      real(wp), intent(in) :: reaction(3)
      real(wp), intent(out) :: resultant(3, n + 1)     !! The resultants: (3, n + 1) [N/m]
      real(wp), intent(out) :: magnitude(2)            !! Of corners, of thrusts: (2) [N/m]
      real(wp) :: s(2), normal, along, moment, per_half
      integer :: ahead, i, j, side

      j = merge(n + 1, 1, halved)
      ahead = merge(-1, 1, halved)
      side = merge(1, 2, halved)
      s = reaction(1:2)
      moment = reaction(3) - joint(j)%middle(1)*s(2) + joint(j)%middle(2)*s(1)
      magnitude = 0.0_wp
      do i = 0, n
         if (i > 0) then
            moment = moment + joint(j)%arm(1, side)*normal + joint(j)%arm(2, side)*along
            j = j + ahead
            s = s + real(ahead, wp)*block(j + 1 - side)%weight
         end if
         normal = joint(j)%tangent(2)*s(1) - joint(j)%tangent(1)*s(2)
         along = joint(j)%tangent(1)*s(1) + joint(j)%tangent(2)*s(2)
         if (i > 0) moment = moment - joint(j)%arm(1, 3 - side)*normal &
            & - joint(j)%arm(2, 3 - side)*along
         per_half = 1.0_wp/joint(j)%half
         resultant(:, j) = [normal, moment*per_half, along]
         magnitude(1) = max(magnitude(1), (abs(s(1)*joint(j)%middle(2)) &
            & + abs(s(2)*joint(j)%middle(1)))*per_half + abs(normal))
         magnitude(2) = max(magnitude(2), abs(s(1)) + abs(s(2)))
      end do
   end subroutine carry_on

   !> Take the second of three unknowns out: a smooth plane bears no weight, and stops none
   pure subroutine hold_upright(slope, curvature)
      real(wp), intent(inout) :: slope(3)         !! First derivatives
      real(wp), intent(inout) :: curvature(3, 3)  !! Second derivatives

      slope(2) = 0.0_wp
      curvature(:, 2) = 0.0_wp
      curvature(2, :) = 0.0_wp
      curvature(2, 2) = 1.0_wp
   end subroutine hold_upright

   !> Solve three equations with a symmetric matrix that is positive definite, except for directions
   !> without stiffness, in which nothing moves
   pure subroutine solve_3(a, b, x)
      real(wp), intent(in) :: a(3, 3)  !! The matrix
      real(wp), intent(in) :: b(3)     !! Right-hand side
      real(wp), intent(out) :: x(3)    !! The solution
      real(wp) :: r(3), l21, l31, l32

      r(1) = inverse(a(1, 1))
      l21 = a(2, 1)*r(1)
      l31 = a(3, 1)*r(1)
      r(2) = inverse(a(2, 2) - l21*a(2, 1))
      l32 = (a(3, 2) - l31*a(2, 1))*r(2)
      r(3) = inverse(a(3, 3) - l31*a(3, 1) - l32*(a(3, 2) - l31*a(2, 1)))
      x(1) = b(1)
      x(2) = b(2) - l21*x(1)
      x(3) = b(3) - l31*x(1) - l32*x(2)
      x = x*r
      x(2) = x(2) - l32*x(3)
      x(1) = x(1) - l21*x(2) - l31*x(3)
   end subroutine solve_3

   !> One over a number, or 0
   pure real(wp) function inverse(number)
      real(wp), intent(in) :: number  !! The number

      inverse = 0.0_wp
      if (abs(number) > tiny(number)) inverse = 1.0_wp/number
   end function inverse
end module dda_chain_balance
