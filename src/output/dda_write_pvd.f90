!> Index of the files of a run for ParaView (.pvd): which file shows which time
!>
!> A run that is killed, or whose disk is full, leaves an index that can be read: each entry first
!> reserves its room by blanks behind the end of the index, and then takes the place of the end
module dda_write_pvd
   use dda_binary_file, only : append_text, binary_file_t, close_binary, flush_binary, go_to, &
      & open_binary
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_text, only : to_text
   use dda_xml_text, only : attribute, file_head
   implicit none
   private

   public :: pvd_index_t, open_index, add_to_index, close_index

   !> An open index
   type :: pvd_index_t
      private
      !> Its file
      type(binary_file_t) :: file
      !> Where the next entry goes [bytes from the beginning]
      integer :: place = 0
   end type pvd_index_t

   !> Last line of an index
   character(len=*), parameter :: ending = "  </Collection></VTKFile>"//new_line("a")

contains

   !> Begin an index without entries
   subroutine open_index(name, index, error)
      !> Name of the file; one that exists is replaced
      character(len=*), intent(in) :: name
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
end module dda_write_pvd
