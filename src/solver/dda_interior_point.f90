!> Largest load factor of the joints, or motion of masses under a load, by a primal-dual
!> interior-point method
!>
!>    largest f with  A x + f live + dead = 0,  x >= 0      A: arms of the rays, x: their forces
!>    least -dead.v with  s = A'v >= 0,  live.v = 1         v: velocities of a mechanism
!>
!>    mass v = load + A x,  s = A'v >= 0,  x >= 0,  x s = 0  v: accelerations
!>
!> Both sides at once, by Mehrotra's predictor and corrector. A turn is the assembly and
!> factorisation of a DDA step with a spring of stiffness x/s along each ray.
!>
!> Equation (M6) of docs/method.md
module dda_interior_point
   use dda_interior_state, only : interior_goal_t, interior_point_t, interior_state, &
      & load_path_t, no_limit
   use dda_interior_direction, only : turn_t
   use dda_interior_turn, only : begin_turns, correct, lift, move, predict, see_residuals
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_strips, only : keep_inside, renew_strips
   use dda_kinds, only : wp
   use dda_ray_matrix, only : ray_matrix_t, set_springs, solve_springs
   implicit none
   private

   public :: start_by_forces, start_by_springs, worst, solve_cones

   !> Iterations without progress before termination; twice as many where joints crush: their
   !> curvature may show late
   integer, parameter :: patience = 8
   !> Least progress of a factor over its target
   real(wp), parameter :: headway = 0.01_wp
   !> Least initial force and rate
   real(wp), parameter :: inside = 1.0e-6_wp
   !> Residual of forces and velocities in a certificate
   real(wp), parameter :: certain = 1.0e-12_wp
   !> Gap that round-off leaves between both bounds
   real(wp), parameter :: near = 1.0e-9_wp

