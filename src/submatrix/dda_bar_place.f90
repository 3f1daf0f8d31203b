!> Where a bar is, and how the unknowns of its two blocks see it
module dda_bar_place
   use dda_bar, only : bar_t
   use dda_block_system, only : block_system_t
   use dda_deformation, only : displacement_matrix, moved_point, tangent_matrix
   use dda_kinds, only : wp
   implicit none
   private

   public :: place_bar, reference_rows

contains

   !> Rows of a bar where nothing has moved: its elongation by the motion of the blocks at its ends
   pure function reference_rows(system, bar) result(row)
      type(block_system_t), intent(in) :: system
      type(bar_t), intent(in) :: bar
      real(wp) :: row(6, 2)  !! For both ends: (6, 2)
      real(wp) :: along(2)
      integer :: side

      along = bar%point(:, 1) - bar%point(:, 2)
      along = along/norm2(along)
      row = 0.0_wp
      do side = 1, 2
         if (bar%block(side) > 0) row(:, side) = merge(1.0_wp, -1.0_wp, side == 1) &
            & *matmul(along, displacement_matrix(bar%point(:, side), &
            & system%centroid(:, bar%block(side))))
      end do
   end function reference_rows

   !> Rows and elongation of one bar
   pure subroutine place_bar(system, current, bar, row, elongation, inverse_length)
      type(block_system_t), intent(in) :: system
      !> Whether the bar goes with the blocks
      logical, intent(in) :: current
      type(bar_t), intent(in) :: bar
      !> Rows along and across, for both blocks: (n_dof, 2, 2)
      real(wp), intent(out) :: row(:, :, :)
      !> How much longer it is than at the beginning [m]
      real(wp), intent(out) :: elongation
      !> One over its length where it turns with the blocks, else 0 [1/m]
      real(wp), intent(out) :: inverse_length
      real(wp) :: t(2, 6, 2), place(2, 2), along(2), before(2), moved(2)
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
      along = (place(:, 1) - place(:, 2))/norm2(place(:, 1) - place(:, 2))
      elongation = dot_product(along, moved)
      inverse_length = 0.0_wp
      if (current) then
         ! the difference of the squares of two lengths keeps its digits where they are near
         moved = place(:, 1) - place(:, 2) - before
         elongation = dot_product(moved, place(:, 1) - place(:, 2) + before) &
            & /(norm2(place(:, 1) - place(:, 2)) + norm2(before))
         inverse_length = 1.0_wp/norm2(place(:, 1) - place(:, 2))
      end if
      do side = 1, 2
         row(:, 1, side) = matmul(along, t(:, :size(row, 1), side))
         row(:, 2, side) = matmul([-along(2), along(1)], t(:, :size(row, 1), side))
      end do
      row(:, :, 2) = -row(:, :, 2)
   end subroutine place_bar
end module dda_bar_place
