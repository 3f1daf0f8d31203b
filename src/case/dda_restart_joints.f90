!> The joints of a restart file: corners, edges and states as whole numbers, the rest as numbers
submodule (dda_restart) dda_restart_joints
   use dda_contacts, only : begin_memory, set_joints
   use dda_contact_search, only : law_between
   use dda_contact_types, only : joint_springs_t, joint_t, place_joint, vertex_number
   use dda_outline, only : outline_of, outline_t
   implicit none

contains

   !> Joints as numbers
   module procedure pack_joints
      integer :: j, k

      allocate (whole(n_joint_whole, size(contacts%joint)))
      allocate (number(n_joint_number, size(contacts%joint)))
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j), face => contacts%face(j))
            whole(:, j) = [joint%n_contact, joint%contact%edge_side, &
               & (vertex_number(system, joint%contact(k)%vertex_block, joint%contact(k)%vertex), &
               & k=1, 2), (vertex_number(system, joint%contact(k)%edge_block, &
               & joint%contact(k)%edge), k=1, 2), merge(1, 0, face%open), face%slip]
            number(:, j) = [joint%length, joint%contact%length, joint%contact%share, &
               & joint%contact%lock, joint%contact%closed_at, contacts%past_slip(j), &
               & contacts%trial(:, j), contacts%force(:, j), contacts%gap(:, j), &
               & contacts%increment(:, j), contacts%intact(:, j)]
         end associate
      end do
   end procedure pack_joints

   !> Joints from numbers that are finite
   module procedure unpack_joints
      type(joint_t), allocatable :: joint(:)
      integer(int32), allocatable :: given(:, :)
      real(wp), allocatable :: ignored(:, :)
      real(wp) :: gap(3)
      integer :: j

      sound = all(whole(8:9, :) == 0 .or. whole(8:9, :) == 1) .and. all(abs(whole(10, :)) <= 1) &
         & .and. all(number(23:24, :) >= 0.0_wp .and. number(23:24, :) <= 1.0_wp)
      if (.not. sound) return
      if (contacts%searched .and. settings%current) then
         allocate (joint(size(whole, 2)))
         call make_joints(system, contacts, whole, number, joint, sound)
         if (.not. sound) return
         call set_joints(joint, contacts)
         call begin_memory(contacts)
         allocate (contacts%place(size(contacts%joint)))
         do j = 1, size(contacts%joint)
            call place_joint(system, system%moved, contacts%joint(j), contacts%place(j), gap)
         end do
      else
         call begin_memory(contacts)
         sound = size(contacts%joint) == size(whole, 2)
         if (sound) call pack_joints(system, contacts, given, ignored)
         if (sound) sound = all(given(:7, :) == whole(:7, :))
      end if
      if (.not. sound) return
      do j = 1, size(whole, 2)
         contacts%face(j)%open = whole(8:9, j) == 1
         contacts%face(j)%slip = whole(10, j)
         contacts%past_slip(j) = number(10, j)
         contacts%trial(:, j) = number(11:13, j)
         contacts%force(:, j) = number(14:16, j)
         contacts%gap(:, j) = number(17:19, j)
         contacts%increment(:, j) = number(20:22, j)
         contacts%intact(:, j) = number(23:24, j)
      end do
      contacts%springs = joint_springs_t()
   end procedure unpack_joints

   !> Joints that a search had found, where the blocks are
   pure subroutine make_joints(system, contacts, whole, number, joint, sound)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer(int32), intent(in) :: whole(:, :)
      real(wp), intent(in) :: number(:, :)
      type(joint_t), intent(out) :: joint(:)  !! The joints: (n_joint)
      logical, intent(out) :: sound
      type(outline_t) :: outline
      integer :: j, k

      outline = outline_of(system)
      sound = .true.
      do j = 1, size(joint)
         sound = is_joint(system, outline, whole(:, j), number(:, j))
         if (sound) sound = edges_face(system, outline, whole(:, j))
         if (.not. sound) return
         do k = 1, 2
            joint(j)%contact(k)%vertex_block = outline%block(whole(3 + k, j))
            joint(j)%contact(k)%vertex = whole(3 + k, j) &
               & - system%first_vertex(outline%block(whole(3 + k, j))) + 1
            joint(j)%contact(k)%edge_block = outline%block(whole(5 + k, j))
            joint(j)%contact(k)%edge = whole(5 + k, j) &
               & - system%first_vertex(outline%block(whole(5 + k, j))) + 1
         end do
         joint(j)%found = .true.
         joint(j)%n_contact = whole(1, j)
         joint(j)%block = blocks_of(outline, whole(:, j), 1)
         joint(j)%law = law_between(contacts%search, system%material(joint(j)%block))
         joint(j)%length = number(1, j)
         joint(j)%contact%edge_side = whole(2:3, j)
         joint(j)%contact%length = number(2:3, j)
         joint(j)%contact%share = number(4:5, j)
         joint(j)%contact%lock = number(6:7, j)
         joint(j)%contact%closed_at = number(8:9, j)
      end do
   end subroutine make_joints

   !> Whether numbers are those of a joint of two blocks, of which one moves
   pure logical function is_joint(system, outline, whole, number)
      type(block_system_t), intent(in) :: system
      type(outline_t), intent(in) :: outline
      integer(int32), intent(in) :: whole(:)  !! Whole numbers: (n_joint_whole)
      real(wp), intent(in) :: number(:)       !! Numbers: (n_joint_number)
      real(wp), parameter :: rounding = 1.0e-9_wp
      integer :: block(2)

      is_joint = all(whole(:3) == 1 .or. whole(:3) == 2) &
         & .and. all(whole(4:7) >= 1 .and. whole(4:7) <= size(outline%block)) &
         & .and. all(number(1:5) >= 0.0_wp) .and. abs(sum(number(4:5)) - 1.0_wp) <= rounding
      if (.not. is_joint) return
      block = blocks_of(outline, whole, 1)
      is_joint = block(1) /= block(2) .and. any(system%equation(block) > 0) &
         & .and. all(block == blocks_of(outline, whole, 2))
   end function is_joint

   !> Whether the edges of a joint run against one another, if they are of both blocks
   pure logical function edges_face(system, outline, whole)
      type(block_system_t), intent(in) :: system
      type(outline_t), intent(in) :: outline
      integer(int32), intent(in) :: whole(:)  !! Whole numbers of the joint: (n_joint_whole)
      real(wp) :: edge(2, 2)

      edge = system%moved(:, outline%next(whole(6:7))) - system%moved(:, whole(6:7))
      edges_face = whole(2) == whole(3) .or. dot_product(edge(:, 1), edge(:, 2)) < 0.0_wp
   end function edges_face

   !> The two blocks that a contact is of
   pure function blocks_of(outline, whole, k) result(block)
      type(outline_t), intent(in) :: outline
      integer(int32), intent(in) :: whole(:)
      integer, intent(in) :: k  !! Which of its contacts
      integer :: block(2)       !! First and second block of the joint: (2)

      block(whole(1 + k)) = outline%block(whole(5 + k))
      block(3 - whole(1 + k)) = outline%block(whole(3 + k))
   end function blocks_of

end submodule dda_restart_joints
