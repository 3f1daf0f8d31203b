!> The joints of a decision told as rows: forces, openings, and what they do in the collapse
module dda_joint_rows
   use dda_contact_detection, only : contacts_t
   use dda_contact_types, only : joint_t
   use dda_kinds, only : wp
   use dda_mechanism, only : joint_role, role_of_joint
   use dda_write_results, only : joint_row_t, some_number
   implicit none
   private

   public :: joint_rows, tell_roles

   !> Words for the roles of a joint, by their number: those of the columns state and mechanism
   character(len=14), parameter :: role_word(0:4) = [character(len=14) :: "none", "open", &
      & "sliding", "hinge_intrados", "hinge_extrados"]

contains

   !> Rows of all joints
   pure function joint_rows(contacts, joint_angle_deg, origin) result(row)
      !> The contacts
      type(contacts_t), intent(in) :: contacts
      !> Angle of each joint from the crown, or none: (n_joint) or (0) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      !> Where the origin of the blocks' coordinates is: (2) [m]
      real(wp), intent(in) :: origin(2)
      !> The rows, without the number of the case: (n_joint)
      type(joint_row_t) :: row(size(contacts%joint))
      integer :: j

      do j = 1, size(row)
         row(j)%joint = j
         if (size(joint_angle_deg) > 0) row(j)%angle_deg = some_number(joint_angle_deg(j))
         call tell_forces(contacts%joint(j), contacts%force(:, j), origin, row(j))
         row(j)%opening_intrados = contacts%gap(1, j)
         if (contacts%joint(j)%n_contact > 1) &
            & row(j)%opening_extrados = some_number(contacts%gap(2, j))
         row(j)%slip = contacts%gap(3, j)
         row(j)%state = "locked"
         if (contacts%face(j)%open(2)) row(j)%state = "hinge_intrados"
         if (contacts%face(j)%open(1)) row(j)%state = "hinge_extrados"
         if (contacts%face(j)%slip /= 0) row(j)%state = "sliding"
         if (all(contacts%face(j)%open)) row(j)%state = "open"
         if (row(j)%state == "sliding") row(j)%slides = &
            & some_number(way_against(contacts%force(3, j), contacts%gap(3, j)) &
            & *contacts%joint(j)%tangent)
      end do
   end function joint_rows

   !> Where a joint is, and the force that its first block puts on its second
   pure subroutine tell_forces(joint, force, origin, row)
      !> The joint
      type(joint_t), intent(in) :: joint
      !> Its force N1, N2, T: (3) [N/m]
      real(wp), intent(in) :: force(3)
      !> Where the origin of the blocks' coordinates is: (2) [m]
      real(wp), intent(in) :: origin(2)
      !> The row
      type(joint_row_t), intent(inout) :: row

      row%block = joint%block
      row%intrados = joint%contact(1)%point + origin
      row%extrados = joint%contact(joint%n_contact)%point + origin
      row%normal_force = force(1) + force(2)
      row%shear_force = force(3)
      row%force = row%normal_force*joint%normal + row%shear_force*joint%tangent
      row%point = (row%intrados + row%extrados)/2.0_wp
      if (.not. row%normal_force > 0.0_wp) return
      if (joint%n_contact > 1) &
         & row%eccentricity_ratio = some_number((force(1) - force(2))/row%normal_force)
      row%point = (force(1)*row%intrados + force(2)*row%extrados)/row%normal_force
   end subroutine tell_forces

   !> Friction acts against the way in which the second block slides; without friction the slip
   !> itself tells the way
   pure real(wp) function way_against(shear_force, slip)
      !> Shear force on the second block [N/m]
      real(wp), intent(in) :: shear_force
      !> Its slip since the beginning [m]
      real(wp), intent(in) :: slip

      way_against = sign(1.0_wp, slip)
      if (abs(shear_force) > 0.0_wp) way_against = -sign(1.0_wp, shear_force)
   end function way_against

   !> Tell what each joint does in a collapse; its motion is that of the last step
   pure subroutine tell_roles(fallen, row)
      !> Contacts at the end of the collapse
      type(contacts_t), intent(in) :: fallen
      !> The rows, of the same run or of one that stands beside it: (n_joint)
      type(joint_row_t), intent(inout) :: row(:)
      integer :: role(size(fallen%joint)), j, k

      role = role_of_joint(fallen)
      do j = 1, size(row)
         k = same_joint(fallen, row(j))
         if (k == 0) cycle
         row(j)%mechanism = role_word(role(k))
         if (role(k) == joint_role%sliding) row(j)%slides = &
            & some_number(sign(1.0_wp, fallen%increment(3, k))*fallen%joint(k)%tangent)
      end do
   end subroutine tell_roles

   !> Number of the joint between the same blocks, that of the same number if it can be; 0 if there
   !> is none
   pure integer function same_joint(contacts, row)
      !> The joints
      type(contacts_t), intent(in) :: contacts
      !> A joint of another run
      type(joint_row_t), intent(in) :: row

      same_joint = row%joint
      if (same_joint <= size(contacts%joint)) then
         if (all(contacts%joint(same_joint)%block == row%block)) return
      end if
      do same_joint = size(contacts%joint), 1, -1
         if (all(contacts%joint(same_joint)%block == row%block)) return
      end do
   end function same_joint
end module dda_joint_rows
