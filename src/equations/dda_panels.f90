!> Numbers of a factor by panels, in working precision
module dda_panels
   use dda_block_plan, only : block_plan_t, most_columns
   use dda_kinds, only : rk => wp
   implicit none
   private

   public :: panels_t, new_panels, eliminate, substitute_panels

   !> Numbers of a factor L D L', or L U where the matrix is not symmetric
   type :: panels_t
      !> L by panels, of which the diagonal triples are inverses
      real(rk), allocatable :: lower(:)
      !> The transpose of U likewise, or without entries
      real(rk), allocatable :: upper(:)
      !> D, ones where the matrix is not symmetric: (3, n)
      real(rk), allocatable :: pivot(:, :)
      !> Whether the matrix is symmetric
      logical :: symmetric = .true.
      !> Whether the factor can be used
      logical :: usable = .false.
   end type panels_t

contains

   include "dda_panels.inc"
   include "dda_panel_factor.inc"
   include "dda_panel_substitution.inc"
end module dda_panels
