!> Whether a structure is stable under Coulomb friction: the decision that searches are made of
!>
!> The convex problem, in which sliding opens the joint, comes first: what falls there falls under
!> every flow rule. What stands there without sliding stands. What slides before it comes to rest is
!> run again under Coulomb friction. Where blocks keep their places and friction alone holds them,
!> the verdict is that of the joint graph, with a proof, and the run only tells how the forces are
!> shared out.
submodule (dda_decision) dda_decide
   use dda_block_system, only : begin_motion
   use dda_boundary, only : held_at_start
   use dda_contacts, only : begin_forces
   use dda_coulomb_law, only : face
   use dda_forward, only : run_to_verdict
   use dda_frames, only : blank_album, keep_pictures
   use dda_graph_decision, only : decide_graph
   use dda_graph_report, only : show_mechanism, show_state
   use dda_material, only : weakens
   use dda_path_event, only : path_end
   use dda_scene_graph, only : decides_as_graph
   use dda_settings, only : flow_rule
   use dda_step_context, only : run_t
   use dda_verdict, only : outcome_t, verdict
   implicit none

   !> Steps that the static beginning of a dynamic run may take, at the least
   integer, parameter :: least_static_steps = 400
   !> A joint slides against friction if its force is more than this share of the largest
   real(wp), parameter :: felt = 1.0e-9_wp

