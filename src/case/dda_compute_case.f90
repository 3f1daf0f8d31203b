!> Computing a case: searched or decided, proven, with what its tables and pictures need
module dda_compute_case
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_arch_chain, only : arch_rays
   use dda_arch_scene, only : exact_thickness
   use dda_case, only : case_t
   use dda_case_decision, only : compute_decision, place_joints, plan_album, see_collapse, &
      & take_pictures
   use dda_case_proof, only : prove_case
   use dda_critical, only : find_critical
   use dda_deck_scene, only : deck_scene
   use dda_key_names, only : arch_thickness_ratio, output_frames, vehicle_worst
   use dda_kinds, only : wp
   use dda_limerick_decision, only : decide_limerick, search_limerick
   use dda_scene, only : build_once, move_scene
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
