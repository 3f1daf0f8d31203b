!> Augmented Lagrangian: the forces of the springs become multipliers until the springs carry
!> nothing,
!> so that the penalty leaves no trace
module dda_multipliers
   use dda_assembly, only : equations_t
   use dda_friction, only : iterate_friction
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_open_close, only : iterate_open_close, step_state_t
   use dda_settings, only : flow_rule, settings_t
   implicit none
   private

   public :: settle_joints

   !> Most passes of the multipliers in one step
   integer, parameter :: max_multiplier_passes = 100
   !> Change of a force that counts as none, over the sum of all weights
   real(wp), parameter :: force_tolerance = 1.0e-10_wp

contains

   !> Settle the joints of one step: once in reference geometry, where the penalty has no influence,
   !> and where springs give for good; until the multipliers stay the same where blocks move
   pure subroutine settle_joints(settings, equations, springs, state)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      real(wp) :: multiplier(3, size(springs%stiffness)), opening(3, size(springs%stiffness))
      real(wp) :: tolerance
      integer :: pass

      if (springs%give .or. .not. settings%current) then
         call settle_once(settings, equations, springs, state)
         return
      end if
      tolerance = force_tolerance*sum(abs(equations%weight(1:2, :)))
      multiplier = state%multiplier
      opening = state%start - multiplier
      do pass = 1, max_multiplier_passes
         state%start = multiplier + opening
         call settle_once(settings, equations, springs, state)
         if (.not. state%settled) return
         if (maxval(abs(state%force - multiplier)) <= tolerance) return
         multiplier = state%force
      end do
      state%settled = .false.
   end subroutine settle_joints

   !> Settle the joints for given multipliers
   pure subroutine settle_once(settings, equations, springs, state)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state

      if (settings%flow == flow_rule%associated) then
         call iterate_open_close(equations, springs, settings%max_changes, state)
      else
         call iterate_friction(equations, springs, settings%max_changes, state)
      end if
   end subroutine settle_once
end module dda_multipliers
