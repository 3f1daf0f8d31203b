!> Numbers of a factor by panels in numbers of twice the digits
module dda_wide_panels
   use dda_block_plan, only : elimination_plan_t, most_columns
   implicit none
   private

   public :: panels_t, new_panels, eliminate, substitute_panels, wide

   !> Kind of numbers with 30 digits or more; where there is none, with 18
   integer, parameter :: wide = merge(selected_real_kind(30), selected_real_kind(18), &
      & selected_real_kind(30) > 0)
   !> The kind that the panels are written for
   integer, parameter :: rk = wide

   include "dda_panel_type.inc"

contains

   include "dda_panels.inc"
   include "dda_panel_factor.inc"
   include "dda_panel_substitution.inc"
end module dda_wide_panels
