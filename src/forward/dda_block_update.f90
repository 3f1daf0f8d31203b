!> Carry an accepted step over to blocks and contacts (Shi: df25)
module dda_block_update
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_joint_springs, only : mohr_coulomb
   use dda_kinds, only : wp
   use dda_material, only : elasticity_matrix
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : step_context_t
   implicit none
   private

   public :: update_blocks, update_contacts

contains

   !> Add the motion of a step; stress follows the strain, velocity the constant acceleration
   pure subroutine update_blocks(step, settings, system)
      !> The accepted step
      type(step_context_t), intent(in) :: step
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(inout) :: system
      real(wp) :: d(3, 3)
      integer :: b, e, nd

      nd = settings%n_dof
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         associate (motion => step%state%motion(:, e), velocity => system%velocity(:nd, b))
            system%motion(:nd, b) = system%motion(:nd, b) + motion
            if (settings%dynamic) velocity = 2.0_wp*motion/step%dt - velocity
            if (nd < 6) cycle
            d = elasticity_matrix(system%materials(system%material(b)))
            system%stress(:, b) = system%stress(:, b) + matmul(d, motion(4:6))
         end associate
      end do
   end subroutine update_blocks

   !> Keep states, forces and gaps of a step; under Coulomb friction slip is plastic, so that the
   !> springs start anew from the shear force that they could carry
   pure subroutine update_contacts(step, settings, contacts, breaks)
      !> The accepted step
      type(step_context_t), intent(in) :: step
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The contacts
      type(contacts_t), intent(inout) :: contacts
      !> Whether a contact lost its cohesion or tensile strength in this step
      logical, intent(out) :: breaks
      logical :: fails(2)
      integer :: j

      contacts%face = step%state%face
      contacts%trial = step%state%trial
      contacts%force = step%state%force
      contacts%increment = step%state%increment
      contacts%gap = contacts%gap + step%state%increment
      if (settings%flow == flow_rule%coulomb) contacts%trial(3, :) = contacts%force(3, :)
      breaks = .false.
      do j = 1, size(contacts%joint)
         associate (law => contacts%joint(j)%law)
            if (.not. (law%cohesion > 0.0_wp .or. law%tension > 0.0_wp)) cycle
         end associate
         fails = (contacts%face(j)%open .or. contacts%face(j)%slip /= 0) &
            & .and. .not. contacts%broken(:, j)
         if (.not. any(fails)) cycle
         breaks = .true.
         contacts%broken(:, j) = contacts%broken(:, j) .or. fails
         call mohr_coulomb(contacts%joint(j), contacts%broken(:, j), contacts%springs%cone(j), &
            & contacts%springs%shift(:, j))
      end do
   end subroutine update_contacts
end module dda_block_update
