!> A check sum at the end of a file of numbers, by which a damaged one is known
module dda_file_seal
   use, intrinsic :: iso_fortran_env, only : int8, int64
   implicit none
   private

   public :: seal_file, seal_holds

   !> The sum is a polynomial at this place, modulo this prime: any change of a byte changes it
   integer(int64), parameter :: place = 257, prime = 2147483647

contains

   !> Put the check sum of all that is written at the end of a file
   subroutine seal_file(unit, stat, reason)
      !> Unit of the file: a stream open for reading and writing
      integer, intent(in) :: unit
      !> 0 if all is well
      integer, intent(out) :: stat
      !> Why it is not
      character(len=*), intent(inout) :: reason
      integer(int8), allocatable :: bytes(:)
      integer(int64) :: length

      inquire (unit=unit, pos=length)
      allocate (bytes(length - 1))
      read (unit, pos=1, iostat=stat, iomsg=reason) bytes
      if (stat == 0) write (unit, pos=length, iostat=stat, iomsg=reason) check_sum(bytes)
   end subroutine seal_file

   !> Whether a file ends with the check sum of all that stands before; it is at its beginning again
   !> afterwards
   logical function seal_holds(unit)
      !> Unit of the file: a stream open for reading
      integer, intent(in) :: unit
      integer(int8), allocatable :: bytes(:)
      integer(int64) :: length, found
      integer :: stat

      seal_holds = .false.
      inquire (unit=unit, size=length)
      if (length < storage_size(found)/8) return
      allocate (bytes(length - storage_size(found)/8))
      read (unit, pos=1, iostat=stat) bytes, found
      if (stat == 0) seal_holds = found == check_sum(bytes)
      rewind (unit)
   end function seal_holds

   !> The check sum of bytes
   pure integer(int64) function check_sum(bytes)
      !> The bytes: (n)
      integer(int8), intent(in) :: bytes(:)
      integer(int64) :: i

      check_sum = 1
      do i = 1, size(bytes, kind=int64)
         check_sum = mod(check_sum*place + iand(int(bytes(i), int64), 255_int64), prime)
      end do
   end function check_sum
end module dda_file_seal
