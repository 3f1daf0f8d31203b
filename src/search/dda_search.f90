!> Input and result of a search
module dda_search
   use dda_bar, only : bar_state_t
   use dda_block_system, only : block_system_t
   use dda_chain_programme, only : deficit_t
   use dda_contact_types, only : joint_springs_t
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_kinds, only : wp
   use dda_limit_decision, only : load_decision_t
   use dda_limit_load, only : limit_load_t
   use dda_scene, only : link_t, scene_t
   use dda_settings, only : verdict
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: search_t, critical_t, decision_t, limit_t, proof_t, keep_decision, shed

   !> Input of a search
   type :: search_t
      real(wp) :: low = 0.0_wp           !! Least value of the parameter
      real(wp) :: high = 1.0_wp          !! Largest value of the parameter
      real(wp) :: start = 0.0_wp         !! Where to begin, from low to high
      real(wp) :: tolerance = 1.0e-8_wp  !! Width of the bracket over the critical value
      real(wp) :: least = 0.0_wp         !! Width of a bracket that decisions do not narrow
      !> Relative change of the critical value that rounded coordinates can make, if it is known
      real(wp) :: resolution = 0.0_wp
      !> Value at which that holds; elsewhere it goes with the inverse of the value's square. 0
      !> where it holds everywhere
      real(wp) :: resolution_at = 0.0_wp
      logical :: in_time = .false.  !! True if its runs are dynamic
      !> True if the associated limit of a load coefficient is known to lie beyond the range
      logical :: below_limit = .false.
      !> True if the end beyond the critical value is decided too; not needed where it is known to
      !> stand
      logical :: check_far_end = .true.
   end type search_t

   !> An associated limit with its proofs, whose forces carry the load at the first of its values
   type, extends(limit_load_t) :: limit_t
      logical :: known = .false.     !! True if it is known
      real(wp) :: value(2) = 0.0_wp  !! The limit from below and from above
      !> Load added per unit of the coefficient: (3, n_block) [N/m, N/m, N]
      real(wp), allocatable :: live(:, :)
   end type limit_t

   !> Result of a search
   type :: critical_t
      integer :: verdict = 0  !! found, or the verdict of both ends, or undecided
      !> Why the last undecided value is; unallocated if none was
      character(len=:), allocatable :: reason
      real(wp) :: undecided_at = 0.0_wp  !! The last undecided value
      real(wp) :: falls = 0.0_wp         !! Value nearest to critical at which the structure falls
      real(wp) :: stands = 0.0_wp        !! Value nearest to critical at which it stands
      real(wp) :: half = 0.0_wp  !! Half the width that rounding and tolerance leave to the bracket
      !> Least and largest critical value, as jumps of the path may lead elsewhere and joints crush
      real(wp) :: reach(2) = [huge(1.0_wp), -huge(1.0_wp)]
      real(wp) :: stop = 0.0_wp   !! Where the last collapse stops, if it does
      logical :: stops = .false.  !! True if that is known
      !> Decision at falls, if there is one; without its blocks and springs
      type(decision_t), allocatable :: fallen
      !> Decision at stands, if there is one; likewise, and without its motion
      type(decision_t), allocatable :: standing
      type(link_t) :: link            !! The last chain
      type(deficit_t) :: deficit      !! Its deficit, from which the next one starts
      real(wp) :: other = 0.0_wp      !! Value at which it falls in the other direction
      logical :: has_other = .false.  !! True if it does so within the range
      integer :: others = 0           !! Values of a dynamic search beside its bracket
      !> Other neighbours with different verdicts in a dynamic search: (2, n)
      real(wp), allocatable :: other_change(:, :)
      type(limit_t) :: limit               !! The associated limit of a load coefficient
      type(scene_t), allocatable :: scene  !! The scene of a value of the coefficient, whichever
      integer :: jumps = 0                 !! Jumps on the loading path, at fixed load
      real(wp) :: largest_jump = 0.0_wp    !! The largest of them [m]
      !> Where the path to the right jumps in its last leg, over the way to its end: (n)
      real(wp), allocatable :: jump(:)
      logical :: current = .false.   !! True if the blocks move
      integer :: decisions = 0       !! Number of decisions
      integer :: steps = 0           !! Steps of all decisions
      integer :: passes = 0          !! Passes of the open-close loop of all decisions
      integer :: factorisations = 0  !! Factorisations of all decisions and proposals
   end type critical_t

   !> A decided structure
   type :: decision_t
      type(outcome_t) :: outcome      !! Result of the run; its counts are those of all runs
      type(block_system_t) :: system  !! Blocks at the end
      type(contacts_t) :: contacts    !! Contacts at the end
      integer :: flow = 1             !! Flow rule of the run that gave them, one of flow_rule
      logical :: by_graph = .false.   !! True if the mechanism is that of the joint graph
      !> Decision of limit analysis for the full load, if there is one
      type(load_decision_t), allocatable :: limit
      !> True if outcome and contacts are those of the left half of a row, up to its plane of
      !> symmetry
      logical :: halved = .false.
      logical :: keystone = .false.  !! True if this plane runs through the last block
   end type decision_t

   !> Proofs of a case and their figures
   type :: proof_t
      !> N1, N2, T of each joint, then the forces of restrained points; unallocated without: (3, n)
      !> [N/m]
      real(wp), allocatable :: force(:, :)
      real(wp) :: force_at = 0.0_wp  !! Value of what is searched at which they carry the load
      !> Velocities of the blocks' centres and spins; unallocated without: (3, n_block)
      real(wp), allocatable :: velocity(:, :)
      !> Value of what is searched at which the loads begin to drive them
      real(wp) :: motion_at = 0.0_wp
      logical :: same_shape = .true.  !! True if the blocks have the same shape there
      !> Scene of the forces, and of the velocities where only loads are searched
      type(scene_t) :: scene
      !> Largest force or moment left on a block, over the largest load
      real(wp) :: imbalance = 0.0_wp
      !> Largest violation of the law of a joint by forces or velocities, relative
      real(wp) :: law_violation = 0.0_wp
      !> Power of the loads on the mechanism, or of the live load where that is searched, over what
      !> they could do at most
      real(wp) :: power = 0.0_wp
      !> Associated limit of the load factor of a single decision, from below and from above
      real(wp) :: limit(2) = 0.0_wp
      logical :: has_limit = .false.      !! True if there is one
      real(wp) :: thrust(2) = 0.0_wp      !! Least and greatest thrust of a joint: (2) [N/m]
      logical :: has_thrust(2) = .false.  !! True for those that exist
   end type proof_t

