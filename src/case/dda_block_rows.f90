!> Rows of blocks and joints of a case: corners, supports, motion, forces, openings, mechanism
module dda_block_rows
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t
   use dda_contact_types, only : joint_place_t, joint_t, place_joint, same_joint
   use dda_contacts, only : contacts_t, joint_place
   use dda_deformation, only : displacement_matrix
   use dda_frames, only : frame_t
   use dda_kinds, only : wp
   use dda_mechanism, only : largest_of, mechanism_of, mechanism_t, role_of_joint, slides
   use dda_scene, only : build_once, scene_t, searched_load
   use dda_search, only : critical_t, decision_t
   use dda_vector, only : cross
   use dda_write_frames, only : frame_joint_row_t
   use dda_write_results, only : joint_row_t, result_row_t, some_number, told_blocks_t
   implicit none
   private

   public :: contact_state, contact_states, ends_on_path, fallen_contacts, frame_joint_rows
   public :: joint_rows, scale_to_one, tell_blocks
   public :: tell_mechanism, tell_mechanism_motion, tell_nearest, tell_roles, tell_total_motion

   !> Words for the roles of a joint, by their number: those of the columns state and mechanism
   character(len=14), parameter :: role_word(0:4) = [character(len=14) :: "none", "open", &
      & "sliding", "hinge_intrados", "hinge_extrados"]

   !> Shi's states of a contact
   type :: contact_state_enum
      integer :: open = 0     !! Apart: no spring
      integer :: sliding = 1  !! Closed, at the Coulomb limit: normal spring and friction force
      integer :: locked = 2   !! Closed and stuck: normal and shear spring
   end type contact_state_enum

   !> Names of the contact states
   type(contact_state_enum), parameter :: contact_state = contact_state_enum()

   !> Words for the states of a contact, by their number
   character(len=8), parameter :: state_word(0:2) = ["open    ", "sliding ", "locked  "]

