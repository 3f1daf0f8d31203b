!> Joints between blocks as flat arrays on a graph: blocks are nodes, joints are edges
!>
!> A joint carries two normal forces N1, N2 at its corners and one shear force T; forces that
!> separate the blocks are positive. Its three rows give both its opening and slip by block motion,
!> and the action of its forces on the blocks:
!>
!>    (opening 1, opening 2, slip) = sum over both blocks of row' * motion
!>    force on block s             = sum over k of row(:, k, s) * force(k)
!>
!> The graph has no polygons, materials or time, so it is the same for arches, walls, rings and
!> slopes.
module dda_joint_graph
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_graph_t, joint_kind, joint_kind_enum
   public :: add_joint_forces, breaks, crushes, joint_motion, keep_joints, open_joints
   public :: push_blocks, rubs, take_over, unit_of_length

   !> Kinds of joints by their admissible forces
   type :: joint_kind_enum
      integer :: contact = 1         !! Two corners: N1 >= 0, N2 >= 0, |T| <= friction*(N1 + N2)
      integer :: no_slip = 2         !! Two corners that cannot slide: N1 >= 0, N2 >= 0, any T
      integer :: corner = 3          !! One corner: N1 >= 0, |T| <= friction*N1, N2 = 0
      integer :: corner_no_slip = 4  !! One corner that cannot slide: N1 >= 0, any T, N2 = 0
      integer :: pin = 5             !! A restrained point: any N1 and any T, N2 = 0
      integer :: mirror = 6          !! A plane of symmetry: any N1 and N2, T = 0
      integer :: strip = 9           !! Column of a joint that crushes, without forces
   end type joint_kind_enum

   !> Names of the kinds
   type(joint_kind_enum), parameter :: joint_kind = joint_kind_enum()

   !> Joints of an assembly
   type :: joint_graph_t
      integer :: n_block = 0  !! Number of movable blocks
      !> The two blocks of each joint, 0 for a fixed one: (2, n_joint)
      integer, allocatable :: block(:, :)
      !> Opening at corner 1, at corner 2, and slip by unit motion of each block:
      !> (3, 3, 2, n_joint) [1, 1, m]
      real(wp), allocatable :: row(:, :, :, :)
      integer, allocatable :: kind(:)       !! Kind of each joint, one of joint_kind: (n_joint)
      real(wp), allocatable :: friction(:)  !! Coefficient of friction; 0 if none: (n_joint)
      real(wp), allocatable :: length(:)    !! Length of the joint: (n_joint) [m]
      !> Compressive strength times length; huge for a joint that cannot crush; unallocated if there
      !> are no others: (n_joint) [N/m]
      real(wp), allocatable :: crush(:)
      !> Tensile strength of each corner of an intact joint; unallocated if no joint has tensile
      !> strength or cohesion: (2, n_joint) [N/m]
      real(wp), allocatable :: pull(:, :)
      !> Cohesion times length at each corner of an intact joint; likewise: (2, n_joint) [N/m]
      real(wp), allocatable :: cohesion(:, :)
      !> Displacement per unit force at either corner and along the joint: (n_joint) [m2/N]
      real(wp), allocatable :: compliance(:)
      !> Initial opening of the corners, unallocated if zero: (2, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Mass and moment of inertia of each block, for mass-proportional damping: (3, n_block)
      real(wp), allocatable :: mass(:, :)
      !> Strength of yielding bars. Each has its own node after the blocks, with this
      !> load: (n_node) [N]
      real(wp), allocatable :: bound(:)
   end type joint_graph_t

   !> Coefficient of friction (89.9 degrees) from which a closed joint does not slide
   real(wp), parameter :: rough = 572.9_wp

contains

   !> True if friction can limit the shear force of a joint: only then do Coulomb friction and the
   !> associated rule differ
   elemental logical function rubs(kind, friction)
      integer, intent(in) :: kind       !! Kind of the joint, one of joint_kind
      real(wp), intent(in) :: friction  !! Its coefficient of friction

      rubs = (kind == joint_kind%contact .or. kind == joint_kind%corner) &
         & .and. friction > 0.0_wp .and. friction < rough
   end function rubs

   !> Half the mean length of the joints; 1 without joints
   pure real(wp) function unit_of_length(graph) result(unit)
      type(joint_graph_t), intent(in) :: graph

      unit = 1.0_wp
      if (any(graph%length > 0.0_wp)) unit = 0.5_wp*sum(graph%length, graph%length > 0.0_wp) &
         & /real(count(graph%length > 0.0_wp), wp)
   end function unit_of_length

   !> True if sliding or opening reduces the strength of a joint
   pure logical function breaks(graph)
      type(joint_graph_t), intent(in) :: graph

      breaks = allocated(graph%cohesion)
   end function breaks

   !> True if a joint may be crushed
   pure logical function crushes(graph)
      type(joint_graph_t), intent(in) :: graph

      crushes = allocated(graph%crush)
      if (crushes) crushes = any(graph%crush < huge(1.0_wp))
   end function crushes

   !> Keep selected joints
   pure subroutine keep_joints(kept, graph)
      logical, intent(in) :: kept(:)  !! True for joints to keep: (n_joint)
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

   !> Move the joints of a graph; the source keeps only kinds, bounds and the number of blocks
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

   !> The same for arrays of explicit shape, here and below, whose loops the compiler unrolls
   pure subroutine open_joints(n_joint, block, row, motion, opening)
      integer, intent(in) :: n_joint            !! Number of joints
      integer, intent(in) :: block(2, n_joint)  !! Blocks of each joint: (2, n_joint)
      !> Opening and slip by unit motion of each block: (3, 3, 2, n_joint)
      real(wp), intent(in) :: row(3, 3, 2, n_joint)
      real(wp), intent(in), contiguous :: motion(:, :)  !! Motion of the blocks: (3, n_block)
      real(wp), intent(out) :: opening(3, n_joint)      !! Opening 1, opening 2, slip: (3, n_joint)
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

   !> Add the action of joint forces on the blocks
   pure subroutine add_joint_forces(graph, force, load)
      type(joint_graph_t), intent(in) :: graph
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(in), contiguous :: force(:, :)
      !> Forces on the blocks, incremented here: (3, n_block) [N/m, N/m, N]
      real(wp), intent(inout), contiguous :: load(:, :)

      call push_blocks(size(graph%block, 2), graph%block, graph%row, force, load)
   end subroutine add_joint_forces

   !> The same for arrays of explicit shape
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
