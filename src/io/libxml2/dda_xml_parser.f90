!> XML by libxml2's reader (https://gnome.pages.gitlab.gnome.org/libxml2/): no network, no DTD, no
!> entities of the file's own
module dda_xml_parser
   use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_long, &
      & c_null_char, c_null_ptr, c_ptr, c_size_t, c_sizeof
   use dda_error, only : error_t, fatal_error
   use dda_word_list, only : quoted
   use dda_xml_tree, only : new_xml_tree, open_element, xml_attribute_t, xml_tree_t
   implicit none
   private

   public :: parse_xml, has_xml

   !> Whether this build reads XML
   logical, parameter :: has_xml = .true.
   !> Deepest element that is read
   integer, parameter :: max_depth = 100
   !> libxml2: print neither errors nor warnings, never use the network, count lines beyond 65535
   integer(c_int), parameter :: options = int(ior(ior(32, 64), ior(2048, 4194304)), c_int)

   !> libxml2's kinds of nodes
   type :: node_enum
      !> An element begins
      integer :: element = 1
      !> Text
      integer :: text = 3
      !> Text that may hold marks
      integer :: cdata = 4
      !> An entity that was not replaced
      integer :: entity = 5
      !> An instruction to a program
      integer :: instruction = 7
      !> A comment
      integer :: comment = 8
      !> Blanks between elements
      integer :: blank = 13
      !> Blanks that count
      integer :: significant_blank = 14
      !> An element ends
      integer :: element_end = 15
   end type node_enum

   !> Names of the kinds
   type(node_enum), parameter :: node = node_enum()

   !> libxml2's xmlError as far as it is used here
   type, bind(c) :: xml_error_t
      !> Part of the library
      integer(c_int) :: domain
      !> Number of the error
      integer(c_int) :: code
      !> What happened
      type(c_ptr) :: message
      !> How bad it is
      integer(c_int) :: level
      !> Name of the file
      type(c_ptr) :: file
      !> Line of the file
      integer(c_int) :: line
   end type xml_error_t

   interface
      !> libxml2: a reader of a text in memory
      function reader_for_memory(text, size, url, encoding, options) &
         & bind(c, name="xmlReaderForMemory") result(reader)
         import :: c_int, c_ptr
         !> The text
         type(c_ptr), intent(in), value :: text
         !> Its length
         integer(c_int), intent(in), value :: size
         !> Name of the file
         type(c_ptr), intent(in), value :: url
         !> Encoding; null to find it
         type(c_ptr), intent(in), value :: encoding
         !> Sum of options
         integer(c_int), intent(in), value :: options
         !> The reader; null after a failure
         type(c_ptr) :: reader
      end function reader_for_memory

      !> libxml2: free a reader
      subroutine free_reader(reader) bind(c, name="xmlFreeTextReader")
         import :: c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
      end subroutine free_reader

      !> libxml2: go to the next node
      function read_node(reader) bind(c, name="xmlTextReaderRead") result(status)
         import :: c_int, c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> 1 if there is one, 0 at the end, -1 after a failure
         integer(c_int) :: status
      end function read_node

      !> libxml2: kind of this node
      function node_type(reader) bind(c, name="xmlTextReaderNodeType") result(kind)
         import :: c_int, c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> One of node_enum
         integer(c_int) :: kind
      end function node_type

      !> libxml2: whether this element ends where it begins
      function is_empty(reader) bind(c, name="xmlTextReaderIsEmptyElement") result(yes)
         import :: c_int, c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> 1 if it does
         integer(c_int) :: yes
      end function is_empty

      !> libxml2: go to the next attribute
      function next_attribute(reader) bind(c, name="xmlTextReaderMoveToNextAttribute") &
         & result(status)
         import :: c_int, c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> 1 if there is one
         integer(c_int) :: status
      end function next_attribute

      !> libxml2: name without prefix
      function local_name(reader) bind(c, name="xmlTextReaderConstLocalName") result(name)
         import :: c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> C's text
         type(c_ptr) :: name
      end function local_name

      !> libxml2: text or value
      function node_value(reader) bind(c, name="xmlTextReaderConstValue") result(value)
         import :: c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> C's text
         type(c_ptr) :: value
      end function node_value

      !> libxml2: this node of the tree
      function current_node(reader) bind(c, name="xmlTextReaderCurrentNode") result(at)
         import :: c_ptr
         !> The reader
         type(c_ptr), intent(in), value :: reader
         !> The node
         type(c_ptr) :: at
      end function current_node

      !> libxml2: line of a node
      function line_of_node(at) bind(c, name="xmlGetLineNo") result(line)
         import :: c_long, c_ptr
         !> The node
         type(c_ptr), intent(in), value :: at
         !> Its line
         integer(c_long) :: line
      end function line_of_node

      !> libxml2: what went wrong last
      function last_error() bind(c, name="xmlGetLastError") result(error)
         import :: c_ptr
         !> An xmlError, or null
         type(c_ptr) :: error
      end function last_error

      !> libxml2: forget what went wrong
      subroutine reset_error() bind(c, name="xmlResetLastError")
      end subroutine reset_error

      !> C: length of a text
      function c_strlen(text) bind(c, name="strlen") result(length)
         import :: c_ptr, c_size_t
         !> The text
         type(c_ptr), intent(in), value :: text
         !> Characters before the null character
         integer(c_size_t) :: length
      end function c_strlen

      !> C: copy bytes
      subroutine c_memcpy(to, from, n) bind(c, name="memcpy")
         import :: c_ptr, c_size_t
         !> Where they go
         type(c_ptr), intent(in), value :: to
         !> Where they are
         type(c_ptr), intent(in), value :: from
         !> How many
         integer(c_size_t), intent(in), value :: n
      end subroutine c_memcpy
   end interface

