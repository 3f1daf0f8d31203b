!> A run of Shi's scheme to its verdict
module dda_limerick_run
   use dda_block_system, only : n_unknown
   use dda_error, only : error_t
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_model_t, limerick_state, loads_end, new_blocks, new_march
   use dda_limerick_step, only : advance_limerick, limerick_run_t
   use dda_material, only : friction_coefficient
   use dda_settings, only : verdict
   implicit none
   private

   public :: begin_outcome, begin_run, limerick_outcome_t, next_step, run_limerick

   !> Outcome of a run
   type :: limerick_outcome_t
      !> One of verdict; stable if at rest, or below the collapse displacement at the step limit;
      !> collapsed beyond the collapse displacement
      integer :: verdict = 0
      !> Reason of an undecided verdict; otherwise unallocated
      character(len=:), allocatable :: reason
      logical :: still_moving = .false.  !! True if blocks still moved at the step limit
      real(wp) :: displacement = 0.0_wp  !! Largest displacement of a vertex [m]
      integer :: steps = 0               !! Accepted steps
      integer :: passes = 0              !! Open-close iterations, one factorisation each
      !> Step and time after each step, from step 0 on, in the first steps + 1
      !> columns: (2, :) [-, s]
      real(wp), allocatable :: when(:, :)
      !> Coordinates of the first monitoring points at these times: (2, n_point, :) [m]
      real(wp), allocatable :: track(:, :, :)
      !> Largest displacement at the previous test of rest [m]
      real(wp) :: displacement_before = -huge(1.0_wp)
   end type limerick_outcome_t

   !> Number of steps in which rest is tested
   integer, parameter :: rest_steps = 1000
   !> Change of the largest displacement at rest, over the half size
   real(wp), parameter :: rest_share = 1.0e-7_wp
   !> Friction angle in the gravity phase [deg]
   real(wp), parameter :: gravity_phase_deg = 89.0_wp
   !> Cohesion in the gravity phase, in units of the file
   real(wp), parameter :: gravity_phase_cohesion = 1.0e4_wp

