!> Motion of an assembly at a load that does not change, damped by mass, from event to event: to a
!> state in balance, or without end
!>
!> Where a load has grown by a little and no state in balance is near, the blocks move until gaps
!> close or joints stick, and forces balance again: a jump. If nothing stops them they fall.
module dda_load_jump
   use dda_coulomb_equations, only : coulomb_equations_t
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_coulomb_law, only : coulomb_state_t, imbalance
   use dda_event_rates, only : find_rates, new_rates, rates_t
   use dda_kinds, only : wp
   use dda_path_event, only : event_kind, event_t, hold_forces, move_on, next_event
   implicit none
   private

   public :: motion_end, motion_end_enum, jump_t, path_damping, moves_unbalanced
   public :: far_factor, jump_to_balance

   !> How a motion ends
   type :: motion_end_enum
      !> It did not settle
      integer :: unsettled = 0
      !> Forces balance the load
      integer :: balanced = 1
      !> No gap closes however far the blocks move, and the load drives them
      integer :: endless = 2
      !> The blocks have moved very far
      integer :: far = 3
   end type motion_end_enum

   !> Names of the ends
   type(motion_end_enum), parameter :: motion_end = motion_end_enum()

   !> What a motion is told and what it tells
   type :: jump_t
      !> Balance is where no more than this is left of the load
      real(wp) :: tolerance = 0.0_wp
      !> A motion beyond this is far
      real(wp) :: far = huge(1.0_wp)
      !> Factorisations at most
      integer :: most_factorisations = huge(1)
      !> Velocities of a motion without end: (n_dof, n_block)
      real(wp), allocatable :: mechanism(:, :)
   end type jump_t

   !> Damping along a path, by unit mass and unit compliance: at rest it takes a part of 1e-9 of the
   !> load, in motion nearly all; results are the same from 1e-12 to 1e-9
   real(wp), parameter :: path_damping = 1.0e-10_wp
   !> Blocks move where damping takes more than this share of the load
   real(wp), parameter :: moves_unbalanced = 0.01_wp
   !> So many times the motion under the dead load is far
   real(wp), parameter :: far_factor = 1.0e4_wp
   !> An event no further off than this makes no way
   real(wp), parameter :: no_way = 1.0e-13_wp
   !> So many events without way lead nowhere
   integer, parameter :: max_standstill = 60
   !> Steps of a jump: at least so many, and so many more for each joint
   integer, parameter :: least_patience = 1000, patience = 50
   !> Change of damping after a step that meets no event, and its inverse where there are no rates
   real(wp), parameter :: calmer = 0.1_wp
   !> With so much damping there are always rates
   real(wp), parameter :: strongest = 1.0e5_wp

