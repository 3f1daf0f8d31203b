!> Contacts of a system, what they carry from step to step, and how they are looked for
module dda_contacts
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_place_t, joint_springs_t, joint_t, place_joint
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_outline, only : outline_t
   implicit none
   private

   public :: edge_pairs_t, joint_search_t, contacts_t, begin_forces, joint_place, move_contacts
   public :: place_all_joints

   !> Pairs of edges that were near, and how far their corners can go before others may be
   type :: edge_pairs_t
      !> The pairs in the order of their blocks: (2, n_pair)
      integer, allocatable :: pair(:, :)
      !> Corners when they were found: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Reach of each block that they were found for, margin included: (n_block) [m]
      real(wp), allocatable :: reach(:)
   end type edge_pairs_t

   !> What a search needs of the scene, made once, and what it remembers
   type :: joint_search_t
      !> How the corners follow one another
      type(outline_t) :: outline
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), allocatable :: law(:, :)
      !> Where to look; joints do not depend on it
      type(edge_pairs_t) :: near
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
         call place_joint(system, system%vertex, contacts%joint(j), place, gap)
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
      call move_alloc(from%search%outline%direction, to%search%outline%direction)
   end subroutine move_large
end module dda_contacts
