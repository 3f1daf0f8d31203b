!> What touches, or may touch in the coming step (Shi: df04): edges whose boxes come near one
!> another are looked at pair of blocks by pair of blocks
module dda_contact_search
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_block_system, only : block_system_t
   use dda_box_tree, only : box_tree_t, least_nearby, least_values, new_box_tree
   use dda_contact_types, only : joint_t
   use dda_edge_pairs, only : edge_pairs_t, find_edge_pairs, remember_edge_pairs
   use dda_entrance, only : add_joints, joint_list_t, neighbourhood_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_outline, only : measure_edges, outline_of, outline_t
   use dda_parting_line, only : add_parted_joint
   implicit none
   private

   public :: joint_search_t, new_joint_search, forget_pairs, look_around, touching_joints
   public :: near_joints

   !> What a search needs of the scene, made once, and what it remembers
   type :: joint_search_t
      !> How the corners follow one another
      type(outline_t) :: outline
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), allocatable :: law(:, :)
      !> Where to look; joints do not depend on it
      type(edge_pairs_t) :: near
      !> Blocks that are not there, so that nothing meets them; unallocated if all are: (n_block)
      logical, allocatable :: absent(:)
   end type joint_search_t

   !> Gaps below this share of the smallest block's size, of the two and of those that lie between
   !> them, count as closed at the beginning
   real(wp), parameter :: touching = 1.0e-4_wp

contains

   !> Search for the joints of a system
   pure type(joint_search_t) function new_joint_search(system, law)
      type(block_system_t), intent(in) :: system
      !> Law of the joints between two materials: (n_material, n_material)
      type(joint_law_t), intent(in) :: law(:, :)

      new_joint_search%outline = outline_of(system)
      allocate (new_joint_search%law, source=law)
   end function new_joint_search

   !> Look everywhere again: blocks have come or gone
   pure subroutine forget_pairs(search)
      type(joint_search_t), intent(inout) :: search

      search%near = edge_pairs_t()
   end subroutine forget_pairs

   !> Joints of blocks that touch in the reference shape
   pure subroutine touching_joints(search, system, joint)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> The joints, in the order of their blocks: (n_joint)
      type(joint_t), allocatable, intent(out) :: joint(:)
      type(neighbourhood_t) :: near
      real(wp) :: reach(size(system%area))

      reach = touching*sqrt(system%area)
      near%vertex = system%vertex
      near%travel = 0.0_wp*system%vertex
      near%beginning = .true.
      allocate (near%closed(0))
      call find_joints(search, system, reach, near, joint, least_beside(system, reach))
   end subroutine touching_joints

   !> The least reach of all blocks that a block meets, its own among them: a sheet between two
   !> blocks is thicker than its own reach, not than theirs
   pure function least_beside(system, reach) result(least)
      type(block_system_t), intent(in) :: system
      !> How far each block can reach: (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> The least reach: (n_block) [m]
      real(wp) :: least(size(reach))
      real(wp) :: high(2, size(reach)), low(2, size(reach))
      real(wp), allocatable :: least_below(:)
      type(box_tree_t) :: tree
      integer :: b

      do b = 1, size(reach)
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            low(:, b) = minval(vertex, dim=2) - reach(b)
            high(:, b) = maxval(vertex, dim=2) + reach(b)
         end associate
      end do
      call new_box_tree(low, high, tree)
      call least_values(tree, reach, least_below)
      least = reach
      do b = 1, size(reach)
         call least_nearby(tree, least_below, low(:, b), high(:, b), least(b))
      end do
   end function least_beside

   !> Look around for edges that may come near one another in this step and those that follow
   pure subroutine look_around(search, system, reach)
      type(joint_search_t), intent(inout) :: search
      type(block_system_t), intent(in) :: system
      !> Most that the corners of each block may move in this step: (n_block) [m]
      real(wp), intent(in) :: reach(:)

      call remember_edge_pairs(search%outline, system%equation, system%area, system%moved, reach, &
         & search%near)
   end subroutine look_around

   !> Joints of blocks that touch where they are now, or come as near as they may in a step
   pure subroutine near_joints(search, system, travel, closed, reach, in_time, joint)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> How the corners are about to move; only directions and ratios count: (2, n_vertex) [m]
      real(wp), intent(in) :: travel(:, :)
      !> Keys of the contacts that were closed, rising: (n_closed)
      integer(int64), intent(in) :: closed(:)
      real(wp), intent(in) :: reach(:)
      !> Whether blocks move in time: then a line parts convex blocks
      logical, intent(in) :: in_time
      type(joint_t), allocatable, intent(out) :: joint(:)
      type(neighbourhood_t) :: near

      near%vertex = system%moved
      near%travel = travel
      if (in_time) near%ahead = system%moved + travel
      near%closed = closed
      call find_joints(search, system, reach, near, joint)
   end subroutine near_joints

   !> Drop the pairs of edges of blocks that are not there
   pure subroutine drop_absent(search, block, pair)
      type(joint_search_t), intent(in) :: search
      !> Block of each edge: (n_vertex)
      integer, intent(in) :: block(:)
      !> The pairs: (2, n_pair)
      integer, allocatable, intent(inout) :: pair(:, :)
      integer :: i

      pair = pair(:, pack([(i, i=1, size(pair, 2))], &
         & .not. (search%absent(block(pair(1, :))) .or. search%absent(block(pair(2, :))))))
   end subroutine drop_absent

   !> Joints of all pairs of blocks whose edges come near one another
   pure subroutine find_joints(search, system, reach, near, joint, beside)
      type(joint_search_t), intent(in) :: search
      type(block_system_t), intent(in) :: system
      !> How far each block can reach; of two the smaller counts at the beginning, later the sum:
      !> (n_block) [m]
      real(wp), intent(in) :: reach(:)
      !> Where the corners are; completed here
      type(neighbourhood_t), intent(inout) :: near
      type(joint_t), allocatable, intent(out) :: joint(:)
      !> Least reach beside each block; one that lies beside both counts at the beginning, too:
      !> (n_block) [m]
      real(wp), intent(in), optional :: beside(:)
      type(joint_list_t) :: list
      integer, allocatable :: pair(:, :)
      real(wp) :: far
      integer :: block(2), first, last, j

      near%outline = search%outline
      call measure_edges(near%vertex, near%outline)
      near%first_vertex = system%first_vertex
      call find_edge_pairs(search%near, search%outline, system%equation, near%vertex, reach, pair)
      if (allocated(search%absent)) call drop_absent(search, near%outline%block, pair)
      first = 1
      do while (first <= size(pair, 2))
         block = near%outline%block(pair(:, first))
         last = first
         do while (last < size(pair, 2))
            if (any(near%outline%block(pair(:, last + 1)) /= block)) exit
            last = last + 1
         end do
         far = sum(reach(block))
         if (present(beside)) far = min(minval(reach(block)), maxval(beside(block)))
         if (allocated(near%ahead) .and. all(near%outline%convex(block))) then
            call add_parted_joint(near, pair(:, first:last), far, list)
         else
            call add_joints(near, pair(:, first:last), far, list)
         end if
         first = last + 1
      end do
      allocate (joint(list%n))
      do j = 1, list%n
         joint(j) = list%joint(j)
         joint(j)%law = search%law(system%material(joint(j)%block(1)), &
            & system%material(joint(j)%block(2)))
      end do
   end subroutine find_joints
end module dda_contact_search
