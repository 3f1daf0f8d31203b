!> Whether the separating axes of a step were the right ones
!>
!> Where corners pass corners, which edge the one would go in by depends on the way that both take,
!> and that is only known when the step has been settled. A line that has held off a block which
!> turns out to be apart from its neighbour was the wrong one, and so was one that has let it in;
!> then the lines are chosen anew by the way the blocks have taken.
module dda_parting
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_kinds, only : wp
   use dda_parting_line, only : block_gap
   use dda_step_context, only : march_t, step_context_t, step_outcome_t
   implicit none
   private

   public :: check_axes

   !> Gap or depth that is no matter, over the size of the smaller block
   real(wp), parameter :: no_matter = 1.0e-6_wp
   !> Choices of the lines by the way the blocks have taken
   integer, parameter :: max_choices = 2
   !> Steps shorter than this share of the longest one are not cut further
   real(wp), parameter :: shortest = 1.0e-3_wp

contains

   !> Check the lines of a settled step: where they were wrong they must be chosen anew by its
   !> motion; if blocks still enter one another the step is cut, and if some are still held off in
   !> thin air, they are
   pure type(step_outcome_t) function check_axes(system, contacts, march, step) result(outcome)
      !> The blocks before the step
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      real(wp) :: gap, matters
      logical :: entered, held_off
      integer :: j

      entered = .false.
      held_off = .false.
      do j = 1, size(contacts%joint)
         associate (block => contacts%joint(j)%block)
            if (.not. all(contacts%search%outline%convex(block))) cycle
            matters = no_matter*sqrt(minval(system%area(block)))
            gap = block_gap(system%first_vertex, step%after%moved, block)
            if (gap > matters .and. .not. all(step%state%face(j)%open)) held_off = .true.
            if (gap > -matters) cycle
            if (gap < block_gap(system%first_vertex, system%moved, block) - matters) &
               & entered = .true.
         end associate
      end do
      outcome%dt = step%dt
      outcome%wrong_axes = (entered .or. held_off) .and. step%choices < max_choices
      outcome%accepted = .not. outcome%wrong_axes
      if (outcome%wrong_axes .or. .not. entered .or. step%dt <= shortest*march%longest) return
      outcome = step_outcome_t(dt=step%dt/2.0_wp, was_cut=.true.)
   end function check_axes
end module dda_parting
