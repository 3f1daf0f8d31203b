!> Steps in which blocks come to rest, or go on standing
submodule (dda_step) dda_step_at_rest
   use dda_assembly, only : renew_springs
   use dda_block_inertia, only : packed_velocity
   implicit none

   !> Slow blocks are tried for rest after so many steps, after twice as many, and so on until every
   !> so many; and most steps of such a try
   integer, parameter :: first_try = 16, every_try = 128, steps_of_try = 40

   !> Steps by which such a try must have taken all speed
   integer, parameter :: lively_steps = 4

   !> Distance that blocks may go in the first of these steps, over the size of the smallest block,
   !> and how much of it in the next
   real(wp), parameter :: no_distance = 1.0e-7_wp, falling = 0.8_wp

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
   !> speed in one step, but not of what slides without resistance; after it the gaps that are left
   !> close and forces balance. Where they do not, nothing changes
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
      type(contacts_t), allocatable :: none
      type(march_t) :: trial
      real(wp) :: held(size(equations%fixed%force))
      real(wp) :: distance
      logical :: breaks, lively
      integer :: i

      moving = system
      before = contacts
      held = equations%fixed%force
      trial = march
      still = .false.
      lively = .true.
      distance = no_distance*sqrt(minval(system%area, mask=system%equation > 0))
      do i = 1, steps_of_try
         call predict(settings, system, contacts, equations, trial, step)
         call place_contacts(settings, system, step%travel, none, trial, contacts, equations)
         step%state%fineness = of_try
         step%state%patient = .true.
         call find_motion(settings, system, contacts, equations, trial, step)
         if (.not. step%state%settled .or. step%farthest > distance) exit
         if (lively) then
            call settle_velocities(settings, system, contacts, equations, step)
            lively = .not. is_slow(equations, march, step%velocity, .true.)
            if (.not. step%has_velocity .or. lively .and. i == lively_steps) exit
         else
            distance = max(falling*step%farthest, equations%gap_noise)
         end if
         if (.not. lively) then
            step%velocity = 0.0_wp*step%state%motion
            trial%dt = max(march%dt, balancing_time(equations, march))
         end if
         call update_contacts(step, settings, contacts, breaks)
         call update_blocks(step, settings, system)
         call keep_bars(equations%bars, settings, step%state%motion, system)
         call stands_still(settings, system, contacts, march, equations, still)
         if (still) exit
      end do
      step%state%fineness = 1.0_wp
      march%passes = trial%passes
      if (still) return
      call renew_springs(contacts%springs%equation, before%springs, equations)
      system = moving
      contacts = before
      equations%fixed%force = held
   end subroutine come_to_rest

end submodule dda_step_at_rest
