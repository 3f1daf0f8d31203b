!> Contacts of Shi's scheme: initial state and transfer (Shi: df06, df07)
module dda_limerick_contact
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_blocks_t, limerick_state
   use dda_submatrices, only : point_load
   use dda_vector, only : cross
   implicit none
   private

   public :: limerick_contact_t, contact_list_t, contact_spring_t, append_contact, place_springs
   public :: place_shear_spring, projection, transfer_contacts, begin_contacts

   !> One contact
   type :: limerick_contact_t
      logical :: corner = .false.  !! True for two corners; otherwise a vertex and an edge
      !> Number of lines: two for corners, and for two coinciding edges, where the second line is
      !> the same contact of the other block
      integer :: n_line = 1
      !> Vertex, and ends of the edge in reverse order along its block; the edge and its law are
      !> those of the third vertex: (3, 2)
      integer :: vertex(3, 2) = 0
      !> Other end of the vertex's edge along the contact's edge; 0 if there is none
      integer :: beside = 0
      integer :: block(2) = 0  !! Block of the first line's vertex, and block of its edge: (2)
      integer :: state = limerick_state%open  !! One of limerick_state
      integer :: before = limerick_state%open  !! State before the last solution
      real(wp) :: gap = 0.0_wp  !! Opening; negative is penetration [m]
      real(wp) :: shear = 0.0_wp  !! Slip along the edge since the shear spring was set [m]
      !> Position at which the shear spring was set: 0 at the first end of the edge, 1 at the second
      real(wp) :: place = 0.0_wp
      !> Half the length of two coinciding edges, for cohesion and tensile strength [m]
      real(wp) :: length = 0.0_wp
      logical :: bonded = .false.  !! True if cohesion and tensile strength are intact
   end type limerick_contact_t

   !> Contacts of a step, in the first n entries
   type :: contact_list_t
      type(limerick_contact_t), allocatable :: item(:)  !! The contacts: (at least n)
      integer :: n = 0                                  !! Number of contacts
   end type contact_list_t

   !> Springs of one contact at the beginning of a step: opening and slip from the unknowns
   type :: contact_spring_t
      real(wp) :: normal(6, 2, 2)  !! Opening per unknown: (6, first and second block, line)
      real(wp) :: along(6, 2)      !! Slip per unknown: (6, first and second block)
      real(wp) :: drag(6)          !! Friction on the edge's block per unit force: (6)
      real(wp) :: gap(2)           !! Opening at the beginning of the step: (line) [m]
      real(wp) :: shear            !! Slip at the beginning of the step [m]
      real(wp) :: edge_length      !! Length of the first line's edge [m]
      integer :: entry             !! Entry of the two blocks in the matrix
      !> True if the rows of that entry are those of the contact's first block
      logical :: first_is_row
   end type contact_spring_t

