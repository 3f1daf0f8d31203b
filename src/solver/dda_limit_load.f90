!> Limit analysis: the largest factor of a live load that an assembly carries beside a dead load
!>
!> Forces give a factor from below, a mechanism one from above; both are certificates that need no
!> trust in the method that found them. The dead load is decided first.
!>
!> Equation (M6) of docs/method.md
module dda_limit_load
   use dda_interior_point, only : solve_interior, start_by_springs
   use dda_interior_state, only : interior_goal_t, interior_point_t, interior_state, &
      & load_path_t, no_limit, set_path
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : joint_forces, joint_rays_t, scale_load, set_rays
   use dda_kinds, only : wp
   use dda_limit_certificate, only : balance_margin, carried_factor, check_forces, &
      & check_velocities, flow_margin, stopping_factor
   use dda_limit_decision, only : go_to_load, keep_velocities, load_state, &
      & state_at_end, unit_of_force
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t
   implicit none
   private

   public :: limit_load_t, limit_state
   public :: find_limit

   !> How a search for a limit load has ended
   type :: limit_state_enum
      !> The two factors do not agree to the tolerance
      integer :: not_converged = 0
      !> They do
      integer :: found = 1
      !> The dead load alone falls
      integer :: no_dead_equilibrium = 2
      !> The live load alone is carried at any factor
      integer :: unbounded = 3
   end type limit_state_enum

   !> Names of these ends
   type(limit_state_enum), parameter :: limit_state = limit_state_enum()

   !> A limit load with what proves it
   type :: limit_load_t
      !> One of limit_state
      integer :: state = 0
      !> Factor that the forces carry
      real(wp) :: lower = 0.0_wp
      !> Factor that the mechanism does not let pass
      real(wp) :: upper = no_limit
      !> N1, N2, T of each joint: with dead and lower*live; where unbounded, with live alone:
      !> (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Velocities of the mechanism, the largest one: (n_dof, n_block)
      real(wp), allocatable :: velocity(:, :)
      !> Largest force that is left on a block, over the largest load [1]
      real(wp) :: imbalance = 0.0_wp
      !> Largest violation of the law of a joint by the forces, over the largest load [1]
      real(wp) :: cone_violation = 0.0_wp
      !> Largest violation of the flow rule by the velocities, over the largest of them [1]
      real(wp) :: flow_violation = 0.0_wp
      !> Power on the mechanism of the live load; without dead equilibrium, of the dead load [W/m]
      real(wp) :: power = 0.0_wp
      !> Factorisations
      integer :: n_factorisation = 0
   end type limit_load_t

   !> A live load so many times as large as the dead load may have no limit, one so many times as
   !> large has none
   real(wp), parameter :: many = 1.0e3_wp, beyond = 1.0e9_wp

contains

   !> The limit load
   pure subroutine find_limit(graph, dead, live, tolerance, limit, stands)
      !> The joints
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: dead(:, :)
      !> What a factor of one adds: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: live(:, :)
      !> Relative gap of the two factors
      real(wp), intent(in) :: tolerance
      !> The limit
      type(limit_load_t), intent(out) :: limit
      !> Whether the dead load is taken to stand
      logical, intent(in), optional :: stands
      type(joint_rays_t) :: rays
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: point
      real(wp) :: unit
      logical :: decided

      call set_rays(graph, rays)
      call plan_matrix(rays, springs)
      unit = unit_of_force(dead)
      decided = .false.
      if (present(stands)) decided = stands
      if (.not. decided) call go_to_load(rays, dead, springs, point)
      if (state_at_end(point) == load_state%falls) then
         limit%state = limit_state%no_dead_equilibrium
      else
         call raise_live_load(rays, dead, live, tolerance, many, springs, point)
         if (point%state /= interior_state%optimal .and. point%factor > 0.0_wp) &
            & call try_live_load_alone(rays, live, springs, unit, point, limit)
         if (limit%state == limit_state%not_converged) then
            if (point%state == interior_state%unbounded) &
               & call raise_live_load(rays, dead, live, tolerance, beyond, springs, point)
            if (point%state == interior_state%optimal) limit%state = limit_state%found
         end if
      end if
      allocate (limit%force(3, size(graph%kind)))
      allocate (limit%velocity(graph%n_dof, graph%n_block))
      call joint_forces(rays, point%x, unit, limit%force)
      call keep_velocities(rays, point%v, limit%velocity)
      call certify(graph, dead, live, limit)
      limit%n_factorisation = springs%n_factorisation
   end subroutine find_limit

   !> Raise the live load beside a dead load that stands
   pure subroutine raise_live_load(rays, dead, live, tolerance, ceiling, springs, point)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Loads at factor zero: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: dead(:, :)
      !> What a factor of one adds: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: live(:, :)
      !> Relative gap
      real(wp), intent(in) :: tolerance
      !> Live loads so many times as large as the dead load are beyond bounds
      real(wp), intent(in) :: ceiling
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> The limit
      type(interior_point_t), intent(out) :: point
      type(load_path_t) :: path
      type(interior_goal_t) :: goal
      real(wp) :: scaled_dead(3, 0:rays%n_block), scaled_live(3, 0:rays%n_block)

      call scale_load(rays, dead, unit_of_force(dead), scaled_dead)
      call scale_load(rays, live, unit_of_force(dead), scaled_live)
      call set_path(scaled_dead, scaled_live, path)
      call start_by_springs(rays, path, springs, point)
      goal%tolerance = tolerance
      goal%ceiling = ceiling
      call solve_interior(rays, path, goal, springs, point)
      point%factor = point%factor/path%size
   end subroutine raise_live_load

   !> A live load that is carried alone is carried at any factor
   pure subroutine try_live_load_alone(rays, live, springs, unit, point, limit)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> What a factor of one adds: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: live(:, :)
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Unit of force, that of the live load where it is carried: [N/m]
      real(wp), intent(inout) :: unit
      !> The forces that carry it, if there are any
      type(interior_point_t), intent(inout) :: point
      !> Receives the state
      type(limit_load_t), intent(inout) :: limit
      type(interior_point_t) :: alone

      call go_to_load(rays, live, springs, alone)
      if (state_at_end(alone) /= load_state%stands) return
      limit%state = limit_state%unbounded
      point = alone
      unit = unit_of_force(live)
   end subroutine try_live_load_alone

   !> Factors and figures from forces and velocities alone
   pure subroutine certify(graph, dead, live, limit)
      !> The joints
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: dead(:, :)
      !> What a factor of one adds: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: live(:, :)
      !> State, forces and velocities in, the rest out
      type(limit_load_t), intent(inout) :: limit
      real(wp) :: rounding

      select case (limit%state)
      case (limit_state%no_dead_equilibrium)
         limit%force = 0.0_wp
         limit%lower = -no_limit
         limit%upper = -no_limit
         call check_velocities(graph, dead, limit%velocity, limit%flow_violation, limit%power)
      case (limit_state%unbounded)
         limit%velocity = 0.0_wp
         limit%lower = no_limit
         limit%upper = no_limit
         call check_forces(graph, live, limit%force, limit%imbalance, limit%cone_violation)
      case default
         limit%lower = carried_factor(graph, dead, live, limit%force)
         limit%upper = stopping_factor(dead, live, limit%velocity)
         call check_forces(graph, dead + limit%lower*live, limit%force, limit%imbalance, &
            & limit%cone_violation)
         call check_velocities(graph, live, limit%velocity, limit%flow_violation, limit%power)
         if (limit%state /= limit_state%found) return
         ! what rounding leaves of the proofs moves the factors apart
         limit%lower = limit%lower - balance_margin(graph, dead + limit%lower*live, limit%force, &
            & limit%velocity)/limit%power
         limit%upper = limit%upper + flow_margin(graph, limit%force, limit%velocity)/limit%power
         rounding = 8.0_wp*spacing(max(abs(limit%lower), abs(limit%upper)))
         limit%lower = limit%lower - rounding
         limit%upper = limit%upper + rounding
      end select
   end subroutine certify
end module dda_limit_load
