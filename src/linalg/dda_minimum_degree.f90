!> Elimination order by minimum degree
!>
!> Elimination couples all neighbours of a block to one another. They are kept as one group instead
!> of as pairs (a quotient graph), and how many neighbours a block has is bounded from above by the
!> sizes of its groups (P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM Journal on Matrix Analysis
!> and Applications 17, 1996, 886). Blocks with the same neighbours stay together.
module dda_minimum_degree
   use dda_block_order, only : neighbour_lists
   implicit none
   private

   public :: minimum_degree_order

   !> The blocks of one group
   type :: group_t
      integer, allocatable :: member(:)  !! Their numbers
   end type group_t

   !> What is left of the graph. A group has the number of the block that was eliminated for it
   type :: quotient_t
      !> First entry of each block's list: (n_block + 1)
      integer, allocatable :: start(:)
      !> Lists: groups of a block, then neighbours that share none of them with it
      integer, allocatable :: list(:)
      !> Groups in each block's list: (n_block)
      integer, allocatable :: n_group(:)
      !> Groups and neighbours in it: (n_block)
      integer, allocatable :: n_list(:)
      !> Blocks that a block stands for; 0 if another one stands for it, or if it is gone: (n_block)
      integer, allocatable :: weight(:)
      !> Bound of a block's number of neighbours: (n_block)
      integer, allocatable :: degree(:)
      !> The groups: (n_block)
      type(group_t), allocatable :: group(:)
      !> Number of blocks in a group, 0 if there is none: (n_block)
      integer, allocatable :: group_size(:)
      !> Number of blocks in a group but not in the newest one, where that is wanted: (n_block)
      integer, allocatable :: outside(:)
      !> Newest group that has marked a block, or has counted a group: (n_block)
      integer, allocatable :: mark(:), counted(:)
      !> Next and last of the blocks that one stands for: (n_block)
      integer, allocatable :: next_same(:), last_same(:)
      !> First block of each degree: (0:n_block)
      integer, allocatable :: first(:)
      !> Next and previous block of that degree: (n_block)
      integer, allocatable :: next(:), previous(:)
      !> Blocks that are left
      integer :: n_left = 0
   end type quotient_t

