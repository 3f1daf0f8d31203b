!> A run of the original's scheme to its verdict
module dda_limerick_run
   use dda_block_system, only : n_unknown
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_model_t
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
   pure subroutine run_limerick(model, run, outcome)
      !> The model
      type(limerick_model_t), intent(in) :: model
      !> The run as it ended
      type(limerick_run_t), intent(out) :: run
      !> How it ended
      type(limerick_outcome_t), intent(out) :: outcome
      type(error_t), allocatable :: error
      real(wp) :: last
      logical :: rests

      call begin_run(model, run)
      last = -huge(last)
      do while (run%march%steps < model%constants%max_steps)
         call advance(model, run, error)
         if (allocated(error)) exit
         outcome%displacement = largest_displacement(model, run)
         if (model%constants%dynamic) cycle
         if (outcome%displacement > model%constants%collapse_displacement) &
            & outcome%verdict = limerick_verdict%collapsed
         if (mod(run%march%steps, rest_steps) == 0) then
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
         outcome%verdict = limerick_verdict%stable
         outcome%still_moving = .true.
      end if
   end subroutine run_limerick

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
