!> Stability of a structure under Coulomb friction: the decision of searches
!>
!> The convex problem, in which sliding opens the joint, comes first: its collapses are collapses
!> under every flow rule. Structures that stand there without sliding stand. Others are run again
!> under Coulomb friction. In reference geometry, where friction alone holds the blocks, the verdict
!> is that of the joint graph, with a proof, and steps only distribute the forces.
module dda_decision
   use dda_block_system, only : block_system_t
   use dda_contacts, only : contacts_t
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : load_decision_t
   use dda_scene, only : scene_t
   use dda_scene_graph, only : graph_verdict_t
   use dda_search, only : decision_t
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: decide, decide_by_steps, decide_in_stages, enter_stage, record_collapse, record_rest
   public :: run_in_time, run_under

   interface

      !> Decide a scene stage by stage, or at once where no block is built or removed
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

      !> Set the blocks and contacts that exist from a time on
      pure module subroutine enter_stage(settings, time, system, contacts)
         type(settings_t), intent(in) :: settings
         real(wp), intent(in) :: time  !! The time [s]
         type(block_system_t), intent(inout) :: system
         !> Their contacts, those of the stage before or of all blocks
         type(contacts_t), intent(inout) :: contacts
      end subroutine enter_stage

      !> Blocks and contacts of a collapse. Limit analysis proves it by any mechanism; where that is
      !> not the first motion, steps find it
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

      !> Decide a static structure, or run a dynamic one
      pure module subroutine decide(scene, decision, album, onward, verdict_only, stands)
         type(scene_t), intent(in) :: scene  !! The scene at its beginning
         type(decision_t), intent(out) :: decision
         !> Receives pictures of the run that decides
         type(album_t), intent(inout), optional :: album
         !> Where a dynamic run goes on and where it ended
         type(march_t), intent(inout), optional :: onward
         !> True if forces and motions of what stands are not asked for
         logical, intent(in), optional :: verdict_only
         !> Proof that a static structure stands, without sliding on its way: then only the elastic
         !> sharing of its forces is left to find
         type(load_decision_t), intent(in), optional :: stands
      end subroutine decide

      !> Decide by steps to rest or collapse
      pure module subroutine decide_by_steps(scene, decision, album)
         type(scene_t), intent(in) :: scene
         type(decision_t), intent(out) :: decision
         type(album_t), intent(inout), optional :: album
      end subroutine decide_by_steps

      !> Run a dynamic analysis from the beginning, or from the end of an earlier run. Where it
      !> begins in equilibrium, a static run comes first, under the loads of time 0 on a ground at
      !> rest; velocities are the given ones
      pure module subroutine run_in_time(scene, decision, album, onward)
         type(scene_t), intent(in) :: scene
         !> The decision; the counts of the run are added to those that it has
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
         type(march_t), intent(inout), optional :: onward
      end subroutine run_in_time

      !> Run a structure under a flow rule to its verdict
      pure module subroutine run_under(flow, settings, system, contacts, decision, album, onward)
         integer, intent(in) :: flow  !! One of flow_rule
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
         type(march_t), intent(inout), optional :: onward
      end subroutine run_under

   end interface

end module dda_decision
