!> Grids for ParaView: polygons, single points that carry forces, and blocks that were cut from
!> lines (as a table too), as VTU with raw binary data appended, in the machine's own byte order
!>
!> https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
module dda_write_vtu
   use, intrinsic :: iso_fortran_env, only : int32, int64
   use dda_binary_file, only : append_integers, append_length, append_text, binary_file_t, &
      & close_binary, flush_binary, go_to, open_binary
   use dda_cut_model, only : cut_model_t, point_kind
   use dda_error, only : error_t, require
   use dda_kinds, only : wp
   use dda_table_file, only : append_line, close_table, open_table, table_file_t
   use dda_text, only : to_text
   use dda_vector, only : area_moments, area_moments_t
   use dda_vtu_field, only : append_field, append_vectors, attribute, check_field, &
      & field_attributes, field_bytes, field_t, file_head, scalar_field, state_field
   implicit none
   private

   public :: add_to_index, close_index, open_index, pvd_index_t, write_points, write_polygons
   public :: write_cut_table, write_cut_vtu

   !> VTK's numbers of the kinds of cells
   type :: cell_type_enum
      integer :: vertex = 1   !! A single point
      integer :: polygon = 7  !! Any simple polygon
   end type cell_type_enum

   !> Names of the kinds of cells
   type(cell_type_enum), parameter :: cell_type = cell_type_enum()

   !> The part of the file before its data, while it grows
   type :: header_t
      character(len=:), allocatable :: text  !! Its text
      integer(int64) :: offset = 0           !! Where the next array begins in the data [bytes]
   end type header_t

   !> An open index
   type :: pvd_index_t
      type(binary_file_t) :: file  !! Its file
      integer :: place = 0         !! Where the next entry goes [bytes from the beginning]
   end type pvd_index_t

   !> Last line of an index
   character(len=*), parameter :: ending = "  </Collection></VTKFile>"//new_line("a")

   !> Lines handed to the table at once
   integer, parameter :: batch = 100

