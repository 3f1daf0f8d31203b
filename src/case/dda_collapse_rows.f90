!> How a case falls, or would fall next, in its rows
module dda_collapse_rows
   use dda_block_rows, only : joint_rows, scale_to_one, tell_blocks, tell_mechanism_motion, &
      & tell_roles, tell_total_motion
   use dda_case, only : case_t
   use dda_contacts, only : contacts_t
   use dda_kinds, only : wp
   use dda_mechanism, only : mechanism_of, mechanism_t
   use dda_scene, only : build_once, scene_t, searched_load
   use dda_search, only : critical_t, decision_t
   use dda_write_results, only : joint_row_t, result_row_t, some_number, told_blocks_t
   implicit none
   private

   public :: tell_mechanism, tell_nearest

contains

   !> Joints and blocks of the decision nearest to critical that stands, else of that which falls
   pure subroutine tell_nearest(this, joint_row, blocks)
      type(case_t), intent(in) :: this
      !> Rows of the joints: (n_joint), or (0) if there is nothing to tell
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      type(told_blocks_t), intent(inout) :: blocks
      type(scene_t) :: scene

      ! a load coefficient changes no blocks
      if (allocated(this%critical%standing) .and. this%family%load == searched_load%none) then
         scene = this%standing
         call build_once(this%family, this%critical%stands, scene)
         call tell_scene(scene, this%critical, joint_row, blocks)
      else
         call tell_scene(this%scene, this%critical, joint_row, blocks)
      end if
   end subroutine tell_nearest

   !> The same of its scene
   pure subroutine tell_scene(scene, critical, joint_row, blocks)
      type(scene_t), intent(in) :: scene
      type(critical_t), intent(in) :: critical
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)
      type(told_blocks_t), intent(inout) :: blocks

      if (allocated(critical%standing)) then
         call tell_joints(scene, critical%standing%contacts, critical, joint_row)
      else if (allocated(critical%fallen)) then
         call tell_joints(scene, critical%fallen%contacts, critical, joint_row)
      end if
      if (allocated(scene%system%equation)) call tell_blocks(scene, blocks)
      if (allocated(critical%fallen)) call tell_fall(critical%fallen, scene, blocks)
   end subroutine tell_scene

   !> Joints of one side of the bracket, and what they do in the collapse
   pure subroutine tell_joints(scene, contacts, critical, joint_row)
      type(scene_t), intent(in) :: scene
      type(contacts_t), intent(in) :: contacts  !! Contacts of the side
      type(critical_t), intent(in) :: critical
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)

      if (.not. allocated(contacts%joint)) return
      joint_row = joint_rows(scene%system, contacts, scene%joint_angle_deg, scene%origin)
      if (size(joint_row) > 0 .and. allocated(critical%fallen)) call tell_roles( &
         & critical%fallen%contacts, scene%system, contacts, joint_row, &
         & critical%fallen%outcome%motion)
   end subroutine tell_joints

   !> Displacements of the blocks in the collapse nearest to critical
   pure subroutine tell_fall(fallen, scene, blocks)
      type(decision_t), intent(in) :: fallen
      !> The scene that is told, at the value that stands if one does
      type(scene_t), intent(in) :: scene
      !> Its blocks; displacements are set where they are known
      type(told_blocks_t), intent(inout) :: blocks

      if (allocated(fallen%outcome%motion)) then
         call tell_mechanism_motion(scene%system, fallen%outcome%motion, blocks)
      else if (allocated(fallen%system%moved)) then
         if (size(fallen%system%moved) /= size(blocks%corner)) return
         call tell_total_motion(fallen%system, .true., blocks)
         call scale_to_one(blocks%displacement)
      end if
   end subroutine tell_fall

   !> Fill the columns of a collapse
   pure subroutine tell_mechanism(fallen, joint_angle_deg, row)
      type(decision_t), intent(in) :: fallen
      !> Angle of each joint from the crown: (n_joint) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      type(result_row_t), intent(inout) :: row
      type(mechanism_t) :: mechanism

      associate (outcome => fallen%outcome)
         if (allocated(outcome%fallen)) then
            call mechanism_of(outcome%fallen, joint_angle_deg, mechanism, outcome%motion)
         else
            call mechanism_of(fallen%contacts, joint_angle_deg, mechanism, outcome%motion)
         end if
      end associate
      row%collapse_mode = mechanism%mode
      row%sliding_share = some_number(mechanism%sliding_share)
      row%intrados_hinge_deg = mechanism%intrados_deg
      row%extrados_hinge_deg = mechanism%extrados_deg
      row%springing_hinge = mechanism%springing
   end subroutine tell_mechanism

end module dda_collapse_rows
