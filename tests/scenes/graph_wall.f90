!> Dry walls in running bond as joint graphs: bricks of 2 by 1, half bricks at the ends of every
!> other course, on ground that cannot move
module graph_wall
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   implicit none
   private

   public :: new_wall, add_joint

   !> Length of a brick; its height is 1
   real(wp), parameter :: brick = 2.0_wp

contains

   !> A wall of bricks whose unit area has unit weight and unit mass; joints have unit compliance
   pure subroutine new_wall(units, courses, friction, graph, weight, push)
      !> Bricks of a course
      integer, intent(in) :: units
      !> Courses
      integer, intent(in) :: courses
      !> Coefficient of friction
      real(wp), intent(in) :: friction
      !> The joints
      type(joint_graph_t), intent(out) :: graph
      !> Weight of each brick: (3, n_block)
      real(wp), allocatable, intent(out) :: weight(:, :)
      !> The same to the right: (3, n_block)
      real(wp), allocatable, intent(out) :: push(:, :)
      real(wp) :: head(0:units + 1, courses), area, width, bed(2)
      real(wp), allocatable :: centre(:, :)
      integer :: bricks(courses), first(courses), below, c, i, j, k, n_joint

      do c = 1, courses
         bricks(c) = units + merge(0, 1, modulo(c, 2) == 1)
         first(c) = merge(0, sum(bricks(:c - 1)), c == 1)
         head(:units, c) = [(brick*real(i, wp), i=0, units)]
         if (modulo(c, 2) == 0) head(:, c) = [0.0_wp, head(1:units, c) - 0.5_wp*brick, &
            & brick*real(units, wp)]
      end do
      graph%n_block = sum(bricks)
      allocate (centre(2, graph%n_block), weight(3, graph%n_block), push(3, graph%n_block))
      allocate (graph%mass(3, graph%n_block))
      weight = 0.0_wp
      push = 0.0_wp
      do c = 1, courses
         do k = 1, bricks(c)
            width = head(k, c) - head(k - 1, c)
            area = width
            centre(:, first(c) + k) = [0.5_wp*(head(k, c) + head(k - 1, c)), real(c, wp) - 0.5_wp]
            weight(2, first(c) + k) = -area
            push(1, first(c) + k) = area
            graph%mass(:, first(c) + k) = area*[1.0_wp, 1.0_wp, (width**2 + 1.0_wp)/12.0_wp]
         end do
      end do
      n_joint = sum(bricks) - courses + units + (courses - 1)*2*units
      allocate (graph%block(2, n_joint), graph%row(3, 3, 2, n_joint), graph%kind(n_joint))
      allocate (graph%friction(n_joint), graph%length(n_joint), graph%compliance(3, n_joint))
      allocate (graph%gap(2, n_joint))
      j = 0
      do c = 1, courses
         do k = 1, bricks(c) - 1
            j = j + 1
            call add_joint(graph, centre, j, [first(c) + k, first(c) + k + 1], &
               & [head(k, c), real(c, wp) - 1.0_wp], [head(k, c), real(c, wp)], friction)
         end do
         if (c == 1) then
            do k = 1, units
               j = j + 1
               call add_joint(graph, centre, j, [0, k], [head(k, c), 0.0_wp], &
                  & [head(k - 1, c), 0.0_wp], friction)
            end do
         else
            below = 1
            k = 1
            do while (below <= bricks(c - 1) .and. k <= bricks(c))
               bed = [max(head(below - 1, c - 1), head(k - 1, c)), &
                  & min(head(below, c - 1), head(k, c))]
               if (bed(2) > bed(1)) then
                  j = j + 1
                  call add_joint(graph, centre, j, [first(c - 1) + below, first(c) + k], &
                     & [bed(2), real(c - 1, wp)], [bed(1), real(c - 1, wp)], friction)
               end if
               if (head(below, c - 1) < head(k, c)) then
                  below = below + 1
               else
                  k = k + 1
               end if
            end do
         end if
      end do
   end subroutine new_wall

   !> One joint: the normal points from its first block to its second and lies to the right of the
   !> way from the first corner to the second
   pure subroutine add_joint(graph, centre, j, block, start, finish, friction)
      !> Receives the joint
      type(joint_graph_t), intent(inout) :: graph
      !> Centres of gravity: (2, n_block)
      real(wp), intent(in) :: centre(:, :)
      !> Its number
      integer, intent(in) :: j
      !> Its blocks: (2)
      integer, intent(in) :: block(2)
      !> First corner: (2)
      real(wp), intent(in) :: start(2)
      !> Second corner: (2)
      real(wp), intent(in) :: finish(2)
      !> Coefficient of friction
      real(wp), intent(in) :: friction
      real(wp) :: along(2), arm(2), direction(2, 3), point(2, 3)
      integer :: k, side

      along = (finish - start)/norm2(finish - start)
      direction = reshape([along(2), -along(1), along(2), -along(1), along], [2, 3])
      point = reshape([start, finish, 0.5_wp*(start + finish)], [2, 3])
      graph%block(:, j) = block
      graph%kind(j) = joint_kind%contact
      graph%friction(j) = friction
      graph%length(j) = norm2(finish - start)
      graph%compliance(:, j) = 1.0_wp
      graph%gap(:, j) = 0.0_wp
      graph%row(:, :, :, j) = 0.0_wp
      do side = 1, 2
         if (block(side) == 0) cycle
         do k = 1, 3
            arm = point(:, k) - centre(:, block(side))
            graph%row(:, k, side, j) = real(2*side - 3, wp)*[direction(:, k), &
               & arm(1)*direction(2, k) - arm(2)*direction(1, k)]
         end do
      end do
   end subroutine add_joint
end module graph_wall
