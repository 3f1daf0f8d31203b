!> Velocities at the end of a dynamic step: the law of impact, equation (M5)
!>
!> The motion D of the step shows which contacts are closed, and what v = 2 D/dt - v0 they would
!> have by constant acceleration. Its forces f have acted half way; where the contacts are at the
!> end, with their rows B1, the forces N that the law of impact asks for replace them, with the same
!> cones, in the metric of mass:
!>
!>    M (v1 - v) = dt B1' (N - f),   B1 v1 >= -e B1 v,   N in its cone,   N = 0 where it is more
!>
!> At the end of a step that an impact ends, f has acted up to it where contacts were closed before:
!> that is not taken back, and N is what the impact adds. So a closed contact ends at rest if e = 0,
!> whatever the step: v would end with any restitution between 0 and 1, and has never less energy.
!> Without contact the two are the same. All of it is exact to the second order, impacts too.
module dda_velocity
   use dda_balance, only : keep_moment, rounding
   use dda_block_inertia, only : damping_rate, drop_strain_rates, hold_energy, kinetic_energy, &
      & packed_velocity, strain_follows
   use dda_contact_solver, only : max_energy_gain
   use dda_contact_types, only : joint_place_t, joint_springs_t, joint_t, place_joint, place_rows
   use dda_impact, only : closed_contacts, fall_energy, masked_force, meeting_contacts, &
      & meets_at_end, parting_acceleration
   use dda_fixed_points, only : add_fixed_springs, turn_fixed_row
   use dda_kinds, only : wp
   use dda_multipliers, only : settle_in_time
   use dda_spring_products, only : add_forces, relative_displacement
   use dda_step_context, only : may_shorten, run_t
   use dda_step_state, only : step_state_t
   implicit none
   private

   public :: solve_impacts

   !> Most impacts of one moment, each by what the one before has left, and most reductions of
   !> restitution in each
   integer, parameter :: max_impacts = 10
   !> Share of mixed velocities, and largest reduction of restitution
   real(wp), parameter :: least_less = 1.0e-7_wp, largest_less = 0.5_wp

   !> Conditions on velocities at the end of a step
   type :: impact_t
      !> Springs of the joints where they are after the step, without rows of open contacts
      type(joint_springs_t) :: springs
      !> Contacts that are closed there: (2, n_joint)
      logical, allocatable :: closed(:, :)
      !> Speeds at which they must part; negative where they part before an impact and may meet
      !> after it (Moreau 1988): (2, n_joint) [m/s]
      real(wp), allocatable :: part(:, :)
      !> Forces up to an impact that ends the step; none where there is none: (3, n_joint) [N/m]
      real(wp), allocatable :: force_before(:, :)
      !> Velocities by constant acceleration, with the moments of pairs kept: (n_dof, n_equation)
      real(wp), allocatable :: steady(:, :)
      !> Energy of motion before moments are kept [J/m]
      real(wp) :: energy = 0.0_wp
      !> Blocks whose strain follows its load: (n_block)
      logical, allocatable :: follows(:)
      !> Rates at which their strain opens the contacts and lets them slip: (3, n_joint) [m/s]
      real(wp), allocatable :: strain_opening(:, :)
   end type impact_t

