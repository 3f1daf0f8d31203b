!> Bars between two points of blocks: bolts, anchors and ties
!>
!> A bar pulls with a force between nothing and its strength; beyond that it yields, or breaks. One
!> that may push does so where blocks move in time.
module dda_bar
   use dda_kinds, only : wp
   implicit none
   private

   public :: bar_condition, bar_condition_enum, bar_name, bar_state_t, bar_t

   !> What a bar does
   type :: bar_condition_enum
      integer :: elastic = 0   !! Its force follows its length
      integer :: slack = 1     !! It hangs loose
      integer :: yielding = 2  !! It carries its strength
      integer :: broken = 3    !! It carries nothing any more
   end type bar_condition_enum

   !> Names of the conditions
   type(bar_condition_enum), parameter :: bar_condition = bar_condition_enum()
   !> The same in words
   character(len=*), parameter :: bar_name(0:3) = [character(len=8) :: "elastic", "slack", &
      & "yielding", "broken"]

   !> A bar
   type :: bar_t
      integer :: block(2) = 0              !! Blocks of its ends, 0 for the ground: (2)
      real(wp) :: point(2, 2) = 0.0_wp     !! Its ends in the reference shape: (2, 2) [m]
      real(wp) :: stiffness = 0.0_wp       !! Force over elongation [N/m]
      real(wp) :: strength = huge(1.0_wp)  !! Largest force [N]
      real(wp) :: prestress = 0.0_wp       !! Force at the beginning [N]
      logical :: pushes = .true.           !! Whether it may push where blocks move in time
      logical :: breaks = .false.          !! Whether it breaks where another would yield
      integer :: line = 0                  !! Line of the file, 0 if there is none
   end type bar_t

   !> What a bar carries from step to step
   type :: bar_state_t
      real(wp) :: plastic = 0.0_wp                  !! Elongation that stays [m]
      real(wp) :: force = 0.0_wp                    !! Its force, positive where it pulls [N]
      integer :: condition = bar_condition%elastic  !! One of bar_condition
   end type bar_state_t
end module dda_bar
