!> Narrow order of blocks (reverse Cuthill-McKee)
module dda_block_order
   implicit none
   private

   public :: narrow_order, neighbour_lists

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
end module dda_block_order
