!> Computation of a case: search or decision, certificate, and scenes of its tables
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness, joint_angles_deg
   use dda_case, only : case_t
   use dda_chain_decision, only : decide_chain, show_first_motion, unfold
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_critical, only : find_critical
   use dda_decision, only : decide
   use dda_deck, only : source_of
   use dda_deck_scene, only : deck_scene
   use dda_forward, only : run_to_verdict
   use dda_interior_state, only : no_limit
   use dda_joint_graph, only : joint_graph_t
   use dda_key_names, only : analysis_duration, analysis_restart, analysis_steps, arch_radius, &
      & arch_thickness_ratio, output_energy, output_frames, output_joints, output_reactions, &
      & vehicle_worst
   use dda_kinds, only : wp
   use dda_load_clock, only : follows_path => has_path, load_clock_t, new_load_clock
   use dda_mechanism, only : follow_collapse
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : build_once, link_once, move_scene, scene_t, searched_load
   use dda_search, only : critical_t, decision_t
   use dda_settings, only : verdict
   use dda_stages, only : decide_in_stages, enter_stage
   use dda_verdict, only : outcome_t
   implicit none
   private

   public :: compute_case, least_factor_t, load_arc_t, seek_least_factor

   !> Live loads that are quadratic in the share of the way from one place to another
   type :: load_arc_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp  !! The two places [m]
      integer, allocatable :: block(:)  !! Blocks with a load, by their numbers in the graph: (n)
      !> Loads at the beginning, half way and at the end: (3, n, 3) [N/m, N/m, N]
      real(wp), allocatable :: load(:, :, :)
   end type load_arc_t

   !> The least factor found, and where
   type :: least_factor_t
      real(wp) :: factor = no_limit  !! The factor
      real(wp) :: place = 0.0_wp     !! The place [m]
      logical :: backward = .false.  !! True if the vehicle drives the other way there
      !> True if the loading path there has an end; else the factor is how far it came
      logical :: decided = .true.
      !> True if no load is left whose limit may be less and was not found
      logical :: is_known = .true.
      !> Jump of its inverse between two positions that are all but one: the larger inverse plus the
      !> jump, where that is [m], and the smaller and the larger factor; of a path that was not
      !> followed to its end, how far that came
      real(wp) :: jump = 0.0_wp, jump_place = 0.0_wp, jump_factor(2) = no_limit
      logical :: jump_backward = .false.  !! True if the vehicle drives the other way there
      !> Result of the search there, with its associated limit; unallocated without that
      type(critical_t), allocatable :: critical
   end type least_factor_t

   !> The path of a position
   type :: trial_t
      real(wp) :: place = 0.0_wp  !! The position [m]
      !> Inverse of the factor of the first collapse, or of how far the path was followed
      real(wp) :: inverse = 0.0_wp
      !> Inverse of the factor of its first jump, or of its end where it has none
      real(wp) :: jump = 0.0_wp
      logical :: falls = .false.  !! True if it ends by a collapse
   end type trial_t

   interface

      !> Prove the verdict of a case by limit analysis
      pure module subroutine prove_case(this)
         type(case_t), intent(inout) :: this
      end subroutine prove_case

      !> Decide the scene under Shi's scheme
      pure module subroutine decide_limerick(this)
         type(case_t), intent(inout) :: this
      end subroutine decide_limerick

      !> Search the critical value of Shi's scheme, with pictures of the run nearest to it that was
      !> found to fall, else to stand
      pure module subroutine search_limerick(this)
         type(case_t), intent(inout) :: this
      end subroutine search_limerick

      !> Put the vehicle where the least load factor is carried
      pure module subroutine place_vehicle(this, found)
         type(case_t), intent(inout) :: this
         logical, intent(out) :: found  !! True if its search has been done on the way
      end subroutine place_vehicle

      !> Seek the least factor of the loads of all arcs: none where the dead load falls by itself
      pure module subroutine seek_least_factor(graph, dead, arc, stands, near, least)
         type(joint_graph_t), intent(in) :: graph
         !> Loads at a factor of zero: (3, n_block) [N/m, N/m, N]
         real(wp), intent(in) :: dead(:, :)
         type(load_arc_t), intent(in) :: arc(:)  !! The live loads: (n)
         logical, intent(in) :: stands           !! True if the dead load is known to stand
         real(wp), intent(in) :: near            !! Tolerance of the place [m]
         !> The least factor so far in, with these arcs out
         type(least_factor_t), intent(inout) :: least
      end subroutine seek_least_factor

   end interface

contains

   !> Compute a case
   subroutine compute_case(this)
      type(case_t), intent(inout) :: this
      type(scene_t) :: no_scene
      integer(int64) :: start, finish, rate

      if (this%exact_known) call exact_thickness(this%family%deck, this%exact, this%exact_known)
      call system_clock(start, rate)
      call plan_album(this)
      if (this%searches) then
         ! a load changes no blocks; the scene of any other value is none of another
         if (this%family%load /= searched_load%none) then
            allocate (this%critical%scene)
            call move_scene(this%scene, this%critical%scene)
         end if
         this%scene = no_scene
      end if
      if (this%family%chains) call arch_rays(this%family%numbers, this%family%rays)
      if (this%searches .and. this%limerick) then
         call search_limerick(this)
         call see_standing(this)
      else if (this%searches) then
         call search_critical(this)
      else if (this%limerick) then
         call decide_limerick(this)
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
      logical :: found

      found = .false.
      if (this%family%deck%value(vehicle_worst)%flag) call place_vehicle(this, found)
      if (.not. found) call find_critical(this%family, this%search, this%critical)
      if (this%misses_worst .and. this%critical%verdict /= verdict%undecided) then
         this%critical%verdict = verdict%undecided
         this%critical%undecided_at = this%critical%stop
         this%critical%reason = "the least load factor of all positions is not found"
         ! bounds at this position are none of the least factor
         this%critical%limit%known = .false.
      end if
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

   !> Make the scene of a decision that a chain has made without it, if it is needed: for tables of
   !> joints, for pictures, or to follow a sliding collapse
   pure subroutine see_collapse(this, value, decision)
      type(case_t), intent(inout) :: this
      real(wp), intent(in) :: value  !! Value of the parameter that was decided
      type(decision_t), intent(inout) :: decision
      logical :: collapsed, wanted

      if (this%family%decides_chains) this%scene%joint_angle_deg = &
         & joint_angles_deg(this%family%deck)
      collapsed = decision%outcome%verdict == verdict%collapsed
      wanted = merge(this%writes_tables .or. nint(this%family%deck%value(output_frames)%number) &
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

   !> Decide the scene: as a chain if it needs no more, else from its beginning or from where an
   !> earlier run has ended
   subroutine compute_decision(this)
      type(case_t), intent(inout) :: this
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
   end subroutine compute_decision

   !> Plan the pictures of the case
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
      if (.not. follows_path(clock)) return
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
