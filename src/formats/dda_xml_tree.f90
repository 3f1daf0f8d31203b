!> An XML file as a tree of elements: values that need no parser once they are there
module dda_xml_tree
   implicit none
   private

   public :: xml_tree_t, xml_element_t, xml_attribute_t, first_child, next_sibling, find_child
   public :: count_children, attribute_place, attribute_of

   !> An attribute of an element
   type :: xml_attribute_t
      !> Its name without prefix
      character(len=:), allocatable :: name
      !> Its value
      character(len=:), allocatable :: value
   end type xml_attribute_t

   !> An element
   type :: xml_element_t
      !> Its name without prefix
      character(len=:), allocatable :: name
      !> The text inside it; of comments only the line ends, so that lines can be counted. Of an
      !> element that holds others the first piece that is not blank
      character(len=:), allocatable :: text
      !> Line of the file where its start tag begins
      integer :: row = 0
      !> Line of the file where its text begins
      integer :: text_row = 0
      !> Place of the element that holds it; 0 for the root
      integer :: parent = 0
      !> Place of the last element inside it, itself if there is none
      integer :: last = 0
      !> Whether it has a meaning where it stands
      logical :: is_read = .true.
      !> Its attributes: (n)
      type(xml_attribute_t), allocatable :: attribute(:)
   end type xml_element_t

   !> Elements in the order in which they begin; the root is the first
   type :: xml_tree_t
      !> Name of the file
      character(len=:), allocatable :: file
      !> How many there are
      integer :: n = 0
      !> The elements: (n or more)
      type(xml_element_t), allocatable :: element(:)
   end type xml_tree_t

contains

   !> The first element inside another that is read; 0 if there is none
   pure integer function first_child(tree, at)
      type(xml_tree_t), intent(in) :: tree
      !> Place of the outer element
      integer, intent(in) :: at

      first_child = first_read(tree, at + 1, tree%element(at)%last)
   end function first_child

   !> The element that follows another inside the same one and is read; 0 if there is none
   pure integer function next_sibling(tree, at)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at

      next_sibling = 0
      associate (element => tree%element(at))
         if (element%parent > 0) &
            & next_sibling = first_read(tree, element%last + 1, tree%element(element%parent)%last)
      end associate
   end function next_sibling

   !> The first of some neighbours that is read; 0 if there is none
   pure integer function first_read(tree, first, last)
      type(xml_tree_t), intent(in) :: tree
      !> Place of the first neighbour
      integer, intent(in) :: first
      !> Place where the last one ends
      integer, intent(in) :: last

      first_read = first
      do while (first_read <= last)
         if (tree%element(first_read)%is_read) return
         first_read = tree%element(first_read)%last + 1
      end do
      first_read = 0
   end function first_read

   !> The first element of a name inside another
   pure integer function find_child(tree, at, name)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      !> The name
      character(len=*), intent(in) :: name

      find_child = first_child(tree, at)
      do while (find_child > 0)
         if (tree%element(find_child)%name == name) return
         find_child = next_sibling(tree, find_child)
      end do
   end function find_child

   !> How many elements of a name are inside another
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

   !> Where an element has an attribute: the first of this name; 0 if there is none
   pure integer function attribute_place(tree, at, name)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      !> Name of the attribute
      character(len=*), intent(in) :: name
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
      !> Its value without blanks around it; empty if there is none
      character(len=:), allocatable :: value
      integer :: i

      value = ""
      i = attribute_place(tree, at, name)
      if (i > 0) value = trim(adjustl(tree%element(at)%attribute(i)%value))
   end function attribute_of
end module dda_xml_tree
