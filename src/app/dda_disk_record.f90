!> disk.record: length of results.csv that is safe on disk
!>
!> A row passed to the system survives the end of the program, but not a power failure. Therefore
!> the tables are synced at intervals, results.csv last. Its length is recorded together with the
!> boot identifier of the system. While this identifier is the same, all rows are valid; after a
!> restart, those up to the recorded length.
module dda_disk_record
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_table_file, only : close_table, open_table, part_name, rename_part, table_file_t
   use dda_text, only : to_text
   use dda_text_file, only : read_text_file
   implicit none
   private

   public :: write_disk_record, trusted_length

   !> Linux: file with an identifier that changes at each start
   character(len=*), parameter :: start_file = "/proc/sys/kernel/random/boot_id"

contains

   !> Record the length that is on the disk
   subroutine write_disk_record(file, length, error)
      character(len=*), intent(in) :: file  !! Name of the record
      integer(int64), intent(in) :: length  !! Length of results.csv on the disk [bytes]
      type(error_t), allocatable, intent(inout) :: error
      type(table_file_t) :: record

      if (allocated(error)) return
      call open_table(part_name(file), to_text(real(length, wp))//" "//start_name(), record, error)
      call close_table(record, error)
      if (.not. allocated(error)) call rename_part(file, error)
   end subroutine write_disk_record

   !> Length of valid rows in results.csv [bytes]; the whole file in a folder without a record
   integer(int64) function trusted_length(file)
      character(len=*), intent(in) :: file
      character(len=:), allocatable :: text
      type(error_t), allocatable :: error
      logical :: there
      integer :: stat

      trusted_length = huge(trusted_length)
      inquire (file=file, exist=there)
      if (.not. there) return
      call read_text_file(file, text, error)
      if (index(text, " "//start_name()//new_line("a")) > 0) return
      read (text, *, iostat=stat) trusted_length
      if (stat /= 0) trusted_length = 0
   end function trusted_length

   !> Boot identifier of the system; a dash if there is none
   function start_name() result(name)
      character(len=36) :: name
      integer :: unit, stat

      name = "-"
      open (newunit=unit, file=start_file, status="old", action="read", iostat=stat)
      if (stat /= 0) return
      read (unit, "(a)", iostat=stat) name
      close (unit)
   end function start_name
end module dda_disk_record
