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

   !> Material properties given in a file; missing ones are those of the deck
   type :: material_plan_t
      integer :: number = 0  !! Number of the material, from 2; 1 is the material of the deck
      !> Density, unit weight, Young's modulus, Poisson's ratio, compressive strength: (5)
      !> [kg/m3, N/m3, Pa, -, Pa]
      real(wp) :: value(5) = 0.0_wp
      logical :: given(5) = .false.  !! True for given properties: (5)
   end type material_plan_t

   !> Properties of joints between two materials, given in a file
   type :: law_plan_t
      integer :: material(2) = 0  !! Numbers of the two materials: (2)
      !> Friction angle, cohesion, tensile strength, residual friction angle, slip over which
      !> strength is lost: (5) [deg, Pa, Pa, deg, m]
      real(wp) :: value(5) = 0.0_wp
      logical :: given(5) = .false.  !! True for given properties: (5)
      integer :: line = 0            !! Line of the file
   end type law_plan_t

   !> Blocks with their materials, joint laws and actions, as read
   type :: block_plan_t
      !> First corner of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Corners, counter-clockwise, relative to the origin of the plan: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Origin of the plan, near the blocks, so that coordinates far from zero keep their
      !> digits: (2) [m]
      real(wp) :: origin(2) = 0.0_wp
      !> Gap within which blocks touch, over the size of the smaller one
      real(wp) :: tolerance = contact_tolerance
      logical, allocatable :: fixed(:)     !! Blocks that cannot move: (n_block)
      integer, allocatable :: material(:)  !! Number of each block's material: (n_block)
      integer, allocatable :: starts(:)    !! Blocks with an initial velocity or stress: (n_start)
      !> Velocity of the centre, spin, and stress sx, sy, txy of each of them: (6, n_start)
      !> [m/s, m/s, rad/s, Pa, Pa, Pa]
      real(wp), allocatable :: start(:, :)
      integer, allocatable :: line(:)  !! Line of the file where each block begins: (n_block)
      !> Materials in addition to that of the deck
      type(material_plan_t), allocatable :: materials(:)
      type(law_plan_t), allocatable :: laws(:)  !! Joint laws in addition to that of the deck
      type(water_t), allocatable :: water(:)    !! Water
      !> Actions on points; coordinates relative to the origin of the plan
      type(boundary_t) :: boundary
      integer :: ground_line = 0  !! Line of the file with the ground motion, 0 if there is none
      !> Identifications of the records named in the file, each preceded by a blank; unallocated
      !> without records
      character(len=:), allocatable :: record_marks
   end type block_plan_t

contains

   !> Make a plan without blocks
   pure subroutine new_plan(plan)
      type(block_plan_t), intent(out) :: plan

      allocate (plan%first_vertex(1), source=1)
      allocate (plan%vertex(2, 0), plan%fixed(0), plan%material(0), plan%starts(0))
      allocate (plan%start(6, 0), plan%line(0), plan%materials(0), plan%laws(0))
      allocate (plan%water(0))
   end subroutine new_plan

   !> The first movable block without a chain of joints to a fixed one; 0 if there is none
   pure integer function unsupported_block(fixed, pair)
      logical, intent(in) :: fixed(:)    !! Blocks that are fixed or restrained: (n_block)
      integer, intent(in) :: pair(:, :)  !! Blocks of each joint: (2, n_joint)
      integer :: leader(0:size(fixed)), b, j

      ! blocks with the same leader are connected; fixed blocks belong to the ground, block 0
      leader = [0, merge(0, [(b, b=1, size(fixed))], fixed)]
      do j = 1, size(pair, 2)
         call join_groups(leader, pair(1, j), pair(2, j))
      end do
      do unsupported_block = 1, size(fixed)
         b = unsupported_block
         call find_leader(leader, b)
         if (b > 0) return
      end do
      unsupported_block = 0
   end function unsupported_block

   !> Merge the groups of two blocks; the smaller leader remains
   pure subroutine join_groups(leader, first, second)
      !> Next block towards the leader; a leader points to itself: (0:n_block)
      integer, intent(inout) :: leader(0:)
      integer, intent(in) :: first   !! One block
      integer, intent(in) :: second  !! The other
      integer :: a, b

      a = first
      b = second
      call find_leader(leader, a)
      call find_leader(leader, b)
      leader(max(a, b)) = min(a, b)
   end subroutine join_groups

   !> Find the leader of a block, with path halving (Tarjan 1975)
   pure subroutine find_leader(leader, block)
      integer, intent(inout) :: leader(0:)
      integer, intent(inout) :: block  !! The block on entry, its leader on return

      do while (leader(block) /= block)
         leader(block) = leader(leader(block))
         block = leader(block)
      end do
   end subroutine find_leader
end module dda_block_input
