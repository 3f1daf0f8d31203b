!> The springs of a chain's joints: bounds of their forces, and stiffness on the faces held
module dda_chain_stiffness
   use dda_chain, only : chain_t
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_stiffness_t, joint_stiffness, cone_of

   !> What one joint adds to the matrix
   type :: joint_stiffness_t
      !> To the diagonal block of the block before it: (3, 3)
      real(wp) :: before(3, 3)
      !> To that of the block behind it: (3, 3)
      real(wp) :: behind(3, 3)
      !> Rows of the block behind it, columns of the block before it: (3, 3)
      real(wp) :: coupling(3, 3)
   end type joint_stiffness_t

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

   !> Stiffness p R P R' of one joint
   pure function joint_stiffness(chain, face, stuck, j) result(part)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Face of the joint
      type(joint_face_t), intent(in) :: face
      !> Whether it is the inside of the cone
      logical, intent(in) :: stuck
      !> Number of the joint
      integer, intent(in) :: j
      !> What it adds
      type(joint_stiffness_t) :: part
      real(wp) :: tangent(3, 3), constant(3), before(3, 3), behind(3, 3)

      if (stuck) then
         part = stuck_stiffness(chain%stiffness(j), chain%tangent(:, j), chain%half(j), &
            & chain%arm(:, 1, j), chain%arm(:, 2, j))
         return
      end if
      call apply_face(cone_of(chain, j), face, tangent, constant)
      tangent = chain%stiffness(j)*tangent
      before = rows(chain, 1, j)
      behind = rows(chain, 2, j)
      part%before = matmul(before, matmul(tangent, transpose(before)))
      part%behind = matmul(behind, matmul(tangent, transpose(behind)))
      part%coupling = matmul(behind, matmul(tangent, transpose(before)))
   end function joint_stiffness

   !> The same where all three springs hold: two along the normal n and one along the tangent t
   pure function stuck_stiffness(p, t, half, a, b) result(part)
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
      !> What the joint adds
      type(joint_stiffness_t) :: part
      real(wp) :: xx, xy, yy, n1, n2, t1, t2, ax, ay, bx, by, spin

      ! p (2 n n' + t t') = p (1 + n n')
      xy = -p*t(1)*t(2)
      xx = p + p*t(2)**2
      yy = p + p*t(1)**2
      n1 = 2.0_wp*p*t(2)
      n2 = -2.0_wp*p*t(1)
      t1 = p*t(1)
      t2 = p*t(2)
      ax = a(1)*n1 + a(2)*t1
      ay = a(1)*n2 + a(2)*t2
      bx = b(1)*n1 + b(2)*t1
      by = b(1)*n2 + b(2)*t2
      spin = 2.0_wp*half**2
      part%before(:, 1) = [xx, xy, ax]
      part%before(:, 2) = [xy, yy, ay]
      part%before(:, 3) = [ax, ay, p*(2.0_wp*a(1)**2 + spin + a(2)**2)]
      part%behind(:, 1) = [xx, xy, bx]
      part%behind(:, 2) = [xy, yy, by]
      part%behind(:, 3) = [bx, by, p*(2.0_wp*b(1)**2 + spin + b(2)**2)]
      part%coupling(:, 1) = [-xx, -xy, -bx]
      part%coupling(:, 2) = [-xy, -yy, -by]
      part%coupling(:, 3) = [-ax, -ay, -p*(2.0_wp*a(1)*b(1) + spin + a(2)*b(2))]
   end function stuck_stiffness
end module dda_chain_stiffness
