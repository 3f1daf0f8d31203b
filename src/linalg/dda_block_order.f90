!> Elimination orders: narrow (reverse Cuthill-McKee), minimum degree, nested dissection
!>
!> Nested dissection (A. George, 1973) separates the blocks again and again. The few blocks that
!> part a group in two are eliminated after both parts. Elimination then costs n**1.5 for n blocks
!> in a plane, where a narrow order of a square wall costs n**2. Groups are cut where it is as far
!> to one of their corners as to another, which of six such cuts meets the fewest blocks; parts
!> that are small enough are eliminated by minimum degree.
module dda_block_order
   implicit none
   private

   public :: narrow_order, neighbour_lists, dissected_order, smallest_part, minimum_degree_order

   !> Size below which groups are not divided
   integer, parameter :: smallest_part = 200

   interface

      !> Blocks in the order of elimination, those that wait at the end as they are numbered
      pure module function minimum_degree_order(start, neighbour, late) result(order)
         !> First entry of each block's list, and one beyond the last: (n_block + 1)
         integer, intent(in) :: start(:)
         !> Lists of neighbours, which may tell one twice
         integer, intent(in) :: neighbour(:)
         !> Blocks that wait until all others are gone: (n_block)
         logical, intent(in) :: late(:)
         !> The order: (n_block)
         integer :: order(size(late))
      end function minimum_degree_order

   end interface

   !> Each part has at least this share of a group, if there is such a level of the search
   real, parameter :: least_share = 0.25

   !> Corners of a group: blocks far from one another
   integer, parameter :: n_corner = 4

   !> The blocks and where they have got to
   type :: dissection_t
      !> First entry of each block's list of neighbours, and one beyond: (n_block + 1)
      integer, allocatable :: start(:)
      integer, allocatable :: neighbour(:)  !! Lists of neighbours
      integer, allocatable :: order(:)      !! Blocks in the order of elimination: (n_block)
      !> First place of each block's group in the order, 0 for a block that has its place: (n_block)
      integer, allocatable :: group(:)
      !> Step at which the search reached each block; -1 before: (n_block)
      integer, allocatable :: level(:)
      !> Steps from each corner of its group to a block: (n_block, n_corner)
      integer, allocatable :: steps(:, :)
      integer, allocatable :: queue(:)  !! Blocks in the order of the search: (n_block)
      !> First and last place of each group that waits: (2, n_block)
      integer, allocatable :: waiting(:, :)
      integer :: n_waiting = 0  !! Number of groups that wait
      integer :: smallest = 0   !! Groups of no more blocks are not parted
   end type dissection_t

