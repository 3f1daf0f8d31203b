!> Impacts of a step: contacts, speeds, and times
!>
!> A contact meets if it is closed at the end of a step, was open before or closed in faster than
!> what rests, and is hit faster than gravity makes resting contacts meet. Its gap and its speed are
!> those of the motion without the forces of all contacts that meet. Then no answer depends on
!> whether the motion of the step has closed it by a force, or it has come to lie there by itself.
!> A step is cut to end at its first impact, as long as steps to spare last; later impacts are taken
!> together at the end of the step (Moreau's time stepping).
module dda_impact
   use dda_block_inertia, only : kinetic_energy, packed_velocity
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : cone_t
   use dda_kinds, only : wp
   use dda_spring_products, only : add_forces, relative_displacement
   use dda_step_context, only : near_gap, run_t, step_outcome_t
   use dda_step_state, only : equations_t
   implicit none
   private

   public :: check_impact, closed_contacts, fall_energy, foresee_event, masked_force
   public :: meeting_contacts, meets_at_end, parting_acceleration

   !> Least and largest energy of an impact that ends a step, over that of motion and of a fall of
   !> the longest step, per squared number of blocks
   real(wp), parameter :: min_event_energy = 1.0e-6_wp, max_event_energy = 1.0e-2_wp

   !> Slip of a reversal over the slowest impact
   real(wp), parameter :: at_once = 1.0e-3_wp

contains

   !> Contacts that are closed at the end of a step: those that carry a force, and those without a
   !> gap. Other corners of a block that is hit meet at the same time what strain alone keeps apart
   pure function closed_contacts(run) result(closed)
      type(run_t), intent(in) :: run
      !> For each contact of each joint: (2, n_joint)
      logical :: closed(2, size(run%contacts%joint))
      logical :: may(2, size(run%contacts%joint))
      real(wp) :: gap(2, size(run%contacts%joint)), moved(size(run%system%area))
      integer :: j, k

      gap = huge(gap)
      do j = 1, size(closed, 2)
         do k = 1, run%contacts%joint(j)%n_contact
            gap(k, j) = run%step%end_gap(k, j) - near_gap(run%system, run%contacts%joint(j)%block)
            closed(k, j) = .not. run%step%state%face(j)%open(k)
         end do
      end do
      closed = merge(closed .or. gap <= 0.0_wp, .false., gap < huge(gap))
      if (run%settings%n_dof < 6) return
      may = may_meet(run)
      moved = 0.0_wp
      do j = 1, size(closed, 2)
         associate (pair => run%contacts%joint(j)%block)
            if (any(closed(:, j) .and. may(:, j))) moved(pair) = strain_motion(run, pair)
         end associate
      end do
      do j = 1, size(closed, 2)
         closed(:, j) = closed(:, j) .or. gap(:, j) <= sum(moved(run%contacts%joint(j)%block))
      end do
   end function closed_contacts

   !> Most that strain moves the corners of a block against one another, before a step or after [m]
   elemental real(wp) function strain_motion(run, block)
      type(run_t), intent(in) :: run
      integer, intent(in) :: block  !! Number of the block

      associate (corner => run%system%moved(:, run%system%first_vertex(block): &
         & run%system%first_vertex(block + 1) - 1))
         strain_motion = norm2(maxval(corner, dim=2) - minval(corner, dim=2)) &
            & *max(sum(abs(run%system%motion(4:, block))), &
            & sum(abs(run%step%after%motion(4:, block))))
      end associate
   end function strain_motion

   !> Contacts that may be hit in a step: open at its beginning, or closing in there
   pure function may_meet(run)
      type(run_t), intent(in) :: run
      logical :: may_meet(2, size(run%contacts%joint))  !! For each contact: (2, n_joint)
      integer :: j, k

      may_meet = .false.
      do j = 1, size(may_meet, 2)
         do k = 1, run%contacts%joint(j)%n_contact
            may_meet(k, j) = -run%step%speed(k, j) > run%step%slowest_impact .or. &
               & run%contacts%gap(k, j) > near_gap(run%system, run%contacts%joint(j)%block)
         end do
      end do
   end function may_meet

   !> Contacts that are closed at the end of a step and may have been hit in it
   pure function meeting_contacts(run) result(meets)
      type(run_t), intent(in) :: run
      logical :: meets(2, size(run%contacts%joint))  !! For each contact: (2, n_joint)

      meets = closed_contacts(run) .and. may_meet(run)
   end function meeting_contacts

   !> Forces of the step at some contacts; the shear force of a joint goes with them if it has no
   !> other closed contact
   pure function masked_force(run, mask) result(force)
      type(run_t), intent(in) :: run
      logical, intent(in) :: mask(:, :)  !! The contacts: (2, n_joint)
      real(wp) :: force(3, size(mask, 2))  !! Their forces: (3, n_joint) [N/m]

      force(1:2, :) = merge(run%step%state%force(1:2, :), 0.0_wp, mask)
      force(3, :) = merge(run%step%state%force(3, :), 0.0_wp, any(mask, dim=1) .and. .not. &
         & any(abs(run%step%state%force(1:2, :)) > 0.0_wp .and. .not. mask, dim=1))
   end function masked_force

   !> Acceleration at which loads and forces of joints part the contacts
   pure function parting_acceleration(equations, springs, load, force) result(parting)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      real(wp), intent(in) :: load(:, :)           !! Loads of the blocks: (n_dof, n_equation)
      real(wp), intent(in) :: force(:, :)          !! Forces of the joints: (3, n_joint) [N/m]
      real(wp) :: parting(3, size(force, 2))       !! Of gaps and slips: (3, n_joint) [m/s2]
      real(wp) :: free(size(load, 1), size(load, 2))
      integer :: i

      free = load
      call add_forces(springs, force, free)
      do i = 1, 3
         free(i, :) = free(i, :)/equations%mass(i, i, :)
      end do
      free(4:, :) = 0.0_wp
      parting = relative_displacement(springs, free)
   end function parting_acceleration

   !> True if a step ends before an impact, and before slip turns, if forces stay unchanged from
   !> the last step; if not, the time of that
   pure type(step_outcome_t) function foresee_event(run) result(outcome)
      type(run_t), intent(in) :: run
      real(wp) :: acceleration(3, size(run%contacts%joint)), turn

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (run%march%spare_cuts == 0) return
      acceleration = parting_acceleration(run%equations, run%contacts%springs, &
         & run%equations%outer, run%contacts%force)
      outcome = earliest_impact(run, run%step%end_gap + run%step%dt**2/2.0_wp*acceleration, &
         & may_meet(run))
      outcome%overshoot = run%step%overshoot
      if (run%step%ends_at_event) return
      turn = earliest_reversal(run, acceleration)
      if (turn >= outcome%dt) return
      outcome%accepted = .false.
      outcome%ends_at_event = .true.
      outcome%dt = turn
   end function foresee_event

   !> True if a solved step ends at an impact, or has none; if not, the time of that. A step that
   !> comes no nearer to an impact, as where strain closes a gap at once, has it somewhere
   pure type(step_outcome_t) function check_impact(run) result(outcome)
      type(run_t), intent(in) :: run
      logical :: meets(2, size(run%contacts%joint))

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (run%march%spare_cuts == 0) return
      meets = meeting_contacts(run)
      outcome = earliest_impact(run, free_gaps(run, meets), meets)
      if (outcome%overshoot > run%step%overshoot/2.0_wp) &
         & outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
   end function check_impact

   !> Gaps at the end of a solved step if contacts that meet in it had borne no force
   pure function free_gaps(run, meets) result(gap)
      type(run_t), intent(in) :: run
      logical, intent(in) :: meets(:, :)         !! The contacts: (2, n_joint)
      real(wp) :: gap(3, size(meets, 2))         !! The gaps: (3, n_joint) [m]

      gap = run%step%end_gap - run%step%dt**2/2.0_wp*parting_acceleration(run%equations, &
         & run%contacts%springs, 0.0_wp*run%equations%outer, masked_force(run, meets))
   end function free_gaps

   !> True if contacts that meet in a solved step do so at its end, so that all others have borne
   !> their forces up to then
   pure logical function meets_at_end(run, meets)
      type(run_t), intent(in) :: run
      logical, intent(in) :: meets(:, :)  !! The contacts: (2, n_joint)
      real(wp) :: gap(3, size(meets, 2))
      integer :: j

      gap = free_gaps(run, meets)
      meets_at_end = .true.
      do j = 1, size(meets, 2)
         if (any(meets(:, j) .and. gap(1:2, j) < -near_gap(run%system, &
            & run%contacts%joint(j)%block))) meets_at_end = .false.
      end do
   end function meets_at_end

   !> Time at which the first joint that slides begins to slide back, for friction turns with it:
   !> its slip comes to rest under the forces of the last step, and the load on it then exceeds
   !> friction the other way. A corner that alone carries its block rolls: there friction takes
   !> little energy, but carries much between translation and rotation of the block
   pure real(wp) function earliest_reversal(run, acceleration) result(earliest)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: acceleration(:, :)  !! Of gaps and slips: (3, n_joint) [m/s2]
      real(wp), dimension(3, size(run%contacts%joint)) :: free, translation
      real(wp) :: back, ease(3, 3), least, now, power, shear
      real(wp) :: velocity(size(run%step%state%motion, 1), size(run%step%state%motion, 2))
      integer :: corner(size(run%contacts%joint)), j

      earliest = huge(earliest)
      least = event_energy(run)
      corner = lone_corners(run)
      velocity = packed_velocity(run%system, size(velocity, 1))
      ! blocks that turn change slips without a force
      free = acceleration + 2.0_wp/run%step%dt*(relative_displacement(run%contacts%springs, &
         & velocity) - run%step%speed)
      velocity(3:, :) = 0.0_wp
      translation = relative_displacement(run%contacts%springs, velocity)
      do j = 1, size(corner)
         associate (slip => run%step%speed(3, j), force => run%contacts%force(:, j), &
            & cone => run%contacts%springs%cone(j))
            ease = mobility(run, merge(3, 2, corner(j) > 0), j)
            if (corner(j) > 0) then
               free(:, j) = free(:, j) - matmul(ease, force)
               call slide(cone, corner(j), ease, free(:, j), sign(1.0_wp, slip), back, shear)
               call slide(cone, corner(j), ease, free(:, j), -sign(1.0_wp, slip), now, shear)
               power = shear*abs(translation(3, j))
            else
               now = acceleration(3, j)
               back = now - 2.0_wp*ease(3, 3)*force(3)
               power = abs(force(3)*slip)
            end if
            if (.not. power > 0.0_wp .or. power*run%step%dt < 2.0_wp*least) cycle
            if (abs(slip) <= at_once*max(run%step%slowest_impact, abs(now)*run%step%dt)) cycle
            if (slip*now < 0.0_wp .and. slip*back < 0.0_wp) earliest = min(earliest, -slip/now)
         end associate
      end do
   end function earliest_reversal

   !> Slip of a corner that stays on its edge, by friction in a given direction. Its normal force
   !> keeps the gap: 0 = free + ease (normal, shear), shear = +-(limit + friction normal)
   pure subroutine slide(cone, k, ease, free, way, acceleration, shear)
      type(cone_t), intent(in) :: cone
      integer, intent(in) :: k               !! Number of the contact in its joint
      real(wp), intent(in) :: ease(3, 3)     !! Mobility of its two blocks [1/kg]
      real(wp), intent(in) :: free(3)        !! Acceleration without its force [m/s2]
      real(wp), intent(in) :: way            !! Direction of the friction, 1 or -1
      real(wp), intent(out) :: acceleration  !! Acceleration of the slip [m/s2]
      real(wp), intent(out) :: shear         !! Friction; 0 where no force keeps the corner [N/m]
      real(wp) :: normal

      normal = -(free(k) + way*cone%limit*ease(k, 3))/(ease(k, k) + way*cone%friction*ease(k, 3))
      shear = 0.0_wp
      if (normal > 0.0_wp) shear = cone%limit + cone%friction*normal
      acceleration = free(3) + ease(3, k)*max(0.0_wp, normal) + way*shear*ease(3, 3)
   end subroutine slide

   !> Contact of each joint that alone carries one of its blocks; 0 where there is none
   pure function lone_corners(run) result(corner)
      type(run_t), intent(in) :: run
      integer :: corner(size(run%contacts%joint))  !! Number of the contact: (n_joint)
      integer :: e, j, n(size(run%equations%mass, 3)), side
      logical :: touches(2, size(run%contacts%joint))

      n = 0
      do j = 1, size(corner)
         associate (joint => run%contacts%joint(j))
            touches(:, j) = run%contacts%gap(1:2, j) <= near_gap(run%system, joint%block)
            touches(joint%n_contact + 1:, j) = .false.
         end associate
         do side = 1, 2
            e = run%contacts%springs%equation(side, j)
            if (e > 0) n(e) = n(e) + count(touches(:, j))
         end do
      end do
      corner = 0
      do j = 1, size(corner)
         do side = 1, 2
            e = run%contacts%springs%equation(side, j)
            if (e == 0 .or. count(touches(:, j)) /= 1) cycle
            if (n(e) == 1) corner(j) = findloc(touches(:, j), .true., dim=1)
         end do
      end do
   end function lone_corners

   !> The first impact that is inside a step, by the gaps that the contacts would have at its end
   !> without it
   pure type(step_outcome_t) function earliest_impact(run, gap, meets) result(outcome)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: gap(:, :)    !! Gaps at the end: (3, n_joint) [m]
      logical, intent(in) :: meets(:, :)   !! Contacts that may be hit: (2, n_joint)
      real(wp) :: acceleration, earliest, least, meeting, time
      integer :: j, k

      least = 0.0_wp
      if (.not. run%settings%restitution > 0.0_wp) least = event_energy(run)
      earliest = huge(earliest)
      outcome%overshoot = 0.0_wp
      associate (dt => run%step%dt, start => run%contacts%gap, speed => run%step%speed)
         do j = 1, size(gap, 2)
            do k = 1, run%contacts%joint(j)%n_contact
               if (.not. meets(k, j)) cycle
               associate (near => near_gap(run%system, run%contacts%joint(j)%block))
                  if (start(k, j) <= near .or. gap(k, j) >= 0.0_wp) cycle
                  acceleration = 2.0_wp*(gap(k, j) - start(k, j) - speed(k, j)*dt)/dt**2
                  ! a contact that ends just open bears no force in the step
                  time = falling_time(max(0.0_wp, start(k, j) - run%equations%gap_noise), &
                     & -speed(k, j), -acceleration)
               end associate
               meeting = -speed(k, j) - acceleration*min(time, dt)
               if (meeting <= 0.0_wp .or. run%settings%restitution > 0.0_wp &
                  & .and. meeting <= run%step%slowest_impact) cycle
               if (meeting**2 < 2.0_wp*least*ease_of(run, k, j)) cycle
               earliest = min(earliest, time)
               outcome%overshoot = max(outcome%overshoot, -gap(k, j))
            end do
         end do
         outcome%accepted = earliest >= dt
         outcome%ends_at_event = .not. outcome%accepted
         outcome%dt = min(dt, earliest)
      end associate
   end function earliest_impact

   !> Energy of an event that ends a step [J/m]
   pure real(wp) function event_energy(run)
      type(run_t), intent(in) :: run

      event_energy = min(max_event_energy, &
         & min_event_energy*real(size(run%equations%mass, 3), wp)**2) &
         & *(kinetic_energy(run%equations, packed_velocity(run%system, &
         & size(run%step%state%motion, 1))) &
         & + fall_energy(run))
   end function event_energy

   !> Energy of all blocks after a fall of the longest step [J/m]
   pure real(wp) function fall_energy(run)
      type(run_t), intent(in) :: run

      fall_energy = sum(run%equations%mass(1, 1, :))*(run%step%slowest_impact/2.0_wp)**2/2.0_wp
   end function fall_energy

   !> Mobility of two blocks at a contact that is hit [1/kg]
   pure real(wp) function ease_of(run, k, j) result(ease)
      type(run_t), intent(in) :: run
      integer, intent(in) :: k  !! Number of the contact in the joint
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: of_joint(3, 3)

      of_joint = mobility(run, 3, j)
      ease = of_joint(k, k)
   end function ease_of

   !> Accelerations of gaps and slip of a joint by unit forces [1/kg]
   pure function mobility(run, n, j)
      type(run_t), intent(in) :: run
      !> Number of unknowns that move: 3, or 2 where shear does not turn blocks that lie on one
      !> another
      integer, intent(in) :: n
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: mobility(3, 3)
      integer :: e, i, k, side

      mobility = 0.0_wp
      do side = 1, 2
         e = run%contacts%springs%equation(side, j)
         if (e == 0) cycle
         do i = 1, n
            associate (row => run%contacts%springs%row(i, :, side, j))
               do k = 1, 3
                  mobility(:, k) = mobility(:, k) + row*row(k)/run%equations%mass(i, i, e)
               end do
            end associate
         end do
      end do
   end function mobility

   !> Time to cover a distance at constant acceleration
   pure real(wp) function falling_time(way, speed, acceleration)
      real(wp), intent(in) :: way           !! The distance, positive [m]
      real(wp), intent(in) :: speed         !! Speed at the beginning [m/s]
      real(wp), intent(in) :: acceleration  !! Acceleration [m/s2]
      real(wp) :: square, root

      falling_time = huge(falling_time)
      square = speed**2 + 2.0_wp*acceleration*way
      if (square < 0.0_wp) return
      root = speed + sqrt(square)
      if (root > 0.0_wp) falling_time = 2.0_wp*way/root
   end function falling_time
end module dda_impact
