!> Carry an accepted step over to blocks and contacts (Shi: df25)
module dda_block_update
   use dda_bar_springs, only : keep_bars
   use dda_block_system, only : block_pose_t, block_system_t
   use dda_contact_types, only : mohr_coulomb
   use dda_contacts, only : contacts_t
   use dda_deformation, only : moved_point, turned_tensor
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix, loses_strength
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : run_t, step_context_t
   implicit none
   private

   public :: carry_over, displaced, update_blocks, update_contacts, worn

   !> Force of velocities that is a residual, over that of the motion
   real(wp), parameter :: residual_force = 1.0e-6_wp

contains

   !> Contacts, blocks and bars at the end of a step
   pure subroutine carry_over(run)
      type(run_t), intent(inout) :: run
      logical :: breaks

      call update_contacts(run%step, run%settings, run%contacts, breaks)
      call update_blocks(run%step, run%settings, run%system)
      call keep_bars(run%equations%bars, run%settings, run%step%state%motion, run%system)
      run%step%whole = .not. breaks
   end subroutine carry_over

   !> Add the motion of a step; stress follows the strain, velocity the constant acceleration or the
   !> law of impact. Where blocks move, strain is kept in the block's own frame and the corners are
   !> built again from it
   pure subroutine update_blocks(step, settings, system)
      type(step_context_t), intent(in) :: step
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(inout) :: system
      real(wp) :: motion(6)
      integer :: b, e

      if (settings%current .and. settings%dynamic) then
         system%block_pose_t = step%after
      else if (settings%current) then
         system%block_pose_t = displaced(settings, system, step%state%motion)
         return
      end if
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         motion = 0.0_wp
         motion(:settings%n_dof) = step%state%motion(:, e)
         if (settings%current) then
            system%acceleration(:, b) = (step%velocity(:3, e) - system%velocity(:3, b))/step%dt
            if (step%ends_at_event) system%acceleration(:, b) = 0.0_wp
            system%velocity(:settings%n_dof, b) = step%velocity(:, e)
            system%velocity(4:6, b) = turned_tensor(system%velocity(4:6, b), -motion(3), 2.0_wp)
            system%strain_rate(:, b) = turned_tensor(motion(4:6)/step%dt, -motion(3), 2.0_wp)
            cycle
         end if
         if (settings%dynamic) system%velocity(:, b) = 2.0_wp*motion/step%dt - system%velocity(:, b)
         system%motion(:, b) = system%motion(:, b) + motion
         system%stress(:, b) = system%stress(:, b) &
            & + matmul(elasticity_matrix(system%materials(system%material(b))), motion(4:6))
      end do
   end subroutine update_blocks

   !> Where blocks are after a motion, where blocks move
   pure type(block_pose_t) function displaced(settings, system, motion) result(after)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)  !! The motion: (n_dof, n_equation)
      real(wp) :: of_block(6)
      integer :: b, e

      after = system%block_pose_t
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         of_block = 0.0_wp
         of_block(:settings%n_dof) = motion(:, e)
         call move_block(system, b, of_block, after)
      end do
   end function displaced

   !> Move one block by a finite motion
   pure subroutine move_block(system, block, motion, after)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block       !! Number of the block
      real(wp), intent(in) :: motion(6)  !! Its motion in the step; strain in fixed directions: (6)
      type(block_pose_t), intent(inout) :: after  !! Where it was in, where it is after it out
      integer :: v

      associate (total => after%motion(:, block))
         total(4:6) = total(4:6) + turned_tensor(motion(4:6), total(3), 2.0_wp)
         total(1:3) = total(1:3) + motion(1:3)
         after%stress(:, block) = turned_tensor(system%initial_stress(:, block) &
            & + matmul(elasticity_matrix(system%materials(system%material(block))), total(4:6)), &
            & -total(3), 1.0_wp)
         do v = system%first_vertex(block), system%first_vertex(block + 1) - 1
            after%moved(:, v) = moved_point(system%vertex(:, v), system%centroid(:, block), total)
         end do
      end associate
   end subroutine move_block

   !> Keep states, forces and gaps of a step; under Coulomb friction slip is plastic, so that the
   !> springs start again from the shear force that they could carry. Springs that give keep as much
   !> of it as carries that force. In a dynamic run no slip is kept
   pure subroutine update_contacts(step, settings, contacts, breaks)
      type(step_context_t), intent(in) :: step
      type(settings_t), intent(in) :: settings
      type(contacts_t), intent(inout) :: contacts
      logical, intent(out) :: breaks  !! True if a contact lost strength in this step
      real(wp) :: left(2)
      integer :: j

      contacts%face = step%state%face
      contacts%force = step%state%force
      contacts%increment = step%state%increment
      do j = 1, size(contacts%joint)
         contacts%trial(:, j) = step%state%trial(:, j) &
            & - contacts%springs%stiffness(j)*contacts%increment(:, j)
      end do
      contacts%gap = contacts%gap + step%state%increment
      if (allocated(step%curve)) contacts%gap = contacts%gap + step%curve
      if (settings%current .and. settings%dynamic) then
         contacts%past_slip = contacts%past_slip + contacts%gap(3, :)
         do j = 1, size(contacts%joint)
            contacts%face(j)%idle = abs(step%mean_force(1:2, j)) &
               & <= residual_force*abs(contacts%force(1:2, j))
         end do
      else if (settings%current .and. contacts%springs%give) then
         where (contacts%face%slip /= 0) contacts%past_slip = contacts%past_slip &
            & + contacts%gap(3, :) + contacts%force(3, :)/contacts%springs%stiffness
      else if (settings%current) then
         where (contacts%face%slip /= 0) &
            & contacts%past_slip = contacts%past_slip + contacts%gap(3, :)
      else if (settings%flow == flow_rule%coulomb) then
         contacts%trial(3, :) = contacts%force(3, :)
      end if
      breaks = .false.
      do j = 1, size(contacts%joint)
         if (.not. loses_strength(contacts%law(contacts%joint(j)%law))) cycle
         left = contacts%intact(:, j)
         if (contacts%face(j)%slip /= 0) left = worn(left, abs(contacts%increment(3, j)), &
            & contacts%law(contacts%joint(j)%law)%slip_length)
         where (contacts%face(j)%open) left = 0.0_wp
         if (.not. any(left < contacts%intact(:, j))) cycle
         breaks = .true.
         contacts%intact(:, j) = left
         call mohr_coulomb(contacts%joint(j), contacts%law(contacts%joint(j)%law), &
            & contacts%intact(:, j), contacts%springs%cone(j), &
            & contacts%springs%shift(:, j))
      end do
   end subroutine update_contacts

   !> Share of strength that slip leaves
   elemental real(wp) function worn(intact, slip, slip_length)
      real(wp), intent(in) :: intact       !! Share that was left before
      real(wp), intent(in) :: slip         !! The slip [m]
      real(wp), intent(in) :: slip_length  !! Slip that takes all of it; 0 where any does [m]

      worn = 0.0_wp
      if (slip < intact*slip_length) worn = intact - slip/slip_length
   end function worn
end module dda_block_update
