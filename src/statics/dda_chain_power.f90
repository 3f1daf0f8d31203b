!> The power of the loads on a collapse of a chain whose joints keep to their faces: as smooth a
!> function of the chain's shape as that of any blocks, but found by statics alone
!>
!> The joints that open or slide make the mechanism. Forces in balance with the loads do as much
!> work on its openings as the loads do on the blocks between.
module dda_chain_power
   use dda_chain, only : chain_t
   use dda_chain_balance, only : carry_forces, influence, joint_force, rounding_of_forces, sum_loads
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t
   use dda_kinds, only : wp
   use dda_three_unknowns, only : hold_upright, solve_3
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

   !> Freeze the joints of a collapse. Their openings are what the forces that least hinder it leave
   pure subroutine freeze_mechanism(chain, face, mechanism)
      type(chain_t), intent(in) :: chain
      !> Faces of its joints: (n + 1)
      type(joint_face_t), intent(in) :: face(:)
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
         call apply_face(cone_t(friction=chain%friction(j)), held(j), tangent, constant)
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
      !> What rounding makes of it
      real(wp), intent(out) :: noise
      !> Whether there is a mechanism
      logical, intent(out) :: usable
      real(wp) :: carried, force(3, size(chain%half)), mass
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
      mass = chain%mean_mass*real(size(chain%mass), wp)
      power = power/mass
      noise = noise/mass
   end subroutine chain_power

   !> Forces in balance with the loads that least hinder a mechanism
   pure subroutine find_forces(mechanism, chain, force, noise)
      type(chain_mechanism_t), intent(in) :: mechanism
      type(chain_t), intent(in) :: chain
      !> Forces of its joints; of the others not to the last digit: (3, n + 1) [N/m]
      real(wp), intent(out) :: force(:, :)
      !> What rounding makes of one [N/m]
      real(wp), intent(out) :: noise
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
      !> The change: (3) [N/m, N/m, N]
      real(wp), intent(out) :: change(3)
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
end module dda_chain_power
