!> State of one step: block motion and joints at its end
module dda_step_state
   use dda_bar_springs, only : bar_springs_t
   use dda_block_factor, only : block_factor_t
   use dda_block_matrix, only : block_matrix_t
   use dda_contact_types, only : joint_springs_t
   use dda_fixed_points, only : fixed_points_t
   use dda_friction_cone, only : apply_face, cone_t, is_stuck, joint_face_t, project
   use dda_kinds, only : wp
   use dda_spring_products, only : relative_displacement
   implicit none
   private

   public :: step_state_t, joint_forces, disagreement, force_noise, equations_t

   !> The motion of the step and the joints at its end
   type :: step_state_t
      !> Motion of the blocks: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Opening at the two contacts and slip of each joint: (3, n_joint) [m]
      real(wp), allocatable :: increment(:, :)
      !> Gaps without motion, and slips to begin with, in a dynamic run: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Trial forces where the motion begins, in a static run: (3, n_joint) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Admissible forces, those of the last step to begin with: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Faces that they lie on: (n_joint)
      type(joint_face_t), allocatable :: face(:)
      !> Bounds of the forces: (n_joint)
      type(cone_t), allocatable :: cone(:)
      !> Value smaller than usual gaps must be that contact forces leave in time
      real(wp) :: fineness = 1.0_wp
      !> Free fall from rest in the step after the longest one: these gaps are measured
      !> by it [m]
      real(wp) :: fall = 0.0_wp
      !> The largest opening or slip against the law of contact that they leave [m], and its joint
      real(wp) :: residual = 0.0_wp
      integer :: worst = 0
      !> True if velocities are sought, which bars have no part in
      logical :: rates = .false.
      !> Work of what the bounds of the shear forces would still change by [J/m]
      real(wp) :: unsettled_work = 0.0_wp
      !> Passes of the loop so far
      integer :: passes = 0
      !> True if every joint's force agrees with its face
      logical :: settled = .false.
   end type step_state_t

   !> Matrix, loads and factor; the pattern and the mass are made once, the numbers where faces or
   !> the length of the step change
   type :: equations_t
      !> Matrix with the springs of the faces held
      type(block_matrix_t) :: matrix
      !> Its factor
      type(block_factor_t) :: factor
      !> Entry of the matrix that couples the blocks of a joint, 0 if one is fixed: (n_joint)
      integer, allocatable :: entry(:)
      !> First joint in the list of each equation, and one beyond the last: (n_equation + 1)
      integer, allocatable :: first_joint(:)
      !> Joints of each equation, negative where it is the second block's: (number of sides)
      integer, allocatable :: joint(:)
      !> Stiffness of each block's springs if all its joints are stuck, as most are:
      !> (n_dof, n_dof, n_equation)
      real(wp), allocatable :: glued(:, :, :)
      !> Mass: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: mass(:, :, :)
      !> Forces of absorbing faces per rate, without entries if there are none:
      !> (n_dof, n_dof, n_equation or 0)
      real(wp), allocatable :: dashpot(:, :, :)
      !> Matrix of the blocks without springs: elastic + 2*mass/dt**2: (n_dof, n_dof, n_equation)
      real(wp), allocatable :: base(:, :, :)
      !> Weight of the blocks: (n_dof, n_equation)
      real(wp), allocatable :: weight(:, :)
      !> All loads from outside in this step: (n_dof, n_equation)
      real(wp), allocatable :: outer(:, :)
      !> Sums of their sizes, which do not cancel: (n_dof, n_equation)
      real(wp), allocatable :: felt(:, :)
      !> Loads of this step without springs: (n_dof, n_equation)
      real(wp), allocatable :: load(:, :)
      !> Springs of the restrained points
      type(fixed_points_t) :: fixed
      !> Springs of the bars
      type(bar_springs_t) :: bars
      !> Sum of the forces that bear on the blocks, which small forces are measured by [N/m]
      real(wp) :: force_scale = 0.0_wp
      !> Gap by rounding of the corners' coordinates [m]
      real(wp) :: gap_noise = 0.0_wp
      !> Faces that the couplings were made for: (n_joint)
      type(joint_face_t), allocatable :: held(:)
      !> Coefficients of friction that they were made for: (n_joint)
      real(wp), allocatable :: held_friction(:)
      !> Equations whose numbers have changed since the factor was made: (n_equation)
      logical, allocatable :: changed(:)
      !> True if joints and springs are others than those that pattern and numbers were made for: in
      !> a dynamic run few steps need them
      logical :: new_pattern = .false.
      !> True if springs, or their rows, are others
      logical :: new_numbers = .false.
      !> Factorisations so far, whole or in part
      integer :: factorisations = 0
   end type equations_t

contains

   !> Force that rounding alone can make: of all loads, and of the penalty on the largest motion
   pure function force_noise(equations, springs, state) result(noise)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      real(wp) :: noise  !! The force [N/m]

      noise = 1.0e-13_wp*equations%force_scale + 8.0_wp*epsilon(1.0_wp)*max(0.0_wp, &
         & maxval(springs%stiffness))*maxval(abs(state%motion(1:2, :)))
   end function force_noise

   !> Difference of the force on each joint's face from the admissible one, beyond rounding
   pure subroutine disagreement(springs, state, gap, wanted)
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state    !! The step; its increments are set
      real(wp), intent(out) :: gap(:)               !! Length of the difference: (n_joint) [N/m]
      type(joint_face_t), intent(out) :: wanted(:)  !! Face that each joint ought to have: (n_joint)
      real(wp) :: admissible(3), constant(3), held(3), shift(3), tangent(3, 3), trial(3)
      integer :: j

      state%increment = relative_displacement(springs, state%motion)
      do j = 1, size(gap)
         shift = springs%shift(:, j)
         trial = state%trial(:, j) - springs%stiffness(j)*state%increment(:, j)
         call project(state%cone(j), trial + shift, admissible, wanted(j))
         held = trial + shift
         if (.not. is_stuck(state%face(j))) then
            call apply_face(state%cone(j), state%face(j), tangent, constant)
            held = matmul(tangent, held) + constant
         end if
         gap(j) = sqrt(sum((held - admissible)**2)) &
            & - 16.0_wp*epsilon(1.0_wp)*maxval(abs(trial))
      end do
   end subroutine disagreement

   !> Admissible forces and faces of the joints after a motion
   pure subroutine joint_forces(springs, state)
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state  !! The step; everything but the motion is set
      real(wp) :: shift(3), trial(3)
      integer :: j

      state%increment = relative_displacement(springs, state%motion)
      do j = 1, size(state%face)
         shift = springs%shift(:, j)
         trial = state%trial(:, j) - springs%stiffness(j)*state%increment(:, j)
         call project(state%cone(j), trial + shift, state%force(:, j), state%face(j))
         state%force(:, j) = state%force(:, j) - shift
      end do
   end subroutine joint_forces
end module dda_step_state
