!> One step as a transaction: blocks and contacts change only when it is accepted
!>
!> Equation (M1) of docs/method.md
module dda_step
   use dda_block_update, only : carry_over
   use dda_energy, only : audit_step
   use dda_error, only : error_t, fatal_error
   use dda_impact, only : foresee_event
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_step_context, only : in_time, most_spare_cuts, contact_note_t, run_t, shortest, &
      & step_outcome_t
   use dda_step_at_rest, only : rest
   use dda_step_check, only : check_motion, check_speeds, retry
   use dda_step_interval, only : largest_motion
   use dda_step_motion, only : assemble_step, predict_step, renew_try, solve_contacts
   use dda_step_reach, only : next_reach
   use dda_velocity, only : solve_impacts
   use dda_verdict, only : measure_step
   implicit none
   private

   public :: advance

   !> Maximum number of reductions of a step
   integer, parameter :: max_retries = 40
   !> Step over the permitted one below which a run makes no progress, unless displacements are
   !> prescribed, and most of these steps
   real(wp), parameter :: hardly = 1.0e-6_wp
   integer, parameter :: most_stuck = 100

   !> Reason why contacts find no forces where displacements are prescribed
   character(len=*), parameter :: jam = "contacts lock against a prescribed displacement"

   !> Residual over the fastest speed, or over the speed that loads add per step, above which it is
   !> reported
   real(wp), parameter :: rough = 1.0e-4_wp
   !> Smallest reported reduction of restitution
   real(wp), parameter :: small_reduction = 1.0e-3_wp

contains

   !> One step: blocks and contacts change only when it is accepted
   pure subroutine advance(run, error)
      type(run_t), intent(inout) :: run
      !> Allocated if no step, however short, settles
      type(error_t), allocatable, intent(inout) :: error
      type(step_outcome_t) :: outcome
      character(len=12) :: time
      logical :: repeats, still
      integer :: attempt

      call rest(run, still)
      if (still) return
      call predict_step(run)
      do attempt = 0, max_retries
         if (is_too_short(run)) exit
         repeats = .false.
         if (run%step%renews) call renew_try(run, attempt > 0, repeats)
         outcome = step_outcome_t(accepted=.true.)
         if (.not. repeats) then
            call assemble_step(run)
            if (in_time(run)) outcome = foresee_event(run)
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
         if (in_time(run)) call check_progress(run, error)
      else if (.not. run%march%clock%tries) then
         if (leads(run)) then
            write (time, "(es12.5)") run%march%time
            call fatal_error(error, jam//" at "//trim(adjustl(time))//" s")
         else
            call fatal_error(error, "open-close iteration does not converge for any time step")
         end if
      end if
   end subroutine advance

   !> True if a dynamic step is shorter than rounding of the time
   pure logical function is_too_short(run)
      type(run_t), intent(in) :: run

      is_too_short = in_time(run) &
         & .and. run%march%dt < spacing(max(run%march%time, run%march%longest))
   end function is_too_short

   !> End a dynamic run whose steps make no progress: a prescribed displacement against friction
   !> finds no motion at any speed
   pure subroutine check_progress(run, error)
      type(run_t), intent(inout) :: run
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: cause
      character(len=24) :: numbers
      real(wp) :: usual, speed

      associate (march => run%march)
         speed = largest_motion(run%system, run%step%velocity)
         usual = march%longest
         if (speed*usual > march%allowed_motion) usual = march%allowed_motion/speed
         march%stuck = merge(march%stuck + 1, 0, run%step%dt &
            & < merge(shortest, hardly, leads(run))*usual)
         if (march%stuck < most_stuck) return
         cause = "contacts limit the step length"
         if (leads(run)) cause = jam
         write (numbers, "(2es12.5)") run%step%dt, march%time
         call fatal_error(error, "steps of "//trim(adjustl(numbers(:12)))//" s reach no " &
            & //"solution at "//trim(adjustl(numbers(13:)))//" s: "//cause)
      end associate
   end subroutine check_progress

   !> True if displacements are prescribed in a dynamic run
   pure logical function leads(run)
      type(run_t), intent(in) :: run

      leads = in_time(run) .and. any(abs(run%equations%fixed%rate) > 0.0_wp)
   end function leads

   !> Keep what contact forces of a step have left against the law of contact
   pure subroutine note_residual(run)
      type(run_t), intent(inout) :: run
      real(wp) :: fastest, residual
      integer :: joint

      associate (march => run%march, step => run%step)
         residual = step%residual
         joint = step%worst
         if (step%state%residual > residual*step%dt) then
            residual = step%state%residual/step%dt
            joint = step%state%worst
         end if
         march%energy%residual = residual
         march%residual = max(march%residual, residual)
         fastest = max(largest_motion(run%system, step%velocity), march%free_acceleration*step%dt, &
            & largest_motion(run%system, step%state%motion)/step%dt)
         if (residual <= max(rough*fastest, march%rough%value)) return
         march%rough = contact_note_t(residual, march%time + step%dt)
         if (joint <= size(run%contacts%joint)) &
            & march%rough%block = run%contacts%joint(joint)%block
      end associate
   end subroutine note_residual

   !> Keep the largest reduction of restitution
   pure subroutine note_reduction(run)
      type(run_t), intent(inout) :: run

      associate (march => run%march, step => run%step)
         if (1.0_wp - step%restitution <= max(small_reduction, march%reduced%value)) return
         march%reduced = contact_note_t(1.0_wp - step%restitution, march%time + step%dt, &
            & run%contacts%joint(step%fastest_impact)%block)
      end associate
   end subroutine note_reduction

   !> Carry an accepted step over, and count it
   pure subroutine commit(run)
      type(run_t), intent(inout) :: run

      if (run%contacts%searched) call next_reach(run%system, run%step, run%march)
      if (.not. run%settings%dynamic) call measure_step(run)
      if (in_time(run)) then
         call note_residual(run)
         call note_reduction(run)
      end if
      call carry_over(run)
      run%march%steps = run%march%steps + 1
      run%march%clock%tries = .false.
      run%march%spare_cuts = min(most_spare_cuts, run%march%spare_cuts + 1)
      if (run%step%ends_at_event) run%march%spare_cuts = max(0, run%march%spare_cuts - 3)
      if (.not. has_path(run%march%clock)) run%march%time = run%march%time + run%step%dt
      if (run%settings%dynamic) call audit_step(run)
   end subroutine commit
end module dda_step
