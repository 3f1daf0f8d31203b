!> Factor of the stiffness matrix of springs in numbers of twice the digits: each operation takes as
!> long as dozens in numbers that the processor has
module dda_wide_factor
   use dda_block_plan, only : coupling_places_t, elimination_plan_t, most_columns
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : joint_rays, n_side, scaled_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: wide_factor_t, factorise_wide, substitute_wide

   !> Kind of numbers with 30 digits or more; where there is none, with 18
   integer, parameter :: rk = merge(selected_real_kind(30), selected_real_kind(18), &
      & selected_real_kind(30) > 0)

   include "../linalg/dda_panel_type.inc"

   !> The factor; its plan is that of the factor in working precision
   type :: wide_factor_t
      type(panels_t) :: panels  !! The numbers
   end type wide_factor_t

   !> Assemble springs along all rays and masses, and factor
   interface factorise_wide
      module procedure factorise_springs
   end interface factorise_wide

   !> Solve for one right-hand side
   interface substitute_wide
      module procedure substitute_springs
   end interface substitute_wide

contains

   include "dda_spring_panels.inc"
   include "../linalg/dda_panels.inc"
   include "../linalg/dda_panel_factor.inc"
   include "../linalg/dda_panel_substitution.inc"
end module dda_wide_factor
