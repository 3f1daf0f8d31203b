!> XML by libxml2 (https://gnome.pages.gitlab.gnome.org/libxml2/): without network, DTD and entities
!> of the file
module dda_xml_parser
   use, intrinsic :: iso_c_binding, only : c_associated, c_funloc, c_funptr, c_int, c_loc, &
      & c_null_char, c_null_ptr, c_ptr, c_size_t, c_sizeof
   use, intrinsic :: ieee_exceptions, only : ieee_all, ieee_get_status, ieee_set_halting_mode, &
      & ieee_set_status, ieee_status_type
   use dda_error, only : error_t, fatal_error
   use dda_word_list, only : quoted
   use dda_xml_tags, only : count_of
   use dda_xml_tree, only : add_text, close_element, new_xml_builder, open_element, &
      & xml_attribute_t, xml_builder_t, xml_tree_t
   implicit none
   private

   public :: parse_xml, has_xml

   !> True if this build reads XML
   logical, parameter :: has_xml = .true.
   !> Maximum depth of elements
   integer, parameter :: max_depth = 100
   !> libxml2: print no errors and warnings, do not use the network, do not limit the length of
   !> texts
   integer(c_int), parameter :: options = int(ior(ior(32, 64), ior(2048, 524288)), c_int)

   !> libxml2's kinds of nodes
   type :: node_enum
      integer :: element = 1             !! Start of an element
      integer :: text = 3                !! Text
      integer :: cdata = 4               !! Text that may contain markup characters
      integer :: instruction = 7         !! A processing instruction
      integer :: comment = 8             !! A comment
      integer :: blank = 13              !! Blanks between elements
      integer :: significant_blank = 14  !! Significant blanks
      integer :: element_end = 15        !! End of an element
   end type node_enum

   !> Names of the kinds
   type(node_enum), parameter :: node = node_enum()

   !> libxml2's xmlError, as far as used here
   type, bind(c) :: xml_error_t
      integer(c_int) :: domain  !! Part of the library
      integer(c_int) :: code    !! Number of the error
      type(c_ptr) :: message    !! Text of the error
      integer(c_int) :: level   !! Severity
      type(c_ptr) :: file       !! Name of the file
      integer(c_int) :: line    !! Line of the file
   end type xml_error_t

   interface
      !> libxml2: initialise the library
      subroutine init_parser() bind(c, name="xmlInitParser")
      end subroutine init_parser

      !> libxml2: parse a text in memory. Its reader would parse in pieces of 512 bytes, and start
      !> long texts and names again with each piece
      function read_memory(text, size, url, encoding, options) &
         & bind(c, name="xmlReadMemory") result(document)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: text
         integer(c_int), intent(in), value :: size     !! Length of the text
         type(c_ptr), intent(in), value :: url
         type(c_ptr), intent(in), value :: encoding    !! Encoding; null to detect it
         integer(c_int), intent(in), value :: options  !! Sum of options
         type(c_ptr) :: document                       !! The document; null after a failure
      end function read_memory

      !> libxml2: free a document
      subroutine free_document(document) bind(c, name="xmlFreeDoc")
         import :: c_ptr
         type(c_ptr), intent(in), value :: document
      end subroutine free_document

      !> libxml2: make a reader of a document
      function reader_of(document) bind(c, name="xmlReaderWalker") result(reader)
         import :: c_ptr
         type(c_ptr), intent(in), value :: document
         type(c_ptr) :: reader  !! The reader; null after a failure
      end function reader_of

      !> libxml2: free a reader
      subroutine free_reader(reader) bind(c, name="xmlFreeTextReader")
         import :: c_ptr
         type(c_ptr), intent(in), value :: reader
      end subroutine free_reader

      !> libxml2: advance to the next node
      function read_node(reader) bind(c, name="xmlTextReaderRead") result(status)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: status  !! 1 for a node, 0 at the end, -1 after a failure
      end function read_node

      !> libxml2: kind of the current node
      function node_type(reader) bind(c, name="xmlTextReaderNodeType") result(kind)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: kind  !! One of node_enum
      end function node_type

      !> libxml2: 1 if the current element is empty and has no end node
      function is_empty(reader) bind(c, name="xmlTextReaderIsEmptyElement") result(yes)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: yes  !! 1 for an empty element
      end function is_empty

      !> libxml2: number of attributes and namespaces of the current element
      function count_attributes(reader) bind(c, name="xmlTextReaderAttributeCount") result(n)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: n  !! Number of attributes
      end function count_attributes

      !> libxml2: 1 if the current attribute declares a namespace
      function is_namespace(reader) bind(c, name="xmlTextReaderIsNamespaceDecl") result(yes)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: yes
      end function is_namespace

      !> libxml2: advance to the next attribute
      function next_attribute(reader) bind(c, name="xmlTextReaderMoveToNextAttribute") &
         & result(status)
         import :: c_int, c_ptr
         type(c_ptr), intent(in), value :: reader
         integer(c_int) :: status  !! 1 for an attribute
      end function next_attribute

      !> libxml2: name without prefix
      function local_name(reader) bind(c, name="xmlTextReaderConstLocalName") result(name)
         import :: c_ptr
         type(c_ptr), intent(in), value :: reader
         type(c_ptr) :: name  !! C text
      end function local_name

      !> libxml2: text or value
      function node_value(reader) bind(c, name="xmlTextReaderConstValue") result(value)
         import :: c_ptr
         type(c_ptr), intent(in), value :: reader
         type(c_ptr) :: value  !! C text
      end function node_value

      !> libxml2: set the receiver of errors, warnings and failed encodings
      subroutine set_error_listener(context, listener) bind(c, name="xmlSetStructuredErrorFunc")
         import :: c_funptr, c_ptr
         type(c_ptr), intent(in), value :: context
         type(c_funptr), intent(in), value :: listener
      end subroutine set_error_listener

      !> libxml2: the last error
      function last_error() bind(c, name="xmlGetLastError") result(error)
         import :: c_ptr
         type(c_ptr) :: error  !! An xmlError, or null
      end function last_error

      !> libxml2: delete the last error
      subroutine reset_error() bind(c, name="xmlResetLastError")
      end subroutine reset_error

      !> C: length of a text
      function c_strlen(text) bind(c, name="strlen") result(length)
         import :: c_ptr, c_size_t
         type(c_ptr), intent(in), value :: text
         integer(c_size_t) :: length  !! Number of characters before the null character
      end function c_strlen

      !> C: copy bytes
      subroutine c_memcpy(to, from, n) bind(c, name="memcpy")
         import :: c_ptr, c_size_t
         type(c_ptr), intent(in), value :: to, from
         integer(c_size_t), intent(in), value :: n  !! Number of bytes
      end subroutine c_memcpy
   end interface

contains

   !> Read an XML text
   subroutine parse_xml(text, file, tree, error)
      character(len=*), intent(in) :: text              !! The text of the file
      character(len=*), intent(in) :: file              !! Name of the file
      type(xml_tree_t), intent(out) :: tree
      type(error_t), allocatable, intent(out) :: error  !! Allocated for invalid XML, with its line
      character(len=:), allocatable, target :: kept
      type(xml_builder_t) :: builder
      type(c_ptr) :: document, reader
      integer :: first

      call new_xml_builder(text, file, builder, error)
      if (allocated(error)) return
      call begin_parser()
      ! XML allows no blank lines before it, but users write them
      first = max(1, verify(text, " "//achar(9)//achar(10)))
      kept = text(first:)//c_null_char
      document = read_memory(c_loc(kept(1:1)), len(kept, c_int) - 1, c_null_ptr, c_null_ptr, &
         & options)
      if (.not. c_associated(document)) call report_error(file, count_of(achar(10), &
         & text(:first - 1)), error)
      if (allocated(error)) return
      reader = reader_of(document)
      do while (read_node(reader) == 1)
         call take_node(reader, builder)
         if (builder%depth > max_depth) exit
      end do
      if (builder%depth > max_depth) then
         call fatal_error(error, "expected elements at most 100 deep, got deeper ones; " &
            & //"remove some", file, builder%tree%element(builder%open)%row)
      else if (builder%tree%n == 0) then
         call fatal_error(error, "expected an XML element, got none; write one", file, 1)
      end if
      call free_reader(reader)
      call free_document(document)
      call move_alloc(builder%tree%file, tree%file)
      call move_alloc(builder%tree%element, tree%element)
      tree%n = builder%tree%n
   end subroutine parse_xml

   !> Prepare libxml2, which divides by zero to make a NaN
   subroutine begin_parser()
      type(ieee_status_type) :: status

      call ieee_get_status(status)
      call ieee_set_halting_mode(ieee_all, .false.)
      call init_parser()
      call ieee_set_status(status)
      call reset_error()
      call set_error_listener(c_null_ptr, c_funloc(print_nothing))
   end subroutine begin_parser

   !> Receive an error without printing it; the last one is read later
   subroutine print_nothing(context, address) bind(c)
      type(c_ptr), intent(in), value :: context  !! Context passed with the listener
      type(c_ptr), intent(in), value :: address

      if (c_associated(context) .or. c_associated(address)) return
   end subroutine print_nothing

   !> Add the current node to the tree
   subroutine take_node(reader, builder)
      type(c_ptr), intent(in) :: reader
      type(xml_builder_t), intent(inout) :: builder
      type(xml_attribute_t), allocatable :: attribute(:)
      character(len=:), allocatable :: name
      integer :: kind
      logical :: ends

      kind = int(node_type(reader))
      if (kind == node%element) then
         name = fortran_text(local_name(reader))
         ends = is_empty(reader) == 1
         call take_attributes(reader, attribute)
         call open_element(builder, name, attribute)
         if (ends) call close_element(builder)
      else if (kind == node%element_end) then
         call close_element(builder)
      else if (kind == node%comment .or. kind == node%instruction) then
         call add_text(builder, " "//repeat(achar(10), &
            & count_of(achar(10), fortran_text(node_value(reader)))))
      else if (any(kind == [node%text, node%cdata, node%blank, node%significant_blank])) then
         call add_text(builder, fortran_text(node_value(reader)))
      end if
   end subroutine take_node

   !> Read the attributes of the current element
   subroutine take_attributes(reader, attribute)
      type(c_ptr), intent(in) :: reader
      !> The attributes without namespaces: (n)
      type(xml_attribute_t), allocatable, intent(out) :: attribute(:)
      type(xml_attribute_t), allocatable :: all(:)
      integer :: n

      allocate (all(max(0, int(count_attributes(reader)))))
      n = 0
      do while (next_attribute(reader) == 1)
         if (is_namespace(reader) == 1) cycle
         n = n + 1
         all(n)%name = fortran_text(local_name(reader))
         all(n)%value = fortran_text(node_value(reader))
      end do
      if (n == size(all)) then
         call move_alloc(all, attribute)
      else
         allocate (attribute(n), source=all(:n))
      end if
   end subroutine take_attributes

   !> Make an error from that of libxml2
   subroutine report_error(file, skipped, error)
      character(len=*), intent(in) :: file
      integer, intent(in) :: skipped  !! Number of lines of the file before the parsed text
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
      call fatal_error(error, "the XML is not well-formed: libxml2 says "//quoted(message) &
         & //"; correct it", file, line + skipped)
   end subroutine report_error

   !> Convert a C text to Fortran
   function fortran_text(address) result(text)
      type(c_ptr), intent(in) :: address  !! Address of the text; may be null
      character(len=:), allocatable, target :: text
      integer(c_size_t) :: n

      n = 0
      if (c_associated(address)) n = c_strlen(address)
      text = repeat(" ", int(n))
      if (n > 0) call c_memcpy(c_loc(text(1:1)), address, n)
   end function fortran_text
end module dda_xml_parser
