!> Steps in which blocks come to rest, or go on standing
submodule (dda_step) dda_step_at_rest
   use dda_assembly, only : renew_springs, take_springs
   use dda_block_inertia, only : assemble_blocks, packed_velocity
   use dda_block_update, only : displaced_blocks
   implicit none

   !> Slow blocks are tried for rest after so many steps, after twice as many, and so on until every
   !> so many
   integer, parameter :: first_try = 16, every_try = 128

   !> Steps by which such a try must have taken all speed, and solutions by which forces balance
   integer, parameter :: most_steps = 4, most_solutions = 16

   !> How much smaller than usual the gaps are that a try leaves
   real(wp), parameter :: of_try = 1.0e-6_wp

contains

   !> A step of blocks that stand still, or are found to
   module procedure rest
      call stands_still(settings, system, contacts, march, equations, still)
      if (.not. still .and. march%steps >= first_try .and. (popcnt(march%steps) == 1 &
         & .or. modulo(march%steps, every_try) == 0)) then
         if (is_slow(equations, march, packed_velocity(system, settings%n_dof), .false.)) &
            & call come_to_rest(settings, system, contacts, equations, march, step, still)
      end if
      if (.not. still) return
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      call stand_still(contacts, equations, march, step)
      step%accepted = .true.
      step%was_cut = .false.
      march%steps = march%steps + 1
      march%time = march%time + step%dt
      call audit_step(settings, system, equations, contacts, step, march%time, march%energy)
   end procedure rest

   !> Bring blocks to rest whose speeds may be what contact forces leave: finer forces take all
   !> speed in few steps, but not of what slides without resistance, and then balance the loads.
   !> Where they do not, nothing changes
   pure subroutine come_to_rest(settings, system, contacts, equations, march, step, still)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march; passes are counted
      type(march_t), intent(inout) :: march
      type(step_context_t), intent(inout) :: step
      !> Whether they stand still
      logical, intent(out) :: still
      type(block_system_t) :: moving
      type(contacts_t) :: before
      type(march_t) :: trial
      real(wp) :: held(size(equations%fixed%force))

      moving = system
      before = contacts
      held = equations%fixed%force
      trial = march
      call take_speed(settings, system, contacts, equations, trial, step, still)
      if (still) call balance_forces(settings, system, contacts, equations, trial, step, still)
      step%state%fineness = 1.0_wp
      march%passes = trial%passes
      if (still) return
      call renew_springs(contacts%springs%equation, before%springs, equations)
      system = moving
      contacts = before
      equations%fixed%force = held
   end subroutine come_to_rest

   !> Take the speed that coarser contact forces have left
   pure subroutine take_speed(settings, system, contacts, equations, trial, step, taken)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march of the try
      type(march_t), intent(inout) :: trial
      type(step_context_t), intent(inout) :: step
      !> Whether none is left
      logical, intent(out) :: taken
      type(contacts_t), allocatable :: none
      logical :: breaks
      integer :: i

      taken = .false.
      do i = 1, most_steps
         call predict(settings, system, contacts, equations, trial, step)
         call place_contacts(settings, system, step%travel, none, trial, contacts, equations)
         step%state%fineness = of_try
         step%state%patient = .true.
         call find_motion(settings, system, contacts, equations, trial, step)
         if (.not. step%state%settled) return
         call settle_velocities(settings, system, contacts, equations, step)
         if (.not. step%has_velocity) return
         taken = is_slow(equations, trial, step%velocity, .true.)
         if (taken) step%velocity = 0.0_wp
         call update_contacts(step, settings, contacts, breaks)
         call update_blocks(step, settings, system)
         call keep_bars(equations%bars, settings, step%state%motion, system)
         if (taken) return
      end do
   end subroutine take_speed

   !> Let strain and contact forces of blocks without speed balance the loads, in steps so long that
   !> inertia bears nothing. What bears a force touches: no gap that rounding has left asks for more
   pure subroutine balance_forces(settings, system, contacts, equations, trial, step, still)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(equations_t), intent(inout) :: equations
      !> The march of the try
      type(march_t), intent(inout) :: trial
      type(step_context_t), intent(inout) :: step
      !> Whether they do
      logical, intent(out) :: still
      type(contacts_t), allocatable :: none
      logical :: breaks
      integer :: i

      call place_contacts(settings, system, step%travel, none, trial, contacts, equations)
      step%dt = max(trial%dt, balancing_time(equations, trial))
      do i = 1, most_solutions
         where (abs(contacts%force(1:2, :)) > 0.0_wp) contacts%gap(1:2, :) = 0.0_wp
         call stiffen_contacts(system, step%dt, contacts)
         call take_springs(equations)
         call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
         call assemble_blocks(system, settings, step%dt, equations, trial%time)
         call settle_joints(settings, equations, contacts%springs, step%state)
         trial%passes = trial%passes + step%state%passes
         still = .false.
         if (.not. step%state%settled) return
         step%after = displaced_blocks(system, settings, step%state%motion)
         step%velocity = 0.0_wp
         step%curve = 0.0_wp
         call update_contacts(step, settings, contacts, breaks)
         call update_blocks(step, settings, system)
         call keep_bars(equations%bars, settings, step%state%motion, system)
         call stands_still(settings, system, contacts, trial, equations, still)
         if (still) return
      end do
   end subroutine balance_forces

end submodule dda_step_at_rest
