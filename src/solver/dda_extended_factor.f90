!> Factor of the stiffness matrix of springs in numbers of some more digits that the processor has,
!> for springs whose stiffness spreads over more decades than working precision has
module dda_extended_factor
   use dda_block_plan, only : coupling_places_t, elimination_plan_t, most_columns
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : joint_rays, n_side, scaled_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: extended_factor_t, factorise_extended, substitute_extended

   !> Kind of numbers with 18 digits or more
   integer, parameter :: rk = selected_real_kind(18)

   include "../linalg/dda_panel_type.inc"

   !> The factor; its plan is that of the factor in working precision
   type :: extended_factor_t
      type(panels_t) :: panels  !! The numbers
   end type extended_factor_t

   !> Assemble springs along all rays and masses, and factor
   interface factorise_extended
      module procedure factorise_springs
   end interface factorise_extended

   !> Solve for one right-hand side
   interface substitute_extended
      module procedure substitute_springs
   end interface substitute_extended

contains

   include "dda_spring_panels.inc"
   include "../linalg/dda_panels.inc"
   include "../linalg/dda_panel_factor.inc"
   include "../linalg/dda_panel_substitution.inc"
end module dda_extended_factor
