!> Decision of a load: forces that carry it, or a mechanism with power
!>
!> Forces well inside the cones of all joints carry some load. From that load a straight path leads
!> to the given one: it can be carried if and only if the path's largest factor is one or more. The
!> interior-point method starts at those forces, in balance, and stops as soon as forces reach the
!> end of the path or velocities prove that none do.
module dda_limit_decision
   use dda_interior_point, only : solve_cones, start_by_forces, start_by_springs
   use dda_interior_state, only : interior_goal_t, interior_point_t, interior_state, &
      & load_path_t, no_limit, set_path, size_of_load
   use dda_joint_graph, only : crushes, joint_graph_t, unit_of_length
   use dda_joint_strips, only : add_strips, joint_strip_t, keep_inside, list_strips
   use dda_joint_rays, only : add_ray_forces, bound_rays, forces_of_rays, n_side, ray_rates, &
      & scale_load
   use dda_kinds, only : wp
   use dda_limit_certificate, only : check_forces, check_velocities, crushing_power
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: iso_fortran_env, only : int8
   implicit none
   private

   public :: load_decision_t, load_state
   public :: decide_load, decide_on_way, drives, find_margin
   public :: begin_inside, go_on_to_load, go_to_load, state_at_end, unit_of_force
   public :: keep_velocities, resolution

   !> Decide a load: can it be carried
   type :: load_state_enum
      integer :: undecided = 0  !! Neither is proven
      integer :: stands = 1     !! There are forces that balance it and keep the law of each joint
      integer :: falls = 2      !! There is a mechanism on which it has power
   end type load_state_enum

   !> Names of these states
   type(load_state_enum), parameter :: load_state = load_state_enum()

   !> A decision with what proves it
   type :: load_decision_t
      !> One of load_state
      integer :: state = 0
      !> N1, N2, T of each joint that carry the load, where it stands: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Velocities of a mechanism, the largest one, where it falls: (3, n_block)
      real(wp), allocatable :: velocity(:, :)
      !> Largest force left on a block where it stands, over the largest load [1]
      real(wp) :: imbalance = 0.0_wp
      !> Largest violation of the law of a joint: by forces, over the largest load, where it
      !> stands; by velocities, over the largest, where it falls [1]
      real(wp) :: violation = 0.0_wp
      !> Power of the load on the mechanism where it falls [W/m]
      real(wp) :: power = 0.0_wp
      !> Factorisations
      integer :: n_factorisation = 0
   end type load_decision_t

   !> Rate below which it is round-off, over the largest velocity
   real(wp), parameter :: free = 1.0e-12_wp
   !> Gap at which an open decision ends
   real(wp), parameter :: resolution = 1.0e-12_wp

   !> Largest gap of the factors that a path reaches and does not pass
   real(wp), parameter :: margin_gap = 1.0e-9_wp

   !> Power of a mechanism below which it is round-off, over that of the loads
   real(wp), parameter :: rounding = 1.0e-13_wp

