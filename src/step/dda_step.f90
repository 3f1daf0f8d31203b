!> One step as a transaction: blocks and contacts change only when it is accepted
!>
!> Equation (M1) of docs/method.md
module dda_step
   use dda_bar_springs, only : keep_bars
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_types, only : joint_springs_t
   use dda_energy, only : audit_step
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_settings, only : settings_t
   use dda_step_context, only : in_time, run_t, step_outcome_t
   use dda_step_reach, only : next_reach
   use dda_step_state, only : effort_t, equations_t, step_state_t
   use dda_verdict, only : measure_step
   implicit none
   private

   public :: advance, begin_step, check_axes, check_impact, retry, settle_joints, balancing_time
   public :: carry_over, is_slow, stand_still, stands_still

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 40
   !> Tries in which very many joints are swept before their faces agree
   integer, parameter :: hasty_tries = 3

   !> Shortest step in time: stiffness that grows with its inverse square overflows [s]
   real(wp), parameter :: shortest_step = 1.0e-40_wp

   interface

      !> A step of blocks that stand still, or are found to: nothing moves in it
      pure module subroutine rest(run, still)
         type(run_t), intent(inout) :: run
         logical, intent(out) :: still  !! Whether they stand still; otherwise nothing has changed
      end subroutine rest

      !> What a step begins with: masses as the blocks have turned, whether contacts remember their
      !> slip, and how corners are about to move
      pure module subroutine predict(run)
         type(run_t), intent(inout) :: run
      end subroutine predict

      !> Contacts where the blocks are now: those that were given, or those that a search finds
      pure module subroutine place_contacts(run)
         type(run_t), intent(inout) :: run
      end subroutine place_contacts

      !> Equations of the blocks, and the forces that their joints begin with
      pure module subroutine assemble(run)
         type(run_t), intent(inout) :: run
      end subroutine assemble

      !> Contact forces and motion of one try
      pure module subroutine solve_contacts(run)
         type(run_t), intent(inout) :: run
      end subroutine solve_contacts

      !> Velocities of the blocks at the end of a settled step, if they settle. Newton's restitution
      !> may bring in energy where there is friction, or where blocks are hit in several places;
      !> then there is less of it. What contacts have done to the energy of the motion is no part of
      !> what is allowed; without contacts only held points change it, which turn with their blocks
      pure module subroutine solve_impacts(run)
         type(run_t), intent(inout) :: run
      end subroutine solve_impacts

      !> Check the motion of a try: settled, short enough, within its margins, without an impact
      !> inside, by the right axes. What the first check says that it does not pass
      pure type(step_outcome_t) module function check_motion(run) result(outcome)
         type(run_t), intent(in) :: run
      end function check_motion

      !> Check the velocities of a try: settled, and no corner inside a neighbour
      pure type(step_outcome_t) module function check_velocities(run) result(outcome)
         type(run_t), intent(in) :: run
      end function check_velocities

      !> Change for the next try what the checks ask for: its length, margins, axes
      pure module subroutine retry(run, outcome)
         type(run_t), intent(inout) :: run
         type(step_outcome_t), intent(in) :: outcome
      end subroutine retry

      !> Check the separating axes of a settled step. Where corners pass corners, which edge the one
      !> would go in by depends on the way that both take. A line that has held off a block which
      !> turns out to be apart was the wrong one, and so was one that has let it in: they are chosen
      !> anew by the motion; if blocks still enter one another the step is cut, and if some are
      !> still held off in thin air, they are
      pure type(step_outcome_t) module function check_axes(run) result(outcome)
         type(run_t), intent(in) :: run
      end function check_axes

      !> Check a try before it is solved: that nothing meets in it
      pure type(step_outcome_t) module function check_start(run) result(outcome)
         type(run_t), intent(in) :: run
      end function check_start

      !> Check that no open contact closes fast within the step, for the speed at that very moment
      !> counts, and the time that is left after it; a step in which one would ends when the
      !> two blocks, if nothing else touched them, are near enough to count as touching. A solved
      !> step in which forces have closed one before its time is halved
      pure type(step_outcome_t) module function check_impact(run) result(outcome)
         type(run_t), intent(in) :: run
      end function check_impact

      !> Springs of contacts whose forces are multipliers: stiff beside inertia however short the
      !> step, and without memory of slip, which would bring in work. What sticks has no speed to
      !> slip with
      pure module subroutine stiffen_contacts(run)
         type(run_t), intent(inout) :: run
      end subroutine stiffen_contacts

      !> Begin with the rows of blocks that go on as they are
      pure module subroutine foresee_curves(run)
         type(run_t), intent(inout) :: run
      end subroutine foresee_curves

      !> Settle the contacts again with rows of the motion that was found, until closed contacts
      !> have no gap at the end of the step; blocks and joints there are set
      pure module subroutine follow_curves(run)
         type(run_t), intent(inout) :: run
      end subroutine follow_curves

      !> Settle the joints of one step: once in reference geometry, where the penalty has no
      !> influence, and where springs give for good; until the multipliers stay the same where
      !> blocks move
      pure module subroutine settle_joints(settings, equations, springs, state)
         type(settings_t), intent(in) :: settings
         !> Blocks assembled; matrix and factor are made anew
         type(equations_t), intent(inout) :: equations
         type(joint_springs_t), intent(in) :: springs
         !> Faces to begin with in, motion and joints out
         type(step_state_t), intent(inout) :: state
      end subroutine settle_joints

      !> Whether all blocks move so slowly that this may be what contact forces leave, or with finer
      !> forces that it was
      pure logical module function is_slow(run, velocity, finer)
         type(run_t), intent(in) :: run
         real(wp), intent(in) :: velocity(:, :)  !! Velocities: (n_dof, n_equation)
         logical, intent(in) :: finer            !! Whether forces were finer
      end function is_slow

      !> Length of a step in which rounding of gaps moves blocks less than forces that are not
      !> balanced
      pure real(wp) module function balancing_time(run) result(time)
         type(run_t), intent(in) :: run
      end function balancing_time

      !> Whether no block moves and the contact forces at hand balance the loads of the coming step,
      !> which are assembled
      pure module subroutine stands_still(run, still)
         type(run_t), intent(inout) :: run
         logical, intent(out) :: still  !! The answer
      end subroutine stands_still

      !> A step, begun, in which nothing moves: its forces are those before
      pure module subroutine stand_still(run)
         type(run_t), intent(inout) :: run
      end subroutine stand_still

   end interface

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
      call predict(run)
      do attempt = 0, max_retries
         if (is_too_short(run)) exit
         if (run%step%renews) call place_contacts(run)
         run%step%state%effort%patient = attempt > hasty_tries
         outcome = step_outcome_t(accepted=run%step%is_solved)
         if (.not. outcome%accepted) then
            call assemble(run)
            outcome = check_start(run)
            if (outcome%accepted) call solve_contacts(run)
         end if
         if (outcome%accepted) outcome = check_motion(run)
         if (outcome%accepted .and. in_time(run)) then
            call solve_impacts(run)
            outcome = check_velocities(run)
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

   !> Contacts, blocks and bars at the end of a step
   pure subroutine carry_over(run)
      type(run_t), intent(inout) :: run
      logical :: breaks

      call update_contacts(run%step, run%settings, run%contacts, breaks)
      call update_blocks(run%step, run%settings, run%system)
      call keep_bars(run%equations%bars, run%settings, run%step%state%motion, run%system)
      run%step%whole = .not. breaks
   end subroutine carry_over

   !> The state that a step starts from: the joints as they are, no motion
   pure subroutine begin_step(run)
      type(run_t), intent(inout) :: run
      integer :: n

      n = size(run%contacts%joint)
      associate (state => run%step%state)
         if (.not. allocated(state%motion)) allocate (state%motion, mold=run%equations%weight)
         if (allocated(state%face)) then
            if (size(state%face) /= n) deallocate (state%increment, state%trial, state%force, &
               & state%face, state%cone)
         end if
         if (.not. allocated(state%face)) then
            allocate (state%increment(3, n), state%trial(3, n), state%force(3, n))
            allocate (state%face(n), state%cone(n))
         end if
         state%motion = 0.0_wp
         state%force = run%contacts%force
         state%trial = run%contacts%trial
         state%face = run%contacts%face
         state%cone = run%contacts%springs%cone
         state%unsettled_work = 0.0_wp
         state%settled = .false.
         state%effort = effort_t(patient=state%effort%patient)
         state%passes = 0
      end associate
   end subroutine begin_step
end module dda_step
