!> One turn of the interior-point method: springs, predictor, corrector
!>
!> Corrections of the balance are added to the directions of x, v and the factor one by one, which
!> keeps the balance when the springs spread over many decades. Free rays have springs of a
!> stiffness that is large: what they open is led back to zero from turn to turn.
module dda_interior_turn
   use dda_interior_state, only : interior_goal_t, interior_point_t, load_path_t, no_limit
   use dda_joint_rays, only : add_ray_forces, joint_rays_t, n_side, ray_rates
   use dda_kinds, only : wp
   use dda_ray_matrix, only : ray_matrix_t, set_springs, set_wide_springs, solve_springs
   implicit none
   private

   public :: turn_t, lift
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
      !> Smallest factor whose gap is relative to itself
      real(wp) :: least_factor = 0.0_wp
      !> Mean of x*s
      real(wp) :: barrier = 0.0_wp
      !> Power of the live load on the response to it
      real(wp) :: flexibility = 0.0_wp
      !> Change of x at unchanged s: (n_side, n_joint)
      real(wp), allocatable :: aim(:, :)
      !> Rates of opening by them: (n_side, n_joint)
      real(wp), allocatable :: unit_rate(:, :), rate(:, :)
      !> Direction: (n_side, n_joint), the same, (3, 0:n_block), and of the factor
      real(wp), allocatable :: dx(:, :), ds(:, :), dv(:, :)
      real(wp) :: dfactor = 0.0_wp
      !> Imbalance that the direction leaves, the largest that is accepted
      real(wp) :: left = 0.0_wp, accepted = 0.0_wp
   end type turn_t

   !> Share by which diagonal entries are raised
   real(wp), parameter :: lift = 1.0e-14_wp
   !> Stiffness of free rays over that of the others in the mean
   real(wp), parameter :: stiffness_of_free = 1.0e8_wp
   !> Share of the way to the border of the cones
   real(wp), parameter :: share_of_way = 0.995_wp

