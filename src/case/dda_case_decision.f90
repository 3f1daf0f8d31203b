!> Decision of a case: as a chain, by stages, or from a restart; and its frames
submodule (dda_compute_case) dda_case_decision
   use dda_chain_decision, only : decide_chain, show_first_motion
   use dda_decision, only : decide, decide_in_stages, enter_stage
   use dda_deck, only : source_of
   use dda_deck_scene, only : deck_scene
   use dda_forward, only : run_to_verdict
   use dda_key_names, only : analysis_duration, analysis_restart, analysis_steps, arch_radius, &
      & output_energy, output_reactions
   use dda_load_clock, only : has_path, load_clock_t, new_load_clock
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : link_once
   use dda_verdict, only : outcome_t
   implicit none

contains

   !> Decide the scene
   module procedure compute_decision
      type(decision_t) :: proof
      type(scene_t) :: begun
      real(wp) :: last
      logical :: decided, complete

      complete = .false.
      decided = this%family%chains &
         & .and. .not. this%family%chain_settings%collapse_displacement > 0.0_wp
      associate (critical => this%critical)
         if (decided) call link_once(this%family, &
            & this%family%deck%value(arch_thickness_ratio)%number, critical%link)
         if (decided) decided = critical%link%known
         if (decided) call decide_chain(this%family%chain_settings, critical%link%chain, &
            & this%decision, decided, critical%deficit)
      end associate
      if (decided) then
         ! a collapse is complete with its first motion, unless a growing load determines it.
         ! A chain that stands has no displacements, which tables need
         complete = this%decision%outcome%verdict /= verdict%collapsed
         if (.not. complete .and. this%plan%halved) call show_first_motion( &
            & this%critical%link%chain, this%critical%deficit, this%decision, complete)
         if (complete .and. this%family%decides_chains .and. .not. this%writes_tables) return
         proof = this%decision
         call unfold(proof)
      end if
      if (.not. allocated(this%scene%contacts%joint)) &
         & call deck_scene(this%family%deck, this%scene)
      if (complete .and. proof%outcome%verdict == verdict%collapsed) then
         this%decision%system = this%scene%system
         return
      end if
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
         else if (decided .and. proof%outcome%verdict == verdict%stable) then
            call decide(scene, this%decision, this%album, this%onward, stands=proof%limit)
         else
            call decide_in_stages(scene, this%decision, this%album, this%onward, last)
         end if
         if (allocated(boundary%change)) &
            & call enter_stage(scene%settings, last, scene%system, scene%contacts)
      end associate
      ! the chain decides; the decision of all blocks, if it agrees, has their motion
      if (.not. decided) return
      if (this%decision%outcome%verdict == proof%outcome%verdict) return
      this%decision = proof
      if (proof%outcome%verdict == verdict%stable) this%decision%system = this%scene%system
   end procedure compute_decision

   !> Plan the pictures of the case
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

   !> Repeat the run nearest to critical that a search has found to fall
   module procedure take_pictures
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
