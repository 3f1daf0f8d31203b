!> Arrays with doubling capacity, so that appending has constant cost
module dda_growth
   use dda_kinds, only : wp
   implicit none
   private

   public :: make_room

   !> Make sure that an array has room for n items; existing items are kept
   interface make_room
      module procedure room_for_integers
      module procedure room_for_logicals
      module procedure room_for_columns
      module procedure room_for_slices
   end interface make_room

contains

   !> New capacity of an array that is too small
   pure integer function next_room(room, n)
      integer, intent(in) :: room  !! Current capacity
      integer, intent(in) :: n     !! Required capacity

      next_room = max(n, 8, room + min(room, huge(room) - room))
   end function next_room

   !> Room for integers
   pure subroutine room_for_integers(array, n)
      integer, allocatable, intent(inout) :: array(:)  !! The numbers
      integer, intent(in) :: n                         !! Required number of items
      integer, allocatable :: longer(:)

      if (.not. allocated(array)) allocate (array(0))
      if (n <= size(array)) return
      allocate (longer(next_room(size(array), n)))
      longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine room_for_integers

   !> Room for logical values
   pure subroutine room_for_logicals(array, n)
      logical, allocatable, intent(inout) :: array(:)  !! The values
      integer, intent(in) :: n
      logical, allocatable :: longer(:)

      if (.not. allocated(array)) allocate (array(0))
      if (n <= size(array)) return
      allocate (longer(next_room(size(array), n)))
      longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine room_for_logicals

   !> Room for columns of real numbers
   pure subroutine room_for_columns(array, n)
      !> The columns; unallocated only if their height is 2
      real(wp), allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: n
      real(wp), allocatable :: longer(:, :)

      if (.not. allocated(array)) allocate (array(2, 0))
      if (n <= size(array, 2)) return
      allocate (longer(size(array, 1), next_room(size(array, 2), n)))
      longer(:, :size(array, 2)) = array
      call move_alloc(longer, array)
   end subroutine room_for_columns

   !> Room for slices of real numbers
   pure subroutine room_for_slices(array, n)
      real(wp), allocatable, intent(inout) :: array(:, :, :)  !! The slices, allocated
      integer, intent(in) :: n
      real(wp), allocatable :: longer(:, :, :)

      if (n <= size(array, 3)) return
      allocate (longer(size(array, 1), size(array, 2), next_room(size(array, 3), n)))
      longer(:, :, :size(array, 3)) = array
      call move_alloc(longer, array)
   end subroutine room_for_slices
end module dda_growth
