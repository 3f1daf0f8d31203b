!> Augmented Lagrangian: the forces of the springs become multipliers until the springs carry
!> nothing, so that the penalty leaves no trace
module dda_multipliers
   use dda_bar_springs, only : add_bars, couple_bars, judge_bars
   use dda_contact_types, only : joint_springs_t
   use dda_fixed_points, only : correct_fixed_forces
   use dda_friction, only : iterate_friction
   use dda_kinds, only : wp
   use dda_open_close, only : iterate_open_close
   use dda_settings, only : flow_rule, settings_t
   use dda_settle_in_time, only : settle_in_time
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: settle_joints

   !> Most passes of one step in which forces become multipliers
   integer, parameter :: max_force_passes = 100
   !> Most changes of the conditions of bars in one step; after the few only the worst bar changes
   integer, parameter :: max_bar_passes = 200, few_bar_passes = 20
   !> Change of a force that counts as none, over the sum of all that bear on the blocks
   real(wp), parameter :: force_tolerance = 1.0e-10_wp

contains

   !> Settle the joints of one step: once in reference geometry, where the penalty has no
   !> influence, and where springs give for good; until the multipliers stay the same where
   !> blocks move
   pure subroutine settle_joints(settings, equations, springs, state)
      type(settings_t), intent(in) :: settings
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      integer :: pass
      logical :: agreed

      do pass = 1, max_bar_passes
         if (settings%current .and. settings%dynamic) then
            call settle_in_time(settings, (equations%fixed%target), equations, springs, state)
         else if (multiplies(settings, springs) .or. size(equations%fixed%point) > 0) then
            call settle_exactly(settings, equations, springs, state)
         else
            call settle_once(settings, equations, springs, state)
         end if
         if (.not. state%settled .or. size(equations%bars%entry) == 0) return
         call add_bars(equations%bars, -1.0_wp, equations%base, equations%load)
         call judge_bars(equations%bars, state%motion, pass > few_bar_passes, agreed)
         call add_bars(equations%bars, 1.0_wp, equations%base, equations%load)
         if (agreed) return
         call couple_bars(equations%bars, equations%matrix%pair, .true., equations%matrix%coupling)
         equations%changed = .true.
      end do
      state%settled = .false.
   end subroutine settle_joints

   !> Settle the joints until neither their forces nor those at the held points change
   pure subroutine settle_exactly(settings, equations, springs, state)
      type(settings_t), intent(in) :: settings
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state
      real(wp) :: force(3, size(springs%stiffness)), opening(3, size(springs%stiffness))
      real(wp) :: change, scale
      integer :: pass
      logical :: has_multipliers

      has_multipliers = multiplies(settings, springs)
      force = state%force
      opening = state%trial - force
      do pass = 1, max_force_passes
         if (has_multipliers) state%trial = force + opening
         call settle_once(settings, equations, springs, state)
         if (.not. state%settled) return
         call correct_fixed_forces((equations%fixed%target), state%motion, equations%fixed, &
            & equations%load, change)
         if (has_multipliers) change = max(change, maxval(abs(state%force - force)))
         scale = equations%force_scale + sum(abs(equations%fixed%force))
         if (change <= force_tolerance*scale) return
         force = state%force
      end do
      state%settled = .false.
   end subroutine settle_exactly

   !> Whether the forces of the joints are multipliers; otherwise their springs are real
   pure logical function multiplies(settings, springs)
      type(settings_t), intent(in) :: settings
      type(joint_springs_t), intent(in) :: springs

      multiplies = settings%current .and. .not. springs%give
   end function multiplies

   !> Settle the joints for given multipliers
   pure subroutine settle_once(settings, equations, springs, state)
      type(settings_t), intent(in) :: settings
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state

      if (settings%flow == flow_rule%associated) then
         call iterate_open_close(equations, springs, settings%max_changes, state)
      else
         call iterate_friction(equations, springs, settings%max_changes, settings%dynamic, state)
      end if
   end subroutine settle_once

end module dda_multipliers
