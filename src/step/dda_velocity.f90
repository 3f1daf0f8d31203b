!> Velocities at the end of a dynamic step where blocks move: the law of impact, equation (M5)
!>
!> The motion D of the step says which contacts are closed, and what v = 2 D/dt - v0 they would have
!> by constant acceleration. Its forces f have acted half way; where the contacts are at the end,
!> with their rows B1, the forces N that the law of impact asks for replace them, with the same
!> cones, in the metric of mass:
!>
!>    M (v1 - v) = dt B1' (N - f),   B1 v1 >= -e B1 v,   N in its cone,   N = 0 where it is more
!>
!> At the end of a step that an impact ends, contacts that were closed before have borne f up to it:
!> that is not taken back, and N is what the impact adds. So a closed contact ends at rest if e = 0,
!> whatever the step: v would end with any restitution between 0 and 1, and has never less energy.
!> Without contact the two are the same. All of it is exact to the second order, impacts too.
submodule (dda_step) dda_velocity
   use dda_assembly, only : take_springs
   use dda_bar_springs, only : couple_bars
   use dda_block_inertia, only : damping_rate, hold_energy, kinetic_energy, packed_velocity, &
      & strain_follows
   use dda_contact_types, only : joint_springs_t, place_rows
   use dda_fixed_points, only : add_fixed_springs, hold_rigidly, turn_fixed_row
   use dda_friction_cone, only : joint_face_t
   use dda_settle_in_time, only : settle_in_time
   use dda_spring_products, only : add_load, relative_displacement
   use dda_step_context, only : near_gap
   use dda_vector, only : cross
   implicit none

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

   !> Velocities of the blocks at the end of a settled step
   module procedure settle_velocities
      logical :: closed(2, size(contacts%joint))
      real(wp) :: part(2, size(contacts%joint)), borne(3, size(contacts%joint)), less
      real(wp) :: steady(size(step%state%motion, 1), size(step%state%motion, 2))
      real(wp) :: allowed, before, share
      type(joint_springs_t) :: springs
      integer :: try

      springs = contacts%springs
      call place_rows(system, step%after%motion, step%joint, springs%row)
      closed = closed_contacts(system, contacts, step)
      steady = 2.0_wp/step%dt*step%state%motion &
         & - packed_velocity(system, size(step%state%motion, 1))
      call see_impacts(settings, system, contacts, closed, relative_displacement(springs, steady), &
         & step, part, borne)
      before = kinetic_energy(equations, steady)
      allowed = before - sum(step%state%force*step%state%increment)
      less = least_less
      do try = 0, max_tries
         if (try == max_tries) part = 0.0_wp
         call settle_impulses(settings, system, contacts, springs, closed, part, borne, steady, &
            & equations, step)
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
   end procedure settle_velocities

   !> Velocities for given speeds at which the contacts must part
   pure subroutine settle_impulses(settings, system, contacts, after, closed, part, borne, &
      & steady, equations, step)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> Their springs where the contacts are after it
      type(joint_springs_t), intent(in) :: after
      !> Contacts that are closed: (2, n_joint)
      logical, intent(in) :: closed(:, :)
      !> The speeds: (2, n_joint) [m/s]
      real(wp), intent(in) :: part(:, :)
      !> Forces borne up to an impact that ends the step: (3, n_joint) [N/m]
      real(wp), intent(in) :: borne(:, :)
      !> Velocities by constant acceleration: (n_dof, n_equation)
      real(wp), intent(in) :: steady(:, :)
      type(equations_t), intent(inout) :: equations
      type(step_context_t), intent(inout) :: step
      type(step_state_t) :: state
      type(joint_springs_t) :: springs
      logical :: follows(size(system%equation))
      real(wp) :: held_force(size(equations%fixed%force))
      integer :: j

      follows = strain_follows(system, step%longest)
      held_force = equations%fixed%force
      call assemble_rates(settings, system, follows, after, step%state%force - borne, steady, &
         & step, equations)
      state = step%state
      ! what a speed leaves of a gap counts as in the longest step
      state%fineness = step%state%fineness*finer*step%dt/step%longest
      state%unseen = 10.0_wp*step%state%unseen
      state%rates = .true.
      state%multiplier = state%force - borne
      springs = after
      do j = 1, size(contacts%joint)
         springs%stiffness(j) = over_inertia*joint_mass(system, contacts%joint(j)%block)/step%dt**2
         call keep_closed(closed(:, j), follows(contacts%joint(j)%block), j, springs, state)
         state%start(1:2, j) = state%start(1:2, j) + springs%stiffness(j)*step%dt*part(:, j)
      end do
      call take_springs(equations)
      call settle_in_time(settings, step%dt*equations%fixed%rate, equations, springs, state)
      state%force = state%force + borne
      ! half of the forces of the motion have acted as they did
      step%held_impulse = equations%fixed%force + held_force/2.0_wp
      step%impulse = state%force
      equations%fixed%force = held_force
      step%has_velocity = state%settled
      if (.not. step%has_velocity) return
      step%velocity = state%motion/step%dt
      call keep_moment(system, contacts, after, equations, state%force, step)
   end subroutine settle_impulses

   !> Contacts that are closed at the end of a step: those that carry a force, and those without a
   !> gap
   pure function closed_contacts(system, contacts, step) result(closed)
      type(block_system_t), intent(in) :: system
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

   !> Contacts that have met at the very end of the step, faster than weight makes resting contacts
   !> meet: they must part with restitution times that speed, and up to then contacts that were
   !> closed before the step have borne their forces
   pure subroutine see_impacts(settings, system, contacts, closed, opening, step, part, borne)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> Contacts that are closed at its end: (2, n_joint)
      logical, intent(in) :: closed(:, :)
      !> How fast the contacts open without impacts, and the joints slip: (3, n_joint) [m/s]
      real(wp), intent(in) :: opening(:, :)
      type(step_context_t), intent(in) :: step
      real(wp), intent(out) :: part(:, :)
      !> The forces; none where there is no impact: (3, n_joint) [N/m]
      real(wp), intent(out) :: borne(:, :)
      logical :: has_impact
      integer :: j, k

      part = 0.0_wp
      borne = 0.0_wp
      has_impact = .false.
      do j = 1, size(contacts%joint)
         do k = 1, 2
            if (.not. closed(k, j)) cycle
            if (step%state%face(j)%open(k)) then
               if (-opening(k, j) > step%slowest_impact) then
                  has_impact = .true.
                  part(k, j) = -settings%restitution*opening(k, j)
               end if
            else if (contacts%gap(k, j) <= near_gap(system, contacts%joint(j)%block)) then
               borne([k, 3], j) = step%state%force([k, 3], j)
            end if
         end do
      end do
      if (.not. has_impact) borne = 0.0_wp
   end subroutine see_impacts

   !> Equations of the velocities, as motions v1*dt: M/dt**2 (v1 dt) = M/dt v - B1' f
   pure subroutine assemble_rates(settings, system, follows, springs, force, steady, step, &
      & equations)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> Blocks without strain rates: (n_block)
      logical, intent(in) :: follows(:)
      !> Springs of the joints after the step
      type(joint_springs_t), intent(in) :: springs
      !> Forces that are taken back: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      real(wp), intent(in) :: steady(:, :)
      type(step_context_t), intent(in) :: step
      type(equations_t), intent(inout) :: equations
      integer :: b, e, i, j

      equations%base = (1.0_wp/step%dt + damping_rate(settings, step%dt)/2.0_wp)/step%dt &
         & *equations%mass
      if (size(equations%dashpot) > 0) &
         & equations%base = equations%base + equations%dashpot/(2.0_wp*step%dt)
      do e = 1, size(steady, 2)
         equations%load(:, e) = step%dt*matmul(equations%base(:, :, e), steady(:, e))
      end do
      do j = 1, size(force, 2)
         call add_load(springs, springs%cone(j), joint_face_t(), -force(:, j), j, equations%load)
      end do
      do i = 1, size(equations%fixed%point)
         e = equations%fixed%equation(i)
         call turn_fixed_row(system, settings, i, step%state%motion(:, e), equations%fixed, &
            & equations%load(:, e))
      end do
      do b = 1, size(follows)
         e = system%equation(b)
         if (size(steady, 1) < 6 .or. e == 0 .or. .not. follows(b)) cycle
         equations%base(4:, :3, e) = 0.0_wp
         equations%base(:3, 4:, e) = 0.0_wp
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

      state%start(:, j) = state%multiplier(:, j)
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

   !> Keep the moment of momentum of each pair of blocks: the rows of a joint between turned edges
   !> may lie off one line. The two blocks give back what that brings in by one change of spin
   pure subroutine keep_moment(system, contacts, after, equations, force, step)
      type(block_system_t), intent(in) :: system
      !> The contacts before the step, with the springs that half of the impulses have acted by
      type(contacts_t), intent(in) :: contacts
      !> The springs after it, which the other half acts by
      type(joint_springs_t), intent(in) :: after
      type(equations_t), intent(in) :: equations
      !> The forces of that half: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      !> The step; its spins are changed
      type(step_context_t), intent(inout) :: step
      real(wp) :: change(size(step%velocity, 2)), half_way(6, size(system%area)), moment
      integer :: j, pair(2)

      change = 0.0_wp
      half_way = (system%motion + step%after%motion)/2.0_wp
      do j = 1, size(contacts%joint)
         pair = after%equation(:, j)
         if (any(pair == 0)) cycle
         moment = step%dt/sum(equations%mass(3, 3, pair)) &
            & *(excess(contacts%springs, j, step%state%force(:, j), half_way) &
            & + excess(after, j, force(:, j) - step%state%force(:, j), step%after%motion))
         change(pair) = change(pair) - moment
      end do
      step%velocity(3, :) = step%velocity(3, :) + change

   contains

      !> Moment of the forces of a joint on both its blocks
      pure real(wp) function excess(springs, j, force, motion)
         type(joint_springs_t), intent(in) :: springs
         integer, intent(in) :: j
         !> Its forces: (3) [N/m]
         real(wp), intent(in) :: force(3)
         !> How the blocks have moved: (6, n_block)
         real(wp), intent(in) :: motion(:, :)
         real(wp) :: turn(3)
         integer :: b, side

         excess = 0.0_wp
         do side = 1, 2
            b = contacts%joint(j)%block(side)
            turn = matmul(springs%row(1:3, :, side, j), force)
            excess = excess + turn(3) + cross(system%centroid(:, b) + motion(1:2, b), turn(1:2))
         end do
      end function excess
   end subroutine keep_moment

   !> Springs of contacts whose forces are multipliers
   module procedure stiffen_contacts
      integer :: j

      do j = 1, size(contacts%joint)
         contacts%springs%stiffness(j) = max(contacts%springs%stiffness(j), &
            & over_inertia*joint_mass(system, contacts%joint(j)%block)/dt**2)
         contacts%trial(:, j) = contacts%force(:, j) &
            & - contacts%springs%stiffness(j)*[contacts%gap(1:2, j), 0.0_wp]
      end do
   end procedure stiffen_contacts

   !> Mass of the lighter of the movable blocks of a pair [kg per metre depth]
   pure real(wp) function joint_mass(system, pair)
      type(block_system_t), intent(in) :: system
      !> The two blocks: (2)
      integer, intent(in) :: pair(2)

      joint_mass = minval(system%density(pair)*system%area(pair), mask=system%equation(pair) > 0)
   end function joint_mass

end submodule dda_velocity
