!> The springs of a chain's joints: bounds of their forces, and stiffness on the faces held
module dda_chain_stiffness
   use dda_chain, only : chain_t
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: add_stiffness, cone_of

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

   !> Stiffness p R P R' that a joint has between two sides, which may be the same
   pure subroutine add_stiffness(chain, face, stuck, first, second, j, stiffness)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Face of the joint
      type(joint_face_t), intent(in) :: face
      !> Whether it is the inside of the cone
      logical, intent(in) :: stuck
      !> Side whose rows these are
      integer, intent(in) :: first
      !> Side whose columns these are
      integer, intent(in) :: second
      !> Number of the joint
      integer, intent(in) :: j
      !> What the stiffness is added to: (3, 3)
      real(wp), intent(inout) :: stiffness(3, 3)
      real(wp) :: p, n(2), t(2), tangent(3, 3), constant(3)

      if (.not. stuck) then
         call apply_face(cone_of(chain, j), face, tangent, constant)
         stiffness = stiffness + chain%stiffness(j)*matmul(rows(chain, first, j), &
            & matmul(tangent, transpose(rows(chain, second, j))))
         return
      end if
      p = chain%stiffness(j)
      if (first /= second) p = -p
      t = p*chain%tangent(:, j)
      n(1) = t(2)
      n(2) = -t(1)
      associate (a => chain%arm(:, first, j), b => chain%arm(:, second, j), &
         & u => chain%tangent(:, j))
         stiffness(1, 1) = stiffness(1, 1) + p + n(1)*u(2)
         stiffness(2, 1) = stiffness(2, 1) + n(2)*u(2)
         stiffness(1, 2) = stiffness(1, 2) + n(2)*u(2)
         stiffness(2, 2) = stiffness(2, 2) + p - n(2)*u(1)
         stiffness(3, 1) = stiffness(3, 1) + 2.0_wp*a(1)*n(1) + a(2)*t(1)
         stiffness(3, 2) = stiffness(3, 2) + 2.0_wp*a(1)*n(2) + a(2)*t(2)
         stiffness(1, 3) = stiffness(1, 3) + 2.0_wp*b(1)*n(1) + b(2)*t(1)
         stiffness(2, 3) = stiffness(2, 3) + 2.0_wp*b(1)*n(2) + b(2)*t(2)
         stiffness(3, 3) = stiffness(3, 3) &
            & + p*(2.0_wp*(a(1)*b(1) + chain%half(j)**2) + a(2)*b(2))
      end associate
   end subroutine add_stiffness
end module dda_chain_stiffness
