!> One step of the original's scheme
module dda_limerick_step
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_assembly, only : assemble_limerick, couple_blocks, limerick_equations_t
   use dda_limerick_contact, only : contact_list_t, contact_spring_t, place_springs
   use dda_limerick_detection, only : find_limerick_contacts
   use dda_limerick_interval, only : choose_interval, judge_limerick_step
   use dda_limerick_model, only : limerick_model_t
   use dda_limerick_open_close, only : open_and_close
   use dda_limerick_state, only : limerick_state, limerick_blocks_t, limerick_march_t
   use dda_limerick_transfer, only : begin_contacts, transfer_contacts
   use dda_limerick_update, only : move_vertices, update
   implicit none
   private

   public :: limerick_run_t, advance_limerick

   !> Everything that a run carries from step to step
   type :: limerick_run_t
      !> The blocks
      type(limerick_blocks_t) :: blocks
      !> Contacts of the last step
      type(contact_list_t) :: contacts
      !> Numbers of the march
      type(limerick_march_t) :: march
      !> Work space: contacts of the step before
      type(contact_list_t) :: before
      !> Work space: springs of the contacts
      type(contact_spring_t), allocatable :: spring(:)
      !> Work space: the equations
      type(limerick_equations_t) :: equations
      !> Work space: corners at the end of an attempt: (2, n_vertex) [m]
      real(wp), allocatable :: moved(:, :)
      !> Work space: blocks from left to right: (n_block)
      integer, allocatable :: order(:)
   end type limerick_run_t

   !> Most attempts at one step: the original has no such bound and may loop forever
   integer, parameter :: max_attempts = 200

contains

   !> One step: blocks and contacts change only when it is accepted; the penalty changes at each
   !> attempt
   pure subroutine advance_limerick(model, run, error)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      !> Allocated if no attempt was accepted
      type(error_t), allocatable, intent(out) :: error
      logical :: first_pass, settled, accepted
      integer :: attempt

      call choose_interval(model, run%march)
      call meet(model, run)
      first_pass = .true.
      do attempt = 1, max_attempts
         call assemble_limerick(model, run%blocks, run%march, run%equations)
         run%contacts%item(:run%contacts%n)%before = limerick_state%open
         call open_and_close(model, run%blocks, run%contacts, run%spring, run%march, &
            & first_pass, run%equations, settled)
         if (.not. solved(run%equations)) then
            call fatal_error(error, "the equations of a step have no usable solution")
            return
         end if
         call move_vertices(model, run%blocks, run%equations%motion, run%march, run%moved)
         call judge_limerick_step(model, run%contacts, settled, run%march, accepted)
         if (accepted) exit
      end do
      if (accepted) then
         call update(model, run%equations%motion, run%blocks, run%march, run%moved)
      else
         call fatal_error(error, "no convergence at one step in the attempts that are "// &
            & "allowed (the original loops forever)")
      end if
   end subroutine advance_limerick

   !> Whether the equations gave a motion; one that is not finite is none
   pure logical function solved(equations)
      !> The equations after a solution
      type(limerick_equations_t), intent(in) :: equations

      solved = equations%factor%usable
      if (solved) solved = sum(abs(equations%motion)) <= huge(1.0_wp)
   end function solved

   !> The contacts of the step, with the states of the step before, and their springs
   pure subroutine meet(model, run)
      type(limerick_model_t), intent(in) :: model
      type(limerick_run_t), intent(inout) :: run
      type(contact_list_t) :: swap
      integer :: c

      call move_alloc(run%before%item, swap%item)
      call move_alloc(run%contacts%item, run%before%item)
      call move_alloc(swap%item, run%contacts%item)
      run%before%n = run%contacts%n
      call find_limerick_contacts(run%blocks, run%march%reach, model%constants%overlap_deg, &
         & run%order, run%contacts)
      if (run%march%passes == 0) then
         call begin_contacts(run%blocks, model%constants%dynamic, &
            & model%constants%close_ratio*run%march%reach, run%contacts)
      else
         call transfer_contacts(run%blocks, run%before, run%contacts)
      end if
      if (size(run%spring) < run%contacts%n) then
         deallocate (run%spring)
         allocate (run%spring(2*run%contacts%n))
      end if
      do c = 1, run%contacts%n
         call place_springs(run%blocks, run%contacts%item(c), run%spring(c))
      end do
      call couple_blocks(model, run%contacts, size(run%order), run%equations, run%spring)
   end subroutine meet
end module dda_limerick_step
