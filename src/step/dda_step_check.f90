!> Whether a try of a step counts, and what the next try changes if it does not
submodule (dda_step) dda_step_check
   use dda_block_inertia, only : kinetic_energy, packed_velocity
   use dda_block_system, only : block_system_t
   use dda_block_update, only : update_blocks, update_contacts
   use dda_contact_transfer, only : renew_contacts
   use dda_contacts, only : contacts_t
   use dda_parting_line, only : block_gap
   use dda_spring_products, only : relative_displacement
   use dda_step_context, only : near_gap
   use dda_step_interval, only : check_length
   use dda_step_reach, only : check_margins, travel_by, travel_of, widen_margins
   use dda_step_state, only : equations_t
   implicit none

   !> Gap or depth that is no matter, over the size of the smaller block
   real(wp), parameter :: no_matter = 1.0e-6_wp
   !> Choices of the lines by the way the blocks have taken
   integer, parameter :: max_choices = 2
   !> Steps shorter than this share of the longest one are not cut further
   real(wp), parameter :: shortest = 1.0e-3_wp
   !> Depth that counts as entered, over the size of the smaller block
   real(wp), parameter :: deep = 2.0e-4_wp
   !> Without restitution only impacts end a step that carry this share of the energy of motion, and
   !> of what the longest step of free fall adds to it: in a pile of many blocks none does, and its
   !> steps stay as long as they are
   real(wp), parameter :: notable = 1.0e-2_wp

