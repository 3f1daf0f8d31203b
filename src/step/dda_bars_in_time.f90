!> Bars in time: joints of the contact problem with axial and transverse forces
!>
!> The mean force of an elastic bar over a step is A0 + share*k*e. Bounded above and below it is
!> like a shear force that has no friction, else like a normal force.
module dda_bars_in_time
   use dda_bar_springs, only : bar_springs_t
   use dda_contact_types, only : joint_springs_t, unbounded
   use dda_kinds, only : wp
   use dda_step_state, only : step_state_t
   implicit none
   private

   public :: append_bars, drop_bars

contains

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

end module dda_bars_in_time
