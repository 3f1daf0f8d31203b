!> Factor of the stiffness matrix of springs in numbers of twice the digits: each operation takes as
!> long as dozens in numbers that the processor has
module dda_wide_factor
   use dda_block_plan, only : elimination_plan_t, most_columns
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_places, only : joint_places_t
   use dda_joint_rays, only : joint_rays, n_side, scaled_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: panels_t, factorise_springs, substitute_springs

   !> Kind of numbers with 30 digits or more; where there is none, with 18
   integer, parameter :: rk = merge(selected_real_kind(30), selected_real_kind(18), &
      & selected_real_kind(30) > 0)

   include "../linalg/dda_panel_type.inc"

contains

   include "dda_spring_panels.inc"
   include "../linalg/dda_panels.inc"
   include "../linalg/dda_panel_factor.inc"
   include "../linalg/dda_panel_substitution.inc"
end module dda_wide_factor
