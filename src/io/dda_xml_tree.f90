!> An XML file as a tree of elements: values that need no parser once they are there
module dda_xml_tree
   implicit none
   private

   public :: xml_tree_t, xml_element_t, xml_attribute_t, new_xml_tree, open_element, first_child
   public :: next_sibling, find_child, has_attribute, attribute_of

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
      !> The text directly inside it; of comments only the line ends, so that lines can be counted
      character(len=:), allocatable :: text
      !> Line of the file where its text begins
      integer :: row = 0
      !> Place of the element that holds it; 0 for the root
      integer :: parent = 0
      !> Place of the last element inside it, itself if there is none
      integer :: last = 0
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

   !> A tree without elements
   pure subroutine new_xml_tree(file, tree)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> The tree
      type(xml_tree_t), intent(out) :: tree

      tree%file = file
      allocate (tree%element(16))
   end subroutine new_xml_tree

   !> Add an element inside another
   pure subroutine open_element(tree, name, row, parent)
      !> The tree
      type(xml_tree_t), intent(inout) :: tree
      !> Name of the element
      character(len=*), intent(in) :: name
      !> Line of the file
      integer, intent(in) :: row
      !> Place of the element that holds it; 0 for the root
      integer, intent(in) :: parent
      type(xml_element_t), allocatable :: longer(:)
      integer :: i

      if (tree%n == size(tree%element)) then
         allocate (longer(2*tree%n))
         do i = 1, tree%n
            call move_element(tree%element(i), longer(i))
         end do
         call move_alloc(longer, tree%element)
      end if
      tree%n = tree%n + 1
      associate (new => tree%element(tree%n))
         new%name = name
         new%text = ""
         new%row = row
         new%parent = parent
         new%last = tree%n
         allocate (new%attribute(0))
      end associate
      i = parent
      do while (i > 0)
         tree%element(i)%last = tree%n
         i = tree%element(i)%parent
      end do
   end subroutine open_element

   !> Move an element without copying its texts
   pure subroutine move_element(from, to)
      !> The element; its parts go
      type(xml_element_t), intent(inout) :: from
      !> Receives them
      type(xml_element_t), intent(inout) :: to

      call move_alloc(from%name, to%name)
      call move_alloc(from%text, to%text)
      call move_alloc(from%attribute, to%attribute)
      to%row = from%row
      to%parent = from%parent
      to%last = from%last
   end subroutine move_element

   !> The first element inside another
   pure integer function first_child(tree, at)
      !> The tree
      type(xml_tree_t), intent(in) :: tree
      !> Place of the outer element
      integer, intent(in) :: at

      first_child = 0
      if (tree%element(at)%last > at) first_child = at + 1
   end function first_child

   !> The element that follows another inside the same one
   pure integer function next_sibling(tree, at)
      !> The tree
      type(xml_tree_t), intent(in) :: tree
      !> Place of the element
      integer, intent(in) :: at

      next_sibling = 0
      if (tree%element(at)%parent == 0) return
      if (tree%element(tree%element(at)%parent)%last > tree%element(at)%last) &
         & next_sibling = tree%element(at)%last + 1
   end function next_sibling

   !> The first element of a name inside another
   pure integer function find_child(tree, at, name)
      !> The tree
      type(xml_tree_t), intent(in) :: tree
      !> Place of the outer element
      integer, intent(in) :: at
      !> The name
      character(len=*), intent(in) :: name

      find_child = first_child(tree, at)
      do while (find_child > 0)
         if (tree%element(find_child)%name == name) return
         find_child = next_sibling(tree, find_child)
      end do
   end function find_child

   !> Whether an element has an attribute
   pure logical function has_attribute(tree, at, name)
      !> The tree
      type(xml_tree_t), intent(in) :: tree
      !> Place of the element
      integer, intent(in) :: at
      !> Name of the attribute
      character(len=*), intent(in) :: name
      integer :: i

      has_attribute = .false.
      associate (attribute => tree%element(at)%attribute)
         do i = 1, size(attribute)
            if (attribute(i)%name == name) has_attribute = .true.
         end do
      end associate
   end function has_attribute

   !> Value of an attribute
   pure function attribute_of(tree, at, name) result(value)
      !> The tree
      type(xml_tree_t), intent(in) :: tree
      !> Place of the element
      integer, intent(in) :: at
      !> Name of the attribute
      character(len=*), intent(in) :: name
      !> Its value without blanks around it; empty if there is none
      character(len=:), allocatable :: value
      integer :: i

      value = ""
      associate (attribute => tree%element(at)%attribute)
         do i = size(attribute), 1, -1
            if (attribute(i)%name == name) value = trim(adjustl(attribute(i)%value))
         end do
      end associate
   end function attribute_of
end module dda_xml_tree
