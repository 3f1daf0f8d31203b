!> Rest under the dead loads where the loading path finds no state to begin with
!>
!> Forces that balance the dead loads may exist and yet be out of reach for joints that are loaded
!> from nothing: blocks that nothing presses fall between their neighbours, and where friction is
!> high the way to rest turns back. Elastic blocks that move in steps say which of the two it is.
module dda_dead_rest
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, new_coulomb_joints
   use dda_coulomb_law, only : coulomb_state_t, face, shear_face, unloaded_state
   use dda_forward, only : outcome_t, run_to_verdict
   use dda_path_verdict, only : graph_verdict_t
   use dda_joint_graph, only : add_joint_forces, joint_graph_t
   use dda_kinds, only : wp
   use dda_load_stations, only : history_times, leads_at_once
   use dda_loading_path, only : path_end
   use dda_scene_graph, only : scene_graph
   use dda_settings, only : flow_rule, settings_t
   use dda_verdict, only : verdict
   implicit none
   private

   public :: fall_at_once, rest_under_dead_loads

contains

   !> Run the blocks under their dead loads alone, first under the associated rule: a rest in which
   !> nothing slides is one under Coulomb friction
   pure subroutine rest_under_dead_loads(settings, system, contacts, start, mechanism, n)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> Where they come to rest, with the load that its forces balance
      type(coulomb_state_t), allocatable, intent(out) :: start
      !> How they move where they fall, the largest 1: (3, n_block) [1, 1, 1/m]
      real(wp), allocatable, intent(out) :: mechanism(:, :)
      !> Factorisations
      integer, intent(out) :: n
      integer, parameter :: flow(2) = [flow_rule%associated, flow_rule%coulomb]
      ! a rest takes about four steps; blocks that creep for longer find none in hundreds
      integer, parameter :: most_steps = 20
      type(block_system_t) :: moved
      type(contacts_t) :: settled
      type(joint_graph_t) :: graph
      type(outcome_t) :: outcome
      type(settings_t) :: dead
      integer :: i

      n = 0
      if (size(history_times(settings)) > 0 .or. leads_at_once(settings)) return
      dead = settings
      dead%tilt = 0.0_wp
      dead%push = 0.0_wp
      dead%load_factor = 0.0_wp
      dead%max_steps = min(settings%max_steps, most_steps)
      call scene_graph(dead, system, contacts, graph)
      if (size(graph%kind) /= size(contacts%joint)) return
      do i = 1, size(flow)
         moved = system
         settled = contacts
         dead%flow = flow(i)
         call run_to_verdict(dead, moved, settled, outcome)
         n = n + outcome%factorisations
         if (outcome%verdict /= verdict%stable) exit
         if (dead%flow == flow_rule%associated .and. any(settled%face%slip /= 0)) cycle
         call take_state(graph, settled, start)
         return
      end do
      if (outcome%verdict /= verdict%collapsed) return
      mechanism = outcome%motion(:3, :)/maxval(abs(outcome%motion(:3, :)))
   end subroutine rest_under_dead_loads

   !> A path that ends where it begins, as the dead loads make the blocks fall
   pure subroutine fall_at_once(mechanism, proof)
      !> How the blocks move: (3, n_block)
      real(wp), intent(in) :: mechanism(:, :)
      !> The path that has found no state to begin with
      type(graph_verdict_t), intent(inout) :: proof

      proof%end = path_end%collapsed
      proof%mechanism = mechanism
      proof%flow = flow_rule%coulomb
      proof%station = 0
      proof%share = 0.0_wp
      if (allocated(proof%reason)) deallocate (proof%reason)
   end subroutine fall_at_once

   !> The state of joints at rest
   pure subroutine take_state(graph, contacts, state)
      type(joint_graph_t), intent(in) :: graph
      !> The contacts after the run
      type(contacts_t), intent(in) :: contacts
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
