!> What contacts carry from step to step, and how they begin (Shi: df06, df07)
module dda_limerick_transfer
   use dda_kinds, only : wp
   use dda_limerick_contact, only : contact_list_t, limerick_contact_t, projection
   use dda_limerick_state, only : limerick_state, limerick_blocks_t
   use dda_vector, only : cross
   implicit none
   private

   public :: transfer_contacts, begin_contacts

contains

   !> Give the contacts of a step the states of the step before; a contact is known by its vertices
   pure subroutine transfer_contacts(blocks, before, now)
      type(limerick_blocks_t), intent(in) :: blocks
      !> Contacts of the step before
      type(contact_list_t), intent(in) :: before
      type(contact_list_t), intent(inout) :: now
      integer :: head(size(blocks%area)), following(before%n), c, b, p
      logical :: keeps_place

      head = 0
      do p = before%n, 1, -1
         if (before%item(p)%state == limerick_state%open) cycle
         b = minval(before%item(p)%block)
         following(p) = head(b)
         head(b) = p
      end do
      do c = 1, now%n
         keeps_place = .false.
         p = head(minval(now%item(c)%block))
         do while (p > 0)
            call inherit(before%item(p), now%item(c), keeps_place)
            p = following(p)
         end do
         if (now%item(c)%corner) cycle
         call measure_line(blocks, now%item(c), keeps_place)
      end do
   end subroutine transfer_contacts

   !> Take over from one contact of the step before, if it is the same
   pure subroutine inherit(from, to, keeps_place)
      !> The contact of the step before, closed
      type(limerick_contact_t), intent(in) :: from
      type(limerick_contact_t), intent(inout) :: to
      !> Becomes true if the shear spring stays where it was set
      logical, intent(inout) :: keeps_place
      integer :: i, k, closed_line, state

      closed_line = merge(2, 1, from%state == limerick_state%second_line)
      state = merge(limerick_state%sliding, from%state, from%state == limerick_state%second_line)
      do k = 1, from%n_line
         do i = 1, to%n_line
            if (any(to%vertex(:, i) /= from%vertex(:, k))) cycle
            to%gap = from%gap
            to%shear = from%shear
            to%place = from%place
            to%bonded = from%bonded .and. from%state == limerick_state%locked
            if (to%corner) then
               if (k == closed_line) to%state = merge(limerick_state%sliding, &
                  & limerick_state%second_line, i == 1)
            else
               if (k == closed_line) to%state = state
               ! the corners' spring was normal only; on an edge the contact begins locked
               if (from%corner .and. to%state == limerick_state%open) &
                  & to%state = limerick_state%locked
               if (i == 1 .and. k == 1) keeps_place = from%state == limerick_state%locked
            end if
         end do
      end do
   end subroutine inherit

   !> Half the length along which two edges lie together, and where a new shear spring is set
   pure subroutine measure_line(blocks, contact, keeps_place)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(inout) :: contact
      !> Whether the shear spring stays where it was set
      logical, intent(in) :: keeps_place
      real(wp), dimension(2) :: p2, p3
      real(wp) :: here, there

      p2 = blocks%vertex(:, contact%vertex(2, 1))
      p3 = blocks%vertex(:, contact%vertex(3, 1))
      here = projection(blocks%vertex(:, contact%vertex(1, 1)), p2, p3)
      if (.not. keeps_place) contact%place = here
      contact%length = 0.0_wp
      if (contact%beside == 0) return
      there = projection(blocks%vertex(:, contact%beside), p2, p3)
      contact%length = norm2(p3 - p2)/2.0_wp &
         & *max(0.0_wp, min(1.0_wp, max(here, there)) - max(0.0_wp, min(here, there)))
   end subroutine measure_line

   !> Contacts of the first step: all open in a static run, in a dynamic one those that touch locked
   pure subroutine begin_contacts(blocks, dynamic, touch, list)
      type(limerick_blocks_t), intent(in) :: blocks
      !> Whether velocities are kept
      logical, intent(in) :: dynamic
      !> Distance that counts as touching [m]
      real(wp), intent(in) :: touch
      type(contact_list_t), intent(inout) :: list
      real(wp) :: gap(2)
      integer :: c, line

      do c = 1, list%n
         associate (contact => list%item(c))
            if (.not. contact%corner) call measure_line(blocks, contact, .false.)
            contact%bonded = contact%beside > 0
            if (.not. dynamic) cycle
            gap = -huge(gap)
            do line = 1, merge(2, 1, contact%corner)
               associate (v => contact%vertex(:, line))
                  gap(line) = cross(blocks%vertex(:, v(2)) - blocks%vertex(:, v(1)), &
                     & blocks%vertex(:, v(3)) - blocks%vertex(:, v(1))) &
                     & /norm2(blocks%vertex(:, v(3)) - blocks%vertex(:, v(2)))
               end associate
            end do
            if (any(gap > touch)) cycle
            contact%state = limerick_state%locked
            if (contact%corner) contact%state = merge(limerick_state%sliding, &
               & limerick_state%second_line, gap(1) >= gap(2))
         end associate
      end do
   end subroutine begin_contacts
end module dda_limerick_transfer
