!> Fields of a grid for ParaView: a name and one column of numbers a point or a cell; the XML that
!> holds them
!>
!> Make an array of fields element by element: gfortran never frees the numbers of fields that stand
!> in an array constructor
module dda_vtu_field
   use, intrinsic :: iso_fortran_env, only : int16, int32, int64, int8
   use dda_binary_file, only : append_integers, append_length, append_reals, binary_file_t
   use dda_error, only : error_t, require
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: field_t, field_kind, field_kind_enum
   public :: scalar_field, vector_field, tensor_field, state_field
   public :: check_field, field_attributes, field_bytes, append_field, append_vectors
   public :: attribute, file_head

   !> What the numbers of a field are
   type :: field_kind_enum
      integer :: scalar = 1  !! One real number
      integer :: vector = 2  !! x and y; written with z = 0
      !> xx, yy and xy of a symmetric tensor; written as three components of these names
      integer :: tensor = 3
      integer :: state = 4  !! One whole number; written as an integer
   end type field_kind_enum

   !> Names of the kinds
   type(field_kind_enum), parameter :: field_kind = field_kind_enum()

   !> A field
   type :: field_t
      character(len=64) :: name = ""       !! Name that ParaView shows
      integer :: kind = field_kind%scalar  !! One of field_kind
      !> The numbers: (1, n), of a vector (2, n), of a tensor (3, n)
      real(wp), allocatable :: values(:, :)
   end type field_t

   !> Columns that are turned into the file's form at a time
   integer, parameter :: chunk = 2048

contains

   !> First lines of a file for ParaView
   pure function file_head(kind) result(text)
      character(len=*), intent(in) :: kind   !! What the file holds, in VTK's word
      character(len=:), allocatable :: text  !! The lines; the element VTKFile is left open

      text = "<?xml version=""1.0""?>"//new_line("a")//"<VTKFile"//attribute("type", kind) &
         & //attribute("version", "1.0")//attribute("byte_order", byte_order()) &
         & //attribute("header_type", "UInt64")//">"//new_line("a")
   end function file_head

   !> An attribute of an element, with a blank before it
   pure function attribute(name, value) result(text)
      character(len=*), intent(in) :: name  !! Its name
      !> Its value; what XML reserves is written as XML wants it
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

   !> The order in which this machine keeps the bytes of a number, in VTK's word
   pure function byte_order() result(word)
      character(len=:), allocatable :: word

      word = "BigEndian"
      if (transfer(1_int16, 0_int8) == 1_int8) word = "LittleEndian"
   end function byte_order

   !> A field of real numbers
   pure type(field_t) function scalar_field(name, values) result(field)
      character(len=*), intent(in) :: name  !! Its name
      real(wp), intent(in) :: values(:)     !! The numbers: (n)

      field%name = name
      field%kind = field_kind%scalar
      allocate (field%values(1, size(values)))
      field%values(1, :) = values
   end function scalar_field

   !> A field of plane vectors
   pure type(field_t) function vector_field(name, values)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:, :)  !! Components x and y: (2, n)

      vector_field%name = name
      vector_field%kind = field_kind%vector
      allocate (vector_field%values, source=values)
   end function vector_field

   !> A field of symmetric plane tensors
   pure type(field_t) function tensor_field(name, values) result(field)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:, :)  !! Components xx, yy and xy: (3, n)

      field = vector_field(name, values)
      field%kind = field_kind%tensor
   end function tensor_field

   !> A field of whole numbers
   pure type(field_t) function state_field(name, states) result(field)
      character(len=*), intent(in) :: name
      integer, intent(in) :: states(:)  !! The numbers: (n)

      field = scalar_field(name, real(states, wp))
      field%kind = field_kind%state
   end function state_field

   !> The contract of a field: a column of the right height for each point or cell
   pure subroutine check_field(field, n, error)
      type(field_t), intent(in) :: field
      integer, intent(in) :: n  !! Number of points or cells
      !> Allocated if the field does not fit; left as it was otherwise
      type(error_t), allocatable, intent(inout) :: error
      integer, parameter :: height(4) = [1, 2, 3, 1]
      integer :: wanted(2)

      call require(field%kind >= 1 .and. field%kind <= size(height) .and. allocated(field%values), &
         & "the field '"//trim(field%name)//"' needs a kind and values", error)
      if (allocated(error)) return
      wanted = [height(field%kind), n]
      if (all(shape(field%values) == wanted)) return
      call require(.false., "the field '"//trim(field%name)//"' must be "//shape_text(wanted) &
         & //" numbers, got "//shape_text(shape(field%values)), error)
   end subroutine check_field

   !> A shape as people write it
   pure function shape_text(extent) result(text)
      integer, intent(in) :: extent(2)  !! Rows and columns: (2)
      character(len=:), allocatable :: text

      text = to_text(extent(1))//" x "//to_text(extent(2))
   end function shape_text

   !> What the file's header says of a field
   pure function field_attributes(field) result(text)
      type(field_t), intent(in) :: field
      character(len=:), allocatable :: text  !! Attributes, each with a blank before it

      text = attribute("type", "Float64")
      if (field%kind == field_kind%state) text = attribute("type", "Int32")
      text = text//attribute("Name", trim(field%name))
      if (field%kind == field_kind%vector .or. field%kind == field_kind%tensor) &
         & text = text//attribute("NumberOfComponents", "3")
      if (field%kind == field_kind%tensor) text = text//attribute("ComponentName0", "xx") &
         & //attribute("ComponentName1", "yy")//attribute("ComponentName2", "xy")
   end function field_attributes

   !> Bytes that the numbers of a field take in the file, without the length before them
   pure integer(int64) function field_bytes(field)
      type(field_t), intent(in) :: field
      integer, parameter :: column(4) = [8, 24, 24, 4]

      field_bytes = int(column(field%kind), int64)*size(field%values, 2, int64)
   end function field_bytes

   !> Write the length of a field and its numbers
   subroutine append_field(file, field)
      type(binary_file_t), intent(in) :: file
      type(field_t), intent(in) :: field

      call append_length(file, field_bytes(field))
      if (field%kind == field_kind%vector) then
         call append_vectors(file, field%values)
      else if (field%kind == field_kind%state) then
         call append_states(file, field%values)
      else
         call append_reals(file, field%values)
      end if
   end subroutine append_field

   !> Write plane vectors with z = 0
   subroutine append_vectors(file, values)
      type(binary_file_t), intent(in) :: file
      real(wp), intent(in) :: values(:, :)
      real(wp) :: spatial(3, chunk)
      integer :: first, n

      spatial(3, :) = 0.0_wp
      do first = 1, size(values, 2), chunk
         n = min(chunk, size(values, 2) - first + 1)
         spatial(1:2, :n) = values(:, first:first + n - 1)
         call append_reals(file, spatial(:, :n))
      end do
   end subroutine append_vectors

   !> Write whole numbers
   subroutine append_states(file, values)
      type(binary_file_t), intent(in) :: file
      real(wp), intent(in) :: values(:, :)  !! The numbers: (1, n)
      integer(int32) :: states(chunk)
      integer :: first, n

      do first = 1, size(values, 2), chunk
         n = min(chunk, size(values, 2) - first + 1)
         states(:n) = nint(values(1, first:first + n - 1), int32)
         call append_integers(file, states(:n))
      end do
   end subroutine append_states
end module dda_vtu_field
