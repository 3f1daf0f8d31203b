!> What the pictures of a case show, and the runs that are repeated for them
submodule (dda_compute_case) dda_case_pictures
   use dda_block_system, only : block_system_t
   use dda_contacts, only : contacts_t
   use dda_deck, only : source_of
   use dda_forward, only : run_to_verdict
   use dda_key_names, only : analysis_duration, analysis_steps, arch_radius, output_energy
   use dda_load_clock, only : has_path, load_clock_t, new_load_clock
   use dda_settings, only : settings_t
   use dda_verdict, only : outcome_t
   implicit none

contains

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

   !> Let the pictures of a static run lie evenly on the way of a collapse
   module procedure plan_fall
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
   end procedure plan_fall

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

end submodule dda_case_pictures
