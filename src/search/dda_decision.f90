!> Stability of a structure under Coulomb friction: the decision of searches
!>
!> The convex problem, in which sliding opens the joint, comes first: its collapses are collapses
!> under every flow rule. Structures that stand there without sliding stand. Others are run again
!> under Coulomb friction. In reference geometry, where friction alone holds the blocks, the verdict
!> is that of the joint graph, with a proof, and steps only distribute the forces.
module dda_decision
   use dda_block_system, only : begin_motion, block_system_t
   use dda_boundary, only : held_at_start
   use dda_contacts, only : begin_forces, contacts_t
   use dda_coulomb_law, only : coulomb_state_t, face
   use dda_dead_rest, only : fall_at_once, rest_under_dead_loads
   use dda_forward, only : run_to_verdict
   use dda_frames, only : album_t, blank_album, keep_pictures
   use dda_graph_decision, only : decide_graph
   use dda_graph_report, only : show_mechanism, show_state
   use dda_kinds, only : wp
   use dda_limit_decision, only : load_decision_t
   use dda_material, only : weakens
   use dda_path_event, only : path_end
   use dda_scene, only : scene_t
   use dda_scene_graph, only : decides_as_graph, graph_verdict_t
   use dda_search, only : decision_t
   use dda_settings, only : flow_rule, settings_t, verdict
   use dda_step_context, only : march_t, run_t
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: decide, decide_by_steps, record_collapse, record_rest, run_in_time, run_under

   !> Least maximum number of steps of a static start
   integer, parameter :: least_static_steps = 400

   !> Least force of a sliding joint over the largest
   real(wp), parameter :: felt = 1.0e-9_wp

