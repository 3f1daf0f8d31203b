!> Trial motion of a step: contacts, equations, joint states
module dda_step_motion
   use dda_assembly, only : renew_springs
   use dda_block_inertia, only : assemble_blocks, packed_velocity, turn_masses
   use dda_block_update, only : worn
   use dda_contact_types, only : mohr_coulomb
   use dda_contact_transfer, only : renew_contacts
   use dda_contact_solver, only : relative_tolerance
   use dda_contacts, only : contacts_t, follow_contacts
   use dda_curved_motion, only : follow_curves, foresee_curves
   use dda_kinds, only : wp
   use dda_material, only : loses_strength
   use dda_multipliers, only : settle_joints
   use dda_spring_products, only : relative_displacement
   use dda_step_context, only : in_time, run_t
   use dda_step_interval, only : largest_motion
   use dda_step_reach, only : first_reach, reach_like_neighbours, travel_of
   implicit none
   private

   public :: assemble_step, begin_step, place_contacts, predict_step, renew_try, solve_contacts

contains

   !> Begin a step: masses of turned blocks, whether contacts keep their
   !> slip, and how corners are about to move
   pure subroutine predict_step(run)
      type(run_t), intent(inout) :: run

      run%contacts%remember = .not. in_time(run)
      associate (step => run%step)
         step%was_cut = .false.
         step%choices = 0
         step%ends_at_event = .false.
         step%ends_at_turn = .false.
         step%event_cuts = 0
         step%uncut = run%march%dt
         step%overshoot = huge(step%overshoot)
         step%renews = run%settings%current
         ! nothing is hit slower than weight or the tolerance of contact forces lets it close
         step%slowest_impact = max(2.0_wp*run%march%free_acceleration*run%march%longest, &
            & relative_tolerance*largest_motion(run%system, &
            & packed_velocity(run%system, run%settings%n_dof)))
         step%travel = 0.0_wp*run%system%vertex
         if (.not. run%settings%current) return
         call turn_masses(run%system, run%equations)
         if (.not. run%contacts%searched) return
         step%travel = travel_of(run%system, run%settings, run%march, run%contacts)
         if (run%contacts%remember) step%kept = run%contacts
      end associate
      if (.not. in_time(run)) return
      run%march%reach = first_reach(run%system, run%settings, run%march)
      call reach_like_neighbours(run%contacts%joint, run%system%equation, run%march%reach)
   end subroutine predict_step

   !> Place the contacts for a try. Where a try of the same length has had the same ones, its
   !> motion is the answer to the same equations and stands
   pure subroutine renew_try(run, has_motion, repeats)
      type(run_t), intent(inout) :: run
      logical, intent(in) :: has_motion  !! True if a try of this step has been solved
      logical, intent(out) :: repeats    !! True if its motion stands
      type(contacts_t) :: before

      repeats = has_motion .and. .not. abs(run%march%dt - run%step%dt) > 0.0_wp
      if (repeats) before = run%contacts
      call place_contacts(run)
      if (repeats) repeats = has_same_corners(before, run%contacts)
      if (repeats) run%contacts = before
   end subroutine renew_try

   !> True if joints join the same blocks at the same corners and edges
   pure logical function has_same_corners(one, other) result(same)
      type(contacts_t), intent(in) :: one, other
      integer :: j, n

      same = size(one%joint) == size(other%joint)
      if (.not. same) return
      do j = 1, size(one%joint)
         n = one%joint(j)%n_contact
         associate (a => one%joint(j)%contact(:n), b => other%joint(j)%contact)
            same = n == other%joint(j)%n_contact &
               & .and. all(one%joint(j)%block == other%joint(j)%block)
            if (same) same = all(a%vertex == b(:n)%vertex .and. a%edge == b(:n)%edge)
            if (.not. same) return
         end associate
      end do
   end function has_same_corners

   !> Contacts where the blocks are now: those that were given, or those that a search finds
   pure subroutine place_contacts(run)
      type(run_t), intent(inout) :: run
      integer, allocatable :: before(:, :)

      associate (system => run%system, settings => run%settings)
         if (run%contacts%searched) then
            allocate (before, source=run%contacts%springs%equation)
            if (run%contacts%remember) run%contacts = run%step%kept
            if (.not. allocated(run%march%reach)) &
               & run%march%reach = first_reach(system, settings, run%march)
            call renew_contacts(system, run%step%travel, run%march%reach, settings%penalty_ratio, &
               & settings%n_dof, run%contacts, run%step%choices > 0)
            call renew_springs(before, run%contacts%springs, run%equations)
         else
            call follow_contacts(system, settings%penalty_ratio, settings%n_dof, run%contacts)
            run%equations%new_numbers = .true.
         end if
      end associate
   end subroutine place_contacts

   !> Equations of the blocks, and the forces that their joints begin with
   pure subroutine assemble_step(run)
      type(run_t), intent(inout) :: run

      run%step%dt = run%march%dt
      call begin_step(run)
      run%step%state%fall = run%step%dt*run%march%free_acceleration*run%march%longest
      call assemble_blocks(run%system, run%settings, run%step%dt, run%equations, &
         & merge(run%march%time, run%march%clock%now, run%settings%dynamic))
      if (.not. in_time(run)) return
      ! a try that is repeated leaves its rows behind
      if (run%step%renews) run%step%speed = relative_displacement(run%contacts%springs, &
         & packed_velocity(run%system, size(run%step%state%motion, 1)))
      call wear_joints(run)
      call foresee_curves(run)
   end subroutine assemble_step

   !> Bounds of joints that lose strength by slip, at the middle of the step: those of its beginning
   !> would be of first order
   pure subroutine wear_joints(run)
      type(run_t), intent(inout) :: run
      real(wp) :: slip
      integer :: j

      associate (contacts => run%contacts)
         do j = 1, size(contacts%joint)
            associate (law => contacts%law(contacts%joint(j)%law), springs => contacts%springs)
               if (.not. (law%slip_length > 0.0_wp .and. loses_strength(law))) cycle
               slip = abs(run%step%speed(3, j))*run%step%dt/2.0_wp
               call mohr_coulomb(contacts%joint(j), law, worn(contacts%intact(:, j), slip, &
                  & law%slip_length), springs%cone(j), springs%shift(:, j))
            end associate
         end do
      end associate
   end subroutine wear_joints

   !> Contact forces and motion of one try
   pure subroutine solve_contacts(run)
      type(run_t), intent(inout) :: run

      associate (step => run%step)
         call settle_joints(run%settings, run%equations, run%contacts%springs, step%state)
         if (in_time(run) .and. step%state%settled) call follow_curves(run)
         run%march%passes = run%march%passes + step%state%passes
         step%last_farthest = step%farthest
         if (step%state%settled) step%farthest = largest_motion(run%system, step%state%motion)
      end associate
   end subroutine solve_contacts

   !> The state that a step starts from: the joints as they are, no motion
   pure subroutine begin_step(run)
      type(run_t), intent(inout) :: run

      associate (state => run%step%state)
         if (.not. allocated(state%motion)) allocate (state%motion, mold=run%equations%weight)
         state%motion = 0.0_wp
         state%increment = run%contacts%increment
         state%force = run%contacts%force
         state%trial = run%contacts%trial
         ! slip brings in no work in a dynamic run
         state%gap = run%contacts%gap
         state%gap(3, :) = 0.0_wp
         state%face = run%contacts%face
         state%cone = run%contacts%springs%cone
         state%unsettled_work = 0.0_wp
         state%settled = .false.
         state%passes = 0
      end associate
   end subroutine begin_step
end module dda_step_motion
