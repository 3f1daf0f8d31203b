!> Does a structure stand under Coulomb friction: the decision that searches are made of
!>
!> The convex problem, in which sliding opens the joint, comes first: what falls there falls under
!> every flow rule. What stands there without sliding stands. What slides before it comes to rest is
!> run again under Coulomb friction.
module dda_decision
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t
   use dda_forward, only : outcome_t, run_to_verdict
   use dda_frames, only : album_t, blank_album
   use dda_settings, only : flow_rule, settings_t
   use dda_step_context, only : march_t
   use dda_verdict, only : verdict
   implicit none
   private

   public :: decision_t, decide, follow_coulomb

   !> A decided structure
   type :: decision_t
      !> How the run ended; its counts are those of all runs
      type(outcome_t) :: outcome
      !> Blocks at the end
      type(block_system_t) :: system
      !> Contacts at the end
      type(contacts_t) :: contacts
      !> Flow rule of the run that gave them, one of flow_rule
      integer :: flow = 1
      !> Whether outcome and contacts are those of the left half of a row, up to its plane of
      !> symmetry
      logical :: halved = .false.
      !> Whether this plane runs through the last block
      logical :: keystone = .false.
   end type decision_t

contains

   !> Decide a static structure, or run a dynamic one
   pure subroutine decide(settings, system, contacts, decision, album, onward)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks at the beginning
      type(block_system_t), intent(in) :: system
      !> The contacts at the beginning
      type(contacts_t), intent(in) :: contacts
      !> The decision
      type(decision_t), intent(out) :: decision
      !> Receives pictures of the run that decides
      type(album_t), intent(inout), optional :: album
      !> Where a dynamic run goes on and where it ended
      type(march_t), intent(inout), optional :: onward
      type(settings_t) :: convex

      if (settings%dynamic) then
         call follow_coulomb(settings, system, contacts, decision, album, onward)
         return
      end if
      convex = settings
      convex%flow = flow_rule%associated
      decision%flow = convex%flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(convex, decision%system, decision%contacts, decision%outcome, album)
      if (decision%outcome%verdict /= verdict%stable) return
      if (settings%verdict_flow == flow_rule%associated) return
      if (.not. any(decision%contacts%face%slip /= 0)) return
      if (present(album)) album = blank_album(album)
      call follow_coulomb(settings, system, contacts, decision, album)
   end subroutine decide

   !> Run a structure under Coulomb friction from its beginning
   pure subroutine follow_coulomb(settings, system, contacts, decision, album, onward)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks at the beginning
      type(block_system_t), intent(in) :: system
      !> The contacts at the beginning
      type(contacts_t), intent(in) :: contacts
      !> The decision; the counts of the run are added to those that it has
      type(decision_t), intent(inout) :: decision
      !> Receives pictures
      type(album_t), intent(inout), optional :: album
      !> Where the run goes on and where it ended
      type(march_t), intent(inout), optional :: onward
      type(settings_t) :: coulomb
      type(outcome_t) :: before

      before = decision%outcome
      coulomb = settings
      coulomb%flow = flow_rule%coulomb
      decision%flow = coulomb%flow
      decision%system = system
      decision%contacts = contacts
      call run_to_verdict(coulomb, decision%system, decision%contacts, decision%outcome, album, &
         & onward)
      associate (outcome => decision%outcome)
         outcome%steps = outcome%steps + before%steps
         outcome%passes = outcome%passes + before%passes
         outcome%factorisations = outcome%factorisations + before%factorisations
      end associate
   end subroutine follow_coulomb
end module dda_decision
