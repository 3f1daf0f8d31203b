!> The loading path under Coulomb friction: dead loads at once, live loads from event to event, with
!> the history of slip
!>
!>    call new_path(graph, load, path)
!>    call apply_dead_load(dead_load, path, state, result)
!>    call follow_path(path, state, rate, h_end, result)
!>
!> Forces that balance a load may exist where no way leads to them. So a load is followed: between
!> two events, at which a joint opens, closes or begins to slide, everything grows in proportion,
!> and each event is a small change of the equations. Where no rates go on from an event the blocks
!> move at a fixed load until they find balance (a jump) or fall. The first load at which they fall
!> is the collapse; a state in balance can go on with any other rate.
!>
!> Joints that break are loaded from nothing by what is dead, too.
!>
!> Equation (M4) of docs/method.md
module dda_loading_path
   use dda_coulomb_equations, only : coulomb_equations_t, new_coulomb_equations
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, in_metres, in_motion_units, &
      & in_newtons, in_units, set_force_unit, shear_role, take_coulomb_joints
   use dda_coulomb_law, only : coulomb_state_t, imbalance, shear_limit, strength, unloaded_state
   use dda_crushed_joint, only : reserve
   use dda_joint_graph, only : breaks, joint_graph_t
   use dda_kinds, only : wp
   use dda_load_jump, only : balance_rest, far_factor, jump_t, motion_end, moves_unbalanced
   use dda_path_event, only : path_end
   implicit none
   private

   public :: loading_path_t, path_rate_t, path_result_t, path_reason, path_reason_enum
   public :: apply_dead_load, follow_path, new_path, load_at_once

   !> Proof of a collapse, or cause of a missing decision
   type :: path_reason_enum
      integer :: none = 0              !! The end was reached
      integer :: mechanism = 1         !! A motion that nothing stops and that the load drives
      integer :: far_motion = 2        !! A motion ten thousand times as large as the dead load's
      integer :: unsettled_motion = 3  !! A motion at a fixed load did not settle
      integer :: too_many = 4          !! Too many events
      integer :: too_costly = 5        !! Too many factorisations
      integer :: no_balance = 6        !! Forces at its end break a law or do not balance the load
   end type path_reason_enum

   !> Names of the reasons
   type(path_reason_enum), parameter :: path_reason = path_reason_enum()

   !> Data that are made once per assembly
   type :: loading_path_t
      private
      !> Its joints in units of their own
      type(coulomb_joints_t) :: joints
      !> Their equations
      type(coulomb_equations_t) :: equations
      !> Largest displacement of the first state over its largest force, 1 at least; 0 before it
      real(wp) :: softness = 0.0_wp
      !> Largest gap of the first state, and what supports that move have opened since
      real(wp) :: given = 0.0_wp
      !> Largest changes of forces by the jumps so far, which are unrelated: root of the sum of
      !> their squares [N/m]
      real(wp) :: jumped = 0.0_wp
      !> Factorisations that it may take under the dead load, and from there to an end
      integer, public :: most_factorisations = 0
   end type loading_path_t

   !> Growing load of a path
   type :: path_rate_t
      !> Load: (3, n_block) [N/m, N/m, N]
      real(wp), allocatable :: load(:, :)
      !> Opening 1, opening 2 and slip where supports move, else unallocated: (3, n_joint) [m]
      real(wp), allocatable :: opening(:, :)
   end type path_rate_t

   !> Result of a path
   type :: path_result_t
      !> One of path_end
      integer :: end = 0
      !> One of path_reason
      integer :: reason = 0
      !> Its length, as a multiple of the rate
      real(wp) :: reached = 0.0_wp
      !> Joints that changed what they do
      integer :: n_event = 0
      !> Its length up to each jump to another state at the same load: (n)
      real(wp), allocatable :: jump(:)
      !> Largest displacement of a jump [m]
      real(wp) :: largest_jump = 0.0_wp
      !> Growth beyond its length in which joints that crush may still find balance
      real(wp) :: rest = 0.0_wp
      !> Length of its last step, and largest rate of motion over the motion there
      real(wp) :: step = 0.0_wp, haste = 0.0_wp
      !> Growth that changes a force as much as the jumps have changed some, here and before
      real(wp) :: spread = 0.0_wp
      !> Factorisations
      integer :: n_factorisation = 0
      !> Velocities of the collapse, the largest 1: (3, n_block) [1, 1, 1/m]; without
      !> entries if there is none
      real(wp), allocatable :: mechanism(:, :)
   end type path_result_t

   !> Least damping above round-off
   real(wp), parameter :: least_damping = 1.1e-14_wp
   !> Imbalance and violation of a law over the largest force of a state that is an answer
   real(wp), parameter :: negligible = 1.0e-9_wp
   !> Maximum number of factorisations, plus one per joint
   integer, parameter :: least_factorisations = 10000

   interface

      !> Measure the compliance of an assembly: the motion of its blocks by a load while no joint
      !> changes. Tall columns bend so far that damping which is negligible for others would hold
      !> them
      pure module subroutine see_softness(joints, equations, load, state)
         type(coulomb_joints_t), intent(in) :: joints
         type(coulomb_equations_t), intent(inout) :: equations  !! Receive their damping at rest
         real(wp), intent(in) :: load(:, :)                     !! Growing load: (3, n_block)
         type(coulomb_state_t), intent(in) :: state
      end subroutine see_softness

      !> State under a load that is applied at once
      pure module subroutine load_at_once(joints, equations, load, state, jump, end)
         type(coulomb_joints_t), intent(inout) :: joints
         type(coulomb_equations_t), intent(inout) :: equations
         real(wp), intent(in) :: load(:, :)   !! The load: (3, n_block)
         type(coulomb_state_t), intent(out) :: state
         type(jump_t), intent(inout) :: jump  !! Output of a motion, where one was needed
         integer, intent(out) :: end          !! Its end, one of motion_end
      end subroutine load_at_once

      !> From event to event, with jumps, which have rates of their own, where no rates go on
      pure module subroutine follow(path, first, way, h_end, state, result)
         type(loading_path_t), intent(inout) :: path
         real(wp), intent(in) :: first(:, :)  !! Load at the beginning: (3, n_block)
         !> Growing load, in units of the joints; the largest force is one
         type(path_rate_t), intent(in) :: way
         real(wp), intent(in) :: h_end        !! Required multiple of it
         type(coulomb_state_t), intent(inout) :: state
         type(path_result_t), intent(inout) :: result
      end subroutine follow

      !> Result of a path that ends by a collapse, or by a motion that did not converge
      pure module subroutine note_fall(end, jump, result)
         integer, intent(in) :: end  !! End of the motion
         type(jump_t), intent(in) :: jump
         type(path_result_t), intent(inout) :: result
      end subroutine note_fall

      !> A state whose joints do not crush, at a share of its load at which they crush by little
      pure module subroutine begin_to_crush(path, state, share, settled)
         type(loading_path_t), intent(inout) :: path
         type(coulomb_state_t), intent(inout) :: state
         real(wp), intent(out) :: share   !! The share of its load
         logical, intent(out) :: settled  !! True if forces balance that
      end subroutine begin_to_crush

   end interface

