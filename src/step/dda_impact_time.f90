!> Where blocks rebound, a step ends before they meet: the speed at that very moment counts
module dda_impact_time
   use dda_assembly, only : equations_t
   use dda_block_inertia, only : packed_velocity
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : step_context_t, step_outcome_t
   use dda_velocity, only : near_gap
   use dda_spring_products, only : relative_displacement
   implicit none
   private

   public :: check_impact

contains

   !> Check that no open contact closes fast within the step; a step in which one does ends when the
   !> two blocks, if nothing else touched them, would be near enough to count as touching
   pure function check_impact(settings, system, contacts, equations, step) result(outcome)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> The equations of the step
      type(equations_t), intent(in) :: equations
      !> The settled step
      type(step_context_t), intent(in) :: step
      !> What the check says
      type(step_outcome_t) :: outcome
      real(wp) :: free(size(step%state%motion, 1), size(step%state%motion, 2))
      real(wp) :: speed(3, size(contacts%joint)), acceleration(3, size(contacts%joint))
      real(wp) :: near, earliest, time
      integer :: e, i, j, k

      outcome%accepted = .true.
      outcome%dt = step%dt
      if (.not. settings%restitution > 0.0_wp) return
      free = 0.0_wp
      do e = 1, size(free, 2)
         do i = 1, 3
            free(i, e) = equations%outer(i, e)/equations%mass(i, i, e)
         end do
      end do
      speed = relative_displacement(contacts%springs, &
         & packed_velocity(system, size(free, 1)))
      acceleration = relative_displacement(contacts%springs, free)
      earliest = huge(earliest)
      do j = 1, size(contacts%joint)
         near = near_gap(system, contacts%joint(j)%block)
         do k = 1, contacts%joint(j)%n_contact
            if (step%state%face(j)%open(k) .or. contacts%gap(k, j) <= near) cycle
            time = falling_time(contacts%gap(k, j) - near/2.0_wp, -speed(k, j), -acceleration(k, j))
            if (-speed(k, j) - acceleration(k, j)*min(time, step%dt) <= step%slowest_impact) cycle
            earliest = min(earliest, time)
         end do
      end do
      if (earliest > 2.0_wp*step%dt) return
      outcome%accepted = .false.
      outcome%dt = merge(earliest, step%dt/2.0_wp, earliest < 0.999_wp*step%dt)
   end function check_impact

   !> Time to cover a way at constant acceleration
   pure real(wp) function falling_time(way, speed, acceleration)
      !> The way, positive [m]
      real(wp), intent(in) :: way
      !> Speed at the beginning [m/s]
      real(wp), intent(in) :: speed
      !> Acceleration [m/s2]
      real(wp), intent(in) :: acceleration
      real(wp) :: square, root

      falling_time = huge(falling_time)
      square = speed**2 + 2.0_wp*acceleration*way
      if (square < 0.0_wp) return
      root = speed + sqrt(square)
      if (root > 0.0_wp) falling_time = 2.0_wp*way/root
   end function falling_time
end module dda_impact_time
