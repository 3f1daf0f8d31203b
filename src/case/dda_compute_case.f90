!> Computation of a case: search or decision, certificate, and scenes of its tables
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness, joint_angles_deg
   use dda_case, only : case_t
   use dda_chain_decision, only : unfold
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_critical, only : find_critical
   use dda_interior_state, only : no_limit
   use dda_joint_graph, only : joint_graph_t
   use dda_key_names, only : arch_thickness_ratio, output_frames, output_joints, vehicle_worst
   use dda_kinds, only : wp
   use dda_mechanism, only : follow_collapse
   use dda_scene, only : build_once, move_scene, scene_t, searched_load
   use dda_search, only : decision_t
   use dda_settings, only : verdict
   implicit none
   private

   public :: compute_case, least_factor_t, load_arc_t, seek_least_factor

   !> Live loads that are quadratic in the share of the way from one place to another
   type :: load_arc_t
      !> The two places [m]
      real(wp) :: from = 0.0_wp, to = 0.0_wp
      !> Blocks with a load, by their numbers in the graph: (n)
      integer, allocatable :: block(:)
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
   end type least_factor_t

   interface

      !> Decide the scene: as a chain if it needs no more, else from its beginning or from where an
      !> earlier run has ended
      module subroutine compute_decision(this)
         type(case_t), intent(inout) :: this
      end subroutine compute_decision

      !> Plan the pictures of the case
      pure module subroutine plan_album(this)
         type(case_t), intent(inout) :: this
      end subroutine plan_album

      !> Repeat the run nearest to critical that a search has found to fall, else to stand, for its
      !> pictures
      pure module subroutine take_pictures(this)
         type(case_t), intent(inout) :: this
      end subroutine take_pictures

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
      pure module subroutine place_vehicle(this)
         type(case_t), intent(inout) :: this
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
      integer(int64) :: start, finish, rate

      if (this%exact_known) call exact_thickness(this%family%deck, this%exact, this%exact_known)
      call system_clock(start, rate)
      call plan_album(this)
      if (this%searches) then
         ! the scene of one value is none of another
         allocate (this%critical%scene)
         call move_scene(this%scene, this%critical%scene)
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

      if (this%family%deck%value(vehicle_worst)%flag) call place_vehicle(this)
      call find_critical(this%family, this%search, this%critical)
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
end module dda_compute_case
