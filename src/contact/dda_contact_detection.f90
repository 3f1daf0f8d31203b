!> The contacts of a system and what they carry from step to step (Shi: df04 to df07)
module dda_contact_detection
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : edge_to_edge_joint, joint_springs_t, joint_t, mohr_coulomb, &
      & new_joint_springs, place_joint
   use dda_contacts, only : begin_forces, contacts_t, place_all_joints
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_settings, only : settings_t
   implicit none
   private

   public :: begin_memory, find_contacts, follow_contacts, keep_contacts, raise_springs
   public :: set_joints, set_strength

contains

   !> Joints of the pairs of edges that lie together in the reference shape, closed and free of
   !> force
   pure subroutine find_contacts(system, edge_pair, law, contacts)
      type(block_system_t), intent(in) :: system
      !> Block and edge, block and edge of each joint: (4, n_joint)
      integer, intent(in) :: edge_pair(:, :)
      !> Law of each joint: (n_joint)
      type(joint_law_t), intent(in) :: law(:)
      type(contacts_t), intent(out) :: contacts
      type(joint_t), allocatable :: joint(:)
      integer :: j

      allocate (joint(size(edge_pair, 2)))
      do j = 1, size(joint)
         joint(j) = edge_to_edge_joint(system, edge_pair(:, j), j)
      end do
      allocate (contacts%law, source=law)
      call set_joints(joint, contacts)
      call begin_forces(contacts)
   end subroutine find_contacts

   !> Take these joints, of which nothing is known yet
   pure subroutine set_joints(joint, contacts)
      !> The joints: (n_joint); they become those of the contacts
      type(joint_t), allocatable, intent(inout) :: joint(:)
      !> The contacts; their search is kept
      type(contacts_t), intent(inout) :: contacts

      call move_alloc(joint, contacts%joint)
      if (allocated(contacts%place)) deallocate (contacts%place)
      if (allocated(contacts%face)) deallocate (contacts%face)
      if (allocated(contacts%force)) deallocate (contacts%force, contacts%gap, contacts%increment)
      if (allocated(contacts%trial)) deallocate (contacts%trial, contacts%past_slip)
      if (allocated(contacts%intact)) deallocate (contacts%intact)
      contacts%springs = joint_springs_t()
   end subroutine set_joints

   !> What contacts carry from step to step where they have carried nothing yet
   pure subroutine begin_memory(contacts)
      type(contacts_t), intent(inout) :: contacts

      call begin_forces(contacts)
      if (allocated(contacts%trial)) return
      allocate (contacts%trial, source=0.0_wp*contacts%force)
      allocate (contacts%past_slip(size(contacts%joint)), source=0.0_wp)
      allocate (contacts%intact(2, size(contacts%joint)), source=1.0_wp)
   end subroutine begin_memory

   !> Springs of contacts that have none yet, as strong as what is left of the joints: in reference
   !> geometry where the blocks were at the beginning, in current geometry where they are
   pure subroutine raise_springs(settings, system, contacts)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(inout) :: contacts

      call begin_memory(contacts)
      if (allocated(contacts%springs%row)) return
      call place_all_joints(system, contacts)
      call new_joint_springs(system, merge(1.0_wp, 0.0_wp, settings%current)*system%motion, &
         & contacts%joint, contacts%law, contacts%place, settings%penalty_ratio, settings%n_dof, &
         & contacts%springs)
      call set_strength(contacts)
   end subroutine raise_springs

   !> Keep some of the joints with what they carry, without springs: blocks may have other numbers
   !> in the equations
   pure subroutine keep_contacts(kept, contacts)
      logical, intent(in) :: kept(:)  !! Which: (n_joint)
      type(contacts_t), intent(inout) :: contacts
      type(contacts_t) :: old
      type(joint_t), allocatable :: joint(:)
      integer :: k(count(kept)), j

      k = pack([(j, j=1, size(kept))], kept)
      old = contacts
      allocate (joint(size(k)))
      do j = 1, size(k)
         joint(j) = old%joint(k(j))
      end do
      call set_joints(joint, contacts)
      if (allocated(old%place)) contacts%place = old%place(k)
      if (.not. allocated(old%face)) return
      contacts%face = old%face(k)
      contacts%force = old%force(:, k)
      contacts%gap = old%gap(:, k)
      contacts%increment = old%increment(:, k)
      if (.not. allocated(old%trial)) return
      contacts%trial = old%trial(:, k)
      contacts%past_slip = old%past_slip(k)
      contacts%intact = old%intact(:, k)
   end subroutine keep_contacts

   !> Bounds of the forces by what is left of the joints' strength
   pure subroutine set_strength(contacts)
      type(contacts_t), intent(inout) :: contacts
      integer :: j

      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j))
            call mohr_coulomb(joint, contacts%law(joint%law), contacts%intact(:, j), &
               & contacts%springs%cone(j), contacts%springs%shift(:, j))
         end associate
      end do
   end subroutine set_strength

   !> Joints where the blocks are now: rows anew, openings measured, and the forces of the step
   !> before as multipliers, so that the springs only carry what changes
   pure subroutine follow_contacts(system, penalty_ratio, n_dof, contacts)
      type(block_system_t), intent(in) :: system
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp), intent(in) :: penalty_ratio
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> The contacts; what they carry is kept
      type(contacts_t), intent(inout) :: contacts
      type(joint_springs_t) :: before
      real(wp) :: gap(3)
      integer :: j

      do j = 1, size(contacts%joint)
         call place_joint(system, system%moved, contacts%joint(j), contacts%place(j), gap)
         contacts%gap(:, j) = gap - [0.0_wp, 0.0_wp, contacts%past_slip(j)]
      end do
      before = contacts%springs
      call new_joint_springs(system, system%motion, contacts%joint, contacts%law, &
         & contacts%place, penalty_ratio, n_dof, contacts%springs)
      contacts%springs%cone = before%cone
      contacts%springs%shift = before%shift
      do j = 1, size(contacts%joint)
         contacts%trial(:, j) = contacts%force(:, j) &
            & - contacts%springs%stiffness(j)*contacts%gap(:, j)
      end do
   end subroutine follow_contacts
end module dda_contact_detection
