!> One step as a transaction: blocks and contacts change only when it is accepted
!>
!> Equation (M1) of docs/method.md
module dda_step
   use dda_block_update, only : carry_over
   use dda_energy, only : audit_step
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_step_at_rest, only : rest
   use dda_step_check, only : check_impact, check_motion, check_speeds, retry
   use dda_step_context, only : in_time, run_t, step_outcome_t
   use dda_step_motion, only : assemble_step, place_contacts, predict_step, solve_contacts
   use dda_step_reach, only : next_reach
   use dda_velocity, only : solve_impacts
   use dda_verdict, only : measure_step
   implicit none
   private

   public :: advance

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 40
   !> Tries in which very many joints are swept before their faces agree
   integer, parameter :: hasty_tries = 3

   !> Shortest step in time: stiffness that grows with its inverse square overflows [s]
   real(wp), parameter :: shortest_step = 1.0e-40_wp

contains

   !> One step: blocks and contacts change only when it is accepted
   pure subroutine advance(run, error)
      type(run_t), intent(inout) :: run
      !> Allocated if no step, however short, settles
      type(error_t), allocatable, intent(inout) :: error
      type(step_outcome_t) :: outcome
      logical :: still
      integer :: attempt

      call rest(run, still)
      if (still) return
      call predict_step(run)
      do attempt = 0, max_retries
         if (is_too_short(run)) exit
         if (run%step%renews) call place_contacts(run)
         run%step%state%effort%patient = attempt > hasty_tries
         outcome = step_outcome_t(accepted=run%step%is_solved)
         if (.not. outcome%accepted) then
            call assemble_step(run)
            outcome%accepted = .true.
            if (in_time(run)) outcome = check_impact(run)
            if (outcome%accepted) call solve_contacts(run)
         end if
         if (outcome%accepted) outcome = check_motion(run)
         if (outcome%accepted .and. in_time(run)) then
            call solve_impacts(run)
            outcome = check_speeds(run)
         end if
         if (outcome%accepted .or. run%march%clock%tries .and. .not. outcome%beyond_margin) exit
         call retry(run, outcome)
      end do
      run%step%accepted = outcome%accepted
      if (outcome%accepted) then
         call commit(run)
      else if (.not. run%march%clock%tries) then
         call fatal_error(error, "open-close iteration does not converge for any time step")
      end if
   end subroutine advance

   !> Whether a step in time is too short for its stiffness, or for time to go on
   pure logical function is_too_short(run)
      type(run_t), intent(in) :: run

      is_too_short = in_time(run) .and. run%march%dt < max(shortest_step, spacing(run%march%time))
   end function is_too_short

   !> Carry an accepted step over, and count it
   pure subroutine commit(run)
      type(run_t), intent(inout) :: run

      if (run%contacts%searched) call next_reach(run%system, run%step, run%march)
      call measure_step(run)
      call carry_over(run)
      run%march%steps = run%march%steps + 1
      run%march%clock%tries = .false.
      if (.not. has_path(run%march%clock)) run%march%time = run%march%time + run%step%dt
      if (run%settings%dynamic) call audit_step(run)
   end subroutine commit
end module dda_step
