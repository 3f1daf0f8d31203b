!> Geometry and analysis files of the Limerick line, plain or DDAML, known by their first word
module dda_read_limerick
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_line_model, only : entities_t, line_model_t
   use dda_plain_files, only : read_plain_analysis, read_plain_geometry
   use dda_text, only : to_text
   use dda_text_file, only : read_text_file
   use dda_xml_parser, only : parse_xml
   use dda_xml_tree, only : xml_tree_t
   implicit none
   private

   public :: read_geometry, read_analysis, check_materials, read_ddaml_analysis
   public :: read_ddaml_geometry

   !> Forms that a file can have
   type :: form_enum
      integer :: plain = 1     !! Numbers between blanks
      integer :: ddaml = 2     !! XML
      integer :: extended = 3  !! A form that the original announces and does not read either
      integer :: blank = 4     !! Nothing but blanks
   end type form_enum

   !> Names of the forms
   type(form_enum), parameter :: form = form_enum()

   interface

      !> Read the analysis of a tree
      pure module subroutine read_ddaml_analysis(tree, analysis, warnings, error)
         !> The file's elements; those that are not read are marked
         type(xml_tree_t), intent(inout) :: tree
         type(limerick_analysis_t), intent(out) :: analysis
         type(warnings_t), intent(inout) :: warnings
         !> What is wrong, with its line
         type(error_t), allocatable, intent(out) :: error
      end subroutine read_ddaml_analysis

      !> Read the geometry of a tree
      pure module subroutine read_ddaml_geometry(tree, model, warnings, error)
         type(xml_tree_t), intent(inout) :: tree
         type(line_model_t), intent(out) :: model
         type(warnings_t), intent(inout) :: warnings
         type(error_t), allocatable, intent(out) :: error
      end subroutine read_ddaml_geometry

   end interface

contains

   !> Read a geometry file
   subroutine read_geometry(file, model, warnings, error)
      character(len=*), intent(in) :: file  !! Name of the file
      type(line_model_t), intent(out) :: model
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error  !! What is wrong, with file and line
      character(len=:), allocatable :: text
      type(xml_tree_t) :: tree

      call read_form(file, text, tree, error)
      if (allocated(error)) return
      if (form_of(text) == form%ddaml) then
         call read_ddaml_geometry(tree, model, warnings, error)
      else
         call read_plain_geometry(text, file, model, warnings, error)
      end if
   end subroutine read_geometry

   !> Read an analysis file
   subroutine read_analysis(file, analysis, warnings, error)
      character(len=*), intent(in) :: file
      type(limerick_analysis_t), intent(out) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      type(xml_tree_t) :: tree

      call read_form(file, text, tree, error)
      if (allocated(error)) return
      if (form_of(text) == form%ddaml) then
         call read_ddaml_analysis(tree, analysis, warnings, error)
      else
         call read_plain_analysis(text, file, analysis, warnings, error)
      end if
   end subroutine read_analysis

   !> Read the text of a file, in DDAML as a tree too
   subroutine read_form(file, text, tree, error)
      character(len=*), intent(in) :: file
      character(len=:), allocatable, intent(out) :: text  !! The file's text
      type(xml_tree_t), intent(out) :: tree
      type(error_t), allocatable, intent(out) :: error

      call read_text_file(file, text, error)
      if (allocated(error)) return
      select case (form_of(text))
      case (form%ddaml)
         call parse_xml(text, file, tree, error)
      case (form%blank)
         call fatal_error(error, "the file is blank; write numbers or XML into it", file, 1)
      case (form%extended)
         call fatal_error(error, "expected the plain form or DDAML, got the extended form " &
            & //"#!0xDDA-v1, which is not read; save it as one of the two", file, 1)
      end select
   end subroutine read_form

   !> Whether an analysis has a material for each block and joint, and a force for each load point
   pure subroutine check_materials(model, analysis, warnings, error)
      type(line_model_t), intent(in) :: model
      type(limerick_analysis_t), intent(in) :: analysis
      type(warnings_t), intent(inout) :: warnings       !! Receives load points without a force
      type(error_t), allocatable, intent(out) :: error  !! What is missing

      call check_numbers(model%line, "joint", size(analysis%joint), model%file, analysis%file, &
         & error)
      if (.not. allocated(error)) call check_numbers(model%material_line, "block", &
         & size(analysis%material), model%file, analysis%file, error)
      if (allocated(error) .or. size(analysis%load) == model%load%n) return
      if (size(analysis%load) == 0) then
         call add_warning(warnings, "a load point has no force: "//analysis%file//" gives none", &
            & model%file, model%load%row(1))
      else
         call fatal_error(error, "expected forces on "//to_text(model%load%n) &
            & //" load points, as many as "//model%file//" has, got " &
            & //to_text(size(analysis%load))//"; add or remove forces", analysis%file, 1)
      end if
   end subroutine check_materials

   !> Whether all materials of a list exist
   pure subroutine check_numbers(entities, what, n, file, analysis_file, error)
      type(entities_t), intent(in) :: entities
      character(len=*), intent(in) :: what           !! What the materials are for
      integer, intent(in) :: n                       !! How many materials there are
      character(len=*), intent(in) :: file           !! Name of the geometry file
      character(len=*), intent(in) :: analysis_file  !! Name of the analysis file
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, entities%n
         if (entities%material(i) <= n) cycle
         call fatal_error(error, "expected one of the "//to_text(n)//" "//what//" materials of " &
            & //analysis_file//", got number "//to_text(entities%material(i)) &
            & //"; correct it or add the material", file, entities%row(i))
         return
      end do
   end subroutine check_numbers

   !> Form of a file
   pure integer function form_of(text)
      character(len=*), intent(in) :: text  !! Its text
      integer :: first

      first = verify(text, " "//achar(9)//achar(10))
      form_of = form%blank
      if (first == 0) return
      form_of = form%plain
      if (text(first:first) == "<") form_of = form%ddaml
      if (index(text(first:), "#!0xDDA-v1") == 1) form_of = form%extended
   end function form_of
end module dda_read_limerick
