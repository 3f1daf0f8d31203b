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
   use dda_friction_cone, only : shear_bound
   use dda_kinds, only : wp
   use dda_spring_products, only : add_forces, relative_displacement
   use dda_step_context, only : near_gap, run_t, step_outcome_t
   use dda_step_state, only : equations_t
   implicit none
   private

   public :: check_impact, closed_contacts, fall_energy, foresee_event, masked_force
   public :: meeting_contacts, meets_at_end, parting_acceleration

   !> Least share in the energy of motion and of a fall of the longest step of an impact that ends
   !> a step, per squared number of blocks, and the largest
   real(wp), parameter :: min_event_share = 1.0e-6_wp, max_event_share = 1.0e-2_wp

   !> Least change of slip by a reversal that ends a step, over the speed that all this energy would
   !> give there, per cubed number of blocks: more blocks turn more often, and each cut costs more
   real(wp), parameter :: min_change = 1.0e-6_wp

   !> Time of a reversal over the longest step that is its beginning, and most cuts of a step that
   !> may end at one: where blocks are pressed the harder the shorter the step, it comes no nearer
   real(wp), parameter :: at_once = 1.0e-3_wp
   integer, parameter :: max_event_cuts = 10

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

   !> True if a step ends before an impact, if forces stay unchanged from the last step; if not, the
   !> time of that
   pure type(step_outcome_t) function foresee_event(run) result(outcome)
      type(run_t), intent(in) :: run

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (run%march%spare_cuts == 0) return
      outcome = earliest_impact(run, run%step%end_gap + run%step%dt**2/2.0_wp &
         & *parting_acceleration(run%equations, run%contacts%springs, run%equations%outer, &
         & run%contacts%force), may_meet(run))
      outcome%overshoot = run%step%overshoot
   end function foresee_event

   !> True if no impact is inside a solved step and no slip turns there; if not, the time of the
   !> first. A step that comes no nearer to an impact, as where strain closes a gap at once, has it
   !> somewhere
   pure type(step_outcome_t) function check_impact(run) result(outcome)
      type(run_t), intent(in) :: run
      logical :: meets(2, size(run%contacts%joint))
      real(wp) :: turn

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (run%march%spare_cuts == 0) return
      meets = meeting_contacts(run)
      outcome = earliest_impact(run, free_gaps(run, meets), meets)
      if (outcome%overshoot > run%step%overshoot/2.0_wp) &
         & outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      turn = earliest_reversal(run)
      if (turn >= outcome%dt) then
         if (.not. (outcome%accepted .and. run%step%ends_at_turn)) return
         turn = end_of_slip(run)
         if (turn - outcome%dt <= at_once*run%march%longest .or. turn > run%march%longest) return
      end if
      outcome%accepted = .false.
      outcome%ends_at_event = .true.
      outcome%ends_at_turn = .true.
      outcome%dt = turn
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

   !> Time at which the first joint turns its slip in a solved step, which has one friction force of
   !> each joint, and one of the velocities at its end. Slip and its speed there are compared with
   !> those by friction that turns: at its bound up to the moment of rest, and at most so much the
   !> other way afterwards, while closed contacts stay closed. A joint that stuck in the previous
   !> step has no slip to turn: velocities do without those of strain that follows its load
   pure real(wp) function earliest_reversal(run) result(earliest)
      type(run_t), intent(in) :: run
      real(wp) :: back, bound, change, hold, least, loss, m(4, 4), push, slip, turn, way
      integer :: j

      earliest = huge(earliest)
      if (run%step%event_cuts >= max_event_cuts) return
      least = event_energy(run, (min_change*real(size(run%equations%mass, 3), wp)**3)**2)
      do j = 1, size(run%contacts%joint)
         associate (dt => run%step%dt, speed => run%step%speed(3, j), state => run%step%state, &
            & force => run%step%state%force(:, j), before => run%contacts%face(j))
            if (.not. abs(force(3)) > 0.0_wp) cycle
            if (before%slip == 0 .and. .not. all(before%open)) cycle
            way = sign(1.0_wp, speed)
            m = mobility(run, j, closed=force(1:2) > 0.0_wp)
            ! a shear force takes loss times itself from the bound of friction
            loss = -m(3, 4)*state%cone(j)%friction
            bound = loss*force(3) &
               & + shear_bound(state%cone(j), force + run%contacts%springs%shift(:, j))
            hold = bound/(1.0_wp - loss*way)
            back = bound/(1.0_wp + loss*way)
            push = way*(2.0_wp*(state%increment(3, j) - speed*dt)/(m(3, 3)*dt**2) - force(3))
            if (abs(loss) >= 1.0_wp .or. push >= hold) cycle
            turn = abs(speed)/m(3, 3)/(hold - push)
            if (turn <= at_once*run%march%longest .or. turn >= dt) cycle
            slip = abs(speed)*turn/2.0_wp + m(3, 3)*min(0.0_wp, push + back)*(dt - turn)**2/2.0_wp
            ! velocities of joints that slide back have friction that way in all of the step
            change = m(3, 3)*min(max(0.0_wp, -push - back)*(dt - turn), (hold + back)*turn)
            change = max(change, abs(slip - way*state%increment(3, j))/dt)
            if (change**2 > 2.0_wp*m(3, 3)*least) &
               & earliest = min(earliest, turn)
         end associate
      end do
   end function earliest_reversal

   !> Time at which the first joint comes to rest that slides in all of a solved step, by the mean
   !> acceleration of the step: one that has been cut to end there may end too early, as blocks that
   !> move together weigh more than the two of the joint
   pure real(wp) function end_of_slip(run) result(earliest)
      type(run_t), intent(in) :: run
      real(wp) :: loss
      integer :: j

      earliest = huge(earliest)
      if (run%step%event_cuts >= max_event_cuts) return
      do j = 1, size(run%contacts%joint)
         associate (dt => run%step%dt, speed => run%step%speed(3, j))
            if (run%contacts%face(j)%slip == 0 .or. run%step%state%face(j)%slip == 0) cycle
            loss = 2.0_wp*(speed - run%step%state%increment(3, j)/dt)/dt
            if (speed*loss > 0.0_wp) earliest = min(earliest, speed/loss)
         end associate
      end do
   end function end_of_slip

   !> The first impact that is inside a step, by the gaps that the contacts would have at its end
   !> without it
   pure type(step_outcome_t) function earliest_impact(run, gap, meets) result(outcome)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: gap(:, :)    !! Gaps at the end: (3, n_joint) [m]
      logical, intent(in) :: meets(:, :)   !! Contacts that may be hit: (2, n_joint)
      real(wp) :: acceleration, earliest, ease(4, 4), least, meeting, time
      integer :: j, k

      least = 0.0_wp
      if (.not. run%settings%restitution > 0.0_wp) least = event_energy(run, &
         & min_event_share*real(size(run%equations%mass, 3), wp)**2)
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
               ease = mobility(run, j, closed=[.false., .false.])
               if (meeting**2 < 2.0_wp*least*ease(k, k)) cycle
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
   pure real(wp) function event_energy(run, share)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: share  !! Share of the energy of all blocks

      event_energy = min(max_event_share, share)*(kinetic_energy(run%equations, &
         & packed_velocity(run%system, size(run%step%state%motion, 1))) + fall_energy(run))
   end function event_energy

   !> Energy of all blocks after a fall of the longest step [J/m]
   pure real(wp) function fall_energy(run)
      type(run_t), intent(in) :: run

      fall_energy = sum(run%equations%mass(1, 1, :))*(run%step%slowest_impact/2.0_wp)**2/2.0_wp
   end function fall_energy

   !> Mobility of the contacts and the slip of a joint by forces there. Gaps of closed contacts stay
   !> unchanged: their normal forces are eliminated (Gauss). Their sum is the last row and column
   pure function mobility(run, j, closed)
      type(run_t), intent(in) :: run
      integer, intent(in) :: j             !! Number of the joint
      logical, intent(in) :: closed(2)     !! Contacts that stay closed: (2)
      real(wp) :: mobility(4, 4)           !! The mobility; the last without unit: (4, 4) [1/kg]
      real(wp) :: own(2)
      integer :: e, i, k, side

      mobility = 0.0_wp
      mobility(4, :2) = 1.0_wp
      mobility(:2, 4) = 1.0_wp
      do side = 1, 2
         e = run%contacts%springs%equation(side, j)
         if (e == 0) cycle
         associate (row => run%contacts%springs%row(:, :, side, j))
            do i = 1, 3
               do k = 1, 3
                  mobility(:3, k) = mobility(:3, k) &
                     & + row(i, :)*row(i, k)/run%equations%mass(i, i, e)
               end do
            end do
         end associate
      end do
      own = [mobility(1, 1), mobility(2, 2)]
      do k = 1, 2
         ! two corners at one place are one
         if (.not. closed(k) .or. mobility(k, k) <= 1.0e-12_wp*own(k)) cycle
         mobility = mobility - matmul(mobility(:, k:k), mobility(k:k, :))/mobility(k, k)
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
