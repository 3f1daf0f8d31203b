!> The springs of a chain's joints: bounds of their forces, and stiffness on the faces held
module dda_chain_stiffness
   use dda_chain, only : chain_t
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: add_joint, cone_of

contains

   !> Bounds of the force of one joint
   pure function cone_of(chain, j) result(cone)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Number of the joint
      integer, intent(in) :: j
      !> The bounds
      type(cone_t) :: cone

      cone = cone_t(friction=chain%friction(j), limit=chain%limit(j), &
         & mirror=chain%keystone .and. j == size(chain%half))
   end function cone_of

   !> Rows of one side of a joint: what its forces N1, N2, T are to a block
   pure function rows(chain, side, j)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> 1 for the block before the joint, 2 for the one behind it
      integer, intent(in) :: side
      !> Number of the joint
      integer, intent(in) :: j
      !> The rows: (3, 3)
      real(wp) :: rows(3, 3)

      rows(:, 1) = [chain%tangent(2, j), -chain%tangent(1, j), &
         & chain%arm(1, side, j) + chain%half(j)]
      rows(:, 2) = [chain%tangent(2, j), -chain%tangent(1, j), &
         & chain%arm(1, side, j) - chain%half(j)]
      rows(:, 3) = [chain%tangent(1, j), chain%tangent(2, j), chain%arm(2, side, j)]
      if (side == 1) rows = -rows
   end function rows

   !> Stiffness p R P R' of one joint, in the matrix of a chain
   pure subroutine add_joint(chain, face, stuck, j, before, behind, coupling)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Face of the joint
      type(joint_face_t), intent(in) :: face
      !> Whether it is the inside of the cone
      logical, intent(in) :: stuck
      !> Number of the joint
      integer, intent(in) :: j
      !> Diagonal block of the block before it, to which it adds: (3, 3)
      real(wp), intent(inout) :: before(3, 3)
      !> Diagonal block of the block behind it, of which it is the first part: (3, 3)
      real(wp), intent(out) :: behind(3, 3)
      !> Rows of the block behind it, columns of the block before it: (3, 3)
      real(wp), intent(out) :: coupling(3, 3)
      real(wp) :: tangent(3, 3), constant(3), left(3, 3), right(3, 3)

      if (stuck) then
         call add_stuck(chain%stiffness(j), chain%tangent(:, j), chain%half(j), &
            & chain%arm(:, 1, j), chain%arm(:, 2, j), before, behind, coupling)
         return
      end if
      call apply_face(cone_of(chain, j), face, tangent, constant)
      tangent = chain%stiffness(j)*tangent
      left = rows(chain, 1, j)
      right = rows(chain, 2, j)
      before = before + matmul(left, matmul(tangent, transpose(left)))
      behind = matmul(right, matmul(tangent, transpose(right)))
      coupling = matmul(right, matmul(tangent, transpose(left)))
   end subroutine add_joint

   !> The same where all three springs hold: two along the normal n and one along the tangent t
   pure subroutine add_stuck(p, t, half, a, b, before, behind, coupling)
      !> Stiffness of a spring [N/m per metre depth]
      real(wp), intent(in) :: p
      !> The tangent: (2)
      real(wp), intent(in) :: t(2)
      !> Half the length of the joint [m]
      real(wp), intent(in) :: half
      !> Moments of unit forces along n and t about the centre of the block before: (2) [m]
      real(wp), intent(in) :: a(2)
      !> Likewise about that of the block behind: (2) [m]
      real(wp), intent(in) :: b(2)
      !> Diagonal block of the block before it, to which it adds: (3, 3)
      real(wp), intent(inout) :: before(3, 3)
      !> Diagonal block of the block behind it, of which it is the first part: (3, 3)
      real(wp), intent(out) :: behind(3, 3)
      !> Rows of the block behind it, columns of the block before it: (3, 3)
      real(wp), intent(out) :: coupling(3, 3)
      real(wp) :: xx, xy, yy, n1, n2, ax, ay, bx, by, spin

      ! p (2 n n' + t t') = p (1 + n n')
      xy = -p*t(1)*t(2)
      xx = p + p*t(2)**2
      yy = p + p*t(1)**2
      n1 = 2.0_wp*p*t(2)
      n2 = -2.0_wp*p*t(1)
      ax = a(1)*n1 + a(2)*p*t(1)
      ay = a(1)*n2 + a(2)*p*t(2)
      bx = b(1)*n1 + b(2)*p*t(1)
      by = b(1)*n2 + b(2)*p*t(2)
      spin = 2.0_wp*half**2
      before(:, 1) = before(:, 1) + [xx, xy, ax]
      before(:, 2) = before(:, 2) + [xy, yy, ay]
      before(:, 3) = before(:, 3) + [ax, ay, p*(2.0_wp*a(1)**2 + spin + a(2)**2)]
      behind(:, 1) = [xx, xy, bx]
      behind(:, 2) = [xy, yy, by]
      behind(:, 3) = [bx, by, p*(2.0_wp*b(1)**2 + spin + b(2)**2)]
      coupling(:, 1) = [-xx, -xy, -bx]
      coupling(:, 2) = [-xy, -yy, -by]
      coupling(:, 3) = [-ax, -ay, -p*(2.0_wp*a(1)*b(1) + spin + a(2)*b(2))]
   end subroutine add_stuck
end module dda_chain_stiffness
