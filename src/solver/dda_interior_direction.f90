!> Directions of the interior-point method: barrier stiffness and corrections
!>
!> Corrections of the balance are added to the directions of x, v and the factor one by one, which
!> keeps the balance when the springs spread over many decades. Free rays have springs of a large
!> stiffness: each turn reduces their openings.
module dda_interior_direction
   use dda_interior_state, only : interior_point_t, load_path_t
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : add_ray_forces, sum_of_rays, n_side, ray_rates
   use dda_joint_strips, only : bear_strips, subtract_crushing, yield_strip
   use dda_kinds, only : wp
   use dda_ray_matrix, only : add_digits, ray_matrix_t, solve_springs
   implicit none
   private

   public :: turn_t
   public :: direct, direct_again, refine_direction, find_balance, respond_to_live_load, see_rest
   public :: add_yielding, see_yielding

   !> Working data of one turn
   type :: turn_t
      !> Imbalance, and right-hand sides: (3, 0:n_block)
      real(wp), allocatable :: lack(:, :), rest(:, :)
      !> Response to the live load, to the right-hand side: (3, 0:n_block)
      real(wp), allocatable :: unit_response(:, :), response(:, :)
      !> One less the power of the live load
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

contains

   !> Response of the springs to the live load
   pure subroutine respond_to_live_load(graph, path, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn

      call solve_springs(graph, springs, path%live, turn%unit_response, turn%unit_rate)
      turn%flexibility = sum(path%live*turn%unit_response)
      ! nor has a load that does no work a factor
      if (path%moves .or. .not. abs(turn%flexibility) > 0.0_wp) &
         & turn%flexibility = huge(turn%flexibility)
   end subroutine respond_to_live_load

   !> Direction to balance, compatibility and the aim
   pure subroutine direct(graph, path, point, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn  !! Aim in, direction out

      turn%left = huge(turn%left)
      if (springs%usable) call find_direction(graph, path, point, turn%accepted, springs, turn)
      call direct_again(graph, path, point, springs, turn)
   end subroutine direct

   !> The same by a factor with more digits if it leaves too much
   pure subroutine direct_again(graph, path, point, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn

      if (springs%asked_wide .or. .not. turn%left > turn%accepted) return
      call add_digits(graph, path%mass, springs)
      if (.not. springs%is_wide) return
      call respond_to_live_load(graph, path, springs, turn)
      call find_direction(graph, path, point, turn%accepted, springs, turn)
   end subroutine direct_again

   !> Direction to balance, compatibility and the aim
   pure subroutine find_direction(graph, path, point, enough, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      real(wp), intent(in) :: enough  !! Imbalance that needs no correction
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn

      turn%dv = 0.0_wp
      turn%dfactor = 0.0_wp
      ! rates less what velocities make of them are to go
      call ray_rates(graph, path%length, point%v, turn%rate)
      call subtract_crushing(path%strip, point%x, point%s, turn%rate)
      turn%ds = path%compliance*turn%aim &
         & - ((point%s - path%compliance*point%x)*path%bounded - turn%rate)
      turn%dx = turn%aim - springs%stiffness*turn%ds
      turn%ds = (1.0_wp - path%compliance*springs%stiffness)*turn%ds
      call begin_yielding(point, springs, turn)
      call see_rest(graph, path, turn)
      call balance_direction(graph, path, point, springs, turn)
      call refine_direction(graph, path, point, enough, springs, turn)
   end subroutine find_direction

   !> Let joints that crush yield to the first direction, and bring their strips to their forces
   pure subroutine begin_yielding(point, springs, turn)
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(in) :: springs
      type(turn_t), intent(inout) :: turn
      real(wp) :: force(3), y(2), more(n_side)
      integer :: i

      do i = 1, size(springs%strip)
         associate (strip => springs%strip(i), j => springs%strip(i)%joint, &
            & c => springs%strip(i)%place)
            force = sum_of_rays(strip%kind, strip%friction, turn%dx(:, j))
            call yield_strip(strip, force, turn%aim(:2, c) &
               & + point%x(:2, c) - bear_strips(strip, point%x), y, more)
            turn%ds(:, j) = turn%ds(:, j) + more
            turn%dx(:, j) = turn%dx(:, j) - springs%stiffness(:, j)*more
            turn%ds(:2, c) = y
            turn%dx(:2, c) = turn%aim(:2, c) - springs%stiffness(:2, c)*y
         end associate
      end do
   end subroutine begin_yielding

   !> Let joints that crush yield to a change of a direction
   pure subroutine see_yielding(springs, dx, turn, more)
      type(ray_matrix_t), intent(in) :: springs
      real(wp), intent(in) :: dx(:, :)       !! The direction of x before: (n_side, n_joint)
      type(turn_t), intent(inout) :: turn    !! That of x without yielding in, with it out
      !> Rates of yielding, of the joint and of its strip: (n_side, 2, n_strip)
      real(wp), intent(out) :: more(:, :, :)
      real(wp) :: force(3)
      integer :: i

      more = 0.0_wp
      do i = 1, size(springs%strip)
         associate (strip => springs%strip(i), j => springs%strip(i)%joint, &
            & c => springs%strip(i)%place)
            force = sum_of_rays(strip%kind, strip%friction, turn%dx(:, j) - dx(:, j))
            call yield_strip(strip, force, turn%dx(:2, c) - dx(:2, c), &
               & more(:2, 2, i), more(:, 1, i))
            turn%dx(:, j) = turn%dx(:, j) - springs%stiffness(:, j)*more(:, 1, i)
            turn%dx(:, c) = turn%dx(:, c) - springs%stiffness(:, c)*more(:, 2, i)
         end associate
      end do
   end subroutine see_yielding

   !> Add rates of yielding to the rates, whose part of the direction of x follows
   pure subroutine add_yielding(springs, more, turn)
      type(ray_matrix_t), intent(in) :: springs
      real(wp), intent(in) :: more(:, :, :)  !! Rates of yielding: (n_side, 2, n_strip)
      type(turn_t), intent(inout) :: turn
      integer :: i

      do i = 1, size(springs%strip)
         associate (j => springs%strip(i)%joint, c => springs%strip(i)%place)
            turn%rate(:, j) = turn%rate(:, j) + more(:, 1, i)
            turn%rate(:, c) = turn%rate(:, c) + more(:, 2, i)
            turn%dx(:, j) = turn%dx(:, j) + springs%stiffness(:, j)*more(:, 1, i)
            turn%dx(:, c) = turn%dx(:, c) + springs%stiffness(:, c)*more(:, 2, i)
         end associate
      end do
   end subroutine add_yielding

   !> Balance a direction again until the imbalance that is left no longer halves
   pure subroutine refine_direction(graph, path, point, enough, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      real(wp), intent(in) :: enough
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn
      integer, parameter :: max_correction = 3
      real(wp) :: before
      integer :: correction

      before = huge(before)
      do correction = 0, max_correction
         call see_rest(graph, path, turn)
         turn%left = min(before, maxval(abs(turn%rest)))
         if (turn%left < enough .or. .not. turn%left < 0.5_wp*before) exit
         if (correction == max_correction) exit
         before = turn%left
         call balance_direction(graph, path, point, springs, turn)
      end do
   end subroutine refine_direction

   !> Imbalance after a direction
   pure subroutine see_rest(graph, path, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(turn_t), intent(inout) :: turn  !! The direction; receives the rest

      call begin_rest(size(turn%rest), turn%lack, turn%dfactor, path%live, path%mass, turn%dv, &
         & turn%rest)
      call add_ray_forces(graph, path%length, turn%dx, turn%rest)
   end subroutine see_rest

   !> Imbalance of loads and masses alone. Arrays are flat here and below, so that a loop is one
   pure subroutine begin_rest(n, lack, factor, live, mass, dv, rest)
      integer, intent(in) :: n             !! Numbers of each array
      real(wp), intent(in) :: lack(n)      !! Imbalance
      real(wp), intent(in) :: factor       !! Change of the factor
      real(wp), intent(in) :: live(n)      !! The live load
      real(wp), intent(in) :: mass(n)      !! The masses
      real(wp), intent(in) :: dv(n)        !! The direction of v
      real(wp), intent(out) :: rest(n)     !! Remaining imbalance

      rest = -lack + factor*live - mass*dv
   end subroutine begin_rest

   !> Correct a direction by the motion that balances the rest that it leaves
   pure subroutine balance_direction(graph, path, point, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn

      call find_balance(graph, path, point, springs, turn)
      turn%ds = turn%ds + (1.0_wp - path%compliance*springs%stiffness)*turn%rate
      turn%dx = turn%dx - springs%stiffness*turn%rate
   end subroutine balance_direction

   !> The motion that balances the rest that a direction leaves, and its rates: of the direction all
   !> but the changes of x and s by these. The power of the rest on the mechanism is the factor's
   !> alone: taken out first, it leads to no large motion that would have
   !> to cancel
   pure subroutine find_balance(graph, path, point, springs, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(inout) :: springs
      type(turn_t), intent(inout) :: turn
      real(wp) :: step, taken
      integer :: n

      n = size(turn%dv)
      taken = 0.0_wp
      if (turn%lack_of_power < 0.5_wp) &
         & taken = power_of(n, turn%rest, point%v)/(1.0_wp - turn%lack_of_power)
      call add_multiple(n, -taken, path%live, turn%rest)
      call solve_springs(graph, springs, turn%rest, turn%response, turn%rate)
      step = (turn%lack_of_power - power_of(n, path%live, turn%dv) &
         & - power_of(n, path%live, turn%response))/turn%flexibility
      call add_multiple(n, step, turn%unit_response, turn%response)
      turn%dfactor = turn%dfactor + step - taken
      call add_multiple(n, 1.0_wp, turn%response, turn%dv)
      call add_multiple(size(turn%rate), step, turn%unit_rate, turn%rate)
   end subroutine find_balance

   !> Power of forces on velocities
   pure real(wp) function power_of(n, force, velocity) result(power)
      integer, intent(in) :: n            !! Numbers of each
      real(wp), intent(in) :: force(n)    !! The forces
      real(wp), intent(in) :: velocity(n) !! The velocities

      power = sum(force*velocity)
   end function power_of

   !> sum = sum + factor*more
   pure subroutine add_multiple(n, factor, more, sum)
      integer, intent(in) :: n           !! Number of values
      real(wp), intent(in) :: factor     !! The factor
      real(wp), intent(in) :: more(n)    !! Summand
      real(wp), intent(inout) :: sum(n)  !! The sum

      sum = sum + factor*more
   end subroutine add_multiple
end module dda_interior_direction
