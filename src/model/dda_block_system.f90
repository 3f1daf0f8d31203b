!> Blocks: shape, moments, motion, stress; state from step to step
module dda_block_system
   use dda_bar, only : bar_state_t
   use dda_kinds, only : wp
   use dda_material, only : material_t
   use dda_vector, only : area_moments, area_moments_t
   implicit none
   private

   public :: block_pose_t, block_system_t, n_unknown, new_block_system
   public :: begin_motion, forget_rest, move_system

   !> Unknowns of a deformable block: u0, v0, r0, ex, ey, gxy
   integer, parameter :: n_unknown = 6

   !> Where blocks are, and their stress
   type :: block_pose_t
      real(wp), allocatable :: moved(:, :)  !! Present corners: (2, n_vertex) [m]
      !> Total motion; in current geometry, strains refer to the frame that rotates with the
      !> block: (n_unknown, n_block) [m, m, rad, -, -, -]
      real(wp), allocatable :: motion(:, :)
      real(wp), allocatable :: stress(:, :)  !! Stress sx, sy, txy: (3, n_block) [Pa]
   end type block_pose_t

   !> Blocks as arrays; block b owns the vertices first_vertex(b) to first_vertex(b + 1) - 1. The
   !> pose, and the arrays from `velocity` on, are allocated only if blocks may have moved
   type, extends(block_pose_t) :: block_system_t
      !> First vertex of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Corners in the reference shape, counter-clockwise: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      real(wp), allocatable :: area(:)  !! Area: (n_block) [m2]
      !> Centre of gravity of the reference shape: (2, n_block) [m]
      real(wp), allocatable :: centroid(:, :)
      !> Central second moments Sxx, Syy, Sxy: (3, n_block) [m4]
      real(wp), allocatable :: second(:, :)
      real(wp), allocatable :: density(:)            !! Mass per volume: (n_block) [kg/m3]
      real(wp), allocatable :: unit_weight(:)        !! Weight per volume: (n_block) [N/m3]
      integer, allocatable :: material(:)            !! Number of the block's material: (n_block)
      type(material_t), allocatable :: materials(:)  !! Materials
      !> Number of the block in the equations; 0 for a block that cannot move: (n_block)
      integer, allocatable :: equation(:)
      logical, allocatable :: fixed(:)  !! Blocks that are always fixed: (n_block)
      !> Blocks that are not yet built or have been removed; unallocated if there are
      !> none: (n_block)
      logical, allocatable :: absent(:)
      !> Rates of the unknowns: (n_unknown, n_block) [1/s of the above]
      real(wp), allocatable :: velocity(:, :)
      !> Mean strain rate over the last dynamic step: (3, n_block) [1/s]
      real(wp), allocatable :: strain_rate(:, :)
      !> Mean acceleration in the last dynamic step, 0 if it ended at an impact or a reversal:
      !> (3, n_block) [m/s2, m/s2, rad/s2]
      real(wp), allocatable :: acceleration(:, :)
      !> Stress at zero strain, in the frame that rotates with the block: (3, n_block) [Pa]
      real(wp), allocatable :: initial_stress(:, :)
      !> States of the bars; unallocated without bars: (n_bar)
      type(bar_state_t), allocatable :: bar(:)
   end type block_system_t

contains

   !> Make blocks at rest and free of stress
   pure function new_block_system(first_vertex, vertex, fixed, material) result(system)
      !> First vertex of each block, and one past the last: (n_block + 1)
      integer, intent(in) :: first_vertex(:)
      real(wp), intent(in) :: vertex(:, :)  !! Corners, counter-clockwise: (2, n_vertex) [m]
      logical, intent(in) :: fixed(:)       !! Blocks that cannot move: (n_block)
      type(material_t), intent(in) :: material
      type(block_system_t) :: system
      type(area_moments_t) :: moments
      integer :: b, n, movable

      n = size(first_vertex) - 1
      allocate (system%first_vertex, source=first_vertex)
      allocate (system%vertex, source=vertex)
      allocate (system%fixed, source=fixed)
      allocate (system%materials(1))
      system%materials(1) = material
      allocate (system%area(n), system%centroid(2, n), system%second(3, n))
      allocate (system%density(n), system%unit_weight(n), system%material(n), system%equation(n))
      system%material = 1
      system%density = material%density
      system%unit_weight = 0.0_wp
      movable = 0
      do b = 1, n
         moments = area_moments(vertex(:, first_vertex(b):first_vertex(b + 1) - 1))
         system%area(b) = moments%area
         system%centroid(:, b) = moments%centroid
         system%second(:, b) = moments%second
         if (.not. fixed(b)) movable = movable + 1
         system%equation(b) = merge(0, movable, fixed(b))
      end do
      call begin_motion(system)
   end function new_block_system

   !> Allocate the arrays of the moving state, if missing
   pure subroutine begin_motion(system)
      type(block_system_t), intent(inout) :: system
      integer :: n

      if (allocated(system%motion)) return
      n = size(system%area)
      allocate (system%moved, source=system%vertex)
      allocate (system%motion(n_unknown, n), system%velocity(n_unknown, n), source=0.0_wp)
      allocate (system%stress(3, n), system%initial_stress(3, n), system%strain_rate(3, n), &
         & system%acceleration(3, n), source=0.0_wp)
   end subroutine begin_motion

   !> Deallocate the arrays of the moving state of blocks at rest and free of stress
   pure subroutine forget_rest(system)
      type(block_system_t), intent(inout) :: system

      if (any(abs(system%velocity) > 0.0_wp) .or. any(abs(system%stress) > 0.0_wp)) return
      deallocate (system%moved, system%motion, system%velocity, system%stress, &
         & system%initial_stress, system%strain_rate, system%acceleration)
   end subroutine forget_rest

   !> Move blocks without copying large arrays
   pure subroutine move_system(from, to)
      type(block_system_t), intent(inout) :: from  !! The blocks; large arrays are deallocated
      type(block_system_t), intent(inout) :: to
      type(block_system_t) :: large

      call move_large(from, large)
      to = from
      call move_large(large, to)
   end subroutine move_system

   !> Move the large arrays
   pure subroutine move_large(from, to)
      type(block_system_t), intent(inout) :: from, to

      call move_alloc(from%vertex, to%vertex)
      call move_alloc(from%moved, to%moved)
      call move_alloc(from%centroid, to%centroid)
      call move_alloc(from%second, to%second)
      call move_alloc(from%motion, to%motion)
      call move_alloc(from%velocity, to%velocity)
      call move_alloc(from%strain_rate, to%strain_rate)
      call move_alloc(from%acceleration, to%acceleration)
      call move_alloc(from%stress, to%stress)
      call move_alloc(from%initial_stress, to%initial_stress)
   end subroutine move_large

end module dda_block_system
