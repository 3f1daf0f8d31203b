!> Computing a case: searched or decided, proven, with what its tables and pictures need
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t
   use dda_case_proof, only : prove_decision, prove_search
   use dda_chain, only : chain_t
   use dda_chain_decision, only : decide_chain
   use dda_chain_unfold, only : unfold
   use dda_contact_detection, only : contacts_t
   use dda_critical, only : find_critical
   use dda_decision, only : decide_in_stages
   use dda_deck, only : deck_t, parameter_t, scene_kind
   use dda_deck_keys, only : key_index
   use dda_deck_scene, only : deck_family_t, deck_scene
   use dda_deck_set, only : put_number
   use dda_error, only : error_t
   use dda_forward, only : outcome_t, run_to_verdict
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_limerick_decision, only : decide_limerick
   use dda_load_clock, only : has_path, load_clock_t, new_load_clock
   use dda_mechanism, only : follow_collapse
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : build_once, scene_t
   use dda_search, only : critical_t, decision_t, search_t
   use dda_settings, only : settings_t
   use dda_verdict, only : verdict
   implicit none
   private

   public :: compute_case

   !> The thrust of an arch of more joints than this is reported only where it is asked for
   integer, parameter :: most_thrust_joints = 2001

   interface

      !> Search the critical value
      pure module subroutine find_limerick_critical(family, search, critical)
         type(deck_family_t), intent(in) :: family
         !> What is searched; where the far end needs no check, the search strides out from the
         !> start
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical
      end subroutine find_limerick_critical

      !> Pictures of the run nearest to critical that was found to fall, else to stand
      pure module subroutine repeat_with_pictures(family, critical, album)
         type(deck_family_t), intent(in) :: family
         type(critical_t), intent(in) :: critical
         type(album_t), intent(inout) :: album
      end subroutine repeat_with_pictures

      !> Find the worst position
      pure module subroutine find_worst_position(deck, scene, position, found)
         type(deck_t), intent(in) :: deck
         type(scene_t), intent(in) :: scene
         !> The position of the first axle [m]
         real(wp), intent(out) :: position
         !> Whether any position is bounded
         logical, intent(out) :: found
      end subroutine find_worst_position

   end interface

