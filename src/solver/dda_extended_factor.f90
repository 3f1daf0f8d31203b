!> Factor of the stiffness matrix of springs in numbers of some more digits that the processor has,
!> for springs whose stiffness spreads over more decades than working precision has
module dda_extended_factor
   use dda_block_plan, only : elimination_plan_t, most_columns
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_places, only : joint_places_t
   use dda_joint_rays, only : joint_rays, n_side, scaled_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: panels_t, factorise_springs, substitute_springs

   !> Kind of numbers with 18 digits or more
   integer, parameter :: rk = selected_real_kind(18)

   include "../linalg/dda_panel_type.inc"

contains

   include "dda_spring_panels.inc"
   include "../linalg/dda_panels.inc"
   include "../linalg/dda_panel_factor.inc"
   include "../linalg/dda_panel_substitution.inc"
end module dda_extended_factor
