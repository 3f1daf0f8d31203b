!> Contacts of a system, their state from step to step, and their detection (Shi: df04 to df07)
module dda_contacts
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : edge_to_edge_joint, joint_place_t, joint_springs_t, joint_t, &
      & mohr_coulomb, near_miss_t, new_joint_springs, place_joint
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_outline, only : outline_t
   use dda_settings, only : contact_tolerance, settings_t
   implicit none
   private

   public :: edge_pairs_t, joint_search_t, contacts_t, accept_penetration, begin_forces
   public :: joint_place, move_contacts, place_all_joints
   public :: begin_memory, find_contacts, follow_contacts, keep_contacts, raise_springs
   public :: set_joints, set_strength

   !> Pairs of edges that were near, and their range of validity
   type :: edge_pairs_t
      integer, allocatable :: pair(:, :)     !! The pairs in the order of their blocks: (2, n_pair)
      real(wp), allocatable :: vertex(:, :)  !! Corners at the time of the search: (2, n_vertex) [m]
      !> Reach of each block in the search, including the margin: (n_block) [m]
      real(wp), allocatable :: reach(:)
   end type edge_pairs_t

   !> Data of the joint search: constant data of the scene, and stored pairs
   type :: joint_search_t
      type(outline_t) :: outline  !! Outline of the blocks
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), allocatable :: law(:, :)
      !> Law of each edge, where joints have that of a line rather than of two materials: (n_vertex)
      integer, allocatable :: edge_law(:)
      !> Gap within which blocks touch, over the size of the smaller one
      real(wp) :: tolerance = contact_tolerance
      type(edge_pairs_t) :: near  !! Stored pairs; the result does not depend on them
      !> Blocks not present, without contacts; unallocated if there are none: (n_block)
      logical, allocatable :: absent(:)
   end type joint_search_t

   !> Joints with their springs, states and forces
   type :: contacts_t
      !> The joints: (n_joint)
      type(joint_t), allocatable :: joint(:)
      !> Laws of the joints: (n_law)
      type(joint_law_t), allocatable :: law(:)
      !> Positions of the joints; unallocated before the first step, when they are those of the
      !> reference shape: (n_joint)
      type(joint_place_t), allocatable :: place(:)
      !> Springs of the joints
      type(joint_springs_t) :: springs
      !> Face of the friction cone of each joint's force; this and the following arrays are
      !> allocated once they have values: (n_joint)
      type(joint_face_t), allocatable :: face(:)
      !> Trial force N1, N2, T of the springs, from the first step on: (3, n_joint) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Force N1, N2, T: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Opening at the two contacts and total slip: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Opening at the two contacts and slip of the last step: (3, n_joint) [m]
      real(wp), allocatable :: increment(:, :)
      !> Irreversible slip, in current geometry, from the first step on: (n_joint) [m]
      real(wp), allocatable :: past_slip(:)
      !> Remaining share of each contact's strength, from the first step on: 1 intact, 0 after
      !> sliding or opening: (2, n_joint)
      real(wp), allocatable :: intact(:, :)
      !> True to search for new contacts of moving blocks; otherwise the joints are given
      logical :: searched = .false.
      !> True to continue the slip of found contacts; false in dynamic runs
      logical :: remember = .true.
      !> The search
      type(joint_search_t) :: search
      !> Blocks that almost touch as they are drawn; unallocated where none are joined: (n)
      type(near_miss_t), allocatable :: near_miss(:)
   end type contacts_t

contains

   !> Place joints that have no position yet
   pure subroutine place_all_joints(system, contacts)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(inout) :: contacts
      integer :: j

      if (allocated(contacts%joint) .and. .not. allocated(contacts%place)) &
         & contacts%place = [(joint_place(system, contacts, j), j=1, size(contacts%joint))]
   end subroutine place_all_joints

   !> Position of a joint
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

   !> Allocate faces, forces and openings, if missing
   pure subroutine begin_forces(contacts)
      type(contacts_t), intent(inout) :: contacts

      if (allocated(contacts%face)) return
      allocate (contacts%face(size(contacts%joint)))
      contacts%face%open(2) = contacts%joint%n_contact == 1
      allocate (contacts%force(3, size(contacts%joint)), source=0.0_wp)
      allocate (contacts%gap, contacts%increment, source=contacts%force)
   end subroutine begin_forces

   !> Move contacts without copying large arrays
   pure subroutine move_contacts(from, to)
      type(contacts_t), intent(inout) :: from  !! The contacts; large arrays are deallocated
      type(contacts_t), intent(inout) :: to
      type(contacts_t) :: large

      call move_large(from, large)
      to = from
      call move_large(large, to)
   end subroutine move_contacts

   !> Move the large arrays
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
      call move_alloc(from%near_miss, to%near_miss)
   end subroutine move_large

   !> Joints of the coinciding pairs of edges in the reference shape, closed and free of force
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

   !> Set the joints and delete their states
   pure subroutine set_joints(joint, contacts)
      !> The joints: (n_joint); moved to the contacts
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

   !> Allocate the states of contacts, if missing
   pure subroutine begin_memory(contacts)
      type(contacts_t), intent(inout) :: contacts

      call begin_forces(contacts)
      if (allocated(contacts%trial)) return
      allocate (contacts%trial, source=0.0_wp*contacts%force)
      allocate (contacts%past_slip(size(contacts%joint)), source=0.0_wp)
      allocate (contacts%intact(2, size(contacts%joint)), source=1.0_wp)
   end subroutine begin_memory

   !> Make the springs of contacts, if missing, with the remaining strength: in reference geometry
   !> at the reference shape, in current geometry at the present positions
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

   !> Keep selected joints with their states, without springs, because the numbers of the equations
   !> may change
   pure subroutine keep_contacts(kept, contacts)
      logical, intent(in) :: kept(:)  !! True for joints to keep: (n_joint)
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

   !> Set the bounds of the forces from the remaining strength of the joints
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

   !> Update joints to the present blocks: rows, openings, and the forces of the previous step as
   !> multipliers, so that the springs carry only changes
   pure subroutine follow_contacts(system, penalty_ratio, n_dof, contacts)
      type(block_system_t), intent(in) :: system
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp), intent(in) :: penalty_ratio
      integer, intent(in) :: n_dof                 !! Unknowns of one block
      type(contacts_t), intent(inout) :: contacts  !! The contacts; their states are kept
      type(joint_springs_t) :: before
      real(wp) :: gap(3)
      integer :: j

      if (.not. allocated(contacts%place)) allocate (contacts%place(size(contacts%joint)))
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j))
            if (.not. contacts%remember) &
               & joint%contact%closed_at = max(0.0_wp, joint%contact%closed_at)
            call place_joint(system%moved, joint, contacts%place(j), gap)
            if (.not. contacts%remember) call accept_penetration(joint, gap)
         end associate
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

   !> Accept the present penetration of corners. Its removal would add energy: in the shortest steps
   !> the smallest displacement is a speed
   pure subroutine accept_penetration(joint, gap)
      type(joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: gap(3)  !! Opening at the two contacts, and slip: (3) [m]
      integer :: k

      do k = 1, joint%n_contact
         if (gap(k) >= 0.0_wp) cycle
         joint%contact(k)%closed_at = joint%contact(k)%closed_at + gap(k)
         gap(k) = 0.0_wp
      end do
   end subroutine accept_penetration
end module dda_contacts