contains

   !> Move from event to event at a load that does not change. Where friction lets forces drop, only
   !> motion that is damped enough has rates: damping rises until it has, and falls again with every
   !> step that meets no event
   pure subroutine jump_to_balance(joints, equations, load, state, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> The load: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> The state; where it is in balance it carries the load
      type(coulomb_state_t), intent(inout) :: state
      !> The jump
      type(jump_t), intent(inout) :: jump
      !> How it ends, one of motion_end
      integer, intent(out) :: end
      type(rates_t) :: rates
      type(event_t) :: event
      real(wp) :: damping, rest(size(load, 1), size(load, 2)), start(size(load, 1), size(load, 2))
      real(wp) :: still(3, size(state%slip))
      integer :: i, standstill
      logical :: failed, found, pushed

      still = 0.0_wp
      start = state%motion
      standstill = 0
      pushed = .false.
      failed = .false.
      damping = path_damping
      rates = new_rates(state)
      do i = 1, least_patience + patience*size(state%slip)
         call imbalance(joints, load, state%force, rest)
         end = where_it_is(maxval(abs(rest)), state%motion - start, jump)
         if (end == motion_end%balanced) state%load = load
         if (end == motion_end%far) call end_far(joints, equations, rest, state, start, jump, end)
         if (end /= motion_end%unsettled) return
         if (equations%base%n_factorisation >= jump%most_factorisations) return
         if (event%kind == event_kind%none .and. .not. failed) &
            & damping = max(path_damping, calmer*damping)
         call find_rates(joints, equations, state, rest, still, damping, rates, found)
         failed = .not. found
         if (failed) then
            if (damping > strongest) return
            damping = damping/calmer
            cycle
         end if
         if (pushed .and. rates%unbalanced > moves_unbalanced) then
            call see_ray(joints, state, rest, rates, event, jump, end)
            if (event%kind == event_kind%none) return
         else
            event = next_event(joints, state, rates, 1.0_wp)
         end if
         pushed = .not. damping > path_damping .and. rates%unbalanced > moves_unbalanced &
            & .and. event%kind == event_kind%none
         standstill = merge(standstill + 1, 0, event%distance < no_way)
         if (standstill > max_standstill) return
         call move_on(joints, rates, event, state)
      end do
   end subroutine jump_to_balance

   !> Whether a motion has come to balance, or far
   pure integer function where_it_is(left, way, jump) result(end)
      !> What the forces leave of the load
      real(wp), intent(in) :: left
      !> Motion so far: (n_dof, n_block)
      real(wp), intent(in) :: way(:, :)
      !> What it is told
      type(jump_t), intent(in) :: jump

      end = motion_end%unsettled
      if (left <= jump%tolerance) then
         end = motion_end%balanced
      else if (maxval(abs(way)) > jump%far) then
         end = motion_end%far
      end if
   end function where_it_is

   !> Whether a motion that has gone far has no end. If that is not seen, the blocks have fallen by
   !> all that it went
   pure subroutine end_far(joints, equations, rest, state, start, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> Their equations
      type(coulomb_equations_t), intent(inout) :: equations
      !> What the forces leave of the load: (n_dof, n_block)
      real(wp), intent(in) :: rest(:, :)
      !> The state
      type(coulomb_state_t), intent(in) :: state
      !> Motion where it began: (n_dof, n_block)
      real(wp), intent(in) :: start(:, :)
      !> Receives the mechanism
      type(jump_t), intent(inout) :: jump
      !> endless or far
      integer, intent(out) :: end
      type(rates_t) :: rates
      type(event_t) :: event
      real(wp) :: still(3, size(state%slip))
      logical :: found

      still = 0.0_wp
      rates = new_rates(state)
      end = motion_end%unsettled
      call find_rates(joints, equations, state, rest, still, path_damping, rates, found)
      if (found .and. rates%unbalanced > moves_unbalanced) &
         & call see_ray(joints, state, rest, rates, event, jump, end)
      if (end == motion_end%endless) return
      end = motion_end%far
      jump%mechanism = state%motion - start
   end subroutine end_far

   !> Follow a motion whose forces stay as they are: to the next gap that closes, or without end
   pure subroutine see_ray(joints, state, rest, rates, event, jump, end)
      !> The joints
      type(coulomb_joints_t), intent(in) :: joints
      !> The state
      type(coulomb_state_t), intent(in) :: state
      !> What the forces leave of the load: (n_dof, n_block)
      real(wp), intent(in) :: rest(:, :)
      !> Rates of a motion; their forces are held
      type(rates_t), intent(inout) :: rates
      !> The gap that closes, or none
      type(event_t), intent(out) :: event
      !> Receives the mechanism
      type(jump_t), intent(inout) :: jump
      !> endless if no gap closes and the load drives the motion, otherwise unsettled
      integer, intent(out) :: end

      call hold_forces(rates)
      event = next_event(joints, state, rates, huge(1.0_wp))
      end = motion_end%unsettled
      if (event%kind /= event_kind%none .or. .not. sum(rest*rates%motion) > 0.0_wp) return
      end = motion_end%endless
      jump%mechanism = rates%motion
   end subroutine see_ray
end module dda_load_jump
