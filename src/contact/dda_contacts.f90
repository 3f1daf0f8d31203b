!> Contacts of a system, their state from step to step, and their detection (Shi: df04 to df07)
module dda_contacts
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : edge_to_edge_joint, joint_place_t, joint_springs_t, joint_t, &
      & mohr_coulomb, new_joint_springs, place_joint
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_outline, only : outline_t
   use dda_settings, only : contact_tolerance, settings_t
   implicit none
   private

   public :: edge_pairs_t, joint_search_t, contacts_t, begin_forces, joint_place, move_contacts
   public :: place_all_joints
   public :: begin_memory, find_contacts, follow_contacts, keep_contacts, raise_springs
   public :: set_joints, set_strength

   !> Pairs of edges that were near, and how far their corners can go before others may be
   type :: edge_pairs_t
      integer, allocatable :: pair(:, :)     !! The pairs in the order of their blocks: (2, n_pair)
      real(wp), allocatable :: vertex(:, :)  !! Corners when they were found: (2, n_vertex) [m]
      !> Reach of each block that they were found for, margin included: (n_block) [m]
      real(wp), allocatable :: reach(:)
   end type edge_pairs_t

   !> What a search needs of the scene, made once, and what it remembers
   type :: joint_search_t
      type(outline_t) :: outline  !! How the corners follow one another
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), allocatable :: law(:, :)
      !> Blocks lie together within this share of the smaller one's size
      real(wp) :: tolerance = contact_tolerance
      type(edge_pairs_t) :: near  !! Where to look; joints do not depend on it
      !> Blocks that are not there, so that nothing meets them; unallocated if all are: (n_block)
      logical, allocatable :: absent(:)
   end type joint_search_t

   !> Joints with their springs, states and forces
   type :: contacts_t
      !> The joints: (n_joint)
      type(joint_t), allocatable :: joint(:)
      !> Laws that they have: (n_law)
      type(joint_law_t), allocatable :: law(:)
      !> Where they are; unallocated before the first step, where they are where the blocks began:
      !> (n_joint)
      type(joint_place_t), allocatable :: place(:)
      !> Their springs
      type(joint_springs_t) :: springs
      !> Face of the friction cone that each joint's force lies on; this and what follows only where
      !> something is known of it: (n_joint)
      type(joint_face_t), allocatable :: face(:)
      !> Trial force N1, N2, T of the springs, from the first step on: (3, n_joint) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Force N1, N2, T: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Opening at the two contacts and slip since the beginning: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Opening at the two contacts and slip in the last step: (3, n_joint) [m]
      real(wp), allocatable :: increment(:, :)
      !> Slip that is past and done, where blocks move, from the first step on: (n_joint) [m]
      real(wp), allocatable :: past_slip(:)
      !> Share that is left of each contact's strength, from the first step on: 1 is whole, 0 has
      !> slid or parted: (2, n_joint)
      real(wp), allocatable :: intact(:, :)
      !> Whether blocks that move are searched for new contacts; otherwise the joints stay as given
      logical :: searched = .false.
      !> Whether found contacts remember their slip; in time what sticks has no speed to slip with
      logical :: remember = .true.
      !> The search
      type(joint_search_t) :: search
   end type contacts_t

contains

   !> Place joints that have not been placed yet
   pure subroutine place_all_joints(system, contacts)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(inout) :: contacts
      integer :: j

      if (allocated(contacts%joint) .and. .not. allocated(contacts%place)) &
         & contacts%place = [(joint_place(system, contacts, j), j=1, size(contacts%joint))]
   end subroutine place_all_joints

   !> Where a joint is
   pure type(joint_place_t) function joint_place(system, contacts, j) result(place)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: gap(3)

      if (allocated(contacts%place)) then
         place = contacts%place(j)
      else
         call place_joint(system%vertex, contacts%joint(j), place, gap)
      end if
   end function joint_place

   !> Faces, forces and openings of joints that have carried nothing yet
   pure subroutine begin_forces(contacts)
      type(contacts_t), intent(inout) :: contacts

      if (allocated(contacts%face)) return
      allocate (contacts%face(size(contacts%joint)))
      contacts%face%open(2) = contacts%joint%n_contact == 1
      allocate (contacts%force(3, size(contacts%joint)), source=0.0_wp)
      allocate (contacts%gap, contacts%increment, source=contacts%force)
   end subroutine begin_forces

   !> Hand contacts over without a copy of what is large
   pure subroutine move_contacts(from, to)
      type(contacts_t), intent(inout) :: from  !! The contacts; what is large is gone
      type(contacts_t), intent(inout) :: to
      type(contacts_t) :: large

      call move_large(from, large)
      to = from
      call move_large(large, to)
   end subroutine move_contacts

   !> Move what is large
   pure subroutine move_large(from, to)
      type(contacts_t), intent(inout) :: from, to

      call move_alloc(from%joint, to%joint)
      call move_alloc(from%law, to%law)
      call move_alloc(from%place, to%place)
      call move_alloc(from%face, to%face)
      call move_alloc(from%trial, to%trial)
      call move_alloc(from%force, to%force)
      call move_alloc(from%gap, to%gap)
      call move_alloc(from%increment, to%increment)
      call move_alloc(from%intact, to%intact)
      call move_alloc(from%springs%row, to%springs%row)
      call move_alloc(from%springs%cone, to%springs%cone)
      call move_alloc(from%springs%shift, to%springs%shift)
      call move_alloc(from%search%near%pair, to%search%near%pair)
      call move_alloc(from%search%near%vertex, to%search%near%vertex)
   end subroutine move_large

   !> Joints of the pairs of edges that lie together in the reference shape, closed and free of
   !> force
   pure subroutine find_contacts(system, edge_pair, law, contacts)
      type(block_system_t), intent(in) :: system
      !> Block and edge, block and edge of each joint: (4, n_joint)
      integer, intent(in) :: edge_pair(:, :)
      type(joint_law_t), intent(in) :: law(:)  !! Law of each joint: (n_joint)
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
      type(contacts_t), intent(inout) :: contacts  !! The contacts; their search is kept

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
      integer, intent(in) :: n_dof                 !! Unknowns of one block
      type(contacts_t), intent(inout) :: contacts  !! The contacts; what they carry is kept
      type(joint_springs_t) :: before
      real(wp) :: gap(3)
      integer :: j

      do j = 1, size(contacts%joint)
         call place_joint(system%moved, contacts%joint(j), contacts%place(j), gap)
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
end module dda_contacts
