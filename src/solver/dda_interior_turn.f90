!> One turn of the interior-point method: springs, predictor, corrector
!>
!> Corrections of the balance are added to the directions of x, v and the factor one by one, which
!> keeps the balance when the springs spread over many decades. Free rays have springs of a
!> stiffness that is large: what they open is led back to zero from turn to turn.
module dda_interior_turn
   use dda_interior_state, only : interior_goal_t, interior_point_t, load_path_t, no_limit
   use dda_joint_rays, only : add_ray_forces, joint_rays_t, n_side, ray_rates
   use dda_kinds, only : wp
   use dda_ray_matrix, only : ray_matrix_t, set_springs, solve_springs
   implicit none
   private

   public :: turn_t, least_lift
   public :: begin_turns, see_residuals, predict, correct, move

   !> What one turn works on
   type :: turn_t
      !> What balance lacks, and right-hand sides: (3, 0:n_block)
      real(wp), allocatable :: lack(:, :), rest(:, :)
      !> Response to the live load, to the right-hand side: (3, 0:n_block)
      real(wp), allocatable :: unit_response(:, :), response(:, :)
      !> Rates less what velocities make of them: (n_side, n_joint)
      real(wp), allocatable :: excess(:, :)
      !> What the power of the live load lacks of one
      real(wp) :: lack_of_power = 0.0_wp
      !> Mean of x*s
      real(wp) :: barrier = 0.0_wp
      !> Power of the live load on the response to it
      real(wp) :: flexibility = 0.0_wp
      !> Change of x at unchanged s: (n_side, n_joint)
      real(wp), allocatable :: aim(:, :)
      !> Stiffness of the springs, work space: (n_side, n_joint)
      real(wp), allocatable :: stiffness(:, :), rate(:, :)
      !> Direction: (n_side, n_joint), the same, (3, 0:n_block), and of the factor
      real(wp), allocatable :: dx(:, :), ds(:, :), dv(:, :)
      real(wp) :: dfactor = 0.0_wp
      !> Imbalance that the direction leaves, the largest that is accepted
      real(wp) :: left = 0.0_wp, accepted = 0.0_wp
      !> Share by which diagonal entries are raised
      real(wp) :: lift = 0.0_wp
   end type turn_t

   !> Least share by which diagonal entries are raised
   real(wp), parameter :: least_lift = 1.0e-14_wp
   !> This one and those tried after it
   real(wp), parameter :: lifts(3) = [least_lift, 1.0e-11_wp, 1.0e-8_wp]
   !> Turns of conjugate gradients where the factor alone does not balance
   integer, parameter :: gradient_turns = 10
   !> Share of the way to the border of the cones
   real(wp), parameter :: share_of_way = 0.995_wp