contains

   !> Start a run
   pure subroutine begin_run(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(out) :: run
      integer :: b, n

      call new_blocks(model, run%blocks)
      run%march = new_march(model, run%blocks)
      n = size(run%blocks%area)
      allocate (run%order(n), source=[(b, b=1, n)])
      allocate (run%moved, source=model%vertex)
      allocate (run%spring(4*n), run%contacts%item(64), run%before%item(64))
      allocate (run%equations%base(n_unknown, n_unknown, n))
      allocate (run%equations%load(n_unknown, n), run%equations%motion(n_unknown, n))
   end subroutine begin_run

   !> Run a model to its verdict
   pure subroutine run_limerick(model, run, outcome)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(out) :: run
      type(limerick_outcome_t), intent(out) :: outcome
      logical :: ended

      ended = .false.
      call begin_run(model, run)
      call begin_outcome(model, run, 0, outcome)
      do while (.not. ended)
         call next_step(model, run, outcome, ended)
      end do
   end subroutine run_limerick

   !> Start the outcome, and apply gravity in a separate phase if the model has one
   pure subroutine begin_outcome(model, run, n_track, outcome)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      integer, intent(in) :: n_track  !! Number of monitoring points to record
      type(limerick_outcome_t), intent(out) :: outcome
      type(error_t), allocatable :: error

      allocate (outcome%track(2, n_track, 0))
      call apply_gravity(model, run, error)
      if (allocated(error)) outcome%reason = "turning gravity on: "//error%message
      call keep_track(run, outcome)
   end subroutine begin_outcome

   !> Take one step of a run, or end it
   pure subroutine next_step(model, run, outcome, ended)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      type(limerick_outcome_t), intent(inout) :: outcome  !! The outcome; complete at the end
      logical, intent(out) :: ended  !! True at the end: by a verdict, an error or the step limit
      type(error_t), allocatable :: error
      real(wp) :: end
      logical :: rests

      end = loads_end(model)
      ended = allocated(outcome%reason) .or. run%march%steps >= model%constants%max_steps
      if (.not. ended) then
         call advance_limerick(model, run, error)
         if (allocated(error)) then
            outcome%reason = error%message
            ended = .true.
         end if
      else if (allocated(outcome%reason)) then
         continue
      else if (model%constants%dynamic) then
         outcome%verdict = verdict%completed
      else
         call end_at_step_limit(run%march%time, end, outcome)
      end if
      outcome%steps = run%march%steps
      outcome%passes = run%march%passes
      if (ended) return
      call keep_track(run, outcome)
      outcome%displacement = sqrt(maxval(sum((run%blocks%vertex - model%vertex)**2, dim=1)))
      if (model%constants%dynamic) return
      if (outcome%displacement > model%constants%collapse_displacement) &
         & outcome%verdict = verdict%collapsed
      if (mod(run%march%steps, rest_steps) == 0 .and. .not. run%march%time < end) then
         rests = abs(outcome%displacement - outcome%displacement_before) &
            & < rest_share*run%march%half_size
         if (rests) outcome%verdict = verdict%stable
         outcome%displacement_before = outcome%displacement
      end if
      ended = outcome%verdict /= verdict%undecided
   end subroutine next_step

   !> Apply gravity in steps from rest, with high joint strength, until the contact forces are
   !> constant; time starts after this phase (MacLaughlin 1997)
   pure subroutine apply_gravity(model, run, error)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      type(error_t), allocatable, intent(out) :: error
      type(limerick_model_t) :: phase
      real(wp), allocatable :: before(:, :), now(:, :)
      integer :: b, step
      logical :: steady

      if (model%constants%gravity_steps == 0) return
      phase = model
      phase%constants%dynamic = .false.
      phase%law%friction = max(phase%law%friction, friction_coefficient(gravity_phase_deg))
      phase%law%cohesion = max(phase%law%cohesion, gravity_phase_cohesion)
      allocate (before(2, 0))
      do step = 1, model%constants%gravity_steps
         call advance_limerick(phase, run, error)
         if (allocated(error)) return
         now = contact_forces(model, run)
         steady = size(now) == size(before) .and. is_quasi_static(model, run)
         if (steady) steady = all(maxval(abs(now - before), dim=2) &
            & <= model%constants%gravity_tolerance*maxval(abs(now), dim=2))
         if (steady) exit
         call move_alloc(now, before)
      end do
      run%march%steps = 0
      run%march%time = 0.0_wp
      run%march%time_step = model%constants%time_step
      run%blocks%velocity = 0.0_wp
      do b = 1, size(run%blocks%area)
         run%blocks%velocity(1:3, b) = model%material(model%block_material(b))%velocity
      end do
   end subroutine apply_gravity

   !> True if the last step moved blocks by a small part of a free fall only: blocks without contact
   !> have constant forces too
   pure logical function is_quasi_static(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      real(wp) :: fall

      associate (march => run%march)
         fall = norm2(model%load_direction)*maxval(model%material%unit_weight &
            & /model%material%density)*march%time_step**2/2.0_wp
         is_quasi_static = march%displacement_ratio*march%half_size &
            & *model%constants%max_displacement_ratio &
            & <= maxval(model%constants%gravity_tolerance)*fall
      end associate
   end function is_quasi_static

   !> Normal and shear forces of the contacts
   pure function contact_forces(model, run) result(force)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(in) :: run
      !> Forces of closed contacts, shear forces of locked ones: (2, n_contact) [N/m]
      real(wp), allocatable :: force(:, :)

      associate (contact => run%contacts%item(:run%contacts%n), penalty => run%march%used_penalty)
         allocate (force(2, size(contact)), source=0.0_wp)
         where (contact%state /= limerick_state%open) force(1, :) = -penalty*contact%gap
         where (contact%state == limerick_state%locked) force(2, :) = penalty*contact%shear &
            & /model%constants%stiffness_ratio
      end associate
   end function contact_forces

   !> Set the verdict at the step limit: stable, as in Shi's program, but only after the last record
   !> of a load
   pure subroutine end_at_step_limit(time, end, outcome)
      real(wp), intent(in) :: time                        !! Time at the step limit [s]
      real(wp), intent(in) :: end                         !! Time of the last record of a load [s]
      type(limerick_outcome_t), intent(inout) :: outcome  !! The outcome; verdict and reason are set

      if (time < end) then
         outcome%reason = "step limit reached before the last record of a load; raise "// &
            & "analysis%steps"
      else
         outcome%verdict = verdict%stable
         outcome%still_moving = .true.
      end if
   end subroutine end_at_step_limit

   !> Record the monitoring points at the end of a step
   pure subroutine keep_track(run, outcome)
      type(limerick_run_t), intent(in) :: run
      type(limerick_outcome_t), intent(inout) :: outcome
      integer :: n

      n = run%march%steps
      if (size(outcome%track, 2) == 0) return
      call make_room(outcome%when, n + 1)
      call make_room(outcome%track, n + 1)
      outcome%when(:, n + 1) = [real(n, wp), run%march%time]
      outcome%track(:, :, n + 1) = run%blocks%measured_point(:, :size(outcome%track, 2))
   end subroutine keep_track
end module dda_limerick_run
