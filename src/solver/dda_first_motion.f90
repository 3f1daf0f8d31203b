!> How an assembly that cannot carry its load begins to fall
!>
!> Of all accelerations that the joints allow, the true ones are nearest to those of free fall, in
!> the measure of the masses (Gauss). The interior-point method of limit analysis finds them, with
!> masses instead of a factor, and the answer is one alone. Joints that slide open by their
!> friction, as limit analysis has it.
module dda_first_motion
   use dda_interior_point, only : solve_cones, worst
   use dda_interior_state, only : interior_goal_t, interior_point_t, load_path_t, set_path
   use dda_interior_turn, only : lift
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : forces_of_rays, joint_rays_t, scale_load, set_rays
   use dda_kinds, only : wp
   use dda_limit_decision, only : keep_velocities, unit_of_force
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t, set_springs, solve_springs
   implicit none
   private

   public :: find_first_motion

   !> What may be left of equations and products, and what is aimed at
   real(wp), parameter :: accepted = 1.0e-7_wp, aim = 1.0e-11_wp

   !> What a unit of force closes a ray by, in units of the largest mass and of the largest load
   real(wp), parameter :: compliance = 1.0e-18_wp

contains

   !> Accelerations, the largest one
   pure subroutine find_first_motion(graph, load, motion, force, found, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      !> Loads: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: load(:, :)
      !> Accelerations: (n_dof, n_block)
      real(wp), intent(out) :: motion(:, :)
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(out) :: force(:, :)
      !> Whether they were found
      logical, intent(out) :: found
      !> Factorisations
      integer, intent(out) :: n_factorisation
      type(joint_rays_t) :: rays
      type(ray_matrix_t) :: springs
      type(load_path_t) :: path
      type(interior_point_t) :: point
      real(wp) :: driven(3, 0:graph%n_block)

      call set_rays(graph, rays)
      call plan_matrix(rays, springs)
      call scale_load(rays, load, unit_of_force(load), driven)
      call set_path(driven, 0.0_wp*driven, path)
      path%mass(:, 1:) = graph%mass(1:3, :)/maxval(graph%mass(1, :))
      path%mass(3, 1:) = path%mass(3, 1:)/rays%length**2
      path%moves = .true.
      path%compliance = compliance
      call begin(rays, path, springs, point)
      call solve_cones(rays, path, interior_goal_t(tolerance=aim), springs, point)
      found = worst(point) < accepted
      n_factorisation = springs%n_factorisation
      call keep_velocities(rays, point%v, motion)
      call forces_of_rays(rays, point%x, unit_of_force(load), force)
   end subroutine find_first_motion

   !> Springs of equal stiffness beside the masses; forces and rates are then pushed inside
   pure subroutine begin(rays, path, springs, point)
      type(joint_rays_t), intent(in) :: rays
      type(load_path_t), intent(in) :: path
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(out) :: point
      real(wp), parameter :: inside = 10.0_wp

      allocate (point%v, mold=path%dead)
      allocate (point%x, point%s, mold=rays%bounded)
      springs%stiffness = rays%bounded + rays%free
      call set_springs(rays, path%mass, lift, springs)
      call solve_springs(rays, springs, path%dead, point%v, point%s)
      point%x = -point%s
      point%x = rays%bounded*(point%x + max(0.0_wp, -1.5_wp*minval(point%x)) &
         & + inside*path%largest_dead)
      point%s = rays%bounded*(point%s + max(0.0_wp, -1.5_wp*minval(point%s)) &
         & + inside*maxval(abs(point%v))) + (1.0_wp - rays%bounded)
   end subroutine begin
end module dda_first_motion
