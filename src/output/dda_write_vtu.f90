!> Grids for ParaView: polygons, points with forces, and cut blocks, as VTU with raw binary data
!>
!> https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
module dda_write_vtu
   use, intrinsic :: iso_fortran_env, only : int16, int32, int64, int8
   use dda_binary_file, only : write_file
   use dda_cut_model, only : cut_model_t
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_line_model, only : entity_role
   use dda_table_file, only : append_line, close_table, open_table, table_file_t
   use dda_text, only : to_text
   use dda_vector, only : area_moments, area_moments_t
   implicit none
   private

   public :: field_t, scalar_field, state_field, tensor_field, vector_field
   public :: index_entry, write_index, write_points, write_polygons
   public :: write_cut_table, write_cut_vtu

   !> VTK's numbers of cell types
   type :: cell_type_enum
      integer :: vertex = 1   !! A single point
      integer :: polygon = 7  !! Any simple polygon
   end type cell_type_enum

   !> Names of the cell types
   type(cell_type_enum), parameter :: cell_type = cell_type_enum()

   !> An array of numbers in a file. Lists must be filled element by element: gfortran does not free
   !> the texts of elements in an array constructor
   type :: field_t
      character(len=:), allocatable :: attributes  !! Attributes in the header
      character(len=:), allocatable :: bytes       !! The numbers in binary form
   end type field_t

   !> Number of lines per write
   integer, parameter :: batch = 100
   character(len=1), parameter :: lf = achar(10)

