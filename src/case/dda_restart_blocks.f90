!> Blocks, contacts and state of a restart file
submodule (dda_restart) dda_restart_blocks
   use dda_block_system, only : begin_motion
   use dda_block_update, only : displaced
   use dda_contact_search, only : law_of
   use dda_contact_types, only : joint_springs_t, joint_t, place_joint
   use dda_contacts, only : begin_memory, set_joints
   use dda_outline, only : outline_of, outline_t
   use dda_step_context, only : energy_t, most_spare_cuts
   implicit none

   !> Upper limit of displacements over the model size, rotations and strains
   real(wp), parameter :: far = 1.0e12_wp

   !> Longest reach over width and height of a block
   real(wp), parameter :: longest_reach = 20.0_wp

   !> Upper limit of the number of iterations of a run
   integer, parameter :: most_passes = 1000000000

   !> Shortest and longest step [s]
   real(wp), parameter :: shortest = 1.0e-40_wp, longest = 1.0e15_wp

   !> Least remaining length of an edge over its length
   real(wp), parameter :: least_edge = 1.0e-3_wp

contains

   !> Put the blocks where they were
   module procedure take_blocks
      real(wp) :: no_motion(settings%n_dof, maxval(system%equation)), size_of_all
      integer :: b

      no_motion = 0.0_wp
      size_of_all = maxval(maxval(system%vertex, dim=2) - minval(system%vertex, dim=2))
      if (any(abs(state%vertex - system%vertex) > 0.0_wp)) then
         fault = "that of other blocks"
      else if (any(abs(state%motion(1:2, :)) > far*size_of_all) &
         & .or. any(abs(state%motion(3:, :)) > far) .or. any(abs(state%velocity) > beyond_all) &
         & .or. any(abs(state%strain_rate) > beyond_all) &
         & .or. any(abs(state%acceleration) > beyond_all) &
         & .or. any(abs(state%stress) > beyond_all)) then
         fault = "motions that no block has"
      end if
      do b = 1, size(system%equation)
         associate (corner => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            if (state%reach(b) < 0.0_wp .or. state%reach(b) > longest_reach &
               & *sum(maxval(corner, dim=2) - minval(corner, dim=2))) &
               & fault = "search distances that no block has"
         end associate
         if (system%equation(b) > 0) cycle
         if (any(abs(state%motion(:, b)) > 0.0_wp) .or. any(abs(state%velocity(:, b)) > 0.0_wp)) &
            & fault = "fixed blocks that move"
      end do
      if (fault /= "") return
      call begin_motion(system)
      system%motion = state%motion
      system%velocity = state%velocity
      system%strain_rate = state%strain_rate
      system%acceleration = state%acceleration
      system%stress = state%stress
      if (.not. settings%current) return
      system%block_pose_t = displaced(settings, system, no_motion)
      if (.not. are_blocks(system)) fault = "strains that leave no block"
   end procedure take_blocks

   !> True if strain has left blocks their shapes: no edge is gone, none is turned inside out
   pure logical function are_blocks(system)
      type(block_system_t), intent(in) :: system
      integer :: b

      are_blocks = .true.
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         associate (first => system%first_vertex(b), last => system%first_vertex(b + 1) - 1, &
            & strain => system%motion(4:6, b))
            are_blocks = all(edge_lengths(system%moved(:, first:last)) &
               & > least_edge*edge_lengths(system%vertex(:, first:last))) &
               & .and. strain(1) > -1.0_wp .and. strain(2) > -1.0_wp &
               & .and. (1.0_wp + strain(1))*(1.0_wp + strain(2)) > strain(3)**2/4.0_wp
         end associate
         if (.not. are_blocks) return
      end do
   end function are_blocks

   !> Lengths of the edges of a polygon
   pure function edge_lengths(corner) result(length)
      real(wp), intent(in) :: corner(:, :)  !! Its corners: (2, n) [m]
      real(wp) :: length(size(corner, 2))   !! The lengths: (n) [m]

      length = norm2(cshift(corner, 1, dim=2) - corner, dim=1)
   end function edge_lengths

   !> The march of a file
   module procedure take_march
      march%steps = state%count(8)
      march%passes = state%count(9)
      march%spare_cuts = min(most_spare_cuts, state%count(10))
      march%time = state%march(1)
      march%dt = state%march(2)
      associate (e => state%march(3:))
         march%energy = energy_t(e(1), e(2), e(3), e(4), e(5), e(6), e(7), e(8), e(9), e(10))
      end associate
      march%held_force = state%held_force
      if (contacts%searched .and. settings%current .and. march%steps > 0) march%reach = state%reach
      if (march%steps > 0 .and. (march%dt < shortest .or. march%dt > longest)) then
         fault = "a step of a length that no step has"
      else if (march%time < 0.0_wp .or. abs(march%time - march%energy%time) > 0.0_wp &
         & .or. march%passes > most_passes .or. any(abs(state%march) > beyond_all)) then
         fault = "a time or energies that no run has"
      else if (any(abs(state%held_force) > beyond_all)) then
         fault = "forces that no point has"
      end if
   end procedure take_march

   !> Joints as numbers
   module procedure pack_joints
      integer :: j

      allocate (whole(n_joint_whole, size(contacts%joint)))
      allocate (number(n_joint_number, size(contacts%joint)))
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j), face => contacts%face(j))
            whole(:, j) = [joint%n_contact, joint%contact%edge_side, &
               & joint%contact%vertex, joint%contact%edge, merge(1, 0, face%open), face%slip, &
               & merge(1, 0, face%idle)]
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

      sound = all(abs(whole([8, 9, 11, 12], :) - 0.5_wp) <= 0.5_wp) &
         & .and. all(abs(whole(10, :)) <= 1) &
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
            call place_joint(system%moved, contacts%joint(j), contacts%place(j), gap)
         end do
      else
         call begin_memory(contacts)
         sound = size(contacts%joint) == size(whole, 2)
         if (sound) call pack_joints(contacts, given, ignored)
         if (sound) sound = all(given(:7, :) == whole(:7, :))
      end if
      if (.not. sound) return
      do j = 1, size(whole, 2)
         contacts%face(j)%open = whole(8:9, j) == 1
         contacts%face(j)%slip = whole(10, j)
         contacts%face(j)%idle = whole(11:12, j) == 1
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
      integer :: j

      outline = outline_of(system)
      sound = .true.
      do j = 1, size(joint)
         sound = is_joint(system, outline, whole(:, j), number(:, j))
         if (.not. sound) return
         joint(j)%contact%vertex = whole(4:5, j)
         joint(j)%contact%edge = whole(6:7, j)
         joint(j)%contact%edge_end = outline%next(whole(6:7, j))
         joint(j)%found = .true.
         joint(j)%n_contact = whole(1, j)
         joint(j)%block = blocks_of(outline, whole(:, j), 1)
         joint(j)%law = law_of(contacts%search, system, joint(j))
         joint(j)%length = number(1, j)
         joint(j)%contact%edge_side = whole(2:3, j)
         joint(j)%contact%length = number(2:3, j)
         joint(j)%contact%share = number(4:5, j)
         joint(j)%contact%lock = number(6:7, j)
         joint(j)%contact%closed_at = number(8:9, j)
      end do
   end subroutine make_joints

   !> True if numbers are those of a joint of two blocks, of which one moves; its edges run against
   !> one another, if they are of both blocks
   pure logical function is_joint(system, outline, whole, number)
      type(block_system_t), intent(in) :: system
      type(outline_t), intent(in) :: outline
      integer(int32), intent(in) :: whole(:)  !! Whole numbers: (n_joint_whole)
      real(wp), intent(in) :: number(:)       !! Numbers: (n_joint_number)
      real(wp), parameter :: rounding = 1.0e-9_wp
      real(wp) :: edge(2, 2)
      integer :: block(2)

      is_joint = all(whole(:3) == 1 .or. whole(:3) == 2) &
         & .and. all(whole(4:7) >= 1 .and. whole(4:7) <= size(outline%block)) &
         & .and. all(number(1:5) >= 0.0_wp) .and. abs(sum(number(4:5)) - 1.0_wp) <= rounding
      if (.not. is_joint) return
      block = blocks_of(outline, whole, 1)
      is_joint = block(1) /= block(2) .and. any(system%equation(block) > 0) &
         & .and. all(block == blocks_of(outline, whole, 2))
      edge = system%moved(:, outline%next(whole(6:7))) - system%moved(:, whole(6:7))
      is_joint = is_joint &
         & .and. (whole(2) == whole(3) .or. dot_product(edge(:, 1), edge(:, 2)) < 0.0_wp)
   end function is_joint

   !> The two blocks that a contact is of
   pure function blocks_of(outline, whole, k) result(block)
      type(outline_t), intent(in) :: outline
      integer(int32), intent(in) :: whole(:)
      integer, intent(in) :: k  !! Number among its contacts
      integer :: block(2)       !! First and second block of the joint: (2)

      block(whole(1 + k)) = outline%block(whole(5 + k))
      block(3 - whole(1 + k)) = outline%block(whole(3 + k))
   end function blocks_of
end submodule dda_restart_blocks