contains

   !> Data that are made once per assembly
   pure subroutine new_path(graph, load, path)
      !> Its joints; the path moves them
      type(joint_graph_t), intent(inout) :: graph
      !> A load that it carries, for the scale of forces: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: load(:, :)
      type(loading_path_t), intent(out) :: path

      call take_coulomb_joints(graph, load, path%joints)
      call new_coulomb_equations(path%joints, path%equations)
      path%most_factorisations = least_factorisations + size(path%joints%shear_role)
   end subroutine new_path

   !> The state under the dead load, with which a path begins
   pure subroutine apply_dead_load(dead_load, path, state, result)
      !> The load: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: dead_load(:, :)
      type(loading_path_t), intent(inout) :: path
      !> The state, where one was reached
      type(coulomb_state_t), intent(out) :: state
      !> Its result; "reached" is 1 for the whole load
      type(path_result_t), intent(out) :: result
      type(coulomb_joints_t) :: joints
      type(jump_t) :: jump
      type(path_rate_t) :: rate
      real(wp) :: share
      integer :: end
      logical :: settled

      if (breaks(path%joints%graph)) then
         ! what breaks, and when, depends on how the load grows
         rate%load = dead_load
         state = unloaded_state(path%joints)
         state%gap = state%gap*path%joints%motion_unit
         call follow_path(path, state, rate, 1.0_wp, result)
         path%softness = 0.0_wp
         return
      end if
      allocate (result%jump(0))
      path%equations%most_factorisations = path%most_factorisations
      ! without strength they have no unit of force, so that all of the load is one way
      joints = path%joints
      if (allocated(joints%share)) deallocate (joints%share)
      call load_at_once(joints, path%equations, in_units(path%joints, dead_load), state, jump, end)
      result%end = path_end%reached
      result%reason = path_reason%none
      result%reached = 1.0_wp
      share = 1.0_wp
      if (end == motion_end%balanced .and. allocated(path%joints%share)) then
         call begin_to_crush(path, state, share, settled)
         if (.not. settled) end = motion_end%unsettled
      end if
      if (end /= motion_end%balanced) call note_fall(end, jump, result)
      if (result%end == path_end%reached) call end_in_balance(path, state, result)
      call finish(path, state, result)
      if (result%end /= path_end%reached .or. .not. share < 1.0_wp) return
      rate%load = dead_load - state%load
      call follow_path(path, state, rate, 1.0_wp, result)
      path%softness = 0.0_wp
   end subroutine apply_dead_load

   !> Follow a load, or supports that move, from a state in balance
   pure subroutine follow_path(path, state, rate, h_end, result)
      !> Data that were made once
      type(loading_path_t), intent(inout) :: path
      !> In: a state in balance; out: the last one in balance on the way, with what has broken in
      !> the collapse
      type(coulomb_state_t), intent(inout) :: state
      type(path_rate_t), intent(in) :: rate
      !> Required multiple of it
      real(wp), intent(in) :: h_end
      type(path_result_t), intent(out) :: result
      type(path_rate_t) :: way
      real(wp) :: first(3, size(rate%load, 2)), before(3, size(state%force, 2)), scale

      allocate (result%jump(0))
      path%equations%base%n_factorisation = 0
      path%equations%most_factorisations = path%most_factorisations
      if (.not. path%joints%has_weight) call set_force_unit(path%joints, rate%load)
      state%motion = in_motion_units(path%joints, state%motion)
      state%load = in_units(path%joints, state%load)
      state%force = state%force/path%joints%force_unit
      state%gap = state%gap/path%joints%motion_unit
      state%slip = state%slip/path%joints%motion_unit
      way%load = in_units(path%joints, rate%load)
      scale = maxval(abs(way%load))
      if (allocated(rate%opening)) then
         way%opening = rate%opening/path%joints%motion_unit
         scale = max(scale, maxval(maxval(abs(way%opening), 1)/path%joints%graph%compliance))
      end if
      first = state%load
      before = state%force
      if (scale > 0.0_wp) then
         way%load = plain(way%load/scale)
         if (allocated(way%opening)) way%opening = plain(way%opening/scale)
      end if
      if (.not. path%softness > 0.0_wp) then
         path%softness = max(1.0_wp, &
            & maxval(abs(state%motion))/max(1.0_wp, maxval(abs(state%force))))
         path%given = maxval(state%gap)
      end if
      if (allocated(way%opening)) &
         & path%given = path%given + scale*h_end*maxval(abs(way%opening))
      result%end = path_end%reached
      if (scale > 0.0_wp) then
         call see_softness(path%joints, path%equations, way%load, state)
         call follow(path, first, way, scale*h_end, state, result)
         result%reached = result%reached/scale
         result%jump = result%jump/scale
         result%rest = result%rest/scale
         associate (change => path%joints%force_unit*maxval(abs(state%force - before)))
            result%spread = result%reached*path%jumped/max(change, epsilon(change)*path%jumped, &
               & tiny(change))
         end associate
      end if
      if (result%end == path_end%reached) then
         result%reached = h_end
         if (scale > 0.0_wp) state%load = first + h_end*in_units(path%joints, rate%load)
      end if
      call end_in_balance(path, state, result)
      call finish(path, state, result)
   end subroutine follow_path

   !> Remove what is unbalanced by rounding, and check that forces balance the load and obey the
   !> laws of their joints: else there is no answer
   pure subroutine end_in_balance(path, state, result)
      type(loading_path_t), intent(inout) :: path
      type(coulomb_state_t), intent(inout) :: state
      type(path_result_t), intent(inout) :: result
      real(wp) :: rest(3, size(state%load, 2))

      call balance_rest(path%joints, path%equations, state)
      if (result%end == path_end%undecided) return
      ! joints that break as it falls carried more before
      if (result%end == path_end%collapsed .and. allocated(state%whole)) return
      call imbalance(path%joints, state%load, state%force, rest)
      if (max(maxval(abs(rest)), violation(path%joints, state)) &
         & <= negligible*max(1.0_wp, maxval(abs(state%force)))) return
      result%end = path_end%undecided
      result%reason = path_reason%no_balance
   end subroutine end_in_balance

   !> Largest force of a state that its joint does not bear: a pull beyond the strength of a corner,
   !> pressure beyond a strip that crushes, shear beyond friction and cohesion
   pure real(wp) function violation(joints, state)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      real(wp) :: bond(3)
      integer :: i, j

      violation = 0.0_wp
      do j = 1, size(state%force, 2)
         bond = strength(joints, state, j)
         do i = 1, 2
            if (joints%end_role(i, j) /= end_role%contact) cycle
            violation = max(violation, -reserve(joints, j, i, state%force(:2, j)) - bond(i))
         end do
         violation = max(violation, abs(state%force(3, j)) &
            & - shear_limit(joints, j, state%force(:2, j), bond(3)))
      end do
   end function violation

   !> Numbers without their last digits, which rounding sets: ways to different ends are one way
   elemental real(wp) function plain(x)
      real(wp), intent(in) :: x  !! A number of at most one

      plain = anint(x*2.0_wp**40)*2.0_wp**(-40)
   end function plain

   !> Counts and SI units
   pure subroutine finish(path, state, result)
      type(loading_path_t), intent(in) :: path
      type(coulomb_state_t), intent(inout) :: state
      type(path_result_t), intent(inout) :: result

      result%n_factorisation = path%equations%base%n_factorisation
      if (result%end == path_end%undecided .and. result%n_factorisation &
         & >= path%most_factorisations) result%reason = path_reason%too_costly
      result%largest_jump = result%largest_jump*path%joints%motion_unit
      if (.not. allocated(result%mechanism)) allocate (result%mechanism(size(state%load, 1), 0))
      if (size(result%mechanism) > 0) then
         result%mechanism = in_metres(path%joints, result%mechanism)
         result%mechanism = result%mechanism/maxval(abs(result%mechanism(:2, :)))
      end if
      associate (joints => path%joints)
         state%motion = in_metres(joints, state%motion)
         state%load = in_newtons(joints, state%load)
         state%force = state%force*joints%force_unit
         state%gap = state%gap*joints%motion_unit
         state%slip = state%slip*joints%motion_unit
      end associate
   end subroutine finish
end module dda_loading_path
