!> An XML file as a tree of elements with values
module dda_xml_tree
   use dda_error, only : error_t
   use dda_xml_tags, only : find_tags, xml_tags_t
   implicit none
   private

   public :: xml_tree_t, xml_attribute_t, first_child, next_sibling, find_child, count_children
   public :: attribute_place, attribute_of, xml_builder_t, new_xml_builder, open_element
   public :: add_text, close_element

   !> An attribute of an element
   type :: xml_attribute_t
      character(len=:), allocatable :: name   !! Its name without prefix
      character(len=:), allocatable :: value  !! Its value
   end type xml_attribute_t

   !> An element
   type :: xml_element_t
      character(len=:), allocatable :: name  !! Its name without prefix
      !> Text inside the element; comments are reduced to their line ends, so that lines can be
      !> counted. For an element with children, the first piece that is not blank
      character(len=:), allocatable :: text
      integer :: row = 0           !! Line of the file where its start tag begins
      integer :: text_row = 0      !! Line of the file where its text begins
      integer :: parent = 0        !! Place of the parent; 0 for the root
      integer :: last = 0          !! Place of the last descendant, or of the element itself
      logical :: is_read = .true.  !! True if the element is known at its place
      type(xml_attribute_t), allocatable :: attribute(:)  !! Its attributes: (n)
   end type xml_element_t

   !> Elements in the order of their start tags; the root is the first
   type :: xml_tree_t
      character(len=:), allocatable :: file           !! Name of the file
      integer :: n = 0                                !! Number of elements
      type(xml_element_t), allocatable :: element(:)  !! The elements: (n or more)
   end type xml_tree_t

   !> A tree under construction
   type :: xml_builder_t
      type(xml_tree_t) :: tree  !! The elements read so far
      type(xml_tags_t) :: tags  !! Tags of the file
      integer :: n_tags = 0     !! Number of tags read
      integer :: open = 0       !! Place of the element that is open; 0 outside the root
      integer :: depth = 0      !! Number of open elements
      character(len=:), allocatable :: piece  !! Text after the last tag, and spare room after it
      integer :: length = 0  !! Length of that text
   end type xml_builder_t

   !> Characters that separate words
   character(len=*), parameter :: blanks = " "//achar(9)//achar(10)

contains

   !> The first child that is read; 0 if there is none
   pure integer function first_child(tree, at)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of the parent

      first_child = first_read(tree, at + 1, tree%element(at)%last)
   end function first_child

   !> The next sibling that is read; 0 if there is none
   pure integer function next_sibling(tree, at)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at

      next_sibling = 0
      associate (element => tree%element(at))
         if (element%parent > 0) &
            & next_sibling = first_read(tree, element%last + 1, tree%element(element%parent)%last)
      end associate
   end function next_sibling

   !> The first of several siblings that is read; 0 if there is none
   pure integer function first_read(tree, first, last)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: first  !! Place of the first sibling
      integer, intent(in) :: last   !! Place where the last one ends

      first_read = first
      do while (first_read <= last)
         if (tree%element(first_read)%is_read) return
         first_read = tree%element(first_read)%last + 1
      end do
      first_read = 0
   end function first_read

   !> The first child of a given name
   pure integer function find_child(tree, at, name)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name  !! The name

      find_child = first_child(tree, at)
      do while (find_child > 0)
         if (tree%element(find_child)%name == name) return
         find_child = next_sibling(tree, find_child)
      end do
   end function find_child

   !> Number of children of a given name
   pure integer function count_children(tree, at, name)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name
      integer :: child

      count_children = 0
      child = first_child(tree, at)
      do while (child > 0)
         if (tree%element(child)%name == name) count_children = count_children + 1
         child = next_sibling(tree, child)
      end do
   end function count_children

   !> Index of the first attribute of a given name; 0 if there is none
   pure integer function attribute_place(tree, at, name)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name  !! Name of the attribute
      integer :: i

      attribute_place = 0
      associate (attribute => tree%element(at)%attribute)
         do i = size(attribute), 1, -1
            if (attribute(i)%name == name) attribute_place = i
         end do
      end associate
   end function attribute_place

   !> Value of an attribute
   pure function attribute_of(tree, at, name) result(value)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: name
      !> Value without blanks at its ends; empty if the attribute is missing
      character(len=:), allocatable :: value
      integer :: i

      value = ""
      i = attribute_place(tree, at, name)
      if (i > 0) value = trim(adjustl(tree%element(at)%attribute(i)%value))
   end function attribute_of

   !> Start a tree without elements
   pure subroutine new_xml_builder(text, file, builder, error)
      character(len=*), intent(in) :: text  !! The file's text
      character(len=*), intent(in) :: file  !! Name of the file
      type(xml_builder_t), intent(out) :: builder
      type(error_t), allocatable, intent(out) :: error  !! Allocated for text refused unparsed

      builder%tree%file = file
      allocate (builder%tree%element(16))
      builder%piece = repeat(" ", 4096)
      call find_tags(text, file, builder%tags, error)
   end subroutine new_xml_builder

   !> Add a child to the open element, and make it the open one
   pure subroutine open_element(builder, name, attribute)
      type(xml_builder_t), intent(inout) :: builder
      character(len=*), intent(in) :: name  !! Name of the element
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
      integer, intent(in) :: side  !! 1 for its beginning, 2 for its end

      tag_row = 1
      if (builder%n_tags > 0) tag_row = builder%tags%row(side, min(builder%n_tags, builder%tags%n))
   end function tag_row

   !> Append text after the last tag
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

   !> Assign the text after the last tag to the open element, if it is its first nonblank text, and
   !> advance to the next tag
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
      type(xml_element_t), intent(inout) :: from  !! The element; its parts are moved
      type(xml_element_t), intent(inout) :: to

      call move_alloc(from%name, to%name)
      call move_alloc(from%text, to%text)
      call move_alloc(from%attribute, to%attribute)
      to%row = from%row
      to%text_row = from%text_row
      to%parent = from%parent
      to%last = from%last
   end subroutine move_element

end module dda_xml_tree
