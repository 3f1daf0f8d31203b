!> Where blocks meet fast, a step ends before they do: the speed at that very moment counts, and the
!> time that is left after it
module dda_impact_time
   use dda_assembly, only : equations_t
   use dda_block_inertia, only : kinetic_energy, packed_velocity
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : step_context_t, step_outcome_t
   use dda_velocity, only : near_gap
   use dda_spring_products, only : relative_displacement
   implicit none
   private

   public :: check_impact

   !> Without restitution only impacts end a step that carry this share of the energy of motion, and
   !> of what the longest step of free fall adds to it: in a pile of many blocks none does, and its
   !> steps stay as long as they are
   real(wp), parameter :: notable = 1.0e-2_wp

contains

   !> Check that no open contact closes fast within the step; a step in which one does ends when the
   !> two blocks, if nothing else touched them, would be near enough to count as touching
   pure function check_impact(settings, system, contacts, equations, step) result(outcome)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      type(equations_t), intent(in) :: equations
      type(step_context_t), intent(in) :: step
      !> What the check says
      type(step_outcome_t) :: outcome
      real(wp) :: free(size(step%state%motion, 1), size(step%state%motion, 2))
      real(wp) :: speed(3, size(contacts%joint)), acceleration(3, size(contacts%joint))
      real(wp) :: near, earliest, least, meeting, time
      integer :: e, i, j, k

      outcome%accepted = .true.
      outcome%dt = step%dt
      free = 0.0_wp
      do e = 1, size(free, 2)
         do i = 1, 3
            free(i, e) = equations%outer(i, e)/equations%mass(i, i, e)
         end do
      end do
      associate (velocity => packed_velocity(system, size(free, 1)))
         speed = relative_displacement(contacts%springs, velocity)
         least = merge(0.0_wp, notable, settings%restitution > 0.0_wp) &
            & *(kinetic_energy(equations, velocity) &
            & + sum(equations%mass(1, 1, :))*step%slowest_impact**2/8.0_wp)
      end associate
      acceleration = relative_displacement(contacts%springs, free)
      earliest = huge(earliest)
      do j = 1, size(contacts%joint)
         near = near_gap(system, contacts%joint(j)%block)
         do k = 1, contacts%joint(j)%n_contact
            if (step%state%face(j)%open(k) .or. contacts%gap(k, j) <= near) cycle
            time = falling_time(contacts%gap(k, j) - near/2.0_wp, -speed(k, j), -acceleration(k, j))
            meeting = -speed(k, j) - acceleration(k, j)*min(time, step%dt)
            if (meeting <= step%slowest_impact) cycle
            if (meeting**2 < 2.0_wp*least*ease_of(contacts%springs, equations, k, j)) cycle
            earliest = min(earliest, time)
         end do
      end do
      if (earliest > 2.0_wp*step%dt) return
      outcome%accepted = .false.
      outcome%dt = merge(earliest, step%dt/2.0_wp, earliest < 0.999_wp*step%dt)
   end function check_impact

   !> How easily an impact at a contact moves its two blocks
   pure real(wp) function ease_of(springs, equations, k, j) result(ease)
      !> The springs, for what the contact sees of the blocks
      type(joint_springs_t), intent(in) :: springs
      type(equations_t), intent(in) :: equations
      !> Which contact of the joint
      integer, intent(in) :: k
      !> Number of the joint
      integer, intent(in) :: j
      integer :: e, i, side

      ease = 0.0_wp
      do side = 1, 2
         e = springs%equation(side, j)
         if (e == 0) cycle
         do i = 1, 3
            ease = ease + springs%row(i, k, side, j)**2/equations%mass(i, i, e)
         end do
      end do
   end function ease_of

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