contains

   !> Count a decision and keep it on its side of the bracket; of one that is neither stable nor
   !> collapsed keep why
   pure subroutine keep_decision(critical, value, decision)
      type(critical_t), intent(inout) :: critical
      real(wp), intent(in) :: value  !! Where it was made
      type(decision_t), allocatable, intent(inout) :: decision

      associate (outcome => decision%outcome)
         critical%steps = critical%steps + outcome%steps
         critical%passes = critical%passes + outcome%passes
         critical%factorisations = critical%factorisations + outcome%factorisations
      end associate
      select case (decision%outcome%verdict)
      case (verdict%collapsed)
         critical%falls = value
         call move_alloc(decision, critical%fallen)
      case (verdict%stable)
         critical%stands = value
         call move_alloc(decision, critical%standing)
      case default
         if (allocated(decision%outcome%reason)) critical%reason = decision%outcome%reason
         critical%undecided_at = value
      end select
   end subroutine keep_decision

   !> Deallocate the parts of a kept decision that a search does not need: its springs, and its
   !> blocks without their bars, which the family rebuilds at any value, unless a path has moved
   !> them
   pure subroutine shed(decision, keeps_joints)
      type(decision_t), intent(inout) :: decision
      !> True if it keeps its joints: a load coefficient moves none
      logical, intent(in) :: keeps_joints
      type(bar_state_t), allocatable :: bar(:)

      if (keeps_joints) call place_all_joints(decision%system, decision%contacts)
      if (.not. keeps_joints) deallocate (decision%contacts%joint)
      decision%contacts%springs = joint_springs_t()
      if (.not. decision%outcome%has_path) then
         if (allocated(decision%system%bar)) allocate (bar, source=decision%system%bar)
         decision%system = block_system_t()
         if (allocated(bar)) call move_alloc(bar, decision%system%bar)
      end if
      if (decision%outcome%verdict == verdict%stable .and. allocated(decision%outcome%motion)) &
         & deallocate (decision%outcome%motion)
   end subroutine shed
end module dda_search
