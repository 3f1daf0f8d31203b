!> First motion of an assembly that cannot carry its load
!>
!> Of all accelerations that the joints allow, the true ones are nearest to those of free fall, in
!> the measure of the masses (Gauss). The interior-point method of limit analysis finds them, with
!> masses instead of a factor, and the answer is one alone. Joints that slide open by their
!> friction, as limit analysis has it.
!>
!> Under Coulomb friction an assembly falls from forces that its joints can carry: limit analysis
!> leaves forces that balance the load as far as any can. From these the blocks move at the load,
!> damped by mass, with joints that slide along themselves: until nothing stops them.
module dda_first_fall
   use dda_coulomb_equations, only : coulomb_equations_t, new_coulomb_equations
   use dda_coulomb_joints, only : coulomb_joints_t, in_metres, in_units, new_coulomb_joints, &
      & shear_role
   use dda_coulomb_law, only : apply_law, coulomb_state_t, unloaded_state
   use dda_interior_point, only : solve_cones, worst
   use dda_interior_state, only : interior_goal_t, interior_point_t, load_path_t, set_path
   use dda_interior_turn, only : lift
   use dda_joint_graph, only : joint_graph_t, unit_of_length
   use dda_joint_rays, only : forces_of_rays, scale_load
   use dda_kinds, only : wp
   use dda_limit_decision, only : keep_velocities, unit_of_force
   use dda_load_jump, only : far_factor, few_pivots, jump_t, jump_to_balance, motion_end
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t, set_springs, solve_springs
   implicit none
   private

   public :: find_coulomb_fall, find_first_motion

   !> Force below which a joint is unloaded or at its limit, over the largest
   real(wp), parameter :: nothing = 1.0e-6_wp

   !> Accepted and aimed residual of equations and products
   real(wp), parameter :: accepted = 1.0e-7_wp, aim = 1.0e-11_wp

   !> Compliance of a ray, in units of the largest mass and load
   real(wp), parameter :: compliance = 1.0e-18_wp

contains

   !> Velocities of the fall, the largest one, and the forces with which it goes on
   pure subroutine find_coulomb_fall(graph, load, force, most, velocity, found, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      !> The load: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: load(:, :)
      !> Forces that the joints can carry; those of the fall where one is found: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)
      !> Factorisations that it may take
      integer, intent(in) :: most
      !> Velocities: (3, n_block)
      real(wp), intent(inout) :: velocity(:, :)
      !> True if a motion without end was found; otherwise velocities and forces are unchanged
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
      state%load = in_units(joints, load)
      call jump_to_balance(joints, equations, (state%motion), state, jump, end)
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
      real(wp), intent(in) :: force(:, :)  !! N1, N2, T of each: (3, n_joint)
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

   !> Accelerations, the largest one
   pure subroutine find_first_motion(graph, load, motion, force, found, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)       !! Loads: (3, n_block) [N/m, N/m, N]
      real(wp), intent(out) :: motion(:, :)    !! Accelerations: (3, n_block)
      real(wp), intent(out) :: force(:, :)     !! N1, N2, T of each joint: (3, n_joint) [N/m]
      logical, intent(out) :: found            !! True if they were found
      integer, intent(out) :: n_factorisation  !! Factorisations
      type(ray_matrix_t) :: springs
      type(load_path_t) :: path
      type(interior_point_t) :: point
      real(wp) :: driven(3, 0:graph%n_block)

      call plan_matrix(graph, springs)
      call scale_load(load, unit_of_force(load), unit_of_length(graph), driven)
      call set_path(graph, driven, 0.0_wp*driven, path)
      path%mass(:, 1:) = graph%mass/maxval(graph%mass(1, :))
      path%mass(3, 1:) = path%mass(3, 1:)/path%length**2
      path%moves = .true.
      path%compliance = compliance
      call begin(graph, path, springs, point)
      call solve_cones(graph, path, interior_goal_t(tolerance=aim), springs, point)
      found = worst(point) < accepted
      n_factorisation = springs%n_factorisation
      call keep_velocities(graph, point%v, motion)
      call forces_of_rays(graph, point%x, unit_of_force(load), force)
   end subroutine find_first_motion

   !> Springs of equal stiffness beside the masses; forces and rates are then pushed inside
   pure subroutine begin(graph, path, springs, point)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(out) :: point
      real(wp), parameter :: inside = 10.0_wp

      allocate (point%v, mold=path%dead)
      allocate (point%x, point%s, mold=springs%stiffness)
      springs%stiffness = path%bounded + path%free
      call set_springs(graph, path%mass, lift, springs)
      call solve_springs(graph, springs, path%dead, point%v, point%s)
      point%x = -point%s
      point%x = path%bounded*(point%x + 1.5_wp*max(0.0_wp, -minval(point%x)) &
         & + inside*path%largest_dead)
      point%s = path%bounded*(point%s + 1.5_wp*max(0.0_wp, -minval(point%s)) &
         & + inside*maxval(abs(point%v))) + (1.0_wp - path%bounded)
   end subroutine begin

end module dda_first_fall
