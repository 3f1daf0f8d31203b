!> Fixed and prescribed points of a block: whether one more is compatible
module dda_held_paths
   use dda_boundary, only : held_point_t, history_t, value_at
   use dda_kinds, only : wp
   use dda_least_squares, only : least_squares
   implicit none
   private

   public :: compare_paths

   !> Places nearer than this share of the block's size are the same
   real(wp), parameter :: same = 1.0e-9_wp
   !> So many points of a block along a direction, of which three would do, are kept to choose from
   integer, parameter :: enough = 16

contains

   !> Whether a point is to go where the points held already do not let it. A block moves and
   !> strains linearly, so along each direction a point that is a mixture of held ones goes where
   !> the mixture of their ways leads
   pure subroutine compare_paths(held, other, more, size_of_block, contradicts, telling)
      !> Points that are held: (n)
      type(held_point_t), intent(in) :: held(:)
      !> Those of the same block that have told something: (n)
      integer, intent(in) :: other(:)
      type(held_point_t), intent(in) :: more
      !> Size of its block [m]
      real(wp), intent(in) :: size_of_block
      !> Whether it cannot go its way
      logical, intent(out) :: contradicts
      !> Whether it tells something: those that follow need not be compared with others
      logical, intent(out) :: telling
      integer, allocatable :: same_axis(:)
      real(wp), allocatable :: row(:, :), share(:)
      integer :: axis, i

      contradicts = .false.
      telling = .false.
      do axis = 1, 2
         if (.not. more%along(axis)) cycle
         same_axis = pack(other, held(other)%along(axis))
         telling = telling .or. size(same_axis) < enough
         if (size(same_axis) == 0) cycle
         row = reshape([(1.0_wp, (held(same_axis(i))%point - more%point)/size_of_block, &
            & i=1, size(same_axis))], [3, size(same_axis)])
         share = least_squares(row, [1.0_wp, 0.0_wp, 0.0_wp], same)
         if (norm2(matmul(row, share) - [1.0_wp, 0.0_wp, 0.0_wp]) > same) then
            telling = .true.
            cycle
         end if
         same_axis = pack(same_axis, abs(share) > 0.0_wp)
         share = pack(share, abs(share) > 0.0_wp)
         contradicts = contradicts .or. &
            & far_from(held, same_axis, share, more, axis, same*size_of_block)
      end do
   end subroutine compare_paths

   !> Whether a way is ever off the mixture of others; all are linear between their times
   pure logical function far_from(held, other, share, more, axis, tolerance)
      type(held_point_t), intent(in) :: held(:)
      !> Numbers of the others: (m)
      integer, intent(in) :: other(:)
      !> Their shares: (m)
      real(wp), intent(in) :: share(:)
      type(held_point_t), intent(in) :: more
      !> Direction, 1 or 2 for x or y
      integer, intent(in) :: axis
      !> How far off it may be [m]
      real(wp), intent(in) :: tolerance
      real(wp), allocatable :: time(:)
      real(wp) :: way(2), off
      integer :: i, k

      allocate (time, source=times_of(more%path))
      do i = 1, size(other)
         time = [time, times_of(held(other(i))%path)]
      end do
      far_from = .false.
      do k = 1, size(time)
         way = value_at(more%path, time(k))
         off = way(axis)
         do i = 1, size(other)
            way = value_at(held(other(i))%path, time(k))
            off = off - share(i)*way(axis)
         end do
         far_from = abs(off) > tolerance
         if (far_from) return
      end do
   end function far_from

   !> Times of a history; none if nothing is given
   pure function times_of(history) result(time)
      type(history_t), intent(in) :: history
      !> The times: (n) [s]
      real(wp), allocatable :: time(:)

      allocate (time(0))
      if (allocated(history%time)) time = history%time
   end function times_of
end module dda_held_paths