contains

   !> Append a contact; the capacity grows by doubling
   pure subroutine append_contact(list, contact)
      type(contact_list_t), intent(inout) :: list
      type(limerick_contact_t), intent(in) :: contact

      if (.not. allocated(list%item)) allocate (list%item(64))
      ! double the capacity
      if (list%n == size(list%item)) list%item = [list%item, list%item]
      list%n = list%n + 1
      list%item(list%n) = contact
   end subroutine append_contact

   !> Normal springs of all lines, and the shear spring of a vertex and an edge (Shi 1988, 4.11 to
   !> 4.18)
   pure subroutine place_springs(blocks, contact, spring)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(in) :: contact
      type(contact_spring_t), intent(inout) :: spring
      real(wp), dimension(2) :: p1, p2, p3, edge
      real(wp) :: length
      integer :: line, own, other

      do line = 1, merge(2, 1, contact%corner)
         p1 = blocks%vertex(:, contact%vertex(1, line))
         p2 = blocks%vertex(:, contact%vertex(2, line))
         p3 = blocks%vertex(:, contact%vertex(3, line))
         edge = p3 - p2
         length = sqrt(edge(1)**2 + edge(2)**2)
         own = merge(1, 2, blocks%owner(contact%vertex(1, line)) == contact%block(1))
         other = 3 - own
         spring%gap(line) = cross(p2 - p1, p3 - p1)/length
         spring%normal(:, own, line) = point_load([-edge(2), edge(1)]/length, p1, &
            & blocks%centroid(:, contact%block(own)))
         spring%normal(:, other, line) = &
            & point_load([p3(2) - p1(2), p1(1) - p3(1)]/length, p2, &
            & blocks%centroid(:, contact%block(other))) &
            & + point_load([p1(2) - p2(2), p2(1) - p1(1)]/length, p3, &
            & blocks%centroid(:, contact%block(other)))
         if (line == 1) spring%edge_length = length
      end do
      if (.not. contact%corner) call place_shear_spring(blocks, contact, spring)
   end subroutine place_springs

   !> Place the shear spring between the vertex and the point of the edge where it was set (Ke 1995,
   !> 56 to 59)
   pure subroutine place_shear_spring(blocks, contact, spring)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(in) :: contact  !! Contact of a vertex and an edge
      type(contact_spring_t), intent(inout) :: spring  !! The springs; the shear spring is set
      real(wp), dimension(2) :: p1, p2, p3, set_at, away, tangent

      p1 = blocks%vertex(:, contact%vertex(1, 1))
      p2 = blocks%vertex(:, contact%vertex(2, 1))
      p3 = blocks%vertex(:, contact%vertex(3, 1))
      tangent = (p3 - p2)/spring%edge_length
      set_at = (1.0_wp - contact%place)*p2 + contact%place*p3
      away = (p1 - set_at)/spring%edge_length
      spring%shear = (p1(1) - set_at(1))*tangent(1) + (p1(2) - set_at(2))*tangent(2)
      spring%along(:, 1) = point_load(tangent, p1, blocks%centroid(:, contact%block(1)))
      associate (centroid => blocks%centroid(:, contact%block(2)))
         spring%drag = point_load(tangent, set_at, centroid)
         spring%along(:, 2) = point_load(away, p3, centroid) - point_load(away, p2, centroid) &
            & - spring%drag
      end associate
   end subroutine place_shear_spring

   !> Foot of the perpendicular from a point to a line: 0 at its first end, 1 at its second
   pure real(wp) function projection(point, first, second)
      real(wp), intent(in) :: point(2)   !! The point: (2) [m]
      real(wp), intent(in) :: first(2)   !! First end of the line: (2) [m]
      real(wp), intent(in) :: second(2)  !! Second end, distinct from the first: (2) [m]

      projection = dot_product(point - first, second - first) &
         & /dot_product(second - first, second - first)
   end function projection

   !> Transfer the states of the previous step to contacts with the same vertices
   pure subroutine transfer_contacts(blocks, before, now)
      type(limerick_blocks_t), intent(in) :: blocks
      type(contact_list_t), intent(in) :: before  !! Contacts of the previous step
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

   !> Transfer the state of a previous contact, if it has the same vertices
   pure subroutine inherit(from, to, keeps_place)
      type(limerick_contact_t), intent(in) :: from  !! Closed contact of the previous step
      type(limerick_contact_t), intent(inout) :: to
      logical, intent(inout) :: keeps_place  !! Set if the shear spring keeps its position
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
               ! the spring of the corners was normal only; on an edge the contact starts locked
               if (from%corner .and. to%state == limerick_state%open) &
                  & to%state = limerick_state%locked
               if (i == 1 .and. k == 1) keeps_place = from%state == limerick_state%locked
            end if
         end do
      end do
   end subroutine inherit

   !> Half the common length of two edges, and position of a new shear spring
   pure subroutine measure_line(blocks, contact, keeps_place)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(inout) :: contact
      logical, intent(in) :: keeps_place  !! True if the shear spring keeps its position
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

   !> Initial states of the contacts: open in a static run; in a dynamic run touching contacts are
   !> locked
   pure subroutine begin_contacts(blocks, dynamic, touch, list)
      type(limerick_blocks_t), intent(in) :: blocks
      logical, intent(in) :: dynamic  !! True for a dynamic run
      real(wp), intent(in) :: touch   !! Distance within which contacts touch [m]
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

end module dda_limerick_contact
