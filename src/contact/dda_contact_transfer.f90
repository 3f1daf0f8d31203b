!> Contact transfer between steps (Shi: df06): forces, states, slip and strength
module dda_contact_transfer
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_system, only : block_system_t
   use dda_contact_search, only : store_near_edges, near_joints
   use dda_contact_types, only : contact_t, joint_place_t, joint_t, new_joint_springs, &
      & place_joint, slip_at
   use dda_contacts, only : accept_penetration, begin_memory, contacts_t, set_joints, set_strength
   use dda_entrance, only : contact_key
   use dda_kinds, only : wp
   use dda_near_miss, only : drawn_joints
   use dda_sort, only : place_in, rising_order
   implicit none
   private

   public :: search_contacts, renew_contacts, past_contact_t, match_contacts

   !> A contact of the previous step
   type :: past_contact_t
      type(contact_t) :: contact  !! The contact
      integer :: joint = 0        !! Joint of the contact
      integer :: block(2) = 0     !! The two blocks of the joint: (2)
      integer :: place = 0        !! Number of the contact within the joint
      !> Normal force, and share of the joint's shear force: (2) [N/m]
      real(wp) :: force(2) = 0.0_wp
      real(wp) :: slip = 0.0_wp       !! Slip that the springs still carry [m]
      real(wp) :: stiffness = 0.0_wp  !! Stiffness of the springs [N/m per metre depth]
      real(wp) :: tension = 0.0_wp    !! Tensile strength [N/m]
      logical :: carries = .false.    !! True if its joint carries a force
      logical :: passed_on = .false.  !! True if a contact of the next step continues it
   end type past_contact_t

   !> Share of the joint length within which an open end counts for slip: beyond the rounding of
   !> gaps, and so little that a hinge slips at its closed end alone
   real(wp), parameter :: closeness = 1.0e-6_wp

