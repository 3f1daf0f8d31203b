!> Joint forces as multipliers (augmented Lagrangian), without penalty error
!>
!> In time contact forces that obey Coulomb's law as it is are found group by group
!> (`dda_contact_solver`), and around them the forces of restrained points and bars.
module dda_multipliers
   use dda_bar_springs, only : add_bars, couple_bars, judge_bars
   use dda_bars_in_time, only : append_bars, drop_bars
   use dda_contact_solver, only : settle_contacts
   use dda_contact_types, only : joint_springs_t
   use dda_fixed_points, only : correct_fixed_forces
   use dda_friction, only : iterate_friction
   use dda_kinds, only : wp
   use dda_open_close, only : iterate_open_close
   use dda_settings, only : flow_rule, settings_t
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: settle_in_time, settle_joints

   !> Maximum number of multiplier iterations
   integer, parameter :: max_passes = 100
   !> Change of a converged force over the sum of forces
   real(wp), parameter :: fine = 1.0e-10_wp
   !> Change of a force that a step accepts
   real(wp), parameter :: coarse = 1.0e-7_wp
   !> Least reduction of the change of restraint forces per iteration
   real(wp), parameter :: falling = 0.9_wp
   integer, parameter :: patience = 5
   !> Maximum number of changes of bar states, and number with simultaneous changes
   integer, parameter :: max_bar_passes = 200, few_bar_passes = 20

contains

   !> Settle the joints of one step: once in reference geometry, where the penalty has no
   !> influence, and where springs give for good; until the multipliers stay the same where
   !> blocks move
   pure subroutine settle_joints(settings, equations, springs, state)
      type(settings_t), intent(in) :: settings
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      integer :: pass
      logical :: agreed

      do pass = 1, max_bar_passes
         if (settings%current .and. settings%dynamic) then
            call settle_in_time((equations%fixed%target), equations, springs, state)
         else if (multiplies(settings, springs) .or. size(equations%fixed%point) > 0) then
            call settle_exactly(settings, (equations%fixed%target), state%trial - state%force, &
               & equations, springs, state)
         else
            call settle_once(settings, equations, springs, state)
         end if
         if (.not. state%settled .or. size(equations%bars%entry) == 0) return
         call add_bars(equations%bars, -1.0_wp, equations%base, equations%load)
         call judge_bars(equations%bars, state%motion, pass > few_bar_passes, agreed)
         call add_bars(equations%bars, 1.0_wp, equations%base, equations%load)
         if (agreed) return
         call couple_bars(equations%bars, equations%matrix%pair, .true., equations%matrix%coupling)
         equations%changed = .true.
      end do
      state%settled = .false.
   end subroutine settle_joints

   !> Settle the joints until neither their forces nor those at the restrained points change
   pure subroutine settle_exactly(settings, target, opening, equations, springs, state)
      type(settings_t), intent(in) :: settings
      !> Displacements of the restrained points: (n_fixed) [m]
      real(wp), intent(in) :: target(:)
      !> Trial forces at the beginning without the forces themselves: (3, n_joint) [N/m]
      real(wp), intent(in) :: opening(:, :)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state
      real(wp) :: change, scale, force(3, size(springs%stiffness))
      integer :: pass
      logical :: has_multipliers

      has_multipliers = multiplies(settings, springs)
      do pass = 1, max_passes
         force = state%force
         if (has_multipliers) state%trial = force + opening
         call settle_once(settings, equations, springs, state)
         if (.not. state%settled) return
         call correct_fixed_forces(target, state%motion, equations%fixed, equations%load, change)
         if (has_multipliers) change = max(change, &
            & maxval(abs(state%force - force)))
         ! without loads the forces of restrained points alone bear on the blocks
         scale = equations%force_scale + sum(abs(equations%fixed%force))
         if (change <= fine*scale) return
      end do
      state%settled = .false.
   end subroutine settle_exactly

   !> True if the forces of the joints are multipliers; otherwise their springs are real
   pure logical function multiplies(settings, springs)
      type(settings_t), intent(in) :: settings
      type(joint_springs_t), intent(in) :: springs

      multiplies = settings%current .and. .not. springs%give
   end function multiplies

   !> Settle the joints for given multipliers
   pure subroutine settle_once(settings, equations, springs, state)
      type(settings_t), intent(in) :: settings
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state

      if (settings%flow == flow_rule%associated) then
         call iterate_open_close(equations, springs, settings%max_changes, state)
      else
         call iterate_friction(equations, springs, settings%max_changes, settings%dynamic, state)
      end if
   end subroutine settle_once

   !> Sweep until restrained points are where they must be: their springs, stiff beside inertia, are
   !> parts of the blocks' equations, and what these lack becomes their force
   pure subroutine settle_in_time(target, equations, springs, state)
      real(wp), intent(in) :: target(:)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state
      real(wp) :: change, last, least, scale
      integer :: pass, stale

      change = huge(change)
      least = huge(least)
      stale = 0
      do pass = 1, max_passes
         last = change
         call sweep_with_bars(equations, springs, state)
         if (.not. state%settled) return
         call correct_fixed_forces(target, state%motion, equations%fixed, equations%load, change)
         scale = equations%force_scale + sum(abs(equations%fixed%force))
         if (change <= fine*scale) return
         ! what sweeps leave is no more to be corrected
         if (change <= coarse*scale .and. change > last/2.0_wp) return
         ! contacts may block a prescribed displacement
         stale = merge(0, stale + 1, change < falling*least)
         if (stale == patience) exit
         least = min(least, change)
      end do
      state%settled = change <= coarse*scale
   end subroutine settle_in_time

   !> Sweep the contacts, and in a motion with them the bars
   pure subroutine sweep_with_bars(equations, springs, state)
      !> Blocks assembled, with their bars in a motion; the conditions of the bars are set
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(inout) :: state
      type(joint_springs_t) :: with_bars
      type(step_state_t) :: whole
      real(wp) :: load(size(equations%load, 1), size(equations%load, 2))
      logical :: agreed

      if (state%rates .or. size(equations%bars%entry) == 0) then
         call settle_contacts(equations, springs, state)
         return
      end if
      call add_bars(equations%bars, -1.0_wp, equations%base, equations%load)
      load = equations%load
      call append_bars(equations%bars, springs, state, with_bars, whole, equations%load)
      call settle_contacts(equations, with_bars, whole)
      call drop_bars(whole, state)
      equations%load = load
      call judge_bars(equations%bars, state%motion, .false., agreed)
      call add_bars(equations%bars, 1.0_wp, equations%base, equations%load)
      call couple_bars(equations%bars, equations%matrix%pair, .true., equations%matrix%coupling)
   end subroutine sweep_with_bars
end module dda_multipliers
