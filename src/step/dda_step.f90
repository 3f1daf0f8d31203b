!> One step as a transaction: blocks and contacts change only when it is accepted
!>
!> Equation (M1) of docs/method.md
module dda_step
   use dda_assembly, only : equations_t, renew_springs, take_springs
   use dda_bar_springs, only : keep_bars
   use dda_block_inertia, only : assemble_blocks, packed_velocity, turn_masses
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_detection, only : contacts_t, follow_contacts
   use dda_contact_transfer, only : renew_contacts
   use dda_curved_motion, only : follow_curves, foresee_curves
   use dda_energy, only : audit_step
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_multipliers, only : settle_joints
   use dda_settings, only : settings_t
   use dda_standstill, only : balancing_time, is_slow, stand_still, stands_still
   use dda_step_check, only : check_motion, check_end_velocities, retry
   use dda_step_context, only : march_t, step_context_t, step_outcome_t
   use dda_step_interval, only : largest_motion
   use dda_step_reach, only : first_reach, next_reach, travel_of
   use dda_step_state, only : step_state_t
   use dda_velocity, only : settle_velocities, stiffen_contacts
   use dda_verdict, only : measure_step
   implicit none
   private

   public :: advance, begin_step

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 40
   !> Tries in which very many joints are swept before their faces agree
   integer, parameter :: hasty_tries = 3
   !> Opening against the law of contact that many blocks may leave, over twice the fall in a step
   real(wp), parameter :: unseen = 1.0e-3_wp
   !> Shortest step in time: stiffness that grows with its inverse square overflows [s]
   real(wp), parameter :: shortest_step = 1.0e-40_wp
   !> Steps from one try to bring slow blocks to rest to the next, and most steps of such a try
   integer, parameter :: between_tries = 16, steps_of_try = 40
   !> Steps by which such a try must have taken all speed
   integer, parameter :: lively_steps = 4
   !> Distance that blocks may go in the first of these steps, over the size of the smallest block,
   !> and how much of it in the next
   real(wp), parameter :: no_distance = 1.0e-7_wp, falling = 0.8_wp
   !> How much smaller than usual the gaps are that a try leaves
   real(wp), parameter :: of_try = 1.0e-6_wp

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

   !> A step of blocks that stand still, or are found to: nothing moves in it
   pure subroutine rest(settings, system, contacts, equations, march, step, still)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      !> Whether they stand still; otherwise nothing has changed
      logical, intent(out) :: still

      call stands_still(settings, system, contacts, march, equations, still)
      if (.not. still .and. march%steps > 0 .and. modulo(march%steps, between_tries) == 0) then
         if (is_slow(equations, march, packed_velocity(system, settings%n_dof), .false.)) &
            & call come_to_rest(settings, system, contacts, equations, march, step, still)
      end if
      if (.not. still) return
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      call stand_still(contacts, equations, march, step)
      step%accepted = .true.
      step%was_cut = .false.
      march%steps = march%steps + 1
      march%time = march%time + step%dt
      call audit_step(settings, system, equations, contacts, step, march%time, march%energy)
   end subroutine rest

   !> Bring blocks to rest whose speeds may be what contact forces leave: finer forces take all
   !> speed in one step, but not of what slides without resistance; after it the gaps that are left
   !> close and forces balance. Where they do not, nothing changes
   pure subroutine come_to_rest(settings, system, contacts, equations, march, step, still)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march; passes are counted
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      !> Whether they stand still
      logical, intent(out) :: still
      type(block_system_t) :: moving
      type(contacts_t) :: before
      type(contacts_t), allocatable :: none
      type(march_t) :: trial
      real(wp) :: held(size(equations%fixed%force))
      real(wp) :: distance
      logical :: breaks, lively
      integer :: i

      moving = system
      before = contacts
      held = equations%fixed%force
      trial = march
      still = .false.
      lively = .true.
      distance = no_distance*sqrt(minval(system%area, mask=system%equation > 0))
      do i = 1, steps_of_try
         call predict(settings, system, contacts, equations, trial, step)
         call place_contacts(settings, system, step%travel, none, trial, contacts, equations)
         step%state%fineness = of_try
         step%state%patient = .true.
         call find_motion(settings, system, contacts, equations, trial, step)
         if (.not. step%state%settled .or. step%farthest > distance) exit
         if (lively) then
            call settle_velocities(settings, system, contacts, equations, step)
            lively = .not. is_slow(equations, march, step%velocity, .true.)
            if (.not. step%has_velocity .or. lively .and. i == lively_steps) exit
         else
            distance = max(falling*step%farthest, equations%gap_noise)
         end if
         if (.not. lively) then
            step%velocity = 0.0_wp*step%state%motion
            trial%dt = max(march%dt, balancing_time(equations, march))
         end if
         call update_contacts(step, settings, contacts, breaks)
         call update_blocks(step, settings, system)
         call keep_bars(equations%bars, settings, step%state%motion, system)
         call stands_still(settings, system, contacts, march, equations, still)
         if (still) exit
      end do
      step%state%fineness = 1.0_wp
      march%passes = trial%passes
      if (still) return
      call renew_springs(contacts%springs%equation, before%springs, equations)
      system = moving
      contacts = before
      equations%fixed%force = held
   end subroutine come_to_rest

   !> What a step begins with: masses as the blocks have turned, and how corners are about to move
   pure subroutine predict(settings, system, contacts, equations, march, step)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> The contacts; whether they remember their slip is set
      type(contacts_t), intent(inout) :: contacts
      !> The equations; masses are set
      type(equations_t), intent(inout) :: equations
      type(march_t), intent(in) :: march
      type(step_context_t), intent(inout) :: step

      contacts%remember = .not. (settings%dynamic .and. settings%current)
      step%was_cut = .false.
      step%choices = 0
      step%renews = settings%current
      step%longest = march%longest
      step%slowest_impact = 2.0_wp*march%free_acceleration*march%longest
      step%travel = 0.0_wp*system%vertex
      if (.not. settings%current) return
      call turn_masses(system, equations)
      if (contacts%searched) step%travel = travel_of(system, settings, march)
   end subroutine predict

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

   !> The motion of one try, measured
   pure subroutine find_motion(settings, system, contacts, equations, march, step)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march; passes are counted
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      logical :: in_time

      in_time = settings%dynamic .and. settings%current
      step%dt = march%dt
      if (in_time) call stiffen_contacts(system, step%dt, contacts)
      if (in_time) call take_springs(equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      step%state%unseen = step%state%fineness*unseen*march%free_acceleration*step%dt**2
      call assemble_blocks(system, settings, step%dt, equations, &
         & merge(march%time, march%clock%now, settings%dynamic))
      if (in_time) call foresee_curves(settings, system, contacts, step)
      call settle_joints(settings, equations, contacts%springs, step%state)
      if (in_time .and. step%state%settled) &
         & call follow_curves(settings, system, contacts, equations, step)
      march%passes = march%passes + step%state%passes
      step%last_farthest = step%farthest
      if (step%state%settled) step%farthest = largest_motion(system, step%state%motion)
   end subroutine find_motion

   !> Contacts where the blocks are now: those that were given, or those that a search finds
   pure subroutine place_contacts(settings, system, travel, kept, march, contacts, equations)
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
      integer, allocatable :: before(:, :)

      if (contacts%searched) then
         allocate (before, source=contacts%springs%equation)
         if (allocated(kept)) contacts = kept
         if (.not. allocated(march%reach)) march%reach = first_reach(system, settings, march)
         call renew_contacts(system, travel, march%reach, settings%penalty_ratio, &
            & settings%n_dof, contacts)
         call renew_springs(before, contacts%springs, equations)
      else
         call follow_contacts(system, settings%penalty_ratio, settings%n_dof, contacts)
         call take_springs(equations)
      end if
   end subroutine place_contacts

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
      state%passes = 0
   end subroutine begin_step
end module dda_step
