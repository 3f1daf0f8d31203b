!> Gaps at the end of a step that turns the blocks: rows are straight, ways of corners are not
module dda_curved_motion
   use dda_assembly, only : equations_t
   use dda_block_system, only : block_system_t
   use dda_block_update, only : displaced_blocks
   use dda_contact_detection, only : contacts_t
   use dda_contact_types, only : joint_t, place_joint
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_settle_in_time, only : settle_in_time
   use dda_step_context, only : step_context_t
   use dda_step_state, only : step_state_t
   implicit none
   private

   public :: follow_curves

   !> Most passes of the correction
   integer, parameter :: max_passes = 8
   !> Gap at a closed contact, or depth at an open one, that is left, over the size of the smallest
   !> block
   real(wp), parameter :: left_over = 1.0e-8_wp

   !> Depth that is left where nothing settles, over the same
   real(wp), parameter :: jammed = 1.0e-5_wp

contains

   !> Settle the contacts again with what the gaps really are at the end of the step, until closed
   !> contacts have none
   pure subroutine follow_curves(settings, system, contacts, equations, step)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> Blocks assembled; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      type(step_context_t), intent(inout) :: step
      type(block_system_t) :: after
      type(joint_t) :: joint
      type(step_state_t) :: last
      real(wp) :: curve(2, size(contacts%joint))
      real(wp) :: gap(3), tolerance, error, excess
      integer :: j, k, pass

      tolerance = left_over*sqrt(minval(system%area, mask=system%equation > 0))
      step%curve = 0.0_wp*contacts%gap(1:2, :)
      do pass = 1, max_passes
         after = displaced_blocks(system, settings, step%state%motion)
         error = 0.0_wp
         curve = step%curve
         do j = 1, size(contacts%joint)
            joint = contacts%joint(j)
            call place_joint(after, after%moved, joint, gap)
            do k = 1, joint%n_contact
               excess = gap(k) - contacts%gap(k, j) - step%state%increment(k, j)
               if (.not. step%state%face(j)%open(k)) then
                  error = max(error, abs(excess - step%curve(k, j)))
               else
                  error = max(error, min(-gap(k), step%curve(k, j) - excess))
               end if
               step%curve(k, j) = excess
            end do
         end do
         if (error <= tolerance) return
         last = step%state
         step%state%multiplier = step%state%force
         step%state%start = step%state%force
         do k = 1, 2
            step%state%start(k, :) = step%state%force(k, :) &
               & - contacts%springs%stiffness*(contacts%gap(k, :) + step%curve(k, :))
         end do
         call settle_in_time(settings, (equations%fixed%target), equations, contacts%springs, &
            & step%state, in_vain=error <= jammed*tolerance/left_over)
         if (step%state%settled) cycle
         if (error > jammed*tolerance/left_over) return
         ! blocks that jam where they turn: what they lie in one another is left
         step%state = last
         step%curve = curve
         return
      end do
   end subroutine follow_curves
end module dda_curved_motion
