!> Forward analysis: a run of steps to a verdict (Shi: df)
module dda_forward
   use dda_assembly, only : new_equations
   use dda_block_factor, only : factored_condition
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : raise_springs
   use dda_contacts, only : contacts_t
   use dda_energy, only : keep_energy
   use dda_error, only : error_t
   use dda_frames, only : album_t, keep_pictures
   use dda_kinds, only : wp
   use dda_reactions, only : keep_reactions
   use dda_settings, only : settings_t
   use dda_step, only : advance, begin_step
   use dda_step_context, only : march_t, step_context_t
   use dda_step_interval, only : measure_scales, next_interval
   use dda_step_state, only : equations_t
   use dda_verdict, only : has_collapsed, has_fallen, judge_verdict, largest_displacement, &
      & neighbours_of, outcome_t, verdict
   implicit none
   private

   public :: run_to_verdict

   !> The run at a rest
   type :: rest_t
      !> The blocks
      type(block_system_t) :: system
      !> The contacts
      type(contacts_t) :: contacts
      !> The march
      type(march_t) :: march
      !> Forces of the springs at held points: (n_spring) [N/m]
      real(wp), allocatable :: held_force(:)
      !> Pictures kept so far
      integer :: n_frame = 0
      !> Steps so far of which the measured points are kept
      integer :: n_track = 0
      !> Displacement or time at which the next picture is due [m or s]
      real(wp) :: due = 0.0_wp
   end type rest_t

   interface

      !> Whether the blocks have moved in a stride by more than the stride before lets expect
      pure logical module function leaps(settings, march)
         type(settings_t), intent(in) :: settings
         type(march_t), intent(in) :: march
      end function leaps

      !> Go on from a rest: keep it, and let the clock stride as far as the motion of the last
      !> stride lets expect
      pure module subroutine leave_rest(settings, system, contacts, equations, march, rest, album)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(equations_t), intent(in) :: equations
         type(march_t), intent(inout) :: march
         type(rest_t), allocatable, intent(inout) :: rest
         !> Pictures of the run
         type(album_t), intent(in), optional :: album
      end subroutine leave_rest

      !> Go back to the last rest, from where the blocks do not come to rest, or have moved too far,
      !> for a shorter stride of the clock
      pure module subroutine return_to_rest(settings, rest, falls, system, contacts, equations, &
         & march, &
         & returned, album)
         type(settings_t), intent(in) :: settings
         type(rest_t), intent(in) :: rest
         !> Whether they do not come to rest
         logical, intent(in) :: falls
         type(block_system_t), intent(inout) :: system
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         !> The march; its counts are kept
         type(march_t), intent(inout) :: march
         !> Whether there is a shorter stride; otherwise nothing is changed
         logical, intent(out) :: returned
         type(album_t), intent(inout), optional :: album
      end subroutine return_to_rest

      !> Let the clock of a static run go on where the blocks are at rest before the end of its
      !> path, and back where they do not come to rest, or leap
      pure module subroutine follow_path(settings, system, contacts, equations, march, step, &
         & rest, answer, &
         & error, album)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(inout) :: system
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         type(march_t), intent(inout) :: march
         type(step_context_t), intent(in) :: step
         type(rest_t), allocatable, intent(inout) :: rest
         !> One of verdict; becomes undecided where the run goes on
         integer, intent(inout) :: answer
         type(error_t), allocatable, intent(inout) :: error
         type(album_t), intent(inout), optional :: album
      end subroutine follow_path

      !> Follow a collapse beyond its verdict as far as the album wants to see it, and keep a
      !> picture of the end
      pure module subroutine end_pictures(settings, system, contacts, equations, march, step, &
         & outcome, album)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(inout) :: system
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         type(march_t), intent(inout) :: march
         type(step_context_t), intent(inout) :: step
         !> How the run ended; receives the contacts of a collapse that is followed
         type(outcome_t), intent(inout) :: outcome
         type(album_t), intent(inout) :: album
      end subroutine end_pictures

      !> What the end of a run says
      pure module subroutine conclude(settings, march, acceleration, error, outcome)
         type(settings_t), intent(in) :: settings
         type(march_t), intent(in) :: march
         !> That of the last step [m/s2]
         real(wp), intent(in) :: acceleration
         type(error_t), allocatable, intent(in) :: error
         !> How it ended; receives what the march counts, the verdict, and why it is undecided
         type(outcome_t), intent(inout) :: outcome
      end subroutine conclude

      !> Scales and first step of a run that begins, and its energy
      pure module subroutine begin_run(settings, system, contacts, equations, march, step, error)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         !> The contacts; faces to begin with are set
         type(contacts_t), intent(inout) :: contacts
         type(equations_t), intent(inout) :: equations
         type(march_t), intent(inout) :: march
         type(step_context_t), intent(inout) :: step
         !> Allocated if the system cannot be solved
         type(error_t), allocatable, intent(out) :: error
      end subroutine begin_run

   end interface

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
      type(equations_t) :: equations
      type(step_context_t) :: step
      type(march_t) :: march
      type(error_t), allocatable :: error
      type(rest_t), allocatable :: rest
      integer, allocatable :: neighbours(:, :)

      if (maxval(system%equation) == 0) then
         ! nothing can move
         outcome%verdict = merge(verdict%completed, verdict%stable, settings%dynamic)
         allocate (outcome%motion(settings%n_dof, 0))
         return
      end if
      allocate (neighbours, source=neighbours_of(contacts%joint))
      call raise_springs(settings, system, contacts)
      call new_equations(system, contacts%springs, settings, equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      if (present(onward)) call go_on(settings, system, onward, march, equations)
      if (march%steps == 0) &
         & call begin_run(settings, system, contacts, equations, march, step, error)
      if (present(album)) call keep_pictures(settings, system, contacts, march, 0.0_wp, .false., &
         & album)
      do while (.not. allocated(error))
         if (march%steps - march%begun >= settings%max_steps) exit
         if (settings%duration > 0.0_wp .and. march%time >= settings%duration) exit
         call take_step(settings, system, contacts, equations, march, step, rest, neighbours, &
            & outcome%verdict, error, album)
         call follow_path(settings, system, contacts, equations, march, step, rest, &
            & outcome%verdict, error, album)
         if (outcome%verdict /= verdict%undecided) exit
      end do
      march%held_force = equations%fixed%force
      if (present(onward)) onward = march
      if (settings%tells_condition) &
         & outcome%condition = factored_condition(equations%matrix, equations%factor)
      allocate (outcome%motion, source=step%state%motion)
      if (present(album)) call end_pictures(settings, system, contacts, equations, march, step, &
         & outcome, album)
      outcome%factorisations = equations%factorisations
      call conclude(settings, march, step%acceleration, error, outcome)
   end subroutine run_to_verdict

   !> One step and what it says of the blocks
   pure subroutine take_step(settings, system, contacts, equations, march, step, rest, neighbours, &
      & answer, error, album)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      !> The last rest on a path; not allocated before the first
      type(rest_t), allocatable, intent(in) :: rest
      !> The pairs of blocks that touched at the beginning: (2, n_pair)
      integer, intent(in) :: neighbours(:, :)
      !> One of verdict; undecided where the run goes on
      integer, intent(out) :: answer
      type(error_t), allocatable, intent(inout) :: error
      type(album_t), intent(inout), optional :: album
      logical :: collapsed

      answer = verdict%undecided
      call advance(settings, system, contacts, equations, march, step, error)
      if (.not. step%accepted) return
      if (march%first_motion <= 0.0_wp .and. allocated(rest)) march%first_motion = step%farthest
      if (present(album)) call keep_energy(march%energy, album%audit)
      if (settings%current .or. settings%collapse_displacement > 0.0_wp) then
         march%displacement = largest_displacement(system, settings%current)
         march%moved = march%displacement
         if (settings%current .and. allocated(rest)) &
            & march%moved = largest_displacement(system, settings%current, rest%system)
      end if
      if (settings%current .and. .not. settings%dynamic) &
         & march%has_fallen = has_fallen(system, neighbours, settings%boundary%held)
      if (step%whole .and. .not. settings%dynamic) answer = judge_verdict(march, step, settings)
      call has_collapsed(settings, system, march, collapsed)
      if (collapsed) answer = verdict%collapsed
      if (present(album)) then
         call keep_reactions(settings, system, contacts, equations, step, album)
         call keep_pictures(settings, system, contacts, march, step%farthest, .false., album)
      end if
      if (answer == verdict%undecided) call next_interval(settings, system, step, march)
   end subroutine take_step

   !> Take over the march of a run that goes on, and the forces at its held points; points that are
   !> held otherwise than before begin without force. Scales are those of the run as it is now
   pure subroutine go_on(settings, system, onward, march, equations)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(march_t), intent(in) :: onward
      type(march_t), intent(out) :: march
      type(equations_t), intent(inout) :: equations

      march = onward
      if (march%steps > 0) call measure_scales(system, settings, equations, march)
      if (march%steps > 0) march%dt = min(march%dt, march%longest)
      if (.not. allocated(march%held_force)) return
      if (size(march%held_force) == size(equations%fixed%force)) &
         & equations%fixed%force = march%held_force
   end subroutine go_on
end module dda_forward
