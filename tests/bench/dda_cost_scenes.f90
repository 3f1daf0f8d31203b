!> Scenes by which the cost of a step is measured: walls in running bond and loose blocks
module dda_cost_scenes
   use dda_block_scene, only : base_t, block_scene
   use dda_block_input, only : block_plan_t, new_plan
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_settings, only : flow_rule
   implicit none
   private

   public :: wall, loose_blocks

   !> Length and height of a brick: (2) [m]
   real(wp), parameter :: brick(2) = [0.25_wp, 0.125_wp]
   !> Friction angle of the joints, and no other strength: (3) [deg, Pa, Pa]
   real(wp), parameter :: law(3) = [35.0_wp, 0.0_wp, 0.0_wp]
   !> Loose blocks lie apart by this share of their size
   real(wp), parameter :: apart = 0.06_wp
   !> Loose blocks are turned by up to this angle [rad]
   real(wp), parameter :: tilt = 0.02_wp

contains

   !> A dry wall in running bond at rest on a fixed floor
   subroutine wall(courses, columns, dynamic, current, scene)
      integer, intent(in) :: courses  !! Courses
      !> Bricks in every other course; in between one more, the outer two of half the length
      integer, intent(in) :: columns
      logical, intent(in) :: dynamic  !! True if velocities are kept
      logical, intent(in) :: current  !! True if blocks move
      type(scene_t), intent(out) :: scene
      type(block_plan_t) :: plan
      real(wp) :: left, right
      integer :: i, j, n

      n = courses*columns + courses/2
      call empty_plan(n + 1, plan)
      call put_brick(plan, 1, [0.0_wp, -brick(2)], [columns*brick(1), brick(2)], 0.0_wp)
      n = 1
      do j = 1, courses
         do i = 1, columns + merge(1, 0, modulo(j, 2) == 0)
            left = max(0.0_wp, real(i - 1, wp) - merge(0.5_wp, 0.0_wp, modulo(j, 2) == 0))
            right = min(real(columns, wp), real(i, wp) &
               & - merge(0.5_wp, 0.0_wp, modulo(j, 2) == 0))
            n = n + 1
            call put_brick(plan, n, [left, real(j - 1, wp)]*brick, [right - left, 1.0_wp]*brick, &
               & 0.0_wp)
         end do
      end do
      call make_scene(plan, dynamic, current, scene)
   end subroutine wall

   !> Blocks a little turned and apart, one above the other, that fall upon one another
   subroutine loose_blocks(columns, dynamic, scene)
      integer, intent(in) :: columns  !! Columns of blocks, and their number in each
      logical, intent(in) :: dynamic  !! True if velocities are kept
      type(scene_t), intent(out) :: scene
      type(block_plan_t) :: plan
      real(wp) :: pitch(2), shift
      integer :: i, j, n

      pitch = brick*(1.0_wp + apart)
      call empty_plan(columns**2 + 1, plan)
      call put_brick(plan, 1, [-brick(1), -2.0_wp*brick(2)], &
         & [(columns + 3)*pitch(1), 2.0_wp*brick(2) - tilt*brick(1)], 0.0_wp)
      n = 1
      do j = 1, columns
         shift = merge(0.5_wp, 0.0_wp, modulo(j, 2) == 0)
         do i = 1, columns
            n = n + 1
            call put_brick(plan, n, [i - 1 + shift, real(j - 1, wp)]*pitch, brick, &
               & tilt*sin(real(n, wp)**2))
         end do
      end do
      call make_scene(plan, dynamic, .true., scene)
   end subroutine loose_blocks

   !> A plan of quadrilaterals, the first of which is fixed
   subroutine empty_plan(n, plan)
      integer, intent(in) :: n  !! Number of blocks
      type(block_plan_t), intent(out) :: plan
      integer :: b

      call new_plan(plan)
      plan%first_vertex = [(4*b - 3, b=1, n + 1)]
      plan%fixed = [(b == 1, b=1, n)]
      plan%material = spread(1, 1, n)
      deallocate (plan%vertex)
      allocate (plan%vertex(2, 4*n))
   end subroutine empty_plan

   !> Put a rectangle into a plan
   subroutine put_brick(plan, b, corner, size, angle)
      type(block_plan_t), intent(inout) :: plan
      integer, intent(in) :: b           !! Number of the block
      real(wp), intent(in) :: corner(2)  !! Lower left corner: (2) [m]
      real(wp), intent(in) :: size(2)    !! Length and height: (2) [m]
      real(wp), intent(in) :: angle      !! Angle by which it is turned about its centre [rad]
      real(wp) :: arm(2, 4)
      integer :: v

      arm = reshape([-1, -1, 1, -1, 1, 1, -1, 1], [2, 4])/2.0_wp
      do v = 1, 4
         arm(:, v) = arm(:, v)*size
         plan%vertex(:, 4*b - 4 + v) = corner + size/2.0_wp + cos(angle)*arm(:, v) &
            & + sin(angle)*[-arm(2, v), arm(1, v)]
      end do
   end subroutine put_brick

   !> The scene of a plan
   subroutine make_scene(plan, dynamic, current, scene)
      type(block_plan_t), intent(in) :: plan
      logical, intent(in) :: dynamic  !! True if velocities are kept
      logical, intent(in) :: current  !! True if blocks move
      type(scene_t), intent(out) :: scene
      type(base_t) :: base

      base%unit_weight = base%material%density*base%gravity
      base%law(:3) = law
      scene%settings%dynamic = dynamic
      scene%settings%current = current
      scene%settings%flow = merge(flow_rule%coulomb, flow_rule%associated, dynamic)
      scene%settings%time_step = merge(1.0e-3_wp, 0.0_wp, dynamic)
      scene%settings%duration = merge(1.0e3_wp, 0.0_wp, dynamic)
      call block_scene(plan, base, scene)
   end subroutine make_scene
end module dda_cost_scenes
