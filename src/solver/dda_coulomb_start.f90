!> State of an assembly under a load that is applied at once
!>
!> Coulomb's law knows no unit of force: a load that grows in proportion from nothing makes every
!> force and every motion grow in proportion, so that all at once is a loading path, too. Interior
!> springs with strong damping find which joints stick and slide, an open-close loop with ever less
!> damping has the last word.
module dda_coulomb_start
   use dda_coulomb_equations, only : coulomb_equations_t
   use dda_coulomb_interior, only : interior_motion
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : apply_law, coulomb_state_t, unloaded_state
   use dda_damped_steps, only : settle_faces, step_to_balance
   use dda_joint_graph, only : joint_motion
   use dda_kinds, only : wp
   use dda_load_jump, only : jump_t, motion_end
   implicit none
   private

   public :: load_at_once

   !> What may be left of a load, by the weight of a block
   real(wp), parameter :: balance = 1.0e-10_wp

contains

   !> State under a load that is applied at once
   pure subroutine load_at_once(joints, equations, load, state, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The state
      type(coulomb_state_t), intent(out) :: state
      !> What damped steps tell, where they were needed
      type(jump_t), intent(inout) :: jump
      !> How it ends, one of motion_end
      integer, intent(out) :: end
      real(wp), parameter :: damping(3) = [1.0e-5_wp, 1.0e-4_wp, 1.0e-3_wp]
      integer :: i
      logical :: stands

      do i = 1, size(damping)
         call try_interior(joints, equations, load, damping(i), state, stands)
         end = motion_end%balanced
         if (stands) return
      end do
      state = unloaded_state(joints)
      jump%tolerance = balance
      call step_to_balance(joints, equations, load, state, jump, end)
   end subroutine load_at_once

   !> Interior springs at a damping, then the open-close loop at ever less of it
   pure subroutine try_interior(joints, equations, load, first, state, stands)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Damping to begin with
      real(wp), intent(in) :: first
      !> The state
      type(coulomb_state_t), intent(out) :: state
      !> Whether its forces balance the load
      logical, intent(out) :: stands
      integer, parameter :: most_passes = 12
      real(wp), parameter :: least = 1.0e-13_wp, tolerance = 1.0e-6_wp, sharper = 1.0e-7_wp
      type(coulomb_state_t) :: unloaded
      real(wp) :: damping, left, last
      integer :: passes, rounds
      logical :: settled

      unloaded = unloaded_state(joints)
      state = unloaded
      call take_interior(joints, equations, load, first, tolerance, unloaded, state, settled)
      stands = .false.
      if (.not. settled) return
      damping = first
      last = huge(1.0_wp)
      rounds = 0
      do while (damping >= 0.5_wp*least)
         call settle_faces(joints, equations, load, damping, most_passes, unloaded, state, &
            & left, passes)
         if (passes == 0 .and. damping < 0.5_wp*first) then
            call take_interior(joints, equations, load, damping, sharper, unloaded, state, &
               & settled)
            if (settled) call settle_faces(joints, equations, load, damping, most_passes, &
               & unloaded, &
               & state, left, passes)
         end if
         if (passes == 0) return
         rounds = rounds + 1
         stands = left < balance
         if (stands) exit
         if (left > 0.85_wp*last .and. rounds >= 3) return
         last = left
         damping = 0.1_wp*damping
      end do
      state%load = load
   end subroutine try_interior

   !> Faces by interior springs
   pure subroutine take_interior(joints, equations, load, damping, tolerance, unloaded, state, &
      & settled)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> Tolerance of the interior springs
      real(wp), intent(in) :: tolerance
      !> Joints that carry nothing
      type(coulomb_state_t), intent(in) :: unloaded
      !> Receives motion, forces and faces
      type(coulomb_state_t), intent(inout) :: state
      !> Whether the interior springs have settled
      logical, intent(out) :: settled
      real(wp) :: opening(3, size(unloaded%slip))

      equations%usable = .false.
      call interior_motion(joints, equations%base, load, damping, tolerance, state%motion, settled)
      call joint_motion(joints%graph, state%motion, opening)
      call apply_law(joints, unloaded, opening, state)
   end subroutine take_interior
end module dda_coulomb_start
