!> Blocks that were cut from lines as a table or for ParaView
module dda_write_cut
   use dda_cut_model, only : cut_model_t, point_kind
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_simplex, only : area_moments, area_moments_t
   use dda_table_file, only : append_line, close_table, open_table, table_file_t
   use dda_text, only : to_text
   use dda_vtu_field, only : field_t, scalar_field, state_field
   use dda_write_vtu, only : write_polygons
   implicit none
   private

   public :: write_cut_table, write_cut_vtu

   !> Lines handed to the table at once
   integer, parameter :: batch = 100

contains

   !> Write a row a block; lists in a field are parted by semicolons
   subroutine write_cut_table(file, cut, error)
      !> Name of the file; one that exists is replaced
      character(len=*), intent(in) :: file
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(table_file_t) :: table
      character(len=:), allocatable :: lines
      integer :: b, held(3, size(cut%area))

      held = 0
      do b = 1, size(cut%point)
         associate (point => cut%point(b))
            held(point%kind, point%block) = held(point%kind, point%block) + 1
         end associate
      end do
      call open_table(file, "block,material,corners,area,centroid_x,centroid_y,fixed_points," &
         & //"load_points,measured_points,corner_x,corner_y,edge_joint", table, error)
      lines = ""
      do b = 1, size(cut%area)
         if (allocated(error)) exit
         if (len(lines) > 0) lines = lines//new_line("a")
         lines = lines//block_line(cut, b, held(:, b))
         if (mod(b, batch) /= 0 .and. b < size(cut%area)) cycle
         call append_line(table, lines, error)
         lines = ""
      end do
      call close_table(table, error)
   end subroutine write_cut_table

   !> The row of a block
   pure function block_line(cut, block, held) result(line)
      type(cut_model_t), intent(in) :: cut
      !> Number of the block
      integer, intent(in) :: block
      !> Its fixed, load and measured points: (3)
      integer, intent(in) :: held(3)
      character(len=:), allocatable :: line
      character(len=:), allocatable :: x, y, joint
      type(area_moments_t) :: moments
      integer :: k, first, last

      first = cut%first_vertex(block)
      last = cut%first_vertex(block + 1) - 1
      moments = area_moments(cut%vertex(:, first:last))
      x = ""
      y = ""
      joint = ""
      do k = first, last
         x = x//";"//to_text(cut%vertex(1, k) + cut%scale%origin(1))
         y = y//";"//to_text(cut%vertex(2, k) + cut%scale%origin(2))
         joint = joint//";"//to_text(cut%edge_joint(k))
      end do
      line = to_text(block)//","//to_text(cut%material(block))//","//to_text(last - first + 1) &
         & //","//to_text(cut%area(block)) &
         & //","//to_text(moments%centroid(1) + cut%scale%origin(1)) &
         & //","//to_text(moments%centroid(2) + cut%scale%origin(2)) &
         & //","//to_text(held(point_kind%fixed))//","//to_text(held(point_kind%load)) &
         & //","//to_text(held(point_kind%measured))//","//x(2:)//","//y(2:)//","//joint(2:)
   end function block_line

   !> Write the blocks for ParaView
   subroutine write_cut_vtu(file, cut, error)
      character(len=*), intent(in) :: file
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(field_t), allocatable :: cells(:), corners(:)
      real(wp), allocatable :: point(:, :)
      integer, allocatable :: held(:)
      integer :: i

      allocate (point, source=cut%vertex)
      do i = 1, 2
         point(i, :) = point(i, :) + cut%scale%origin(i)
      end do
      allocate (held(size(cut%area)), source=0)
      do i = 1, size(cut%point)
         if (cut%point(i)%kind == point_kind%fixed) held(cut%point(i)%block) = 1
      end do
      allocate (cells(4), corners(1))
      corners(1) = state_field("edge_joint", cut%edge_joint)
      cells(1) = state_field("block", [(i, i=1, size(cut%area))])
      cells(2) = state_field("material", cut%material)
      cells(3) = state_field("fixed", held)
      cells(4) = scalar_field("area", cut%area)
      call write_polygons(file, point, cut%first_vertex, corners, cells, error)
   end subroutine write_cut_vtu
end module dda_write_cut
