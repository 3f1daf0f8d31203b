!> Forward analysis: one step as a transaction, and a run of steps to a verdict (Shi: df)
module dda_forward
   use dda_assembly, only : equations_t, new_equations, renew_springs, take_springs
   use dda_block_inertia, only : assemble_blocks, turn_masses
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_condition, only : factored_condition
   use dda_contact_detection, only : contacts_t, follow_contacts
   use dda_contact_transfer, only : renew_contacts
   use dda_curved_motion, only : follow_curves
   use dda_energy, only : audit_step, keep_energy
   use dda_entry, only : refuse_entry
   use dda_fall, only : has_fallen, neighbours_of
   use dda_error, only : error_t, fatal_error
   use dda_frames, only : album_t, keep_pictures
   use dda_impact_time, only : meet_impact
   use dda_kinds, only : wp
   use dda_multipliers, only : settle_joints
   use dda_parting, only : judge_parting
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t
   use dda_step_interval, only : first_interval, judge_step, measure_scales, next_interval
   use dda_step_reach, only : first_reach, judge_reach, next_reach, travel_by, travel_of
   use dda_step_state, only : step_state_t
   use dda_velocity, only : settle_velocities, stiffen_contacts
   use dda_verdict, only : judge_verdict, largest_displacement, measure_step, verdict
   implicit none
   private

   public :: outcome_t, run_to_verdict, advance

   !> How a run ended
   type :: outcome_t
      !> One of verdict
      integer :: verdict = 0
      !> Why the verdict is undecided; unallocated otherwise
      character(len=:), allocatable :: reason
      !> Acceleration of the last step over that of the loads
      real(wp) :: acceleration_ratio = 0.0_wp
      !> Acceleration ratio below which the run would have been at rest
      real(wp) :: rest_tolerance = 0.0_wp
      !> Length of a step in which free fall is the elastic motion [s]
      real(wp) :: elastic_time = 0.0_wp
      !> Estimated condition number of the last equations, if it was wanted
      real(wp) :: condition = 0.0_wp
      !> Motion of the step that gave the verdict: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Contacts after that step, if a collapse has been followed from there for its pictures
      type(contacts_t), allocatable :: fallen
      !> Accepted steps
      integer :: steps = 0
      !> Passes of the open-close loop
      integer :: passes = 0
      !> Factorisations
      integer :: factorisations = 0
   end type outcome_t

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 40

