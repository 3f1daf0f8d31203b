!> The power of the loads on a collapse of a chain whose joints keep to their faces: as smooth a
!> function of the chain's shape as that of any blocks, but found by kinematics alone
!>
!> The joints that open or slide make the mechanism: all blocks between two of them move as one. In
!> another shape of the chain the openings must still close the row, from one fixed block to the
!> other; the nearest ones that do are taken.
module dda_chain_power
   use dda_chain, only : chain_t
   use dda_chain_balance, only : hold_upright, influence, solve_3
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_mechanism_t, freeze_mechanism, chain_power

   !> The joints of a collapse that are not stuck, frozen
   type :: chain_mechanism_t
      !> Their numbers, rising: (m)
      integer, allocatable :: joint(:)
      !> What their faces let open and slide: projectors (3, 3, m)
      real(wp), allocatable :: free(:, :, :)
      !> Openings and slip: (3, m), the largest 1
      real(wp), allocatable :: opening(:, :)
   end type chain_mechanism_t

contains

   !> Freeze the joints of a collapse
   pure subroutine freeze_mechanism(chain, face, increment, mechanism)
      !> The chain that falls
      type(chain_t), intent(in) :: chain
      !> Faces of its joints: (n + 1)
      type(joint_face_t), intent(in) :: face(:)
      !> Opening at the two corners and slip in the last step: (3, n + 1) [m]
      real(wp), intent(in) :: increment(:, :)
      !> The mechanism
      type(chain_mechanism_t), intent(out) :: mechanism
      type(joint_face_t) :: held(size(face))
      real(wp) :: tangent(3, 3), constant(3)
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
         call apply_face(cone_t(friction=chain%friction(j)), held(j), tangent, constant)
         mechanism%free(:, :, i) = -tangent
         do k = 1, 3
            mechanism%free(k, k, i) = 1.0_wp - tangent(k, k)
         end do
         mechanism%opening(:, i) = matmul(mechanism%free(:, :, i), increment(:, j))
      end do
      if (m > 0) mechanism%opening = mechanism%opening/maxval(abs(mechanism%opening))
   end subroutine freeze_mechanism

   !> Power of the loads on a frozen mechanism
   pure subroutine chain_power(mechanism, chain, power, noise, usable)
      !> The mechanism
      type(chain_mechanism_t), intent(in) :: mechanism
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Power: positive where the mechanism moves by itself
      real(wp), intent(out) :: power
      !> What the rounding of weights, and of motions far from where they turn, makes of it
      real(wp), intent(out) :: noise
      !> Whether there is a mechanism
      logical, intent(out) :: usable
      real(wp) :: opening(3, size(mechanism%joint)), twist(3), work, scale
      integer :: b, i, last

      power = 0.0_wp
      noise = 0.0_wp
      usable = size(mechanism%joint) > 0
      if (.not. usable) return
      call close_row(mechanism, chain, opening)
      scale = 0.0_wp
      twist = 0.0_wp
      do i = 1, size(mechanism%joint)
         twist = twist + matmul(opening(:, i), influence(chain, mechanism%joint(i)))
         last = size(chain%mass)
         if (i < size(mechanism%joint)) last = mechanism%joint(i + 1) - 1
         do b = mechanism%joint(i), last
            work = chain%weight(1, b)*(twist(1) - twist(3)*chain%centroid(2, b)) &
               & + chain%weight(2, b)*(twist(2) + twist(3)*chain%centroid(1, b))
            power = power + work
            noise = noise + chain%rounding(b)*(abs(chain%weight(1, b))*(abs(twist(1)) &
               & + abs(twist(3)*chain%centroid(2, b))) + abs(chain%weight(2, b)) &
               & *(abs(twist(2)) + abs(twist(3)*chain%centroid(1, b))))
            scale = scale + chain%mass(b)
         end do
      end do
      usable = scale > 0.0_wp
      power = power/max(scale, tiny(1.0_wp))
      noise = noise/max(scale, tiny(1.0_wp))
   end subroutine chain_power

   !> Openings nearest to the frozen ones that bring the last block where it is fixed, or to where
   !> it stays on a plane of symmetry, upright or not
   pure subroutine close_row(mechanism, chain, opening)
      !> The mechanism
      type(chain_mechanism_t), intent(in) :: mechanism
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The openings: (3, m)
      real(wp), intent(out) :: opening(:, :)
      real(wp) :: g(3, 3), lack(3), matrix(3, 3), multiplier(3)
      integer :: i, pass

      opening = mechanism%opening
      ! the second pass takes out what rounding left of the first
      do pass = 1, 2
         lack = 0.0_wp
         matrix = 0.0_wp
         do i = 1, size(mechanism%joint)
            g = influence(chain, mechanism%joint(i))
            lack = lack + matmul(opening(:, i), g)
            matrix = matrix + matmul(transpose(g), matmul(mechanism%free(:, :, i), g))
         end do
         if (chain%halved) call hold_upright(lack, matrix)
         call solve_3(matrix, lack, multiplier)
         do i = 1, size(mechanism%joint)
            g = influence(chain, mechanism%joint(i))
            opening(:, i) = opening(:, i) - matmul(mechanism%free(:, :, i), matmul(g, multiplier))
         end do
      end do
   end subroutine close_row
end module dda_chain_power
