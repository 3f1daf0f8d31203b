!> Joint forces as multipliers (augmented Lagrangian), without penalty error
!>
!> In time contact forces that obey Coulomb's law as it is are found group by group
!> (`dda_contact_solver`), and around them the forces of restrained points and bars.
!>
!> The mean force of an elastic bar over a step is A0 + share*k*e. Bounded above and below it is
!> like a shear force that has no friction, else like a normal force.
module dda_multipliers
   use dda_bar_springs, only : add_bars, bar_springs_t, judge_bars
   use dda_contact_interior, only : falling, patience
   use dda_contact_solver, only : gap_tolerance, settle_contacts
   use dda_contact_types, only : joint_springs_t, unbounded
   use dda_fixed_points, only : correct_fixed_forces
   use dda_friction, only : iterate_friction, negligible
   use dda_kinds, only : wp
   use dda_open_close, only : iterate_open_close
   use dda_settings, only : flow_rule, settings_t
   use dda_step_state, only : equations_t, step_state_t
   implicit none
   private

   public :: settle_in_time, settle_joints

   !> Maximum number of multiplier iterations
   integer, parameter :: max_passes = 100
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
      type(joint_springs_t), intent(inout) :: springs
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
         if (change <= negligible*scale) return
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
      type(joint_springs_t), intent(inout) :: springs
      type(step_state_t), intent(inout) :: state
      real(wp) :: change, last, least, miss, scale
      integer :: pass, stale

      miss = huge(miss)
      least = huge(least)
      stale = 0
      do pass = 1, max_passes
         last = miss
         call sweep_with_bars(equations, springs, state)
         if (.not. state%settled) return
         call correct_fixed_forces(target, state%motion, equations%fixed, equations%load, change, &
            & miss)
         scale = max(state%fall, maxval(abs(state%motion(:2, :))))
         if (miss <= negligible*scale) return
         ! what sweeps leave is no more to be corrected
         if (miss <= gap_tolerance*scale .and. miss > last/2.0_wp) return
         ! contacts may block a prescribed displacement
         stale = merge(0, stale + 1, miss < falling*least)
         if (stale == patience) exit
         least = min(least, miss)
      end do
      ! a point that rests misses its place by what contacts leave of theirs, which ends no run
      state%settled = miss <= gap_tolerance*scale .or. .not. any(abs(equations%fixed%rate) > 0.0_wp)
   end subroutine settle_in_time

   !> Sweep the contacts, and in a motion with them the bars
   pure subroutine sweep_with_bars(equations, springs, state)
      !> Blocks assembled, with their bars in a motion; the conditions of the bars are set
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(inout) :: springs
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
   end subroutine sweep_with_bars

   !> The joints of a step and behind them its bars
   pure subroutine append_bars(bars, contacts, step, springs, state, load)
      type(bar_springs_t), intent(in) :: bars
      type(joint_springs_t), intent(in) :: contacts
      type(step_state_t), intent(in) :: step
      !> Springs of joints and bars
      type(joint_springs_t), intent(out) :: springs
      type(step_state_t), intent(out) :: state
      !> Receives what the bars carry in the middle of their bounds: (n_dof, n_equation) [N/m]
      real(wp), intent(inout) :: load(:, :)
      integer :: i, n, more

      n = size(contacts%stiffness)
      more = n + size(bars%trial)
      call append_springs(contacts, more, springs)
      state = step
      deallocate (state%force, state%gap, state%face)
      allocate (state%force(3, more), state%gap(3, more), source=0.0_wp)
      allocate (state%face(more))
      state%force(:, :n) = step%force
      state%gap(:, :n) = step%gap
      do i = 1, size(bars%trial)
         call make_joint(bars, i, n + i, springs, load)
         state%force(:, n + i) = max(-springs%shift(:, n + i), springs%rest(:, n + i))
         state%force(3, n + i) = max(-springs%cone(n + i)%limit, &
            & min(springs%cone(n + i)%limit, springs%rest(3, n + i)))
      end do
   end subroutine append_bars

   !> The springs of the joints of a step and behind them some of nothing
   pure subroutine append_springs(contacts, more, springs)
      type(joint_springs_t), intent(in) :: contacts
      integer, intent(in) :: more  !! Springs of all together
      type(joint_springs_t), intent(out) :: springs
      integer :: n

      n = size(contacts%stiffness)
      allocate (springs%equation(2, more), source=0)
      allocate (springs%row(size(contacts%row, 1), 3, 2, more), source=0.0_wp)
      allocate (springs%shift(3, more), springs%soft(3, more), springs%rest(3, more), source=0.0_wp)
      allocate (springs%stiffness(more), source=0.0_wp)
      allocate (springs%cone(more))
      springs%equation(:, :n) = contacts%equation
      springs%row(:, :, :, :n) = contacts%row
      springs%shift(:, :n) = contacts%shift
      springs%cone(:n) = contacts%cone
   end subroutine append_springs

   !> One bar as a joint
   pure subroutine make_joint(bars, i, j, springs, load)
      type(bar_springs_t), intent(in) :: bars
      integer, intent(in) :: i, j  !! Numbers of the bar and of its joint
      type(joint_springs_t), intent(inout) :: springs
      !> Receives what the bar carries in the middle of its bounds: (n_dof, n_equation) [N/m]
      real(wp), intent(inout) :: load(:, :)
      real(wp) :: bound(2), middle, sign
      integer :: e, k, side

      springs%equation(:, j) = bars%equation(:, i)
      springs%shift(1:2, j) = unbounded
      bound = max(-unbounded, min(unbounded, bars%bound(:, i)))
      bound = (1.0_wp - bars%share)*bars%force(i) + bars%share*bound
      if (bars%stiffness(2, i) > 0.0_wp) then
         springs%row(:, 2, :, j) = -bars%row(:, 2, :, i)
         springs%soft(2, j) = 1.0_wp/(bars%share*bars%stiffness(2, i))
      end if
      k = 1
      middle = 0.0_wp
      sign = -1.0_wp
      if (all(abs(bars%bound(:, i)) < unbounded)) then
         k = 3
         middle = sum(bound)/2.0_wp
         springs%cone(j)%limit = (bound(2) - bound(1))/2.0_wp
      else if (bars%bound(1, i) > -unbounded) then
         springs%shift(1, j) = -bound(1)
      else if (bars%bound(2, i) < unbounded) then
         sign = 1.0_wp
         springs%shift(1, j) = bound(2)
      end if
      springs%row(:, k, :, j) = sign*bars%row(:, 1, :, i)
      springs%soft(k, j) = 1.0_wp/(bars%share*bars%stiffness(1, i))
      springs%rest(k, j) = -sign*((1.0_wp - bars%share)*bars%force(i) &
         & + bars%share*bars%trial(i) - middle)
      do side = 1, 2
         e = bars%equation(side, i)
         if (e > 0) load(:, e) = load(:, e) - middle*bars%row(:, 1, side, i)
      end do
   end subroutine make_joint

   !> Give the joints of a step back what was found beside its bars
   pure subroutine drop_bars(state, step)
      type(step_state_t), intent(in) :: state
      type(step_state_t), intent(inout) :: step
      integer :: n

      n = size(step%face)
      step%motion = state%motion
      step%increment = state%increment(:, :n)
      step%force = state%force(:, :n)
      step%face = state%face(:n)
      step%passes = state%passes
      step%settled = state%settled
      step%residual = state%residual
      step%worst = state%worst
   end subroutine drop_bars
end module dda_multipliers
