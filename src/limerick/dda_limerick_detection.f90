!> Contacts by distance and angle (Shi: df04, df05), and angles of all corners (Shi: angl)
submodule (dda_limerick_step) dda_limerick_detection
   use dda_kinds, only : degree
   use dda_limerick_contact, only : append_contact, limerick_contact_t
   implicit none

   !> Angle above which corners are reflex [deg]
   real(wp), parameter :: straight = 180.0001_wp

contains

   !> Directions, inner angles and lengths of all corners
   module procedure measure_corners
      real(wp) :: edge(2)
      integer :: v, n

      n = size(blocks%next)
      allocate (corners%direction(n), corners%angle(n), corners%length(n))
      do v = 1, n
         edge = blocks%vertex(:, blocks%next(v)) - blocks%vertex(:, v)
         corners%length(v) = sqrt(edge(1)**2 + edge(2)**2)
         corners%direction(v) = modulo(atan2(edge(2), edge(1))/degree, 360.0_wp)
      end do
      do v = 1, n
         corners%angle(v) = turn(corners%direction(v), &
            & corners%direction(blocks%previous(v)) - 180.0_wp)
      end do
   end procedure measure_corners

   !> Anticlockwise angle from one direction to another
   module procedure turn
      turn = modulo(to - from, 360.0_wp)
   end procedure turn

   !> True if two sectors overlap by more than a limit
   module procedure overlap
      real(wp) :: ray(3), wide

      if (angle_a > angle_b) then
         wide = angle_a
         ray = start_b - start_a + [0.0_wp, angle_b/2.0_wp, angle_b]
      else
         wide = angle_b
         ray = start_a - start_b + [0.0_wp, angle_a/2.0_wp, angle_a]
      end if
      ray = modulo(ray, 360.0_wp)
      overlap = any(ray > least .and. ray < wide - least)
   end procedure overlap

   !> The two lines that a pair of corners may cross, the steeper first, which preserves symmetry
   module procedure entrance_lines
      real(wp) :: start, finish, slack, steep_i, steep_j, steep(2)

      slack = 0.3_wp*overlap_deg
      start = turn(corners%direction(i), corners%direction(j))
      finish = turn(corners%direction(blocks%previous(i)), corners%direction(blocks%previous(j)))
      steep_i = steepness(corners%direction(i) + corners%angle(i)/2.0_wp)
      steep_j = steepness(corners%direction(j) + corners%angle(j)/2.0_wp)
      if (start <= 180.0_wp - slack .or. (start <= 180.0_wp + slack .and. steep_j >= steep_i)) then
         line(:, 1) = [i, blocks%next(j), j]
         steep(1) = steepness(corners%direction(j))
      else
         line(:, 1) = [j, blocks%next(i), i]
         steep(1) = steepness(corners%direction(i))
      end if
      if (finish <= 180.0_wp - slack &
         & .or. (finish <= 180.0_wp + slack .and. steep_i >= steep_j)) then
         line(:, 2) = [j, i, blocks%previous(i)]
         steep(2) = steepness(corners%direction(blocks%previous(i)))
      else
         line(:, 2) = [i, j, blocks%previous(j)]
         steep(2) = steepness(corners%direction(blocks%previous(j)))
      end if
      if (steep(1) < steep(2)) line = line(:, [2, 1])
   end procedure entrance_lines

   !> Steepness of a direction: absolute value of its sine
   pure real(wp) function steepness(direction)
      real(wp), intent(in) :: direction  !! The direction [deg]

      steepness = abs(sin(direction*degree))
   end function steepness

   !> Find all contacts of the present blocks, open, sorted by pairs of blocks
   module procedure find_limerick_contacts
      type(corners_t) :: corners
      real(wp) :: low(2, size(order)), high(2, size(order))
      integer :: i, j, a, b

      call measure_corners(blocks, corners)
      do b = 1, size(order)
         associate (corner => blocks%vertex(:, &
            & blocks%first_vertex(b):blocks%first_vertex(b + 1) - 1))
            low(:, b) = minval(corner, dim=2)
            high(:, b) = maxval(corner, dim=2) + reach
         end associate
      end do
      call sort_by(low(1, :), order)
      list%n = 0
      do i = 1, size(order)
         a = order(i)
         do j = i + 1, size(order)
            b = order(j)
            if (low(1, b) > high(1, a)) exit
            if (low(2, b) > high(2, a) .or. low(2, a) > high(2, b)) cycle
            call meet_blocks(blocks, corners, min(a, b), max(a, b), reach, overlap_deg, list)
         end do
      end do
   end procedure find_limerick_contacts

   !> Sort indices by their keys; fast if they are nearly sorted
   pure subroutine sort_by(key, order)
      real(wp), intent(in) :: key(:)      !! Key of each index: (n)
      integer, intent(inout) :: order(:)  !! The indices: (n)
      integer :: i, j, moving

      do i = 2, size(order)
         moving = order(i)
         do j = i - 1, 1, -1
            if (key(order(j)) <= key(moving)) exit
            order(j + 1) = order(j)
         end do
         order(j + 1) = moving
      end do
   end subroutine sort_by

   !> Find the contacts of two blocks with near boxes
   pure subroutine meet_blocks(blocks, corners, a, b, reach, overlap_deg, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      integer, intent(in) :: a  !! First block
      integer, intent(in) :: b  !! Second block
      real(wp), intent(in) :: reach, overlap_deg
      type(contact_list_t), intent(inout) :: list
      integer :: i, j

      do i = blocks%first_vertex(a), blocks%first_vertex(a + 1) - 1
         do j = blocks%first_vertex(b), blocks%first_vertex(b + 1) - 1
            if (near(blocks, i, j, reach)) then
               call meet_vertices(blocks, corners, i, j, overlap_deg, list)
            else
               if (above_edge(blocks, corners, i, j, reach)) &
                  & call meet_edge(blocks, corners, i, j, overlap_deg, list)
               if (above_edge(blocks, corners, j, i, reach)) &
                  & call meet_edge(blocks, corners, j, i, overlap_deg, list)
            end if
         end do
      end do
   end subroutine meet_blocks

   !> True if two vertices are near each other
   pure logical function near(blocks, i, j, reach)
      type(limerick_blocks_t), intent(in) :: blocks
      integer, intent(in) :: i  !! First vertex
      integer, intent(in) :: j  !! Second vertex
      real(wp), intent(in) :: reach

      near = (blocks%vertex(1, i) - blocks%vertex(1, j))**2 &
         & + (blocks%vertex(2, i) - blocks%vertex(2, j))**2 <= reach**2
   end function near

   !> True if a vertex is near an edge and not near its second end
   pure logical function above_edge(blocks, corners, i, j, reach)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      integer, intent(in) :: i
      integer, intent(in) :: j  !! Start of the edge
      real(wp), intent(in) :: reach
      real(wp) :: edge(2), arm(2), square

      edge = blocks%vertex(:, blocks%next(j)) - blocks%vertex(:, j)
      arm = blocks%vertex(:, i) - blocks%vertex(:, j)
      square = corners%length(j)**2
      above_edge = abs(edge(1)*arm(2) - edge(2)*arm(1)) <= reach*corners%length(j)
      if (above_edge) above_edge = abs(edge(1)*arm(1) + edge(2)*arm(2) - square/2.0_wp) &
         & <= square/2.0_wp
      if (above_edge) above_edge = .not. near(blocks, i, blocks%next(j), reach)
   end function above_edge

   !> Add the contacts of two near vertices: two convex corners, or a corner with both edges of a
   !> reflex corner
   pure subroutine meet_vertices(blocks, corners, i, j, overlap_deg, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      integer, intent(in) :: i  !! Vertex of the first block
      integer, intent(in) :: j  !! Vertex of the second block
      real(wp), intent(in) :: overlap_deg
      type(contact_list_t), intent(inout) :: list

      if (corners%angle(i) >= straight) then
         call meet_edge(blocks, corners, j, i, overlap_deg, list)
         call meet_edge(blocks, corners, j, blocks%previous(i), overlap_deg, list)
      else if (corners%angle(j) >= straight) then
         call meet_edge(blocks, corners, i, j, overlap_deg, list)
         call meet_edge(blocks, corners, i, blocks%previous(j), overlap_deg, list)
      else
         call meet_corner(blocks, corners, i, j, overlap_deg, list)
      end if
   end subroutine meet_vertices

   !> Add the contact of a vertex and an edge, unless the corner would be inside the edge's block
   pure subroutine meet_edge(blocks, corners, i, j, overlap_deg, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      integer, intent(in) :: i, j
      real(wp), intent(in) :: overlap_deg
      type(contact_list_t), intent(inout) :: list
      type(limerick_contact_t) :: contact
      real(wp) :: between

      if (overlap(corners%direction(i), corners%angle(i), corners%direction(j), 180.0_wp, &
         & overlap_deg)) return
      contact%vertex(:, 1) = [i, blocks%next(j), j]
      between = turn(corners%direction(i), corners%direction(j))
      if (between - corners%angle(i) < overlap_deg) contact%beside = blocks%previous(i)
      if (180.0_wp - between < overlap_deg) contact%beside = blocks%next(i)
      call settle(blocks, contact, list)
   end subroutine meet_edge

   !> Add the contacts of two convex corners: a vertex and an edge for each pair of parallel edges;
   !> otherwise one contact of two corners
   pure subroutine meet_corner(blocks, corners, i, j, overlap_deg, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(corners_t), intent(in) :: corners
      integer, intent(in) :: i, j
      real(wp), intent(in) :: overlap_deg
      type(contact_list_t), intent(inout) :: list
      type(limerick_contact_t) :: contact
      real(wp) :: between
      logical :: parallel(2)

      if (overlap(corners%direction(i), corners%angle(i), corners%direction(j), &
         & corners%angle(j), overlap_deg)) return
      between = turn(corners%direction(i), corners%direction(j))
      parallel(1) = 360.0_wp - between - corners%angle(j) < overlap_deg
      parallel(2) = between - corners%angle(i) < overlap_deg
      contact%n_line = 2
      if (parallel(1)) then
         contact%vertex(:, 1) = [i, j, blocks%previous(j)]
         contact%vertex(:, 2) = [j, blocks%next(i), i]
         contact%beside = blocks%next(i)
         call settle_pair(blocks, contact, list)
      end if
      if (parallel(2)) then
         contact%vertex(:, 1) = [j, i, blocks%previous(i)]
         contact%vertex(:, 2) = [i, blocks%next(j), j]
         call settle_pair(blocks, contact, list)
      end if
      if (any(parallel)) return
      contact%corner = .true.
      contact%vertex = entrance_lines(blocks, corners, i, j, overlap_deg)
      call settle(blocks, contact, list)
   end subroutine meet_corner

   !> Add the contact of two parallel edges: its vertex is the one with its foot on the other edge
   pure subroutine settle_pair(blocks, contact, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(in) :: contact
      type(contact_list_t), intent(inout) :: list
      type(limerick_contact_t) :: settled
      real(wp), dimension(2) :: p1, p2, p3

      settled = contact
      p1 = blocks%vertex(:, contact%vertex(1, 1))
      p2 = blocks%vertex(:, contact%vertex(2, 1))
      p3 = blocks%vertex(:, contact%vertex(3, 1))
      if (dot_product(p2 - p1, p3 - p1) > 0.0_wp) settled%vertex = contact%vertex(:, [2, 1])
      associate (second => settled%vertex(:, 2))
         settled%beside = merge(second(3), second(2), second(2) == settled%vertex(1, 1))
      end associate
      call settle(blocks, settled, list)
   end subroutine settle_pair

   !> Append a contact with its blocks
   pure subroutine settle(blocks, contact, list)
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_contact_t), intent(in) :: contact
      type(contact_list_t), intent(inout) :: list
      type(limerick_contact_t) :: settled

      settled = contact
      settled%block = blocks%owner(contact%vertex(1:2, 1))
      call append_contact(list, settled)
   end subroutine settle

end submodule dda_limerick_detection