contains

   !> Write polygons; the file is whole when there is no error
   subroutine write_polygons(file, point, first_vertex, point_fields, cell_fields, error)
      character(len=*), intent(in) :: file  !! Name of the file; one that exists is replaced
      !> Corners of all polygons, one polygon after the other: (2, n_point) [m]
      real(wp), intent(in) :: point(:, :)
      !> First corner of each polygon, and one beyond the last: (n_polygon + 1)
      integer, intent(in) :: first_vertex(:)
      type(field_t), intent(in) :: point_fields(:)  !! Fields with a value at each corner: (:)
      type(field_t), intent(in) :: cell_fields(:)   !! Fields with a value for each polygon: (:)
      !> Allocated if the arrays do not fit together or the file cannot be written
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      n = size(first_vertex) - 1
      call require(n >= 0, "polygons need the number one beyond their last corner", error)
      if (allocated(error)) return
      call require(first_vertex(1) == 1 .and. first_vertex(n + 1) == size(point, 2) + 1, &
         & "the corners of polygons are all the points, in their order", error)
      call require(all(first_vertex(2:) - first_vertex(:n) >= 3), &
         & "a polygon has three corners or more", error)
      call write_grid(file, cell_type%polygon, point, first_vertex(2:), point_fields, cell_fields, &
         & error)
   end subroutine write_polygons

   !> Write single points, such as those that contact forces act on; the file is whole when there is
   !> no error
   subroutine write_points(file, point, point_fields, error)
      character(len=*), intent(in) :: file
      real(wp), intent(in) :: point(:, :)           !! The points: (2, n_point) [m]
      type(field_t), intent(in) :: point_fields(:)  !! Fields with a value at each point: (:)
      type(error_t), allocatable, intent(out) :: error
      type(field_t) :: none(0)
      integer :: i

      call write_grid(file, cell_type%vertex, point, [(i + 1, i=1, size(point, 2))], point_fields, &
         & none, error)
   end subroutine write_points

   !> Write cells of one kind that own the points in their order
   subroutine write_grid(file, kind, point, next_point, point_fields, cell_fields, error)
      character(len=*), intent(in) :: file
      integer, intent(in) :: kind           !! One of cell_type
      real(wp), intent(in) :: point(:, :)
      integer, intent(in) :: next_point(:)  !! The point behind the last one of each cell: (n_cell)
      type(field_t), intent(in) :: point_fields(:)
      !> Fields with a value for each cell: (:)
      type(field_t), intent(in) :: cell_fields(:)
      type(error_t), allocatable, intent(inout) :: error
      type(binary_file_t) :: vtu
      integer :: i

      call require(size(point, 1) == 2, "points need two coordinates", error)
      do i = 1, size(point_fields)
         call check_field(point_fields(i), size(point, 2), error)
      end do
      do i = 1, size(cell_fields)
         call check_field(cell_fields(i), size(next_point), error)
      end do
      if (.not. allocated(error)) call open_binary(file, vtu, error)
      if (allocated(error)) return
      call append_text(vtu, grid_header(size(point, 2), size(next_point), point_fields, &
         & cell_fields))
      do i = 1, size(point_fields)
         call append_field(vtu, point_fields(i))
      end do
      do i = 1, size(cell_fields)
         call append_field(vtu, cell_fields(i))
      end do
      call append_length(vtu, 24_int64*size(point, 2, int64))
      call append_vectors(vtu, point)
      call append_cells(vtu, kind, size(point, 2), next_point)
      call append_text(vtu, new_line("a")//"  </AppendedData>"//new_line("a")//"</VTKFile>" &
         & //new_line("a"))
      call close_binary(vtu, error)
   end subroutine write_grid

   !> Write which points the cells own, where each ends and what it is
   subroutine append_cells(vtu, kind, n_point, next_point)
      type(binary_file_t), intent(in) :: vtu
      integer, intent(in) :: kind
      integer, intent(in) :: n_point  !! Number of points
      integer, intent(in) :: next_point(:)
      integer(int32), allocatable :: connectivity(:)
      integer :: i

      allocate (connectivity(n_point))
      do i = 1, n_point
         connectivity(i) = int(i - 1, int32)
      end do
      call append_length(vtu, 4_int64*n_point)
      call append_integers(vtu, connectivity)
      call append_length(vtu, 4_int64*size(next_point))
      call append_integers(vtu, int(next_point - 1, int32))
      call append_length(vtu, size(next_point, kind=int64))
      call append_text(vtu, repeat(achar(kind), size(next_point)))
   end subroutine append_cells

   !> All of the file before its data: arrays in the order in which they are written
   pure function grid_header(n_point, n_cell, point_fields, cell_fields) result(text)
      integer, intent(in) :: n_point
      integer, intent(in) :: n_cell          !! Number of cells
      type(field_t), intent(in) :: point_fields(:), cell_fields(:)
      character(len=:), allocatable :: text  !! The text, up to the mark behind which the data begin
      type(header_t) :: header

      header%text = file_head("UnstructuredGrid")
      call add_line(header, "  <UnstructuredGrid>")
      call add_line(header, "    <Piece"//attribute("NumberOfPoints", to_text(n_point)) &
         & //attribute("NumberOfCells", to_text(n_cell))//">")
      call add_fields(header, "PointData", point_fields)
      call add_fields(header, "CellData", cell_fields)
      call add_line(header, "      <Points>")
      call add_array(header, attribute("type", "Float64")//attribute("Name", "Points") &
         & //attribute("NumberOfComponents", "3"), 24_int64*n_point)
      call add_line(header, "      </Points>")
      call add_line(header, "      <Cells>")
      call add_array(header, attribute("type", "Int32")//attribute("Name", "connectivity"), &
         & 4_int64*n_point)
      call add_array(header, attribute("type", "Int32")//attribute("Name", "offsets"), &
         & 4_int64*n_cell)
      call add_array(header, attribute("type", "UInt8")//attribute("Name", "types"), &
         & int(n_cell, int64))
      call add_line(header, "      </Cells>")
      call add_line(header, "    </Piece>")
      call add_line(header, "  </UnstructuredGrid>")
      text = header%text//"  <AppendedData"//attribute("encoding", "raw")//">"//new_line("a")//"_"
   end function grid_header

   !> Announce the fields of the points or of the cells
   pure subroutine add_fields(header, element, fields)
      type(header_t), intent(inout) :: header
      character(len=*), intent(in) :: element  !! PointData or CellData
      type(field_t), intent(in) :: fields(:)   !! The fields: (:)
      integer :: i

      call add_line(header, "      <"//element//">")
      do i = 1, size(fields)
         call add_array(header, field_attributes(fields(i)), field_bytes(fields(i)))
      end do
      call add_line(header, "      </"//element//">")
   end subroutine add_fields

   !> Announce an array
   pure subroutine add_array(header, attributes, n_byte)
      type(header_t), intent(inout) :: header
      character(len=*), intent(in) :: attributes  !! What the array is
      !> Its length in the file, without the number before it that tells the length
      integer(int64), intent(in) :: n_byte
      character(len=20) :: offset

      write (offset, "(i0)") header%offset
      call add_line(header, "        <DataArray"//attributes//attribute("format", "appended") &
         & //attribute("offset", trim(offset))//"/>")
      header%offset = header%offset + 8_int64 + n_byte
   end subroutine add_array

   !> Put a line below the header
   pure subroutine add_line(header, line)
      type(header_t), intent(inout) :: header
      character(len=*), intent(in) :: line  !! The line

      header%text = header%text//line//new_line("a")
   end subroutine add_line

   !> Begin an index without entries
   subroutine open_index(name, index, error)
      character(len=*), intent(in) :: name  !! Name of the file; one that exists is replaced
      type(pvd_index_t), intent(out) :: index
      type(error_t), allocatable, intent(out) :: error

      call open_binary(name, index%file, error)
      if (allocated(error)) return
      associate (head => file_head("Collection")//"  <Collection>"//new_line("a"))
         call append_text(index%file, head//ending)
         index%place = len(head)
      end associate
      call flush_binary(index%file, error)
   end subroutine open_index

   !> Add a file, which must be whole by now
   subroutine add_to_index(index, time, part, shown, error)
      type(pvd_index_t), intent(inout) :: index
      !> Time that the file shows, or number of the step
      real(wp), intent(in) :: time
      !> What it shows of that time, counted from 0: files of the same time are shown together
      integer, intent(in) :: part
      !> Name of the file, relative to the folder of the index
      character(len=*), intent(in) :: shown
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: entry

      entry = "    <DataSet"//attribute("timestep", to_text(time)) &
         & //attribute("part", to_text(part))//attribute("file", shown)//"/>"//new_line("a")
      call go_to(index%file, index%place + len(ending))
      call append_text(index%file, repeat(" ", len(entry)))
      call flush_binary(index%file, error)
      if (allocated(error)) return
      call go_to(index%file, index%place)
      call append_text(index%file, entry//ending)
      call flush_binary(index%file, error)
      index%place = index%place + len(entry)
   end subroutine add_to_index

   !> Close an index
   subroutine close_index(index, error)
      !> The index; nothing happens to one that is not open
      type(pvd_index_t), intent(inout) :: index
      !> Allocated if anything of it could not be written
      type(error_t), allocatable, intent(out) :: error

      call close_binary(index%file, error)
   end subroutine close_index

   !> Write a row a block; lists in a field are parted by semicolons
   subroutine write_cut_table(file, cut, error)
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
      integer, intent(in) :: block    !! Number of the block
      integer, intent(in) :: held(3)  !! Its fixed, load and measured points: (3)
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

end module dda_write_vtu
