!> Whether a structure is stable under Coulomb friction: the decision that searches are made of
!>
!> How it is decided stands in submodules: who asks needs no more than what is asked and answered.
module dda_decision
   use dda_block_system, only : block_system_t
   use dda_contacts, only : contacts_t
   use dda_coulomb_law, only : coulomb_state_t
   use dda_frames, only : album_t
   use dda_joint_graph, only : joint_graph_t
   use dda_load_stations, only : load_stations_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, scene_t
   use dda_scene_graph, only : graph_verdict_t
   use dda_search, only : decision_t
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: decide, record_rest, record_collapse, decide_by_steps, follow_coulomb
   public :: follow_from_rest, rest_under_dead_loads, fall_at_once, decide_in_stages

   interface

      !> Decide a static structure, or run a dynamic one
      pure module subroutine decide(settings, system, contacts, decision, album, onward, &
         & verdict_only)
         type(settings_t), intent(in) :: settings
         !> The blocks at the beginning
         type(block_system_t), intent(in) :: system
         !> The contacts at the beginning
         type(contacts_t), intent(in) :: contacts
         type(decision_t), intent(out) :: decision
         !> Receives pictures of the run that decides
         type(album_t), intent(inout), optional :: album
         !> Where a dynamic run goes on and where it ended
         type(march_t), intent(inout), optional :: onward
         !> Whether forces and motions of what stands are not asked for
         logical, intent(in), optional :: verdict_only
      end subroutine decide

      !> Blocks and contacts of what stands, as its proof has them
      pure module subroutine record_rest(settings, system, contacts, proof, decision)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(graph_verdict_t), intent(in) :: proof
         !> Receives them; what its outcome counts is kept
         type(decision_t), intent(inout) :: decision
      end subroutine record_rest

      !> Blocks and contacts of what falls. Limit analysis proves that it does by any mechanism that
      !> will do; where it does not know the first one a run tells it
      pure module subroutine record_collapse(settings, system, contacts, proof, decision, album)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(graph_verdict_t), intent(in) :: proof  !! That it falls
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
      end subroutine record_collapse

      !> Decide by steps to rest or collapse
      pure module subroutine decide_by_steps(settings, system, contacts, decision, album)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(decision_t), intent(out) :: decision
         type(album_t), intent(inout), optional :: album
      end subroutine decide_by_steps

      !> Run in time from the beginning, or from where a run has ended. Where it is to begin in
      !> balance a static run leads there, under what acts at time 0 on a ground at rest; velocities
      !> are those that the blocks were given
      pure module subroutine run_in_time(settings, system, contacts, decision, album, onward)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         !> The decision; the counts of the run are added to those that it has
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
         type(march_t), intent(inout), optional :: onward
      end subroutine run_in_time

      !> Run a structure under Coulomb friction from its beginning
      pure module subroutine follow_coulomb(settings, system, contacts, decision, album, onward)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         type(decision_t), intent(inout) :: decision
         type(album_t), intent(inout), optional :: album
         type(march_t), intent(inout), optional :: onward
      end subroutine follow_coulomb

      !> Follow the path from its dead loads; where it finds no state under them though forces
      !> balance them, from the rest that blocks come to
      pure module subroutine follow_from_rest(family, value, settings, stations, is_balanced, &
         & scene, graph, proof)
         !> The family of the scene, of which it is made anew behind a path: its contacts leave room
         class(family_t), intent(in) :: family
         real(wp), intent(in) :: value                  !! Its parameter
         type(settings_t), intent(in) :: settings
         type(load_stations_t), intent(in) :: stations
         logical, intent(in) :: is_balanced             !! Whether forces balance the dead loads
         type(scene_t), intent(inout) :: scene
         type(joint_graph_t), intent(inout) :: graph    !! Its joints, made anew, too
         type(graph_verdict_t), intent(inout) :: proof  !! How the path went
      end subroutine follow_from_rest

      !> Run the blocks under their dead loads alone
      pure module subroutine rest_under_dead_loads(settings, system, contacts, start, slides, n)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         type(contacts_t), intent(in) :: contacts
         !> Where nothing slides, with the load that its forces balance
         type(coulomb_state_t), allocatable, intent(out) :: start
         logical, intent(out) :: slides  !! Whether there is a rest and joints slide in it
         integer, intent(out) :: n       !! Factorisations
      end subroutine rest_under_dead_loads

      !> A path whose fall, before it has begun, counts
      pure module subroutine fall_at_once(proof)
         type(graph_verdict_t), intent(inout) :: proof  !! The path, with the mechanism of its fall
      end subroutine fall_at_once

      !> Decide a scene stage by stage, or at once where nothing is built or taken away: the first
      !> stage that falls is the last
      pure module subroutine decide_in_stages(scene, decision, album, onward, system, contacts)
         !> The scene; blocks and contacts become those of the last stage, where they were at the
         !> beginning
         type(scene_t), intent(inout) :: scene
         !> The decision of the last stage; its counts are those of all
         type(decision_t), intent(out) :: decision
         type(album_t), intent(inout) :: album
         !> Where a dynamic run goes on and where it ended
         type(march_t), intent(inout) :: onward
         !> Blocks and contacts where an earlier run has left them; without them they are the
         !> scene's
         type(block_system_t), intent(in), optional :: system
         type(contacts_t), intent(in), optional :: contacts
      end subroutine decide_in_stages

   end interface

end module dda_decision
