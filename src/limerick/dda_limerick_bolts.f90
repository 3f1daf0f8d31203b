!> Bolts by the original's rule (Shi: df17): linear springs that pull and push, whatever their
!> strength, along the line between their ends at the beginning of each step
module dda_limerick_bolts
   use dda_kinds, only : wp
   use dda_limerick_contact, only : generalised
   use dda_limerick_model, only : limerick_model_t
   use dda_limerick_state, only : limerick_blocks_t
   implicit none
   private

   public :: bolt_elongation, bolt_rows, n_bolts

contains

   !> Number of bolts
   pure integer function n_bolts(model)
      type(limerick_model_t), intent(in) :: model

      n_bolts = 0
      if (allocated(model%boundary%bar)) n_bolts = size(model%boundary%bar)
   end function n_bolts

   !> Elongation of a bolt per unknown of its two blocks; nothing for the ground
   pure function bolt_rows(model, blocks, i) result(row)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks
      !> Number of the bolt
      integer, intent(in) :: i
      !> (6, 2)
      real(wp) :: row(6, 2)
      real(wp) :: along(2)
      integer :: side

      row = 0.0_wp
      along = blocks%bolt_point(:, 1, i) - blocks%bolt_point(:, 2, i)
      along = along/norm2(along)
      do side = 1, 2
         associate (b => model%boundary%bar(i)%block(side))
            if (b > 0) row(:, side) = generalised(merge(along, -along, side == 1), &
               & blocks%bolt_point(:, side, i), blocks%centroid(:, b))
         end associate
      end do
   end function bolt_rows

   !> Elongation of a bolt in a step
   pure real(wp) function bolt_elongation(model, blocks, i, motion)
      type(limerick_model_t), intent(in) :: model
      !> The blocks at the beginning of the step
      type(limerick_blocks_t), intent(in) :: blocks
      integer, intent(in) :: i
      !> Motion of the blocks: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      real(wp) :: row(6, 2)
      integer :: side

      row = bolt_rows(model, blocks, i)
      bolt_elongation = 0.0_wp
      do side = 1, 2
         associate (b => model%boundary%bar(i)%block(side))
            if (b > 0) bolt_elongation = bolt_elongation + dot_product(row(:, side), motion(:, b))
         end associate
      end do
   end function bolt_elongation
end module dda_limerick_bolts
