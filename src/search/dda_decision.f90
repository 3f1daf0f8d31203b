!> Whether a structure is stable under Coulomb friction: the decision that searches are made of
!>
!> The convex problem, in which sliding opens the joint, comes first: what falls there falls under
!> every flow rule. What stands there without sliding stands. What slides before it comes to rest is
!> run again under Coulomb friction. Where blocks keep their places and friction alone holds them,
!> the verdict is that of the joint graph, with a proof, and the run only tells how the forces are
!> shared out.
module dda_decision
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_at_start
   use dda_contacts, only : contacts_t
   use dda_forward, only : run_to_verdict
   use dda_frames, only : album_t, blank_album
   use dda_kinds, only : wp
   use dda_material, only : weakens
   use dda_scene, only : scene_t
   use dda_scene_graph, only : decides_as_graph, graph_verdict_t
   use dda_search, only : decision_t
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : march_t
   use dda_verdict, only : outcome_t, verdict
   implicit none
   private

   public :: decide, decide_by_steps, decide_in_stages, enter_stage, record_collapse, record_rest
   public :: run_in_time, run_under

   !> Steps that the static beginning of a dynamic run may take, at the least
   integer, parameter :: least_static_steps = 400

   interface

      !> Decide a scene stage by stage, or at once where nothing is built or taken away: the first
      !> stage that falls is the last
      pure module subroutine decide_in_stages(scene, decision, album, onward, last)
         !> The scene at its beginning, or where an earlier run has left it
         type(scene_t), intent(in) :: scene
         !> The decision of the last stage; its counts are those of all
         type(decision_t), intent(out) :: decision
         type(album_t), intent(inout) :: album
         !> Where a dynamic run goes on and where it ended
         type(march_t), intent(inout) :: onward
         real(wp), intent(out) :: last  !! Time at which the last stage began [s]
      end subroutine decide_in_stages

      !> Which blocks and contacts there are from a time on
      pure module subroutine enter_stage(settings, time, system, contacts)
         type(settings_t), intent(in) :: settings
         real(wp), intent(in) :: time  !! The time [s]
         type(block_system_t), intent(inout) :: system
         !> Their contacts, those of the stage before or of all blocks
         type(contacts_t), intent(inout) :: contacts
      end subroutine enter_stage

      !> Decide by the joint graph
      pure module subroutine decide_by_graph(scene, bare, decision, album)
         type(scene_t), intent(in) :: scene
         logical, intent(in) :: bare  !! Whether forces and motions of what stands are not asked for
         type(decision_t), intent(out) :: decision
         type(album_t), intent(inout), optional :: album
      end subroutine decide_by_graph

      !> Blocks and contacts of what falls. Limit analysis proves that it does by any mechanism that
      !> will do; where it does not know the first one a run tells it
      pure module subroutine record_collapse(scene, proof, decision, album)
         type(scene_t), intent(in) :: scene
         type(graph_verdict_t), intent(in) :: proof  !! That it falls
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
      end subroutine record_collapse

      !> Blocks and contacts of what stands, as its proof has them
      pure module subroutine record_rest(scene, proof, decision)
         type(scene_t), intent(in) :: scene
         type(graph_verdict_t), intent(in) :: proof
         !> Receives them; what its outcome counts is kept
         type(decision_t), intent(inout) :: decision
      end subroutine record_rest

   end interface

contains

   !> Decide a static structure, or run a dynamic one
   pure subroutine decide(scene, decision, album, onward, verdict_only)
      type(scene_t), intent(in) :: scene  !! The scene at its beginning
      type(decision_t), intent(out) :: decision
      !> Receives pictures of the run that decides
      type(album_t), intent(inout), optional :: album
      !> Where a dynamic run goes on and where it ended
      type(march_t), intent(inout), optional :: onward
      !> Whether forces and motions of what stands are not asked for
      logical, intent(in), optional :: verdict_only
      logical :: bare

      bare = .false.
      if (present(verdict_only)) bare = verdict_only
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
            if (decision%outcome%verdict /= verdict%stable) return
            if (settings%verdict_flow == flow_rule%associated) return
            if (.not. any(decision%contacts%face%slip /= 0)) return
            if (present(album)) album = blank_album(album)
         end if
         call run_under(flow_rule%coulomb, settings, system, contacts, decision, album)
      end associate
   end subroutine decide_by_steps

   !> Run in time from the beginning, or from where a run has ended. Where it is to begin in balance
   !> a static run leads there, under what acts at time 0 on a ground at rest; velocities are those
   !> that the blocks were given
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
      if (present(onward)) begins = begins .and. onward%steps == 0
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
         decision%outcome%reason = "start = 'static' found no rest: "//decision%outcome%reason
         decision%outcome%verdict = verdict%undecided
         return
      end if
      if (allocated(scene%system%velocity)) settled%system%velocity = scene%system%velocity
      decision%outcome = settled%outcome
      march%held_force = rest%held_force
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
end module dda_decision
