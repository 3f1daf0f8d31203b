!> Motion of an assembly at a load that does not change, by short damped steps
!>
!> Where friction lets forces drop there are no rates that agree with their faces, but a step that
!> is damped enough always settles. Damping falls as long as the steps settle, until forces balance
!> or the blocks move without end.
module dda_damped_steps
   use dda_coulomb_equations, only : coulomb_equations_t, solve_equations, use_faces
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : apply_law, change_faces, coulomb_state_t, imbalance
   use dda_event_rates, only : find_rates, new_rates, rates_t
   use dda_kinds, only : wp
   use dda_load_jump, only : jump_t, motion_end, moves_unbalanced, path_damping, see_ray, &
      & where_it_is
   use dda_path_event, only : event_t
   implicit none
   private

   public :: settle_faces, step_to_balance

contains

   !> One damped step to a load: faces are chosen until they agree with the motion
   pure subroutine settle_faces(joints, equations, load, damping, most, before, after, left, passes)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> Passes at most
      integer, intent(in) :: most
      !> State before the step
      type(coulomb_state_t), intent(in) :: before
      !> In: the faces to begin with; out: the state after the step
      type(coulomb_state_t), intent(inout) :: after
      !> What the forces leave of the load
      real(wp), intent(out) :: left
      !> Number of passes, 0 if the faces did not settle
      integer, intent(out) :: passes
      real(wp), parameter :: rounding = 1.0e-13_wp
      real(wp) :: change(3, size(before%slip)), rest(size(load, 1), size(load, 2))
      real(wp) :: step(size(load, 1), size(load, 2)), first(size(load, 1), size(load, 2))
      integer :: faces(3, size(before%slip)), pass

      passes = 0
      left = huge(1.0_wp)
      call imbalance(joints, load, before%force, first)
      faces = after%face
      do pass = 1, most
         call use_faces(equations, joints, faces, damping)
         if (.not. equations%usable) return
         call change_faces(joints, before, faces, change)
         call imbalance(joints, first, change, rest)
         call solve_equations(equations, joints, rest, step, change)
         if (.not. (equations%usable .and. all(abs(step) <= huge(1.0_wp)))) return
         call apply_law(joints, before, change, after)
         after%motion = before%motion + step
         call imbalance(joints, load, after%force, rest)
         left = maxval(abs(rest))
         if (all(after%face == faces) .or. maxval(abs(rest - damping*joints%graph%mass*step)) &
            & < rounding*real(size(step, 2), wp)) then
            passes = pass
            return
         end if
         faces = after%face
      end do
   end subroutine settle_faces

   !> Move by short steps, at first strongly damped, then less as long as the faces settle
   pure subroutine step_to_balance(joints, equations, load, state, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The state; where it is in balance it carries the load
      type(coulomb_state_t), intent(inout) :: state
      !> The jump
      type(jump_t), intent(inout) :: jump
      !> How it ends, one of motion_end
      integer, intent(out) :: end
      integer, parameter :: max_step = 400, max_failure = 60, most_passes = 12
      real(wp), parameter :: weakest = 1.0e-9_wp, strongest = 1.0e5_wp, slow = 1.0e-2_wp
      type(coulomb_state_t) :: after
      real(wp) :: damping, left, last, start(size(load, 1), size(load, 2))
      integer :: failures, i, passes, same

      end = motion_end%unsettled
      start = state%motion
      last = huge(1.0_wp)
      damping = 10.0_wp
      same = 0
      failures = 0
      do i = 1, max_step
         jump%n_step = jump%n_step + 1
         after = state
         call settle_faces(joints, equations, load, damping, most_passes, state, after, left, &
            & passes)
         if (passes == 0) then
            failures = failures + 1
            if (failures > max_failure .or. damping > strongest) return
            damping = 8.0_wp*damping
            cycle
         end if
         same = merge(same + 1, 0, all(after%face == state%face) .and. damping < slow &
            & .and. abs(left/last - 1.0_wp) < 0.02_wp)
         last = left
         state = after
         end = where_it_is(left, state%motion - start, jump)
         if (end == motion_end%balanced) state%load = load
         if (end == motion_end%unsettled .and. same >= 3) &
            & call try_ray(joints, equations, load, state, jump, end)
         if (end /= motion_end%unsettled) return
         damping = max(weakest, next_damping(damping, passes))
      end do
   end subroutine step_to_balance

   !> The more easily the faces settle, the less damping is needed
   pure real(wp) function next_damping(damping, passes)
      !> Multiple of the mass in the last step
      real(wp), intent(in) :: damping
      !> Passes that it took
      integer, intent(in) :: passes

      next_damping = damping
      if (passes <= 2) then
         next_damping = 0.4_wp*damping
      else if (passes <= 5) then
         next_damping = 0.7_wp*damping
      end if
   end function next_damping

   !> Whether the motion that the load drives has no end
   pure subroutine try_ray(joints, equations, load, state, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The state
      type(coulomb_state_t), intent(in) :: state
      !> Receives the mechanism
      type(jump_t), intent(inout) :: jump
      !> endless if it has none, otherwise unsettled
      integer, intent(out) :: end
      type(rates_t) :: rates
      type(event_t) :: event
      real(wp) :: rest(size(load, 1), size(load, 2)), still(3, size(state%slip))
      logical :: found

      end = motion_end%unsettled
      still = 0.0_wp
      rates = new_rates(state)
      call imbalance(joints, load, state%force, rest)
      call find_rates(joints, equations, state, rest, still, path_damping, rates, found)
      if (found .and. rates%unbalanced > moves_unbalanced) &
         & call see_ray(joints, state, rest, rates, event, jump, end)
   end subroutine try_ray
end module dda_damped_steps
