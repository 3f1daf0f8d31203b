!> Loading paths of joint graphs that tests keep
module graph_path
   use dda_coulomb_law, only : coulomb_state_t
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_loading_path, only : apply_dead_load, follow_path, loading_path_t, new_path, path_rate_t, path_result_t
   implicit none
   private

   public :: begin_path, follow, path_walk_t

   !> Where a graph is on its path
   type :: path_walk_t
      type(loading_path_t) :: path
      type(coulomb_state_t) :: state  !! Load, forces and motion
      type(path_rate_t) :: rate       !! Rates of forces and motion with the load
      type(path_result_t) :: result   !! Outcome of the last piece of the path
   end type path_walk_t

contains

   !> The beginning of a path, under the dead load; nothing grows yet
   subroutine begin_path(graph, dead_load, walk)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: dead_load(:, :)  !! The load: (n_dof, n_block) [N/m, N/m, N ...]
      type(path_walk_t), intent(out) :: walk
      type(joint_graph_t) :: taken

      taken = graph
      call new_path(taken, dead_load, walk%path)
      call apply_dead_load(dead_load, walk%path, walk%state, walk%result)
      allocate (walk%rate%load(3, graph%n_block), walk%rate%opening(3, size(graph%kind)), source=0.0_wp)
   end subroutine begin_path

   !> Go on by so much of what grows
   subroutine follow(walk, h)
      type(path_walk_t), intent(inout) :: walk
      real(wp), intent(in) :: h  !! The share

      call follow_path(walk%path, walk%state, walk%rate, h, walk%result)
   end subroutine follow
end module graph_path