contains

   !> Check the motion of a try
   module procedure check_motion
      logical :: searched

      searched = run%contacts%searched .and. run%settings%current
      outcome = check_length(run)
      if (outcome%accepted .and. searched) outcome = check_margins(run)
      if (.not. in_time(run)) return
      if (outcome%accepted) outcome = check_impact(run)
      if (outcome%accepted .and. searched) outcome = check_axes(run)
   end procedure check_motion

   !> Check the velocities of a try: settled, and no corner inside a neighbour
   module procedure check_speeds
      outcome = step_outcome_t(accepted=run%step%has_velocity, dt=run%step%dt)
      if (.not. outcome%accepted) outcome = half_step(run)
      if (outcome%accepted .and. run%contacts%searched) outcome = check_penetration(run)
   end procedure check_speeds

   !> Try half the step
   pure type(step_outcome_t) function half_step(run)
      type(run_t), intent(in) :: run

      half_step = step_outcome_t(dt=run%step%dt/2.0_wp, was_cut=.true.)
   end function half_step

   !> Change for the next try what the checks ask for: its length, margins, axes
   module procedure retry
      associate (step => run%step)
         if (outcome%dt < step%dt) step%choices = 0
         run%march%dt = outcome%dt
         step%was_cut = step%was_cut .or. outcome%was_cut
         step%renews = outcome%beyond_margin .or. outcome%wrong_axes
         step%is_solved = step%renews .and. in_time(run)
         if (outcome%beyond_margin) &
            & call widen_margins(run%system, step%state%motion, run%march%reach)
         if (.not. outcome%wrong_axes) return
         step%choices = step%choices + 1
         step%travel = travel_by(run%system, step%state%motion)
      end associate
   end procedure retry

   !> Check the separating axes of a settled step
   module procedure check_axes
      real(wp) :: before, gap, level, matters, told
      logical :: entered, held_off
      integer :: j

      entered = .false.
      held_off = .false.
      associate (system => run%system, step => run%step)
         do j = 1, size(run%contacts%joint)
            associate (block => run%contacts%joint(j)%block, n => run%contacts%joint(j)%n_contact)
               if (.not. all(run%contacts%search%outline%convex(block))) cycle
               matters = no_matter*sqrt(minval(system%area(block)))
               gap = block_gap(system%first_vertex, step%after%moved, block)
               ! what forces have left at the contacts themselves is no fault of their line, nor is
               ! the depth at which they are closed
               told = minval(step%end_gap(:n, j))
               level = minval(step%end_gap(:n, j) + run%contacts%joint(j)%contact(:n)%closed_at)
               if (gap > max(0.0_wp, told) + matters .and. .not. all(step%state%face(j)%open)) &
                  & held_off = .true.
               if (gap > -matters) cycle
               before = min(0.0_wp, block_gap(system%first_vertex, system%moved, block))
               if (gap < min(before + min(0.0_wp, told), level) - matters) entered = .true.
            end associate
         end do
         outcome%dt = step%dt
         outcome%wrong_axes = (entered .or. held_off) .and. step%choices < max_choices
         outcome%accepted = .not. outcome%wrong_axes
         if (outcome%accepted .and. entered .and. step%dt > shortest*run%march%longest) &
            & outcome = half_step(run)
      end associate
   end procedure check_axes

   !> Check that a search at the end of a step finds no corners deeper inside than they were at its
   !> beginning, by another edge than that of their contact, where a block with a notch is one of
   !> the two
   pure type(step_outcome_t) function check_penetration(run) result(outcome)
      type(run_t), intent(in) :: run
      type(block_system_t) :: after
      type(contacts_t) :: found
      logical :: breaks

      outcome = step_outcome_t(accepted=.true., dt=run%step%dt)
      if (all(run%contacts%search%outline%convex) &
         & .or. run%step%dt <= shortest*run%march%longest) return
      after = run%system
      found = run%contacts
      call update_contacts(run%step, run%settings, found, breaks)
      call update_blocks(run%step, run%settings, after)
      call renew_contacts(after, travel_of(after, run%settings, run%march, found), &
         & run%march%reach, run%settings%penalty_ratio, run%settings%n_dof, found)
      if (depth(after, found) > max(deep, 1.1_wp*depth(run%system, run%contacts))) &
         & outcome = half_step(run)
   end function check_penetration

   !> How deep the deepest corner is, over the size of the smaller block
   pure real(wp) function depth(system, contacts)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer :: j

      depth = 0.0_wp
      do j = 1, size(contacts%joint)
         associate (n => contacts%joint(j)%n_contact, block => contacts%joint(j)%block)
            if (all(contacts%search%outline%convex(block))) cycle
            depth = max(depth, -minval(contacts%gap(:n, j)) /sqrt(minval(system%area(block))))
         end associate
      end do
   end function depth

   !> Check that no open contact closes fast within the step, for the speed at that very moment
   !> counts, and the time that is left after it
   module procedure check_impact
      real(wp), dimension(3, size(run%contacts%joint)) :: speed, acceleration
      real(wp) :: near, earliest, least, meeting, time
      logical :: solved
      integer :: j, k

      solved = run%step%state%settled
      associate (velocity => packed_velocity(run%system, size(run%step%state%motion, 1)))
         speed = relative_displacement(run%contacts%springs, velocity)
         least = merge(0.0_wp, notable, run%settings%restitution > 0.0_wp) &
            & *(kinetic_energy(run%equations, velocity) &
            & + sum(run%equations%mass(1, 1, :))*run%step%slowest_impact**2/8.0_wp)
      end associate
      acceleration = relative_displacement(run%contacts%springs, free_accelerations(run%equations))
      earliest = huge(earliest)
      do j = 1, size(run%contacts%joint)
         near = near_gap(run%system, run%contacts%joint(j)%block)
         do k = 1, run%contacts%joint(j)%n_contact
            if (run%contacts%gap(k, j) <= near) cycle
            if (solved .and. run%step%state%face(j)%open(k)) cycle
            time = falling_time(run%contacts%gap(k, j) - near/2.0_wp, -speed(k, j), &
               & -acceleration(k, j))
            meeting = -speed(k, j) - acceleration(k, j)*min(time, run%step%dt)
            if (meeting <= run%step%slowest_impact) cycle
            if (meeting**2 < 2.0_wp*least*ease_of(run, k, j)) cycle
            ! what meets at the end of a step has met where it should
            if (.not. solved .or. time > 1.001_wp*run%step%dt) earliest = min(earliest, time)
         end do
      end do
      outcome = step_outcome_t(accepted=earliest > merge(2.0_wp, 0.999_wp, solved)*run%step%dt, &
         & dt=run%step%dt)
      if (.not. outcome%accepted) outcome%dt = merge(run%step%dt/2.0_wp, earliest, solved)
   end procedure check_impact

   !> Accelerations of the blocks if nothing touched them
   pure function free_accelerations(equations) result(free)
      type(equations_t), intent(in) :: equations
      !> The accelerations; those of strains are none: (n_dof, n_equation)
      real(wp) :: free(size(equations%outer, 1), size(equations%outer, 2))
      integer :: i

      free = 0.0_wp
      do i = 1, 3
         free(i, :) = equations%outer(i, :)/equations%mass(i, i, :)
      end do
   end function free_accelerations

   !> How easily an impact at a contact moves its two blocks
   pure real(wp) function ease_of(run, k, j) result(ease)
      type(run_t), intent(in) :: run
      integer, intent(in) :: k  !! Which contact of the joint
      integer, intent(in) :: j  !! Number of the joint
      integer :: e, i, side

      ease = 0.0_wp
      do side = 1, 2
         e = run%contacts%springs%equation(side, j)
         if (e == 0) cycle
         do i = 1, 3
            ease = ease + run%contacts%springs%row(i, k, side, j)**2/run%equations%mass(i, i, e)
         end do
      end do
   end function ease_of

   !> Time to cover a way at constant acceleration
   pure real(wp) function falling_time(way, speed, acceleration)
      real(wp), intent(in) :: way           !! The way, positive [m]
      real(wp), intent(in) :: speed         !! Speed at the beginning [m/s]
      real(wp), intent(in) :: acceleration  !! Acceleration [m/s2]
      real(wp) :: square, root

      falling_time = huge(falling_time)
      square = speed**2 + 2.0_wp*acceleration*way
      if (square < 0.0_wp) return
      root = speed + sqrt(square)
      if (root > 0.0_wp) falling_time = 2.0_wp*way/root
   end function falling_time

end submodule dda_step_check
