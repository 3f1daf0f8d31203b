!> One step of a scene, laid open: equations and state as a run makes them
module scene_step
   use dda_assembly, only : new_equations
   use dda_block_inertia, only : assemble_blocks
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : joint_face_t, project
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_scene, only : scene_t
   use dda_step_context, only : run_t
   use dda_step_state, only : equations_t, step_state_t
   use scene_model, only : add_block, add_joint, model_t, rectangle, scene_of, turned
   implicit none
   private

   public :: begin, begin_run, energy, largest_trial, unbalance, wall

contains

   !> Equations and state at the beginning of a step
   pure subroutine begin(scene, dt, equations, state)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: dt                   !! Length of the step [s]
      type(equations_t), intent(out) :: equations  !! The equations, blocks assembled
      type(step_state_t), intent(out) :: state     !! The state, all joints as they are
      integer :: n

      call new_equations(scene%system, scene%settings, equations)
      call assemble_blocks(scene%system, scene%settings, dt, equations)
      n = size(scene%contacts%joint)
      allocate (state%motion(size(equations%weight, 1), size(equations%weight, 2)))
      allocate (state%increment(3, n), state%trial(3, n), state%force(3, n))
      allocate (state%face(n), state%cone(n))
      state%motion = 0.0_wp
      state%trial = scene%contacts%trial
      state%force = scene%contacts%force
      state%face = scene%contacts%face
      state%cone = scene%contacts%springs%cone
   end subroutine begin

   !> A run of a scene at the beginning of a step
   pure subroutine begin_run(scene, dt, run)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: dt  !! Length of the step [s]
      type(run_t), intent(out) :: run

      run%settings = scene%settings
      run%system = scene%system
      run%contacts = scene%contacts
      run%step%dt = dt
      call begin(scene, dt, run%equations, run%step%state)
   end subroutine begin_run

   !> Largest trial force at the end of a step [N/m]
   pure real(wp) function largest_trial(springs, state)
      type(joint_springs_t), intent(in) :: springs  !! The springs of the joints
      type(step_state_t), intent(in) :: state       !! The solved step
      integer :: j

      largest_trial = 0.0_wp
      do j = 1, size(state%face)
         largest_trial = max(largest_trial, maxval(abs(state%trial(:, j) &
            & - springs%stiffness(j)*state%increment(:, j))))
      end do
   end function largest_trial

   !> What a step minimises: half the motion's stiffness and inertia, less the work of the loads,
   !> and for each joint the function of the trial force whose gradient is the admissible force,
   !> (trial**2 - (trial - force)**2)/2, over the penalty
   pure function energy(equations, springs, state, motion)
      type(equations_t), intent(in) :: equations    !! Blocks assembled
      type(joint_springs_t), intent(in) :: springs  !! The springs of the joints
      type(step_state_t), intent(in) :: state       !! Trial forces at the beginning, bounds
      real(wp), intent(in) :: motion(:, :)          !! Any motion: (n_dof, n_equation)
      real(wp) :: energy                            !! The energy [J/m]
      real(wp) :: increment(3), force(3), trial(3)
      type(joint_face_t) :: face
      integer :: e, j, side

      energy = 0.0_wp
      do e = 1, size(motion, 2)
         energy = energy + dot_product(motion(:, e), &
            & matmul(equations%base(:, :, e), motion(:, e))/2.0_wp - equations%load(:, e))
      end do
      do j = 1, size(state%face)
         increment = 0.0_wp
         do side = 1, 2
            e = springs%equation(side, j)
            if (e > 0) increment = increment + matmul(motion(:, e), springs%row(:, :, side, j))
         end do
         associate (shift => springs%shift(:, j), p => springs%stiffness(j))
            trial = state%trial(:, j) + shift - p*increment
            call project(state%cone(j), trial, force, face)
            energy = energy + dot_product(force, trial - force/2.0_wp)/p &
               & + dot_product(shift, increment)
         end associate
      end do
   end function energy

   !> Loads, joint forces and resistance of each block, which should be zero
   pure function unbalance(equations, springs, motion, force) result(rest)
      type(equations_t), intent(in) :: equations          !! Blocks assembled
      type(joint_springs_t), intent(in) :: springs        !! The springs of the joints
      real(wp), intent(in) :: motion(:, :)                !! The motion: (n_dof, n_equation)
      real(wp), intent(in) :: force(:, :)                 !! Force of each joint: (3, n_joint)
      real(wp) :: rest(size(motion, 1), size(motion, 2))  !! Residual forces: (n_dof, n_equation)
      integer :: e, j, side

      rest = equations%load
      do e = 1, size(motion, 2)
         rest(:, e) = rest(:, e) - matmul(equations%base(:, :, e), motion(:, e))
      end do
      do j = 1, size(force, 2)
         do side = 1, 2
            e = springs%equation(side, j)
            if (e > 0) rest(:, e) = rest(:, e) + matmul(springs%row(:, :, side, j), force(:, j))
         end do
      end do
   end function unbalance

   !> Two courses of two blocks each on a fixed base, tilted; on them one block whose lower side has
   !> a step, so that two joints join it to one of them
   pure function wall(law, slope, n_dof) result(scene)
      type(joint_law_t), intent(in) :: law  !! Law of all joints
      real(wp), intent(in) :: slope         !! By which all is turned [rad]
      integer, intent(in) :: n_dof          !! Unknowns of a block
      !> The scene: base, lower left, lower right, upper left, upper right, top
      type(scene_t) :: scene
      type(model_t) :: model
      real(wp), parameter :: base(2, 5) = reshape([0.0_wp, -1.0_wp, 4.0_wp, -1.0_wp, &
         & 4.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 5])
      real(wp), parameter :: upper(2, 5) = reshape([0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, &
         & 2.0_wp, 1.5_wp, 2.0_wp, 2.0_wp, 0.0_wp, 2.0_wp], [2, 5])
      real(wp), parameter :: top(2, 6) = reshape([0.0_wp, 2.0_wp, 2.0_wp, 2.0_wp, 2.0_wp, 1.5_wp, &
         & 4.0_wp, 1.5_wp, 4.0_wp, 3.0_wp, 0.0_wp, 3.0_wp], [2, 6])

      model%settings%n_dof = n_dof
      call add_block(model, turned(base, slope), fixed=.true.)
      call add_block(model, turned(rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), slope))
      call add_block(model, turned(rectangle([2.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), slope))
      call add_block(model, turned(upper, slope))
      call add_block(model, turned(rectangle([2.0_wp, 1.0_wp], 2.0_wp, 0.5_wp), slope))
      call add_block(model, turned(top, slope))
      call add_joint(model, [1, 4, 2, 1], law)
      call add_joint(model, [1, 3, 3, 1], law)
      call add_joint(model, [2, 2, 3, 4], law)
      call add_joint(model, [2, 3, 4, 1], law)
      call add_joint(model, [3, 3, 5, 1], law)
      call add_joint(model, [4, 2, 5, 4], law)
      call add_joint(model, [4, 4, 6, 1], law)
      call add_joint(model, [5, 3, 6, 3], law)
      call add_joint(model, [6, 2, 4, 3], law)
      scene = scene_of(model)
   end function wall
end module scene_step
