!> Rest under the dead loads without a loading path
!>
!> Forces that balance the dead loads may exist and yet be out of reach for joints that are loaded
!> from nothing: blocks that nothing presses fall between their neighbours, and where friction is
!> high the way to rest turns back. Elastic blocks that move in steps under the associated rule come
!> to rest: if nothing slides in that rest it is one under Coulomb friction, too; if joints slide
!> they hold only because sliding opens them, and the fall of the path counts. Joints do not
!> crush in the steps: where they do on the path its fall counts, too.
module dda_dead_rest
   use dda_contacts, only : contacts_t
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, new_coulomb_joints
   use dda_coulomb_law, only : coulomb_state_t, face, shear_face, unloaded_state
   use dda_error, only : error_t
   use dda_forward, only : run_to_verdict
   use dda_graph_decision, only : no_start
   use dda_joint_graph, only : add_joint_forces, joint_graph_t
   use dda_kinds, only : wp
   use dda_load_stations, only : history_times, leads_at_once, load_stations_t
   use dda_path_event, only : path_end
   use dda_path_verdict, only : follow_stations
   use dda_scene, only : family_t, scene_t
   use dda_scene_graph, only : graph_verdict_t, scene_graph
   use dda_settings, only : flow_rule, settings_t, verdict
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: fall_at_once, follow_from_rest, rest_under_dead_loads

contains

   !> Follow the path from its dead loads; where it finds no state under them though forces balance
   !> them, from the rest that blocks come to
   pure subroutine follow_from_rest(family, value, settings, stations, is_balanced, scene, graph, &
      & proof)
      !> Family of the scene. The scene is rebuilt behind a path: until then its contacts leave
      !> memory free
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value                  !! Its parameter
      type(settings_t), intent(in) :: settings
      type(load_stations_t), intent(in) :: stations
      logical, intent(in) :: is_balanced             !! True if forces balance the dead loads
      type(scene_t), intent(inout) :: scene
      type(joint_graph_t), intent(inout) :: graph    !! Its joints, rebuilt likewise
      type(graph_verdict_t), intent(inout) :: proof  !! Result of the path
      type(coulomb_state_t), allocatable :: start
      type(error_t), allocatable :: error
      integer :: n
      logical :: slides

      deallocate (scene%contacts%joint)
      call follow_stations(settings, scene%system, graph, stations, proof)
      call family%build(value, scene, error)
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      if (.not. (proof%no_start .and. is_balanced)) return
      call rest_under_dead_loads(scene, start, slides, n)
      if (allocated(start)) then
         call follow_stations(settings, scene%system, graph, stations, proof, start)
         call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      else
         proof%end = path_end%undecided
         proof%reason = no_start
         if (slides) call fall_at_once(proof)
      end if
      proof%n_factorisation = proof%n_factorisation + n
   end subroutine follow_from_rest

   !> Run the blocks under their dead loads alone
   pure subroutine rest_under_dead_loads(scene, start, slides, n)
      type(scene_t), intent(in) :: scene
      !> Where nothing slides, with the load that its forces balance
      type(coulomb_state_t), allocatable, intent(out) :: start
      logical, intent(out) :: slides  !! True if joints slide in the rest, or crush
      integer, intent(out) :: n       !! Factorisations
      ! a rest takes about four steps
      integer, parameter :: most_steps = 20
      type(scene_t) :: dead
      type(joint_graph_t) :: graph
      type(outcome_t) :: outcome

      n = 0
      slides = any(scene%contacts%law%strength < huge(1.0_wp))
      if (slides) return
      if (size(history_times(scene%settings)) > 0 .or. leads_at_once(scene%settings)) return
      dead = scene
      associate (settings => dead%settings)
         settings%tilt = 0.0_wp
         settings%push = 0.0_wp
         settings%load_factor = 0.0_wp
         settings%max_steps = min(settings%max_steps, most_steps)
         settings%flow = flow_rule%associated
         call run_to_verdict(settings, dead%system, dead%contacts, outcome)
         n = outcome%factorisations
         if (outcome%verdict /= verdict%stable) return
         slides = any(dead%contacts%face%slip /= 0)
         if (slides) return
         call scene_graph(settings, scene%system, scene%contacts, graph)
      end associate
      ! contacts do not include the forces of bars and fill
      if (size(graph%kind) == size(scene%contacts%joint)) &
         & call take_state(graph, dead%contacts, start)
   end subroutine rest_under_dead_loads

   !> A path whose fall, before it has begun, counts
   pure subroutine fall_at_once(proof)
      type(graph_verdict_t), intent(inout) :: proof  !! The path, with the mechanism of its fall

      if (.not. allocated(proof%mechanism)) return
      proof%end = path_end%collapsed
      if (allocated(proof%reason)) deallocate (proof%reason)
   end subroutine fall_at_once

   !> The state of joints at rest
   pure subroutine take_state(graph, contacts, state)
      type(joint_graph_t), intent(in) :: graph
      type(contacts_t), intent(in) :: contacts  !! The contacts after the run
      type(coulomb_state_t), allocatable, intent(out) :: state
      type(coulomb_joints_t) :: joints
      real(wp) :: load(3, graph%n_block)
      integer :: j

      load = 1.0_wp
      call new_coulomb_joints(graph, load, joints)
      state = unloaded_state(joints)
      do j = 1, size(graph%kind)
         associate (open => contacts%face(j)%open .or. joints%end_role(:, j) == end_role%absent)
            state%face(:2, j) = merge(face%open, face%closed, open)
            state%face(3, j) = shear_face(joints, j, state%face(:2, j), face%stuck)
            state%force(:, j) = contacts%force(:, j)
            where (open) state%force(:2, j) = 0.0_wp
            state%gap(:, j) = merge(max(contacts%gap(:2, j), 0.0_wp), 0.0_wp, &
               & open .and. joints%end_role(:, j) /= end_role%absent)
         end associate
      end do
      state%load = 0.0_wp
      call add_joint_forces(graph, state%force, state%load)
      state%load = -state%load
   end subroutine take_state
end module dda_dead_rest
