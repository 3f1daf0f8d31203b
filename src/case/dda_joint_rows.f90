!> The joints of a decision as rows: forces, openings, and what they do in the collapse
module dda_joint_rows
   use dda_contact_detection, only : contacts_t
   use dda_contact_types, only : joint_t, same_joint
   use dda_kinds, only : wp
   use dda_mechanism, only : largest_of, role_of_joint, slides
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
      type(joint_t), intent(in) :: joint
      !> Its force N1, N2, T: (3) [N/m]
      real(wp), intent(in) :: force(3)
      real(wp), intent(in) :: origin(2)
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
   pure subroutine tell_roles(fallen, joint, row, motion)
      !> Contacts at the end of the collapse
      type(contacts_t), intent(in) :: fallen
      !> The joints of the rows: of the same run, or of one that stands beside it: (n_joint)
      type(joint_t), intent(in) :: joint(:)
      !> The rows: (n_joint)
      type(joint_row_t), intent(inout) :: row(:)
      !> Motion of the blocks in the last step, where it is known: (n_dof, n_equation)
      real(wp), intent(in), optional :: motion(:, :)
      integer :: role(size(fallen%joint)), j, k
      logical :: slip(size(fallen%joint))
      real(wp) :: largest

      largest = largest_of(fallen)
      if (present(motion)) largest = largest_of(fallen, motion)
      role = role_of_joint(fallen, largest)
      slip = slides(fallen%face, fallen%increment(3, :), largest)
      do j = 1, size(row)
         row(j)%slides%known = .false.
         k = place_in(fallen%joint, joint(j), j)
         if (k == 0) cycle
         row(j)%mechanism = role_word(role(k))
         if (slip(k)) row(j)%slides = &
            & some_number(sign(1.0_wp, fallen%increment(3, k))*fallen%joint(k)%tangent)
      end do
   end subroutine tell_roles

   !> Number of a joint among those of another run: of the same corners and edges, else between the
   !> same blocks; 0 if there is none
   pure integer function place_in(joints, joint, guess)
      !> The joints of the other run
      type(joint_t), intent(in) :: joints(:)
      type(joint_t), intent(in) :: joint
      !> Where it may be
      integer, intent(in) :: guess
      integer :: k

      place_in = 0
      if (guess <= size(joints)) then
         if (same_joint(joints(guess), joint)) place_in = guess
      end if
      if (place_in > 0) return
      do k = 1, size(joints)
         if (any(joints(k)%block /= joint%block)) cycle
         if (place_in == 0) place_in = k
         if (.not. same_joint(joints(k), joint)) cycle
         place_in = k
         return
      end do
   end function place_in
end module dda_joint_rows
