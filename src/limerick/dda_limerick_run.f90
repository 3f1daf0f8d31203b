!> A run of the original's scheme to its verdict
module dda_limerick_run
   use dda_block_system, only : n_unknown
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_model_t, loads_end
   use dda_limerick_state, only : new_blocks, new_march
   use dda_limerick_step, only : advance, limerick_run_t
   implicit none
   private

   public :: limerick_outcome_t, limerick_verdict, limerick_verdict_enum
   public :: begin_run, run_limerick, largest_displacement

   !> How a run can end
   type :: limerick_verdict_enum
      !> Not known
      integer :: undecided = 0
      !> At rest, or still below the collapse displacement when the steps are spent
      integer :: stable = 1
      !> A vertex moved by the collapse displacement
      integer :: collapsed = 2
      !> A dynamic run that reached its last step
      integer :: completed = 3
   end type limerick_verdict_enum

   !> Names of the verdicts
   type(limerick_verdict_enum), parameter :: limerick_verdict = limerick_verdict_enum()

   !> How a run ended
   type :: limerick_outcome_t
      !> One of limerick_verdict
      integer :: verdict = limerick_verdict%undecided
      !> Why the verdict is undecided; unallocated otherwise
      character(len=:), allocatable :: reason
      !> Whether the steps were spent while something still moved
      logical :: still_moving = .false.
      !> Largest distance of a vertex from where it began [m]
      real(wp) :: displacement = 0.0_wp
      !> Accepted steps
      integer :: steps = 0
      !> Passes of the open-close loop, each with one factorisation
      integer :: passes = 0
      !> Time at the end of each step, with the beginning, the first steps + 1 of them [s]
      real(wp), allocatable :: time(:)
      !> Where the first of the measured points are then: (2, n_point, :) [m]
      real(wp), allocatable :: track(:, :, :)
   end type limerick_outcome_t

   !> Steps over which rest is judged
   integer, parameter :: rest_steps = 1000
   !> Change of the largest displacement in that many steps, over the half size, that counts as rest
   real(wp), parameter :: rest_share = 1.0e-7_wp

contains

   !> A run before its first step
   pure subroutine begin_run(model, run)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run
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
   pure subroutine run_limerick(model, run, outcome, n_track)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run as it ended
      type(limerick_run_t), intent(out) :: run
      !> How it ended
      type(limerick_outcome_t), intent(out) :: outcome
      !> Of how many measured points the way is kept; none if it is not given
      integer, intent(in), optional :: n_track
      type(error_t), allocatable :: error
      real(wp) :: last, end
      logical :: rests

      call begin_run(model, run)
      allocate (outcome%time(64))
      if (present(n_track)) then
         allocate (outcome%track(2, n_track, 64))
      else
         allocate (outcome%track(2, 0, 64))
      end if
      call keep_track(run, outcome)
      last = -huge(last)
      end = loads_end(model)
      do while (run%march%steps < model%constants%max_steps)
         call advance(model, run, error)
         if (allocated(error)) exit
         call keep_track(run, outcome)
         outcome%displacement = largest_displacement(model, run)
         if (model%constants%dynamic) cycle
         if (outcome%displacement > model%constants%collapse_displacement) &
            & outcome%verdict = limerick_verdict%collapsed
         if (mod(run%march%steps, rest_steps) == 0 .and. .not. run%march%time < end) then
            rests = abs(outcome%displacement - last) < rest_share*run%march%half_size
            if (rests) outcome%verdict = limerick_verdict%stable
            last = outcome%displacement
         end if
         if (outcome%verdict /= limerick_verdict%undecided) exit
      end do
      outcome%steps = run%march%steps
      outcome%passes = run%march%passes
      if (allocated(error)) then
         outcome%reason = error%message
      else if (model%constants%dynamic) then
         outcome%verdict = limerick_verdict%completed
      else if (outcome%verdict == limerick_verdict%undecided) then
         call spend_steps(run%march%time, end, outcome)
      end if
   end subroutine run_limerick

   !> What still moves when the steps are spent is called stable, as a user of the original would
   !> have said; but not before all loads have come
   pure subroutine spend_steps(time, end, outcome)
      !> Time that the steps have reached [s]
      real(wp), intent(in) :: time
      !> Time of the last record of a load [s]
      real(wp), intent(in) :: end
      !> The outcome; verdict and reason are set
      type(limerick_outcome_t), intent(inout) :: outcome

      if (time < end) then
         outcome%reason = "step limit reached before the last record of a load; raise "// &
            & "analysis%steps"
      else
         outcome%verdict = limerick_verdict%stable
         outcome%still_moving = .true.
      end if
   end subroutine spend_steps

   !> Keep where the measured points are at the end of a step
   pure subroutine keep_track(run, outcome)
      !> The run
      type(limerick_run_t), intent(in) :: run
      !> Receives the places
      type(limerick_outcome_t), intent(inout) :: outcome
      real(wp), allocatable :: time(:), track(:, :, :)
      integer :: n, n_track

      n = run%march%steps
      n_track = size(outcome%track, 2)
      if (n_track == 0) return
      if (n == size(outcome%time)) then
         allocate (time(2*n), track(2, n_track, 2*n))
         time(:n) = outcome%time
         track(:, :, :n) = outcome%track
         call move_alloc(time, outcome%time)
         call move_alloc(track, outcome%track)
      end if
      outcome%time(n + 1) = run%march%time
      outcome%track(:, :, n + 1) = run%blocks%measured_point(:, :n_track)
   end subroutine keep_track

   !> Largest distance of a vertex from where it began [m]
   pure real(wp) function largest_displacement(model, run)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run
      type(limerick_run_t), intent(in) :: run
      integer :: v

      largest_displacement = 0.0_wp
      do v = 1, size(model%vertex, 2)
         largest_displacement = max(largest_displacement, &
            & (run%blocks%vertex(1, v) - model%vertex(1, v))**2 &
            & + (run%blocks%vertex(2, v) - model%vertex(2, v))**2)
      end do
      largest_displacement = sqrt(largest_displacement)
   end function largest_displacement
end module dda_limerick_run
