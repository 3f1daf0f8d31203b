!> Blocks before materials and laws are assigned: the input of a scene
module dda_block_input
   use dda_boundary, only : boundary_t
   use dda_kinds, only : wp
   use dda_settings, only : contact_tolerance
   use dda_water, only : water_t
   implicit none
   private

   public :: block_plan_t, material_plan_t, law_plan_t, most_materials, new_plan, unsupported_block

   !> Largest material number
   integer, parameter :: most_materials = 1000

   !> What a file says of a material; what it leaves out is that of the deck
   type :: material_plan_t
      integer :: number = 0  !! Number of the material, from 2; 1 is that of the deck
      !> Density, unit weight, Young's modulus, Poisson's ratio, compressive strength: (5)
      !> [kg/m3, N/m3, Pa, -, Pa]
      real(wp) :: value(5) = 0.0_wp
      logical :: given(5) = .false.  !! Which of them are given: (5)
   end type material_plan_t

   !> What a file says of the joints between two materials
   type :: law_plan_t
      integer :: material(2) = 0  !! Numbers of the two materials: (2)
      !> Friction angle, cohesion, tensile strength, friction angle of what has slid, slip over
      !> which strength goes: (5) [deg, Pa, Pa, deg, m]
      real(wp) :: value(5) = 0.0_wp
      logical :: given(5) = .false.  !! Which of them are given: (5)
      integer :: line = 0            !! Line of the file
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
      !> Blocks lie together within this share of the smaller one's size
      real(wp) :: tolerance = contact_tolerance
      !> Blocks that cannot move: (n_block)
      logical, allocatable :: fixed(:)
      !> Number of each block's material: (n_block)
      integer, allocatable :: material(:)
      !> Blocks that begin with a velocity or a stress: (n_start)
      integer, allocatable :: starts(:)
      !> Velocity of the centre, spin, and stress sx, sy, txy of each of them: (6, n_start)
      !> [m/s, m/s, rad/s, Pa, Pa, Pa]
      real(wp), allocatable :: start(:, :)
      !> Line of the file where each block begins: (n_block)
      integer, allocatable :: line(:)
      !> Materials beside that of the deck
      type(material_plan_t), allocatable :: materials(:)
      !> Laws beside that of the deck
      type(law_plan_t), allocatable :: laws(:)
      !> Water
      type(water_t), allocatable :: water(:)
      !> Points; they are seen from the origin of the plan too
      type(boundary_t) :: boundary
      !> Line of the file that moves the ground, 0 if there is none
      integer :: ground_line = 0
      !> Lengths and check sums of the records that the file names, each with a blank before it;
      !> unallocated without records
      character(len=:), allocatable :: record_marks
   end type block_plan_t

contains

   !> A plan without blocks
   pure subroutine new_plan(plan)
      type(block_plan_t), intent(out) :: plan

      allocate (plan%first_vertex(1), source=1)
      allocate (plan%vertex(2, 0), plan%fixed(0), plan%material(0), plan%starts(0))
      allocate (plan%start(6, 0), plan%line(0), plan%materials(0), plan%laws(0))
      allocate (plan%water(0))
   end subroutine new_plan

   !> The first movable block that no chain of joints ties to a fixed one; 0 if there is none
   pure integer function unsupported_block(fixed, pair)
      logical, intent(in) :: fixed(:)    !! Blocks that cannot move, or are held: (n_block)
      integer, intent(in) :: pair(:, :)  !! Blocks of each joint: (2, n_joint)
      integer :: leader(0:size(fixed)), b, j

      ! blocks with one leader are tied to one another, those that are fixed to the ground, block 0
      leader = [0, merge(0, [(b, b=1, size(fixed))], fixed)]
      do j = 1, size(pair, 2)
         call tie(leader, pair(1, j), pair(2, j))
      end do
      do unsupported_block = 1, size(fixed)
         b = unsupported_block
         call find_leader(leader, b)
         if (b > 0) return
      end do
      unsupported_block = 0
   end function unsupported_block

   !> Give the groups of two blocks one leader, the smaller of theirs
   pure subroutine tie(leader, first, second)
      !> A block that each follows, itself at the end: (0:n_block)
      integer, intent(inout) :: leader(0:)
      integer, intent(in) :: first   !! One block
      integer, intent(in) :: second  !! The other
      integer :: a, b

      a = first
      b = second
      call find_leader(leader, a)
      call find_leader(leader, b)
      leader(max(a, b)) = min(a, b)
   end subroutine tie

   !> Go from a block to its leader, and halve the way for those who come after (Tarjan 1975)
   pure subroutine find_leader(leader, block)
      integer, intent(inout) :: leader(0:)
      integer, intent(inout) :: block  !! The block in, its leader out

      do while (leader(block) /= block)
         leader(block) = leader(leader(block))
         block = leader(block)
      end do
   end subroutine find_leader
end module dda_block_input