contains

   !> Compute a case
   subroutine compute_case(this)
      type(case_t), intent(inout) :: this
      type(error_t), allocatable :: error
      integer(int64) :: start, finish, rate

      if (this%exact_known) call exact_thickness(this%family%deck, this%exact, this%exact_known)
      call system_clock(start, rate)
      call plan_album(this)
      if (this%family%chains) call arch_rays(this%family%numbers, this%family%rays)
      if (this%searches .and. this%limerick) then
         ! the limit of this scheme lies somewhat above the exact value
         if (this%exact_known .and. .not. this%search%check_far_end) &
            & this%search%start = min(max(this%exact, this%search%low), this%search%high)
         call find_limerick_critical(this%family, this%search, this%critical)
         if (allocated(this%critical%fallen)) &
            & call this%family%build(this%critical%falls, this%scene, error)
      else if (this%searches) then
         if (this%family%deck%vehicle%worst%flag) call place_vehicle(this)
         call find_critical(this%family, this%search, this%critical)
         if (allocated(this%critical%fallen)) &
            & call see_collapse(this, this%critical%falls, this%critical%fallen)
      else if (this%limerick) then
         call deck_scene(this%family%deck, this%plan, this%scene)
         call decide_limerick(this%family%deck, this%scene, this%decision, this%album)
      else
         call compute_decision(this)
         if (.not. allocated(this%error)) call see_collapse(this, &
            & this%family%deck%arch%thickness_ratio%number, this%decision)
      end if
      if (this%searches .and. .not. this%family%decides_chains &
         & .and. .not. allocated(this%critical%fallen) .and. allocated(this%critical%standing)) then
         call build_once(this%family, this%critical%stands, this%standing)
         this%scene = this%standing
      end if
      if (this%family%deck%output%joints%flag .and. this%searches) call place_joints(this)
      if (this%searches .and. this%family%deck%output%frames%whole > 0) then
         if (this%limerick) call repeat_with_pictures(this%family, this%critical, this%album)
         if (.not. this%limerick) call take_pictures(this)
      end if
      call system_clock(finish)
      this%seconds = real(finish - start, wp)/real(rate, wp)
      if (this%proves .and. .not. (this%limerick .or. this%plan%velocities &
         & .or. allocated(this%error))) call prove_case(this)
   end subroutine compute_case

   !> Put the vehicle where the least load factor is carried
   pure subroutine place_vehicle(this)
      type(case_t), intent(inout) :: this
      type(scene_t) :: scene
      type(error_t), allocatable :: error
      type(parameter_t) :: position
      real(wp) :: value

      position%key = key_index("vehicle", "position")
      call deck_scene(this%family%deck, this%plan, scene)
      call find_worst_position(this%family%deck, scene, value, this%has_worst)
      if (.not. this%has_worst) return
      associate (deck => this%family%deck)
         call put_number(deck, position, value, deck%value(position%key)%place, error)
      end associate
   end subroutine place_vehicle

   !> Prove the verdict of a case by limit analysis
   pure subroutine prove_case(this)
      type(case_t), intent(inout) :: this
      integer :: joint

      if (this%searches) then
         call prove_search(this%family, this%critical, this%standing, this%scene, this%proof)
      else if (allocated(this%scene%contacts%joint)) then
         joint = this%family%deck%output%thrust_joint%whole
         if (joint == 0 .and. size(this%scene%joint_angle_deg) > 0 &
            & .and. size(this%scene%joint_angle_deg) <= most_thrust_joints) &
            & joint = minloc(abs(this%scene%joint_angle_deg), dim=1)
         joint = merge(joint, this%scene%crown_joint, joint > 0)
         call prove_decision(this%scene, this%decision, joint, &
            & this%family%deck%output%thrust_bar%whole, this%proof)
      end if
   end subroutine prove_case

   !> Decide the scene: as a chain if it needs no more, else from its beginning or from where an
   !> earlier run has ended
   subroutine compute_decision(this)
      type(case_t), intent(inout) :: this
      type(block_system_t) :: system
      type(contacts_t) :: contacts
      type(settings_t) :: settings
      type(chain_t) :: chain
      logical :: decided

      ! tables tell displacements, which a chain does not keep
      decided = this%family%decides_chains .and. .not. this%tells_tables
      if (decided) call this%family%link(this%family%deck%arch%thickness_ratio%number, &
         & settings, chain, decided)
      if (decided) call decide_chain(settings, chain, this%decision, decided)
      ! a chain proves that it falls; how it does is told by all of its blocks
      if (decided) decided = this%decision%outcome%verdict /= verdict%collapsed
      if (decided) return
      call deck_scene(this%family%deck, this%plan, this%scene)
      call plan_fall(this)
      if (this%family%deck%analysis%restart%given) then
         system = this%scene%system
         contacts = this%scene%contacts
         call load_restart(this%restart_file, this%scene%settings, system, contacts, this%onward, &
            & this%error)
         if (allocated(this%error)) return
         call keep_supports(this, system)
         call decide_in_stages(this%scene, this%decision, this%album, this%onward, system, contacts)
      else
         call keep_supports(this, this%scene%system)
         call decide_in_stages(this%scene, this%decision, this%album, this%onward)
      end if
   end subroutine compute_decision

   !> Supports whose reactions a dynamic run tells
   pure subroutine keep_supports(this, system)
      type(case_t), intent(inout) :: this
      type(block_system_t), intent(in) :: system

      if (this%scene%settings%dynamic .and. this%family%deck%output%reactions%flag) &
         & this%album%support = supports_of(system, this%scene%settings%boundary)
   end subroutine keep_supports

   !> Make the scene of a decision where a chain has done without it and it is wanted now: for
   !> tables of joints, for pictures, or to follow a sliding collapse
   pure subroutine see_collapse(this, value, decision)
      type(case_t), intent(inout) :: this
      !> Value of the parameter that was decided
      real(wp), intent(in) :: value
      type(decision_t), intent(inout) :: decision
      logical :: collapsed, wanted

      if (this%family%decides_chains) this%scene%joint_angle_deg = this%family%joint_angle_deg
      collapsed = decision%outcome%verdict == verdict%collapsed
      wanted = merge(this%tells_tables .or. this%family%deck%output%frames%whole > 0, &
         & this%searches, this%family%decides_chains)
      if (wanted .or. collapsed) call unfold(decision)
      if (collapsed) wanted = wanted .or. any(decision%contacts%face%slip /= 0)
      if (wanted) call build_once(this%family, value, this%scene)
      if (collapsed) call follow_collapse(this%scene, decision, this%album)
      if (allocated(this%scene%contacts%joint) .and. .not. allocated(decision%contacts%joint)) &
         & decision%contacts%joint = this%scene%contacts%joint
   end subroutine see_collapse

   !> What the album of the case is to hold
   pure subroutine plan_album(this)
      type(case_t), intent(inout) :: this
      integer :: frames

      frames = this%family%deck%output%frames%whole
      allocate (this%album%point(0))
      if (frames > 0 .and. this%plan%velocities) &
         & this%album%interval = this%family%deck%analysis%duration%number/real(frames, wp)
      if (frames > 0 .and. this%plan%velocities .and. .not. this%album%interval > 0.0_wp) &
         & this%album%every = max(1, this%family%deck%analysis%steps%whole/frames)
      if (this%searches) return
      this%album%audit%wanted = this%plan%velocities .and. this%family%deck%output%energy%flag
      if (allocated(this%family%deck%plan%boundary%measured)) &
         & this%album%point = this%family%deck%plan%boundary%measured
   end subroutine plan_album

   !> Give the assembly nearest to critical that was found to stand its joints: a chain has none
   pure subroutine place_joints(this)
      type(case_t), intent(inout) :: this

      if (.not. allocated(this%critical%standing)) return
      associate (contacts => this%critical%standing%contacts)
         if (allocated(contacts%joint)) return
         call build_once(this%family, this%critical%stands, this%standing)
         contacts%joint = this%standing%contacts%joint
      end associate
   end subroutine place_joints

   !> Let the pictures of a static run lie evenly on the way of a collapse, until a corner has moved
   !> a tenth of the radius, or of the size of the blocks; or on the path of its histories
   pure subroutine plan_fall(this)
      type(case_t), intent(inout) :: this
      type(load_clock_t) :: clock
      integer :: frames

      frames = this%family%deck%output%frames%whole
      if (frames == 0 .or. this%scene%settings%dynamic) return
      this%album%follow = this%scene%settings%collapse_displacement
      if (.not. this%album%follow > 0.0_wp) this%album%follow = 0.1_wp*scene_size(this)
      this%album%spacing = this%album%follow/real(frames, wp)
      clock = new_load_clock(this%scene%settings)
      if (.not. has_path(clock)) return
      this%album%spacing = scene_size(this)/real(frames, wp)
      this%album%begin = clock%bend(1)
      this%album%interval = (clock%bend(size(clock%bend)) - clock%bend(1))/real(frames, wp)
   end subroutine plan_fall

   !> Repeat the run nearest to critical that a search has found to fall, else to stand, for its
   !> pictures
   pure subroutine take_pictures(this)
      type(case_t), intent(inout) :: this
      type(outcome_t) :: outcome
      type(settings_t) :: settings
      type(block_system_t) :: system
      type(contacts_t) :: contacts
      integer :: flow

      if (allocated(this%critical%fallen)) then
         call build_once(this%family, this%critical%falls, this%scene)
         flow = this%critical%fallen%flow
      else if (allocated(this%critical%standing)) then
         call build_once(this%family, this%critical%stands, this%standing)
         this%scene = this%standing
         flow = this%critical%standing%flow
      else
         return
      end if
      settings = this%scene%settings
      settings%flow = flow
      call plan_fall(this)
      system = this%scene%system
      contacts = this%scene%contacts
      call run_to_verdict(settings, system, contacts, outcome, this%album)
   end subroutine take_pictures

   !> Radius of an arch, half size of what was cut, or mean size of the blocks that move [m]
   pure real(wp) function scene_size(this)
      type(case_t), intent(in) :: this

      associate (system => this%scene%system)
         scene_size = sqrt(sum(system%area, mask=system%equation > 0) &
            & /real(max(1, count(system%equation > 0)), wp))
      end associate
      associate (deck => this%family%deck)
         if (scene_kind(deck) == "arch") scene_size = deck%arch%radius%number
         if (allocated(deck%cut)) scene_size = deck%cut%scale%size
      end associate
   end function scene_size
end module dda_compute_case
