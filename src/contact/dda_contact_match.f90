!> Which contact of the last step one of the next continues (Shi: df06)
submodule (dda_contact_transfer) dda_contact_match
   use dda_entrance, only : contact_key
   use dda_sort, only : place_in
   implicit none

contains

   !> Keys of contacts
   module procedure contact_keys
      integer :: i

      do i = 1, size(contact)
         key(i) = contact_key(vertex_number(system, contact(i)%vertex_block, contact(i)%vertex), &
            & vertex_number(system, contact(i)%edge_block, contact(i)%edge), &
            & size(system%vertex, 2))
      end do
   end procedure contact_keys

   !> Find for each contact the one of the step before that it goes on
   module procedure match_contacts
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
   end procedure match_contacts

   !> The contact of the step before of the same corner and edge that none has taken over, or 0
   pure integer function same_contact(past, past_key, key)
      type(past_contact_t), intent(in) :: past(:)
      integer(int64), intent(in) :: past_key(:)  !! Their keys, rising
      integer(int64), intent(in) :: key          !! Key of the contact that looks for one
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
      integer, intent(in) :: order(:)             !! Their order by blocks
      integer(int64), intent(in) :: past_pair(:)  !! Keys of their blocks in that order, rising
      type(contact_t), intent(in) :: contact
      integer(int64), intent(in) :: pair          !! Key of its blocks
      real(wp), intent(in) :: reach               !! How far away it may lie [m]
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
      type(contact_t), intent(in) :: contact  !! A contact of the pair
      integer, intent(in) :: n_block          !! Number of all blocks

      key = int(min(contact%vertex_block, contact%edge_block), int64)*int(n_block + 1, int64) &
         & + int(max(contact%vertex_block, contact%edge_block), int64)
   end function pair_keys

end submodule dda_contact_match
