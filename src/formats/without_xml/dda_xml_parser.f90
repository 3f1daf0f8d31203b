!> Replacement of the XML parser in builds without libxml2: reports the missing library
module dda_xml_parser
   use dda_error, only : error_t, fatal_error
   use dda_xml_tree, only : xml_tree_t
   implicit none
   private

   public :: parse_xml, has_xml

   !> True if this build reads XML
   logical, parameter :: has_xml = .false.

contains

   !> Report that XML files cannot be read
   subroutine parse_xml(text, file, tree, error)
      character(len=*), intent(in) :: text              !! The text of the file
      character(len=*), intent(in) :: file              !! Name of the file
      type(xml_tree_t), intent(out) :: tree             !! Empty
      type(error_t), allocatable, intent(out) :: error  !! Always allocated

      tree%file = file
      allocate (tree%element(0))
      if (len(text) >= 0) call fatal_error(error, "expected the plain form, got XML: this " &
         & //"build has no libxml2 (on Debian: libxml2-dev); install it and configure again", &
         & file, 1)
   end subroutine parse_xml
end module dda_xml_parser