contains

   !> Work space of the turns
   pure subroutine begin_turns(rays, path, goal, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> What is asked for
      type(interior_goal_t), intent(in) :: goal
      !> The work space
      type(turn_t), intent(out) :: turn

      allocate (turn%lack, turn%rest, turn%unit_response, turn%response, turn%dv, &
         & source=0.0_wp*path%dead)
      allocate (turn%excess, turn%aim, turn%unit_rate, turn%rate, turn%dx, turn%ds, &
         & source=0.0_wp*rays%bounded)
      turn%least_factor = path%negligible/goal%tolerance
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
      real(wp) :: against, power

      turn%rest = path%dead + point%factor*path%live
      call add_ray_forces(rays, point%x, turn%rest)
      turn%lack = -turn%rest
      ! forces that hold one another may be so large that their rounding counts beside the loads
      point%imbalance = maxval(abs(turn%lack))/max(path%largest_dead, &
         & abs(point%factor)*path%largest_live, 1.0e-3_wp*maxval(abs(point%x)), tiny(power))
      call ray_rates(rays, point%v, turn%rate)
      turn%excess = point%s*rays%bounded - turn%rate
      power = maxval(abs(point%v))
      against = max(maxval(-turn%rate*rays%bounded), maxval(abs(turn%rate*rays%free)))
      point%violation = against/max(power, tiny(power))
      against = max(against, 0.0_wp) + epsilon(power)*power
      turn%barrier = sum(point%x*point%s*rays%bounded)/real(max(1, rays%n_bounded), wp)
      power = sum(path%live*point%v)
      turn%lack_of_power = 1.0_wp - power
      point%upper = no_limit
      if (power > 0.0_wp) point%upper = (against*sum(abs(point%x)) - sum(path%dead*point%v))/power
      point%gap = abs(point%upper - point%factor) &
         & /max(abs(point%factor), abs(point%upper), turn%least_factor, tiny(power))
   end subroutine see_residuals

   !> Factor the springs and find the direction to x*s = 0
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

      turn%accepted = max(min(1.0e-9_wp, 0.01_wp*point%gap)*path%largest_dead, &
         & 1.0e-13_wp*path%largest_dead, 0.05_wp*maxval(abs(turn%lack)))
      call set_stiffness(rays, point, springs)
      call set_springs(rays, lift, springs)
      if (springs%usable) call respond_to_live_load(rays, path, springs, turn)
      turn%aim = -point%x*rays%bounded
      call direct(rays, path, point, turn%accepted, springs, turn)
   end subroutine predict

   !> Stiffness of the springs along all rays
   pure subroutine set_stiffness(rays, point, springs)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The point
      type(interior_point_t), intent(in) :: point
      !> Receives it
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: mean

      mean = sum(point%x*rays%bounded)/max(sum(point%s*rays%bounded), tiny(mean))
      springs%stiffness = rays%bounded*point%x/point%s + rays%free*stiffness_of_free*mean
   end subroutine set_stiffness

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

      call solve_springs(rays, springs, path%live, turn%unit_response, turn%unit_rate)
      turn%flexibility = sum(path%live*turn%unit_response)
   end subroutine respond_to_live_load

   !> Direction to balance, compatibility and the aim; where that leaves too much, by a factor with
   !> more digits
   pure subroutine direct(rays, path, point, enough, springs, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The point
      type(interior_point_t), intent(in) :: point
      !> Imbalance that needs no correction
      real(wp), intent(in) :: enough
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Aim in, direction out
      type(turn_t), intent(inout) :: turn

      if (springs%usable) then
         call find_direction(rays, path, point, enough, springs, turn)
         if (turn%left <= turn%accepted .or. springs%is_wide) return
      end if
      call set_wide_springs(rays, springs)
      if (.not. springs%usable) return
      call respond_to_live_load(rays, path, springs, turn)
      call find_direction(rays, path, point, enough, springs, turn)
   end subroutine direct

   !> Direction to balance, compatibility and the aim; corrections follow until the imbalance that
   !> is left no longer halves
   pure subroutine find_direction(rays, path, point, enough, springs, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The point
      type(interior_point_t), intent(in) :: point
      !> Imbalance that needs no correction
      real(wp), intent(in) :: enough
      !> The matrix with a usable factor
      type(ray_matrix_t), intent(inout) :: springs
      !> Aim in, direction out
      type(turn_t), intent(inout) :: turn
      real(wp) :: before, imbalance
      integer :: correction

      turn%dv = 0.0_wp
      turn%dfactor = 0.0_wp
      turn%ds = -turn%excess
      turn%dx = turn%aim - springs%stiffness*turn%ds
      turn%rest = -turn%lack
      call add_ray_forces(rays, turn%dx, turn%rest)
      before = huge(before)
      turn%left = huge(before)
      do correction = 0, 3
         call balance_direction(rays, path, point, springs, turn)
         turn%rest = -turn%lack + turn%dfactor*path%live
         call add_ray_forces(rays, turn%dx, turn%rest)
         imbalance = maxval(abs(turn%rest))
         turn%left = min(turn%left, imbalance)
         if (.not. imbalance < 0.5_wp*before .or. imbalance < enough) exit
         before = imbalance
      end do
   end subroutine find_direction

   !> Correct a direction by the motion that balances what it leaves. The power of the rest on the
   !> mechanism is the factor's alone: taken out first, it leads to no large motion that would have
   !> to cancel
   pure subroutine balance_direction(rays, path, point, springs, turn)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The loads
      type(load_path_t), intent(in) :: path
      !> The point
      type(interior_point_t), intent(in) :: point
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Direction and the rest of its balance in, direction out
      type(turn_t), intent(inout) :: turn
      real(wp) :: step, taken

      taken = 0.0_wp
      if (turn%lack_of_power < 0.5_wp) taken = sum(turn%rest*point%v)/(1.0_wp - turn%lack_of_power)
      turn%rest = turn%rest - taken*path%live
      call solve_springs(rays, springs, turn%rest, turn%response, turn%rate)
      step = (turn%lack_of_power - sum(path%live*turn%dv) - sum(path%live*turn%response)) &
         & /turn%flexibility
      turn%response = turn%response + step*turn%unit_response
      turn%dfactor = turn%dfactor + step - taken
      turn%dv = turn%dv + turn%response
      turn%rate = turn%rate + step*turn%unit_rate
      turn%ds = turn%ds + turn%rate
      turn%dx = turn%dx - springs%stiffness*turn%rate
   end subroutine balance_direction

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
      call direct(rays, path, point, 1.0e-14_wp*path%largest_dead, springs, turn)
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

   !> Move along the direction, almost to the border
   pure subroutine move(rays, turn, point)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The direction
      type(turn_t), intent(in) :: turn
      !> The point
      type(interior_point_t), intent(inout) :: point
      real(wp) :: to_x, to_s

      call longest_steps(rays, point, turn, to_x, to_s)
      to_x = min(1.0_wp, share_of_way*to_x)
      to_s = min(1.0_wp, share_of_way*to_s)
      point%x = point%x + to_x*turn%dx
      point%factor = point%factor + to_x*turn%dfactor
      point%s = point%s + to_s*(turn%ds*rays%bounded)
      point%v = point%v + to_s*turn%dv
   end subroutine move
end module dda_interior_turn
