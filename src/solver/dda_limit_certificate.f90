!> Certificates from forces and velocities of a graph
!>
!> Forces that balance a load and keep the law of every joint prove that it can be carried;
!> velocities that no joint resists, on which the load has power, that it cannot. Moments are
!> compared with forces, and spins with velocities, by half the mean length of a joint.
module dda_limit_certificate
   use dda_interior_state, only : no_limit
   use dda_joint_graph, only : add_joint_forces, crushes, joint_graph_t, joint_kind, &
      & joint_motion, unit_of_length
   use dda_joint_strips, only : beyond_parabola
   use dda_kinds, only : wp
   implicit none
   private

   public :: check_forces, check_velocities, carried_factor, stopping_factor
   public :: balance_margin, crushing_power, flow_margin

   !> Closing rate of fibres below which it is round-off, over the fastest rate
   real(wp), parameter :: still = 1.0e-12_wp

contains

   !> Factor of the live load that forces carry best beside the dead load
   pure real(wp) function carried_factor(graph, dead, live, force) result(factor)
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: dead(:, :)
      !> Load added by a factor of one: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: live(:, :)
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      real(wp) :: left(size(dead, 1), size(dead, 2)), weight(3), size_of_live
      integer :: b

      left = dead
      call add_joint_forces(graph, force, left)
      weight = [1.0_wp, 1.0_wp, 1.0_wp/unit_of_length(graph)**2]
      factor = 0.0_wp
      size_of_live = 0.0_wp
      do b = 1, size(live, 2)
         factor = factor - sum(weight*live(:, b)*left(:, b))
         size_of_live = size_of_live + sum(weight*live(:, b)**2)
      end do
      factor = factor/max(size_of_live, tiny(factor))
   end function carried_factor

   !> Factor at which the loads have no power on a mechanism: above it they drive it
   pure real(wp) function stopping_factor(dead, live, velocity) result(factor)
      real(wp), intent(in) :: dead(:, :), live(:, :)
      real(wp), intent(in) :: velocity(:, :)  !! Velocities: (3, n_block) [m/s, m/s, 1/s]
      real(wp) :: power

      power = sum(live*velocity)
      factor = no_limit
      if (power > 0.0_wp) factor = -sum(dead*velocity)/power
   end function stopping_factor

   !> Residuals of forces: of the balance with a load, and of the law of the joints
   pure subroutine check_forces(graph, load, force, imbalance, violation, part)
      type(joint_graph_t), intent(in) :: graph
      !> Loads: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: force(:, :)
      !> Largest force or moment left on a block, over the largest load [1]
      real(wp), intent(out) :: imbalance
      !> Largest force beyond the law of a joint, over the largest load [1]
      real(wp), intent(out) :: violation
      !> A part of the load, which the others may cancel: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in), optional :: part(:, :)
      real(wp) :: left(size(load, 1), size(load, 2)), largest
      integer :: j

      left = load
      call add_joint_forces(graph, force, left)
      largest = larger_load(graph, load)
      if (present(part)) largest = max(largest, larger_load(graph, part))
      imbalance = larger_load(graph, left)/max(largest, tiny(largest))
      violation = 0.0_wp
      do j = 1, size(force, 2)
         violation = max(violation, beyond_law(graph%kind(j), graph%friction(j), force(:, j)))
      end do
      if (crushes(graph)) violation = max(violation, maxval(beyond_parabola(graph%crush, &
         & force(1, :), force(2, :))))
      violation = violation/max(largest, tiny(largest))
   end subroutine check_forces

   !> Power on a mechanism of what forces leave of a load, and of what lies beyond the strength of
   !> joints that the mechanism crushes: by so much per unit of the live load's power a factor that
   !> they carry may be too large, as the mechanism is the factor's slope in any load or strength
   pure real(wp) function balance_margin(graph, load, force, velocity) result(margin)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :), force(:, :), velocity(:, :)
      real(wp) :: left(size(load, 1), size(load, 2)), rate(3, size(graph%kind))

      left = load
      call add_joint_forces(graph, force, left)
      margin = sum(abs(left*velocity))
      if (.not. crushes(graph)) return
      call joint_motion(graph, velocity, rate)
      margin = margin + sum(beyond_parabola(graph%crush, force(1, :), force(2, :)) &
         & *(abs(rate(1, :) - rate(2, :)) + max(0.0_wp, -rate(1, :)) + max(0.0_wp, -rate(2, :))))
   end function balance_margin

   !> Power that forces would put into velocities where these close joints that cannot close: by so
   !> much per unit of the live load's power a factor that the velocities stop may be too small, as
   !> the forces are the factor's slope in any gap
   pure real(wp) function flow_margin(graph, force, velocity) result(margin)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: force(:, :), velocity(:, :)
      real(wp) :: rate(3, size(graph%kind)), fastest, slip
      integer :: j, k

      call joint_motion(graph, velocity, rate)
      fastest = maxval(abs(rate))
      margin = 0.0_wp
      do j = 1, size(rate, 2)
         slip = abs(rate(3, j))
         if (is_crushed(graph, j)) then
            margin = margin + 0.5_wp*abs(rate(1, j) - rate(2, j)) &
               & *beyond_parabola(graph%crush(j), force(1, j), force(2, j)) &
               & + sum(max(0.0_wp, force(1:2, j))*max(0.0_wp, min(still*fastest, &
               & merge(graph%friction(j), 0.0_wp, graph%kind(j) == joint_kind%contact)*slip &
               & - rate(1:2, j))))
            if (graph%kind(j) == joint_kind%no_slip) margin = margin + abs(force(3, j))*slip
            cycle
         end if
         select case (graph%kind(j))
         case (joint_kind%contact, joint_kind%corner)
            do k = 1, 2
               margin = margin + max(0.0_wp, force(k, j)) &
                  & *max(0.0_wp, graph%friction(j)*slip - rate(k, j))
            end do
         case (joint_kind%no_slip, joint_kind%corner_no_slip)
            margin = margin + abs(force(3, j))*slip &
               & + sum(max(0.0_wp, force(1:2, j))*max(0.0_wp, -rate(1:2, j)))
         case default
            margin = margin + sum(abs(force(:, j)*rate(:, j)))
         end select
      end do
   end function flow_margin

   !> True if a joint has a strength
   pure logical function is_crushed(graph, joint)
      type(joint_graph_t), intent(in) :: graph
      integer, intent(in) :: joint  !! Number of the joint

      is_crushed = allocated(graph%crush)
      if (is_crushed) is_crushed = graph%crush(joint) < huge(1.0_wp)
   end function is_crushed

   !> Power that joints take up at most as velocities crush them: their strength times the rate at
   !> which fibres along them close, as far as they do; sliding opens a joint by its friction
   pure real(wp) function crushing_power(graph, velocity) result(power)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: velocity(:, :)
      real(wp) :: rate(3, size(graph%kind)), close(2), least
      integer :: j

      power = 0.0_wp
      if (.not. crushes(graph)) return
      call joint_motion(graph, velocity, rate)
      least = still*maxval(abs(rate))
      do j = 1, size(rate, 2)
         if (.not. is_crushed(graph, j)) cycle
         close = -rate(1:2, j)
         if (graph%kind(j) == joint_kind%contact) close = close + graph%friction(j)*abs(rate(3, j))
         if (all(close <= least)) cycle
         if (any(close < 0.0_wp)) then
            ! the fibres beyond the one that keeps its length open
            power = power + graph%crush(j)*0.5_wp*maxval(close) &
               & *(maxval(close)/(maxval(close) - minval(close)))
         else
            power = power + graph%crush(j)*0.5_wp*sum(close)
         end if
      end do
   end function crushing_power

   !> Largest force or moment on a block that moves as a rigid body
   pure real(wp) function larger_load(graph, load) result(largest)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :)

      largest = 0.0_wp
      if (size(load, 2) > 0) largest = max(maxval(abs(load(1:2, :))), &
         & maxval(abs(load(3, :)))/unit_of_length(graph))
   end function larger_load

   !> Excess of the forces of one joint over its law [N/m]
   pure real(wp) function beyond_law(kind, friction, force) result(beyond)
      integer, intent(in) :: kind       !! Its kind, one of joint_kind
      real(wp), intent(in) :: friction  !! Coefficient of friction
      real(wp), intent(in) :: force(3)  !! N1, N2, T: (3)

      beyond = 0.0_wp
      associate (n1 => force(1), n2 => force(2), t => abs(force(3)))
         select case (kind)
         case (joint_kind%contact)
            beyond = max(0.0_wp, -n1, -n2, t - friction*(n1 + n2))
         case (joint_kind%no_slip)
            beyond = max(0.0_wp, -n1, -n2)
         case (joint_kind%corner)
            beyond = max(0.0_wp, -n1, abs(n2), t - friction*n1)
         case (joint_kind%corner_no_slip)
            beyond = max(0.0_wp, -n1, abs(n2))
         case (joint_kind%pin)
            beyond = abs(n2)
         case (joint_kind%mirror)
            beyond = t
         end select
      end associate
   end function beyond_law

   !> Residual of velocities as a mechanism, and the power of a load on them
   pure subroutine check_velocities(graph, load, velocity, violation, power)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: load(:, :), velocity(:, :)
      !> Largest rate at which a joint is closed that cannot close, over the largest velocity [1]
      real(wp), intent(out) :: violation
      !> Power of the load [W/m]
      real(wp), intent(out) :: power
      real(wp) :: rate(3, size(graph%kind)), largest
      integer :: j

      power = sum(load*velocity)
      call joint_motion(graph, velocity, rate)
      violation = 0.0_wp
      do j = 1, size(rate, 2)
         if (is_crushed(graph, j)) then
            if (graph%kind(j) == joint_kind%no_slip) violation = max(violation, abs(rate(3, j)))
         else
            violation = max(violation, beyond_flow(graph%kind(j), graph%friction(j), rate(:, j)))
         end if
      end do
      largest = maxval(abs(velocity(1:2, :)))
      largest = max(largest, unit_of_length(graph)*maxval(abs(velocity(3, :))))
      violation = violation/max(largest, tiny(largest))
   end subroutine check_velocities

   !> Speed of one joint against its resistance, along the worst of its forces whose normal part is
   !> one; of joints with much friction, whose shear part is one [m/s]
   pure real(wp) function beyond_flow(kind, friction, rate) result(beyond)
      integer, intent(in) :: kind
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: rate(3)  !! Opening 1, opening 2, slip: (3)

      beyond = 0.0_wp
      associate (o1 => rate(1), o2 => rate(2), slip => abs(rate(3)))
         select case (kind)
         case (joint_kind%contact)
            beyond = max(0.0_wp, friction*slip - min(o1, o2))/max(1.0_wp, friction)
         case (joint_kind%no_slip)
            beyond = max(0.0_wp, -o1, -o2, slip)
         case (joint_kind%corner)
            beyond = max(0.0_wp, friction*slip - o1)/max(1.0_wp, friction)
         case (joint_kind%corner_no_slip)
            beyond = max(0.0_wp, -o1, slip)
         case (joint_kind%pin)
            beyond = max(abs(o1), slip)
         case (joint_kind%mirror)
            beyond = max(abs(o1), abs(o2))
         end select
      end associate
   end function beyond_flow
end module dda_limit_certificate
