!> One step as a transaction: blocks and contacts change only when it is accepted
!>
!> Equation (M1) of docs/method.md
module dda_step
   use dda_bar_springs, only : keep_bars
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_types, only : joint_springs_t
   use dda_contacts, only : contacts_t
   use dda_energy, only : audit_step
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t, step_outcome_t
   use dda_step_reach, only : next_reach
   use dda_step_state, only : equations_t, step_state_t
   use dda_verdict, only : measure_step
   implicit none
   private

   public :: advance, begin_step, check_axes, check_impact, retry, settle_joints, balancing_time
   public :: is_slow, stand_still, stands_still

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 40
   !> Tries in which very many joints are swept before their faces agree
   integer, parameter :: hasty_tries = 3

   !> Shortest step in time: stiffness that grows with its inverse square overflows [s]
   real(wp), parameter :: shortest_step = 1.0e-40_wp

   interface

      !> Begin with the rows of blocks that go on as they are
      pure module subroutine foresee_curves(settings, system, contacts, step)
         type(settings_t), intent(in) :: settings
         !> The blocks before the step
         type(block_system_t), intent(in) :: system
         !> The contacts before the step; rows of their springs are set
         type(contacts_t), intent(inout) :: contacts
         !> The step; its curves and trial forces are set
         type(step_context_t), intent(inout) :: step
      end subroutine foresee_curves

      !> Settle the contacts again with rows of the motion that was found, until closed contacts
      !> have no gap at the end of the step
      pure module subroutine follow_curves(settings, system, contacts, equations, step)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(inout) :: contacts
         !> Blocks assembled; matrix and factor are made anew
         type(equations_t), intent(inout) :: equations
         !> The step; its curves, and blocks and joints at its end, are set
         type(step_context_t), intent(inout) :: step
      end subroutine follow_curves

      !> Velocities of the blocks at the end of a settled step. Newton's restitution may bring in
      !> energy where there is friction, or where blocks are hit in several places; then there is
      !> less of it. What contacts have done to the energy of the motion is no part of what is
      !> allowed; without contacts only held points change it, which turn with their blocks
      pure module subroutine settle_velocities(settings, system, contacts, equations, step)
         type(settings_t), intent(in) :: settings
         !> The blocks before the step
         type(block_system_t), intent(in) :: system
         !> The contacts before the step
         type(contacts_t), intent(in) :: contacts
         !> The equations; matrix and factor are made anew
         type(equations_t), intent(inout) :: equations
         !> The step; its velocities are set, if they settle
         type(step_context_t), intent(inout) :: step
      end subroutine settle_velocities

      !> Springs of contacts whose forces are multipliers: stiff beside inertia however short the
      !> step, and without memory of slip, which would bring in work. What sticks has no speed to
      !> slip with
      pure module subroutine stiffen_contacts(system, dt, contacts)
         type(block_system_t), intent(in) :: system
         !> Length of the step [s]
         real(wp), intent(in) :: dt
         !> The contacts; stiffness and trial forces are set
         type(contacts_t), intent(inout) :: contacts
      end subroutine stiffen_contacts

      !> Check the motion of a try: settled, short enough, within its margins, without an impact
      !> inside, by the right axes
      pure module function check_motion(settings, system, contacts, equations, march, &
         & step) result(outcome)
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
      end function check_motion

      !> Check the velocities of a try: settled, and no corner inside a neighbour
      pure module function check_end_velocities(settings, system, contacts, march, &
         & step) result(outcome)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(march_t), intent(in) :: march
         type(step_context_t), intent(in) :: step
         type(step_outcome_t) :: outcome
      end function check_end_velocities

      !> Change for the next try what the checks ask for: its length, margins, axes
      pure module subroutine retry(system, outcome, march, step)
         type(block_system_t), intent(in) :: system
         type(step_outcome_t), intent(in) :: outcome
         !> The march; length and margins are set
         type(march_t), intent(inout) :: march
         !> The try; how corners move is set, and whether contacts are searched again
         type(step_context_t), intent(inout) :: step
      end subroutine retry

      !> Check the separating axes of a settled step. Where corners pass corners, which edge the one
      !> would go in by depends on the way that both take. A line that has held off a block which
      !> turns out to be apart was the wrong one, and so was one that has let it in: they are chosen
      !> anew by the motion; if blocks still enter one another the step is cut, and if some are
      !> still held off in thin air, they are
      pure type(step_outcome_t) module function check_axes(system, contacts, march, &
         & step) result(outcome)
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(march_t), intent(in) :: march
         type(step_context_t), intent(in) :: step
      end function check_axes

      !> Check that no open contact closes fast within the step, for the speed at that very moment
      !> counts, and the time that is left after it; a step in which one does ends when the
      !> two blocks, if nothing else touched them, would be near enough to count as touching
      pure module function check_impact(settings, system, contacts, equations, step) result(outcome)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(equations_t), intent(in) :: equations
         type(step_context_t), intent(in) :: step
         !> What the check says
         type(step_outcome_t) :: outcome
      end function check_impact

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

      !> What a step begins with: masses as the blocks have turned, and how corners are about to
      !> move
      pure module subroutine predict(settings, system, contacts, equations, march, step)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         !> The contacts; whether they remember their slip is set
         type(contacts_t), intent(inout) :: contacts
         !> The equations; masses are set
         type(equations_t), intent(inout) :: equations
         type(march_t), intent(in) :: march
         type(step_context_t), intent(inout) :: step
      end subroutine predict

      !> The motion of one try, measured
      pure module subroutine find_motion(settings, system, contacts, equations, march, step)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         !> The march; passes are counted
         type(march_t), intent(inout) :: march
         type(step_context_t), intent(inout) :: step
      end subroutine find_motion

      !> Contacts where the blocks are now: those that were given, or those that a search finds
      pure module subroutine place_contacts(settings, system, travel, kept, march, contacts, &
         & equations)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         !> How the corners are about to move: (2, n_vertex) [m]
         real(wp), intent(in) :: travel(:, :)
         !> The contacts at the end of the step before, where a search must not go by an earlier one
         type(contacts_t), allocatable, intent(in) :: kept
         !> The march; its reach is set where it was not
         type(march_t), intent(inout) :: march
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
      end subroutine place_contacts

      !> A step of blocks that stand still, or are found to: nothing moves in it
      pure module subroutine rest(settings, system, contacts, equations, march, step, still)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(inout) :: system
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         type(march_t), intent(inout) :: march
         type(step_context_t), intent(inout) :: step
         !> Whether they stand still; otherwise nothing has changed
         logical, intent(out) :: still
      end subroutine rest

      !> Whether all blocks move so slowly that this may be what contact forces leave, or with finer
      !> forces that it was
      pure logical module function is_slow(equations, march, velocity, finer)
         !> The equations, for the masses
         type(equations_t), intent(in) :: equations
         !> The march, for the length of the step and free fall
         type(march_t), intent(in) :: march
         !> Velocities: (n_dof, n_equation)
         real(wp), intent(in) :: velocity(:, :)
         !> Whether forces were finer
         logical, intent(in) :: finer
      end function is_slow

      !> Length of a step in which rounding of gaps moves blocks less than forces that are not
      !> balanced
      pure real(wp) module function balancing_time(equations, march) result(time)
         !> The equations, for the rounding
         type(equations_t), intent(in) :: equations
         !> The march, for free fall
         type(march_t), intent(in) :: march
      end function balancing_time

      !> Whether no block moves and the contact forces at hand balance the loads of the coming step
      pure module subroutine stands_still(settings, system, contacts, march, equations, still)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(march_t), intent(in) :: march
         !> The equations; blocks are assembled
         type(equations_t), intent(inout) :: equations
         !> The answer
         logical, intent(out) :: still
      end subroutine stands_still

      !> A step in which nothing moves: its forces are those before
      pure module subroutine stand_still(contacts, equations, march, step)
         !> The contacts; what the last step added to gaps is none
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(in) :: equations
         type(march_t), intent(in) :: march
         !> The step, begun; its motion and forces are set
         type(step_context_t), intent(inout) :: step
      end subroutine stand_still

   end interface

