!> Limit analysis: the largest factor of a live load beside a dead load
!>
!> Forces give a factor from below, a mechanism one from above; both are certificates that need no
!> trust in the method that found them. The dead load is decided first.
!>
!> Equation (M6) of docs/method.md
!>
!> The thrust is the horizontal force in the joint, positive where it presses. A block without
!> weight is put between the joint and one of its blocks, tied to that block upright and against
!> turning alone: what goes through horizontally is a pair of forces on the two, a load factor, and
!> limit analysis finds its ends.
module dda_limit_load
   use, intrinsic :: iso_fortran_env, only : int8
   use dda_interior_point, only : solve_cones, start_by_forces, start_by_springs, worst
   use dda_interior_state, only : interior_goal_t, interior_point_t, interior_state, load_path_t, &
      & no_limit, set_path, size_of_load
   use dda_joint_graph, only : crushes, joint_graph_t, joint_kind, unit_of_length
   use dda_joint_rays, only : bound_rays, forces_of_rays, scale_load
   use dda_joint_strips, only : add_strips, never_crush
   use dda_kinds, only : wp
   use dda_limit_certificate, only : balance_margin, carried_factor, check_forces, crushing_power, &
      & flow_margin, stopping_factor
   use dda_limit_decision, only : drives, go_to_load, keep_velocities, load_state, state_at_end, &
      & unit_of_force
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t
   implicit none
   private

   public :: limit_load_t, limit_state, find_limit, find_thrust_range, load_walk_t, begin_walk
   public :: walk_to

   !> Forces of an assembly on their way
   type :: load_walk_t
      private
      !> The joints, with columns for those that crush
      type(joint_graph_t) :: graph
      !> One for rays whose force may not be negative, and for rays of any sign: (n_side, n_joint)
      integer(int8), allocatable :: bounded(:, :), free(:, :)
      !> Springs that measure the distance of forces from their bounds
      type(ray_matrix_t) :: springs
      !> Masses, none: (3, 0:n_block)
      real(wp), allocatable :: mass(:, :)
      !> Forces along the rays that carry a load; unallocated where none has been carried yet:
      !> (n_side, n_joint)
      real(wp), allocatable :: x(:, :)
      !> Unit of force: [N/m]
      real(wp) :: unit = 1.0_wp
   end type load_walk_t

   !> End of a search for a limit load
   type :: limit_state_enum
      integer :: not_converged = 0        !! The two factors do not agree to the tolerance
      integer :: found = 1                !! They do
      integer :: no_dead_equilibrium = 2  !! The dead load alone falls
      integer :: unbounded = 3            !! The live load alone is carried at any factor
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
      !> Velocities of the mechanism, the largest one: (3, n_block)
      real(wp), allocatable :: velocity(:, :)
      !> Largest violation of the law of a joint by the forces, over the largest load [1]
      real(wp) :: cone_violation = 0.0_wp
      !> Factorisations
      integer :: n_factorisation = 0
   end type limit_load_t

   !> Ratios of live to dead load: possibly and certainly without limit
   real(wp), parameter :: many = 1.0e3_wp, beyond = 1.0e9_wp

   !> Largest difference of both factors of crushing joints
   real(wp), parameter :: widest = 1.0e-8_wp

   interface

      !> Begin with an assembly
      pure module subroutine begin_walk(graph, load, walk)
         type(joint_graph_t), intent(in) :: graph
         !> A load of the size of those to come: (3, n_block) [N/m, N/m, N]
         real(wp), intent(in) :: load(:, :)
         type(load_walk_t), intent(out) :: walk
      end subroutine begin_walk

      !> Go on to a load
      pure module subroutine walk_to(load, walk, state)
         real(wp), intent(in) :: load(:, :)
         !> The walk; its forces are those of the last load that took more than a correction
         type(load_walk_t), intent(inout) :: walk
         !> One of load_state
         integer, intent(out) :: state
      end subroutine walk_to

   end interface

   !> Relative gap of the bounds of either end
   real(wp), parameter :: tolerance = 1.0e-10_wp
   !> Least horizontal component of a joint normal with a thrust
   real(wp), parameter :: least_normal = 1.0e-6_wp

