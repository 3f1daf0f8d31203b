!> Where the joints of a graph have their numbers in a factor that is assembled in its own place
module dda_joint_places
   use dda_block_factor, only : block_factor_t, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_block_plan, only : coupling_places_t, list_places
   use dda_joint_graph, only : joint_graph_t
   implicit none
   private

   public :: lay_out_joints

contains

   !> Lay out the factor of a matrix that couples the blocks of each joint
   pure subroutine lay_out_joints(graph, symmetric, factor, places)
      type(joint_graph_t), intent(in) :: graph
      logical, intent(in) :: symmetric  !! Whether the matrix is
      type(block_factor_t), intent(out) :: factor
      type(coupling_places_t), intent(out) :: places
      type(block_matrix_t) :: pattern
      logical :: couples(size(graph%block, 2))
      integer, allocatable :: second(:), pair(:, :), place(:)

      couples = all(graph%block /= 0, 1) .and. graph%block(1, :) /= graph%block(2, :)
      pair = reshape(pack(graph%block, spread(couples, 1, 2)), [2, count(couples)])
      allocate (second, source=pair(2, :))
      call set_pattern(pattern, 3, graph%n_block, pair, symmetric)
      ! numbers are assembled in the factor
      deallocate (pair, pattern%diagonal, pattern%coupling, pattern%upper)
      call plan_factor(pattern, factor)
      allocate (places%diagonal(graph%n_block), place(size(second)))
      call list_places(factor%plan, places%diagonal, place)
      deallocate (factor%plan%first_given, factor%plan%given)
      places%coupling = unpack(place, couples, spread(0, 1, size(couples)))
      places%second_is_row = unpack(pattern%pair(1, :) == second, couples, .false.)
   end subroutine lay_out_joints
end module dda_joint_places