contains

   !> Decide a static structure, or run a dynamic one
   pure subroutine decide(scene, decision, album, onward, verdict_only, stands)
      type(scene_t), intent(in) :: scene  !! The scene at its beginning
      type(decision_t), intent(out) :: decision
      type(album_t), intent(inout), optional :: album  !! Receives pictures of the run that decides
      !> Where a dynamic run goes on and where it ended
      type(march_t), intent(inout), optional :: onward
      !> True if forces and motions of what stands are not asked for
      logical, intent(in), optional :: verdict_only
      !> Proof that a static structure stands, without sliding on its way: then only the elastic
      !> sharing of its forces is left to find
      type(load_decision_t), intent(in), optional :: stands
      type(decision_t) :: blank
      logical :: bare, shared

      bare = .false.
      if (present(verdict_only)) bare = verdict_only
      if (present(stands)) then
         call share_forces(scene, decision, shared, album)
         allocate (decision%limit, source=stands)
         if (shared) return
         ! how joints slide that the elastic sharing overloads is known of the path alone
         decision = blank
         if (present(album)) album = blank_album(album)
      end if
      if (scene%settings%dynamic) then
         call run_in_time(scene, decision, album, onward)
      else if (decides_as_graph(scene%settings, scene%contacts)) then
         call decide_by_graph(scene, bare, decision, album)
      else
         call decide_by_steps(scene, decision, album)
      end if
   end subroutine decide

   !> Decide by steps to rest or collapse
   pure subroutine decide_by_steps(scene, decision, album)
      type(scene_t), intent(in) :: scene
      type(decision_t), intent(out) :: decision
      type(album_t), intent(inout), optional :: album

      associate (settings => scene%settings, system => scene%system, contacts => scene%contacts)
         ! what slides as it opens wears another way, so that its fall proves nothing
         if (.not. any(weakens(contacts%law(contacts%joint%law)))) then
            call run_under(flow_rule%associated, settings, system, contacts, decision, album)
            if (decision%outcome%verdict == verdict%collapsed) return
            if (settings%verdict_flow == flow_rule%associated) return
            if (decision%outcome%verdict == verdict%stable &
               & .and. .not. any(decision%contacts%face%slip /= 0)) return
            if (present(album)) album = blank_album(album)
         end if
         call run_under(flow_rule%coulomb, settings, system, contacts, decision, album)
      end associate
   end subroutine decide_by_steps

   !> Run a dynamic analysis from the beginning, or from the end of an earlier run. Where it
   !> begins in equilibrium, a static run comes first, under the loads of time 0 on a ground at
   !> rest; velocities are the given ones
   pure subroutine run_in_time(scene, decision, album, onward)
      type(scene_t), intent(in) :: scene
      !> The decision; the counts of the run are added to those that it has
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout), optional :: album
      type(march_t), intent(inout), optional :: onward
      type(settings_t) :: static
      type(decision_t) :: settled
      type(march_t) :: rest, march
      logical :: begins

      begins = scene%settings%settles
      if (present(onward)) &
         & begins = begins .and. onward%steps == 0 .and. .not. onward%time > 0.0_wp
      if (.not. begins) then
         call run_under(flow_rule%coulomb, scene%settings, scene%system, scene%contacts, decision, &
            & album, onward)
         return
      end if
      static = scene%settings
      static%dynamic = .false.
      static%time_step = 0.0_wp
      static%duration = 0.0_wp
      static%collapse_displacement = 0.0_wp
      static%max_steps = max(least_static_steps, static%max_steps)
      static%boundary = held_at_start(scene%settings%boundary)
      call run_under(flow_rule%coulomb, static, scene%system, scene%contacts, settled, onward=rest)
      if (settled%outcome%verdict /= verdict%stable) then
         decision = settled
         if (.not. allocated(decision%outcome%reason)) decision%outcome%reason = &
            & "the blocks collapse under their loads at time 0"
         decision%outcome%reason = "start = 'static' found no equilibrium: " &
            & //decision%outcome%reason
         decision%outcome%verdict = verdict%undecided
         return
      end if
      if (allocated(scene%system%velocity)) settled%system%velocity = scene%system%velocity
      decision%outcome = settled%outcome
      if (allocated(rest%held_force)) march%held_force = rest%held_force
      call run_under(flow_rule%coulomb, scene%settings, settled%system, settled%contacts, &
         & decision, album, march)
      if (present(onward)) onward = march
   end subroutine run_in_time

   !> Run a structure under a flow rule to its verdict
   pure subroutine run_under(flow, settings, system, contacts, decision, album, onward)
      integer, intent(in) :: flow  !! One of flow_rule
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout), optional :: album
      type(march_t), intent(inout), optional :: onward
      type(settings_t) :: ruled
      type(outcome_t) :: before

      before = decision%outcome
      ruled = settings
      ruled%flow = flow
      decision%flow = flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(ruled, decision%system, decision%contacts, decision%outcome, album, &
         & onward)
      associate (outcome => decision%outcome)
         outcome%steps = outcome%steps + before%steps
         outcome%passes = outcome%passes + before%passes
         outcome%factorisations = outcome%factorisations + before%factorisations
      end associate
   end subroutine run_under

   !> Decide by the joint graph
   pure subroutine decide_by_graph(scene, bare, decision, album)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: bare  !! True if forces and motions of what stands are not asked for
      type(decision_t), intent(out) :: decision
      type(album_t), intent(inout), optional :: album
      type(graph_verdict_t) :: proof
      type(coulomb_state_t), allocatable :: start
      integer :: n
      logical :: shared, slides

      associate (settings => scene%settings, system => scene%system, contacts => scene%contacts)
         call decide_graph(settings, system, contacts, bare, proof)
         if (proof%no_start) then
            call rest_under_dead_loads(scene, start, slides, n)
            if (allocated(start) .and. .not. proof%unproven) &
               & call decide_graph(settings, system, contacts, bare, proof, start)
            if (slides) call fall_at_once(proof)
            proof%n_factorisation = proof%n_factorisation + n
         end if
      end associate
      if (proof%end == path_end%collapsed) then
         call record_collapse(scene, proof, decision, album)
      else if (proof%end == path_end%reached .and. (bare .or. proof%on_path &
         & .or. has_slid(proof) .or. .not. may_run(scene))) then
         call record_rest(scene, proof, decision)
      else if (proof%end == path_end%reached) then
         call share_forces(scene, decision, shared, album)
         if (.not. shared) call record_rest(scene, proof, decision)
         if (present(album) .and. .not. shared) call show_end(scene%settings, decision, album)
      else if (proof%unproven .and. may_run(scene)) then
         call decide_by_steps(scene, decision, album)
      else
         decision%system = scene%system
         decision%contacts = scene%contacts
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
         if (.not. allocated(outcome%motion)) allocate (outcome%motion(scene%settings%n_dof, &
            & maxval(scene%system%equation)), source=0.0_wp)
      end associate
   end subroutine decide_by_graph

   !> True if joints slide at the end of the loading path, or have strength whose loss only the path
   !> follows: an elastic sharing without slip is not sought then
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

   !> True if steps can decide where the graph does not: steps have neither bounded forces nor
   !> strength
   pure logical function may_run(scene)
      type(scene_t), intent(in) :: scene

      may_run = .not. (allocated(scene%settings%boundary%bounded) .or. any( &
         & scene%contacts%law(scene%contacts%joint%law)%strength < huge(1.0_wp)))
   end function may_run

   !> Let the blocks of what stands share out the forces as elastic blocks do, unless joints slide
   !> in that under Coulomb friction
   pure subroutine share_forces(scene, decision, shared, album)
      type(scene_t), intent(in) :: scene
      type(decision_t), intent(inout) :: decision
      logical, intent(out) :: shared  !! True if they do
      type(album_t), intent(inout), optional :: album

      associate (outcome => decision%outcome)
         call run_under(flow_rule%associated, scene%settings, scene%system, scene%contacts, &
            & decision, album)
         shared = outcome%verdict == verdict%stable .and. &
            & .not. (scene%settings%verdict_flow == flow_rule%coulomb &
            & .and. any(decision%contacts%face%slip /= 0))
         outcome%verdict = verdict%stable
         if (allocated(outcome%reason)) deallocate (outcome%reason)
      end associate
   end subroutine share_forces

   !> Blocks and contacts of what stands, as its proof has them
   pure subroutine record_rest(scene, proof, decision)
      type(scene_t), intent(in) :: scene
      type(graph_verdict_t), intent(in) :: proof
      type(decision_t), intent(inout) :: decision  !! Receives them; what its outcome counts is kept

      decision%outcome%verdict = verdict%stable
      decision%flow = proof%flow
      decision%system = scene%system
      decision%contacts = scene%contacts
      call show_state(scene%settings, proof, decision%system, decision%contacts)
   end subroutine record_rest

   !> Blocks and contacts of a collapse. Limit analysis proves it by any mechanism; where that is
   !> not the first motion, steps find it
   pure subroutine record_collapse(scene, proof, decision, album)
      type(scene_t), intent(in) :: scene
      type(graph_verdict_t), intent(in) :: proof  !! That it falls
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout), optional :: album

      associate (outcome => decision%outcome, settings => scene%settings)
         if (proof%flow == flow_rule%associated .and. .not. proof%is_told .and. may_run(scene)) then
            call run_under(proof%flow, settings, scene%system, scene%contacts, decision, album)
            if (outcome%verdict == verdict%collapsed) return
            if (allocated(outcome%reason)) deallocate (outcome%reason)
         end if
         decision%flow = proof%flow
         decision%system = scene%system
         decision%contacts = scene%contacts
         decision%by_graph = .true.
         outcome%verdict = verdict%collapsed
         if (allocated(outcome%motion)) deallocate (outcome%motion)
         allocate (outcome%motion(settings%n_dof, maxval(scene%system%equation)), source=0.0_wp)
         outcome%motion(:3, :) = proof%mechanism(:, :maxval(scene%system%equation))
         call show_mechanism(settings, scene%system, proof, decision%contacts)
         outcome%acceleration_ratio = proof%power_share
         outcome%rest_tolerance = settings%rest_tolerance
         if (present(album)) call show_end(settings, decision, album)
      end associate
   end subroutine record_collapse

   !> Monitoring points in a state that no run has reached
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
end module dda_decision
