!> The decision of a case: as a chain, stage by stage, or from where an earlier run has ended; and
!> the scene that its tables and pictures need
submodule (dda_compute_case) dda_case_decision
   use dda_block_system, only : block_system_t
   use dda_chain, only : chain_t
   use dda_chain_decision, only : decide_chain, unfold
   use dda_contacts, only : contacts_t, place_all_joints
   use dda_decision, only : decide_in_stages
   use dda_key_names, only : analysis_restart, output_joints, output_reactions
   use dda_mechanism, only : follow_collapse
   use dda_reactions, only : supports_of
   use dda_restart, only : load_restart
   use dda_scene, only : searched_load
   use dda_settings, only : settings_t
   use dda_verdict, only : verdict
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
      contacts%joint = this%standing%contacts%joint
      call place_all_joints(this%standing%system, contacts)
   end subroutine place_standing

   !> Take the joints of a scene that needs them no more
   pure subroutine take_joints(from, to)
      type(scene_t), intent(inout) :: from
      type(contacts_t), intent(inout) :: to

      if (allocated(to%joint) .or. .not. allocated(from%contacts%joint)) return
      call move_alloc(from%contacts%joint, to%joint)
      call place_all_joints(from%system, to)
   end subroutine take_joints

end submodule dda_case_decision
