!> Loading paths of joint graphs that tests keep
module graph_path
   use dda_coulomb_law, only : coulomb_state_t
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_loading_path, only : apply_dead_load, loading_path_t, new_path, path_rate_t, path_result_t
   implicit none
   private

   public :: begin_path, new_rate

contains

   !> A path and the state under the dead load
   subroutine begin_path(graph, dead_load, path, state, result)
      type(joint_graph_t), intent(in) :: graph
      !> The load: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: dead_load(:, :)
      type(loading_path_t), intent(out) :: path
      !> The state, where one was reached
      type(coulomb_state_t), intent(out) :: state
      !> How it went
      type(path_result_t), intent(out) :: result
      type(joint_graph_t) :: taken

      taken = graph
      call new_path(taken, dead_load, path)
      call apply_dead_load(dead_load, path, state, result)
   end subroutine begin_path

   !> Nothing grows
   subroutine new_rate(graph, rate)
      type(joint_graph_t), intent(in) :: graph
      !> Room for what grows
      type(path_rate_t), intent(out) :: rate

      allocate (rate%load(3, graph%n_block), rate%opening(3, size(graph%kind)), source=0.0_wp)
   end subroutine new_rate
end module graph_path
