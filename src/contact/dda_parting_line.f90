!> Separating axes: an edge of one convex block whose line has the other block on its outer side.
!> This line is the entrance: as long as it is not crossed, the blocks are separated, whichever
!> corners touch
module dda_parting_line
   use dda_entrance, only : add_single, join_edges, joint_list_t, neighbourhood_t, was_closed
   use dda_key_set, only : key_set_t, new_key_set
   use dda_kinds, only : wp
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: add_parted_joint, block_gap

   !> An edge and the opposite block
   type :: line_t
      integer :: edge = 0               !! Number of the edge; 0 for none
      integer :: corner = 0             !! Corner of the opposite block nearest to the line
      real(wp) :: gap = -huge(1.0_wp)   !! Height of that corner above the line [m]
      !> Height of the block above it after the expected motion [m]
      real(wp) :: after = -huge(1.0_wp)
      real(wp) :: time = -huge(1.0_wp)  !! Crossing time in units of the expected motion
      !> True if the block is beyond the line before the expected motion and after it
      logical :: parts = .false.
   end type line_t

   !> Advantage in gap below which a separating axis is kept, over the length of the edge
   real(wp), parameter :: lasting = 1.0e-9_wp
   !> Advantage in gap after a try above which a line is chosen, over the level: what the check of
   !> axes counts
   real(wp), parameter :: clear = 1.0e-2_wp

