!> Whether a block has collapsed: it has turned over, or has left its support by its own size
!>
!> What comes to rest after that is another structure than the one in question. A block may go far
!> and not have fallen: with others that settle under it, or with what is led.
module dda_fall
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t
   use dda_contact_types, only : joint_t
   use dda_deformation, only : moved_point
   use dda_kinds, only : pi, wp
   implicit none
   private

   public :: has_fallen, neighbours_of

   !> A block that has turned by this angle has fallen [rad]
   real(wp), parameter :: turned = pi/4.0_wp

contains

   !> The pairs of blocks that touch
   pure function neighbours_of(joint) result(pair)
      !> Their joints: (n_joint)
      type(joint_t), intent(in) :: joint(:)
      !> The two blocks of each joint: (2, n_joint)
      integer :: pair(2, size(joint))

      pair(1, :) = joint%block(1)
      pair(2, :) = joint%block(2)
   end function neighbours_of

   !> Whether a block has turned by 45 degrees against all blocks whose motion is given, fixed ones
   !> among them, or has moved by its own size and no chain of blocks that touched at the beginning,
   !> each still within its size of the next, ties it to a fixed block or to one that is held
   pure logical function has_fallen(system, pair, held)
      !> The blocks, which have moved
      type(block_system_t), intent(in) :: system
      !> The pairs of blocks that touched at the beginning: (2, n_pair)
      integer, intent(in) :: pair(:, :)
      !> Held and led points
      type(held_point_t), intent(in), optional :: held(:)
      integer :: directions(size(system%area)), i, last
      logical :: far(size(system%area)), tied(size(system%area)), near
      real(wp) :: least, most

      directions = merge(3, 0, system%equation == 0)
      if (present(held)) then
         do i = 1, size(held)
            associate (n => directions(held(i)%block))
               n = n + count(held(i)%along)
            end associate
         end do
      end if
      associate (turn => system%motion(3, :))
         least = min(0.0_wp, minval(turn, mask=directions >= 3))
         most = max(0.0_wp, maxval(turn, mask=directions >= 3))
         has_fallen = any(turn - most >= turned .or. least - turn >= turned)
      end associate
      far = norm2(system%motion(1:2, :), dim=1) >= sqrt(system%area)
      if (has_fallen .or. .not. any(far)) return
      tied = directions >= 2 .or. .not. far
      last = 0
      do while (count(tied) > last)
         last = count(tied)
         do i = 1, size(pair, 2)
            if (all(tied(pair(:, i))) .or. .not. any(tied(pair(:, i)))) cycle
            near = parted(system, pair(:, i)) < sqrt(minval(system%area(pair(:, i))))
            tied(pair(:, i)) = tied(pair(:, i)) .or. near
         end do
      end do
      has_fallen = .not. all(tied)
   end function has_fallen

   !> How far the smaller of two blocks has left the place to which the larger would carry it
   pure real(wp) function parted(system, pair)
      type(block_system_t), intent(in) :: system
      !> The two blocks: (2)
      integer, intent(in) :: pair(2)
      integer :: large, small

      large = pair(maxloc(system%area(pair), dim=1))
      small = sum(pair) - large
      associate (centre => system%centroid(:, small), motion => system%motion(:, small))
         parted = norm2(moved_point(centre, system%centroid(:, large), system%motion(:, large)) &
            & - centre - motion(1:2))
      end associate
   end function parted
end module dda_fall