contains

   !> Rows of the blocks at the beginning
   pure subroutine tell_blocks(scene, blocks)
      type(scene_t), intent(in) :: scene
      type(told_blocks_t), intent(out) :: blocks  !! The blocks, without displacements
      integer :: i

      associate (system => scene%system)
         allocate (blocks%first_vertex, source=system%first_vertex)
         allocate (blocks%corner, source=system%vertex)
         blocks%corner(1, :) = blocks%corner(1, :) + scene%origin(1)
         blocks%corner(2, :) = blocks%corner(2, :) + scene%origin(2)
         allocate (blocks%state(size(system%equation)))
         blocks%state = "free"
         if (allocated(scene%settings%boundary%held)) then
            do i = 1, size(scene%settings%boundary%held)
               blocks%state(scene%settings%boundary%held(i)%block) = "held"
            end do
         end if
         where (system%equation == 0) blocks%state = "fixed"
         if (allocated(system%absent)) then
            where (system%absent) blocks%state = ""
         end if
      end associate
   end subroutine tell_blocks

   !> A collapse mechanism: the motion of the last step, which has a shape but no size
   pure subroutine tell_mechanism_motion(system, motion, blocks)
      type(block_system_t), intent(in) :: system    !! The blocks at the beginning
      real(wp), intent(in) :: motion(:, :)          !! Motion of the step: (n_dof, n_equation)
      type(told_blocks_t), intent(inout) :: blocks  !! The blocks; displacements are set
      real(wp) :: of_block(6, size(system%equation))
      integer :: b

      of_block = 0.0_wp
      do b = 1, size(system%equation)
         if (system%equation(b) > 0) of_block(:size(motion, 1), b) = motion(:, system%equation(b))
      end do
      blocks%displacement = small_displacements(system, of_block)
      call scale_to_one(blocks%displacement)
   end subroutine tell_mechanism_motion

   !> Scale a mechanism so that the largest displacement is 1
   pure subroutine scale_to_one(displacement)
      real(wp), intent(inout) :: displacement(:, :)  !! Displacements of all corners: (2, n_vertex)
      real(wp) :: largest

      largest = maxval(norm2(displacement, dim=1))
      if (largest > 0.0_wp) displacement = displacement/largest
   end subroutine scale_to_one

   !> Displacements at the end of a run
   pure subroutine tell_total_motion(system, moves, blocks)
      type(block_system_t), intent(in) :: system
      !> True if corners follow the motion; otherwise displacements are small
      logical, intent(in) :: moves
      type(told_blocks_t), intent(inout) :: blocks

      if (moves) then
         blocks%displacement = system%moved - system%vertex
      else
         blocks%displacement = small_displacements(system, system%motion)
      end if
   end subroutine tell_total_motion

   !> Displacements of all corners in a motion without second-order terms
   pure function small_displacements(system, motion) result(displacement)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)                 !! Motion of all blocks: (6, n_block)
      real(wp) :: displacement(2, size(system%vertex, 2))  !! The displacements: (2, n_vertex) [m]
      integer :: b, v

      do b = 1, size(system%equation)
         do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
            displacement(:, v) = matmul( &
               & displacement_matrix(system%vertex(:, v), system%centroid(:, b)), motion(:, b))
         end do
      end do
   end function small_displacements

   !> Rows of all joints
   pure function joint_rows(system, contacts, joint_angle_deg, origin) result(row)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      !> Angle of each joint from the crown, or none: (n_joint) or (0) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      real(wp), intent(in) :: origin(2)  !! Where the origin of the blocks' coordinates is: (2) [m]
      !> The rows, without the number of the case: (n_joint)
      type(joint_row_t) :: row(size(contacts%joint))
      type(joint_place_t) :: place
      real(wp) :: way
      integer :: j

      do j = 1, size(row)
         place = joint_place(system, contacts, j)
         row(j)%joint = j
         if (size(joint_angle_deg) > 0) row(j)%angle_deg = some_number(joint_angle_deg(j))
         call tell_forces(contacts%joint(j), place, contacts%force(:, j), origin, row(j))
         row(j)%opening_intrados = contacts%gap(1, j)
         if (contacts%joint(j)%n_contact > 1) &
            & row(j)%opening_extrados = some_number(contacts%gap(2, j))
         row(j)%slip = contacts%gap(3, j)
         row(j)%state = "locked"
         if (contacts%face(j)%open(2)) row(j)%state = "hinge_intrados"
         if (contacts%face(j)%open(1) .or. is_second_end(system, contacts%joint(j))) &
            & row(j)%state = "hinge_extrados"
         if (contacts%face(j)%slip /= 0) row(j)%state = "sliding"
         if (all(contacts%face(j)%open)) row(j)%state = "open"
         if (row(j)%state /= "sliding") cycle
         ! friction acts against the sliding of the second block; without friction the slip gives
         ! its direction
         way = sign(1.0_wp, contacts%gap(3, j))
         if (abs(contacts%force(3, j)) > 0.0_wp) way = -sign(1.0_wp, contacts%force(3, j))
         row(j)%slides = some_number(way*place%tangent)
      end do
   end function joint_rows

   !> True if the only corner of a joint is where joints of two corners have their second end: left
   !> of the way from the first block to the second, in the reference shape
   pure logical function is_second_end(system, joint)
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint
      real(wp) :: middle(2, 2), corner(2)

      middle = system%centroid(:, joint%block)
      corner = system%vertex(:, joint%contact(1)%vertex)
      is_second_end = joint%n_contact == 1 &
         & .and. cross(middle(:, 2) - middle(:, 1), corner - middle(:, 1)) > 0.0_wp
   end function is_second_end

   !> Where a joint is, and the force that its first block puts on its second
   pure subroutine tell_forces(joint, place, force, origin, row)
      type(joint_t), intent(in) :: joint
      type(joint_place_t), intent(in) :: place
      real(wp), intent(in) :: force(3)  !! Its force N1, N2, T: (3) [N/m]
      real(wp), intent(in) :: origin(2)
      type(joint_row_t), intent(inout) :: row

      row%block = joint%block
      row%intrados = place%point(:, 1) + origin
      row%extrados = place%point(:, joint%n_contact) + origin
      row%normal_force = force(1) + force(2)
      row%shear_force = force(3)
      row%force = row%normal_force*place%normal + row%shear_force*place%tangent
      row%point = (row%intrados + row%extrados)/2.0_wp
      if (.not. row%normal_force > 0.0_wp) return
      if (joint%n_contact > 1) &
         & row%eccentricity_ratio = some_number((force(1) - force(2))/row%normal_force)
      row%point = (force(1)*row%intrados + force(2)*row%extrados)/row%normal_force
   end subroutine tell_forces

   !> Set the role of each joint in a collapse; its motion is that of the last step
   pure subroutine tell_roles(fallen, system, contacts, row, motion)
      !> Contacts at the end of the collapse; without joints they are those of the rows
      type(contacts_t), intent(in) :: fallen
      !> The blocks of the rows, where these or those have not been placed
      type(block_system_t), intent(in) :: system
      !> The contacts of the rows: of the same run, or of one that stands beside it
      type(contacts_t), intent(in) :: contacts
      type(joint_row_t), intent(inout) :: row(:)  !! The rows: (n_joint)
      !> Motion of the blocks in the last step, where it is known: (n_dof, n_equation)
      real(wp), intent(in), optional :: motion(:, :)
      integer :: role(size(fallen%face)), j, k
      logical :: slip(size(fallen%face))
      real(wp) :: largest
      type(joint_place_t) :: place

      largest = largest_of(fallen, motion)
      role = role_of_joint(fallen, largest)
      slip = slides(fallen%face, fallen%increment(3, :), largest)
      do j = 1, size(row)
         row(j)%slides%known = .false.
         k = j
         if (allocated(fallen%joint)) k = number_in(fallen%joint, contacts%joint(j), j)
         if (k == 0) cycle
         row(j)%mechanism = role_word(role(k))
         if (.not. slip(k)) cycle
         if (allocated(fallen%joint)) place = joint_place(system, fallen, k)
         if (.not. allocated(fallen%joint)) place = joint_place(system, contacts, j)
         row(j)%slides = some_number(sign(1.0_wp, fallen%increment(3, k))*place%tangent)
      end do
   end subroutine tell_roles

   !> Number of a joint among those of another run: of the same corners and edges, else between the
   !> same blocks; 0 if there is none
   pure integer function number_in(joints, joint, guess)
      type(joint_t), intent(in) :: joints(:)  !! The joints of the other run
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: guess            !! Where it may be
      integer :: k

      number_in = 0
      if (guess <= size(joints)) then
         if (same_joint(joints(guess), joint)) number_in = guess
      end if
      if (number_in > 0) return
      do k = 1, size(joints)
         if (any(joints(k)%block /= joint%block)) cycle
         if (number_in == 0) number_in = k
         if (.not. same_joint(joints(k), joint)) cycle
         number_in = k
         return
      end do
   end function number_in

   !> Rows of all joints of a picture
   pure function frame_joint_rows(frame) result(row)
      type(frame_t), intent(in) :: frame
      type(frame_joint_row_t) :: row(size(frame%joint))  !! The rows: (n_joint)
      type(joint_place_t) :: place
      real(wp) :: gap(3), normal_force
      integer :: j, states(2)

      do j = 1, size(row)
         call place_joint(frame%moved, frame%joint(j), place, gap)
         row(j)%joint = j
         row(j)%contact(:, 1) = place%point(:, 1)
         row(j)%contact(:, 2) = place%point(:, frame%joint(j)%n_contact)
         normal_force = sum(frame%force(1:2, j))
         row(j)%force = normal_force*place%normal + frame%force(3, j)*place%tangent
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
      integer, intent(in) :: joint  !! Number of the joint
      integer :: states(2)          !! One of contact_state each: (2)

      states = contact_state%locked
      if (slides(frame%face(joint), frame%slip(joint), frame%farthest)) &
         & states = contact_state%sliding
      where (frame%face(joint)%open) states = contact_state%open
   end function contact_states

   !> Joints and blocks of the decision nearest to critical that stands, else of that which falls
   pure subroutine tell_nearest(this, joint_row, blocks)
      type(case_t), intent(in) :: this
      !> Rows of the joints: (n_joint), or (0) if there are none
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
      if (ends_on_path(critical%standing)) then
         if (size(critical%standing%system%moved) == size(blocks%corner)) &
            & call tell_total_motion(critical%standing%system, .true., blocks)
         return
      end if
      if (.not. allocated(critical%fallen)) return
      associate (fallen => critical%fallen)
         if (allocated(fallen%outcome%motion)) then
            call tell_mechanism_motion(scene%system, fallen%outcome%motion, blocks)
         else if (allocated(fallen%system%moved)) then
            if (size(fallen%system%moved) /= size(blocks%corner)) return
            call tell_total_motion(fallen%system, .true., blocks)
            call scale_to_one(blocks%displacement)
         end if
      end associate
   end subroutine tell_scene

   !> True if blocks have moved along a path of histories or prescribed displacements to their rest
   pure logical function ends_on_path(standing)
      type(decision_t), intent(in), allocatable :: standing  !! The decision, if there is one

      ends_on_path = allocated(standing)
      if (ends_on_path) ends_on_path = standing%outcome%has_path &
         & .and. allocated(standing%system%moved)
   end function ends_on_path

   !> Joints of one side of the bracket, and what they do in the collapse
   pure subroutine tell_joints(scene, contacts, critical, joint_row)
      type(scene_t), intent(in) :: scene
      type(contacts_t), intent(in) :: contacts  !! Contacts of the side
      type(critical_t), intent(in) :: critical
      type(joint_row_t), allocatable, intent(inout) :: joint_row(:)

      if (.not. allocated(contacts%joint)) return
      joint_row = joint_rows(scene%system, contacts, scene%joint_angle_deg, scene%origin)
      if (size(joint_row) > 0 .and. allocated(critical%fallen)) call tell_roles( &
         & fallen_contacts(critical%fallen), scene%system, contacts, joint_row, &
         & critical%fallen%outcome%motion)
   end subroutine tell_joints

   !> Contacts of the step that has shown a collapse
   pure type(contacts_t) function fallen_contacts(fallen) result(contacts)
      !> The collapse, which may have been followed beyond that step
      type(decision_t), intent(in) :: fallen

      if (allocated(fallen%outcome%fallen)) then
         contacts = fallen%outcome%fallen
      else
         contacts = fallen%contacts
      end if
   end function fallen_contacts

   !> Fill the columns of a collapse
   pure subroutine tell_mechanism(fallen, joint_angle_deg, row)
      type(decision_t), intent(in) :: fallen
      !> Angle of each joint from the crown: (n_joint) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      type(result_row_t), intent(inout) :: row
      type(mechanism_t) :: mechanism

      call mechanism_of(fallen_contacts(fallen), joint_angle_deg, mechanism, fallen%outcome%motion)
      row%collapse_mode = mechanism%mode
      row%sliding_share = some_number(mechanism%sliding_share)
      row%intrados_hinge_deg = mechanism%intrados_deg
      row%extrados_hinge_deg = mechanism%extrados_deg
      row%springing_hinge = mechanism%springing
   end subroutine tell_mechanism
end module dda_block_rows
