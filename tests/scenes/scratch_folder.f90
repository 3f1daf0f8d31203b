!> Where tests write: beside the folder of the test programs, wherever they are started
module scratch_folder
   implicit none
   private

   public :: scratch, write_text

contains

   !> Path of a file that a test writes
   function scratch(file) result(path)
      character(len=*), intent(in) :: file  !! Its name
      character(len=:), allocatable :: path
      integer :: n

      call get_command_argument(0, length=n)
      allocate (character(len=n) :: path)
      call get_command_argument(0, path)
      path = path(:index(path, "/", back=.true.))//"../scratch/"//file
   end function scratch

   !> Write a text to a file of the scratch folder
   subroutine write_text(file, text)
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: text
      integer :: unit

      open (newunit=unit, file=scratch(file), access="stream", form="unformatted", status="replace")
      write (unit) text
      close (unit)
   end subroutine write_text
end module scratch_folder
