!> Forward analysis: a run of steps to a verdict (Shi: df)
module dda_forward
   use dda_assembly, only : new_equations
   use dda_balance, only : is_drowned
   use dda_block_factor, only : factored_condition
   use dda_block_system, only : begin_motion, block_system_t, move_system
   use dda_contacts, only : begin_forces, contacts_t, move_contacts, raise_springs
   use dda_energy, only : audit_step, keep_energy
   use dda_error, only : error_t
   use dda_frames, only : album_t, keep_pictures
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path
   use dda_outline, only : outline_of
   use dda_path_run, only : follow_clock
   use dda_reactions, only : keep_reactions
   use dda_settings, only : settings_t, verdict
   use dda_step, only : advance
   use dda_step_context, only : in_time, march_t, run_t
   use dda_step_interval, only : first_interval, measure_scales, next_interval
   use dda_step_motion, only : begin_step
   use dda_verdict, only : has_collapsed, has_fallen, is_full, judge_verdict, &
      & largest_displacement, outcome_t, points_to_rest, still_moves_away
   implicit none
   private

   public :: run_to_verdict

contains

   !> Run a static analysis to its verdict, a dynamic one to its end
   pure subroutine run_to_verdict(settings, system, contacts, outcome, album, onward)
      type(settings_t), intent(in) :: settings
      !> The blocks: at the beginning in, at the end out
      type(block_system_t), intent(inout) :: system
      !> The contacts: at the beginning in, at the end out
      type(contacts_t), intent(inout) :: contacts
      type(outcome_t), intent(out) :: outcome
      !> Receives pictures of the run where blocks move
      type(album_t), intent(inout), optional :: album
      !> The march of a run that goes on in, without steps for one that begins; where it ended out
      type(march_t), intent(inout), optional :: onward
      type(run_t) :: run
      type(error_t), allocatable :: error

      call begin_motion(system)
      call begin_forces(contacts)
      if (contacts%searched .and. .not. allocated(contacts%search%outline%next)) &
         & contacts%search%outline = outline_of(system)
      if (maxval(system%equation) == 0) then
         ! nothing can move
         outcome%verdict = merge(verdict%completed, verdict%stable, settings%dynamic)
         allocate (outcome%motion(settings%n_dof, 0))
         if (present(onward)) onward%time = max(onward%time, settings%duration)
         return
      end if
      run%settings = settings
      call move_system(system, run%system)
      call move_contacts(contacts, run%contacts)
      call start_run(run, error, onward)
      if (present(album)) call keep_pictures(run, .false., album)
      do while (.not. (allocated(error) .or. is_over(run)))
         call take_step(run, outcome%verdict, error, album)
         call follow_clock(run, outcome%verdict, error, album)
         if (outcome%verdict /= verdict%undecided) exit
      end do
      run%march%held_force = run%equations%fixed%force
      if (present(onward)) onward = run%march
      if (settings%tells_condition) &
         & outcome%condition = factored_condition(run%equations%matrix, run%equations%factor)
      outcome%motion = run%step%state%motion
      if (present(album)) call end_pictures(run, outcome, album)
      if (outcome%verdict == verdict%collapsed .and. allocated(run%onset)) then
         call move_alloc(run%onset, outcome%fallen)
         call move_alloc(run%onset_motion, outcome%motion)
      end if
      call conclude(run, error, outcome)
      call move_system(run%system, system)
      call move_contacts(run%contacts, contacts)
   end subroutine run_to_verdict

   !> True if no steps remain, or no time of a dynamic run
   pure logical function is_over(run)
      type(run_t), intent(in) :: run

      associate (march => run%march, settings => run%settings)
         is_over = march%steps - march%begun >= settings%max_steps .or. settings%duration > 0.0_wp &
            & .and. march%time >= settings%duration
      end associate
   end function is_over

   !> One step and its verdict
   pure subroutine take_step(run, answer, error, album)
      type(run_t), intent(inout) :: run
      integer, intent(out) :: answer  !! One of verdict; undecided where the run goes on
      type(error_t), allocatable, intent(inout) :: error
      type(album_t), intent(inout), optional :: album
      logical :: collapsed

      answer = verdict%undecided
      call advance(run, error)
      if (.not. run%step%accepted) return
      call measure_way(run)
      if (run%step%whole .and. .not. run%settings%dynamic) &
         & answer = judge_verdict(run%march, run%step, run%settings)
      call has_collapsed(run, collapsed)
      if (collapsed) answer = verdict%collapsed
      if (present(album)) then
         call keep_energy(run%march%energy, album%audit)
         call keep_reactions(run, album)
         call keep_pictures(run, .false., album)
      end if
      if (answer == verdict%undecided) call next_interval(run)
   end subroutine take_step

   !> Displacement of the blocks since the beginning and since the last rest, and whether one has
   !> fallen
   pure subroutine measure_way(run)
      type(run_t), intent(inout) :: run

      associate (march => run%march, settings => run%settings, on_path => allocated(run%rest))
         if (on_path .and. march%first_motion <= 0.0_wp) march%first_motion = run%step%farthest
         if (settings%current .or. settings%collapse_displacement > 0.0_wp) then
            march%displacement = largest_displacement(run%system, settings%current)
            march%moved = march%displacement
            if (settings%current .and. on_path) march%moved &
               & = largest_displacement(run%system, settings%current, run%rest%state%system)
         end if
         if (.not. settings%current .or. settings%dynamic) return
         march%has_fallen = has_fallen(run%system, run%neighbours, settings%boundary%held)
         if (points_to_rest(run%step)) &
            & march%expected_rest = max(march%expected_rest, march%moved + run%step%way_to_rest)
         if (on_path .and. .not. allocated(run%onset) .and. is_full(march, run%step)) then
            allocate (run%onset, source=run%contacts)
            run%onset_motion = run%step%state%motion
         end if
      end associate
   end subroutine measure_way

   !> Follow a collapse beyond its verdict up to a given displacement, and keep a picture of
   !> the end
   pure subroutine end_pictures(run, outcome, album)
      type(run_t), intent(inout) :: run
      !> Outcome of the run; receives the contacts of a collapse that is followed
      type(outcome_t), intent(inout) :: outcome
      type(album_t), intent(inout) :: album
      type(error_t), allocatable :: error

      if (outcome%verdict == verdict%collapsed .and. run%march%displacement < album%follow) &
         & outcome%fallen = run%contacts
      do while (allocated(outcome%fallen) .and. run%march%displacement < album%follow)
         if (run%march%steps == run%settings%max_steps) exit
         call next_interval(run)
         call advance(run, error)
         if (allocated(error)) exit
         run%march%displacement = largest_displacement(run%system, run%settings%current)
         call keep_pictures(run, .false., album)
      end do
      call keep_pictures(run, .true., album)
   end subroutine end_pictures

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
      call new_equations(run%system, run%settings, run%equations)
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
end module dda_forward