contains

   !> Springs of equal stiffness carry the dead load; all forces and rates are then pushed inside
   !> their bounds by the same amount (Mehrotra)
   pure subroutine start_by_springs(graph, path, far, springs, point)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      logical, intent(in) :: far  !! True if joints that crush begin at a share of their strength
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(out) :: point  !! Where the iteration begins
      real(wp) :: product, power

      allocate (point%x, point%s, mold=springs%stiffness)
      allocate (point%v, mold=path%dead)
      springs%stiffness = path%bounded + path%free
      call set_springs(graph, path%mass, lift, springs)
      call solve_springs(graph, springs, -path%dead, point%v, point%x)
      call solve_springs(graph, springs, path%live, point%v, point%s)
      power = sum(path%live*point%v)
      if (power > 0.0_wp) then
         point%v = point%v/power
         point%s = point%s/power
      end if
      if (any(path%bounded > 0)) then
         point%x = point%x + 1.5_wp*max(0.0_wp, -minval(point%x, path%bounded > 0)) + inside
         point%s = point%s + 1.5_wp*max(0.0_wp, -minval(point%s, path%bounded > 0)) &
            & + inside*maxval(abs(point%v))
         product = sum(point%x*point%s*path%bounded)
         power = sum(point%s*path%bounded)
         point%s = point%s + 0.5_wp*product/sum(point%x*path%bounded)
         point%x = point%x + 0.5_wp*product/power
      end if
      point%x = point%x*path%bounded
      if (far .and. size(path%strip) > 0) &
         & point%x = path%bounded*(0.25_wp*minval(path%strip%strength))
      call keep_inside(path%strip, point%x)
      point%s = point%s*path%bounded + (1.0_wp - path%bounded)
   end subroutine start_by_springs

   !> Forces that carry the dead load inside their bounds, and rates that share a power equally
   pure subroutine start_by_forces(path, power, point)
      type(load_path_t), intent(in) :: path
      real(wp), intent(in) :: power                   !! Power of all forces: the gap to begin with
      type(interior_point_t), intent(inout) :: point  !! Has the forces; receives the rest

      point = interior_point_t(x=point%x)
      point%s = power*path%bounded/(path%n_bounded &
         & *(point%x*path%bounded + (1.0_wp - path%bounded))) + (1.0_wp - path%bounded)
      allocate (point%v, mold=path%dead)
      point%v = 0.0_wp
   end subroutine start_by_forces

   !> Largest factor, or motion of masses, from a point inside the bounds
   pure subroutine solve_cones(graph, path, goal, springs, point)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_goal_t), intent(in) :: goal
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(inout) :: point  !! Where it begins and ends
      type(interior_point_t) :: best
      type(turn_t) :: turn
      integer :: idle
      real(wp) :: merit, farthest

      call begin_turns(path, goal, turn)
      merit = huge(merit)
      farthest = point%factor
      idle = 0
      ! where the load is no number no point is better than the first
      call keep(point, best)
      do
         call see_residuals(graph, path, point, turn)
         idle = idle + 1
         if (worst(point) < merit) then
            merit = worst(point)
            call keep(point, best)
            idle = 0
         end if
         ! on the way to a target the gap may stay
         if (goal%target < no_limit .and. point%factor > farthest + headway*goal%target) then
            farthest = point%factor
            idle = 0
         end if
         call judge(path, goal, turn, idle, springs%n_factorisation, point)
         if (point%state /= interior_state%running) exit
         point%n_turn = point%n_turn + 1
         call predict(graph, path, springs, point, turn)
         if (.not. springs%usable) then
            point%state = interior_state%stalled
            exit
         end if
         call correct(graph, path, goal, springs, point, turn)
         call move(path, turn, point)
         call renew_strips(path%strip, point%x)
      end do
      if (point%state /= interior_state%stalled) return
      best%n_turn = point%n_turn
      best%state = point%state
      if (goal%target >= no_limit .and. worst(best) < near) best%state = interior_state%optimal
      point = best
   end subroutine solve_cones

   !> Keep a point without its rates, which are not needed again
   pure subroutine keep(point, kept)
      type(interior_point_t), intent(inout) :: point  !! The point; it comes back as it was
      type(interior_point_t), intent(inout) :: kept
      real(wp), allocatable :: s(:, :)

      call move_alloc(point%s, s)
      ! an assignment would hold both at once
      if (allocated(kept%x)) deallocate (kept%x, kept%v)
      kept = point
      call move_alloc(s, point%s)
   end subroutine keep

   !> The worst of the three figures
   pure real(wp) function worst(point)
      type(interior_point_t), intent(in) :: point

      worst = max(point%gap, point%imbalance, point%violation)
   end function worst

   !> Check for the end of the iteration
   pure subroutine judge(path, goal, turn, idle, n_factorisation, point)
      type(load_path_t), intent(in) :: path
      type(interior_goal_t), intent(in) :: goal
      type(turn_t), intent(in) :: turn
      integer, intent(in) :: idle             !! Turns without progress
      integer, intent(in) :: n_factorisation  !! Factorisations so far
      type(interior_point_t), intent(inout) :: point
      real(wp) :: live

      live = max(path%largest_live, tiny(1.0_wp))
      point%state = interior_state%running
      if (point%imbalance < certain .and. point%factor >= goal%target) then
         point%state = interior_state%reached
      else if (point%violation < certain .and. point%upper + point%margin < goal%target &
         & .and. goal%target < no_limit .and. n_factorisation >= goal%to_limit) then
         point%state = interior_state%blocked
      else if (worst(point) < goal%tolerance) then
         point%state = interior_state%optimal
      else if (point%factor*live > goal%ceiling*max(live, path%largest_dead) &
         & .and. point%imbalance < near) then
         point%state = interior_state%unbounded
      else if (idle >= merge(patience, 2*patience, size(path%strip) == 0) &
         & .or. point%n_turn == goal%max_turn &
         & .or. .not. abs(turn%barrier) <= huge(turn%barrier)) then
         point%state = interior_state%stalled
      end if
   end subroutine judge
end module dda_interior_point
