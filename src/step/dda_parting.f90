!> Whether the separating axes of a step were the right ones
!>
!> Where corners pass corners, which edge the one would go in by depends on the way that both take,
!> and that is only known when the step has been settled. A line that has held off a block which
!> turns out to be apart from its neighbour was the wrong one, and so was one that has let it in;
!> then the lines are chosen anew by the way the blocks have taken.
module dda_parting
   use dda_block_system, only : block_system_t
   use dda_block_update, only : displaced_blocks
   use dda_contact_detection, only : contacts_t
   use dda_kinds, only : wp
   use dda_parting_line, only : block_gap
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, step_context_t
   implicit none
   private

   public :: judge_parting

   !> Gap or depth that is no matter, over the size of the smaller block
   real(wp), parameter :: no_matter = 1.0e-6_wp
   !> Choices of the lines by the way the blocks have taken
   integer, parameter :: max_choices = 2
   !> Steps shorter than this share of the longest one are not cut further
   real(wp), parameter :: shortest = 1.0e-3_wp

contains

   !> Judge the lines of a settled step: where they were wrong they must be chosen anew by its
   !> motion; if blocks still enter one another the step is cut, and if some are still held off in
   !> thin air, they are
   pure subroutine judge_parting(settings, system, contacts, choices, march, step, again)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      !> The contacts of the step
      type(contacts_t), intent(in) :: contacts
      !> Choices so far
      integer, intent(inout) :: choices
      !> The march; the length of the next try is set if the step is cut
      type(march_t), intent(inout) :: march
      !> The settled step; whether it is accepted is set
      type(step_context_t), intent(inout) :: step
      !> Whether lines must be chosen by the motion of this step
      logical, intent(out) :: again
      type(block_system_t) :: after
      real(wp) :: gap, matters
      logical :: entered, held_off
      integer :: j

      after = displaced_blocks(system, settings, step%state%motion)
      entered = .false.
      held_off = .false.
      do j = 1, size(contacts%joint)
         associate (block => contacts%joint(j)%block)
            if (.not. all(contacts%search%outline%convex(block))) cycle
            matters = no_matter*sqrt(minval(system%area(block)))
            gap = block_gap(system%first_vertex, after%moved, block)
            if (gap > matters .and. .not. all(step%state%face(j)%open)) held_off = .true.
            if (gap > -matters) cycle
            if (gap < block_gap(system%first_vertex, system%moved, block) - matters) &
               & entered = .true.
         end associate
      end do
      again = (entered .or. held_off) .and. choices < max_choices
      if (again) choices = choices + 1
      step%accepted = .not. again
      if (again .or. .not. entered .or. step%dt <= shortest*march%longest) return
      step%accepted = .false.
      step%was_cut = .true.
      march%dt = step%dt/2.0_wp
      choices = 0
   end subroutine judge_parting
end module dda_parting
