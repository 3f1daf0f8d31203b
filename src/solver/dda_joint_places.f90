!> The matrix that couples the blocks of a joint graph, and the position of each joint in it
module dda_joint_places
   use dda_block_factor, only : block_factor_t, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_joint_graph, only : joint_graph_t
   implicit none
   private

   public :: lay_out_joints

contains

   !> Lay out the matrix and its factor
   pure subroutine lay_out_joints(graph, symmetric, matrix, factor, entry)
      type(joint_graph_t), intent(in) :: graph
      logical, intent(in) :: symmetric  !! Whether the matrix is
      type(block_matrix_t), intent(out) :: matrix
      type(block_factor_t), intent(out) :: factor
      !> Number of each joint's coupling, negative where the joint's second block has the rows, 0
      !> for joints that couple no blocks: (n_joint)
      integer, allocatable, intent(out) :: entry(:)
      logical :: couples(size(graph%block, 2))
      integer, allocatable :: pair(:, :)
      integer :: i

      couples = all(graph%block /= 0, 1) .and. graph%block(1, :) /= graph%block(2, :)
      pair = reshape(pack(graph%block, spread(couples, 1, 2)), [2, count(couples)])
      call set_pattern(matrix, 3, graph%n_block, pair, symmetric)
      call plan_factor(matrix, factor)
      entry = unpack([(merge(i, -i, matrix%pair(1, i) == pair(1, i)), i=1, size(pair, 2))], &
         & couples, spread(0, 1, size(couples)))
   end subroutine lay_out_joints
end module dda_joint_places