contains

   !> One step: blocks and contacts change only when it is accepted
   pure subroutine advance(settings, system, contacts, equations, march, step, error)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> What is carried from step to step
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      !> Allocated if no step, however short, settles
      type(error_t), allocatable, intent(inout) :: error
      type(contacts_t), allocatable :: kept
      type(step_outcome_t) :: outcome
      logical :: still
      integer :: attempt

      if (settings%dynamic .and. settings%current) then
         call rest(settings, system, contacts, equations, march, step, still)
         if (still) return
      end if
      call predict(settings, system, contacts, equations, march, step)
      if (contacts%searched .and. contacts%remember .and. settings%current) kept = contacts
      do attempt = 0, max_retries
         if (too_short(settings, march)) exit
         if (step%renews) call place_contacts(settings, system, step%travel, kept, march, &
            & contacts, equations)
         step%state%patient = attempt > hasty_tries
         call find_motion(settings, system, contacts, equations, march, step)
         outcome = check_motion(settings, system, contacts, equations, march, step)
         if (outcome%accepted .and. .not. contacts%remember) then
            call settle_velocities(settings, system, contacts, equations, step)
            outcome = check_end_velocities(settings, system, contacts, march, step)
         end if
         if (outcome%accepted .or. march%clock%tries .and. .not. outcome%beyond_margin) exit
         call retry(system, outcome, march, step)
      end do
      step%accepted = outcome%accepted
      if (step%accepted) then
         call commit(settings, system, contacts, equations, march, step)
      else if (.not. march%clock%tries) then
         call fatal_error(error, "open-close iteration does not converge for any time step")
      end if
   end subroutine advance

   !> Whether a step in time is too short for its stiffness, or for time to go on
   pure logical function too_short(settings, march)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march

      too_short = settings%dynamic .and. settings%current &
         & .and. march%dt < max(shortest_step, spacing(march%time))
   end function too_short

   !> Carry an accepted step over
   pure subroutine commit(settings, system, contacts, equations, march, step)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(in) :: equations
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      logical :: breaks

      if (contacts%searched) call next_reach(system, step, march)
      call measure_step(system, contacts%springs, equations, contacts%force, step)
      call update_contacts(step, settings, contacts, breaks)
      call update_blocks(step, settings, system)
      call keep_bars(equations%bars, settings, step%state%motion, system)
      step%whole = .not. breaks
      march%steps = march%steps + 1
      march%clock%tries = .false.
      if (.not. has_path(march%clock)) march%time = march%time + step%dt
      if (settings%dynamic) call audit_step(settings, system, equations, contacts, step, &
         & march%time, march%energy)
   end subroutine commit

   !> The state that a step starts from: the joints as they are, no motion
   pure subroutine begin_step(contacts, n_dof, n_equation, state)
      type(contacts_t), intent(in) :: contacts
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> Number of movable blocks
      integer, intent(in) :: n_equation
      type(step_state_t), intent(inout) :: state
      integer :: n

      n = size(contacts%joint)
      if (.not. allocated(state%motion)) allocate (state%motion(n_dof, n_equation))
      if (allocated(state%face)) then
         if (size(state%face) /= n) deallocate (state%increment, state%start, state%trial, &
            & state%force, state%face, state%cone, state%multiplier)
      end if
      if (.not. allocated(state%face)) then
         allocate (state%increment(3, n), state%start(3, n))
         allocate (state%trial(3, n), state%force(3, n), state%face(n), state%cone(n))
         allocate (state%multiplier(3, n))
      end if
      state%motion = 0.0_wp
      state%multiplier = contacts%force
      state%start = contacts%trial
      state%face = contacts%face
      state%cone = contacts%springs%cone
      state%unsettled_work = 0.0_wp
      state%many = .false.
      state%swept = .false.
      state%again = .false.
      state%passes = 0
   end subroutine begin_step
end module dda_step