contains

   !> Read an XML text
   subroutine parse_xml(text, file, tree, error)
      !> The file's text
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Its elements
      type(xml_tree_t), intent(out) :: tree
      !> What is not XML, with its line
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable, target :: kept
      type(c_ptr) :: reader
      integer(c_int) :: status
      integer :: at, depth, first, skipped

      call new_xml_tree(file, tree)
      call reset_error()
      ! XML allows no blank lines before it, people do
      first = max(1, verify(text, " "//achar(9)//achar(10)))
      skipped = len(line_ends(text(:first - 1))) - 1
      ! libxml2 reads the text where it is, as long as the reader lives
      kept = text(first:)//c_null_char
      reader = reader_for_memory(c_loc(kept(1:1)), len(kept, c_int) - 1, c_null_ptr, c_null_ptr, &
         & options)
      status = -1
      at = 0
      depth = 0
      do while (c_associated(reader))
         status = read_node(reader)
         if (status /= 1) exit
         call take_node(reader, tree, at, depth, error)
         if (allocated(error)) exit
      end do
      if (.not. allocated(error) .and. status /= 0) call tell_error(file, error)
      if (c_associated(reader)) call free_reader(reader)
      if (allocated(error)) error%line = error%line + skipped
      tree%element(:tree%n)%row = tree%element(:tree%n)%row + skipped
      if (.not. allocated(error) .and. tree%n == 0) &
         & call fatal_error(error, "an XML element is wanted, none was found; write one", file, 1)
   end subroutine parse_xml

   !> Take what the reader stands on
   subroutine take_node(reader, tree, at, depth, error)
      !> The reader
      type(c_ptr), intent(in) :: reader
      !> Receives elements and texts
      type(xml_tree_t), intent(inout) :: tree
      !> Place of the element that is open; 0 outside the root
      integer, intent(inout) :: at
      !> How many elements are open
      integer, intent(inout) :: depth
      !> What the tree has no place for
      type(error_t), allocatable, intent(out) :: error
      integer :: kind, row

      kind = int(node_type(reader))
      if (kind == node%element) then
         row = int(line_of_node(current_node(reader)))
         call open_element(tree, fortran_text(local_name(reader)), row, at)
         depth = depth + 1
         if (depth > max_depth) call fatal_error(error, "elements at most "// &
            & "100 deep are wanted, found deeper ones; remove some", tree%file, row)
         at = tree%n
         if (is_empty(reader) == 1) then
            at = tree%element(at)%parent
            depth = depth - 1
         end if
         call take_attributes(reader, tree)
      else if (kind == node%element_end) then
         at = tree%element(at)%parent
         depth = depth - 1
      else if (at == 0) then
         return
      else if (kind == node%entity) then
         call fatal_error(error, "text without entities is wanted, found &" &
            & //fortran_text(local_name(reader))//"; write what it stands for", tree%file, &
            & tree%element(at)%row)
      else if (kind == node%comment .or. kind == node%instruction) then
         tree%element(at)%text = tree%element(at)%text &
            & //line_ends(fortran_text(node_value(reader)))
      else if (any(kind == [node%text, node%cdata, node%blank, node%significant_blank])) then
         tree%element(at)%text = tree%element(at)%text//fortran_text(node_value(reader))
      end if
   end subroutine take_node

   !> Take the attributes of the element that began last
   subroutine take_attributes(reader, tree)
      !> The reader, on the element
      type(c_ptr), intent(in) :: reader
      !> Receives the attributes
      type(xml_tree_t), intent(inout) :: tree
      type(xml_attribute_t), allocatable :: list(:), longer(:)
      integer :: n

      n = 0
      allocate (list(0))
      do while (next_attribute(reader) == 1)
         allocate (longer(n + 1))
         longer(:n) = list
         n = n + 1
         longer(n)%name = fortran_text(local_name(reader))
         longer(n)%value = fortran_text(node_value(reader))
         call move_alloc(longer, list)
      end do
      call move_alloc(list, tree%element(tree%n)%attribute)
   end subroutine take_attributes

   !> Make an error of what libxml2 says
   subroutine tell_error(file, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> The error
      type(error_t), allocatable, intent(out) :: error
      type(xml_error_t), target :: said
      character(len=:), allocatable :: message
      integer :: line
      type(c_ptr) :: address

      message = "unknown"
      line = 1
      address = last_error()
      if (c_associated(address)) then
         call c_memcpy(c_loc(said), address, c_sizeof(said))
         message = fortran_text(said%message)
         line = int(said%line)
      end if
      if (index(message, achar(10)) > 0) message = message(:index(message, achar(10)) - 1)
      call fatal_error(error, "well-formed XML is wanted, libxml2 found "//quoted(message) &
         & //"; correct it", file, line)
   end subroutine tell_error

   !> A C text as Fortran's
   function fortran_text(address) result(text)
      !> Where it is; may be null
      type(c_ptr), intent(in) :: address
      !> The same characters
      character(len=:), allocatable, target :: text
      integer(c_size_t) :: n

      n = 0
      if (c_associated(address)) n = c_strlen(address)
      text = repeat(" ", int(n))
      if (n > 0) call c_memcpy(c_loc(text(1:1)), address, n)
   end function fortran_text

   !> The line ends of a text
   pure function line_ends(text) result(ends)
      !> The text
      character(len=*), intent(in) :: text
      !> A blank, then its line feeds
      character(len=:), allocatable :: ends
      integer :: i

      ends = " "
      do i = 1, len(text)
         if (text(i:i) == achar(10)) ends = ends//achar(10)
      end do
   end function line_ends
end module dda_xml_parser
