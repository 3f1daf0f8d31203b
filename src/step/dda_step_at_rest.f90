!> Steps of blocks that come to rest or stay at rest
module dda_step_at_rest
   use dda_assembly, only : renew_springs
   use dda_block_inertia, only : assemble_blocks, packed_velocity
   use dda_block_update, only : carry_over, displaced
   use dda_contacts, only : joint_search_t
   use dda_contact_solver, only : gap_tolerance, relative_tolerance, rounding_tolerance
   use dda_energy, only : audit_step
   use dda_kinds, only : wp
   use dda_multipliers, only : settle_joints
   use dda_spring_products, only : add_forces
   use dda_step_context, only : in_time, run_state_t, run_t
   use dda_step_motion, only : assemble_step, begin_step, place_contacts, predict_step, &
      & solve_contacts
   use dda_velocity, only : solve_impacts
   implicit none
   private

   public :: rest

   !> Steps before the first and between later tests of rest
   integer, parameter :: first_try = 16, every_try = 128

   !> Maximum number of steps and solutions of a test of rest
   integer, parameter :: most_steps = 4, most_solutions = 16

   !> Speed of a slow block over that of free fall per step
   real(wp), parameter :: slow = 1.0e-3_wp

contains

   !> A step of blocks that stand still, or are found to: nothing moves in it
   pure subroutine rest(run, still)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: still  !! True if they stand still; otherwise nothing has changed

      still = .false.
      if (.not. in_time(run)) return
      call stands_still(run, still)
      associate (steps => run%march%steps)
         if (.not. still .and. steps >= first_try .and. (popcnt(steps) == 1 &
            & .or. modulo(steps, every_try) == 0)) then
            if (is_slow(run, packed_velocity(run%system, run%settings%n_dof), .false.)) &
               & call come_to_rest(run, still)
         end if
      end associate
      if (.not. still) return
      call begin_step(run)
      run%system%strain_rate = 0.0_wp
      run%system%acceleration = 0.0_wp
      associate (step => run%step)
         run%contacts%increment = 0.0_wp
         step%dt = run%march%dt
         step%state%increment = run%contacts%increment
         step%state%settled = .true.
         step%velocity = step%state%motion
         step%has_velocity = .true.
         step%mean_force = run%contacts%force
         step%held_mean_force = run%equations%fixed%force
         step%impact = 0.0_wp
         step%farthest = 0.0_wp
         step%whole = .true.
         step%accepted = .true.
         step%was_cut = .false.
      end associate
      run%march%steps = run%march%steps + 1
      run%march%time = run%march%time + run%step%dt
      run%march%energy%residual = 0.0_wp
      call audit_step(run)
   end subroutine rest

   !> Bring blocks to rest whose speeds may be what contact forces leave: finer forces take all
   !> speed in few steps, but not of what slides without resistance, and then balance the loads.
   !> Where they do not, nothing changes but the passes that are counted
   pure subroutine come_to_rest(run, still)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: still  !! True if they stand still
      type(run_state_t) :: before

      run%march%held_force = run%equations%fixed%force
      before = run%run_state_t
      ! they follow with the places of contacts in the next step
      deallocate (before%contacts%springs%row, before%contacts%place)
      before%contacts%search = joint_search_t()
      call take_speed(run, still)
      if (still) call balance_forces(run, still)
      run%step%state%fineness = 1.0_wp
      before%march%passes = run%march%passes
      run%march = before%march
      if (still) call count_work(before%system%motion, run)
      if (still) return
      call renew_springs(run%contacts%springs%equation, before%contacts%springs, run%equations)
      before%contacts%search = run%contacts%search
      run%run_state_t = before
      run%equations%fixed%force = before%march%held_force
   end subroutine come_to_rest

   !> Count the work of loads on the way to where blocks stand still
   pure subroutine count_work(start, run)
      real(wp), intent(in) :: start(:, :)  !! Motion of the blocks before it: (6, n_block)
      type(run_t), intent(inout) :: run
      real(wp) :: work
      integer :: b, e, n

      n = size(run%equations%outer, 1)
      work = 0.0_wp
      do b = 1, size(start, 2)
         e = run%system%equation(b)
         if (e > 0) work = work + dot_product(run%equations%outer(:, e) &
            & - run%equations%weight(:, e), run%system%motion(:n, b) - start(:n, b))
      end do
      ! what energies do not keep of it is found when they are counted
      run%march%energy%work = run%march%energy%work + work
      run%march%energy%numerical = run%march%energy%numerical + work
   end subroutine count_work

   !> Take the speed that coarser contact forces have left
   pure subroutine take_speed(run, taken)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: taken  !! True if none is left
      integer :: i

      taken = .false.
      do i = 1, most_steps
         call predict_step(run)
         call place_contacts(run)
         run%step%state%fineness = rounding_tolerance
         call assemble_step(run)
         call solve_contacts(run)
         if (.not. run%step%state%settled) return
         call solve_impacts(run)
         if (.not. run%step%has_velocity) return
         taken = is_slow(run, run%step%velocity, .true.)
         if (taken) run%step%velocity = 0.0_wp
         call carry_over(run)
         if (taken) return
      end do
   end subroutine take_speed

   !> Let strain and contact forces of blocks without speed balance the loads, in steps so long that
   !> inertia bears nothing. Contacts with a force are closed, whatever gap rounding has left
   pure subroutine balance_forces(run, still)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: still  !! True if they do
      integer :: i

      call place_contacts(run)
      associate (step => run%step, contacts => run%contacts)
         ! rounding of gaps then moves blocks less than forces that are not balanced
         step%dt = run%march%dt
         if (run%march%free_acceleration > 0.0_wp) step%dt = max(step%dt, sqrt(8.0_wp &
            & *run%equations%gap_noise/(relative_tolerance*run%march%free_acceleration)))
         do i = 1, most_solutions
            where (abs(contacts%force(1:2, :)) > 0.0_wp) contacts%gap(1:2, :) = 0.0_wp
            call begin_step(run)
            call assemble_blocks(run%system, run%settings, step%dt, run%equations, run%march%time)
            call settle_joints(run%settings, run%equations, contacts%springs, step%state)
            run%march%passes = run%march%passes + step%state%passes
            still = .false.
            if (.not. step%state%settled) return
            step%after = displaced(run%settings, run%system, step%state%motion)
            step%velocity = 0.0_wp
            step%mean_force = step%state%force
            step%curve = 0.0_wp
            call carry_over(run)
            call stands_still(run, still)
            if (still) return
         end do
      end associate
   end subroutine balance_forces

   !> True if all blocks move so slowly that this may be what contact forces leave, or with finer
   !> forces that it was
   pure logical function is_slow(run, velocity, finer)
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: velocity(:, :)  !! Velocities: (n_dof, n_equation)
      logical, intent(in) :: finer            !! True if forces were finer
      real(wp) :: least
      integer :: e

      is_slow = .false.
      least = merge(gap_tolerance, slow, finer)*run%march%free_acceleration*run%march%dt
      associate (mass => run%equations%mass)
         do e = 1, size(velocity, 2)
            if (dot_product(velocity(:, e), matmul(mass(:, :, e), velocity(:, e))) &
               & > least**2*mass(1, 1, e)) return
         end do
      end associate
      is_slow = .true.
   end function is_slow

   !> True if no block moves and the contact forces at hand balance the loads of the coming step,
   !> which are assembled
   pure subroutine stands_still(run, still)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: still  !! The answer
      real(wp) :: left(size(run%equations%load, 1), size(run%equations%load, 2))
      integer :: b, e, i

      still = .false.
      do b = 1, size(run%system%equation)
         if (run%system%equation(b) > 0 .and. any(abs(run%system%velocity(:, b)) > 0.0_wp)) return
      end do
      call assemble_blocks(run%system, run%settings, run%march%dt, run%equations, run%march%time)
      left = run%equations%load
      associate (contacts => run%contacts, mass => run%equations%mass)
         call add_forces(contacts%springs, contacts%force, left)
         do e = 1, size(left, 2)
            do i = 1, size(left, 1)
               if (abs(left(i, e)) > relative_tolerance*run%march%free_acceleration &
                  & *sqrt(mass(1, 1, e)*mass(i, i, e))) return
            end do
         end do
      end associate
      still = .true.
   end subroutine stands_still
end module dda_step_at_rest
