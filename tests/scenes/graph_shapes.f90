!> Small joint graphs whose limits are found by hand
module graph_shapes
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use graph_wall, only : add_joint
   implicit none
   private

   public :: new_graph, new_tower, new_wedge

contains

   !> A graph without numbers
   pure subroutine new_graph(n_block, n_joint, graph)
      integer, intent(in) :: n_block  !! Blocks that can move
      integer, intent(in) :: n_joint  !! Joints
      type(joint_graph_t), intent(out) :: graph

      graph%n_block = n_block
      allocate (graph%block(2, n_joint), graph%kind(n_joint), source=0)
      allocate (graph%row(3, 3, 2, n_joint), graph%friction(n_joint), source=0.0_wp)
      allocate (graph%length(n_joint), graph%gap(2, n_joint), source=0.0_wp)
      allocate (graph%compliance(n_joint), graph%mass(3, n_block), source=1.0_wp)
   end subroutine new_graph

   !> Blocks of unit height one upon the other
   pure subroutine new_tower(n, width, friction, graph)
      integer, intent(in) :: n          !! Number of blocks
      real(wp), intent(in) :: width     !! Their width
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(joint_graph_t), intent(out) :: graph
      real(wp) :: centre(2, n)
      integer :: b

      call new_graph(n, n, graph)
      centre = reshape([(0.0_wp, real(b, wp) - 0.5_wp, b=1, n)], [2, n])
      do b = 1, n
         call add_joint(graph, centre, b, [b - 1, b], [0.5_wp*width, real(b - 1, wp)], &
            & [-0.5_wp*width, real(b - 1, wp)], friction)
      end do
   end subroutine new_tower

   !> A triangle of height one whose tip points down into a right-angled notch
   pure subroutine new_wedge(friction, graph)
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(joint_graph_t), intent(out) :: graph
      real(wp), parameter :: centre(2, 1) = reshape([0.0_wp, 2.0_wp/3.0_wp], [2, 1])

      call new_graph(1, 2, graph)
      call add_joint(graph, centre, 1, [0, 1], [0.0_wp, 0.0_wp], [-1.0_wp, 1.0_wp], friction)
      call add_joint(graph, centre, 2, [0, 1], [1.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], friction)
   end subroutine new_wedge
end module graph_shapes
