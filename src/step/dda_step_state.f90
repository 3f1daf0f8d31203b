!> What one step works on: the motion of the blocks, and the joints at its end
module dda_step_state
   use dda_assembly, only : equations_t
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t, project
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   implicit none
   private

   public :: step_state_t, joint_forces, disagreement, force_noise

   !> The motion of the step and the joints at its end
   type :: step_state_t
      !> Motion of the blocks: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Opening at the two contacts and slip of each joint: (3, n_joint) [m]
      real(wp), allocatable :: increment(:, :)
      !> Forces at the beginning of the step: (3, n_joint) [N/m]
      real(wp), allocatable :: multiplier(:, :)
      !> Trial forces at the beginning of the step: (3, n_joint) [N/m]
      real(wp), allocatable :: start(:, :)
      !> Trial forces at its end: (3, n_joint) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Admissible forces at its end: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Faces that they lie on: (n_joint)
      type(joint_face_t), allocatable :: face(:)
      !> Bounds of the forces: (n_joint)
      type(cone_t), allocatable :: cone(:)
      !> How much smaller than usual gaps must be that sweeps leave
      real(wp) :: fineness = 1.0_wp
      !> Opening or slip against the law of contact that many blocks may leave [m]
      real(wp) :: unseen = 0.0_wp
      !> Whether velocities are sought: then it does not matter which of all forces that stop the
      !> blocks are found, in a motion those nearest to the ones before count
      logical :: rates = .false.
      !> Whether longer steps have failed: then very many joints get all the time that they take
      logical :: patient = .false.
      !> Whether many joints hang together, so that less than that is no matter
      logical :: many = .false.
      !> Whether very many joints were swept in this step since their faces did not agree: once more
      !> these would not either
      logical :: swept = .false.
      !> Work of what the bounds of the shear forces would still change by [J/m]
      real(wp) :: unsettled_work = 0.0_wp
      !> Passes of the loop so far
      integer :: passes = 0
      !> Whether every joint's force agrees with its face
      logical :: settled = .false.
   end type step_state_t

contains

   !> Force that rounding alone can make: of all loads, and of the penalty on the largest motion
   pure function force_noise(equations, springs, state) result(noise)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      !> The force [N/m]
      real(wp) :: noise

      noise = 1.0e-13_wp*equations%force_scale + 8.0_wp*epsilon(1.0_wp)*max(0.0_wp, &
         & maxval(springs%stiffness))*maxval(abs(state%motion(1:2, :)))
   end function force_noise

   !> How far the force that each joint's face gives is from the admissible one, beyond rounding
   pure subroutine disagreement(springs, state, gap, wanted)
      type(joint_springs_t), intent(in) :: springs
      !> The step; its increments and trial forces are set
      type(step_state_t), intent(inout) :: state
      !> Length of the difference: (n_joint) [N/m]
      real(wp), intent(out) :: gap(:)
      !> Face that each joint ought to have: (n_joint)
      type(joint_face_t), intent(out) :: wanted(:)
      real(wp) :: admissible(3), constant(3), held(3), shift(3), tangent(3, 3)
      integer :: j

      state%increment = relative_displacement(springs, state%motion)
      do j = 1, size(gap)
         shift = springs%shift(:, j)
         state%trial(:, j) = state%start(:, j) - springs%stiffness(j)*state%increment(:, j)
         call project(state%cone(j), state%trial(:, j) + shift, admissible, wanted(j))
         held = state%trial(:, j) + shift
         if (.not. is_stuck(state%face(j))) then
            call apply_face(state%cone(j), state%face(j), tangent, constant)
            held = matmul(tangent, held) + constant
         end if
         gap(j) = sqrt(sum((held - admissible)**2)) &
            & - 16.0_wp*epsilon(1.0_wp)*maxval(abs(state%trial(:, j)))
      end do
   end subroutine disagreement

   !> Admissible forces and faces of the joints after a motion
   pure subroutine joint_forces(springs, state)
      type(joint_springs_t), intent(in) :: springs
      !> The step; everything but the motion is set
      type(step_state_t), intent(inout) :: state
      real(wp) :: shift(3)
      integer :: j

      state%increment = relative_displacement(springs, state%motion)
      do j = 1, size(state%face)
         shift = springs%shift(:, j)
         state%trial(:, j) = state%start(:, j) - springs%stiffness(j)*state%increment(:, j)
         call project(state%cone(j), state%trial(:, j) + shift, state%force(:, j), state%face(j))
         state%force(:, j) = state%force(:, j) - shift
      end do
   end subroutine joint_forces
end module dda_step_state
