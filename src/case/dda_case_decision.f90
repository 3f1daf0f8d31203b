!> The decision of a case: as a chain, stage by stage, or from where an earlier run has ended; and
!> the scene that its tables and pictures need. What the pictures show, and the runs that are
!> repeated for them
submodule (dda_compute_case) dda_case_decision
   use dda_block_system, only : block_system_t
   use dda_chain, only : chain_t
   use dda_chain_decision, only : decide_chain, unfold
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_decision, only : decide_in_stages
   use dda_deck, only : source_of
   use dda_forward, only : run_to_verdict
   use dda_key_names, only : analysis_duration, analysis_restart, analysis_steps, arch_radius, &
      & output_energy, output_joints, output_reactions
   use dda_load_clock, only : has_path, load_clock_t, new_load_clock
   use dda_mechanism, only : follow_collapse
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : move_scene, searched_load
   use dda_settings, only : settings_t
   use dda_verdict, only : outcome_t, verdict
   implicit none

contains

   !> Decide the scene
   module procedure compute_decision
      type(block_system_t) :: system
      type(contacts_t) :: contacts
      type(settings_t) :: settings
      type(chain_t) :: chain
      logical :: decided

      ! tables tell displacements, which a chain does not keep
      decided = this%family%decides_chains .and. .not. this%tells_tables
      if (decided) call this%family%link(this%family%deck%value(arch_thickness_ratio)%number, &
         & settings, chain, decided)
      if (decided) call decide_chain(settings, chain, this%decision, decided)
      ! a chain proves that it falls; how it does is told by all of its blocks
      if (decided) decided = this%decision%outcome%verdict /= verdict%collapsed
      if (decided) return
      call deck_scene(this%family%deck, this%plan, this%scene)
      call plan_fall(this)
      if (this%family%deck%value(analysis_restart)%given) then
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
   end procedure compute_decision

   !> Supports whose reactions a dynamic run tells
   pure subroutine keep_supports(this, system)
      type(case_t), intent(inout) :: this
      type(block_system_t), intent(in) :: system

      if (this%scene%settings%dynamic .and. this%family%deck%value(output_reactions)%flag) &
         & this%album%support = supports_of(system, this%scene%settings%boundary)
   end subroutine keep_supports

   !> Make the scene of a decision where a chain has done without it and it is wanted now
   module procedure see_collapse
      logical :: collapsed, wanted

      if (this%family%decides_chains) this%scene%joint_angle_deg = this%family%joint_angle_deg
      collapsed = decision%outcome%verdict == verdict%collapsed
      wanted = merge(this%tells_tables .or. nint(this%family%deck%value(output_frames)%number) &
         & > 0, this%searches, this%family%decides_chains)
      if (wanted .or. collapsed) call unfold(decision)
      if (collapsed) wanted = wanted .or. any(decision%contacts%face%slip /= 0)
      if (wanted .and. allocated(this%critical%scene)) &
         & call move_scene(this%critical%scene, this%scene)
      if (wanted) call build_once(this%family, value, this%scene)
      if (collapsed) call follow_collapse(this%scene, decision, this%album)
   end procedure see_collapse

   !> Give what was decided the joints of its scene where it has none
   module procedure place_joints
      if (allocated(this%critical%standing)) call place_standing(this, &
         & this%critical%standing%contacts)
      if (this%limerick .or. allocated(this%error)) return
      if (.not. this%searches) then
         call take_joints(this%scene, this%decision%contacts)
      else if (allocated(this%critical%fallen)) then
         call take_joints(this%scene, this%critical%fallen%contacts)
      end if
   end procedure place_joints

   !> Give the assembly nearest to critical that was found to stand its joints: a load coefficient
   !> moves none
   pure subroutine place_standing(this, contacts)
      type(case_t), intent(inout) :: this
      type(contacts_t), intent(inout) :: contacts  !! Those of the assembly

      if (allocated(contacts%joint)) return
      if (this%family%load /= searched_load%none) call take_joints(this%scene, contacts)
      if (allocated(contacts%joint) .or. .not. this%family%deck%value(output_joints)%flag) return
      call build_once(this%family, this%critical%stands, this%standing)
      associate (begun => this%standing%contacts)
         call place_all_joints(this%standing%system, begun)
         allocate (contacts%joint, source=begun%joint)
         if (.not. allocated(contacts%place)) allocate (contacts%place, source=begun%place)
      end associate
   end subroutine place_standing

   !> Take the joints of a scene that needs them no more, and where they are
   pure subroutine take_joints(from, to)
      type(scene_t), intent(inout) :: from
      type(contacts_t), intent(inout) :: to

      if (allocated(to%joint) .or. .not. allocated(from%contacts%joint)) return
      call place_all_joints(from%system, from%contacts)
      call move_alloc(from%contacts%joint, to%joint)
      if (.not. allocated(to%place)) call move_alloc(from%contacts%place, to%place)
   end subroutine take_joints

   !> What the album of the case is to hold
   module procedure plan_album
      integer :: frames

      frames = nint(this%family%deck%value(output_frames)%number)
      allocate (this%album%point(0))
      if (frames > 0 .and. this%plan%velocities) &
         & this%album%interval = this%family%deck%value(analysis_duration)%number/real(frames, wp)
      if (frames > 0 .and. this%plan%velocities .and. .not. this%album%interval > 0.0_wp) &
         & this%album%every = max(1, nint(this%family%deck%value(analysis_steps)%number)/frames)
      if (this%searches) return
      this%album%audit%wanted = this%plan%velocities &
         & .and. this%family%deck%value(output_energy)%flag
      if (allocated(this%family%deck%plan%boundary%measured)) &
         & this%album%point = this%family%deck%plan%boundary%measured
   end procedure plan_album

   !> Let the pictures of a static run lie evenly on the way of a collapse, until a corner has moved
   !> a tenth of the radius, or of the size of the blocks; or on the path of its histories
   pure subroutine plan_fall(this)
      type(case_t), intent(inout) :: this
      type(load_clock_t) :: clock
      integer :: frames

      frames = nint(this%family%deck%value(output_frames)%number)
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

   !> Repeat the run nearest to critical that a search has found to fall, else to stand
   module procedure take_pictures
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
   end procedure take_pictures

   !> Radius of an arch, half size of what was cut, or mean size of the blocks that move [m]
   pure real(wp) function scene_size(this)
      type(case_t), intent(in) :: this

      associate (system => this%scene%system)
         scene_size = sqrt(sum(system%area, mask=system%equation > 0) &
            & /real(max(1, count(system%equation > 0)), wp))
      end associate
      associate (deck => this%family%deck)
         if (source_of(deck) == "arch") scene_size = deck%value(arch_radius)%number
         if (allocated(deck%cut)) scene_size = deck%cut%scale%size
      end associate
   end function scene_size

end submodule dda_case_decision
