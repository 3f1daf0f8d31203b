!> Position of a bar, and its elongation by the unknowns of two blocks
module dda_bar_place
   use dda_bar, only : bar_t
   use dda_block_system, only : block_system_t
   use dda_deformation, only : displacement_matrix, moved_point, tangent_matrix
   use dda_kinds, only : wp
   use dda_vector, only : along
   implicit none
   private

   public :: place_bar, bar_rows

contains

   !> Elongation of a bar or bolt by the unknowns of the blocks at its ends
   pure function bar_rows(point, block, centroid) result(row)
      real(wp), intent(in) :: point(2, 2)     !! Ends: (2, 2) [m]
      integer, intent(in) :: block(2)         !! The blocks, 0 for the ground: (2)
      real(wp), intent(in) :: centroid(:, :)  !! Centres of all blocks: (2, n_block) [m]
      real(wp) :: row(6, 2)                   !! Rows for both ends: (6, 2)
      integer :: side

      row = 0.0_wp
      do side = 1, 2
         if (block(side) > 0) row(:, side) = merge(1.0_wp, -1.0_wp, side == 1) &
            & *matmul(along(point(:, 2), point(:, 1)), displacement_matrix(point(:, side), &
            & centroid(:, block(side))))
      end do
   end function bar_rows

   !> Rows and elongation of one bar
   pure subroutine place_bar(system, current, bar, row, elongation, inverse_length)
      type(block_system_t), intent(in) :: system
      logical, intent(in) :: current  !! True in current geometry
      type(bar_t), intent(in) :: bar
      !> Rows along and across, for both blocks: (n_dof, 2, 2)
      real(wp), intent(out) :: row(:, :, :)
      real(wp), intent(out) :: elongation  !! Elongation since the start of the run [m]
      !> One over its length in current geometry, else 0 [1/m]
      real(wp), intent(out) :: inverse_length
      real(wp) :: t(2, 6, 2), place(2, 2), axis(2), before(2), moved(2)
      integer :: side

      t = 0.0_wp
      place = bar%point
      before = bar%point(:, 1) - bar%point(:, 2)
      moved = 0.0_wp
      do side = 1, 2
         associate (b => bar%block(side))
            if (b == 0) cycle
            t(:, :, side) = displacement_matrix(bar%point(:, side), system%centroid(:, b))
            if (current) then
               place(:, side) = moved_point(bar%point(:, side), system%centroid(:, b), &
                  & system%motion(:, b))
               t(:, :, side) = tangent_matrix(place(:, side), system%centroid(:, b) &
                  & + system%motion(1:2, b), system%motion(:, b))
            else
               moved = moved + merge(1.0_wp, -1.0_wp, side == 1) &
                  & *matmul(t(:, :, side), system%motion(:, b))
            end if
         end associate
      end do
      axis = along(place(:, 2), place(:, 1))
      elongation = dot_product(axis, moved)
      inverse_length = 0.0_wp
      if (current) then
         ! the difference of squared lengths avoids cancellation for nearly equal lengths
         moved = place(:, 1) - place(:, 2) - before
         elongation = dot_product(moved, place(:, 1) - place(:, 2) + before) &
            & /(norm2(place(:, 1) - place(:, 2)) + norm2(before))
         inverse_length = 1.0_wp/norm2(place(:, 1) - place(:, 2))
      end if
      do side = 1, 2
         row(:, 1, side) = matmul(axis, t(:, :size(row, 1), side))
         row(:, 2, side) = matmul([-axis(2), axis(1)], t(:, :size(row, 1), side))
      end do
      row(:, :, 2) = -row(:, :, 2)
   end subroutine place_bar
end module dda_bar_place
