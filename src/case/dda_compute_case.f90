!> Computing a case: searched or decided, proven, with what its tables and pictures need
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness
   use dda_case, only : case_t
   use dda_critical, only : find_critical
   use dda_deck, only : deck_t
   use dda_deck_scene, only : deck_scene
   use dda_frames, only : album_t
   use dda_interior_state, only : no_limit
   use dda_joint_graph, only : joint_graph_t
   use dda_key_names, only : arch_thickness_ratio, output_frames, vehicle_worst
   use dda_kinds, only : wp
   use dda_scene, only : build_once, move_scene, scene_t
   use dda_search, only : decision_t
   implicit none
   private

   public :: compute_case, load_arc_t, least_factor_t, seek_least_factor

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
   end type least_factor_t

   interface

      !> Search the critical value of Shi's scheme, with pictures of the run nearest to it that was
      !> found to fall, else to stand
      pure module subroutine search_limerick(this)
         type(case_t), intent(inout) :: this
      end subroutine search_limerick

      !> What the album of the case is to hold
      pure module subroutine plan_album(this)
         type(case_t), intent(inout) :: this
      end subroutine plan_album

      !> Repeat the run nearest to critical that a search has found to fall, else to stand, for its
      !> pictures
      pure module subroutine take_pictures(this)
         type(case_t), intent(inout) :: this
      end subroutine take_pictures

      !> Put the vehicle where the least load factor is carried
      pure module subroutine place_vehicle(this)
         type(case_t), intent(inout) :: this
      end subroutine place_vehicle

      !> Decide the scene: as a chain if it needs no more, else from its beginning or from where an
      !> earlier run has ended
      module subroutine compute_decision(this)
         type(case_t), intent(inout) :: this
      end subroutine compute_decision

      !> Make the scene of a decision where a chain has done without it and it is wanted now: for
      !> tables of joints, for pictures, or to follow a sliding collapse
      pure module subroutine see_collapse(this, value, decision)
         type(case_t), intent(inout) :: this
         real(wp), intent(in) :: value  !! Value of the parameter that was decided
         type(decision_t), intent(inout) :: decision
      end subroutine see_collapse

      !> Give what was decided the joints of its scene where it has none; the scene may lose them
      pure module subroutine place_joints(this)
         type(case_t), intent(inout) :: this
      end subroutine place_joints

      !> Prove the verdict of a case by limit analysis
      pure module subroutine prove_case(this)
         type(case_t), intent(inout) :: this
      end subroutine prove_case

      !> Run what a deck describes under Shi's scheme
      pure module subroutine decide_limerick(deck, scene, decision, album)
         type(deck_t), intent(in) :: deck
         type(scene_t), intent(in) :: scene
         type(decision_t), intent(out) :: decision
         !> Receives the ways of its points, if it has some
         type(album_t), intent(inout), optional :: album
      end subroutine decide_limerick

      !> Seek the least factor of the loads of all arcs: none where the dead load falls by itself
      pure module subroutine seek_least_factor(graph, dead, arc, stands, near, least)
         type(joint_graph_t), intent(in) :: graph
         !> Loads at a factor of zero: (3, n_block) [N/m, N/m, N]
         real(wp), intent(in) :: dead(:, :)
         type(load_arc_t), intent(in) :: arc(:)  !! The live loads: (n)
         logical, intent(in) :: stands           !! Whether the dead load is known to stand
         real(wp), intent(in) :: near            !! How near the place is to be [m]
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
      if (this%family%chains) call arch_rays(this%family%numbers, this%family%rays)
      if (this%searches .and. this%limerick) then
         call search_limerick(this)
         call see_standing(this)
      else if (this%searches) then
         call search_critical(this)
      else if (this%limerick) then
         call deck_scene(this%family%deck, this%plan, this%scene)
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
      if (allocated(this%critical%fallen)) &
         & call see_collapse(this, this%critical%falls, this%critical%fallen)
      call see_standing(this)
      if (allocated(this%critical%scene)) deallocate (this%critical%scene)
      if (nint(this%family%deck%value(output_frames)%number) > 0) call take_pictures(this)
   end subroutine search_critical

   !> Make the scene that stands, where none was found to fall
   pure subroutine see_standing(this)
      type(case_t), intent(inout) :: this

      if (this%family%decides_chains .or. allocated(this%critical%fallen) &
         & .or. .not. allocated(this%critical%standing)) return
      if (allocated(this%critical%scene)) call move_scene(this%critical%scene, this%standing)
      call build_once(this%family, this%critical%stands, this%standing)
      this%scene = this%standing
   end subroutine see_standing
end module dda_compute_case
