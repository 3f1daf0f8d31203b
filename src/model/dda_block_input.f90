!> Blocks as a user gives them, before materials and laws are known: what makes a scene
module dda_block_input
   use dda_boundary, only : boundary_t
   use dda_kinds, only : wp
   use dda_polygon, only : depth_in
   implicit none
   private

   public :: block_plan_t, material_plan_t, law_plan_t, new_plan, block_at
   public :: holds_point, rivals_at, unsupported_block

   !> What a file says of a material; what it leaves out is that of the deck
   type :: material_plan_t
      !> Number of the material, from 2; 1 is that of the deck
      integer :: number = 0
      !> Density, unit weight, Young's modulus, Poisson's ratio: (4) [kg/m3, N/m3, Pa, -]
      real(wp) :: value(4) = 0.0_wp
      !> Which of them are given: (4)
      logical :: given(4) = .false.
   end type material_plan_t

   !> What a file says of the joints between two materials
   type :: law_plan_t
      !> Numbers of the two materials: (2)
      integer :: material(2) = 0
      !> Friction angle, cohesion, tensile strength: (3) [deg, Pa, Pa]
      real(wp) :: value(3) = 0.0_wp
      !> Which of them are given: (3)
      logical :: given(3) = .false.
   end type law_plan_t

   !> Blocks and what is said of them
   type :: block_plan_t
      !> First corner of each block, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Corners, counter-clockwise, seen from the origin of the plan: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Where the origin of the plan is: not at zero where the blocks are far from it, so that
      !> coordinates keep their digits: (2) [m]
      real(wp) :: origin(2) = 0.0_wp
      !> Blocks that cannot move: (n_block)
      logical, allocatable :: fixed(:)
      !> Number of each block's material: (n_block)
      integer, allocatable :: material(:)
      !> Velocity of the centre and spin at the beginning: (3, n_block) [m/s, m/s, rad/s]
      real(wp), allocatable :: velocity(:, :)
      !> Stress sx, sy, txy at the beginning: (3, n_block) [Pa]
      real(wp), allocatable :: stress(:, :)
      !> Line of the file where each block begins: (n_block)
      integer, allocatable :: line(:)
      !> Materials beside that of the deck
      type(material_plan_t), allocatable :: materials(:)
      !> Laws beside that of the deck
      type(law_plan_t), allocatable :: laws(:)
      !> Points; they are seen from the origin of the plan too
      type(boundary_t) :: boundary
      !> Line of the file that moves the ground, 0 if there is none
      integer :: ground_line = 0
      !> What the user should know: (n)
      character(len=160), allocatable :: warning(:)
      !> Lines that the warnings speak of: (n)
      integer, allocatable :: warning_line(:)
   end type block_plan_t

   !> A point may lie outside its block by this share of the block's size: coordinates are rounded
   real(wp), parameter :: rounded = 1.0e-4_wp

contains

   !> A plan without blocks
   pure subroutine new_plan(plan)
      !> The plan
      type(block_plan_t), intent(out) :: plan

      allocate (plan%first_vertex(1), source=1)
      allocate (plan%vertex(2, 0), plan%fixed(0), plan%material(0), plan%velocity(3, 0))
      allocate (plan%stress(3, 0), plan%line(0), plan%materials(0), plan%laws(0))
      allocate (plan%warning(0), plan%warning_line(0))
   end subroutine new_plan

   !> Block that holds a point most deeply or has it on its outline; 0 if none does
   pure integer function block_at(plan, point)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> The point, seen from the origin of the plan: (2) [m]
      real(wp), intent(in) :: point(2)
      real(wp) :: deepest, depth
      integer :: b

      block_at = 0
      deepest = -huge(deepest)
      do b = 1, size(plan%fixed)
         depth = depth_of(plan, b, point)
         if (depth < -margin_of(plan, b) .or. .not. depth > deepest) cycle
         deepest = depth
         block_at = b
      end do
   end function block_at

   !> Blocks that have a point on their outlines together with a block, as far as rounding tells
   pure function rivals_at(plan, point, block) result(rival)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> The point, seen from the origin of the plan: (2) [m]
      real(wp), intent(in) :: point(2)
      !> The block, which holds it
      integer, intent(in) :: block
      !> The others: (n)
      integer, allocatable :: rival(:)
      real(wp) :: depth
      integer :: b

      depth = depth_of(plan, block, point)
      if (depth > margin_of(plan, block)) then
         allocate (rival(0))
      else
         rival = pack([(b, b=1, size(plan%fixed))], [(b /= block .and. is_rival(b), &
            & b=1, size(plan%fixed))])
      end if

   contains

      !> Whether a block has the point on its outline, too
      pure logical function is_rival(b)
         !> Number of the block
         integer, intent(in) :: b
         real(wp) :: margin

         margin = min(margin_of(plan, b), margin_of(plan, block))
         is_rival = depth <= margin .and. depth_of(plan, b, point) >= -margin
      end function is_rival
   end function rivals_at

   !> Whether a block holds a point or has it on its outline
   pure logical function holds_point(plan, b, point)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> Number of the block
      integer, intent(in) :: b
      !> The point, seen from the origin of the plan: (2) [m]
      real(wp), intent(in) :: point(2)

      holds_point = depth_of(plan, b, point) >= -margin_of(plan, b)
   end function holds_point

   !> How deep a point lies in a block, negative outside; far outside its box only that it does [m]
   pure real(wp) function depth_of(plan, b, point)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> Number of the block
      integer, intent(in) :: b
      !> The point, seen from the origin of the plan: (2) [m]
      real(wp), intent(in) :: point(2)
      real(wp) :: margin

      depth_of = -huge(depth_of)
      margin = margin_of(plan, b)
      associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
         if (any(point < minval(vertex, dim=2) - margin)) return
         if (any(point > maxval(vertex, dim=2) + margin)) return
         depth_of = depth_in(vertex, point)
      end associate
   end function depth_of

   !> How far outside a block a point may lie that is still on its outline [m]
   pure real(wp) function margin_of(plan, b)
      !> The plan
      type(block_plan_t), intent(in) :: plan
      !> Number of the block
      integer, intent(in) :: b

      associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
         margin_of = rounded*norm2(maxval(vertex, dim=2) - minval(vertex, dim=2))
      end associate
   end function margin_of

   !> The first movable block that no chain of joints ties to a fixed one; 0 if there is none
   pure integer function unsupported_block(fixed, pair)
      !> Blocks that cannot move, or are held: (n_block)
      logical, intent(in) :: fixed(:)
      !> Blocks of each joint: (2, n_joint)
      integer, intent(in) :: pair(:, :)
      logical :: tied(size(fixed)), grows
      integer :: j

      tied = fixed
      grows = .true.
      do while (grows)
         grows = .false.
         do j = 1, size(pair, 2)
            if (tied(pair(1, j)) .eqv. tied(pair(2, j))) cycle
            tied(pair(:, j)) = .true.
            grows = .true.
         end do
      end do
      unsupported_block = findloc(tied, .false., dim=1)
   end function unsupported_block
end module dda_block_input