contains

   !> Work space of the turns
   pure subroutine begin_turns(rays, path, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The work space
      type(turn_t), intent(out) :: turn

      allocate (turn%lack, turn%rest, turn%unit_response, turn%response, turn%dv, &
         & source=0.0_wp*path%dead)
      allocate (turn%excess, turn%aim, turn%stiffness, turn%rate, turn%dx, turn%ds, &
         & source=0.0_wp*rays%bounded)
      turn%lift = least_lift
   end subroutine begin_turns

   !> Balance, compatibility and the gap at a point
   pure subroutine see_residuals(rays, path, point, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The point; receives the figures
      type(interior_point_t), intent(inout) :: point
      !> Receives the residuals
      type(turn_t), intent(inout) :: turn
      real(wp) :: power

      turn%rest = path%dead + point%factor*path%live
      call add_ray_forces(rays, point%x, turn%rest)
      turn%lack = -turn%rest
      point%imbalance = maxval(abs(turn%lack)) &
         & /max(path%largest_dead, abs(point%factor)*path%largest_live, tiny(power))
      call ray_rates(rays, point%v, turn%rate)
      turn%excess = point%s*rays%bounded - turn%rate
      point%violation = max(maxval(-turn%rate*rays%bounded), maxval(abs(turn%rate*rays%free))) &
         & /max(maxval(abs(point%v)), tiny(power))
      turn%barrier = sum(point%x*point%s*rays%bounded)/real(max(1, rays%n_bounded), wp)
      power = sum(path%live*point%v)
      turn%lack_of_power = 1.0_wp - power
      point%upper = no_limit
      if (power > 0.0_wp) point%upper = -sum(path%dead*point%v)/power
      point%gap = abs(point%upper - point%factor) &
         & /max(abs(point%factor), abs(point%upper), tiny(power))
   end subroutine see_residuals

   !> Factor the springs and find the direction to x*s = 0; where the factor does not balance,
   !> conjugate gradients and then raised diagonals help
   pure subroutine predict(rays, path, springs, point, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> The point
      type(interior_point_t), intent(in) :: point
      !> Receives the direction
      type(turn_t), intent(inout) :: turn
      integer :: tier

      turn%stiffness = rays%bounded*point%x/point%s &
         & + rays%free*1.0e6_wp*sum(abs(point%x*rays%bounded))/sum(point%s*rays%bounded)
      turn%aim = -point%x*rays%bounded
      turn%lift = max(least_lift, 1.0e-3_wp*turn%lift)
      turn%accepted = max(1.0e-9_wp*path%largest_dead, 0.05_wp*maxval(abs(turn%lack)))
      do tier = 1, 2*size(lifts)
         if (modulo(tier, 2) == 1) then
            if (tier > 1) turn%lift = lifts(ishft(tier + 1, -1))
            springs%max_turn = 0
            call set_springs(rays, turn%stiffness, turn%lift, springs)
         else
            springs%max_turn = gradient_turns
         end if
         if (.not. springs%factor%usable) cycle
         call respond_to_live_load(rays, path, springs, turn)
         call find_direction(rays, path, springs, turn%accepted, turn)
         if (turn%left <= turn%accepted .and. turn%flexibility > 0.0_wp) exit
      end do
   end subroutine predict

   !> Response of the springs to the live load
   pure subroutine respond_to_live_load(rays, path, springs, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Receives it
      type(turn_t), intent(inout) :: turn

      call solve_springs(rays, springs, path%live, turn%unit_response)
      turn%flexibility = sum(path%live*turn%unit_response)
   end subroutine respond_to_live_load

   !> Direction to balance, compatibility and the aim; corrections follow until the imbalance that
   !> it leaves no longer halves
   pure subroutine find_direction(rays, path, springs, enough, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Imbalance that needs no correction
      real(wp), intent(in) :: enough
      !> Aim in, direction out
      type(turn_t), intent(inout) :: turn
      real(wp) :: step, before, imbalance
      integer :: correction

      turn%dx = turn%aim + turn%stiffness*turn%excess
      turn%rest = -turn%lack
      call add_ray_forces(rays, turn%dx, turn%rest)
      call solve_springs(rays, springs, turn%rest, turn%response)
      turn%dfactor = (turn%lack_of_power - sum(path%live*turn%response))/turn%flexibility
      turn%dv = turn%response + turn%dfactor*turn%unit_response
      call ray_rates(rays, turn%dv, turn%rate)
      turn%ds = turn%rate - turn%excess
      turn%dx = turn%aim - turn%stiffness*turn%ds
      before = huge(before)
      turn%left = huge(before)
      do correction = 1, 3
         turn%rest = -turn%lack + turn%dfactor*path%live
         call add_ray_forces(rays, turn%dx, turn%rest)
         imbalance = maxval(abs(turn%rest))
         turn%left = min(turn%left, imbalance)
         if (.not. imbalance < 0.5_wp*before .or. imbalance < enough) exit
         before = imbalance
         call solve_springs(rays, springs, turn%rest, turn%response)
         step = (turn%lack_of_power - sum(path%live*turn%dv) - sum(path%live*turn%response)) &
            & /turn%flexibility
         turn%response = turn%response + step*turn%unit_response
         turn%dfactor = turn%dfactor + step
         turn%dv = turn%dv + turn%response
         call ray_rates(rays, turn%response, turn%rate)
         turn%ds = turn%ds + turn%rate
         turn%dx = turn%dx - turn%stiffness*turn%rate
      end do
   end subroutine find_direction

   !> Direction to equal products x*s, with the second order of the predictor
   pure subroutine correct(rays, path, goal, springs, point, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> What is asked for
      type(interior_goal_t), intent(in) :: goal
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> The point
      type(interior_point_t), intent(in) :: point
      !> Predictor in, direction out
      type(turn_t), intent(inout) :: turn
      type(turn_t) :: first
      real(wp) :: to_x, to_s, after, centring

      call longest_steps(rays, point, turn, to_x, to_s)
      to_x = min(1.0_wp, to_x)
      to_s = min(1.0_wp, to_s)
      after = sum((point%x + to_x*turn%dx)*(point%s + to_s*turn%ds)*rays%bounded) &
         & /real(max(1, rays%n_bounded), wp)
      centring = min(1.0_wp, (after/turn%barrier)**3)
      centring = max(centring, min(1.0_wp, 0.02_wp*goal%tolerance*abs(point%factor) &
         & /(real(max(1, rays%n_bounded), wp)*turn%barrier)))
      turn%aim = ((centring*turn%barrier - turn%dx*turn%ds)/point%s - point%x)*rays%bounded
      call find_direction(rays, path, springs, 1.0e-14_wp*path%largest_dead, turn)
      if (turn%left <= turn%accepted) return
      first = turn
      springs%max_turn = merge(0, gradient_turns, springs%max_turn > 0)
      call respond_to_live_load(rays, path, springs, turn)
      call find_direction(rays, path, springs, 1.0e-14_wp*path%largest_dead, turn)
      if (.not. turn%left < first%left) turn = first
   end subroutine correct

   !> Longest steps along a direction that keep forces and rates inside their bounds
   pure subroutine longest_steps(rays, point, turn, to_x, to_s)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The point
      type(interior_point_t), intent(in) :: point
      !> The direction
      type(turn_t), intent(in) :: turn
      !> Step of the forces
      real(wp), intent(out) :: to_x
      !> Step of the rates
      real(wp), intent(out) :: to_s
      integer :: i, j

      to_x = 1.0e9_wp
      to_s = 1.0e9_wp
      do j = 1, size(point%x, 2)
         do i = 1, n_side
            if (.not. rays%bounded(i, j) > 0.0_wp) cycle
            if (turn%dx(i, j) < 0.0_wp) to_x = min(to_x, -point%x(i, j)/turn%dx(i, j))
            if (turn%ds(i, j) < 0.0_wp) to_s = min(to_s, -point%s(i, j)/turn%ds(i, j))
         end do
      end do
   end subroutine longest_steps

   !> Move along the direction, almost to the border and not beyond the target
   pure subroutine move(rays, goal, turn, point)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> What is asked for
      type(interior_goal_t), intent(in) :: goal
      !> The direction
      type(turn_t), intent(in) :: turn
      !> The point
      type(interior_point_t), intent(inout) :: point
      real(wp) :: to_x, to_s

      call longest_steps(rays, point, turn, to_x, to_s)
      to_x = min(1.0_wp, share_of_way*to_x)
      to_s = min(1.0_wp, share_of_way*to_s)
      if (point%factor + to_x*turn%dfactor > goal%target) &
         & to_x = (goal%target - point%factor)/turn%dfactor
      point%x = point%x + to_x*turn%dx
      point%factor = point%factor + to_x*turn%dfactor
      point%s = point%s + to_s*(turn%ds*rays%bounded)
      point%v = point%v + to_s*turn%dv
   end subroutine move
end module dda_interior_turn