contains

   !> New place of each block such that coupled blocks lie near one another
   pure function narrow_order(n_block, pair) result(place)
      integer, intent(in) :: n_block     !! Number of blocks
      integer, intent(in) :: pair(:, :)  !! Coupled blocks, both from 1 to n_block: (2, n_pair)
      integer :: place(n_block)          !! Place of each block in the matrix: (n_block)
      integer, allocatable :: start(:), neighbour(:)
      integer :: queue(n_block), head, tail, root
      logical :: queued(n_block)

      call neighbour_lists(n_block, pair, start, neighbour)
      queued = .false.
      head = 0
      tail = 0
      do root = 1, n_block
         if (queued(root)) cycle
         tail = tail + 1
         queue(tail) = outermost(root, start, neighbour)
         queued(queue(tail)) = .true.
         do while (head < tail)
            head = head + 1
            call enqueue_neighbours(queue(head), start, neighbour, queue, tail, queued)
         end do
      end do
      place(queue(n_block:1:-1)) = [(root, root=1, n_block)]
   end function narrow_order

   !> Neighbour lists of all blocks
   pure subroutine neighbour_lists(n_block, pair, start, neighbour)
      integer, intent(in) :: n_block, pair(:, :)
      !> First entry of each block, and one beyond the last: (n_block + 1)
      integer, allocatable, intent(out) :: start(:)
      !> Blocks coupled to each block, one list after the other: (2*n_pair)
      integer, allocatable, intent(out) :: neighbour(:)
      integer :: i, side, fill(n_block)

      allocate (start(n_block + 1), neighbour(2*size(pair, 2)))
      fill = 0
      do i = 1, size(pair, 2)
         fill(pair(:, i)) = fill(pair(:, i)) + 1
      end do
      start(1) = 1
      do i = 1, n_block
         start(i + 1) = start(i) + fill(i)
      end do
      fill = start(:n_block)
      do i = 1, size(pair, 2)
         do side = 1, 2
            neighbour(fill(pair(side, i))) = pair(3 - side, i)
            fill(pair(side, i)) = fill(pair(side, i)) + 1
         end do
      end do
   end subroutine neighbour_lists

   !> A block at the rim of the group that a block belongs to: the last one that a search in
   !> breadth reaches, searched again from there until it gets no farther
   pure function outermost(root, start, neighbour) result(rim)
      integer, intent(in) :: root          !! Any block of the group
      integer, intent(in) :: start(:)      !! First entry of each block's list: (n_block + 1)
      integer, intent(in) :: neighbour(:)  !! Neighbour lists
      integer :: rim                       !! The block to begin with
      integer :: queue(size(start) - 1), level(size(start) - 1), head, tail, reached, i

      rim = root
      reached = -1
      do
         level = -1
         level(rim) = 0
         queue(1) = rim
         head = 0
         tail = 1
         do while (head < tail)
            head = head + 1
            do i = start(queue(head)), start(queue(head) + 1) - 1
               if (level(neighbour(i)) >= 0) cycle
               tail = tail + 1
               queue(tail) = neighbour(i)
               level(neighbour(i)) = level(queue(head)) + 1
            end do
         end do
         if (level(queue(tail)) <= reached) exit
         reached = level(queue(tail))
         rim = queue(tail)
      end do
   end function outermost

   !> Append the neighbours of a block that wait nowhere yet, those with the fewest neighbours first
   pure subroutine enqueue_neighbours(block, start, neighbour, queue, tail, queued)
      integer, intent(in) :: block         !! The block
      integer, intent(in) :: start(:), neighbour(:)
      integer, intent(inout) :: queue(:)   !! Blocks in order of visit: (n_block)
      integer, intent(inout) :: tail       !! Number of blocks in the queue
      logical, intent(inout) :: queued(:)  !! Which blocks are in the queue: (n_block)
      integer :: first, i, at, candidate

      first = tail + 1
      do i = start(block), start(block + 1) - 1
         candidate = neighbour(i)
         if (queued(candidate)) cycle
         queued(candidate) = .true.
         tail = tail + 1
         at = tail
         do while (at > first)
            if (degree(queue(at - 1)) <= degree(candidate)) exit
            queue(at) = queue(at - 1)
            at = at - 1
         end do
         queue(at) = candidate
      end do

   contains

      !> Number of neighbours of a block
      pure integer function degree(b)
         integer, intent(in) :: b  !! The block

         degree = start(b + 1) - start(b)
      end function degree
   end subroutine enqueue_neighbours

   !> Place of each block in the order of elimination
   pure function dissected_order(n_block, pair, smallest) result(place)
      integer, intent(in) :: n_block, pair(:, :)
      integer, intent(in) :: smallest  !! Groups of no more blocks are not parted
      integer :: place(n_block)
      type(dissection_t) :: d
      logical :: late(n_block)
      integer :: first, last, i, n

      call neighbour_lists(n_block, pair, d%start, d%neighbour)
      allocate (d%order(n_block), d%group(n_block), d%level(n_block), d%queue(n_block))
      allocate (d%steps(n_block, n_corner))
      allocate (d%waiting(2, n_block))
      d%order = [(i, i=1, n_block)]
      d%smallest = smallest
      call put_off(1, n_block, d)
      do while (d%n_waiting > 0)
         first = d%waiting(1, d%n_waiting)
         last = d%waiting(2, d%n_waiting)
         d%n_waiting = d%n_waiting - 1
         call search_from_corners(first, last, d, n)
         if (n <= last - first) then
            call part_groups(first, last, d)
         else
            call part_in_two(first, last, d)
         end if
      end do
      late = d%group == 0
      n = count(.not. late)
      d%queue = minimum_degree_order(d%start, d%neighbour, late)
      d%queue(n + 1:) = pack(d%order, late(d%order))
      place(d%queue) = [(i, i=1, n_block)]
   end function dissected_order

   !> Let a group wait for its parting; one that is too small stays as it is
   pure subroutine put_off(first, last, d)
      integer, intent(in) :: first  !! First place of the group in the order
      integer, intent(in) :: last   !! Last place
      type(dissection_t), intent(inout) :: d

      d%group(d%order(first:last)) = first
      if (last - first < d%smallest) return
      d%n_waiting = d%n_waiting + 1
      d%waiting(:, d%n_waiting) = [first, last]
   end subroutine put_off

   !> Search a connected group in breadth from its corners: each is farthest from those before it
   pure subroutine search_from_corners(first, last, d, n)
      integer, intent(in) :: first, last
      type(dissection_t), intent(inout) :: d  !! The blocks; steps and queue are set
      integer, intent(out) :: n               !! Number of blocks that a search has reached
      integer :: corner, near(last - first + 1), root

      associate (block => d%order(first:last))
         root = block(1)
         near = huge(near)
         do corner = 0, n_corner
            d%level(block) = -1
            n = 0
            call spread_from(root, d, n)
            if (n < size(block)) return
            if (corner == 0) then
               root = d%queue(n)
            else
               d%steps(block, corner) = d%level(block)
               near = min(near, d%level(block))
               root = block(maxloc(near, dim=1))
            end if
         end do
      end associate
   end subroutine search_from_corners

   !> Search in breadth from a block through its group
   pure subroutine spread_from(root, d, n)
      integer, intent(in) :: root             !! The block
      type(dissection_t), intent(inout) :: d  !! The blocks; levels and queue are set
      integer, intent(inout) :: n             !! Number of blocks in the queue
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
      integer, intent(in) :: first, last
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

   !> Part a connected group in two parts, and the blocks between them behind both: by how much
   !> nearer blocks are to one corner than to another
   pure subroutine part_in_two(first, last, d)
      integer, intent(in) :: first, last
      type(dissection_t), intent(inout) :: d
      integer :: block(last - first + 1), part(last - first + 1), i, k
      real :: least

      block = d%order(first:last)
      least = huge(least)
      do i = 1, n_corner
         do k = 1, i - 1
            d%level(block) = d%steps(block, i) - d%steps(block, k)
            call cut_between(block, least, d, part)
         end do
      end do
      if (least >= huge(least)) return
      d%order(first:last) = [pack(block, part == 1), pack(block, part == 2), pack(block, part == 3)]
      d%group(pack(block, part == 3)) = 0
      i = count(part == 1)
      k = count(part == 2)
      call put_off(first, first + i - 1, d)
      call put_off(first + i, first + i + k - 1, d)
   end subroutine part_in_two

   !> The cut between two levels of a group that costs the least: blocks on one side of it that meet
   !> the other side lie between the parts
   pure subroutine cut_between(block, least, d, part)
      integer, intent(in) :: block(:)  !! The group
      real, intent(inout) :: least     !! Cost of the best cut in, and out
      type(dissection_t), intent(in) :: d
      !> Receives 1 and 2 for the two sides, 3 for what is between, if the cut is better
      integer, intent(inout) :: part(:)
      integer :: low(size(block)), high(size(block)), i, k, side, cut(2), below
      integer :: meets(minval(d%level(block)):maxval(d%level(block)) + 1, 2)
      integer :: many(minval(d%level(block)):maxval(d%level(block)) + 1)
      real :: cost, former

      meets = 0
      many = 0
      do i = 1, size(block)
         associate (own => d%level(block(i)))
            low(i) = own
            high(i) = own
            do k = d%start(block(i)), d%start(block(i) + 1) - 1
               if (d%group(d%neighbour(k)) /= d%group(block(i))) cycle
               low(i) = min(low(i), d%level(d%neighbour(k)))
               high(i) = max(high(i), d%level(d%neighbour(k)))
            end do
            many(own) = many(own) + 1
            ! the block is the last below, or the first above, all cuts behind these levels
            meets(own, 1) = meets(own, 1) + 1
            meets(high(i), 1) = meets(high(i), 1) - 1
            meets(low(i), 2) = meets(low(i), 2) + 1
            meets(own, 2) = meets(own, 2) - 1
         end associate
      end do
      former = least
      cut = 0
      below = 0
      do i = lbound(many, 1), ubound(many, 1) - 2
         below = below + many(i)
         if (i > lbound(many, 1)) meets(i, :) = meets(i, :) + meets(i - 1, :)
         do side = 1, 2
            associate (one => real(below - merge(meets(i, 1), 0, side == 1)), &
               & other => real(size(block) - below - merge(meets(i, 2), 0, side == 2)))
               if (min(one, other) < least_share*size(block)) cycle
               cost = real(meets(i, side))/(one*other)
               if (cost >= least) cycle
               least = cost
               cut = [i, side]
            end associate
         end do
      end do
      if (least >= former) return
      part = merge(1, 2, d%level(block) <= cut(1))
      if (cut(2) == 1) then
         where (part == 1 .and. high > cut(1)) part = 3
      else
         where (part == 2 .and. low <= cut(1)) part = 3
      end if
   end subroutine cut_between

end module dda_block_order