contains

   !> Contacts of blocks that touch in the reference shape: closed, intact and free of force
   pure subroutine search_contacts(system, contacts, closes_gaps)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(inout) :: contacts  !! The contacts; their search must be set
      !> True to join blocks that almost touch
      logical, intent(in), optional :: closes_gaps
      type(joint_t), allocatable :: joint(:)
      type(joint_place_t) :: place
      real(wp) :: gap(3)
      logical :: closes
      integer :: j

      contacts%law = pack(contacts%search%law, .true.)
      closes = .false.
      if (present(closes_gaps)) closes = closes_gaps
      call drawn_joints(contacts%search, system, closes, joint, contacts%near_miss)
      do j = 1, size(joint)
         call lock_joint(system%vertex, joint(j))
         call place_joint(system%vertex, joint(j), place, gap)
         joint(j)%contact%closed_at = gap(1:2)
      end do
      call set_joints(joint, contacts)
   end subroutine search_contacts

   !> Contacts of the present blocks; their springs carry forces from openings and slip
   pure subroutine renew_contacts(system, travel, reach, penalty_ratio, n_dof, contacts, tried)
      type(block_system_t), intent(in) :: system
      !> Expected motion of the corners, for directions and ratios only: (2, n_vertex) [m]
      real(wp), intent(in) :: travel(:, :)
      !> Largest motion of the corners of each block in the step: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp), intent(in) :: penalty_ratio
      !> Unknowns of one block
      integer, intent(in) :: n_dof
      !> Contacts of the previous step on entry, of the next on return
      type(contacts_t), intent(inout) :: contacts
      !> True if the expected motion is that of a try; false if absent
      logical, intent(in), optional :: tried
      type(past_contact_t), allocatable :: past(:)
      type(contacts_t) :: before
      type(joint_t), allocatable :: joint(:)
      type(joint_place_t), allocatable :: place(:)
      integer(int64), allocatable :: closed(:)
      integer :: j
      integer, allocatable :: source(:, :)
      real(wp) :: far(size(reach)), gap(3)

      call list_past(system, contacts, past, closed)
      far = reach + depth_inside(system, contacts)
      call store_near_edges(contacts%search, system, far)
      call near_joints(contacts%search, system, travel, closed, far, &
         & .not. contacts%remember, joint, tried)
      allocate (source(2, size(joint)), place(size(joint)))
      call match_contacts(system, joint, reach, past, source)
      do j = 1, size(joint)
         call continue_slip(system, past, source(:, j), .not. contacts%remember, joint(j), &
            & place(j))
      end do
      call move_alloc(contacts%face, before%face)
      call move_alloc(contacts%intact, before%intact)
      call set_joints(joint, contacts)
      call move_alloc(place, contacts%place)
      call begin_memory(contacts)
      call new_joint_springs(system, system%motion, contacts%joint, contacts%law, &
         & contacts%place, penalty_ratio, n_dof, contacts%springs)
      do j = 1, size(contacts%joint)
         call continue_state(before, past, source(:, j), j, contacts)
         call keep_shear(system, past, source(:, j), contacts%springs%stiffness(j), &
            & contacts%joint(j))
         call place_joint(system%moved, contacts%joint(j), contacts%place(j), gap)
         if (.not. contacts%remember) call accept_penetration(contacts%joint(j), gap)
         contacts%gap(:, j) = gap
         contacts%trial(:, j) = -contacts%springs%stiffness(j)*gap
         call guess_face(source(:, j), j, contacts)
      end do
      call set_strength(contacts)
   end subroutine renew_contacts

   !> Depth to which soft springs have let each block into others. The search must reach that far
   !> to find its closed contacts again
   pure function depth_inside(system, contacts) result(depth)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      real(wp) :: depth(size(system%area))  !! The depth, 0 for fixed blocks: (n_block) [m]
      type(joint_place_t) :: place
      real(wp) :: gap(3)
      integer :: j

      depth = 0.0_wp
      do j = 1, size(contacts%joint)
         call place_joint(system%moved, contacts%joint(j), place, gap)
         associate (joint => contacts%joint(j), n => contacts%joint(j)%n_contact)
            depth(joint%block) = max(depth(joint%block), maxval( &
               & -gap(:n) - joint%contact(:n)%closed_at, mask=.not. contacts%face(j)%open(:n)))
         end associate
      end do
      where (system%equation == 0) depth = 0.0_wp
   end function depth_inside

   !> List the contacts of the previous step in order of their keys, and the keys of closed ones
   pure subroutine list_past(system, contacts, past, closed)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> The contacts: (n_contact)
      type(past_contact_t), allocatable, intent(out) :: past(:)
      !> Keys of the closed contacts, ascending: (n_closed)
      integer(int64), allocatable, intent(out) :: closed(:)
      type(past_contact_t), allocatable :: list(:)
      integer(int64), allocatable :: key(:)
      integer, allocatable :: order(:)
      integer :: j, k, n

      allocate (list(sum(contacts%joint%n_contact)))
      n = 0
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j), force => contacts%force(:, j))
            do k = 1, joint%n_contact
               n = n + 1
               list(n)%contact = joint%contact(k)
               list(n)%joint = j
               list(n)%block = joint%block
               list(n)%place = k
               list(n)%force = [force(k), force(3)*joint%contact(k)%share]
               list(n)%carries = sum(force(1:2)) > 0.0_wp
               if (list(n)%carries) list(n)%force(2) = force(3)*force(k)/sum(force(1:2))
               list(n)%slip = slip_at(system%moved, joint%contact(k)) &
                  & - contacts%past_slip(j)
               list(n)%stiffness = contacts%springs%stiffness(j)
               list(n)%tension = contacts%springs%shift(k, j)
               if (.not. contacts%remember) list(n)%slip = 0.0_wp
            end do
         end associate
      end do
      allocate (key, source=contact_key(list%contact%vertex, list%contact%edge, &
         & size(system%vertex, 2)))
      allocate (order, source=rising_order(key))
      allocate (past(n))
      past = list(order)
      key = key(order)
      allocate (closed, source=pack(key, &
         & [(.not. contacts%face(past(j)%joint)%open(past(j)%place), j=1, n)]))
   end subroutine list_past

   !> Continue the slip of previous contacts in a joint, and place the joint
   pure subroutine continue_slip(system, past, source, in_time, joint, place)
      type(block_system_t), intent(in) :: system
      type(past_contact_t), intent(in) :: past(:)  !! The contacts of the previous step
      integer, intent(in) :: source(2)             !! Continued contacts, 0 for none: (2)
      !> True in dynamic runs, where each step accepts the present penetration
      logical, intent(in) :: in_time
      type(joint_t), intent(inout) :: joint
      type(joint_place_t), intent(out) :: place
      real(wp) :: gap(3), apart(2), length
      integer :: k

      call lock_joint(system%moved, joint)
      call place_joint(system%moved, joint, place, gap)
      do k = 1, joint%n_contact
         if (source(k) == 0) then
            ! initial penetration, for example of two corners that meet, is not corrected
            if (.not. in_time) joint%contact(k)%closed_at = min(0.0_wp, gap(k))
            cycle
         end if
         associate (contact => joint%contact(k))
            length = edge_size(system%moved, contact)
            contact%lock = contact%lock - past(source(k))%slip/length
            contact%closed_at = past(source(k))%contact%closed_at
            if (in_time) contact%closed_at = max(0.0_wp, contact%closed_at)
         end associate
      end do
      if (joint%n_contact == 2) then
         apart = max(gap(1:2), 0.0_wp) + closeness*joint%length
         joint%contact%share = apart([2, 1])/sum(apart)
      end if
      call place_joint(system%moved, joint, place, gap)
   end subroutine continue_slip

   !> Keep the shear force if the stiffness changes
   pure subroutine keep_shear(system, past, source, stiffness, joint)
      type(block_system_t), intent(in) :: system
      type(past_contact_t), intent(in) :: past(:)
      integer, intent(in) :: source(2)
      real(wp), intent(in) :: stiffness  !! New stiffness [N/m per metre depth]
      type(joint_t), intent(inout) :: joint
      integer :: k

      do k = 1, joint%n_contact
         if (source(k) == 0) cycle
         associate (contact => joint%contact(k), old => past(source(k)))
            contact%lock = contact%lock + old%slip*(1.0_wp - old%stiffness/stiffness) &
               & /edge_size(system%moved, contact)
         end associate
      end do
   end subroutine keep_shear

   !> Set the slip of a joint to zero at the present position
   pure subroutine lock_joint(vertex, joint)
      real(wp), intent(in) :: vertex(:, :)  !! Corners: (2, n_vertex) [m]
      type(joint_t), intent(inout) :: joint
      integer :: k

      do k = 1, joint%n_contact
         associate (c => joint%contact(k))
            c%lock = 0.0_wp
            c%lock = slip_at(vertex, c)/edge_size(vertex, c)
         end associate
      end do
   end subroutine lock_joint

   !> Length of a contact's edge [m]
   pure real(wp) function edge_size(vertex, contact)
      real(wp), intent(in) :: vertex(:, :)
      type(contact_t), intent(in) :: contact

      edge_size = norm2(vertex(:, contact%edge_end) - vertex(:, contact%edge))
   end function edge_size

   !> Continue forces, strength and direction of sliding of previous contacts
   pure subroutine continue_state(before, past, source, j, contacts)
      type(contacts_t), intent(in) :: before  !! The contacts of the previous step
      !> The contacts of the previous step as a list
      type(past_contact_t), intent(in) :: past(:)
      integer, intent(in) :: source(2)  !! Contacts that the joint continues, 0 for none: (2)
      integer, intent(in) :: j          !! Number of the joint
      type(contacts_t), intent(inout) :: contacts
      integer :: k

      ! new contacts have no strength
      contacts%intact(:, j) = 0.0_wp
      do k = 1, contacts%joint(j)%n_contact
         if (source(k) == 0) cycle
         associate (old => past(source(k)))
            contacts%force(k, j) = old%force(1)
            contacts%force(3, j) = contacts%force(3, j) + old%force(2)
            contacts%intact(k, j) = before%intact(old%place, old%joint)
            contacts%face(j)%idle(k) = before%face(old%joint)%idle(old%place)
            if (before%face(old%joint)%slip /= 0) &
               & contacts%face(j)%slip = before%face(old%joint)%slip
         end associate
      end do
   end subroutine continue_state

   !> Initial face of a joint: continued contacts by their trial force, new ones by their gap
   pure subroutine guess_face(source, j, contacts)
      !> Contacts of the previous step that the joint continues, 0 for none: (2)
      integer, intent(in) :: source(2)
      integer, intent(in) :: j
      type(contacts_t), intent(inout) :: contacts

      associate (face => contacts%face(j), trial => contacts%trial(:, j))
         face%open = trial(1:2) < 0.0_wp
         where (source == 0) face%open = .not. contacts%gap(1:2, j) <= 0.0_wp
         if (contacts%joint(j)%n_contact == 1) face%open(2) = .true.
         if (all(face%open)) face%slip = 0
      end associate
   end subroutine guess_face

   !> Find the previous contact that each contact continues: the same corner and edge, else the
   !> nearest contact of the same two blocks
   pure subroutine match_contacts(system, joint, reach, past, source)
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint(:)  !! The joints
      !> Reach of the blocks; contacts farther apart are different: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> The contacts of the previous step in order of their keys; continued ones are marked
      type(past_contact_t), intent(inout) :: past(:)
      integer, intent(out) :: source(:, :)  !! Indices in past, 0 for none: (2, n_joint)
      integer(int64) :: past_key(size(past)), key(2)
      integer :: order(size(past)), j, k

      past_key = contact_key(past%contact%vertex, past%contact%edge, size(system%vertex, 2))
      source = 0
      do j = 1, size(joint)
         key = contact_key(joint(j)%contact%vertex, joint(j)%contact%edge, size(system%vertex, 2))
         do k = 1, joint(j)%n_contact
            source(k, j) = same_contact(past, past_key, key(k))
            if (source(k, j) > 0) past(source(k, j))%passed_on = .true.
         end do
      end do
      do k = 1, size(past)
         past_key(k) = pair_key(past(k)%block, size(system%area))
      end do
      order = rising_order(past_key)
      past_key = past_key(order)
      do j = 1, size(joint)
         do k = 1, joint(j)%n_contact
            if (source(k, j) > 0) cycle
            source(k, j) = next_contact(system, past, order, past_key, joint(j)%contact(k), &
               & pair_key(joint(j)%block, size(system%area)), sum(reach(joint(j)%block)))
            if (source(k, j) > 0) past(source(k, j))%passed_on = .true.
         end do
      end do
   end subroutine match_contacts

   !> The previous contact of the same corner and edge that is not yet continued, or 0
   pure integer function same_contact(past, past_key, key)
      type(past_contact_t), intent(in) :: past(:)
      integer(int64), intent(in) :: past_key(:)  !! Keys of the previous contacts, ascending
      integer(int64), intent(in) :: key          !! Key of the new contact
      integer :: i

      same_contact = 0
      do i = place_in(past_key, key), size(past)
         if (past_key(i) /= key) return
         if (past(i)%passed_on) cycle
         same_contact = i
         return
      end do
   end function same_contact

   !> The nearest previous contact of the same blocks that is not yet continued and whose joint
   !> carries a force, or that has tensile strength, or 0
   pure integer function next_contact(system, past, order, past_pair, contact, pair, reach)
      type(block_system_t), intent(in) :: system
      type(past_contact_t), intent(in) :: past(:)
      integer, intent(in) :: order(:)             !! Order of the previous contacts by blocks
      integer(int64), intent(in) :: past_pair(:)  !! Keys of their blocks in that order, ascending
      type(contact_t), intent(in) :: contact
      integer(int64), intent(in) :: pair          !! Key of the blocks of the new contact
      real(wp), intent(in) :: reach               !! Largest distance [m]
      real(wp) :: least, distance
      integer :: m

      next_contact = 0
      least = reach
      do m = place_in(past_pair, pair), size(past)
         if (past_pair(m) /= pair) exit
         associate (old => past(order(m)))
            if (old%passed_on .or. .not. (old%carries .or. old%tension > 0.0_wp)) cycle
            distance = norm2(system%moved(:, old%contact%vertex) &
               & - system%moved(:, contact%vertex))
         end associate
         if (distance > least) cycle
         least = distance
         next_contact = order(m)
      end do
   end function next_contact

   !> Key of a pair of blocks
   pure integer(int64) function pair_key(block, n_block)
      integer, intent(in) :: block(2)  !! The pair, in either order
      integer, intent(in) :: n_block   !! Number of all blocks

      pair_key = int(minval(block), int64)*int(n_block + 1, int64) + int(maxval(block), int64)
   end function pair_key

end module dda_contact_transfer
