!> One iteration of the interior-point method: barrier stiffness, predictor, corrector
!>
!> Equation (M6) of docs/method.md
module dda_interior_turn
   use dda_interior_direction, only : add_yielding, direct, direct_again, find_balance, &
      & refine_direction, respond_to_live_load, see_rest, see_yielding, turn_t
   use dda_interior_state, only : interior_goal_t, interior_point_t, load_path_t, no_limit
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : add_ray_forces, n_side, ray_rates
   use dda_joint_strips, only : see_strips, strip_hurry, strip_lack, strip_power, subtract_crushing
   use dda_kinds, only : wp
   use dda_ray_matrix, only : ray_matrix_t, set_springs
   use, intrinsic :: iso_fortran_env, only : int8
   implicit none
   private

   public :: lift, begin_turns, see_residuals, predict, correct, move

   !> Relative shift of diagonal entries
   real(wp), parameter :: lift = 1.0e-14_wp
   !> Stiffness of free rays over the mean of the others
   real(wp), parameter :: stiffness_of_free = 1.0e8_wp
   !> Step over the distance to the boundary of the cones
   real(wp), parameter :: share_of_way = 0.995_wp
   !> Maximum number of centrality corrections, their step increase, and a sufficient step
   integer, parameter :: max_centring = 3
   real(wp), parameter :: longer = 0.3_wp, long_enough = 0.9_wp
   !> Least increase of both steps for a further correction
   real(wp), parameter :: worthwhile = 0.03_wp
   !> Step below which all products move to half their mean
   real(wp), parameter :: short = 0.1_wp, half = 0.5_wp
   !> Parts of a correction that are tried
   integer, parameter :: n_share = 10
   !> Range of products, over their target, without correction
   real(wp), parameter :: least_product = 0.1_wp, largest_product = 10.0_wp

   !> Aims of the products x*s at the end of a step
   type :: centring_enum
      integer :: equal = 0    !! One product, with the second order of the direction before
      integer :: within = 1   !! Multiples of it, where they lie beyond them
      integer :: inwards = 2  !! One product, of the point itself
   end type centring_enum

   !> Names of these
   type(centring_enum), parameter :: centring = centring_enum()

   !> Aim of a correction
   type :: centring_t
      !> One of centring
      integer :: kind = centring%equal
      !> The product
      real(wp) :: product = 0.0_wp
      !> Steps of forces and of rates at whose ends products are computed: (2)
      real(wp) :: further(2) = 0.0_wp
   end type centring_t