contains

   !> Run a static analysis to its verdict, a dynamic one to its end
   pure subroutine run_to_verdict(settings, system, contacts, outcome, album, onward)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks: at the beginning in, at the end out
      type(block_system_t), intent(inout) :: system
      !> The contacts: at the beginning in, at the end out
      type(contacts_t), intent(inout) :: contacts
      !> How it ended
      type(outcome_t), intent(out) :: outcome
      !> Receives pictures of the run where blocks move
      type(album_t), intent(inout), optional :: album
      !> The march of a run that goes on in, without steps for one that begins; where it ended out
      type(march_t), intent(inout), optional :: onward
      type(equations_t) :: equations
      type(step_context_t) :: step
      type(march_t) :: march
      type(error_t), allocatable :: error
      integer, allocatable :: neighbours(:, :)

      if (maxval(system%equation) == 0) then
         ! nothing can move
         outcome%verdict = merge(verdict%completed, verdict%stable, settings%dynamic)
         allocate (outcome%motion(settings%n_dof, 0))
         return
      end if
      neighbours = neighbours_of(contacts%joint)
      call new_equations(system, contacts%springs, settings, equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      if (present(onward)) call go_on(settings, system, onward, march, equations)
      if (march%steps == 0) then
         call first_interval(system, contacts%springs, settings, equations, step%state, march, &
            & error)
         contacts%face = step%state%face
      end if
      if (settings%dynamic .and. march%steps == 0) call audit_step(settings, system, equations, &
         & contacts, step, 0.0_wp, march%energy)
      if (present(album)) call keep_pictures(settings, system, contacts, march, 0.0_wp, .false., &
         & album)
      do while (.not. allocated(error))
         if (march%steps >= settings%max_steps) exit
         if (settings%duration > 0.0_wp .and. march%time >= settings%duration) exit
         call advance(settings, system, contacts, equations, march, step, error)
         if (allocated(error)) exit
         if (present(album)) call keep_energy(march%energy, album%audit)
         outcome%verdict = verdict%undecided
         if (settings%current .or. settings%collapse_displacement > 0.0_wp) &
            & march%displacement = largest_displacement(system, settings%current)
         if (settings%current .and. .not. settings%dynamic) &
            & march%has_fallen = has_fallen(system, neighbours, settings%boundary%held)
         if (step%whole .and. .not. settings%dynamic) &
            & outcome%verdict = judge_verdict(march, step, settings)
         if (present(album)) call keep_pictures(settings, system, contacts, march, &
            & step%farthest, .false., album)
         if (outcome%verdict /= verdict%undecided) exit
         call next_interval(settings, system, step, march)
      end do
      march%held_force = equations%fixed%force
      if (present(onward)) onward = march
      outcome%rest_tolerance = settings%rest_tolerance
      if (march%free_acceleration > 0.0_wp) then
         outcome%acceleration_ratio = step%acceleration/march%free_acceleration
         outcome%elastic_time = sqrt(2.0_wp*march%elastic_motion/march%free_acceleration)
      end if
      if (settings%tells_condition) &
         & outcome%condition = factored_condition(equations%matrix, equations%factor)
      allocate (outcome%motion, source=step%state%motion)
      if (present(album)) call end_pictures(settings, system, contacts, equations, march, step, &
         & outcome, album)
      outcome%steps = march%steps
      outcome%passes = march%passes
      outcome%factorisations = equations%factorisations
      if (allocated(error)) then
         outcome%verdict = verdict%undecided
         outcome%reason = error%message
      else if (settings%dynamic .and. march%time >= settings%duration) then
         outcome%verdict = verdict%completed
      else if (settings%dynamic) then
         outcome%verdict = verdict%undecided
         outcome%reason = "all steps are spent before the end of the run"
      else if (outcome%verdict == verdict%undecided) then
         outcome%reason = "all steps are spent and neither rest nor collapse is proven"
      end if
   end subroutine run_to_verdict

   !> Take over the march of a run that goes on, and the forces at its held points; points that are
   !> held otherwise than before begin without force. Scales are those of the run as it is now
   pure subroutine go_on(settings, system, onward, march, equations)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Where the run ended
      type(march_t), intent(in) :: onward
      !> The march
      type(march_t), intent(out) :: march
      !> Receives the forces
      type(equations_t), intent(inout) :: equations

      march = onward
      if (march%steps == 0) return
      call measure_scales(system, settings, equations, march)
      march%dt = min(march%dt, march%longest)
      if (.not. allocated(march%held_force)) return
      if (size(march%held_force) == size(equations%fixed%force)) &
         & equations%fixed%force = march%held_force
   end subroutine go_on

   !> Follow a collapse beyond its verdict as far as the album wants to see it, and keep a picture
   !> of the end
   pure subroutine end_pictures(settings, system, contacts, equations, march, step, outcome, album)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(inout) :: system
      !> The contacts
      type(contacts_t), intent(inout) :: contacts
      !> The equations
      type(equations_t), intent(inout) :: equations
      !> The march
      type(march_t), intent(inout) :: march
      !> The last step
      type(step_context_t), intent(inout) :: step
      !> How the run ended; receives the contacts of a collapse that is followed
      type(outcome_t), intent(inout) :: outcome
      !> Receives the pictures
      type(album_t), intent(inout) :: album
      type(error_t), allocatable :: error

      if (outcome%verdict == verdict%collapsed .and. march%displacement < album%follow) &
         & outcome%fallen = contacts
      do while (allocated(outcome%fallen) .and. march%displacement < album%follow)
         if (march%steps == settings%max_steps) exit
         call next_interval(settings, system, step, march)
         call advance(settings, system, contacts, equations, march, step, error)
         if (allocated(error)) exit
         march%displacement = largest_displacement(system, settings%current)
         call keep_pictures(settings, system, contacts, march, step%farthest, .false., album)
      end do
      call keep_pictures(settings, system, contacts, march, step%farthest, .true., album)
   end subroutine end_pictures

   !> One step: blocks and contacts change only when it is accepted
   pure subroutine advance(settings, system, contacts, equations, march, step, error)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(inout) :: system
      !> The contacts
      type(contacts_t), intent(inout) :: contacts
      !> The equations
      type(equations_t), intent(inout) :: equations
      !> What is carried from step to step
      type(march_t), intent(inout) :: march
      !> The step
      type(step_context_t), intent(inout) :: step
      !> Allocated if no step, however short, settles
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: travel(2, size(system%vertex, 2))
      integer :: choices, retry
      logical :: again, breaks, in_time, widened

      in_time = settings%dynamic .and. settings%current
      widened = settings%current
      contacts%remember = .not. in_time
      if (settings%current) call turn_masses(system, equations)
      step%was_cut = .false.
      choices = 0
      travel = 0.0_wp
      if (contacts%searched .and. settings%current) travel = travel_of(system, settings, march)
      do retry = 0, max_retries
         if (widened) call place_contacts(settings, system, travel, march, contacts, equations)
         widened = .false.
         again = .false.
         call find_motion(settings, system, in_time, contacts, equations, march, step)
         if (contacts%searched .and. settings%current) &
            & call judge_reach(system, contacts, march, step, widened)
         if (step%accepted .and. in_time) &
            & call settle_impacts(settings, system, contacts, equations, choices, march, step, &
            & again)
         if (step%accepted) exit
         widened = widened .or. again
         if (again) travel = travel_by(system, step%state%motion)
      end do
      if (.not. step%accepted) then
         call fatal_error(error, "the open-close loop settles at no length of the step")
         return
      end if
      if (contacts%searched) call next_reach(system, step, march)
      call measure_step(system, contacts%springs, equations, contacts%force, step)
      call update_contacts(step, settings, contacts, breaks)
      call update_blocks(step, settings, system)
      step%whole = .not. breaks
      march%steps = march%steps + 1
      march%time = march%time + step%dt
      if (settings%dynamic) call audit_step(settings, system, equations, contacts, step, &
         & march%time, march%energy)
   end subroutine advance

   !> The motion of one try, and whether it is short enough
   pure subroutine find_motion(settings, system, in_time, contacts, equations, march, step)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Whether blocks move in time
      logical, intent(in) :: in_time
      !> The contacts
      type(contacts_t), intent(inout) :: contacts
      !> The equations
      type(equations_t), intent(inout) :: equations
      !> The march; the length of the next try is set
      type(march_t), intent(inout) :: march
      !> The step
      type(step_context_t), intent(inout) :: step

      step%dt = march%dt
      if (in_time) call stiffen_contacts(system, step%dt, contacts)
      if (in_time) call take_springs(contacts%springs, equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      call assemble_blocks(system, settings, step%dt, equations, march%time)
      call settle_joints(settings, equations, contacts%springs, step%state)
      if (in_time .and. step%state%settled) &
         & call follow_curves(settings, system, contacts, equations, step)
      march%passes = march%passes + step%state%passes
      call judge_step(settings, system, march, step)
   end subroutine find_motion

   !> Velocities after a settled step: cut it if blocks meet in it that rebound, or if the impulses
   !> do not settle
   pure subroutine settle_impacts(settings, system, contacts, equations, choices, march, step, &
      & again)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> The equations
      type(equations_t), intent(inout) :: equations
      !> How often the lines that part blocks were chosen by the motion of the step
      integer, intent(inout) :: choices
      !> The march; the length of the next try is set
      type(march_t), intent(inout) :: march
      !> The settled step; its velocities are set, and whether it counts
      type(step_context_t), intent(inout) :: step
      !> Whether they must be chosen again
      logical, intent(out) :: again

      again = .false.
      step%longest = march%longest
      step%slowest_impact = 2.0_wp*march%free_acceleration*march%longest
      call meet_impact(settings, system, contacts, equations, march, step)
      if (step%accepted .and. contacts%searched) &
         & call judge_parting(settings, system, contacts, choices, march, step, again)
      if (.not. step%accepted) return
      call settle_velocities(settings, system, contacts, equations, step)
      if (step%accepted) then
         if (contacts%searched) call refuse_entry(settings, system, contacts, march, step)
      else
         step%was_cut = .true.
         march%dt = march%dt/2.0_wp
      end if
   end subroutine settle_impacts

   !> Contacts where the blocks are now: those that were given, or those that a search finds
   pure subroutine place_contacts(settings, system, travel, march, contacts, equations)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> How the corners are about to move: (2, n_vertex) [m]
      real(wp), intent(in) :: travel(:, :)
      !> The march; its reach is set where it was not
      type(march_t), intent(inout) :: march
      !> The contacts
      type(contacts_t), intent(inout) :: contacts
      !> The equations
      type(equations_t), intent(inout) :: equations
      integer, allocatable :: before(:, :)

      if (contacts%searched) then
         allocate (before, source=contacts%springs%equation)
         if (.not. allocated(march%reach)) march%reach = first_reach(system, settings, march)
         call renew_contacts(system, travel, march%reach, settings%penalty_ratio, &
            & settings%n_dof, contacts)
         call renew_springs(before, contacts%springs, equations)
      else
         call follow_contacts(system, settings%penalty_ratio, settings%n_dof, contacts)
         call take_springs(contacts%springs, equations)
      end if
   end subroutine place_contacts

   !> The state that a step starts from: the joints as they are, no motion
   pure subroutine begin_step(contacts, n_dof, n_equation, state)
      !> The contacts
      type(contacts_t), intent(in) :: contacts
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> Number of movable blocks
      integer, intent(in) :: n_equation
      !> The state
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
      state%passes = 0
   end subroutine begin_step
end module dda_forward
