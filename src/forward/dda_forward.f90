!> Forward analysis: one step as a transaction, and a run of steps to a verdict (Shi: df)
module dda_forward
   use dda_assembly, only : assemble_blocks, equations_t, new_equations, take_springs
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_condition, only : factored_condition
   use dda_contact_detection, only : contacts_t, follow_contacts
   use dda_error, only : error_t, fatal_error
   use dda_frames, only : album_t, keep_frame
   use dda_kinds, only : wp
   use dda_multipliers, only : settle_joints
   use dda_open_close, only : step_state_t
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t
   use dda_step_interval, only : first_interval, judge_step, next_interval
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
      !> Motion of the last step: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Accepted steps
      integer :: steps = 0
      !> Passes of the open-close loop
      integer :: passes = 0
      !> Factorisations
      integer :: factorisations = 0
   end type outcome_t

   !> Most cuts of one step's length
   integer, parameter :: max_retries = 20

contains

   !> Run a static analysis to its verdict, a dynamic one to its last step
   pure subroutine run_to_verdict(settings, system, contacts, outcome, album)
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
      type(equations_t) :: equations
      type(step_context_t) :: step
      type(march_t) :: march
      type(error_t), allocatable :: error

      call new_equations(system, contacts%springs, settings, equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      call first_interval(system, contacts%springs, settings, equations, step%state, march, error)
      contacts%face = step%state%face
      if (present(album)) call keep_frame(system, contacts, 0, 0.0_wp, 0.0_wp, .false., album)
      do while (.not. allocated(error))
         if (march%steps == settings%max_steps) exit
         call advance(settings, system, contacts, equations, march, step, error)
         if (allocated(error)) exit
         outcome%verdict = verdict%undecided
         if (settings%current .or. settings%collapse_displacement > 0.0_wp) &
            & march%displacement = largest_displacement(system, settings%current)
         if (step%whole .and. .not. settings%dynamic) &
            & outcome%verdict = judge_verdict(march, step, settings)
         if (present(album)) call keep_frame(system, contacts, march%steps, march%time, &
            & march%displacement, outcome%verdict /= verdict%undecided, album)
         if (outcome%verdict /= verdict%undecided) exit
         call next_interval(settings, step, march)
      end do
      outcome%rest_tolerance = settings%rest_tolerance
      outcome%steps = march%steps
      outcome%passes = march%passes
      outcome%factorisations = equations%factorisations
      if (march%free_acceleration > 0.0_wp) then
         outcome%acceleration_ratio = step%acceleration/march%free_acceleration
         outcome%elastic_time = sqrt(2.0_wp*march%elastic_motion/march%free_acceleration)
      end if
      if (settings%tells_condition) &
         & outcome%condition = factored_condition(equations%matrix, equations%factor)
      call move_alloc(step%state%motion, outcome%motion)
      if (allocated(error)) then
         outcome%verdict = verdict%undecided
         outcome%reason = error%message
      else if (settings%dynamic) then
         outcome%verdict = verdict%completed
      else if (outcome%verdict == verdict%undecided) then
         outcome%reason = "all steps are spent and neither rest nor collapse is proven"
      end if
   end subroutine run_to_verdict

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
      integer :: retry
      logical :: breaks

      if (settings%current) then
         call follow_contacts(system, settings%penalty_ratio, settings%n_dof, contacts)
         call take_springs(contacts%springs, equations)
      end if
      step%was_cut = .false.
      do retry = 0, max_retries
         step%dt = march%dt
         call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
         call assemble_blocks(system, settings, step%dt, equations)
         call settle_joints(settings, equations, contacts%springs, step%state)
         march%passes = march%passes + step%state%passes
         call judge_step(settings, system, march, step)
         if (step%accepted) exit
      end do
      if (.not. step%accepted) then
         call fatal_error(error, "the open-close loop settles at no length of the step")
         return
      end if
      call measure_step(system, contacts%springs, equations, contacts%force, step)
      call update_contacts(step, settings, contacts, breaks)
      call update_blocks(step, settings, system)
      step%whole = .not. breaks
      march%steps = march%steps + 1
      march%time = march%time + step%dt
   end subroutine advance

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
      if (.not. allocated(state%motion)) then
         allocate (state%motion(n_dof, n_equation), state%increment(3, n), state%start(3, n))
         allocate (state%trial(3, n), state%force(3, n), state%face(n), state%cone(n))
         allocate (state%multiplier(3, n))
      end if
      state%motion = 0.0_wp
      state%multiplier = contacts%force
      state%start = contacts%trial
      state%face = contacts%face
      state%cone = contacts%springs%cone
      state%passes = 0
   end subroutine begin_step
end module dda_forward
