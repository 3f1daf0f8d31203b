!> Whether a try of a step counts, and what the next try changes if it does not
module dda_step_check
   use dda_assembly, only : equations_t
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_entry, only : check_penetration
   use dda_impact_time, only : check_impact
   use dda_kinds, only : wp
   use dda_parting, only : check_axes
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t, step_outcome_t
   use dda_step_interval, only : check_length
   use dda_step_reach, only : check_margins, travel_by, widen_margins
   implicit none
   private

   public :: check_motion, check_end_velocities, retry

contains

   !> Check the motion of a try: settled, short enough, within its margins, without an impact
   !> inside, by the right axes
   pure function check_motion(settings, system, contacts, equations, march, step) result(outcome)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      type(equations_t), intent(in) :: equations
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      !> What the first check says that it does not pass
      type(step_outcome_t) :: outcome
      logical :: searched

      searched = contacts%searched .and. settings%current
      outcome = check_length(settings, march, step)
      if (outcome%accepted .and. searched) outcome = check_margins(system, contacts, march, step)
      if (.not. (settings%dynamic .and. settings%current)) return
      if (outcome%accepted) outcome = check_impact(settings, system, contacts, equations, step)
      if (outcome%accepted .and. searched) outcome = check_axes(system, contacts, march, step)
   end function check_motion

   !> Check the velocities of a try: settled, and no corner inside a neighbour
   pure function check_end_velocities(settings, system, contacts, march, step) result(outcome)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      type(step_outcome_t) :: outcome

      outcome = step_outcome_t(accepted=step%has_velocity, dt=step%dt)
      if (.not. outcome%accepted) outcome = step_outcome_t(dt=step%dt/2.0_wp, was_cut=.true.)
      if (outcome%accepted .and. contacts%searched) &
         & outcome = check_penetration(settings, system, contacts, march, step)
   end function check_end_velocities

   !> Change for the next try what the checks ask for: its length, margins, axes
   pure subroutine retry(system, outcome, march, step)
      type(block_system_t), intent(in) :: system
      type(step_outcome_t), intent(in) :: outcome
      !> The march; length and margins are set
      type(march_t), intent(inout) :: march
      !> The try; how corners move is set, and whether contacts are searched again
      type(step_context_t), intent(inout) :: step

      if (outcome%dt < step%dt) step%choices = 0
      march%dt = outcome%dt
      step%was_cut = step%was_cut .or. outcome%was_cut
      step%renews = outcome%beyond_margin .or. outcome%wrong_axes
      if (outcome%beyond_margin) call widen_margins(system, step%state%motion, march%reach)
      if (.not. outcome%wrong_axes) return
      step%choices = step%choices + 1
      step%travel = travel_by(system, step%state%motion)
   end subroutine retry
end module dda_step_check