contains

   !> The limit load
   pure subroutine find_limit(graph, dead, live, tolerance, limit, stands)
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: dead(:, :)
      !> Load added by a factor of one: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: live(:, :)
      !> Relative gap of the two factors
      real(wp), intent(in) :: tolerance
      type(limit_load_t), intent(out) :: limit
      !> True if the dead load is taken to stand
      logical, intent(in), optional :: stands
      logical :: decided

      decided = .false.
      if (present(stands)) decided = stands
      if (crushes(graph)) then
         call limit_crushing(graph, dead, live, tolerance, decided, limit)
      else
         call limit_cones(graph, dead, live, tolerance, decided, limit)
      end if
   end subroutine find_limit

   !> The limit load of joints that crush
   pure subroutine limit_crushing(graph, dead, live, tolerance, stands, limit)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: dead(:, :)  !! Loads at factor zero: (3, n_block) [N/m, N/m, N]
      !> Load added by a factor of one: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: live(:, :)
      real(wp), intent(in) :: tolerance
      logical, intent(in) :: stands       !! True if the dead load is taken to stand
      type(limit_load_t), intent(out) :: limit
      type(joint_graph_t) :: joints
      real(wp) :: unit

      unit = unit_of_force(dead)
      call add_strips(graph, unit, joints)
      call limit_cones(joints, dead/unit, live/unit, tolerance, stands, limit)
      limit%force = unit*limit%force(:, :size(graph%kind))
      call certify(graph, dead, live, limit)
      if (limit%state == limit_state%found .and. .not. agree(limit, max(tolerance, widest), &
         & widest)) limit%state = limit_state%not_converged
   end subroutine limit_crushing

   !> True if two factors agree, and the forces keep the law of joints that crush
   pure logical function agree(limit, gap, violation)
      type(limit_load_t), intent(in) :: limit
      !> Relative gap
      real(wp), intent(in) :: gap
      !> Permitted excess of forces over a law, over the largest load
      real(wp), intent(in) :: violation

      agree = limit%upper - limit%lower <= gap*max(abs(limit%lower), abs(limit%upper)) &
         & .and. limit%cone_violation <= violation
   end function agree

   !> The limit load of joints that do not crush
   pure subroutine limit_cones(graph, dead, live, tolerance, stands, limit)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: dead(:, :), live(:, :), tolerance
      logical, intent(in) :: stands
      type(limit_load_t), intent(out) :: limit
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: point
      real(wp) :: unit

      call plan_matrix(graph, springs)
      unit = unit_of_force(dead)
      if (.not. stands) call go_to_load(graph, dead, springs, point)
      if (state_at_end(point) == load_state%falls) then
         limit%state = limit_state%no_dead_equilibrium
      else
         call raise_live_load(graph, dead, live, tolerance, .false., springs, point)
         if (point%state /= interior_state%optimal) then
            call try_live_load_alone(graph, live, unit, point, limit, springs%n_factorisation)
            if (limit%state == limit_state%not_converged .and. (crushes(graph) &
               & .or. point%state == interior_state%unbounded)) &
               & call raise_live_load(graph, dead, live, tolerance, .true., springs, point)
         end if
         if (limit%state == limit_state%not_converged .and. point%state &
            & == interior_state%optimal) limit%state = limit_state%found
      end if
      allocate (limit%force(3, size(graph%kind)))
      allocate (limit%velocity(3, graph%n_block))
      call forces_of_rays(graph, point%x, unit, limit%force)
      call keep_velocities(graph, point%v, limit%velocity)
      call certify(graph, dead, live, limit)
      limit%n_factorisation = springs%n_factorisation
   end subroutine limit_cones

   !> Raise the live load beside a dead load that stands: from forces that carry it, if there are
   !> any, or where these lead nowhere, from springs
   pure subroutine raise_live_load(graph, dead, live, tolerance, far, springs, point)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: dead(:, :), live(:, :), tolerance
      !> True if live loads far larger than the dead load are within bounds
      logical, intent(in) :: far
      type(ray_matrix_t), intent(inout) :: springs
      !> Where forces carry the dead load in, where the live load ends out
      type(interior_point_t), intent(inout) :: point
      type(load_path_t) :: path
      type(interior_goal_t) :: goal
      type(interior_point_t) :: before
      real(wp) :: scaled_dead(3, 0:graph%n_block), scaled_live(3, 0:graph%n_block)

      call scale_load(dead, unit_of_force(dead), unit_of_length(graph), scaled_dead)
      call scale_load(live, unit_of_force(dead), unit_of_length(graph), scaled_live)
      call set_path(graph, scaled_dead, scaled_live, path)
      goal%tolerance = tolerance
      goal%ceiling = merge(beyond, many, far)
      if (state_at_end(point) == load_state%stands) then
         call start_by_forces(path, max(1.0_wp, size_of_load(scaled_dead)), point)
         call solve_cones(graph, path, goal, springs, point)
         before = point
      end if
      if (worst(before) > tolerance .and. before%state /= interior_state%unbounded) then
         call start_by_springs(graph, path, far, springs, point)
         call solve_cones(graph, path, goal, springs, point)
         if (point%state /= interior_state%unbounded .and. worst(before) < worst(point)) &
            & point = before
      end if
      ! rounded coordinates may make a mechanism of what has none
      if (point%state == interior_state%optimal .and. .not. drives(scaled_live, point%v)) &
         & point%state = interior_state%stalled
      point%factor = point%factor/path%size
   end subroutine raise_live_load

   !> A live load that is carried alone is carried at any factor, where no joint has to bear it that
   !> crushes
   pure subroutine try_live_load_alone(graph, live, unit, point, limit, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: live(:, :)
      !> Unit of force, that of the live load where it is carried: [N/m]
      real(wp), intent(inout) :: unit
      !> The forces that carry it, if there are any
      type(interior_point_t), intent(inout) :: point
      type(limit_load_t), intent(inout) :: limit
      integer, intent(inout) :: n_factorisation  !! Factorisations so far
      type(joint_graph_t) :: joints
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: alone

      joints = never_crush(graph)
      call plan_matrix(joints, springs)
      springs%n_factorisation = n_factorisation
      call go_to_load(joints, live, springs, alone)
      n_factorisation = springs%n_factorisation
      if (state_at_end(alone) /= load_state%stands) return
      limit%state = limit_state%unbounded
      point = alone
      unit = unit_of_force(live)
   end subroutine try_live_load_alone

   !> Factors from forces and velocities alone
   pure subroutine certify(graph, dead, live, limit)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: dead(:, :), live(:, :)
      type(limit_load_t), intent(inout) :: limit  !! State, forces and velocities in, the rest out
      real(wp) :: imbalance, power, rounding

      select case (limit%state)
      case (limit_state%no_dead_equilibrium)
         limit%force = 0.0_wp
         limit%lower = -no_limit
         limit%upper = -no_limit
      case (limit_state%unbounded)
         limit%velocity = 0.0_wp
         limit%lower = no_limit
         limit%upper = no_limit
         call check_forces(graph, live, limit%force, imbalance, limit%cone_violation)
      case default
         limit%lower = carried_factor(graph, dead, live, limit%force)
         limit%upper = stopping_factor(dead, live, limit%velocity)
         if (crushes(graph)) limit%upper = limit%upper + crushing_power(graph, limit%velocity) &
            & /max(sum(live*limit%velocity), tiny(1.0_wp))
         call check_forces(graph, dead + limit%lower*live, limit%force, imbalance, &
            & limit%cone_violation)
         if (limit%state /= limit_state%found) return
         ! what rounding leaves of the proofs moves the factors apart
         power = sum(live*limit%velocity)
         limit%lower = limit%lower - balance_margin(graph, dead + limit%lower*live, limit%force, &
            & limit%velocity)/power
         limit%upper = limit%upper + flow_margin(graph, limit%force, limit%velocity)/power
         rounding = 8.0_wp*spacing(max(abs(limit%lower), abs(limit%upper)))
         limit%lower = limit%lower - rounding
         ! the dead load stands, up to rounding
         limit%upper = max(limit%upper + rounding, 0.0_wp)
      end select
   end subroutine certify

   !> The range of thrust of a joint
   pure subroutine find_thrust_range(graph, load, force, joint, thrust, known)
      type(joint_graph_t), intent(in) :: graph
      !> Loads: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: load(:, :)
      !> N1, N2, T of each joint that carry it: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> Number of the joint
      integer, intent(in) :: joint
      !> Least and greatest thrust: (2) [N/m]
      real(wp), intent(out) :: thrust(2)
      !> True for those of the two that exist: one may have no bound
      logical, intent(out) :: known(2)
      type(joint_graph_t) :: split
      type(limit_load_t) :: limit
      real(wp) :: dead(3, graph%n_block + 1), live(3, graph%n_block + 1), share(3), way, middle
      integer :: k, side

      known = .false.
      thrust = 0.0_wp
      side = merge(1, 2, graph%block(1, joint) > 0)
      share = graph%row(1, :, side, joint)
      if (.not. abs(share(1)) > least_normal) return
      way = sign(1.0_wp, share(1))
      middle = way*dot_product(share, force(:, joint))
      call split_graph(graph, joint, side, split)
      dead = 0.0_wp
      dead(:, :graph%n_block) = load
      live = 0.0_wp
      live(1, graph%n_block + 1) = -way
      live(1, graph%block(side, joint)) = way
      dead = dead + middle*live
      do k = 1, 2
         call find_limit(split, dead, merge(-1.0_wp, 1.0_wp, k == 1)*live, tolerance, limit, &
            & stands=.true.)
         known(k) = limit%state == limit_state%found
         if (known(k)) thrust(k) = middle &
            & + merge(-0.5_wp, 0.5_wp, k == 1)*(limit%lower + limit%upper)
      end do
   end subroutine find_thrust_range

   !> The same joints, with a block without weight between one of them and one of its blocks
   pure subroutine split_graph(graph, joint, side, split)
      type(joint_graph_t), intent(in) :: graph
      integer, intent(in) :: joint
      integer, intent(in) :: side  !! Its block, 1 or 2, from which it is separated
      type(joint_graph_t), intent(out) :: split
      integer :: n

      n = size(graph%kind)
      split%n_block = graph%n_block + 1
      allocate (split%block(2, n + 1), split%kind(n + 1))
      allocate (split%row(3, 3, 2, n + 1), split%friction(n + 1), split%length(n + 1), &
         & source=0.0_wp)
      split%block(:, :n) = graph%block
      split%kind(:n) = graph%kind
      split%row(:, :, :, :n) = graph%row
      split%friction(:n) = graph%friction
      split%length(:n) = graph%length
      if (allocated(graph%crush)) split%crush = [graph%crush, huge(1.0_wp)]
      split%block(side, joint) = split%n_block
      split%kind(n + 1) = joint_kind%pin
      split%block(:, n + 1) = [graph%block(side, joint), split%n_block]
      split%row(2, 1, :, n + 1) = [-1.0_wp, 1.0_wp]
      split%row(3, 3, :, n + 1) = [-1.0_wp, 1.0_wp]
   end subroutine split_graph
end module dda_limit_load
