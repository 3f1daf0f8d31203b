!> Which contact of the last step one of the next continues (Shi: df06)
module dda_contact_match
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : contact_t, joint_t, vertex_number
   use dda_entrance, only : contact_key
   use dda_kinds, only : wp
   use dda_sort, only : place_in, rising_order
   implicit none
   private

   public :: past_contact_t, contact_keys, match_contacts

   !> One contact of the step before
   type :: past_contact_t
      !> The contact
      type(contact_t) :: contact
      !> The joint that it belonged to
      integer :: joint = 0
      !> Which of the joint's contacts it was
      integer :: place = 0
      !> Normal force, and its part of the joint's shear force: (2) [N/m]
      real(wp) :: force(2) = 0.0_wp
      !> Slip that the springs still feel [m]
      real(wp) :: slip = 0.0_wp
      !> Stiffness of the springs [N/m per metre depth]
      real(wp) :: stiffness = 0.0_wp
      !> Whether a contact of the next step has taken it over
      logical :: passed_on = .false.
   end type past_contact_t

contains

   !> Keys of contacts
   pure function contact_keys(system, contact) result(key)
      type(block_system_t), intent(in) :: system
      !> The contacts: (n)
      type(contact_t), intent(in) :: contact(:)
      !> Their keys: (n)
      integer(int64) :: key(size(contact))
      integer :: i

      do i = 1, size(contact)
         key(i) = contact_key(vertex_number(system, contact(i)%vertex_block, contact(i)%vertex), &
            & vertex_number(system, contact(i)%edge_block, contact(i)%edge), &
            & size(system%vertex, 2))
      end do
   end function contact_keys

   !> Find for each contact the one of the step before that it goes on: the same corner and edge, or
   !> else the nearest of the same two blocks
   pure subroutine match_contacts(system, joint, reach, past, source)
      type(block_system_t), intent(in) :: system
      !> The joints
      type(joint_t), intent(in) :: joint(:)
      !> Contacts farther from one another than their blocks reach are different ones: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> The contacts of the step before in the order of their keys; those taken over are marked
      type(past_contact_t), intent(inout) :: past(:)
      !> Places in past, 0 for none: (2, n_joint)
      integer, intent(out) :: source(:, :)
      integer(int64) :: past_key(size(past)), key(2)
      integer :: order(size(past)), j, k

      past_key = contact_keys(system, past%contact)
      source = 0
      do j = 1, size(joint)
         key = contact_keys(system, joint(j)%contact)
         do k = 1, joint(j)%n_contact
            source(k, j) = same_contact(past, past_key, key(k))
            if (source(k, j) > 0) past(source(k, j))%passed_on = .true.
         end do
      end do
      past_key = pair_keys(past%contact, size(system%area))
      order = rising_order(past_key)
      past_key = past_key(order)
      do j = 1, size(joint)
         key = pair_keys(joint(j)%contact, size(system%area))
         do k = 1, joint(j)%n_contact
            if (source(k, j) > 0) cycle
            source(k, j) = next_contact(system, past, order, past_key, joint(j)%contact(k), &
               & key(k), sum(reach(joint(j)%block)))
            if (source(k, j) > 0) past(source(k, j))%passed_on = .true.
         end do
      end do
   end subroutine match_contacts

   !> The contact of the step before of the same corner and edge that none has taken over, or 0
   pure integer function same_contact(past, past_key, key)
      type(past_contact_t), intent(in) :: past(:)
      !> Their keys, rising
      integer(int64), intent(in) :: past_key(:)
      !> Key of the contact that looks for one
      integer(int64), intent(in) :: key
      integer :: i

      same_contact = 0
      do i = place_in(past_key, key), size(past)
         if (past_key(i) /= key) return
         if (past(i)%passed_on) cycle
         same_contact = i
         return
      end do
   end function same_contact

   !> The nearest contact of the same blocks that none has taken over and that carried a force, or 0
   pure integer function next_contact(system, past, order, past_pair, contact, pair, reach)
      type(block_system_t), intent(in) :: system
      type(past_contact_t), intent(in) :: past(:)
      !> Their order by blocks
      integer, intent(in) :: order(:)
      !> Keys of their blocks in that order, rising
      integer(int64), intent(in) :: past_pair(:)
      type(contact_t), intent(in) :: contact
      !> Key of its blocks
      integer(int64), intent(in) :: pair
      !> How far away it may lie [m]
      real(wp), intent(in) :: reach
      real(wp) :: least, distance, here(2), there(2)
      integer :: m

      next_contact = 0
      least = reach
      here = system%moved(:, vertex_number(system, contact%vertex_block, contact%vertex))
      do m = place_in(past_pair, pair), size(past)
         if (past_pair(m) /= pair) exit
         associate (old => past(order(m)))
            if (old%passed_on .or. .not. old%force(1) > 0.0_wp) cycle
            there = system%moved(:, vertex_number(system, old%contact%vertex_block, &
               & old%contact%vertex))
         end associate
         distance = norm2(there - here)
         if (distance > least) cycle
         least = distance
         next_contact = order(m)
      end do
   end function next_contact

   !> Numbers that tell pairs of blocks apart
   elemental integer(int64) function pair_keys(contact, n_block) result(key)
      !> A contact of the pair
      type(contact_t), intent(in) :: contact
      !> Number of all blocks
      integer, intent(in) :: n_block

      key = int(min(contact%vertex_block, contact%edge_block), int64)*int(n_block + 1, int64) &
         & + int(max(contact%vertex_block, contact%edge_block), int64)
   end function pair_keys
end module dda_contact_match
