!> How a run begins and ends, and what its outcome says
submodule (dda_forward) dda_run_end
   use dda_balance, only : is_drowned
   use dda_energy, only : audit_step
   use dda_load_clock, only : has_path
   use dda_step_interval, only : first_interval
   use dda_verdict, only : still_moves_away
   implicit none

contains

   !> What the end of a run says
   module procedure conclude
      outcome%rest_tolerance = settings%rest_tolerance
      if (march%free_acceleration > 0.0_wp) then
         outcome%acceleration_ratio = acceleration/march%free_acceleration
         outcome%elastic_time = sqrt(2.0_wp*march%elastic_motion/march%free_acceleration)
      end if
      outcome%has_path = has_path(march%clock)
      outcome%path_time = march%clock%now
      outcome%jumps = march%jumps
      outcome%largest_jump = march%largest_jump
      outcome%steps = march%steps
      outcome%passes = march%passes
      if (allocated(error)) then
         outcome%verdict = verdict%undecided
         outcome%reason = error%message
      else if (settings%dynamic) then
         call conclude_in_time(settings, march, outcome)
      else if (outcome%verdict /= verdict%stable .and. march%drowned) then
         ! rounding may throw a block, but it does not balance one
         outcome%verdict = verdict%undecided
         outcome%reason = "round-off of coordinates loads a small block with more than its " &
            & //"weight; compute it apart from larger ones"
      else if (outcome%verdict == verdict%undecided) then
         outcome%reason = "step limit reached; neither equilibrium nor collapse established"
      end if
   end procedure conclude

   !> What the end of a dynamic run says
   pure subroutine conclude_in_time(settings, march, outcome)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march
      type(outcome_t), intent(inout) :: outcome

      if (outcome%verdict == verdict%collapsed) return
      if (still_moves_away(settings, march)) then
         outcome%verdict = verdict%undecided
         outcome%reason = "the blocks still move away at the end of the run; give a longer duration"
      else if (march%time >= settings%duration) then
         outcome%verdict = verdict%completed
      else
         outcome%verdict = verdict%undecided
         outcome%reason = "step limit reached before the end of the run"
      end if
   end subroutine conclude_in_time

   !> Scales and first step of a run that begins, and its energy
   module procedure begin_run
      call first_interval(system, contacts%springs, settings, equations, step%state, march, error)
      contacts%face = step%state%face
      if (settings%dynamic) then
         call audit_step(settings, system, equations, contacts, step, 0.0_wp, march%energy)
      else if (settings%current .and. contacts%springs%give) then
         march%drowned = is_drowned(system, contacts%joint, contacts%springs, equations)
      end if
   end procedure begin_run

end submodule dda_run_end
