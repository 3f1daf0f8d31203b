!> An order of the blocks that parts them again and again: nested dissection (A. George, 1973)
!>
!> The few blocks that part a group in two are eliminated after both parts. Elimination then costs
!> n**1.5 for n blocks in a plane, where a narrow order of a square wall costs n**2. Where to part
!> is read from the steps that a search in breadth takes from a block at the rim (A. George and
!> J. W. H. Liu, 1978).
module dda_block_dissection
   use dda_block_order, only : neighbour_lists
   implicit none
   private

   public :: dissected_order

   !> Groups of no more blocks are not parted: their order hardly matters
   integer, parameter :: smallest = 6
   !> Each part has at least this share of a group, if there is such a level of the search
   real, parameter :: least_share = 0.3
   !> Most searches for the rim of a group
   integer, parameter :: max_searches = 4

   !> The blocks and where they have got to
   type :: dissection_t
      !> First entry of each block's list of neighbours, and one beyond: (n_block + 1)
      integer, allocatable :: start(:)
      !> Lists of neighbours
      integer, allocatable :: neighbour(:)
      !> Blocks in the order of elimination: (n_block)
      integer, allocatable :: order(:)
      !> First place of each block's group in the order, 0 for a block that has its place: (n_block)
      integer, allocatable :: group(:)
      !> Step at which the search reached each block; -1 before: (n_block)
      integer, allocatable :: level(:)
      !> Blocks in the order of the search: (n_block)
      integer, allocatable :: queue(:)
      !> First and last place of each group that waits: (2, n_block)
      integer, allocatable :: waiting(:, :)
      !> Number of groups that wait
      integer :: n_waiting = 0
   end type dissection_t

