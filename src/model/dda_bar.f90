!> Bars between two points of blocks: bolts, anchors and ties
!>
!> The tension of a bar is between zero and its strength; at its strength the bar yields or breaks.
!> In dynamic runs a bar may also carry compression.
module dda_bar
   use dda_kinds, only : wp
   implicit none
   private

   public :: bar_condition, bar_condition_enum, bar_name, bar_state_t, bar_t

   !> Conditions of a bar
   type :: bar_condition_enum
      integer :: elastic = 0   !! Force proportional to elongation
      integer :: slack = 1     !! No force
      integer :: yielding = 2  !! Force equal to the strength
      integer :: broken = 3    !! No force for the rest of the run
   end type bar_condition_enum

   !> Names of the conditions
   type(bar_condition_enum), parameter :: bar_condition = bar_condition_enum()
   !> Names of the conditions in output
   character(len=*), parameter :: bar_name(0:3) = [character(len=8) :: "elastic", "slack", &
      & "yielding", "broken"]

   !> A bar
   type :: bar_t
      integer :: block(2) = 0              !! Blocks of its ends, 0 for the ground: (2)
      real(wp) :: point(2, 2) = 0.0_wp     !! Its ends in the reference shape: (2, 2) [m]
      real(wp) :: stiffness = 0.0_wp       !! Force per elongation [N/m]
      real(wp) :: strength = huge(1.0_wp)  !! Largest force [N]
      real(wp) :: prestress = 0.0_wp       !! Force at the beginning [N]
      logical :: pushes = .true.           !! True if it carries compression in dynamic runs
      logical :: breaks = .false.          !! True if it breaks at its strength, otherwise it yields
      integer :: line = 0                  !! Line of the file, 0 if there is none
   end type bar_t

   !> State of a bar from step to step
   type :: bar_state_t
      real(wp) :: plastic = 0.0_wp                  !! Permanent elongation [m]
      real(wp) :: force = 0.0_wp                    !! Force, positive in tension [N]
      integer :: condition = bar_condition%elastic  !! One of bar_condition
   end type bar_state_t
end module dda_bar
