!> Blocks that were cut from lines: polygons, what they are made of, what acts on them, and which
!> edges lie together
module dda_cut_model
   use dda_cut_report, only : cut_remarks_t
   use dda_cut_scale, only : cut_scale_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: cut_bolt_t, cut_model_t, block_point_t, edge_pair_t, point_kind, point_kind_enum
   public :: block_vertices

   !> What a point of a block is for
   type :: point_kind_enum
      !> It is held
      integer :: fixed = 1
      !> A force acts there
      integer :: load = 2
      !> It is followed
      integer :: measured = 3
   end type point_kind_enum

   !> Names of the kinds
   type(point_kind_enum), parameter :: point_kind = point_kind_enum()

   !> A point that belongs to a block
   type :: block_point_t
      !> One of point_kind
      integer :: kind = 0
      !> Number of the block
      integer :: block = 0
      !> Number of the point, or of the fixed line, among those of its kind in the file
      integer :: source = 0
      !> Where it is, from the origin of the cut: (2) [m]
      real(wp) :: place(2) = 0.0_wp
   end type block_point_t

   !> Two edges of two blocks that lie together, wholly or in part
   type :: edge_pair_t
      !> Block and edge on the left of the line as it was drawn, block and edge on its right: (4)
      integer :: side(4) = 0
      !> Material of the joint
      integer :: joint = 0
      !> Ends of the part in common, along the first block's edge: (4) [m]
      real(wp) :: place(4) = 0.0_wp
   end type edge_pair_t

   !> A bolt between two blocks
   type :: cut_bolt_t
      !> The blocks, 0 for the ground: (2)
      integer :: block(2) = 0
      !> Its ends, from the origin of the cut: (4) [m]
      real(wp) :: place(4) = 0.0_wp
      !> Stiffness, strength and prestress, below 0 where the analysis file says them: (3)
      real(wp) :: property(3) = 0.0_wp
      !> Line of the file
      integer :: row = 0
   end type cut_bolt_t

   !> The blocks
   type :: cut_model_t
      !> Scales of the cut; its origin is what all coordinates here are counted from
      type(cut_scale_t) :: scale
      !> First vertex of each block, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Corners, anticlockwise: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Joint material of the edge from each vertex to the next: (n_vertex)
      integer, allocatable :: edge_joint(:)
      !> Area of each block: (n_block) [m2]
      real(wp), allocatable :: area(:)
      !> Material of each block: (n_block)
      integer, allocatable :: material(:)
      !> Fixed points, then load points, then measured points: (n_point)
      type(block_point_t), allocatable :: point(:)
      !> Bolts: (n_bolt)
      type(cut_bolt_t), allocatable :: bolt(:)
      !> Edges that lie together: (n_pair)
      type(edge_pair_t), allocatable :: pair(:)
      !> What was dropped
      type(cut_remarks_t) :: remarks
      !> Crossings that became a node that was there already at another place
      integer :: n_merged = 0
      !> Bolts left out, as both ends lie in one block
      integer :: n_idle_bolts = 0
      !> Blocks taken out because of hole points
      integer :: n_removed = 0
   end type cut_model_t

contains

   !> Corners of one block
   pure function block_vertices(cut, block) result(vertex)
      type(cut_model_t), intent(in) :: cut
      !> Number of the block
      integer, intent(in) :: block
      !> Its corners, anticlockwise: (2, n) [m]
      real(wp), allocatable :: vertex(:, :)

      allocate (vertex, source=cut%vertex(:, cut%first_vertex(block): &
         & cut%first_vertex(block + 1) - 1))
   end function block_vertices
end module dda_cut_model
