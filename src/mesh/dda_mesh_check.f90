!> The blocks fill what the lines enclose, once (Shi: dc16, dc17)
module dda_mesh_check
   use dda_cut_model, only : cut_model_t
   use dda_cut_points, only : block_around, block_boxes, boxes_t
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_model, only : line_model_t
   use dda_line_network, only : network_t
   use dda_network_loops, only : half_edge_start, loops_t
   use dda_polygon, only : contains_point
   use dda_text, only : to_text
   implicit none
   private

   public :: check_areas, check_nesting

contains

   !> Areas of blocks add up to those that the outer loops enclose
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
      !> A group lies inside a block
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
end module dda_mesh_check