contains

   !> Decide a static structure, or run a dynamic one
   module procedure decide
      logical :: bare

      bare = .false.
      if (present(verdict_only)) bare = verdict_only
      if (settings%dynamic) then
         call run_in_time(settings, system, contacts, decision, album, onward)
      else if (decides_as_graph(settings, contacts)) then
         call decide_by_graph(settings, system, contacts, bare, decision, album)
      else
         call decide_by_steps(settings, system, contacts, decision, album)
      end if
   end procedure decide

   !> Decide by the joint graph
   pure subroutine decide_by_graph(settings, system, contacts, bare, decision, album)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      logical, intent(in) :: bare  !! Whether forces and motions of what stands are not asked for
      type(decision_t), intent(out) :: decision
      type(album_t), intent(inout), optional :: album
      type(graph_verdict_t) :: proof
      type(coulomb_state_t), allocatable :: start
      integer :: n
      logical :: slides

      call decide_graph(settings, system, contacts, bare, proof)
      if (proof%no_start) then
         call rest_under_dead_loads(settings, system, contacts, start, slides, n)
         if (allocated(start) .and. .not. proof%unproven) &
            & call decide_graph(settings, system, contacts, bare, proof, start)
         if (slides) call fall_at_once(proof)
         proof%n_factorisation = proof%n_factorisation + n
      end if
      if (proof%end == path_end%collapsed) then
         call record_collapse(settings, system, contacts, proof, decision, album)
      else if (proof%end == path_end%reached .and. (bare .or. proof%on_path &
         & .or. has_slid(proof) .or. .not. may_run(settings, contacts))) then
         call record_rest(settings, system, contacts, proof, decision)
      else if (proof%end == path_end%reached) then
         call share_forces(settings, system, contacts, proof, decision, album)
      else if (proof%unproven .and. may_run(settings, contacts)) then
         call decide_by_steps(settings, system, contacts, decision, album)
      else
         decision%system = system
         decision%contacts = contacts
         call begin_forces(decision%contacts)
         decision%outcome%reason = proof%reason
      end if
      call begin_motion(decision%system)
      call move_alloc(proof%limit, decision%limit)
      associate (outcome => decision%outcome)
         outcome%steps = outcome%steps + proof%n_event + 1
         outcome%jumps = outcome%jumps + proof%n_jump
         outcome%largest_jump = max(outcome%largest_jump, proof%largest_jump)
         outcome%factorisations = outcome%factorisations + proof%n_factorisation
         if (.not. allocated(outcome%motion)) &
            & allocate (outcome%motion(settings%n_dof, maxval(system%equation)), source=0.0_wp)
      end associate
   end subroutine decide_by_graph

   !> Whether joints slide in the state that Coulomb's law has led to, or have strength, of which
   !> the path alone knows what is lost: no elastic sharing without slip is looked for then
   pure logical function has_slid(proof)
      type(graph_verdict_t), intent(in) :: proof

      has_slid = .false.
      if (.not. allocated(proof%state)) return
      has_slid = allocated(proof%state%whole)
      if (has_slid) return
      associate (force => proof%state%force)
         ! where two corners touch without force nothing resists
         has_slid = any(abs(proof%state%face(3, :)) == face%slides &
            & .and. sum(force(1:2, :), dim=1) > felt*maxval(abs(force)))
      end associate
   end function has_slid

   !> Whether a run of steps can tell what the graph does not: steps know neither bounded forces nor
   !> strength
   pure logical function may_run(settings, contacts)
      type(settings_t), intent(in) :: settings
      type(contacts_t), intent(in) :: contacts

      may_run = .not. (allocated(settings%boundary%bounded) &
         & .or. any(contacts%law(contacts%joint%law)%strength < huge(1.0_wp)))
   end function may_run

   !> How the blocks of what stands share out the forces: as elastic blocks do, or where joints
   !> slide, as the loading path leaves them
   pure subroutine share_forces(settings, system, contacts, proof, decision, album)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(graph_verdict_t), intent(in) :: proof
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout), optional :: album
      logical :: shared

      call share_elastically(settings, system, contacts, decision, shared, album)
      decision%outcome%verdict = verdict%stable
      if (allocated(decision%outcome%reason)) deallocate (decision%outcome%reason)
      if (shared) return
      call record_rest(settings, system, contacts, proof, decision)
      if (present(album)) call show_end(settings, decision, album)
   end subroutine share_forces

   !> Share out the forces of what stands as elastic blocks do
   pure subroutine share_elastically(settings, system, contacts, decision, shared, album)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(decision_t), intent(inout) :: decision
      !> Whether that is how they are shared out: not where joints slide under Coulomb friction
      logical, intent(out) :: shared
      type(album_t), intent(inout), optional :: album
      type(settings_t) :: convex

      convex = settings
      convex%flow = flow_rule%associated
      decision%flow = convex%flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(convex, decision%system, decision%contacts, decision%outcome, album)
      shared = decision%outcome%verdict == verdict%stable
      if (settings%verdict_flow == flow_rule%coulomb) &
         & shared = shared .and. .not. any(decision%contacts%face%slip /= 0)
   end subroutine share_elastically

   !> Blocks and contacts of what stands, as its proof has them
   module procedure record_rest
      decision%outcome%verdict = verdict%stable
      decision%flow = proof%flow
      decision%system = system
      decision%contacts = contacts
      call show_state(settings, proof, decision%system, decision%contacts)
   end procedure record_rest

   !> Blocks and contacts of what falls
   module procedure record_collapse
      type(settings_t) :: convex

      decision%flow = proof%flow
      decision%system = system
      decision%contacts = contacts
      if (proof%flow == flow_rule%associated .and. .not. proof%is_told &
         & .and. may_run(settings, contacts)) then
         convex = settings
         convex%flow = flow_rule%associated
         call run_to_verdict(convex, decision%system, decision%contacts, decision%outcome, album)
         if (decision%outcome%verdict == verdict%collapsed) return
         decision%system = system
         decision%contacts = contacts
         if (allocated(decision%outcome%reason)) deallocate (decision%outcome%reason)
      end if
      decision%by_graph = .true.
      decision%outcome%verdict = verdict%collapsed
      if (allocated(decision%outcome%motion)) deallocate (decision%outcome%motion)
      allocate (decision%outcome%motion(settings%n_dof, maxval(system%equation)), source=0.0_wp)
      decision%outcome%motion(:3, :) = proof%mechanism(:, :maxval(system%equation))
      call show_mechanism(settings, system, proof, decision%contacts)
      if (present(album)) call show_end(settings, decision, album)
   end procedure record_collapse

   !> Where the measured points are in a state that no run has led to
   pure subroutine show_end(settings, decision, album)
      type(settings_t), intent(in) :: settings
      type(decision_t), intent(in) :: decision
      type(album_t), intent(inout) :: album
      type(run_t) :: run

      album = blank_album(album)
      run%settings = settings
      run%system = decision%system
      call begin_motion(run%system)
      run%contacts = decision%contacts
      call keep_pictures(run, .false., album)
   end subroutine show_end

   !> Decide by steps to rest or collapse
   module procedure decide_by_steps
      type(settings_t) :: convex

      if (any(weakens(contacts%law(contacts%joint%law)))) then
         ! what slides as it opens wears another way, so that its fall proves nothing
         call follow_coulomb(settings, system, contacts, decision, album)
         return
      end if
      convex = settings
      convex%flow = flow_rule%associated
      decision%flow = convex%flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(convex, decision%system, decision%contacts, decision%outcome, album)
      if (decision%outcome%verdict /= verdict%stable) return
      if (settings%verdict_flow == flow_rule%associated) return
      if (.not. any(decision%contacts%face%slip /= 0)) return
      if (present(album)) album = blank_album(album)
      call follow_coulomb(settings, system, contacts, decision, album)
   end procedure decide_by_steps

   !> Run in time from the beginning, or from where a run has ended
   module procedure run_in_time
      type(settings_t) :: static
      type(decision_t) :: settled
      type(march_t) :: rest, march
      logical :: begins

      begins = settings%settles
      if (present(onward)) begins = begins .and. onward%steps == 0
      if (.not. begins) then
         call follow_coulomb(settings, system, contacts, decision, album, onward)
         return
      end if
      static = settings
      static%dynamic = .false.
      static%time_step = 0.0_wp
      static%duration = 0.0_wp
      static%collapse_displacement = 0.0_wp
      static%max_steps = max(least_static_steps, settings%max_steps)
      static%boundary = held_at_start(settings%boundary)
      call follow_coulomb(static, system, contacts, settled, onward=rest)
      if (settled%outcome%verdict /= verdict%stable) then
         decision = settled
         if (.not. allocated(decision%outcome%reason)) decision%outcome%reason = &
            & "the blocks collapse under their loads at time 0"
         decision%outcome%reason = "start = 'static' found no rest: "//decision%outcome%reason
         decision%outcome%verdict = verdict%undecided
         return
      end if
      if (allocated(system%velocity)) settled%system%velocity = system%velocity
      decision%outcome = settled%outcome
      march%held_force = rest%held_force
      call follow_coulomb(settings, settled%system, settled%contacts, decision, album, march)
      if (present(onward)) onward = march
   end procedure run_in_time

   !> Run a structure under Coulomb friction from its beginning
   module procedure follow_coulomb
      type(settings_t) :: coulomb
      type(outcome_t) :: before

      before = decision%outcome
      coulomb = settings
      coulomb%flow = flow_rule%coulomb
      decision%flow = coulomb%flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(coulomb, decision%system, decision%contacts, decision%outcome, album, &
         & onward)
      associate (outcome => decision%outcome)
         outcome%steps = outcome%steps + before%steps
         outcome%passes = outcome%passes + before%passes
         outcome%factorisations = outcome%factorisations + before%factorisations
      end associate
   end procedure follow_coulomb

end submodule dda_decide
