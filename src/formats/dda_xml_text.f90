!> The few words of XML that files for ParaView need
module dda_xml_text
   use, intrinsic :: iso_fortran_env, only : int8, int16
   implicit none
   private

   public :: attribute, file_head

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
      !> Its name
      character(len=*), intent(in) :: name
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
end module dda_xml_text