contains

   !> Distance of two convex blocks along the normal of the best separating edge; negative if they
   !> overlap [m]
   pure real(wp) function block_gap(first_vertex, vertex, block)
      !> First corner of each block, and one past the last: (n_block + 1)
      integer, intent(in) :: first_vertex(:)
      real(wp), intent(in) :: vertex(:, :)  !! Corners: (2, n_vertex) [m]
      integer, intent(in) :: block(2)       !! The two blocks: (2)
      integer :: edge, next, side

      block_gap = -huge(block_gap)
      do side = 1, 2
         associate (first => first_vertex(block(side)), last => first_vertex(block(side) + 1) - 1, &
            & from => first_vertex(block(3 - side)), to => first_vertex(block(3 - side) + 1) - 1)
            do edge = first, last
               next = merge(first, edge + 1, edge == last)
               block_gap = max(block_gap, minval(heights(vertex, edge, next, from, to)))
            end do
         end associate
      end do
   end function block_gap

   !> Heights of a block's corners above the line of an edge
   pure function heights(vertex, edge, next, from, to) result(height)
      real(wp), intent(in) :: vertex(:, :)
      integer, intent(in) :: edge  !! Start of the edge
      integer, intent(in) :: next  !! End of the edge
      integer, intent(in) :: from  !! First corner of the block
      integer, intent(in) :: to    !! Its last corner
      real(wp) :: height(from:to)  !! The heights: (to - from + 1) [m]
      real(wp) :: normal(2)

      normal = right_normal(along(vertex(:, edge), vertex(:, next)))
      height = normal(1)*(vertex(1, from:to) - vertex(1, edge)) &
         & + normal(2)*(vertex(2, from:to) - vertex(2, edge))
   end function heights

   !> Add the joint of two convex blocks: the edge or corner of one block at the separating line of
   !> the other
   pure subroutine add_parted_joint(near, edge_pair, reach, list)
      type(neighbourhood_t), intent(in) :: near
      !> Edges near one another, of the first block and of the second: (2, n_pair)
      integer, intent(in) :: edge_pair(:, :)
      real(wp), intent(in) :: reach  !! Largest gap [m]
      type(joint_list_t), intent(inout) :: list
      type(line_t) :: line
      type(key_set_t) :: taken
      integer :: pair(2), side, n

      line = parting_line(near, edge_pair, reach)
      if (line%gap > reach) return
      side = merge(1, 2, near%outline%block(line%edge) == near%outline%block(edge_pair(1, 1)))
      pair(side) = line%edge
      pair(3 - side) = facing_edge(near, line)
      n = list%n
      call new_key_set(taken, 2)
      call join_edges(near, pair, reach, taken, list)
      if (list%n > n) return
      call add_single(near, line%corner, line%edge, side, taken, list)
   end subroutine add_parted_joint

   !> The edge whose line separates two blocks: the one that does so after a try; the previous one
   !> of touching blocks; else the one that the opposite block would cross last
   pure function parting_line(near, edge_pair, reach) result(best)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: edge_pair(:, :)
      real(wp), intent(in) :: reach  !! Largest distance of the blocks [m]
      type(line_t) :: best
      type(line_t) :: apart, free, line, held, widest
      integer :: i, side

      do side = 1, 2
         do i = 1, size(edge_pair, 2)
            if (any(edge_pair(side, :i - 1) == edge_pair(side, i))) cycle
            line = line_of(near, edge_pair(side, i), near%outline%block(edge_pair(3 - side, i)))
            if (line%gap > widest%gap) widest = line
            if (line%gap >= -near%level .and. line%after > apart%after) apart = line
            if (is_later(line, best)) best = line
            if (is_later(line, free)) then
               if (line%parts .or. .not. is_covered(near, line)) free = line
            end if
            if (was_closed(near, line%corner, line%edge) .and. line%gap > held%gap) held = line
         end do
      end do
      ! covered edges that do not part the blocks count only if there are no others
      if (free%time > -huge(1.0_wp)) best = free
      if (widest%gap > reach) best = widest
      ! a line that has been found by a try to separate the blocks precedes those that hold them off
      if (near%tried .and. apart%after > max(0.0_wp, held%after) + clear*near%level) then
         best = apart
      else if (held%edge > 0) then
         if (held%gap >= widest%gap - lasting*near%outline%length(held%edge)) best = held
      end if
   end function parting_line

   !> True if a line is crossed later than another one, or at the same time with a larger gap after
   !> the expected motion. A line that parts the blocks throughout precedes those that they have
   !> crossed within the tolerance
   pure logical function is_later(line, other)
      type(line_t), intent(in) :: line, other

      if (line%parts .neqv. other%parts) then
         is_later = line%parts
      else
         is_later = line%time > other%time &
            & .or. .not. line%time < other%time .and. line%after > other%after
      end if
   end function is_later

   !> True if the edge of a line, or the opposite edge, is between two fixed blocks
   pure logical function is_covered(near, line)
      type(neighbourhood_t), intent(in) :: near
      type(line_t), intent(in) :: line

      is_covered = near%outline%covered(line%edge) &
         & .or. near%outline%covered(facing_edge(near, line))
   end function is_covered

   !> Line of one edge for the opposite block
   pure type(line_t) function line_of(near, edge, block) result(line)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: edge   !! Number of the edge
      integer, intent(in) :: block  !! The other block
      real(wp), allocatable :: height(:)
      integer :: next

      associate (from => near%first_vertex(block), to => near%first_vertex(block + 1) - 1)
         next = near%outline%next(edge)
         line%edge = edge
         allocate (height(from:to))
         height(:) = heights(near%vertex, edge, next, from, to)
         where (.not. near%outline%turns(from:to)) height = huge(1.0_wp)
         line%corner = from - 1 + minloc(height, dim=1)
         line%gap = minval(height)
         height(:) = heights(near%ahead, edge, next, from, to)
         line%after = minval(height)
         line%parts = min(line%gap, line%after) > 0.0_wp
      end associate
      associate (left => line%gap + near%level, way => line%gap - line%after)
         line%time = sign(huge(1.0_wp), left)
         if (left < 0.0_wp .or. .not. way > tiny(1.0_wp)) return
         if (left < huge(1.0_wp)**0.5_wp*way) line%time = left/way
      end associate
   end function line_of

   !> Edge at the nearest corner of a line that is most nearly parallel to it
   pure integer function facing_edge(near, line)
      type(neighbourhood_t), intent(in) :: near
      type(line_t), intent(in) :: line

      associate (direction => near%outline%direction, before => near%outline%previous(line%corner))
         facing_edge = merge(before, line%corner, &
            & dot_product(direction(:, line%edge), direction(:, before)) &
            & < dot_product(direction(:, line%edge), direction(:, line%corner)))
      end associate
   end function facing_edge
end module dda_parting_line