contains

   !> Work space of the turns
   pure subroutine begin_turns(path, goal, turn)
      type(load_path_t), intent(in) :: path
      type(interior_goal_t), intent(in) :: goal
      type(turn_t), intent(out) :: turn

      allocate (turn%lack, turn%rest, turn%unit_response, turn%response, turn%dv, mold=path%dead)
      turn%lack = 0.0_wp
      turn%rest = 0.0_wp
      turn%unit_response = 0.0_wp
      turn%response = 0.0_wp
      turn%dv = 0.0_wp
      allocate (turn%aim(n_side, size(path%bounded, 2)))
      allocate (turn%unit_rate, turn%rate, turn%dx, turn%ds, mold=turn%aim)
      turn%least_factor = path%negligible/goal%tolerance
   end subroutine begin_turns

   !> Balance, compatibility and the gap at a point
   pure subroutine see_residuals(graph, path, point, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(inout) :: point  !! The point; receives the figures
      type(turn_t), intent(inout) :: turn
      real(wp) :: against, power

      turn%rest = path%dead + point%factor*path%live - path%mass*point%v
      call add_ray_forces(graph, path%length, point%x, turn%rest)
      turn%lack = -turn%rest
      ! forces that hold one another may be so large that their rounding counts beside the loads
      power = max(maxval(abs(turn%lack)), strip_lack(path%strip, point%x))
      point%imbalance = power/max(path%largest_dead, abs(point%factor)*path%largest_live, &
         & 1.0e-3_wp*maxval(abs(point%x)), tiny(power))
      call ray_rates(graph, path%length, point%v, turn%rate)
      call subtract_crushing(path%strip, point%x, point%s, turn%rate)
      power = maxval(abs(point%v))
      against = against_all(path, turn%rate)
      point%violation = against/max(power, tiny(power))
      turn%barrier = sum(point%x*point%s, path%bounded > 0)/path%n_bounded
      power = sum(path%live*point%v)
      turn%lack_of_power = 1.0_wp - power
      point%upper = no_limit
      if (power > 0.0_wp) then
         point%upper = (power_against(graph, path, point, turn%rate) - sum(path%dead*point%v) &
            & + strip_power(path%strip, point%x, point%s))/power
         ! forces that carry more may be larger where joints are violated
         point%margin = (max(against, 0.0_wp) + epsilon(power)*maxval(abs(point%v))) &
            & *sum(abs(point%x))/power
      end if
      point%gap = abs(point%upper - point%factor) &
         & /max(abs(point%factor), abs(point%upper), turn%least_factor, tiny(power))
      if (path%moves) point%gap = sum(point%x*abs(turn%rate)*path%bounded) &
         & /max(abs(sum(path%dead*point%v)), tiny(power))
   end subroutine see_residuals

   !> Power that forces put into rates that they forbid, each with the rounding of its own blocks:
   !> forces that hold one another may be large where nothing moves
   pure real(wp) function power_against(graph, path, point, rate) result(power)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      real(wp), intent(in) :: rate(:, :)  !! Rates along the rays: (n_side, n_joint)
      real(wp) :: rounding
      integer :: j

      power = 0.0_wp
      do j = 1, size(rate, 2)
         rounding = epsilon(rounding)*max(maxval(abs(point%v(:, graph%block(1, j)))), &
            & maxval(abs(point%v(:, graph%block(2, j)))))
         power = power + sum(abs(point%x(:, j))*(rounding + against_ray(path, rate, j)))
      end do
   end function power_against

   !> Rates that forces along the rays of a joint forbid
   pure function against_ray(path, rate, j) result(against)
      type(load_path_t), intent(in) :: path
      real(wp), intent(in) :: rate(:, :)
      integer, intent(in) :: j       !! Number of the joint
      real(wp) :: against(n_side)

      if (path%has_others) then
         against = max(-rate(:, j)*path%bounded(:, j), abs(rate(:, j)*path%free(:, j)))
      else
         against = max(-rate(:, j), 0.0_wp)
      end if
   end function against_ray

   !> The largest of all rates that forces forbid
   pure real(wp) function against_all(path, rate) result(largest)
      type(load_path_t), intent(in) :: path
      real(wp), intent(in) :: rate(:, :)
      integer :: j

      largest = 0.0_wp
      do j = 1, size(rate, 2)
         largest = max(largest, maxval(against_ray(path, rate, j)))
      end do
   end function against_all

   !> Factor the springs and find the direction to x*s = 0
   pure subroutine predict(graph, path, springs, point, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(in) :: point
      type(turn_t), intent(inout) :: turn

      turn%accepted = max(min(1.0e-9_wp, 0.01_wp*point%gap)*path%largest_dead, &
         & 1.0e-13_wp*path%largest_dead, 0.05_wp*maxval(abs(turn%lack)))
      call set_stiffness(path, point, springs)
      call see_strips(point%x, point%s, springs%strip)
      call set_springs(graph, path%mass, lift, springs)
      if (springs%usable) call respond_to_live_load(graph, path, springs, turn)
      turn%aim = -point%x*path%bounded
      call direct(graph, path, point, springs, turn)
   end subroutine predict

   !> Stiffness of the springs along all rays
   pure subroutine set_stiffness(path, point, springs)
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: mean

      mean = sum(point%x*path%bounded)/max(sum(point%s*path%bounded), tiny(mean))
      springs%stiffness = path%bounded*point%x/(point%s + path%compliance*point%x) &
         & + path%free*stiffness_of_free*mean
   end subroutine set_stiffness

   !> Direction to equal products x*s, with the second order of the predictor; then products that
   !> would be far smaller or far larger than the others at the end of somewhat longer steps are
   !> corrected (Gondzio 1996)
   pure subroutine correct(graph, path, goal, springs, point, turn)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(interior_goal_t), intent(in) :: goal
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(in) :: point
      type(turn_t), intent(inout) :: turn  !! Predictor in, direction out
      type(centring_t) :: wish
      real(wp) :: reach(2), before(2)
      integer :: i

      reach = longest_steps(path, point, turn)
      wish%product = aimed_product(path, goal, point, turn, reach)
      call add_correction(graph, path, wish, springs, point, turn, reach)
      wish%kind = centring%within
      do i = 1, max_centring
         if (minval(reach) > long_enough) exit
         before = reach
         wish%further = min(1.0_wp, reach + longer)
         call add_correction(graph, path, wish, springs, point, turn, reach)
         if (sum(reach) < sum(before) + worthwhile) exit
      end do
      wish%kind = centring%inwards
      wish%product = half*turn%barrier
      if (minval(reach) < short) call add_correction(graph, path, wish, springs, point, turn, reach)
      call refine_direction(graph, path, point, 1.0e-12_wp*path%largest_dead, springs, turn)
      call direct_again(graph, path, point, springs, turn)
   end subroutine correct

   !> The product x*s that a turn aims at
   pure real(wp) function aimed_product(path, goal, point, turn, reach) result(product)
      type(load_path_t), intent(in) :: path
      type(interior_goal_t), intent(in) :: goal
      type(interior_point_t), intent(in) :: point
      type(turn_t), intent(in) :: turn
      real(wp), intent(in) :: reach(2)  !! Steps along it
      real(wp) :: after, share

      ! where every force may have any sign there is nothing to aim at
      product = 0.0_wp
      if (.not. turn%barrier > 0.0_wp) return
      after = sum((point%x + reach(1)*turn%dx)*(point%s + reach(2)*turn%ds)*path%bounded) &
         & /path%n_bounded
      share = min(1.0_wp, (after/turn%barrier)**3)
      share = max(share, min(1.0_wp, 0.02_wp*goal%tolerance*abs(point%factor) &
         & /(path%n_bounded*turn%barrier)))
      product = share*turn%barrier
   end function aimed_product

   !> Change of x that a correction aims at. Arrays are flat here and below, so that a loop is one
   pure subroutine change_aim(n, wish, x, s, dx, ds, aim, change)
      integer, intent(in) :: n                    !! Number of rays
      type(centring_t), intent(in) :: wish
      real(wp), intent(in) :: x(n), s(n), dx(n), ds(n), aim(n)  !! Point, direction before, its aim
      real(wp), intent(out) :: change(n)          !! The change

      select case (wish%kind)
      case (centring%equal)
         change = (wish%product - dx*ds)/s
      case (centring%within)
         change = (x + wish%further(1)*dx)*(s + wish%further(2)*ds)
         change = max(-largest_product*wish%product, min(max(change, &
            & least_product*wish%product), largest_product*wish%product) - change)/s
      case default
         change = wish%product/s - x - aim
      end select
   end subroutine change_aim

   !> Change the aim of a direction, and take as much of that as makes the steps longest
   !> (Colombo and Gondzio 2008)
   pure subroutine add_correction(graph, path, wish, springs, point, turn, reach)
      type(joint_graph_t), intent(in) :: graph
      type(load_path_t), intent(in) :: path
      type(centring_t), intent(in) :: wish
      type(ray_matrix_t), intent(inout) :: springs
      type(interior_point_t), intent(in) :: point
      type(turn_t), intent(inout) :: turn
      real(wp), intent(out) :: reach(2)
      real(wp), dimension(n_side, size(turn%dx, 2)) :: change, dx
      real(wp) :: more(n_side, 2, size(springs%strip))
      real(wp) :: dv(3, 0:graph%n_block), dfactor, share, steps(2, n_share)
      integer :: i, best

      dx = turn%dx
      dv = turn%dv
      dfactor = turn%dfactor
      call change_aim(size(dx), wish, point%x, point%s, dx, turn%ds, turn%aim, change)
      if (path%has_others) change = change*path%bounded
      turn%dx = dx + change*(1.0_wp - path%compliance*springs%stiffness)
      call see_yielding(springs, dx, turn, more)
      call see_rest(graph, path, turn)
      call find_balance(graph, path, point, springs, turn)
      call add_yielding(springs, more, turn)
      call follow_rates(size(dx), path%compliance, springs%stiffness, dx, turn%ds, turn%dx, &
         & turn%rate)
      steps = steps_of_shares(path, point, turn, dx)
      best = n_share
      do i = n_share - 1, 1, -1
         if (product(steps(:, i)) > 1.02_wp*product(steps(:, best))) best = i
      end do
      reach = steps(:, best)
      share = real(best, wp)/real(n_share, wp)
      turn%aim = turn%aim + share*change
      call take_share(size(dx), 1.0_wp - share, dx, turn%dx)
      call take_share(size(dx), share, turn%rate, turn%ds)
      call take_share(size(dv), 1.0_wp - share, dv, turn%dv)
      turn%dfactor = dfactor + share*(turn%dfactor - dfactor)
   end subroutine add_correction

   !> Change the direction of x by the rates, and put that of s in their place
   pure subroutine follow_rates(n, compliance, stiffness, before, ds, dx, rate)
      integer, intent(in) :: n
      real(wp), intent(in) :: compliance, stiffness(n)  !! Those of the path and of the springs
      real(wp), intent(in) :: before(n), ds(n)          !! The direction before
      real(wp), intent(inout) :: dx(n), rate(n)         !! The directions out
      real(wp) :: other
      integer :: i

      do i = 1, n
         other = dx(i) - before(i)
         dx(i) = dx(i) - stiffness(i)*rate(i)
         rate(i) = ds(i) + compliance*other + (1.0_wp - compliance*stiffness(i))*rate(i)
      end do
   end subroutine follow_rates

   !> Go a share of the way to other numbers
   pure subroutine take_share(n, share, other, number)
      integer, intent(in) :: n              !! Number of values
      real(wp), intent(in) :: share, other(n)  !! The share, and the others
      real(wp), intent(inout) :: number(n)  !! The numbers

      number = number + share*(other - number)
   end subroutine take_share

   !> Longest steps along a direction of which the first, second ... n_share-th part of what the
   !> turn changed is taken
   pure function steps_of_shares(path, point, turn, dx) result(steps)
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      !> The direction of x, that of s before, and in the place of its rates the one of s
      type(turn_t), intent(in) :: turn
      real(wp), intent(in) :: dx(:, :)  !! The direction of x before: (n_side, n_joint)
      real(wp) :: steps(2, n_share)     !! Steps of forces and of rates: (2, n_share)
      real(wp) :: hurry(n_share, 2)
      integer :: j, k

      hurry = share_of_way
      do j = 1, size(dx, 2)
         do k = 1, n_side
            ! most are far from their bounds with any part
            if (min(dx(k, j), turn%dx(k, j)) < -share_of_way*point%x(k, j)) call hurry_by( &
               & path%bounded(k, j), point%x(k, j), dx(k, j), turn%dx(k, j), hurry(:, 1))
            if (min(turn%ds(k, j), turn%rate(k, j)) < -share_of_way*point%s(k, j)) call hurry_by( &
               & path%bounded(k, j), point%s(k, j), turn%ds(k, j), turn%rate(k, j), hurry(:, 2))
         end do
      end do
      steps = 1.0_wp/transpose(hurry)
   end function steps_of_shares

   !> Inverse of the longest steps of a ray, with each part of a change of its direction
   pure subroutine hurry_by(bounded, from, before, after, hurry)
      integer(int8), intent(in) :: bounded     !! One if it has a bound
      real(wp), intent(in) :: from             !! Its force, or its rate
      real(wp), intent(in) :: before, after    !! The direction without the change, and with all
      real(wp), intent(inout) :: hurry(:)      !! One over the longest steps: (n_share)
      integer :: i

      if (bounded == 0_int8) return
      do i = 1, n_share
         hurry(i) = max(hurry(i), -(before + real(i, wp)/real(n_share, wp)*(after - before))/from)
      end do
   end subroutine hurry_by

   !> Longest steps of forces and of rates along the direction, at most 1, that keep them inside
   !> their bounds
   pure function longest_steps(path, point, turn) result(reach)
      type(load_path_t), intent(in) :: path
      type(interior_point_t), intent(in) :: point
      type(turn_t), intent(in) :: turn
      real(wp) :: reach(2)  !! Steps
      real(wp) :: hurry(2)
      integer :: j, k

      hurry = max(share_of_way, [strip_hurry(path%strip, point%x, turn%dx), 0.0_wp])
      do j = 1, size(turn%dx, 2)
         do k = 1, n_side
            if (turn%dx(k, j) < -hurry(1)*point%x(k, j) .and. path%bounded(k, j) > 0) &
               & hurry(1) = max(hurry(1), -turn%dx(k, j)/point%x(k, j))
            if (turn%ds(k, j) < -hurry(2)*point%s(k, j) .and. path%bounded(k, j) > 0) &
               & hurry(2) = max(hurry(2), -turn%ds(k, j)/point%s(k, j))
         end do
      end do
      reach = 1.0_wp/hurry
   end function longest_steps

   !> Move along the direction, almost to the border
   pure subroutine move(path, turn, point)
      type(load_path_t), intent(in) :: path
      type(turn_t), intent(in) :: turn
      type(interior_point_t), intent(inout) :: point
      real(wp) :: reach(2)

      reach = share_of_way*longest_steps(path, point, turn)
      ! with masses, forces and accelerations balance together, and with curvature
      if (path%moves .or. size(path%strip) > 0) reach = minval(reach)
      point%x = point%x + reach(1)*turn%dx
      point%factor = point%factor + reach(1)*turn%dfactor
      point%s = point%s + reach(2)*(turn%ds*path%bounded)
      point%v = point%v + reach(2)*turn%dv
   end subroutine move
end module dda_interior_turn
