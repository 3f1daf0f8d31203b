!> Dry walls as joint graphs: courses of bricks on ground that cannot move
module graph_wall
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   implicit none
   private

   public :: new_wall, new_steps_wall, lay_courses, add_joint, wide_springs

   !> Length of a brick in running bond; its height is 1
   real(wp), parameter :: brick = 2.0_wp

contains

   !> A wall in running bond: bricks of 2 by 1, half bricks at the ends of every other course
   pure subroutine new_wall(units, courses, friction, graph, weight, push)
      integer, intent(in) :: units      !! Bricks of a course
      integer, intent(in) :: courses    !! Courses
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(joint_graph_t), intent(out) :: graph
      real(wp), allocatable, intent(out) :: weight(:, :)  !! Weight of each brick: (3, n_block)
      real(wp), allocatable, intent(out) :: push(:, :)    !! The same to the right: (3, n_block)
      real(wp) :: head(0:units + 1, courses)
      integer :: bricks(courses), c, i

      do c = 1, courses
         bricks(c) = units + merge(0, 1, modulo(c, 2) == 1)
         head(:units, c) = [(brick*real(i, wp), i=0, units)]
         if (modulo(c, 2) == 0) head(:, c) = [0.0_wp, head(1:units, c) - 0.5_wp*brick, &
            & brick*real(units, wp)]
      end do
      call lay_courses(bricks, head, [(real(i, wp), i=0, courses)], friction, graph, weight, push)
   end subroutine new_wall

   !> 25 bricks with a stepped edge, of unequal lengths and heights
   pure subroutine new_steps_wall(friction, graph, weight, push)
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(joint_graph_t), intent(out) :: graph
      real(wp), allocatable, intent(out) :: weight(:, :)  !! Weight of each brick: (3, 25)
      real(wp), allocatable, intent(out) :: push(:, :)    !! The same to the right: (3, 25)
      real(wp), parameter :: left = 0.0_wp, right = 2.980916829816682_wp
      real(wp), parameter :: level(6) = [0.0_wp, 0.25011638446681367_wp, 0.6035971503472201_wp, &
         & 0.9749743829203876_wp, 1.2410130403590103_wp, 1.517347052446026_wp]
      real(wp), parameter :: head(6, 5) = reshape([ &
         & left, 0.5089523954134982_wp, 1.2388459559879001_wp, 1.827618849894751_wp, &
         & 2.4257714090172513_wp, right, &
         & left, 0.6142516297443784_wp, 1.0694881756074128_wp, 1.6225493687385708_wp, &
         & 2.3021361816127768_wp, right, &
         & left, 0.7044509932098935_wp, 1.3241338304571888_wp, 2.0237411962082708_wp, &
         & 2.525284371631284_wp, right, &
         & left, 0.562420228449706_wp, 1.0033293198816453_wp, 1.5847961194834055_wp, &
         & 2.2154233982001355_wp, right, &
         & left, 0.719151459463523_wp, 1.2096433760125158_wp, 1.8923473256720063_wp, &
         & 2.3078308962081757_wp, right], [6, 5])

      call lay_courses([5, 5, 5, 5, 5], head, level, friction, graph, weight, push)
   end subroutine new_steps_wall

   !> Courses of bricks whose unit area has unit weight and unit mass; joints have unit compliance
   pure subroutine lay_courses(bricks, head, level, friction, graph, weight, push)
      integer, intent(in) :: bricks(:)  !! Bricks of each course: (n)
      !> Ends of the bricks of each course from left to right: (maxval(bricks) + 1, n)
      real(wp), intent(in) :: head(0:, :)
      !> Height of the ground and of the top of each course: (n + 1)
      real(wp), intent(in) :: level(0:)
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(joint_graph_t), intent(out) :: graph
      real(wp), allocatable, intent(out) :: weight(:, :)  !! Weight of each brick: (3, n_block)
      real(wp), allocatable, intent(out) :: push(:, :)    !! The same to the right: (3, n_block)
      real(wp), allocatable :: centre(:, :)
      real(wp) :: area, size_of(2)
      integer :: b, c, k, most

      graph%n_block = sum(bricks)
      allocate (centre(2, graph%n_block), weight(3, graph%n_block), push(3, graph%n_block))
      allocate (graph%mass(3, graph%n_block))
      weight = 0.0_wp
      push = 0.0_wp
      b = 0
      do c = 1, size(bricks)
         do k = 1, bricks(c)
            b = b + 1
            size_of = [head(k, c) - head(k - 1, c), level(c) - level(c - 1)]
            area = product(size_of)
            centre(:, b) = [0.5_wp*(head(k, c) + head(k - 1, c)), 0.5_wp*(level(c) + level(c - 1))]
            weight(2, b) = -area
            push(1, b) = area
            graph%mass(:, b) = area*[1.0_wp, 1.0_wp, sum(size_of**2)/12.0_wp]
         end do
      end do
      most = 3*sum(bricks) + size(bricks)
      allocate (graph%block(2, most), graph%row(3, 3, 2, most), graph%kind(most))
      allocate (graph%friction(most), graph%length(most), graph%compliance(most))
      allocate (graph%gap(2, most))
      call lay_joints(bricks, head, level, friction, centre, graph)
   end subroutine lay_courses

   !> Joints between bricks of a course, under the first course, and between courses
   pure subroutine lay_joints(bricks, head, level, friction, centre, graph)
      integer, intent(in) :: bricks(:)  !! Bricks of each course: (n)
      !> Ends of the bricks of each course from left to right: (maxval(bricks) + 1, n)
      real(wp), intent(in) :: head(0:, :)
      !> Height of the ground and of the top of each course: (n + 1)
      real(wp), intent(in) :: level(0:)
      real(wp), intent(in) :: friction             !! Coefficient of friction
      real(wp), intent(in) :: centre(:, :)         !! Centres of gravity: (2, n_block)
      type(joint_graph_t), intent(inout) :: graph  !! Receives the joints
      real(wp) :: bed(2)
      integer :: below, c, first, j, k, under

      j = 0
      first = 0
      do c = 1, size(bricks)
         do k = 1, bricks(c) - 1
            j = j + 1
            call add_joint(graph, centre, j, [first + k, first + k + 1], [head(k, c), level(c - 1)], &
               & [head(k, c), level(c)], friction)
         end do
         under = c - 1
         below = 1
         k = 1
         do while (under > 0 .and. below <= bricks(max(1, under)) .and. k <= bricks(c))
            bed = [max(head(below - 1, under), head(k - 1, c)), min(head(below, under), head(k, c))]
            if (bed(2) > bed(1)) then
               j = j + 1
               call add_joint(graph, centre, j, [first - bricks(under) + below, first + k], &
                  & [bed(2), level(under)], [bed(1), level(under)], friction)
            end if
            if (head(below, under) < head(k, c)) then
               below = below + 1
            else
               k = k + 1
            end if
         end do
         do k = 1, merge(bricks(c), 0, c == 1)
            j = j + 1
            call add_joint(graph, centre, j, [0, k], [head(k, c), level(0)], &
               & [head(k - 1, c), level(0)], friction)
         end do
         first = first + bricks(c)
      end do
      call keep_joints(j, graph)
   end subroutine lay_joints

   !> Give back the room that no joint needs
   pure subroutine keep_joints(n, graph)
      integer, intent(in) :: n  !! Number of joints
      type(joint_graph_t), intent(inout) :: graph

      graph%block = graph%block(:, :n)
      graph%row = graph%row(:, :, :, :n)
      graph%kind = graph%kind(:n)
      graph%friction = graph%friction(:n)
      graph%length = graph%length(:n)
      graph%compliance = graph%compliance(:n)
      graph%gap = graph%gap(:, :n)
   end subroutine keep_joints

   !> Springs as soft as the blocks on both sides are wide, by unit length of the joint
   pure subroutine wide_springs(graph)
      type(joint_graph_t), intent(inout) :: graph  !! The joints; the mean of their compliance is 1
      integer :: j

      do j = 1, size(graph%kind)
         ! the moment of a unit shear force about a centre is its distance from the joint
         graph%compliance(j) = sum(abs(graph%row(3, 3, :, j)))/graph%length(j)
      end do
      graph%compliance = graph%compliance*real(size(graph%kind), wp)/sum(graph%compliance)
   end subroutine wide_springs

   !> One joint: the normal points from its first block to its second and lies to the right of the
   !> way from the first corner to the second
   pure subroutine add_joint(graph, centre, j, block, start, finish, friction)
      type(joint_graph_t), intent(inout) :: graph  !! Receives the joint
      real(wp), intent(in) :: centre(:, :)         !! Centres of gravity: (2, n_block)
      integer, intent(in) :: j                     !! Its number
      integer, intent(in) :: block(2)              !! Its blocks: (2)
      real(wp), intent(in) :: start(2)             !! First corner: (2)
      real(wp), intent(in) :: finish(2)            !! Second corner: (2)
      real(wp), intent(in) :: friction             !! Coefficient of friction
      real(wp) :: along(2), arm(2), direction(2, 3), point(2, 3)
      integer :: k, side

      along = (finish - start)/norm2(finish - start)
      direction = reshape([along(2), -along(1), along(2), -along(1), along], [2, 3])
      point = reshape([start, finish, 0.5_wp*(start + finish)], [2, 3])
      graph%block(:, j) = block
      graph%kind(j) = joint_kind%contact
      graph%friction(j) = friction
      graph%length(j) = norm2(finish - start)
      graph%compliance(j) = 1.0_wp
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
