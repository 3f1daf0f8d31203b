!> Elimination and substitution of blocks with 6 unknowns
module dda_block_rows_6
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : block_factor_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: eliminate, substitute_rows

   !> Unknowns of one block
   integer, parameter :: nd = 6
   integer :: row, column
   !> Ones on the diagonal
   real(wp), parameter :: unit_matrix(nd, nd) = reshape([((merge(1.0_wp, 0.0_wp, row == column), &
      & row=1, nd), column=1, nd)], [nd, nd])
   !> Ones below the diagonal
   real(wp), parameter :: below(nd, nd) = reshape([((merge(1.0_wp, 0.0_wp, row > column), &
      & row=1, nd), column=1, nd)], [nd, nd])

contains

   include "dda_block_rows.inc"
end module dda_block_rows_6