contains

   !> Place of each block in the order of elimination
   pure function minimum_degree_order(n_block, pair) result(place)
      integer, intent(in) :: n_block     !! Number of blocks
      integer, intent(in) :: pair(:, :)  !! Coupled blocks, perhaps given twice: (2, n_pair)
      integer :: place(n_block)          !! The places: (n_block)
      type(quotient_t) :: q
      integer :: b, least, n

      call new_quotient(n_block, pair, q)
      n = 0
      least = 0
      do while (n < n_block)
         do while (q%first(least) == 0)
            least = least + 1
         end do
         b = q%first(least)
         call take_out(q, b)
         call eliminate(q, b, least)
         do while (b > 0)
            n = n + 1
            place(b) = n
            b = q%next_same(b)
         end do
      end do
   end function minimum_degree_order

   !> The whole graph
   pure subroutine new_quotient(n, pair, q)
      integer, intent(in) :: n           !! Number of blocks
      integer, intent(in) :: pair(:, :)
      type(quotient_t), intent(out) :: q
      integer, allocatable :: neighbour(:)
      integer :: b, i

      allocate (q%n_group(n), q%n_list(n), q%degree(n), q%group_size(n), source=0)
      allocate (q%outside(n), q%mark(n), q%counted(n), q%next_same(n), source=0)
      allocate (q%next(n), q%previous(n), q%first(0:n), source=0)
      allocate (q%weight(n), source=1)
      allocate (q%group(n))
      call neighbour_lists(n, pair, q%start, neighbour)
      q%list = neighbour
      q%last_same = [(b, b=1, n)]
      q%n_left = n
      do b = 1, n
         q%mark(b) = b
         do i = q%start(b), q%start(b + 1) - 1
            if (q%mark(neighbour(i)) == b) cycle
            q%mark(neighbour(i)) = b
            q%list(q%start(b) + q%n_list(b)) = neighbour(i)
            q%n_list(b) = q%n_list(b) + 1
         end do
         q%degree(b) = q%n_list(b)
      end do
      q%mark = 0
      do b = n, 1, -1
         call put_in(q, b)
      end do
   end subroutine new_quotient

   !> Eliminate a block, and with it all that are left without other neighbours than its own
   pure subroutine eliminate(q, p, least)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: p         !! The block
      integer, intent(inout) :: least  !! A degree that no block is below
      integer, allocatable :: member(:)
      integer :: b, i, k

      call gather(q, p)
      member = q%group(p)%member
      do i = 1, size(member)
         b = member(i)
         do k = q%start(b), q%start(b) + q%n_group(b) - 1
            associate (g => q%list(k))
               if (q%group_size(g) == 0) cycle
               if (q%counted(g) /= p) q%outside(g) = q%group_size(g)
               q%counted(g) = p
               q%outside(g) = q%outside(g) - q%weight(b)
            end associate
         end do
      end do
      do i = 1, size(member)
         call take_out(q, member(i))
         call renew(q, p, member(i))
      end do
      call join_same(q, member)
      do i = 1, size(member)
         b = member(i)
         if (q%weight(b) == 0) cycle
         q%degree(b) = min(q%degree(b) + q%group_size(p), q%n_left) - q%weight(b)
         call put_in(q, b)
         least = min(least, q%degree(b))
      end do
      q%group(p)%member = pack(member, q%weight(member) > 0)
   end subroutine eliminate

   !> The neighbours of a block that goes become a group; its own groups are part of that
   pure subroutine gather(q, p)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: p
      integer :: member(size(q%weight)), i, n

      n = 0
      q%n_left = q%n_left - q%weight(p)
      q%weight(p) = 0
      associate (own => q%list(q%start(p):q%start(p) + q%n_list(p) - 1))
         do i = 1, q%n_group(p)
            if (q%group_size(own(i)) == 0) cycle
            call add_new(q%group(own(i))%member, p, q%weight, q%mark, member, n)
            q%group_size(own(i)) = 0
            deallocate (q%group(own(i))%member)
         end do
         call add_new(own(q%n_group(p) + 1:), p, q%weight, q%mark, member, n)
      end associate
      allocate (q%group(p)%member, source=member(:n))
      q%group_size(p) = sum(q%weight(member(:n)))
   end subroutine gather

   !> Add blocks to a group that are left and not in it yet
   pure subroutine add_new(block, p, weight, mark, member, n)
      integer, intent(in) :: block(:)      !! The blocks
      integer, intent(in) :: p             !! Number of the group
      integer, intent(in) :: weight(:)     !! Zero for a block that is not left: (n_block)
      integer, intent(inout) :: mark(:)    !! Newest group of each block: (n_block)
      integer, intent(inout) :: member(:)  !! Members of the group: (n_block)
      integer, intent(inout) :: n          !! Number of them
      integer :: i

      do i = 1, size(block)
         if (weight(block(i)) == 0 .or. mark(block(i)) == p) cycle
         mark(block(i)) = p
         n = n + 1
         member(n) = block(i)
      end do
   end subroutine add_new

   !> Groups, neighbours and degree of a member of the newest group; the group itself is left out of
   !> the degree
   pure subroutine renew(q, p, b)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: p  !! The newest group
      integer, intent(in) :: b  !! The member
      integer :: kept(q%n_list(b) + 1), degree, i, n

      kept(1) = p
      n = 1
      degree = 0
      associate (list => q%list(q%start(b):q%start(b) + q%n_list(b) - 1))
         do i = 1, q%n_group(b)
            if (q%group_size(list(i)) == 0) cycle
            if (q%outside(list(i)) == 0) then
               ! all of it is in the newest group
               q%group_size(list(i)) = 0
               deallocate (q%group(list(i))%member)
               cycle
            end if
            n = n + 1
            kept(n) = list(i)
            degree = degree + q%outside(list(i))
         end do
         i = q%n_group(b)
         q%n_group(b) = n
         do i = i + 1, size(list)
            if (q%weight(list(i)) == 0 .or. q%mark(list(i)) == p) cycle
            n = n + 1
            kept(n) = list(i)
            degree = degree + q%weight(list(i))
         end do
      end associate
      q%n_list(b) = n
      q%list(q%start(b):q%start(b) + n - 1) = kept(:n)
      q%degree(b) = min(q%degree(b), degree)
      if (n > 1) return
      ! nothing but the newest group
      q%group_size(p) = q%group_size(p) - q%weight(b)
      q%n_left = q%n_left - q%weight(b)
      call join(q, p, b)
   end subroutine renew

   !> Blocks of the newest group with the same groups and neighbours become one
   pure subroutine join_same(q, member)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: member(:)  !! Members of the newest group
      integer :: key(size(member)), i, k

      do i = 1, size(member)
         associate (b => member(i))
            key(i) = -1
            if (q%weight(b) == 0) cycle
            key(i) = sum(modulo(q%list(q%start(b):q%start(b) + q%n_list(b) - 1), 32768))
            do k = 1, i - 1
               if (key(k) /= key(i)) cycle
               if (.not. same(member(k), b)) cycle
               q%weight(member(k)) = q%weight(member(k)) + q%weight(b)
               call join(q, member(k), b)
               key(i) = -1
               exit
            end do
         end associate
      end do

   contains

      !> Whether two blocks have the same lists
      pure logical function same(a, b)
         integer, intent(in) :: a  !! The one
         integer, intent(in) :: b  !! The other
         integer :: j

         same = q%n_list(a) == q%n_list(b) .and. q%n_group(a) == q%n_group(b)
         if (.not. same) return
         associate (list => q%list(q%start(a):q%start(a) + q%n_list(a) - 1))
            do j = q%start(b), q%start(b) + q%n_list(b) - 1
               same = any(list == q%list(j))
               if (.not. same) return
            end do
         end associate
      end function same
   end subroutine join_same

   !> Let a block stand for another one
   pure subroutine join(q, a, b)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: a  !! The block that stands for both
      integer, intent(in) :: b

      q%next_same(q%last_same(a)) = b
      q%last_same(a) = q%last_same(b)
      q%weight(b) = 0
   end subroutine join

   !> Put a block into the list of its degree
   pure subroutine put_in(q, b)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: b  !! The block

      associate (first => q%first(q%degree(b)))
         q%next(b) = first
         q%previous(b) = 0
         if (first > 0) q%previous(first) = b
         first = b
      end associate
   end subroutine put_in

   !> Take a block out of the list of its degree
   pure subroutine take_out(q, b)
      type(quotient_t), intent(inout) :: q
      integer, intent(in) :: b

      if (q%previous(b) > 0) then
         q%next(q%previous(b)) = q%next(b)
      else
         q%first(q%degree(b)) = q%next(b)
      end if
      if (q%next(b) > 0) q%previous(q%next(b)) = q%previous(b)
   end subroutine take_out

end module dda_minimum_degree