contains

   !> A field of real numbers
   pure type(field_t) function scalar_field(name, values) result(field)
      character(len=*), intent(in) :: name  !! Name in ParaView
      real(wp), intent(in) :: values(:)     !! The numbers: (n)

      field = new_field("Float64", name, "", real_bytes(values))
   end function scalar_field

   !> A field of plane vectors, written with z = 0
   pure type(field_t) function vector_field(name, values) result(field)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:, :)  !! Components x and y: (2, n)
      real(wp), allocatable :: spatial(:, :)

      allocate (spatial(3, size(values, 2)), source=0.0_wp)
      spatial(:2, :) = values
      field = new_field("Float64", name, attribute("NumberOfComponents", "3"), &
         & real_bytes(reshape(spatial, [size(spatial)])))
   end function vector_field

   !> A field of symmetric plane tensors
   pure type(field_t) function tensor_field(name, values) result(field)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:, :)  !! Components xx, yy and xy: (3, n)

      field = new_field("Float64", name, attribute("NumberOfComponents", "3") &
         & //attribute("ComponentName0", "xx")//attribute("ComponentName1", "yy") &
         & //attribute("ComponentName2", "xy"), real_bytes(reshape(values, [size(values)])))
   end function tensor_field

   !> A field of integers
   pure type(field_t) function state_field(name, states) result(field)
      character(len=*), intent(in) :: name
      integer, intent(in) :: states(:)  !! The numbers: (n)

      field = new_field("Int32", name, "", &
         & transfer(int(states, int32), repeat(" ", 4*size(states))))
   end function state_field

   !> A field of any numbers
   pure type(field_t) function new_field(type, name, more, bytes) result(field)
      character(len=*), intent(in) :: type   !! VTK's word for the type of the numbers
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: more   !! Further attributes, each preceded by a blank
      character(len=*), intent(in) :: bytes  !! The numbers in binary form

      field%attributes = attribute("type", type)//attribute("Name", name)//more
      field%bytes = bytes
   end function new_field

   !> Real numbers in binary form
   pure function real_bytes(values) result(bytes)
      real(wp), intent(in) :: values(:)       !! The numbers: (n)
      character(len=8*size(values)) :: bytes  !! Their bytes

      bytes = transfer(values, bytes)
   end function real_bytes

   !> First lines of a VTK file
   pure function file_head(kind) result(text)
      character(len=*), intent(in) :: kind   !! VTK's word for the type of the file
      character(len=:), allocatable :: text  !! The lines; the element VTKFile is still open

      text = "<?xml version=""1.0""?>"//lf//"<VTKFile"//attribute("type", kind) &
         & //attribute("version", "1.0")//attribute("byte_order", trim(merge("LittleEndian", &
         & "BigEndian   ", transfer(1_int16, 0_int8) == 1_int8))) &
         & //attribute("header_type", "UInt64")//">"//lf
   end function file_head

   !> An attribute of an element, preceded by a blank
   pure function attribute(name, value) result(text)
      character(len=*), intent(in) :: name  !! Name of the attribute
      !> Value of the attribute; reserved characters are escaped
      character(len=*), intent(in) :: value
      character(len=:), allocatable :: text
      integer :: i

      text = " "//name//"="""
      do i = 1, len(value)
         select case (value(i:i))
         case ("&")
            text = text//"&amp;"
         case ("<")
            text = text//"&lt;"
         case (">")
            text = text//"&gt;"
         case ("""")
            text = text//"&quot;"
         case default
            text = text//value(i:i)
         end select
      end do
      text = text//""""
   end function attribute

   !> Write polygons
   subroutine write_polygons(file, point, first_vertex, point_fields, cell_fields, error)
      character(len=*), intent(in) :: file  !! Name of the file; one that exists is replaced
      !> Corners of all polygons, one polygon after the other: (2, n_point) [m]
      real(wp), intent(in) :: point(:, :)
      !> First corner of each polygon, and one past the last: (n_polygon + 1)
      integer, intent(in) :: first_vertex(:)
      type(field_t), intent(in) :: point_fields(:)      !! Fields with a value at each corner: (:)
      type(field_t), intent(in) :: cell_fields(:)       !! Fields with a value for each polygon: (:)
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the file cannot be written

      call write_grid(file, cell_type%polygon, point, first_vertex(2:) - 1, point_fields, &
         & cell_fields, error)
   end subroutine write_polygons

   !> Write single points with their forces
   subroutine write_points(file, point, point_fields, error)
      character(len=*), intent(in) :: file
      real(wp), intent(in) :: point(:, :)           !! The points: (2, n_point) [m]
      type(field_t), intent(in) :: point_fields(:)  !! Fields with a value at each point: (:)
      type(error_t), allocatable, intent(out) :: error
      type(field_t) :: none(0)
      integer :: i

      call write_grid(file, cell_type%vertex, point, [(i, i=1, size(point, 2))], point_fields, &
         & none, error)
   end subroutine write_points

   !> Write cells of one type that consist of consecutive points
   subroutine write_grid(file, kind, point, last_point, point_fields, cell_fields, error)
      character(len=*), intent(in) :: file
      integer, intent(in) :: kind           !! One of cell_type
      real(wp), intent(in) :: point(:, :)
      integer, intent(in) :: last_point(:)  !! The last point of each cell: (n_cell)
      type(field_t), intent(in) :: point_fields(:)
      type(field_t), intent(in) :: cell_fields(:)  !! Fields with a value for each cell: (:)
      type(error_t), allocatable, intent(out) :: error
      type(field_t) :: points(1), cells(3)
      character(len=:), allocatable :: head, data
      integer :: i

      points(1) = vector_field("Points", point)
      cells(1) = state_field("connectivity", [(i - 1, i=1, size(point, 2))])
      cells(2) = state_field("offsets", last_point)
      cells(3) = new_field("UInt8", "types", "", repeat(achar(kind), size(last_point)))
      head = file_head("UnstructuredGrid")//"  <UnstructuredGrid>"//lf//"    <Piece" &
         & //attribute("NumberOfPoints", to_text(size(point, 2))) &
         & //attribute("NumberOfCells", to_text(size(last_point)))//">"//lf
      data = ""
      call add_fields("PointData", point_fields)
      call add_fields("CellData", cell_fields)
      call add_fields("Points", points)
      call add_fields("Cells", cells)
      call write_file(file, head//"    </Piece>"//lf//"  </UnstructuredGrid>"//lf &
         & //"  <AppendedData"//attribute("encoding", "raw")//">"//lf//"_"//data//lf &
         & //"  </AppendedData>"//lf//"</VTKFile>"//lf, error)

   contains

      !> Write fields into the header, and append their lengths and data
      subroutine add_fields(element, fields)
         character(len=*), intent(in) :: element  !! Element of the header
         type(field_t), intent(in) :: fields(:)   !! The fields: (:)
         integer :: k

         head = head//"      <"//element//">"//lf
         do k = 1, size(fields)
            head = head//"        <DataArray"//fields(k)%attributes//attribute("format", &
               & "appended")//attribute("offset", to_text(len(data)))//"/>"//lf
            data = data//transfer(len(fields(k)%bytes, int64), repeat(" ", 8))//fields(k)%bytes
         end do
         head = head//"      </"//element//">"//lf
      end subroutine add_fields
   end subroutine write_grid

   !> Entry of a file in an index
   pure function index_entry(time, part, shown) result(entry)
      real(wp), intent(in) :: time  !! Time of the file, or number of the step
      !> Part number from 0: all parts of the same time are shown together
      integer, intent(in) :: part
      character(len=*), intent(in) :: shown   !! Name of the file, relative to the index
      character(len=:), allocatable :: entry  !! The entry with its line end

      entry = "    <DataSet"//attribute("timestep", to_text(time)) &
         & //attribute("part", to_text(part))//attribute("file", shown)//"/>"//lf
   end function index_entry

   !> Write an index of files
   subroutine write_index(file, entries, error)
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: entries  !! The entries
      type(error_t), allocatable, intent(out) :: error

      call write_file(file, file_head("Collection")//"  <Collection>"//lf//entries &
         & //"  </Collection></VTKFile>"//lf, error)
   end subroutine write_index

   !> Write one row per block; lists in a field are separated by semicolons
   subroutine write_cut_table(file, cut, error)
      character(len=*), intent(in) :: file
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(table_file_t) :: table
      character(len=:), allocatable :: lines
      integer :: b, held(entity_role%fix:entity_role%measure, size(cut%area))

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

   !> Row of a block
   pure function block_line(cut, block, held) result(line)
      type(cut_model_t), intent(in) :: cut
      integer, intent(in) :: block                   !! Number of the block
      integer, intent(in) :: held(entity_role%fix:)  !! Its fixed, load and monitoring points: (3)
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
         & //","//to_text(held(entity_role%fix))//","//to_text(held(entity_role%load)) &
         & //","//to_text(held(entity_role%measure))//","//x(2:)//","//y(2:)//","//joint(2:)
   end function block_line

   !> Write the blocks for ParaView
   subroutine write_cut_vtu(file, cut, error)
      character(len=*), intent(in) :: file
      type(cut_model_t), intent(in) :: cut
      type(error_t), allocatable, intent(out) :: error
      type(field_t) :: cells(4), corners(1)
      integer :: held(size(cut%area)), i

      held = 0
      do i = 1, size(cut%point)
         if (cut%point(i)%kind == entity_role%fix) held(cut%point(i)%block) = 1
      end do
      corners(1) = state_field("edge_joint", cut%edge_joint)
      cells(1) = state_field("block", [(i, i=1, size(cut%area))])
      cells(2) = state_field("material", cut%material)
      cells(3) = state_field("fixed", held)
      cells(4) = scalar_field("area", cut%area)
      call write_polygons(file, cut%vertex + spread(cut%scale%origin, 2, size(cut%vertex, 2)), &
         & cut%first_vertex, corners, cells, error)
   end subroutine write_cut_vtu

end module dda_write_vtu