contains

   !> Velocities of the blocks at the end of a step, if they are found. The change of energy by
   !> contacts is no part of the allowed one; without contacts only restrained points
   !> change it, which turn with their blocks
   pure subroutine solve_impacts(run)
      type(run_t), intent(inout) :: run
      type(impact_t) :: impact
      real(wp) :: allowed, before, share
      integer :: impacts
      logical :: meets

      call see_impacts(run, impact)
      associate (step => run%step, equations => run%equations)
         before = impact%energy
         allowed = before - sum(step%state%force*step%state%increment) + rounding*before
         step%restitution = 1.0_wp
         step%fastest_impact = 0
         if (any(impact%part > 0.0_wp)) &
            & step%fastest_impact = maxloc(maxval(impact%part, dim=1), dim=1)
         call solve_impact(run, impact, allowed, share)
         do impacts = 2, max_impacts
            if (.not. step%has_velocity) return
            call see_next_impact(run, impact, meets)
            if (.not. meets) exit
            call add_impact(run, impact, allowed, share)
         end do
         if (.not. step%has_velocity) return
         ! prescribed points bring in energy of their own, and residuals of contacts end no run
         if (any(impact%closed)) step%has_velocity = any(abs(equations%fixed%rate) > 0.0_wp) &
            & .or. .not. may_shorten(run) .or. &
            & kinetic_energy(equations, step%velocity) <= allowed + allowed_gain(run, before)
         step%mean_force = (1.0_wp - share)*step%mean_force + share*step%state%force
         step%held_mean_force = (1.0_wp - share)*step%held_mean_force + share*equations%fixed%force
         ! what has closed by a force has been stopped on its way, not at its end
         step%impact = before - kinetic_energy(equations, step%velocity) &
            & - sum(step%state%force(1:2, :)*step%state%increment(1:2, :))
      end associate
   end subroutine solve_impacts

   !> Solve one impact. Newton's restitution may bring in energy where there is friction, or where
   !> blocks are hit in several places; then it is reduced
   pure subroutine solve_impact(run, impact, allowed, share)
      type(run_t), intent(inout) :: run
      type(impact_t), intent(inout) :: impact
      real(wp), intent(in) :: allowed  !! Energy of motion that it may leave [J/m]
      !> Share of the velocities before that is mixed in to keep that energy
      real(wp), intent(out) :: share
      integer :: try

      share = 0.0_wp
      associate (step => run%step)
         do try = 0, max_impacts
            if (try == max_impacts) step%restitution = 0.0_wp
            call solve_rates(run, impact, step%restitution)
            if (.not. step%has_velocity) return
            share = 0.0_wp
            if (any(impact%closed)) call hold_energy(run%equations, impact%steady, allowed, &
               & step%velocity, share)
            if (share <= least_less .or. .not. any(step%restitution*impact%part > 0.0_wp)) exit
            step%restitution = (1.0_wp - min(largest_less, 2.0_wp*share))*step%restitution
         end do
      end associate
   end subroutine solve_impact

   !> Solve an impact that follows another one at the same moment: their impulses add up
   pure subroutine add_impact(run, impact, allowed, share)
      type(run_t), intent(inout) :: run
      type(impact_t), intent(inout) :: impact
      real(wp), intent(in) :: allowed
      real(wp), intent(out) :: share
      real(wp) :: force(3, size(run%contacts%joint)), held(2, size(run%equations%fixed%force))

      force = run%step%mean_force - run%step%state%force
      held(1, :) = run%equations%fixed%force
      held(2, :) = run%step%held_mean_force
      run%equations%fixed%force = 0.0_wp
      call solve_impact(run, impact, allowed, share)
      run%equations%fixed%force = held(1, :)
      run%step%mean_force = run%step%mean_force + force
      run%step%held_mean_force = run%step%held_mean_force + held(2, :)
   end subroutine add_impact

   !> Find contacts that were separating before an impact and meet by it, which is the next impact
   pure subroutine see_next_impact(run, impact, meets)
      type(run_t), intent(in) :: run
      type(impact_t), intent(inout) :: impact  !! The impact before in, the next one out
      logical, intent(out) :: meets            !! True if there is one
      real(wp) :: before(3, size(run%contacts%joint))

      meets = any(impact%part < 0.0_wp)
      if (.not. meets) return
      before = relative_displacement(impact%springs, run%step%velocity)
      meets = any(impact%part < 0.0_wp .and. -before(1:2, :) > run%step%slowest_impact)
      if (.not. meets) return
      impact%steady = run%step%velocity
      impact%force_before = run%step%state%force
      impact%part = merge(-run%settings%restitution*before(1:2, :), 0.0_wp, &
         & impact%closed .and. abs(before(1:2, :)) > run%step%slowest_impact)
   end subroutine see_next_impact

   !> Energy that contacts may add in a step [J/m]
   pure real(wp) function allowed_gain(run, kinetic)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: kinetic  !! Energy of motion [J/m]

      allowed_gain = max_energy_gain*(kinetic + run%march%energy%elastic &
         & + fall_energy(run) + sum(abs(run%equations%outer*run%step%state%motion)))
   end function allowed_gain

   !> Find contacts that are closed at the end of a step, and those that have met in it, faster than
   !> weight makes resting contacts meet: they must part with restitution times that speed. If they
   !> have met at the end of the step, the forces of all others have acted up to then
   pure subroutine see_impacts(run, impact)
      type(run_t), intent(in) :: run
      type(impact_t), intent(out) :: impact
      real(wp) :: before(3, size(run%contacts%joint))
      logical :: at_end, meets(2, size(run%contacts%joint))
      type(joint_t) :: joint(size(run%contacts%joint))
      type(joint_place_t) :: place(size(run%contacts%joint))
      real(wp) :: gap(3)
      integer :: j, side

      allocate (impact%closed, source=closed_contacts(run))
      impact%springs = run%contacts%springs
      joint = run%contacts%joint
      do j = 1, size(joint)
         ! friction acts where the blocks touch
         if (joint(j)%n_contact == 2 .and. count(impact%closed(:, j)) == 1) &
            & joint(j)%contact%share = merge(1.0_wp, 0.0_wp, impact%closed(:, j))
         call place_joint(run%step%after%moved, joint(j), place(j), gap)
      end do
      call place_rows(run%system, run%step%after%motion, joint, place, impact%springs%row)
      impact%follows = strain_follows(run%system, run%march%longest)
      impact%strain_opening = strain_opening(run, impact%follows, impact%springs)
      do j = 1, size(joint)
         do side = 1, 2
            if (impact%follows(joint(j)%block(side))) impact%springs%row(4:, :, side, j) = 0.0_wp
         end do
      end do
      meets = meeting_contacts(run)
      at_end = meets_at_end(run, meets)
      associate (start => packed_velocity(run%system, size(run%step%state%motion, 1)))
         impact%steady = 2.0_wp/run%step%dt*run%step%state%motion - start
         impact%energy = kinetic_energy(run%equations, impact%steady)
         call keep_moment(run, impact%steady)
         if (at_end) then
            before = relative_displacement(impact%springs, impact%steady) - run%step%dt &
               & *parting_acceleration(run%equations, run%contacts%springs, 0.0_wp*start, &
               & masked_force(run, meets))
         else
            before = relative_displacement(impact%springs, start)
         end if
      end associate
      impact%part = merge(-run%settings%restitution*before(1:2, :), 0.0_wp, &
         & meets .and. -before(1:2, :) > run%step%slowest_impact)
      ! others part already: stopped on their way by an impact they would bring in energy
      if (any(impact%part > 0.0_wp)) where (before(1:2, :) > run%step%slowest_impact) &
         & impact%part = -run%settings%restitution*before(1:2, :)
      impact%force_before = run%step%state%force - masked_force(run, meets)
      if (.not. (at_end .and. any(meets))) impact%force_before = 0.0_wp
      call drop_open_rows(impact%closed, impact%springs)
   end subroutine see_impacts

   !> Let springs act at closed contacts alone
   pure subroutine drop_open_rows(closed, springs)
      logical, intent(in) :: closed(:, :)  !! Contacts that are closed: (2, n_joint)
      type(joint_springs_t), intent(inout) :: springs
      integer :: j, k

      do j = 1, size(closed, 2)
         do k = 1, 2
            if (closed(k, j)) cycle
            springs%row(:, k, :, j) = 0.0_wp
            springs%shift(k, j) = 0.0_wp
         end do
         if (.not. any(closed(:, j))) springs%row(:, 3, :, j) = 0.0_wp
      end do
   end subroutine drop_open_rows

   !> Rates at the end of a step at which strain that follows its load opens contacts. They are
   !> extrapolated from the mean rates of this step and the one before, which is exact to the second
   !> order and damps what steps do not resolve (BDF2: Gear 1971), by at most half of the mean
   !> rate
   pure function strain_opening(run, follows, springs) result(opening)
      type(run_t), intent(in) :: run
      logical, intent(in) :: follows(:)                !! Blocks of such strain: (n_block)
      type(joint_springs_t), intent(in) :: springs     !! Where the joints are after the step
      real(wp) :: opening(3, size(springs%stiffness))  !! Rates: (3, n_joint) [m/s]
      real(wp), dimension(size(run%step%state%motion, 1), size(run%step%state%motion, 2)) :: &
         & mean, before
      integer :: b, e

      mean = 0.0_wp
      before = 0.0_wp
      do b = 1, merge(size(follows), 0, size(mean, 1) == 6)
         e = run%system%equation(b)
         if (e == 0 .or. .not. follows(b)) cycle
         mean(4:, e) = run%step%state%motion(4:, e)/run%step%dt
         before(4:, e) = run%system%strain_rate(:, b)
      end do
      opening = relative_displacement(springs, mean)
      associate (change => opening - relative_displacement(springs, before))
         opening = opening + sign(min(abs(change), abs(opening)), change)/2.0_wp
      end associate
   end function strain_opening

   !> Velocities for given speeds at which the contacts must part
   pure subroutine solve_rates(run, impact, restitution)
      type(run_t), intent(inout) :: run
      type(impact_t), intent(inout) :: impact
      real(wp), intent(in) :: restitution  !! Share of the restitution that is applied
      type(step_state_t) :: state
      real(wp) :: held_force(size(run%equations%fixed%force))

      held_force = run%equations%fixed%force
      call assemble_rates(run, impact)
      call begin_rates(run, impact, restitution, state)
      associate (step => run%step, fixed => run%equations%fixed)
         call settle_in_time(step%dt*fixed%rate, run%equations, impact%springs, state)
         step%mean_force = state%force + impact%force_before
         ! half of the forces of the motion have acted as they did
         step%held_mean_force = fixed%force + held_force/2.0_wp
         fixed%force = held_force
         step%residual = state%residual/step%dt
         step%worst = state%worst
         step%has_velocity = state%settled
         if (.not. step%has_velocity) return
         step%velocity = state%motion/step%dt
      end associate
   end subroutine solve_rates

   !> Equations of the velocities, as motions v1*dt: M/dt**2 (v1 dt) = M/dt v - B1' f
   pure subroutine assemble_rates(run, impact)
      type(run_t), intent(inout) :: run
      type(impact_t), intent(in) :: impact
      integer :: e, i

      associate (dt => run%step%dt, equations => run%equations, springs => impact%springs)
         equations%base = (1.0_wp/dt + damping_rate(run%settings, dt)/2.0_wp)/dt*equations%mass
         if (size(equations%dashpot) > 0) &
            & equations%base = equations%base + equations%dashpot/(2.0_wp*dt)
         do e = 1, size(impact%steady, 2)
            equations%load(:, e) = dt*matmul(equations%base(:, :, e), impact%steady(:, e))
         end do
         call add_forces(springs, impact%force_before - run%step%state%force, equations%load)
         do i = 1, size(equations%fixed%point)
            e = equations%fixed%equation(i)
            call turn_fixed_row(run%system, run%settings, i, run%step%state%motion(:, e), &
               & equations%fixed, equations%load(:, e))
         end do
         call drop_strain_rates(run%system%equation, impact%follows, equations)
         call add_fixed_springs(equations%fixed, dt*equations%fixed%rate, equations%base, &
            & equations%load)
         equations%new_numbers = .true.
      end associate
   end subroutine assemble_rates

   !> Forces that the search for velocities begins with, and gaps that it closes
   pure subroutine begin_rates(run, impact, restitution, state)
      type(run_t), intent(in) :: run
      type(impact_t), intent(in) :: impact
      real(wp), intent(in) :: restitution
      type(step_state_t), intent(out) :: state
      real(wp) :: part(3)
      logical :: bears(2)
      integer :: j

      state%motion = run%step%state%motion
      state%force = run%step%state%force - impact%force_before
      allocate (state%gap, mold=state%force)
      state%rates = .true.
      ! speeds are found to the same digits in short steps
      state%fineness = run%step%state%fineness*min(1.0_wp, run%step%dt/run%march%longest)
      state%fall = run%step%state%fall
      do j = 1, size(run%contacts%joint)
         associate (closed => impact%closed(:, j))
            state%force(:, j) = merge(state%force(:, j), 0.0_wp, [closed, any(closed)])
            part = [restitution*impact%part(:, j), 0.0_wp]
            ! strain pushes no contact apart that bore nothing before, or a force of its own
            bears = closed .and. run%contacts%force(1:2, j) > 0.0_wp &
               & .and. .not. run%contacts%face(j)%idle
         end associate
         where ([bears, any(bears)]) part = part - impact%strain_opening(:, j)
         state%gap(:, j) = -run%step%dt*part
      end do
   end subroutine begin_rates

end module dda_velocity
