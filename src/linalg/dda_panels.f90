!> Numbers of a factor by panels, in working precision
module dda_panels
   use dda_block_plan, only : elimination_plan_t, most_columns
   use dda_kinds, only : rk => wp
   implicit none
   private

   public :: panels_t, new_panels, eliminate, substitute_panels

   include "dda_panel_type.inc"

contains

   include "dda_panels.inc"
   include "dda_panel_factor.inc"
   include "dda_panel_substitution.inc"
end module dda_panels