contains

   !> Place of each block in the order of elimination
   pure function dissected_order(n_block, pair) result(place)
      !> Number of blocks
      integer, intent(in) :: n_block
      !> Coupled blocks, both between 1 and n_block: (2, n_pair)
      integer, intent(in) :: pair(:, :)
      !> The places: (n_block)
      integer :: place(n_block)
      type(dissection_t) :: d
      integer :: first, last, i, n

      call neighbour_lists(n_block, pair, d%start, d%neighbour)
      allocate (d%order(n_block), d%group(n_block), d%level(n_block), d%queue(n_block))
      allocate (d%waiting(2, n_block))
      d%order = [(i, i=1, n_block)]
      call put_off(1, n_block, d)
      do while (d%n_waiting > 0)
         first = d%waiting(1, d%n_waiting)
         last = d%waiting(2, d%n_waiting)
         d%n_waiting = d%n_waiting - 1
         call search_from_rim(first, last, d, n)
         if (n <= last - first) then
            call part_groups(first, last, d)
         else
            call part_in_two(first, last, d)
         end if
      end do
      place(d%order) = [(i, i=1, n_block)]
   end function dissected_order

   !> Let a group wait for its parting; one that is too small stays as it is
   pure subroutine put_off(first, last, d)
      !> First place of the group in the order
      integer, intent(in) :: first
      !> Last place
      integer, intent(in) :: last
      !> Receives the group
      type(dissection_t), intent(inout) :: d

      d%group(d%order(first:last)) = first
      if (last - first < smallest) return
      d%n_waiting = d%n_waiting + 1
      d%waiting(:, d%n_waiting) = [first, last]
   end subroutine put_off

   !> Search a group in breadth from a block at its rim: the last one that a search reaches,
   !> searched again from there until it gets no farther
   pure subroutine search_from_rim(first, last, d, n)
      !> First place of the group in the order
      integer, intent(in) :: first
      !> Last place
      integer, intent(in) :: last
      !> The blocks; levels and queue are set
      type(dissection_t), intent(inout) :: d
      !> Number of blocks that the search has reached
      integer, intent(out) :: n
      integer :: reached, root, search

      root = d%order(first)
      reached = -1
      do search = 1, max_searches
         d%level(d%order(first:last)) = -1
         n = 0
         call spread_from(root, d, n)
         if (d%level(d%queue(n)) <= reached) exit
         reached = d%level(d%queue(n))
         root = d%queue(n)
      end do
   end subroutine search_from_rim

   !> Search in breadth from a block through its group
   pure subroutine spread_from(root, d, n)
      !> The block
      integer, intent(in) :: root
      !> The blocks; levels and queue are set
      type(dissection_t), intent(inout) :: d
      !> Number of blocks in the queue
      integer, intent(inout) :: n
      integer :: b, head, i

      head = n
      n = n + 1
      d%queue(n) = root
      d%level(root) = 0
      do while (head < n)
         head = head + 1
         b = d%queue(head)
         do i = d%start(b), d%start(b + 1) - 1
            associate (other => d%neighbour(i))
               if (d%group(other) /= d%group(root) .or. d%level(other) >= 0) cycle
               n = n + 1
               d%queue(n) = other
               d%level(other) = d%level(b) + 1
            end associate
         end do
      end do
   end subroutine spread_from

   !> Part a group into those that nothing couples
   pure subroutine part_groups(first, last, d)
      !> First place of the group in the order
      integer, intent(in) :: first
      !> Last place
      integer, intent(in) :: last
      !> The blocks
      type(dissection_t), intent(inout) :: d
      integer :: head(last - first + 2), i, m, n

      d%level(d%order(first:last)) = -1
      m = 0
      n = 0
      do i = first, last
         if (d%level(d%order(i)) >= 0) cycle
         m = m + 1
         head(m) = n + 1
         call spread_from((d%order(i)), d, n)
      end do
      head(m + 1) = n + 1
      d%order(first:last) = d%queue(:n)
      do i = 1, m
         call put_off(first + head(i) - 1, first + head(i + 1) - 2, d)
      end do
   end subroutine part_groups

   !> Part a connected group that was searched: two parts, and the blocks between them behind both
   pure subroutine part_in_two(first, last, d)
      !> First place of the group in the order
      integer, intent(in) :: first
      !> Last place
      integer, intent(in) :: last
      !> The blocks
      type(dissection_t), intent(inout) :: d
      integer :: block(last - first + 1), part(last - first + 1), i, cut, low, high

      block = d%order(first:last)
      cut = best_level(d, size(block))
      if (cut == 0) return
      do i = 1, size(block)
         part(i) = 1
         if (d%level(block(i)) > cut) part(i) = 2
         if (d%level(block(i)) == cut .and. meets_level(d, block(i), cut + 1)) part(i) = 3
      end do
      d%order(first:last) = [pack(block, part == 1), pack(block, part == 2), pack(block, part == 3)]
      low = count(part == 1)
      high = count(part == 2)
      d%group(pack(block, part == 3)) = 0
      call put_off(first, first + low - 1, d)
      call put_off(first + low, first + low + high - 1, d)
   end subroutine part_in_two

   !> The level with the fewest blocks that leaves enough on both sides; 0 if there are too few
   pure integer function best_level(d, n)
      !> The blocks
      type(dissection_t), intent(in) :: d
      !> Number of blocks that the search has reached
      integer, intent(in) :: n
      integer :: i, next, fewest, least

      best_level = 0
      fewest = huge(fewest)
      least = 0
      i = 1
      do while (i <= n)
         next = i
         do while (next <= n)
            if (d%level(d%queue(next)) /= d%level(d%queue(i))) exit
            next = next + 1
         end do
         associate (side => min(i - 1, n + 1 - next))
            if (side > least .and. least < least_share*n &
               & .or. side >= least_share*n .and. next - i < fewest) then
               best_level = d%level(d%queue(i))
               fewest = next - i
               least = side
            end if
         end associate
         i = next
      end do
   end function best_level

   !> Whether a block has a neighbour in its group at a level of the search
   pure logical function meets_level(d, block, level)
      !> The blocks
      type(dissection_t), intent(in) :: d
      !> The block
      integer, intent(in) :: block
      !> The level
      integer, intent(in) :: level
      integer :: i

      meets_level = .false.
      do i = d%start(block), d%start(block + 1) - 1
         associate (other => d%neighbour(i))
            meets_level = meets_level &
               & .or. d%group(other) == d%group(block) .and. d%level(other) == level
         end associate
      end do
   end function meets_level
end module dda_block_dissection
