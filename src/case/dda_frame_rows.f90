!> The joints of a picture: where they are, their forces, and what their contacts do
module dda_frame_rows
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_t, place_joint
   use dda_frames, only : frame_t
   use dda_friction_cone, only : contact_state
   use dda_kinds, only : wp
   use dda_mechanism, only : slides
   use dda_write_frames, only : frame_joint_row_t
   implicit none
   private

   public :: frame_joint_rows, contact_states

   !> Words for the states of a contact, by their number
   character(len=8), parameter :: state_word(0:2) = ["open    ", "sliding ", "locked  "]

contains

   !> Rows of all joints of a picture
   pure function frame_joint_rows(system, frame) result(row)
      type(block_system_t), intent(in) :: system
      type(frame_t), intent(in) :: frame
      !> The rows: (n_joint)
      type(frame_joint_row_t) :: row(size(frame%joint))
      type(joint_t) :: joint
      real(wp) :: gap(3), normal_force
      integer :: j, states(2)

      do j = 1, size(row)
         joint = frame%joint(j)
         call place_joint(system, frame%moved, joint, gap)
         row(j)%joint = j
         row(j)%contact(:, 1) = joint%contact(1)%point
         row(j)%contact(:, 2) = joint%contact(joint%n_contact)%point
         normal_force = sum(frame%force(1:2, j))
         row(j)%force = normal_force*joint%normal + frame%force(3, j)*joint%tangent
         row(j)%point = (row(j)%contact(:, 1) + row(j)%contact(:, 2))/2.0_wp
         if (normal_force > 0.0_wp) row(j)%point = (frame%force(1, j)*row(j)%contact(:, 1) &
            & + frame%force(2, j)*row(j)%contact(:, 2))/normal_force
         states = contact_states(frame, j)
         row(j)%state = state_word(states)
      end do
   end function frame_joint_rows

   !> States of the two contacts of a joint: whether it slides is seen in the last step
   pure function contact_states(frame, joint) result(states)
      type(frame_t), intent(in) :: frame
      !> Number of the joint
      integer, intent(in) :: joint
      !> One of contact_state each: (2)
      integer :: states(2)

      states = contact_state%locked
      if (slides(frame%face(joint), frame%slip(joint), frame%farthest)) &
         & states = contact_state%sliding
      where (frame%face(joint)%open) states = contact_state%open
   end function contact_states
end module dda_frame_rows
