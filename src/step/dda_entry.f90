!> Penetration check of a step: corners that would end inside a neighbour because they enter by
!> another edge than that of their contact
module dda_entry
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_detection, only : contacts_t
   use dda_contact_transfer, only : renew_contacts
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t, step_outcome_t
   use dda_step_reach, only : travel_of
   implicit none
   private

   public :: check_penetration

   !> Depth that counts as entered, over the size of the smaller block
   real(wp), parameter :: deep = 2.0e-4_wp
   !> Steps shorter than this share of the longest one are not cut further
   real(wp), parameter :: shortest = 1.0e-3_wp

contains

   !> Check that a search at the end of a step finds no corners deeper inside than they were at its
   !> beginning, where a block with a notch is one of the two
   pure type(step_outcome_t) function check_penetration(settings, system, contacts, march, step)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      type(block_system_t) :: after
      type(contacts_t) :: found
      logical :: breaks

      check_penetration = step_outcome_t(accepted=.true., dt=step%dt)
      if (all(contacts%search%outline%convex) .or. step%dt <= shortest*march%longest) return
      after = system
      found = contacts
      call update_contacts(step, settings, found, breaks)
      call update_blocks(step, settings, after)
      call renew_contacts(after, travel_of(after, settings, march), march%reach, &
         & settings%penalty_ratio, settings%n_dof, found)
      if (depth(after, found) > max(deep, 1.1_wp*depth(system, contacts))) &
         & check_penetration = step_outcome_t(dt=step%dt/2.0_wp, was_cut=.true.)
   end function check_penetration

   !> How deep the deepest corner is, over the size of the smaller block
   pure real(wp) function depth(system, contacts)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer :: j

      depth = 0.0_wp
      do j = 1, size(contacts%joint)
         associate (n => contacts%joint(j)%n_contact, block => contacts%joint(j)%block)
            if (all(contacts%search%outline%convex(block))) cycle
            depth = max(depth, -minval(contacts%gap(:n, j)) /sqrt(minval(system%area(block))))
         end associate
      end do
   end function depth
end module dda_entry
