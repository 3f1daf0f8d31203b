!> Acceptance of a step, and changes for its repetition
module dda_step_check
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_transfer, only : renew_contacts
   use dda_contacts, only : contacts_t
   use dda_impact, only : check_impact
   use dda_kinds, only : wp
   use dda_parting_line, only : block_gap
   use dda_step_context, only : in_time, may_shorten, near_gap, run_t, step_outcome_t
   use dda_step_interval, only : check_length
   use dda_step_reach, only : check_margins, travel_by, travel_of, widen_margins
   implicit none
   private

   public :: check_axes, check_motion, check_speeds, retry

   !> Negligible gap or depth over the size of the smaller block
   real(wp), parameter :: no_matter = 1.0e-6_wp
   !> Maximum number of selections of separating axes per step
   integer, parameter :: max_choices = 2
   !> Permitted penetration over the size of the smaller block
   real(wp), parameter :: deep = 2.0e-4_wp

contains

   !> Check the motion of a try: settled, short enough, within its margins, without an impact
   !> inside, by the right axes. The outcome is that of the first check that fails
   pure type(step_outcome_t) function check_motion(run) result(outcome)
      type(run_t), intent(in) :: run
      logical :: searched

      searched = run%contacts%searched .and. run%settings%current
      outcome = check_length(run)
      if (outcome%accepted .and. searched) outcome = check_margins(run)
      if (.not. in_time(run)) return
      if (outcome%accepted) outcome = check_impact(run)
      if (outcome%accepted .and. searched) outcome = check_axes(run)
   end function check_motion

   !> Check the velocities of a try: settled, and no corner inside a neighbour
   pure type(step_outcome_t) function check_speeds(run) result(outcome)
      type(run_t), intent(in) :: run

      outcome = step_outcome_t(accepted=run%step%has_velocity, dt=run%step%dt)
      if (.not. outcome%accepted) outcome = half_step(run)
      if (outcome%accepted .and. run%contacts%searched) outcome = check_penetration(run)
   end function check_speeds

   !> Try half the step
   pure type(step_outcome_t) function half_step(run)
      type(run_t), intent(in) :: run

      half_step = step_outcome_t(dt=run%step%dt/2.0_wp, was_cut=.true.)
   end function half_step

   !> Change for the next try what the checks ask for: its length, margins, axes
   pure subroutine retry(run, outcome)
      type(run_t), intent(inout) :: run
      type(step_outcome_t), intent(in) :: outcome

      associate (step => run%step)
         if (outcome%dt < step%dt) step%choices = 0
         run%march%dt = outcome%dt
         step%was_cut = step%was_cut .or. outcome%was_cut
         step%renews = outcome%beyond_margin .or. outcome%wrong_axes
         if (outcome%beyond_margin) &
            & call widen_margins(run%system, step%state%motion, run%march%reach)
         if (.not. step%renews) step%overshoot = outcome%overshoot
         step%ends_at_event = outcome%ends_at_event
         step%ends_at_turn = outcome%ends_at_turn
         if (step%ends_at_event) step%event_cuts = step%event_cuts + 1
         if (.not. outcome%wrong_axes) return
         ! an event at a line that held off separate blocks is none
         if (outcome%met_nothing .and. step%uncut > step%dt) then
            run%march%dt = step%uncut
            step%overshoot = huge(step%overshoot)
            step%uncut = 0.0_wp
         end if
         step%choices = step%choices + 1
         step%travel = travel_by(run%system, step%state%motion)
      end associate
   end subroutine retry

   !> Check the separating axes of a settled step. Where corners pass corners, the edge that one
   !> enters by depends on the motion of both. An axis is wrong if it has held off a block that is
   !> separate, or has let one enter. Axes are then chosen again by the motion. If blocks still
   !> enter one another, the step is cut; if some are still held off without contact, that is
   !> accepted. A step that ends at a line is cut if another line separates the blocks there: they
   !> do not meet, and after a shorter step both lines separate them. If they do not, because the
   !> blocks were level with the line from the start, axes are chosen again
   pure type(step_outcome_t) function check_axes(run) result(outcome)
      type(run_t), intent(in) :: run
      real(wp) :: before, contact_gap, gap, level, matters
      logical :: entered, held_off, replaced
      integer :: j

      entered = .false.
      held_off = .false.
      replaced = .false.
      associate (system => run%system, step => run%step)
         do j = 1, size(run%contacts%joint)
            associate (block => run%contacts%joint(j)%block, n => run%contacts%joint(j)%n_contact)
               if (.not. all(run%contacts%search%outline%convex(block))) cycle
               matters = no_matter*sqrt(minval(system%area(block)))
               gap = block_gap(system%first_vertex, step%after%moved, block)
               ! what forces have left at the contacts themselves is no fault of their line, nor is
               ! the depth at which they are closed
               contact_gap = minval(step%end_gap(:n, j))
               level = minval(step%end_gap(:n, j) + run%contacts%joint(j)%contact(:n)%closed_at)
               if (gap > max(0.0_wp, contact_gap) + matters) then
                  if (.not. all(step%state%face(j)%open)) then
                     held_off = .true.
                  else if (contact_gap <= near_gap(system, block)) then
                     replaced = .true.
                  end if
                  if (step%event_cuts > 0 .and. contact_gap <= near_gap(system, block)) &
                     & outcome%met_nothing = outcome%met_nothing &
                     & .or. minval(run%contacts%gap(:n, j)) > near_gap(system, block)
               end if
               if (gap > -matters) cycle
               before = min(0.0_wp, block_gap(system%first_vertex, system%moved, block))
               if (gap < min(before + min(0.0_wp, contact_gap), level) - matters) entered = .true.
            end associate
         end do
         outcome%dt = step%dt
         outcome%wrong_axes = (entered .or. held_off .or. replaced .and. step%was_cut) &
            & .and. step%choices < max_choices
         outcome%accepted = .not. outcome%wrong_axes
         if (outcome%accepted .and. (entered .or. replaced) .and. may_shorten(run)) &
            & outcome = half_step(run)
      end associate
   end function check_axes

   !> Check that a search at the end of a step finds no corners deeper inside than they were at its
   !> beginning, by another edge than that of their contact, where a block with a notch is one of
   !> the two
   pure type(step_outcome_t) function check_penetration(run) result(outcome)
      type(run_t), intent(in) :: run
      type(block_system_t) :: after
      type(contacts_t) :: found
      logical :: breaks

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (all(run%contacts%search%outline%convex) .or. .not. may_shorten(run)) return
      after = run%system
      found = run%contacts
      call update_contacts(run%step, run%settings, found, breaks)
      call update_blocks(run%step, run%settings, after)
      call renew_contacts(after, travel_of(after, run%settings, run%march, found), &
         & run%march%reach, run%settings%penalty_ratio, run%settings%n_dof, found)
      if (depth(after, found) > max(deep, 1.1_wp*depth(run%system, run%contacts))) &
         & outcome = half_step(run)
   end function check_penetration

   !> Depth of the deepest corner over the size of the smaller block
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

end module dda_step_check
