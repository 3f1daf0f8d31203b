!> Elimination and substitution of blocks with 6 unknowns
module dda_block_rows_6
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : block_factor_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: eliminate, eliminate_pairs, substitute_rows

   !> Unknowns of one block
   integer, parameter :: nd = 6
   !> Their numbers
   integer, parameter :: number(nd) = [1, 2, 3, 4, 5, 6]
   !> Ones on the diagonal
   real(wp), parameter :: unit_matrix(nd, nd) = merge(1.0_wp, 0.0_wp, &
      & spread(number, 2, nd) == spread(number, 1, nd))
   !> Ones below the diagonal
   real(wp), parameter :: below(nd, nd) = merge(1.0_wp, 0.0_wp, &
      & spread(number, 2, nd) > spread(number, 1, nd))
   !> What is first added to a diagonal block without a factor, over the matrix's diagonal
   real(wp), parameter :: first_lift = 1.0e-10_wp
   !> How that grows from turn to turn
   real(wp), parameter :: lift_growth = 100.0_wp
   !> Most turns
   integer, parameter :: most_lifts = 12

contains

   include "dda_block_rows.inc"
end module dda_block_rows_6
