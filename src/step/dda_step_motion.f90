!> How blocks would move in a try of a step: contacts placed, equations assembled, joints settled
submodule (dda_step) dda_step_motion
   use dda_assembly, only : renew_springs, take_springs
   use dda_block_inertia, only : assemble_blocks, turn_masses
   use dda_contact_detection, only : follow_contacts
   use dda_contact_transfer, only : renew_contacts
   use dda_step_interval, only : largest_motion
   use dda_step_reach, only : first_reach, travel_of
   implicit none

   !> Opening against the law of contact that many blocks may leave, over twice the fall in a step
   real(wp), parameter :: unseen = 1.0e-3_wp

contains

   !> What a step begins with
   module procedure predict
      contacts%remember = .not. (settings%dynamic .and. settings%current)
      step%was_cut = .false.
      step%choices = 0
      step%renews = settings%current
      step%longest = march%longest
      step%slowest_impact = 2.0_wp*march%free_acceleration*march%longest
      step%travel = 0.0_wp*system%vertex
      if (.not. settings%current) return
      call turn_masses(system, equations)
      if (contacts%searched) step%travel = travel_of(system, settings, march)
   end procedure predict

   !> The motion of one try, measured
   module procedure find_motion
      logical :: in_time

      in_time = settings%dynamic .and. settings%current
      step%dt = march%dt
      if (in_time) call stiffen_contacts(system, step%dt, contacts)
      if (in_time) call take_springs(equations)
      call begin_step(contacts, size(equations%weight, 1), size(equations%weight, 2), step%state)
      step%state%unseen = step%state%fineness*unseen*march%free_acceleration*step%dt**2
      call assemble_blocks(system, settings, step%dt, equations, &
         & merge(march%time, march%clock%now, settings%dynamic))
      if (in_time) call foresee_curves(settings, system, contacts, step)
      call settle_joints(settings, equations, contacts%springs, step%state)
      if (in_time .and. step%state%settled) &
         & call follow_curves(settings, system, contacts, equations, step)
      march%passes = march%passes + step%state%passes
      step%last_farthest = step%farthest
      if (step%state%settled) step%farthest = largest_motion(system, step%state%motion)
   end procedure find_motion

   !> Contacts where the blocks are now
   module procedure place_contacts
      integer, allocatable :: before(:, :)

      if (contacts%searched) then
         allocate (before, source=contacts%springs%equation)
         if (allocated(kept)) contacts = kept
         if (.not. allocated(march%reach)) march%reach = first_reach(system, settings, march)
         call renew_contacts(system, travel, march%reach, settings%penalty_ratio, &
            & settings%n_dof, contacts)
         call renew_springs(before, contacts%springs, equations)
      else
         call follow_contacts(system, settings%penalty_ratio, settings%n_dof, contacts)
         call take_springs(equations)
      end if
   end procedure place_contacts

end submodule dda_step_motion
