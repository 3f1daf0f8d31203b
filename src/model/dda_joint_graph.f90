!> Joints between blocks as flat arrays on a graph: blocks are nodes, joints are edges
!>
!> A joint carries two normal forces N1, N2 at its corners and one shear force T; forces that push
!> the blocks apart are positive. Its three rows are at once how it opens and slips when the blocks
!> move, and how its forces act on them:
!>
!>    (opening 1, opening 2, slip) = sum over both blocks of row' * motion
!>    force on block s             = sum over k of row(:, k, s) * force(k)
!>
!> Nothing here knows polygons, materials or time: arches, walls, rings and slopes are one thing.
module dda_joint_graph
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_graph_t, joint_kind, joint_kind_enum
   public :: add_joint_forces, breaks, crushes, joint_motion, keep_joints, open_joints
   public :: push_blocks, rubs, take_over, unit_of_length

   !> What a joint can carry
   type :: joint_kind_enum
      integer :: contact = 1         !! Two corners: N1 >= 0, N2 >= 0, |T| <= friction*(N1 + N2)
      integer :: no_slip = 2         !! Two corners that cannot slide: N1 >= 0, N2 >= 0, any T
      integer :: corner = 3          !! One corner: N1 >= 0, |T| <= friction*N1, N2 = 0
      integer :: corner_no_slip = 4  !! One corner that cannot slide: N1 >= 0, any T, N2 = 0
      integer :: pin = 5             !! A held point: any N1 and any T, N2 = 0
      integer :: mirror = 6          !! A plane of symmetry: any N1 and N2, T = 0
   end type joint_kind_enum

   !> Names of the kinds
   type(joint_kind_enum), parameter :: joint_kind = joint_kind_enum()

   !> Joints of an assembly
   type :: joint_graph_t
      !> Number of blocks that can move
      integer :: n_block = 0
      !> The two blocks of each joint, 0 for one that cannot move: (2, n_joint)
      integer, allocatable :: block(:, :)
      !> Opening at corner 1, at corner 2, and slip by unit motion of each block:
      !> (3, 3, 2, n_joint) [1, 1, m]
      real(wp), allocatable :: row(:, :, :, :)
      !> What each joint can carry, one of joint_kind: (n_joint)
      integer, allocatable :: kind(:)
      !> Coefficient of friction; 0 without: (n_joint)
      real(wp), allocatable :: friction(:)
      !> Length of the joint: (n_joint) [m]
      real(wp), allocatable :: length(:)
      !> Compressive strength times length; huge where the joint does not crush; unallocated where
      !> none does: (n_joint) [N/m]
      real(wp), allocatable :: crush(:)
      !> Tensile force that each corner of a whole joint carries, unallocated where none carries
      !> any nor has cohesion: (2, n_joint) [N/m]
      real(wp), allocatable :: pull(:, :)
      !> Cohesion times length that each corner has while it is whole; likewise: (2, n_joint) [N/m]
      real(wp), allocatable :: cohesion(:, :)
      !> Displacement by unit force at either corner and along the joint: (n_joint) [m2/N]
      real(wp), allocatable :: compliance(:)
      !> Opening of the corners where nothing has moved, unallocated where there is none:
      !> (2, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Mass and moment of inertia of each block, for motion damped by mass: (3, n_block)
      real(wp), allocatable :: mass(:, :)
      !> Strength of bars that yield: each has a node of its own behind the blocks, on which it
      !> pulls against that load: (n_node) [N]
      real(wp), allocatable :: bound(:)
   end type joint_graph_t

   !> Coefficient of friction (89.9 degrees) from which a closed joint does not slide
   real(wp), parameter :: rough = 572.9_wp

contains

   !> Whether a joint may slide against friction: under Coulomb friction that is another thing than
   !> under the associated rule
   elemental logical function rubs(kind, friction)
      integer, intent(in) :: kind       !! What the joint can carry, one of joint_kind
      real(wp), intent(in) :: friction  !! Its coefficient of friction

      rubs = (kind == joint_kind%contact .or. kind == joint_kind%corner) &
         & .and. friction > 0.0_wp .and. friction < rough
   end function rubs

   !> Half the mean length of the joints; one without joints
   pure real(wp) function unit_of_length(graph) result(unit)
      type(joint_graph_t), intent(in) :: graph

      unit = 1.0_wp
      if (any(graph%length > 0.0_wp)) unit = 0.5_wp*sum(graph%length, graph%length > 0.0_wp) &
         & /real(count(graph%length > 0.0_wp), wp)
   end function unit_of_length

   !> Whether a joint has strength that it loses where it slides or opens
   pure logical function breaks(graph)
      type(joint_graph_t), intent(in) :: graph

      breaks = allocated(graph%cohesion)
   end function breaks

   !> Whether a joint may be crushed
   pure logical function crushes(graph)
      type(joint_graph_t), intent(in) :: graph

      crushes = allocated(graph%crush)
      if (crushes) crushes = any(graph%crush < huge(1.0_wp))
   end function crushes

   !> Keep some of the joints
   pure subroutine keep_joints(kept, graph)
      logical, intent(in) :: kept(:)  !! Which: (n_joint)
      type(joint_graph_t), intent(inout) :: graph
      integer :: k(count(kept)), j

      k = pack([(j, j=1, size(kept))], kept)
      graph%block = graph%block(:, k)
      graph%row = graph%row(:, :, :, k)
      graph%kind = graph%kind(k)
      graph%friction = graph%friction(k)
      graph%length = graph%length(k)
      graph%compliance = graph%compliance(k)
      if (allocated(graph%gap)) graph%gap = graph%gap(:, k)
      if (allocated(graph%crush)) graph%crush = graph%crush(k)
      if (.not. breaks(graph)) return
      graph%pull = graph%pull(:, k)
      graph%cohesion = graph%cohesion(:, k)
   end subroutine keep_joints

   !> Take the joints of a graph over: what is left of it tells of kinds and of blocks alone
   pure subroutine take_over(from, to)
      type(joint_graph_t), intent(inout) :: from
      type(joint_graph_t), intent(out) :: to

      to%n_block = from%n_block
      to%kind = from%kind
      if (allocated(from%bound)) to%bound = from%bound
      call move_alloc(from%block, to%block)
      call move_alloc(from%row, to%row)
      call move_alloc(from%friction, to%friction)
      call move_alloc(from%length, to%length)
      call move_alloc(from%crush, to%crush)
      call move_alloc(from%pull, to%pull)
      call move_alloc(from%cohesion, to%cohesion)
      call move_alloc(from%compliance, to%compliance)
      call move_alloc(from%gap, to%gap)
      call move_alloc(from%mass, to%mass)
   end subroutine take_over

   !> Opening at both corners and slip of every joint
   pure subroutine joint_motion(graph, motion, opening)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in), contiguous :: motion(:, :)  !! Motion of the blocks: (3, n_block)
      !> Opening 1, opening 2, slip: (3, n_joint)
      real(wp), intent(out), contiguous :: opening(:, :)

      call open_joints(size(graph%block, 2), graph%block, graph%row, motion, opening)
   end subroutine joint_motion

   !> The same of some joints. Arrays are explicit here and below, for loops that the compiler
   !> unrolls
   pure subroutine open_joints(n_joint, block, row, motion, opening)
      integer, intent(in) :: n_joint            !! Number of joints
      integer, intent(in) :: block(2, n_joint)  !! Their blocks
      !> Opening and slip by unit motion of each block
      real(wp), intent(in) :: row(3, 3, 2, n_joint)
      real(wp), intent(in), contiguous :: motion(:, :)  !! Motion of the blocks: (3, n_block)
      real(wp), intent(out) :: opening(3, n_joint)      !! Opening 1, opening 2, slip
      real(wp) :: x(3), y(3)
      integer :: b, j, k, side

      do j = 1, n_joint
         y = 0.0_wp
         do side = 1, 2
            b = block(side, j)
            if (b == 0) cycle
            x = motion(:, b)
            !GCC$ unroll 3
            do k = 1, 3
               y(k) = y(k) + row(1, k, side, j)*x(1) + row(2, k, side, j)*x(2) + row(3, k, &
                  & side, j)*x(3)
            end do
         end do
         opening(:, j) = y
      end do
   end subroutine open_joints

   !> Add what joint forces do to the blocks
   pure subroutine add_joint_forces(graph, force, load)
      type(joint_graph_t), intent(in) :: graph
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(in), contiguous :: force(:, :)
      !> Forces on the blocks, to which theirs are added: (3, n_block) [N/m, N/m, N]
      real(wp), intent(inout), contiguous :: load(:, :)

      call push_blocks(size(graph%block, 2), graph%block, graph%row, force, load)
   end subroutine add_joint_forces

   !> The same of some joints
   pure subroutine push_blocks(n_joint, block, row, force, load)
      integer, intent(in) :: n_joint, block(2, n_joint)
      real(wp), intent(in) :: row(3, 3, 2, n_joint)
      real(wp), intent(in) :: force(3, n_joint)  !! N1, N2, T
      real(wp), intent(inout), contiguous :: load(:, :)
      integer :: b, d, j, side
      real(wp) :: f(3)

      do j = 1, n_joint
         f = force(:, j)
         do side = 1, 2
            b = block(side, j)
            if (b == 0) cycle
            !GCC$ unroll 3
            do d = 1, 3
               load(d, b) = load(d, b) + row(d, 1, side, j)*f(1) + row(d, 2, side, j)*f(2) &
                  & + row(d, 3, side, j)*f(3)
            end do
         end do
      end do
   end subroutine push_blocks
end module dda_joint_graph
