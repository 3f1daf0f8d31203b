!> How an assembly falls under Coulomb friction, from forces that its joints can carry
!>
!> Where no forces balance a load, limit analysis leaves forces that do so as far as any can, and a
!> mechanism whose joints open as they slide. From these forces the blocks move at the load, damped
!> by mass, with joints that slide along themselves: until nothing stops them.
module dda_coulomb_fall
   use dda_coulomb_equations, only : coulomb_equations_t, new_coulomb_equations
   use dda_coulomb_joints, only : coulomb_joints_t, in_metres, in_units, new_coulomb_joints, &
      & shear_role
   use dda_coulomb_law, only : apply_law, coulomb_state_t, unloaded_state
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_load_jump, only : far_factor, few_pivots, jump_t, jump_to_balance, motion_end
   implicit none
   private

   public :: find_coulomb_fall

   !> Forces below this share of the largest are none, joints as near to their limit are at it
   real(wp), parameter :: nothing = 1.0e-6_wp

contains

   !> Velocities of the fall, the largest one, and the forces with which it goes on
   pure subroutine find_coulomb_fall(graph, load, force, most, velocity, found, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      !> The load: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: load(:, :)
      !> Forces that the joints can carry; those of the fall where one is found: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Factorisations that it may take
      integer, intent(in) :: most
      !> Velocities: (n_dof, n_block)
      real(wp), intent(inout) :: velocity(:, :)
      !> Whether a motion without end was found; otherwise velocities and forces are left alone
      logical, intent(out) :: found
      !> Factorisations
      integer, intent(out) :: n_factorisation
      type(coulomb_joints_t) :: joints
      type(coulomb_equations_t) :: equations
      type(coulomb_state_t) :: state
      type(jump_t) :: jump
      real(wp) :: still(3, size(force, 2))
      integer :: end

      call new_coulomb_joints(graph, load, joints)
      call new_coulomb_equations(joints, equations)
      call begin_at(joints, force/joints%force_unit, state)
      still = 0.0_wp
      call apply_law(joints, state, still, state)
      jump%far = far_factor*max(1.0_wp, maxval(abs(state%force)))
      jump%tolerance = nothing
      equations%most_factorisations = most
      equations%most_pivots = few_pivots
      call jump_to_balance(joints, equations, in_units(joints, load), state, jump, end)
      n_factorisation = equations%base%n_factorisation
      found = end == motion_end%endless .or. end == motion_end%far
      if (.not. found) return
      velocity = in_metres(joints, jump%mechanism)
      velocity = velocity/max(maxval(abs(velocity(:2, :))), tiny(1.0_wp))
      force = joints%force_unit*state%force
   end subroutine find_coulomb_fall

   !> The state of joints with given forces; what is next to nothing is nothing
   pure subroutine begin_at(joints, force, state)
      type(coulomb_joints_t), intent(in) :: joints
      !> N1, N2, T of each: (3, n_joint)
      real(wp), intent(in) :: force(:, :)
      type(coulomb_state_t), intent(out) :: state
      real(wp) :: bound, least
      integer :: j

      state = unloaded_state(joints)
      state%force = force
      least = nothing*maxval(abs(force))
      do j = 1, size(force, 2)
         associate (f => state%force(:, j))
            where (abs(f) < least) f = 0.0_wp
            if (joints%shear_role(j) /= shear_role%frictional) cycle
            bound = joints%graph%friction(j)*(f(1) + f(2))
            if (abs(f(3)) > bound - least) f(3) = sign(bound, f(3))
         end associate
      end do
   end subroutine begin_at
end module dda_coulomb_fall
