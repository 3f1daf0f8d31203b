!> Start and end of a run, and its outcome
module dda_run_end
   use dda_assembly, only : new_equations
   use dda_balance, only : is_drowned
   use dda_contacts, only : raise_springs
   use dda_energy, only : audit_step
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_settings, only : verdict
   use dda_step_context, only : in_time, march_t, run_t
   use dda_step_interval, only : first_interval, measure_scales
   use dda_step_motion, only : begin_step
   use dda_verdict, only : outcome_t, still_moves_away
   implicit none
   private

   public :: conclude, start_run

contains

   !> Equations, scales and first step of a run, which begins or goes on from another
   pure subroutine start_run(run, error, onward)
      !> Settings, blocks and contacts in; faces to begin with are set
      type(run_t), intent(inout) :: run
      !> Allocated if the system cannot be solved
      type(error_t), allocatable, intent(out) :: error
      !> The march of the run that this one goes on from; without steps only its restrained points
      !> bear forces
      type(march_t), intent(in), optional :: onward

      call raise_springs(run%settings, run%system, run%contacts)
      call new_equations(run%system, run%contacts%springs, run%settings, run%equations)
      allocate (run%neighbours(2, size(run%contacts%joint)))
      run%neighbours(1, :) = run%contacts%joint%block(1)
      run%neighbours(2, :) = run%contacts%joint%block(2)
      call begin_step(run)
      if (present(onward)) call go_on(onward, run)
      if (run%march%steps > 0) return
      call first_interval(run, error)
      run%contacts%face = run%step%state%face
      if (run%settings%dynamic) then
         call audit_step(run)
      else if (run%settings%current .and. run%contacts%springs%give) then
         run%march%drowned = is_drowned(run%system, run%contacts, run%equations)
      end if
   end subroutine start_run

   !> Continue the march of a run that goes on, and the forces at its restrained points; points that
   !> are held otherwise than before begin without force. Scales are those of the run as it is now.
   !> Time has passed even where no block could move
   pure subroutine go_on(onward, run)
      type(march_t), intent(in) :: onward
      type(run_t), intent(inout) :: run

      if (onward%steps > 0) then
         run%march = onward
         call measure_scales(run)
         run%march%dt = min(run%march%dt, run%march%longest)
      end if
      run%march%time = onward%time
      if (.not. allocated(onward%held_force)) return
      if (size(onward%held_force) == size(run%equations%fixed%force)) &
         & run%equations%fixed%force = onward%held_force
   end subroutine go_on

   !> Outcome at the end of a run
   pure subroutine conclude(run, error, outcome)
      type(run_t), intent(in) :: run
      type(error_t), allocatable, intent(in) :: error
      !> End of the run; receives counts, the verdict, and the reason if it is undecided
      type(outcome_t), intent(inout) :: outcome

      associate (march => run%march)
         outcome%rest_tolerance = run%settings%rest_tolerance
         if (march%free_acceleration > 0.0_wp) then
            outcome%acceleration_ratio = run%step%acceleration/march%free_acceleration
            outcome%elastic_time = sqrt(2.0_wp*march%elastic_motion/march%free_acceleration)
         end if
         outcome%has_path = has_path(march%clock)
         outcome%path_time = march%clock%now
         outcome%jumps = march%jumps
         outcome%largest_jump = march%largest_jump
         outcome%has_residual = in_time(run)
         outcome%residual = march%residual
         outcome%rough = march%rough
         outcome%reduced = march%reduced
         outcome%steps = march%steps
         outcome%passes = march%passes
         outcome%factorisations = run%equations%factorisations
      end associate
      if (allocated(error)) then
         outcome%verdict = verdict%undecided
         outcome%reason = error%message
      else if (run%settings%dynamic) then
         call conclude_in_time(run, outcome)
      else if (outcome%verdict /= verdict%stable .and. run%march%drowned) then
         ! rounding may throw a block, but it does not balance one
         outcome%verdict = verdict%undecided
         outcome%reason = "round-off of coordinates loads a small block with more than its " &
            & //"weight; compute it apart from larger ones"
      else if (outcome%verdict == verdict%undecided) then
         outcome%reason = "step limit of analysis%steps reached; neither "// &
            & "equilibrium nor collapse established"
      end if
   end subroutine conclude

   !> Outcome at the end of a dynamic run
   pure subroutine conclude_in_time(run, outcome)
      type(run_t), intent(in) :: run
      type(outcome_t), intent(inout) :: outcome

      if (outcome%verdict == verdict%collapsed) return
      if (still_moves_away(run%settings, run%march)) then
         outcome%verdict = verdict%undecided
         outcome%reason = "the blocks still move away at the end of the run; give a longer duration"
      else if (run%march%time >= run%settings%duration) then
         outcome%verdict = verdict%completed
      else
         outcome%verdict = verdict%undecided
         outcome%reason = "step limit of analysis%steps reached before the end of the run"
      end if
   end subroutine conclude_in_time

end module dda_run_end