contains

   !> Decide a load: can it be carried
   pure subroutine decide_load(graph, load, decision)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)  !! Loads: (3, n_block) [N/m, N/m, N]
      type(load_decision_t), intent(out) :: decision

      if (crushes(graph)) then
         call decide_crushing(graph, load, decision)
      else
         call decide_cones(graph, load, decision)
      end if
   end subroutine decide_load

   !> Decide a load on joints that crush
   pure subroutine decide_crushing(graph, load, decision)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)  !! Loads: (3, n_block) [N/m, N/m, N]
      type(load_decision_t), intent(out) :: decision
      type(joint_graph_t) :: joints
      real(wp) :: power, unit

      unit = unit_of_force(load)
      call add_strips(graph, unit, joints)
      call decide_cones(joints, load/unit, decision)
      decision%force = unit*decision%force(:, :size(graph%kind))
      if (decision%state == load_state%stands) then
         call check_forces(graph, load, decision%force, decision%imbalance, decision%violation)
      else if (decision%state == load_state%falls) then
         call check_velocities(graph, load, decision%velocity, decision%violation, power)
         decision%power = power - crushing_power(graph, decision%velocity)
         if (.not. decision%power > 0.0_wp) decision%state = load_state%undecided
      end if
   end subroutine decide_crushing

   !> Decide a load on joints that do not crush
   pure subroutine decide_cones(graph, load, decision)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      type(load_decision_t), intent(out) :: decision
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: point
      logical :: is_none, is_number

      is_number = all(ieee_is_finite(load))
      is_none = .false.
      if (is_number) is_none = all(abs(load) <= 0.0_wp)
      if (is_none .or. .not. is_number) then
         if (is_none) decision%state = load_state%stands
         allocate (decision%force(3, size(graph%kind)), source=0.0_wp)
         allocate (decision%velocity(3, graph%n_block), source=0.0_wp)
         return
      end if
      call plan_matrix(graph, springs)
      call go_to_load(graph, load, springs, point)
      decision%n_factorisation = springs%n_factorisation
      call conclude(graph, load, point, decision)
   end subroutine decide_cones

   !> Decide a load that grows out of another one, on joints that do not crush. A collapse is
   !> reported in the mechanism in which it falls first, with the forces of then
   pure subroutine decide_on_way(graph, dead, load, tolerance, enough, decision)
      type(joint_graph_t), intent(in) :: graph
      !> The load out of which it grows: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: dead(:, :)
      !> The load: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: load(:, :)
      !> Relative gap of the two proofs of the load at which it falls
      real(wp), intent(in) :: tolerance
      !> Factorisations after which any mechanism by which it falls is enough
      integer, intent(in) :: enough
      !> The decision; undecided where the dead load does not stand, too
      type(load_decision_t), intent(out) :: decision
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: point
      real(wp) :: scaled(3, 0:graph%n_block)

      call plan_matrix(graph, springs)
      call scale_load(dead, unit_of_force(load), unit_of_length(graph), scaled)
      call begin_inside(graph, scaled, point)
      call go_on_to_load(graph, scaled, resolution, springs, point)
      if (state_at_end(point) == load_state%stands) then
         call scale_load(load, unit_of_force(load), unit_of_length(graph), scaled)
         call go_on_to_load(graph, scaled, tolerance, springs, point, to_limit=enough)
         call conclude(graph, load, point, decision)
      end if
      decision%n_factorisation = springs%n_factorisation
   end subroutine decide_on_way

   !> Margin of a load: how much of the load that equal forces along all rays carry can be taken
   !> off, in units of these forces. The load can be carried if and only if that is not negative. It
   !> is a concave function of the load, and linear for one mechanism
   pure subroutine find_margin(graph, load, tolerance, margin, unit, found, n_factorisation)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: tolerance  !! Permitted error of the margin over its unit
      real(wp), intent(out) :: margin    !! The margin [N/m]
      real(wp), intent(out) :: unit      !! Forces that it is small beside [N/m]
      logical, intent(out) :: found      !! True if it is known
      integer, intent(out) :: n_factorisation  !! Factorisations
      type(ray_matrix_t) :: springs
      type(interior_point_t) :: point
      real(wp) :: finish(3, 0:graph%n_block)

      unit = unit_of_force(load)
      call scale_load(load, unit, unit_of_length(graph), finish)
      call begin_inside(graph, finish, point)
      unit = maxval(point%x)*unit
      call plan_matrix(graph, springs)
      call go_on_to_load(graph, finish, max(tolerance, resolution), springs, point, whole=.true.)
      found = any(point%state == [interior_state%optimal, interior_state%stalled]) &
         & .and. point%upper - point%factor <= max(10.0_wp*tolerance, margin_gap)
      margin = 0.5_wp*(point%factor + point%upper)
      if (found) margin = (1.0_wp - 1.0_wp/margin)*unit
      n_factorisation = springs%n_factorisation
   end subroutine find_margin

   !> Follow the path from a load that strictly admissible forces carry to a given one
   pure subroutine go_to_load(graph, load, springs, point)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      type(ray_matrix_t), intent(inout) :: springs
      !> Where the path ends; the load is at factor one
      type(interior_point_t), intent(out) :: point
      real(wp) :: finish(3, 0:graph%n_block)

      call scale_load(load, unit_of_force(load), unit_of_length(graph), finish)
      call begin_inside(graph, finish, point)
      call go_on_to_load(graph, finish, resolution, springs, point)
      if (state_at_end(point) == load_state%undecided) &
         & call see_free_motion(graph, finish, springs, point)
   end subroutine go_to_load

   !> A load drives blocks along a motion that no joint resists, where there is one: no forces then
   !> balance any share of it
   pure subroutine see_free_motion(graph, load, springs, point)
      type(joint_graph_t), intent(in) :: graph
      !> The load in the units of the rays: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      type(ray_matrix_t), intent(inout) :: springs
      !> Receives the motion, and that it blocks the load
      type(interior_point_t), intent(inout) :: point
      type(interior_point_t) :: soft
      type(load_path_t) :: path

      call set_path(graph, 0.0_wp*load, load, path)
      call start_by_springs(graph, path, .false., springs, soft)
      if (.not. (is_free(graph, soft%v) .and. drives(load, soft%v))) return
      call move_alloc(soft%v, point%v)
      point%state = interior_state%blocked
   end subroutine see_free_motion

   !> True if a load has more power on a motion than rounded coordinates make
   pure logical function drives(load, velocity)
      real(wp), intent(in) :: load(:, :)      !! Loads: (:, n_block)
      real(wp), intent(in) :: velocity(:, :)  !! Velocities: (:, n_block)

      drives = sum(load*velocity) > rounding*sum(norm2(load(1:2, :), dim=1) &
         & *norm2(velocity(1:2, :), dim=1))
   end function drives

   !> True if a motion neither opens joints nor closes them nor slides against friction, up to
   !> rounding
   pure logical function is_free(graph, velocity)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: velocity(:, 0:)  !! Velocities of the blocks: (3, 0:n_block)
      real(wp) :: rate(n_side, size(graph%kind))

      call ray_rates(graph, unit_of_length(graph), velocity, rate)
      is_free = maxval(abs(rate)) <= free*maxval(abs(velocity))
   end function is_free

   !> Forces that are equal along all rays, several times as large as a load: nearer to the borders
   !> of the cones the first steps are short
   pure subroutine begin_inside(graph, load, point)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, 0:)
      type(interior_point_t), intent(out) :: point  !! Has these forces
      real(wp), parameter :: several = 5.0_wp
      integer(int8), allocatable :: bounded(:, :), free(:, :)
      type(joint_strip_t), allocatable :: strip(:)

      call bound_rays(graph, bounded, free)
      point%x = several*max(1.0_wp, sqrt(size_of_load(load)))*bounded
      call list_strips(graph, strip)
      call keep_inside(strip, point%x)
   end subroutine begin_inside

   !> Follow the path from the load that given forces carry to another one
   pure subroutine go_on_to_load(graph, finish, tolerance, springs, point, to_limit, whole)
      type(joint_graph_t), intent(in) :: graph
      !> The load in the units of the rays: (3, 0:n_block)
      real(wp), intent(in) :: finish(:, 0:)
      !> Gap at which a decision that is not made ends
      real(wp), intent(in) :: tolerance
      type(ray_matrix_t), intent(inout) :: springs
      !> Forces inside their bounds in, where the path ends out; the load is at factor one
      type(interior_point_t), intent(inout) :: point
      !> Factorisations within which the largest factor of a path is sought that does not reach the
      !> load: none if absent
      integer, intent(in), optional :: to_limit
      !> True if the path is followed to its end, beyond the load; else to the load
      logical, intent(in), optional :: whole
      type(interior_goal_t) :: goal
      type(load_path_t) :: path
      real(wp), allocatable :: start(:, :)
      real(wp) :: before(size(point%x, 1), size(point%x, 2))

      before = point%x
      allocate (start(3, 0:graph%n_block), source=0.0_wp)
      call add_ray_forces(graph, unit_of_length(graph), before, start)
      call set_path(graph, -start, start + finish, path)
      deallocate (start)
      ! what lacks of balance is judged by the load in question
      path%largest_dead = maxval(abs(finish))
      path%largest_live = 0.0_wp
      call start_by_forces(path, path%size, point)
      goal%tolerance = tolerance
      goal%target = path%size
      if (present(whole)) goal%target = no_limit
      if (present(to_limit)) goal%to_limit = to_limit
      call solve_cones(graph, path, goal, springs, point)
      point%factor = point%factor/path%size
      point%upper = point%upper/path%size
      if (point%factor > 1.0_wp .and. .not. present(whole)) then
         ! between two states in balance all are: back to the load
         point%x = before + (point%x - before)/point%factor
         point%factor = 1.0_wp
      end if
   end subroutine go_on_to_load

   !> Mean load of a block; moments count where no forces do
   pure real(wp) function unit_of_force(load) result(unit)
      real(wp), intent(in) :: load(:, :)

      unit = sum(hypot(load(1, :), load(2, :)))
      if (.not. unit > 0.0_wp) unit = sum(abs(load(3, :)))
      unit = unit/real(max(1, size(load, 2)), wp)
      if (.not. unit > 0.0_wp) unit = 1.0_wp
   end function unit_of_force

   !> Velocities in the user's units, the largest one
   pure subroutine keep_velocities(graph, v, velocity)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: v(:, 0:)         !! In the units of the rays: (3, 0:n_block)
      real(wp), intent(out) :: velocity(:, :)  !! Velocities: (3, n_block) [m/s, m/s, 1/s]
      real(wp) :: largest

      largest = max(maxval(abs(v)), tiny(largest))
      velocity = 0.0_wp
      velocity(1:2, :) = v(1:2, 1:)/largest
      velocity(3, :) = v(3, 1:)/(largest*unit_of_length(graph))
   end subroutine keep_velocities

   !> State proven by the end of a path to a load at factor one; forces that reach it up to rounding
   !> carry it
   pure integer function state_at_end(point) result(state)
      type(interior_point_t), intent(in) :: point  !! Where the path has ended

      state = load_state%undecided
      if (point%state == interior_state%reached) then
         state = load_state%stands
      else if (point%state == interior_state%blocked) then
         state = load_state%falls
      else if (point%state == interior_state%optimal) then
         if (point%factor >= 1.0_wp - 2.0_wp*resolution) then
            state = load_state%stands
         else if (point%upper < 1.0_wp) then
            state = load_state%falls
         end if
      end if
   end function state_at_end

   !> The decision, what proves it, and how well
   pure subroutine conclude(graph, load, point, decision)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)
      type(interior_point_t), intent(in) :: point
      type(load_decision_t), intent(inout) :: decision
      real(wp) :: imbalance, beyond_cone, beyond_flow, power

      allocate (decision%force(3, size(graph%kind)), decision%velocity(3, graph%n_block))
      call forces_of_rays(graph, point%x, unit_of_force(load), decision%force)
      call keep_velocities(graph, point%v, decision%velocity)
      call check_forces(graph, load, decision%force, imbalance, beyond_cone)
      call check_velocities(graph, load, decision%velocity, beyond_flow, power)
      decision%state = state_at_end(point)
      if (decision%state == load_state%falls .and. .not. drives(load, decision%velocity)) &
         & decision%state = load_state%undecided
      select case (decision%state)
      case (load_state%stands)
         decision%imbalance = imbalance
         decision%violation = beyond_cone
      case (load_state%falls)
         decision%violation = beyond_flow
         decision%power = power
      end select
   end subroutine conclude
end module dda_limit_decision
