!> Velocities at the end of a dynamic step where blocks move: the law of impact, equation (M5)
!>
!> The motion of the step says which contacts are closed. What their impulses make of the velocities
!> is a problem of its own, with the same cones, in the metric of mass:
!>
!>    M (v1 - v0) = dt (f + B' N),   B v1 >= -e B v0,   N in its cone,   N = 0 where B v1 is more
!>
!> Impulses are total ones, those of persistent contacts included. So a closed contact ends at rest
!> if e = 0, whatever the step: Shi's v1 = 2 D/dt - v0 would end with any restitution between 0 and
!> 1, and has never less energy. Without contact the two are the same.
module dda_velocity
   use dda_assembly, only : equations_t, take_springs
   use dda_bar_springs, only : couple_bars, push_bars
   use dda_block_inertia, only : damping_rate, hold_energy, kinetic_energy, packed_velocity, &
      & strain_follows
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_elasticity, only : stress_load
   use dda_fixed_points, only : add_fixed_springs, hold_rigidly, turn_fixed_row
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_settle_in_time, only : settle_in_time
   use dda_settings, only : settings_t
   use dda_step_context, only : step_context_t
   use dda_step_state, only : step_state_t
   use dda_vector, only : cross
   use dda_spring_products, only : relative_displacement
   implicit none
   private

   public :: settle_velocities, near_gap, stiffen_contacts

   !> A contact is closed if its gap is below this share of the smaller block
   real(wp), parameter :: near = 1.0e-10_wp
   !> Stiffness of the springs that stand for impulses, over the inertia m/dt**2
   real(wp), parameter :: over_inertia = 1.0e3_wp
   !> Most tries with less restitution; the last one has none
   integer, parameter :: max_tries = 10
   !> What speeds leave of gaps in the longest step, over what motions leave
   real(wp), parameter :: finer = 1.0e-2_wp
   !> Share by which restitution is taken less at first
   real(wp), parameter :: least_less = 1.0e-6_wp
   !> Energy that counts as rounding, over that of motion
   real(wp), parameter :: energy_noise = 1.0e-12_wp

contains

   !> Velocities of the blocks at the end of a settled step. Newton's restitution may bring in
   !> energy where there is friction, or where blocks are hit in several places; then there is
   !> less of it. What contacts have done to the energy of the motion is no part of what is allowed;
   !> without contacts only held points change it, which turn with their blocks
   pure subroutine settle_velocities(settings, system, contacts, equations, step)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> The equations; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      !> The step; its velocities are set, if they settle
      type(step_context_t), intent(inout) :: step
      logical :: closed(2, size(contacts%joint))
      real(wp) :: part(2, size(contacts%joint)), allowed, before, less
      real(wp) :: steady(size(step%state%motion, 1), size(step%state%motion, 2)), share
      integer :: try

      closed = closed_contacts(system, contacts, step)
      part = parting_speed(settings, system, contacts, closed, step)
      steady = 2.0_wp/step%dt*step%state%motion &
         & - packed_velocity(system, size(step%state%motion, 1))
      before = kinetic_energy(equations, steady)
      allowed = before - sum(step%state%force*step%state%increment)
      less = least_less
      do try = 0, max_tries
         if (try == max_tries) part = 0.0_wp
         call settle_impulses(settings, system, contacts, closed, part, equations, step)
         if (.not. step%has_velocity) return
         if (kinetic_energy(equations, step%velocity) <= allowed + energy_noise*before) exit
         if (.not. any(part > 0.0_wp)) exit
         part = (1.0_wp - less)*part
         less = min(20.0_wp*less, 0.2_wp)
      end do
      share = 0.0_wp
      if (any(closed)) call hold_energy(equations, steady, allowed + energy_noise*before, &
         & step%velocity, share)
      step%impulse = (1.0_wp - share)*step%impulse + share*step%state%force
      step%held_impulse = (1.0_wp - share)*step%held_impulse + share*equations%fixed%force
      step%impact = before - kinetic_energy(equations, step%velocity)
   end subroutine settle_velocities

   !> Velocities for given speeds at which the contacts must part
   pure subroutine settle_impulses(settings, system, contacts, closed, part, equations, step)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> Contacts that are closed: (2, n_joint)
      logical, intent(in) :: closed(:, :)
      !> The speeds: (2, n_joint) [m/s]
      real(wp), intent(in) :: part(:, :)
      !> The equations; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      !> The step; its velocities are set, if they settle
      type(step_context_t), intent(inout) :: step
      type(step_state_t) :: state
      type(joint_springs_t) :: springs
      logical :: follows(size(system%equation))
      real(wp) :: held_force(size(equations%fixed%force))
      integer :: j

      follows = strain_follows(system, step%longest)
      held_force = equations%fixed%force
      call assemble_rates(settings, system, follows, step, equations)
      state = step%state
      ! what a speed leaves of a gap counts as in the longest step
      state%fineness = finer*step%dt/step%longest
      state%unseen = 10.0_wp*step%state%unseen
      state%rates = .true.
      springs = contacts%springs
      do j = 1, size(contacts%joint)
         springs%stiffness(j) = over_inertia*joint_mass(system, contacts%joint(j)%block)/step%dt**2
         call keep_closed(closed(:, j), follows(contacts%joint(j)%block), j, springs, state)
         state%start(1:2, j) = state%start(1:2, j) + springs%stiffness(j)*step%dt*part(:, j)
      end do
      call take_springs(equations)
      call settle_in_time(settings, step%dt*equations%fixed%rate, equations, springs, state)
      ! half of the forces of the motion have acted as they did
      step%held_impulse = equations%fixed%force + held_force/2.0_wp
      step%impulse = state%force
      equations%fixed%force = held_force
      step%has_velocity = state%settled
      if (.not. step%has_velocity) return
      step%velocity = state%motion/step%dt
      call keep_moment(system, contacts, springs, equations, state%force, step)
   end subroutine settle_impulses

   !> Contacts that are closed at the end of a step: those that carry a force, and those without a
   !> gap
   pure function closed_contacts(system, contacts, step) result(closed)
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      type(step_context_t), intent(in) :: step
      !> For each contact of each joint: (2, n_joint)
      logical :: closed(2, size(contacts%joint))
      integer :: j, k

      closed = .false.
      do j = 1, size(contacts%joint)
         do k = 1, contacts%joint(j)%n_contact
            closed(k, j) = .not. step%state%face(j)%open(k) .or. contacts%gap(k, j) &
               & + step%state%increment(k, j) + step%curve(k, j) &
               & <= near_gap(system, contacts%joint(j)%block)
         end do
      end do
   end function closed_contacts

   !> Speed at which the contacts must part: restitution times the speed at which they have met, if
   !> they have met at the very end of the step and faster than weight makes resting contacts meet
   pure function parting_speed(settings, system, contacts, closed, step) result(speed)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> Contacts that are closed at its end: (2, n_joint)
      logical, intent(in) :: closed(:, :)
      type(step_context_t), intent(in) :: step
      !> The speeds: (2, n_joint) [m/s]
      real(wp) :: speed(2, size(contacts%joint))
      real(wp) :: before(3, size(contacts%joint)), meeting
      integer :: j, k

      speed = 0.0_wp
      if (.not. settings%restitution > 0.0_wp) return
      before = relative_displacement(contacts%springs, packed_velocity(system, &
         & size(step%state%motion, 1)))
      do j = 1, size(contacts%joint)
         do k = 1, 2
            if (.not. closed(k, j) .or. .not. step%state%face(j)%open(k)) cycle
            meeting = before(k, j) - 2.0_wp*step%state%increment(k, j)/step%dt
            if (meeting > step%slowest_impact) speed(k, j) = settings%restitution*meeting
         end do
      end do
   end function parting_speed

   !> Equations of the velocities, as motions v1*dt: M/dt**2 (v1 dt) = M v0/dt + f
   pure subroutine assemble_rates(settings, system, follows, step, equations)
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> Blocks without strain rates: (n_block)
      logical, intent(in) :: follows(:)
      type(step_context_t), intent(in) :: step
      !> Receives base and load
      type(equations_t), intent(inout) :: equations
      real(wp) :: share, stress(6)
      integer :: b, e, i, nd

      nd = size(equations%load, 1)
      share = damping_rate(settings, step%dt)*step%dt/2.0_wp
      equations%base = (1.0_wp + share)/step%dt**2*equations%mass
      if (size(equations%dashpot) > 0) &
         & equations%base = equations%base + equations%dashpot/(2.0_wp*step%dt)
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         equations%load(:, e) = equations%outer(:, e) + (1.0_wp - share)/step%dt &
            & *matmul(equations%mass(:, :, e), system%velocity(:nd, b))
         if (size(equations%dashpot) > 0) equations%load(:, e) = equations%load(:, e) &
            & - matmul(equations%dashpot(:, :, e), system%velocity(:nd, b))/2.0_wp
         if (nd < 6) cycle
         if (follows(b)) then
            equations%base(4:, :3, e) = 0.0_wp
            equations%base(:3, 4:, e) = 0.0_wp
            equations%load(4:, e) = 0.0_wp
         else
            stress = stress_load(system%stress(:, b), system%area(b))
            equations%load(:, e) = equations%load(:, e) + stress &
               & - matmul(equations%elastic(:, :, e), step%state%motion(:, e))
         end if
      end do
      call push_bars(equations%bars, step%state%motion, equations%load)
      do i = 1, size(equations%fixed%point)
         e = equations%fixed%equation(i)
         call turn_fixed_row(system, settings, i, step%state%motion(:, e), equations%fixed, &
            & equations%load(:, e))
      end do
      do b = 1, size(follows)
         e = system%equation(b)
         if (e == 0 .or. .not. follows(b)) cycle
         call hold_rigidly(e, equations%fixed)
         equations%load(4:, e) = 0.0_wp
      end do
      call couple_bars(equations%bars, equations%matrix%pair, .false., equations%matrix%coupling)
      call add_fixed_springs(equations%fixed, step%dt*equations%fixed%rate, equations%base, &
         & equations%load)
   end subroutine assemble_rates

   !> Springs of one joint that only its closed contacts feel, and only motions without strain where
   !> strain has no rate
   pure subroutine keep_closed(closed, follows, j, springs, state)
      !> Contacts that are closed: (2)
      logical, intent(in) :: closed(2)
      !> Blocks without strain rates: (2)
      logical, intent(in) :: follows(2)
      !> Number of the joint
      integer, intent(in) :: j
      type(joint_springs_t), intent(inout) :: springs
      !> The state that the search for the velocities begins with
      type(step_state_t), intent(inout) :: state
      integer :: k, side

      state%multiplier(:, j) = state%force(:, j)
      state%start(:, j) = state%force(:, j)
      do k = 1, 2
         state%face(j)%open(k) = .not. closed(k)
         if (closed(k)) cycle
         springs%row(:, k, :, j) = 0.0_wp
         springs%shift(k, j) = 0.0_wp
         state%multiplier(k, j) = 0.0_wp
         state%start(k, j) = -1.0_wp
      end do
      if (.not. any(closed)) then
         springs%row(:, 3, :, j) = 0.0_wp
         state%multiplier(3, j) = 0.0_wp
         state%start(3, j) = 0.0_wp
      end if
      do side = 1, 2
         if (follows(side)) springs%row(4:, :, side, j) = 0.0_wp
      end do
   end subroutine keep_closed

   !> Keep the moment of momentum of each pair of blocks. The centres have moved while their
   !> impulses acted as at the beginning: the pair's centres bring in
   !> dt**2 (F/2 - N) x (v2 - v1), F the force of the motion, N that of the impulse; and the rows of
   !> a joint between turned edges may lie off one line. The two blocks give it back by one change
   !> of spin
   pure subroutine keep_moment(system, contacts, springs, equations, impulse, step)
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts before the step
      type(contacts_t), intent(in) :: contacts
      !> Springs that the impulses have acted by
      type(joint_springs_t), intent(in) :: springs
      !> The equations, for the moments of inertia
      type(equations_t), intent(in) :: equations
      !> Forces that stand for the impulses: (3, n_joint) [N/m]
      real(wp), intent(in) :: impulse(:, :)
      !> The step; its spins are changed
      type(step_context_t), intent(inout) :: step
      real(wp) :: change(size(step%velocity, 2)), force(2), excess(3), moment, turn(3)
      integer :: b, j, one, other, side

      change = 0.0_wp
      do j = 1, size(contacts%joint)
         one = contacts%springs%equation(1, j)
         other = contacts%springs%equation(2, j)
         if (one == 0 .or. other == 0) cycle
         excess = step%state%force(:, j)/2.0_wp - impulse(:, j)
         associate (joint => contacts%joint(j))
            force = excess(1)*joint%contact(1)%normal + excess(2)*joint%contact(2)%normal &
               & + excess(3)*joint%tangent
         end associate
         moment = step%dt**2*cross(force, step%velocity(1:2, other) - step%velocity(1:2, one))
         do side = 1, 2
            b = contacts%joint(j)%block(side)
            turn = matmul(springs%row(1:3, :, side, j), impulse(:, j))
            moment = moment + step%dt*(turn(3) + cross(system%centroid(:, b) &
               & + system%motion(1:2, b), turn(1:2)))
         end do
         moment = moment/(equations%mass(3, 3, one) + equations%mass(3, 3, other))
         change(one) = change(one) - moment
         change(other) = change(other) - moment
      end do
      step%velocity(3, :) = step%velocity(3, :) + change
   end subroutine keep_moment

   !> Springs of contacts whose forces are multipliers: stiff beside inertia however short the step,
   !> and without memory of slip, which would bring in work. What sticks has no speed to slip with
   pure subroutine stiffen_contacts(system, dt, contacts)
      type(block_system_t), intent(in) :: system
      !> Length of the step [s]
      real(wp), intent(in) :: dt
      !> The contacts; stiffness and trial forces are set
      type(contacts_t), intent(inout) :: contacts
      integer :: j

      do j = 1, size(contacts%joint)
         contacts%springs%stiffness(j) = max(contacts%springs%stiffness(j), &
            & over_inertia*joint_mass(system, contacts%joint(j)%block)/dt**2)
         contacts%trial(:, j) = contacts%force(:, j) &
            & - contacts%springs%stiffness(j)*[contacts%gap(1:2, j), 0.0_wp]
      end do
   end subroutine stiffen_contacts

   !> Gap below which two blocks count as touching
   pure real(wp) function near_gap(system, pair)
      type(block_system_t), intent(in) :: system
      !> The two blocks: (2)
      integer, intent(in) :: pair(2)

      near_gap = near*sqrt(minval(system%area(pair)))
   end function near_gap

   !> Mass of the lighter of the movable blocks of a pair [kg per metre depth]
   pure real(wp) function joint_mass(system, pair)
      type(block_system_t), intent(in) :: system
      !> The two blocks: (2)
      integer, intent(in) :: pair(2)

      joint_mass = minval(system%density(pair)*system%area(pair), mask=system%equation(pair) > 0)
   end function joint_mass
end module dda_velocity
