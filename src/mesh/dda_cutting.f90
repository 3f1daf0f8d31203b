!> From lines to blocks (Shi: dc)
module dda_cutting
   use dda_cut_model, only : cut_model_t
   use dda_cut_points, only : block_around, block_boxes, boxes_t, give_materials, place_bolts, &
      & place_points, remove_holes
   use dda_cut_scale, only : cut_scale
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_crossings, only : crossings_t, find_crossings
   use dda_line_model, only : line_model_t
   use dda_line_network, only : join_crossings, network_t
   use dda_loop_blocks, only : blocks_of_loops
   use dda_network_loops, only : half_edge_start, loops_t, trace_loops
   use dda_network_trim, only : cut_trees, drop_close_edges, drop_crossing_edges
   use dda_polygon, only : contains_point
   use dda_text, only : to_text
   implicit none
   private

   public :: check_areas, cut_blocks

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

   !> Areas of blocks add up to those that the outer loops enclose (Shi: dc16, dc17)
   pure subroutine check_areas(loops, cut, file, error)
      !> All loops
      type(loops_t), intent(in) :: loops
      type(cut_model_t), intent(in) :: cut
      !> Name of the geometry file
      character(len=*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: enclosed, room

      enclosed = -sum(loops%area, loops%area < 0.0_wp)
      room = 1.0e-9_wp*enclosed + 10.0_wp*cut%scale%reach*cut%scale%size
      if (abs(sum(cut%area) - enclosed) <= room) return
      call fatal_error(error, "expected block areas that add up to the enclosed area " &
         & //to_text(enclosed)//", got "//to_text(sum(cut%area)) &
         & //": lines cross without a node; make the edge-node distance smaller", file, 1)
   end subroutine check_areas

   !> No group of blocks may lie inside a block of another group, unless that block is taken out: a
   !> block is one polygon, without holes
   pure subroutine check_nesting(model, network, loops, cut, error)
      type(line_model_t), intent(in) :: model
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(boxes_t) :: boxes
      logical, allocatable :: hole(:)
      real(wp) :: node(2)
      integer :: i, k, b

      if (count(loops%area < 0.0_wp) < 2) return
      boxes = block_boxes(cut)
      allocate (hole(size(cut%area)), source=.false.)
      do i = 1, model%hole%n
         b = block_around(cut, boxes, model%hole%place(1:2, i) - cut%scale%origin)
         if (b > 0) hole(b) = .true.
      end do
      do k = 1, size(loops%area)
         if (.not. loops%area(k) < 0.0_wp) cycle
         node = network%node(:, half_edge_start(network, loops%half_edge(loops%first(k))))
         do b = 1, size(cut%area)
            if (hole(b) .or. any(node <= boxes%low(:, b) .or. node >= boxes%high(:, b))) cycle
            associate (vertex => cut%vertex(:, cut%first_vertex(b):cut%first_vertex(b + 1) - 1))
               if (any(abs(vertex(1, :) - node(1)) <= 0.0_wp &
                  & .and. abs(vertex(2, :) - node(2)) <= 0.0_wp)) cycle
               if (.not. contains_point(vertex, node)) cycle
            end associate
            call tell_nested(model, network, loops, k, cut, b, error)
            return
         end do
      end do
   end subroutine check_nesting

   !> Say which block holds what
   pure subroutine tell_nested(model, network, loops, inner, cut, block, error)
      type(line_model_t), intent(in) :: model
      type(network_t), intent(in) :: network
      type(loops_t), intent(in) :: loops
      !> Number of the loop around the inner group
      integer, intent(in) :: inner
      type(cut_model_t), intent(in) :: cut
      !> Number of the outer block
      integer, intent(in) :: block
      type(error_t), allocatable, intent(out) :: error
      integer :: h, line

      h = loops%half_edge(loops%first(inner))
      line = network%line((h + 1)/2)
      call fatal_error(error, "expected blocks without holes, got line "//to_text(line) &
         & //" of blocks that lie wholly inside block "//to_text(block) &
         & //", whose corner 1 "// &
         & "is at ("//to_text(cut%vertex(1, cut%first_vertex(block)) + cut%scale%origin(1))//", " &
         & //to_text(cut%vertex(2, cut%first_vertex(block)) + cut%scale%origin(2)) &
         & //"); join the two by a line or put a hole point into the outer block", &
         & model%file, model%line%row(line))
   end subroutine tell_nested
end module dda_cutting
