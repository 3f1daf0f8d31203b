!> Joints of blocks as drawn, and near misses: edges with small gaps
!>
!> Coordinates of drawings are rounded. Edges within the contact tolerance form a joint. Slightly
!> wider gaps would close under displacements that are small compared with the blocks. Static runs
!> therefore join such blocks too, with a warning.
module dda_near_miss
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_system, only : block_system_t
   use dda_contact_search, only : remember_drawn, touching_joints
   use dda_contact_types, only : joint_place_t, joint_t, near_miss_t, place_joint, same_joint
   use dda_contacts, only : joint_search_t
   use dda_kinds, only : wp
   use dda_sort, only : place_in, rising_order
   implicit none
   private

   public :: drawn_joints, find_near_misses

   !> Largest near miss that is joined, over the contact tolerance
   real(wp), parameter :: joined = 10.0_wp
   !> Largest near miss over the size of the smaller block
   real(wp), parameter :: widest = 1.0e-3_wp

contains

   !> Joints of blocks in the reference shape
   pure subroutine drawn_joints(search, system, closes_gaps, joint, miss)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> True to join near misses
      logical, intent(in) :: closes_gaps
      !> The joints, in the order of their blocks: (n_joint)
      type(joint_t), allocatable, intent(out) :: joint(:)
      !> Near misses, joined or not; unallocated where none are joined: (n)
      type(near_miss_t), allocatable, intent(out) :: miss(:)
      type(joint_t), allocatable :: whole(:)
      type(near_miss_t), allocatable :: joined_miss(:)
      type(joint_search_t) :: both
      integer(int64), allocatable :: key(:)
      integer(int64) :: wanted
      logical, allocatable :: kept(:)
      integer :: i, j

      both = search
      if (closes_gaps .and. search%tolerance < widest) call remember_drawn(both, system, widest)
      call touching_joints(both, system, search%tolerance, joint)
      if (.not. closes_gaps) return
      call add_misses(both, system, joint, miss)
      joined_miss = pack(miss, miss%is_joined)
      if (size(joined_miss) == 0) return
      ! a touching corner belongs to the joint of its edge
      allocate (kept(size(joint)), source=.true.)
      key = pair_key(joint, size(system%area))
      do i = 1, size(joined_miss)
         associate (edges => joined_miss(i)%joint)
            if (edges%n_contact < 2) cycle
            wanted = pair_key(edges, size(system%area))
            do j = place_in(key, wanted), size(joint)
               if (key(j) /= wanted) exit
               if (joint(j)%n_contact == 1) kept(j) = kept(j) .and. .not. holds(edges, joint(j))
            end do
         end associate
      end do
      whole = [pack(joint, kept), joined_miss%joint]
      key = pair_key(whole, size(system%area))
      joint = whole(rising_order(key))
   end subroutine drawn_joints

   !> Find blocks that almost touch
   pure subroutine find_near_misses(search, system, miss)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> The near misses, in the order of their blocks: (n)
      type(near_miss_t), allocatable, intent(out) :: miss(:)
      type(joint_t), allocatable :: joint(:)
      type(joint_search_t) :: both

      both = search
      if (search%tolerance < widest) call remember_drawn(both, system, widest)
      call touching_joints(both, system, search%tolerance, joint)
      call add_misses(both, system, joint, miss)
   end subroutine find_near_misses

   !> Find near misses: pairs of edges without a joint, and the nearest corner of blocks without any
   !> joint
   pure subroutine add_misses(search, system, joint, miss)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint(:)  !! The joints: (n_joint)
      type(near_miss_t), allocatable, intent(out) :: miss(:)
      type(joint_t), allocatable :: wide(:)
      type(near_miss_t), allocatable :: list(:)
      type(near_miss_t) :: new
      real(wp), allocatable :: size_of(:)
      integer(int64) :: key(size(joint))
      integer(int64), allocatable :: wide_key(:)
      integer :: i, k, n

      allocate (miss(0))
      if (search%tolerance >= widest) return
      call touching_joints(search, system, widest, wide, size_of)
      key = pair_key(joint, size(system%area))
      wide_key = pair_key(wide, size(system%area))
      allocate (list(size(wide)))
      n = 0
      do i = 1, size(wide)
         k = place_in(key, wide_key(i))
         if (has_joint(joint, key, k, wide_key(i), wide(i))) cycle
         new = measured(system, wide(i), size_of(i), search%tolerance)
         if (wide(i)%n_contact == 2) then
            if (.not. is_misfit(new, size_of(i))) cycle
         else if (n > 0) then
            ! only the nearest corner, and none in addition to edges
            if (all(list(n)%joint%block == wide(i)%block)) then
               if (list(n)%joint%n_contact == 1 .and. abs(new%gap) < abs(list(n)%gap)) list(n) = new
               cycle
            end if
         end if
         n = n + 1
         list(n) = new
      end do
      miss = list(:n)
   end subroutine add_misses

   !> True if the blocks have this joint of two edges; for a corner, if they have any joint
   pure logical function has_joint(joint, key, first, wanted, other)
      type(joint_t), intent(in) :: joint(:)
      integer(int64), intent(in) :: key(:)  !! Keys of their blocks, ascending: (n_joint)
      integer, intent(in) :: first          !! First joint of these blocks
      integer(int64), intent(in) :: wanted  !! Key of the blocks
      type(joint_t), intent(in) :: other
      integer :: j

      has_joint = .false.
      do j = first, size(joint)
         if (key(j) /= wanted) return
         has_joint = other%n_contact == 1 .or. same_joint(joint(j), other)
         if (has_joint) return
      end do
   end function has_joint

   !> Measure a near miss
   pure type(near_miss_t) function measured(system, joint, size_of, tolerance) result(miss)
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint
      real(wp), intent(in) :: size_of    !! Size of the smaller block [m]
      real(wp), intent(in) :: tolerance  !! The contact tolerance
      type(joint_place_t) :: place
      real(wp) :: gap(3)
      integer :: k

      call place_joint(system%vertex, joint, place, gap)
      k = maxloc(abs(gap(:joint%n_contact)), dim=1)
      miss = near_miss_t(joint, gap(k), place%point(:, k), tolerance*size_of)
      if (joint%n_contact == 2) miss%tilt = abs(gap(1) - gap(2))/joint%length
      miss%is_joined = abs(miss%gap) <= max(tolerance, min(joined*tolerance, widest))*size_of
   end function measured

   !> True if two edges probably should coincide: they overlap by more than a corner, and their
   !> angle is within errors of coordinates, unlike that of a round or tapered block
   pure logical function is_misfit(miss, size_of)
      type(near_miss_t), intent(in) :: miss
      real(wp), intent(in) :: size_of

      is_misfit = miss%joint%length > widest*size_of .and. miss%tilt <= widest
   end function is_misfit

   !> True if a joint of edges includes the contact of a corner
   pure logical function holds(edges, corner)
      type(joint_t), intent(in) :: edges   !! The joint of edges
      type(joint_t), intent(in) :: corner  !! The joint of a corner

      holds = any(edges%contact%vertex == corner%contact(1)%vertex &
         & .and. edges%contact%edge == corner%contact(1)%edge)
   end function holds

   !> Key of the blocks of a joint, for sorting
   elemental integer(int64) function pair_key(joint, n_block)
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: n_block  !! Total number of blocks

      pair_key = int(joint%block(1), int64)*(n_block + 1) + joint%block(2)
   end function pair_key
end module dda_near_miss
