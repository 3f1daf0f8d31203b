!> Computing a case: searched or decided, as a chain, stage by stage, or from where an earlier run
!> has ended; proven; with the scene that its tables need, and the runs repeated for its pictures
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness, joint_angles_deg
   use dda_case, only : case_t
   use dda_case_proof, only : prove_case
   use dda_chain, only : chain_t
   use dda_chain_decision, only : decide_chain, unfold
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_critical, only : find_critical
   use dda_decision, only : decide_in_stages, enter_stage
   use dda_deck, only : source_of
   use dda_deck_scene, only : deck_scene
   use dda_forward, only : run_to_verdict
   use dda_key_names, only : analysis_duration, analysis_restart, analysis_steps, arch_radius, &
      & arch_thickness_ratio, output_energy, output_frames, output_joints, output_reactions, &
      & vehicle_worst
   use dda_kinds, only : wp
   use dda_limerick_decision, only : decide_limerick, search_limerick
   use dda_load_clock, only : has_path, load_clock_t, new_load_clock
   use dda_mechanism, only : follow_collapse
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : build_once, move_scene, scene_t, searched_load
   use dda_search, only : decision_t
   use dda_settings, only : settings_t
   use dda_verdict, only : outcome_t, verdict
   use dda_worst_position, only : place_vehicle
   implicit none
   private

   public :: compute_case

contains

   !> Compute a case
   subroutine compute_case(this)
      type(case_t), intent(inout) :: this
      integer(int64) :: start, finish, rate

      if (this%exact_known) call exact_thickness(this%family%deck, this%exact, this%exact_known)
      call system_clock(start, rate)
      call plan_album(this)
      if (this%family%chains) call arch_rays(this%family%numbers, this%family%rays)
      if (this%searches .and. this%limerick) then
         call search_limerick(this)
         call see_standing(this)
      else if (this%searches) then
         call search_critical(this)
      else if (this%limerick) then
         call deck_scene(this%family%deck, this%scene)
         call decide_limerick(this%family%deck, this%scene, this%decision, this%album)
      else
         call compute_decision(this)
         if (.not. allocated(this%error)) call see_collapse(this, &
            & this%family%deck%value(arch_thickness_ratio)%number, this%decision)
      end if
      call system_clock(finish)
      this%seconds = real(finish - start, wp)/real(rate, wp)
      if (this%proves .and. .not. (this%limerick .or. this%plan%velocities &
         & .or. allocated(this%error))) call prove_case(this)
      call place_joints(this)
   end subroutine compute_case

   !> Search the critical value, and see the scenes on its two sides that tables and pictures need
   pure subroutine search_critical(this)
      type(case_t), intent(inout) :: this

      if (this%family%deck%value(vehicle_worst)%flag) call place_vehicle(this)
      call find_critical(this%family, this%search, this%critical)
      if (allocated(this%critical%scene)) call move_scene(this%critical%scene, this%scene)
      if (allocated(this%critical%fallen)) &
         & call see_collapse(this, this%critical%falls, this%critical%fallen)
      call see_standing(this)
      if (nint(this%family%deck%value(output_frames)%number) > 0) call take_pictures(this)
   end subroutine search_critical

   !> Make the scene that stands, where none was found to fall
   pure subroutine see_standing(this)
      type(case_t), intent(inout) :: this

      if (this%family%decides_chains .or. allocated(this%critical%fallen) &
         & .or. .not. allocated(this%critical%standing)) return
      call build_once(this%family, this%critical%stands, this%scene)
      this%standing = this%scene
   end subroutine see_standing

   !> Decide the scene: as a chain if it needs no more, else from its beginning or from where an
   !> earlier run has ended
   subroutine compute_decision(this)
      type(case_t), intent(inout) :: this
      type(settings_t) :: settings
      type(chain_t) :: chain
      type(scene_t) :: begun
      real(wp) :: last
      logical :: decided

      ! tables tell displacements, which a chain does not keep
      decided = this%family%decides_chains .and. .not. this%tells_tables
      if (decided) call this%family%link(this%family%deck%value(arch_thickness_ratio)%number, &
         & settings, chain, decided)
      if (decided) call decide_chain(settings, chain, this%decision, decided)
      ! a chain proves that it falls; how it does is told by all of its blocks
      if (decided) decided = this%decision%outcome%verdict /= verdict%collapsed
      if (decided) return
      call deck_scene(this%family%deck, this%scene)
      call plan_fall(this)
      associate (scene => this%scene, boundary => this%scene%settings%boundary)
         if (scene%settings%dynamic .and. this%family%deck%value(output_reactions)%flag) &
            & this%album%support = supports_of(scene%system, boundary)
         if (this%family%deck%value(analysis_restart)%given) then
            begun = scene
            call load_restart(this%restart_file, begun%settings, begun%system, begun%contacts, &
               & this%onward, this%error)
            if (allocated(this%error)) return
            call decide_in_stages(begun, this%decision, this%album, this%onward, last)
         else
            call decide_in_stages(scene, this%decision, this%album, this%onward, last)
         end if
         if (allocated(boundary%change)) &
            & call enter_stage(scene%settings, last, scene%system, scene%contacts)
      end associate
   end subroutine compute_decision

   !> Make the scene of a decision where a chain has done without it and it is wanted now: for
   !> tables of joints, for pictures, or to follow a sliding collapse
   pure subroutine see_collapse(this, value, decision)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: value  !! Value of the parameter that was decided
      type(decision_t), intent(inout) :: decision
      logical :: collapsed, wanted

      if (this%family%decides_chains) this%scene%joint_angle_deg = &
         & joint_angles_deg(this%family%deck)
      collapsed = decision%outcome%verdict == verdict%collapsed
      wanted = merge(this%tells_tables .or. nint(this%family%deck%value(output_frames)%number) &
         & > 0, this%searches, this%family%decides_chains)
      if (wanted .or. collapsed) call unfold(decision)
      if (collapsed) wanted = wanted .or. any(decision%contacts%face%slip /= 0)
      if (wanted) call build_once(this%family, value, this%scene)
      if (collapsed) call follow_collapse(this%scene, decision, this%album)
   end subroutine see_collapse

   !> Give what was decided the joints of its scene where it has none; the scene may lose them
   pure subroutine place_joints(this)
      type(case_t), intent(inout) :: this

      if (allocated(this%critical%standing)) call place_standing(this, &
         & this%critical%standing%contacts)
      if (this%limerick .or. allocated(this%error)) return
      if (.not. this%searches) then
         call take_joints(this%scene, this%decision%contacts)
      else if (allocated(this%critical%fallen)) then
         call take_joints(this%scene, this%critical%fallen%contacts)
      end if
   end subroutine place_joints

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
   pure subroutine plan_album(this)
      type(case_t), intent(inout) :: this
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
   end subroutine plan_album

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

   !> Repeat the run nearest to critical that a search has found to fall, else to stand, for its
   !> pictures
   pure subroutine take_pictures(this)
      type(case_t), intent(inout) :: this
      type(outcome_t) :: outcome
      type(scene_t) :: begun
      integer :: flow

      if (allocated(this%critical%fallen)) then
         call build_once(this%family, this%critical%falls, this%scene)
         flow = this%critical%fallen%flow
      else if (allocated(this%critical%standing)) then
         call build_once(this%family, this%critical%stands, this%scene)
         flow = this%critical%standing%flow
      else
         return
      end if
      call plan_fall(this)
      begun = this%scene
      begun%settings%flow = flow
      call run_to_verdict(begun%settings, begun%system, begun%contacts, outcome, this%album)
   end subroutine take_pictures

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
end module dda_compute_case
