!> An XML file becomes a tree, tag by tag
module dda_xml_builder
   use dda_error, only : error_t
   use dda_xml_tags, only : find_tags, xml_tags_t
   use dda_xml_tree, only : xml_attribute_t, xml_element_t, xml_tree_t
   implicit none
   private

   public :: xml_builder_t, new_xml_builder, open_element, add_text, close_element

   !> A tree, and what is open in it
   type :: xml_builder_t
      !> The elements so far
      type(xml_tree_t) :: tree
      !> Tags of the file
      type(xml_tags_t) :: tags
      !> How many of them have been read
      integer :: n_tags = 0
      !> Place of the element that is open; 0 outside the root
      integer :: open = 0
      !> Number of open elements
      integer :: depth = 0
      !> Text behind the last tag, and room behind it
      character(len=:), allocatable :: piece
      !> Length of that text
      integer :: length = 0
   end type xml_builder_t

   !> Characters that part words
   character(len=*), parameter :: blanks = " "//achar(9)//achar(10)

contains

   !> A tree without elements
   pure subroutine new_xml_builder(text, file, builder, error)
      !> The file's text
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      type(xml_builder_t), intent(out) :: builder
      !> What is refused before it is parsed
      type(error_t), allocatable, intent(out) :: error

      builder%tree%file = file
      allocate (builder%tree%element(16))
      builder%piece = repeat(" ", 4096)
      call find_tags(text, file, builder%tags, error)
   end subroutine new_xml_builder

   !> Add an element inside the one that is open, and open it
   pure subroutine open_element(builder, name, attribute)
      type(xml_builder_t), intent(inout) :: builder
      !> Name of the element
      character(len=*), intent(in) :: name
      !> Its attributes, which are moved into the tree: (n)
      type(xml_attribute_t), allocatable, intent(inout) :: attribute(:)
      type(xml_element_t), allocatable :: longer(:)
      integer :: i

      call end_piece(builder)
      if (builder%tree%n == size(builder%tree%element)) then
         allocate (longer(2*builder%tree%n))
         do i = 1, builder%tree%n
            call move_element(builder%tree%element(i), longer(i))
         end do
         call move_alloc(longer, builder%tree%element)
      end if
      builder%tree%n = builder%tree%n + 1
      associate (new => builder%tree%element(builder%tree%n))
         new%name = name
         new%text = ""
         new%row = tag_row(builder, 1)
         new%text_row = tag_row(builder, 2)
         new%parent = builder%open
         new%last = builder%tree%n
         call move_alloc(attribute, new%attribute)
      end associate
      builder%open = builder%tree%n
      builder%depth = builder%depth + 1
   end subroutine open_element

   !> Line of the tag that was read last
   pure integer function tag_row(builder, side)
      type(xml_builder_t), intent(in) :: builder
      !> 1 for its beginning, 2 for its end
      integer, intent(in) :: side

      tag_row = 1
      if (builder%n_tags > 0) tag_row = builder%tags%row(side, min(builder%n_tags, builder%tags%n))
   end function tag_row

   !> Add text behind the last tag
   pure subroutine add_text(builder, text)
      type(xml_builder_t), intent(inout) :: builder
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: longer
      integer :: length

      if (builder%open == 0) return
      length = builder%length + len(text)
      if (length > len(builder%piece)) then
         allocate (character(len=2*length) :: longer)
         longer(:builder%length) = builder%piece(:builder%length)
         call move_alloc(longer, builder%piece)
      end if
      builder%piece(builder%length + 1:length) = text
      builder%length = length
   end subroutine add_text

   !> Give the text behind the last tag to the open element, if it is the first that is not blank,
   !> and go on to the next tag
   pure subroutine end_piece(builder)
      type(xml_builder_t), intent(inout) :: builder

      if (builder%length > 0) then
         associate (element => builder%tree%element(builder%open), &
            & text => builder%piece(:builder%length))
            if (len(element%text) == 0 .and. verify(text, blanks) > 0) then
               element%text = text
               element%text_row = tag_row(builder, 2)
            end if
         end associate
      end if
      builder%length = 0
      builder%n_tags = builder%n_tags + 1
   end subroutine end_piece

   !> Close the element that is open
   pure subroutine close_element(builder)
      type(xml_builder_t), intent(inout) :: builder
      logical :: has_end_tag

      has_end_tag = .true.
      if (builder%open == builder%tree%n .and. builder%n_tags <= builder%tags%n) &
         & has_end_tag = .not. builder%tags%is_whole(builder%n_tags)
      if (has_end_tag) call end_piece(builder)
      builder%tree%element(builder%open)%last = builder%tree%n
      builder%open = builder%tree%element(builder%open)%parent
      builder%depth = builder%depth - 1
   end subroutine close_element

   !> Move an element without copying its texts
   pure subroutine move_element(from, to)
      !> The element; its parts go
      type(xml_element_t), intent(inout) :: from
      type(xml_element_t), intent(inout) :: to

      call move_alloc(from%name, to%name)
      call move_alloc(from%text, to%text)
      call move_alloc(from%attribute, to%attribute)
      to%row = from%row
      to%text_row = from%text_row
      to%parent = from%parent
      to%last = from%last
   end subroutine move_element
end module dda_xml_builder
