!> Points of a block that are held or led: whether one more can be
module dda_held_paths
   use dda_boundary, only : held_point_t, history_t, value_at
   use dda_kinds, only : wp
   use dda_least_squares, only : least_squares
   implicit none
   private

   public :: contradicts

   !> Places nearer than this share of the block's size are the same
   real(wp), parameter :: same = 1.0e-9_wp

contains

   !> Whether a point is to go where the points held already do not let it. A block moves and
   !> strains linearly, so along each direction a point that is a mixture of held ones goes where
   !> the mixture of their ways leads
   pure logical function contradicts(held, more, size_of_block)
      !> Points that are held: (n)
      type(held_point_t), intent(in) :: held(:)
      !> The point
      type(held_point_t), intent(in) :: more
      !> Size of its block [m]
      real(wp), intent(in) :: size_of_block
      integer, allocatable :: other(:)
      real(wp), allocatable :: row(:, :), share(:)
      integer :: axis, i

      contradicts = .false.
      do axis = 1, 2
         if (.not. more%along(axis)) cycle
         other = pack([(i, i=1, size(held))], held%block == more%block .and. held%along(axis))
         if (size(other) == 0) cycle
         row = reshape([(1.0_wp, (held(other(i))%point - more%point)/size_of_block, &
            & i=1, size(other))], [3, size(other)])
         share = least_squares(row, [1.0_wp, 0.0_wp, 0.0_wp], same)
         if (norm2(matmul(row, share) - [1.0_wp, 0.0_wp, 0.0_wp]) > same) cycle
         contradicts = contradicts .or. far_from(held(other), share, more, axis, same*size_of_block)
      end do
   end function contradicts

   !> Whether a way is ever off the mixture of others; all are linear between their times
   pure logical function far_from(held, share, more, axis, tolerance)
      !> The others: (n)
      type(held_point_t), intent(in) :: held(:)
      !> Their shares: (n)
      real(wp), intent(in) :: share(:)
      !> The point
      type(held_point_t), intent(in) :: more
      !> Direction, 1 or 2 for x or y
      integer, intent(in) :: axis
      !> How far off it may be [m]
      real(wp), intent(in) :: tolerance
      real(wp), allocatable :: time(:)
      real(wp) :: way(2), mixture
      integer :: i, k

      allocate (time, source=times_of(more%path))
      do i = 1, size(held)
         time = [time, times_of(held(i)%path)]
      end do
      far_from = .false.
      do k = 1, size(time)
         mixture = 0.0_wp
         do i = 1, size(held)
            way = value_at(held(i)%path, time(k))
            mixture = mixture + share(i)*way(axis)
         end do
         way = value_at(more%path, time(k))
         far_from = far_from .or. abs(way(axis) - mixture) > tolerance
      end do
   end function far_from

   !> Times of a history; none if nothing is given
   pure function times_of(history) result(time)
      !> The history
      type(history_t), intent(in) :: history
      !> The times: (n) [s]
      real(wp), allocatable :: time(:)

      allocate (time(0))
      if (allocated(history%time)) time = history%time
   end function times_of
end module dda_held_paths
