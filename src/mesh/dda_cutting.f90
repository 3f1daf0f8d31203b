!> From lines to blocks (Shi: dc)
module dda_cutting
   use dda_cut_model, only : cut_model_t
   use dda_cut_points, only : give_materials, place_bolts, place_points, remove_holes
   use dda_cut_scale, only : cut_scale
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_crossings, only : crossings_t, find_crossings
   use dda_line_model, only : line_model_t
   use dda_line_network, only : join_crossings, network_t
   use dda_loop_blocks, only : blocks_of_loops
   use dda_mesh_check, only : check_areas, check_nesting
   use dda_network_loops, only : loops_t, trace_loops
   use dda_network_trim, only : cut_trees, drop_close_edges, drop_crossing_edges
   use dda_text, only : to_text
   implicit none
   private

   public :: cut_blocks

contains

   !> Cut lines into blocks, and give each block its material and its points
   pure subroutine cut_blocks(model, cut, error)
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(out) :: cut
      !> What keeps the lines from making blocks
      type(error_t), allocatable, intent(out) :: error
      type(network_t) :: network
      type(loops_t) :: loops

      call make_network(model, cut, network, error)
      if (allocated(error)) return
      call trace_loops(network, loops)
      call blocks_of_loops(network, loops, model%line%material(:model%line%n), cut)
      cut%n_merged = network%n_merged
      if (size(cut%area) == 0) call fatal_error(error, "expected lines that enclose a block, got " &
         & //to_text(model%line%n)//" that enclose none; join their ends", model%file, 1)
      if (.not. allocated(error)) call check_areas(loops, cut, model%file, error)
      if (.not. allocated(error)) call check_nesting(model, network, loops, cut, error)
      if (.not. allocated(error)) call remove_holes(model, cut, error)
      if (.not. allocated(error)) call give_materials(model, cut, error)
      if (.not. allocated(error)) call place_points(model, cut, error)
      if (.not. allocated(error)) call place_bolts(model, cut)
   end subroutine cut_blocks

   !> Nodes and edges that bound blocks (Shi: dc04 to dc06)
   pure subroutine make_network(model, cut, network, error)
      type(line_model_t), intent(in) :: model
      !> Receives the scales and what was dropped
      type(cut_model_t), intent(inout) :: cut
      type(network_t), intent(out) :: network
      type(error_t), allocatable, intent(out) :: error
      type(crossings_t) :: crossings
      real(wp), allocatable :: line(:, :)
      integer :: i, crossing(2)

      if (model%line%n > 0) cut%scale = cut_scale(model)
      if (.not. cut%scale%size > 0.0_wp) then
         call fatal_error(error, "expected at least one line with a length, got none; add it", &
            & model%file, 1)
         return
      end if
      allocate (line, source=model%line%place(:, :model%line%n))
      do i = 1, 4
         line(i, :) = line(i, :) - cut%scale%origin(2 - mod(i, 2))
      end do
      call find_crossings(line, cut%scale%reach, crossings, error)
      if (allocated(error)) then
         error%file = model%file
         return
      end if
      call join_crossings(line, model%n_boundary, cut%scale, crossings, network, cut%remarks)
      call cut_trees(network, cut%remarks)
      call drop_crossing_edges(network, cut%scale, cut%remarks, crossing)
      if (all(crossing > 0)) then
         call fatal_error(error, "expected boundary lines that do not cross between their nodes, " &
            & //"got lines "//to_text(crossing(1))//" and "//to_text(crossing(2)) &
            & //", which do; make the edge-node distance smaller", model%file, &
            & model%line%row(crossing(2)))
         return
      end if
      call drop_close_edges(network, cut%scale, cut%remarks)
      call cut_trees(network, cut%remarks)
   end subroutine make_network
end module dda_cutting
