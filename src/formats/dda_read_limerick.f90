!> Reading of geometry and analysis files of the Limerick format, plain or DDAML
module dda_read_limerick
   use dda_ddaml_form, only : check_elements, find_part, geometry_form
   use dda_ddaml_material, only : attribute_words, element_words
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_line_model, only : add_entity, entities_t, entity_role, line_model_t
   use dda_plain_files, only : read_plain_analysis, read_plain_geometry
   use dda_text, only : to_text
   use dda_text_file, only : read_text_file
   use dda_word_list, only : check_number, largest_coordinate, largest_material, take_number, &
      & take_property, take_whole, take_word_numbers, warn_of_rest, word_list_t
   use dda_xml_parser, only : parse_xml
   use dda_xml_tree, only : attribute_place, first_child, next_sibling, xml_tree_t
   implicit none
   private

   public :: read_geometry, read_analysis, check_materials, read_ddaml_analysis
   public :: read_ddaml_geometry

   interface

      !> Read the analysis from an element tree
      pure module subroutine read_ddaml_analysis(tree, analysis, warnings, error)
         !> Elements of the file; skipped elements are marked
         type(xml_tree_t), intent(inout) :: tree
         type(limerick_analysis_t), intent(out) :: analysis
         type(warnings_t), intent(inout) :: warnings
         type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid file
      end subroutine read_ddaml_analysis

   end interface

   !> Names of the lists, by the roles of their contents
   character(len=*), parameter :: list_name(*) = [character(len=17) :: "Jointlist", &
      & "Matlinelist", "Fixedpointlist", "Loadpointlist", "Measuredpointlist", "Holepointlist", &
      & "Boltlist", "Seismicpointlist"]
   !> Default material of an entity: none, the first one, or required
   integer, parameter :: no_material = 0, first_material = 1, own_material = -1

contains

   !> Read a geometry file
   subroutine read_geometry(file, model, warnings, error)
      character(len=*), intent(in) :: file              !! Name of the file
      type(line_model_t), intent(out) :: model
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid file
      character(len=:), allocatable :: text
      type(xml_tree_t) :: tree
      logical :: is_ddaml

      call read_form(file, text, tree, is_ddaml, error)
      if (allocated(error)) return
      if (is_ddaml) then
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
      logical :: is_ddaml

      call read_form(file, text, tree, is_ddaml, error)
      if (allocated(error)) return
      if (is_ddaml) then
         call read_ddaml_analysis(tree, analysis, warnings, error)
      else
         call read_plain_analysis(text, file, analysis, warnings, error)
      end if
   end subroutine read_analysis

   !> Read the text of a file, and its element tree if it is in DDAML
   subroutine read_form(file, text, tree, is_ddaml, error)
      character(len=*), intent(in) :: file
      character(len=:), allocatable, intent(out) :: text  !! The file's text
      type(xml_tree_t), intent(out) :: tree
      logical, intent(out) :: is_ddaml                    !! True if it is in DDAML
      type(error_t), allocatable, intent(out) :: error
      integer :: first

      is_ddaml = .false.
      call read_text_file(file, text, error)
      if (allocated(error)) return
      first = verify(text, " "//achar(9)//achar(10))
      if (first == 0) first = len(text) + 1
      is_ddaml = index(text(first:), "<") == 1
      if (is_ddaml) then
         call parse_xml(text, file, tree, error)
      else if (first > len(text)) then
         call fatal_error(error, "the file is blank; write numbers or XML into it", file, 1)
      else if (index(text(first:), "#!0xDDA-v1") == 1) then
         call fatal_error(error, "expected the plain form or DDAML, got the extended form " &
            & //"#!0xDDA-v1, which is not read; save it as one of the two", file, 1)
      end if
   end subroutine read_form

   !> Check that an analysis has a material for each block and joint, and a force for each load
   !> point
   pure subroutine check_materials(model, analysis, warnings, error)
      type(line_model_t), intent(in) :: model
      type(limerick_analysis_t), intent(in) :: analysis
      type(warnings_t), intent(inout) :: warnings       !! Receives load points without a force
      type(error_t), allocatable, intent(out) :: error  !! Allocated if a material is missing

      call check_numbers(model%line, "joint", size(analysis%joint), model%file, analysis%file, &
         & error)
      if (.not. allocated(error)) call check_numbers(model%of(entity_role%material), "block", &
         & size(analysis%material), model%file, analysis%file, error)
      if (allocated(error) .or. size(analysis%load) == model%of(entity_role%load)%n) return
      if (size(analysis%load) == 0) then
         call add_warning(warnings, "a load point has no force: "//analysis%file//" gives none", &
            & model%file, model%of(entity_role%load)%row(1))
      else
         call fatal_error(error, "expected forces on "//to_text(model%of(entity_role%load)%n) &
            & //" load points, as many as "//model%file//" has, got " &
            & //to_text(size(analysis%load))//"; add or remove forces", analysis%file, 1)
      end if
   end subroutine check_materials

   !> Check that all material numbers of a list exist
   pure subroutine check_numbers(entities, what, n, file, analysis_file, error)
      type(entities_t), intent(in) :: entities
      character(len=*), intent(in) :: what           !! Use of the materials, for the message
      integer, intent(in) :: n                       !! Number of materials
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

   !> Read the geometry from an element tree
   pure subroutine read_ddaml_geometry(tree, model, warnings, error)
      type(xml_tree_t), intent(inout) :: tree
      type(line_model_t), intent(out) :: model
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(entities_t) :: boundary
      integer :: part, at, i

      call find_part(tree, "Geometry", part, error)
      if (.not. allocated(error)) call check_elements(tree, part, geometry_form, warnings, error)
      if (allocated(error)) return
      model%file = tree%file
      at = first_child(tree, part)
      do while (at > 0 .and. .not. allocated(error))
         call read_list(tree, at, model, boundary, warnings, error)
         at = next_sibling(tree, at)
      end do
      if (allocated(error)) return
      ! boundary lines precede joints
      model%n_boundary = boundary%n
      do i = 1, model%line%n
         call add_entity(boundary, model%line%place(:, i), model%line%material(i), &
            & model%line%row(i))
      end do
      model%line = boundary
   end subroutine read_ddaml_geometry

   !> Read one child of Geometry
   pure subroutine read_list(tree, at, model, boundary, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of the child
      type(line_model_t), intent(inout) :: model
      type(entities_t), intent(inout) :: boundary
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: role

      associate (element => tree%element(at))
         role = findloc(list_name == element%name, .true., dim=1)
         if (element%name == "Edgenodedist") then
            call read_ratio(tree, at, model%edge_node_ratio, error)
         else if (element%name == "Boundlist") then
            call read_entities(tree, at, first_material, boundary, warnings, error)
         else if (role == entity_role%joint) then
            call read_entities(tree, at, own_material, model%line, warnings, error)
         else if (role > 0) then
            call read_entities(tree, at, merge(own_material, no_material, &
               & role == entity_role%material), model%of(role), warnings, error)
            if (allocated(error) .or. role /= entity_role%seismic) return
            if (model%of(role)%n > 0) call add_warning(warnings, "seismic points have no effect", &
               & tree%file, element%row)
         end if
      end associate
   end subroutine read_list

   !> Read Shi's e00
   pure subroutine read_ratio(tree, at, ratio, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at         !! Place of the element
      real(wp), intent(inout) :: ratio  !! The ratio
      type(error_t), allocatable, intent(inout) :: error
      type(word_list_t) :: words

      call attribute_words(tree, at, "distance", words, error)
      call take_number(words, "the edge-node distance", ratio, error)
      call check_number(ratio >= 0.0_wp .and. ratio <= 0.5_wp, &
         & "the edge-node distance must be from 0 to 0.5", ratio, tree%file, &
         & tree%element(at)%row, error)
   end subroutine read_ratio

   !> Read the elements of a list
   pure subroutine read_entities(tree, list, usual, entities, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: list   !! Place of the list
      integer, intent(in) :: usual  !! Default material, as above
      type(entities_t), intent(inout) :: entities
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      at = first_child(tree, list)
      do while (at > 0 .and. .not. allocated(error))
         call read_entity(tree, at, usual, entities, warnings, error)
         at = next_sibling(tree, at)
      end do
   end subroutine read_entities

   !> Read one element of a list. Bolt properties may be attributes (an extension); otherwise they
   !> are in the analysis file
   pure subroutine read_entity(tree, at, usual, entities, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at, usual
      type(entities_t), intent(inout) :: entities
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(inout) :: error
      type(word_list_t) :: words
      character(len=*), parameter :: attribute(3) = [character(len=10) :: "stiffness", "strength", &
         & "pretension"]
      real(wp) :: place(4)
      real(wp), allocatable :: property(:)
      integer :: material, k, n

      associate (name => tree%element(at)%name)
         material = usual
         if (usual == own_material .or. usual == first_material &
            & .and. attribute_place(tree, at, "type") > 0) then
            call attribute_words(tree, at, "type", words, error)
            call take_whole(words, "the type of "//name, 1, largest_material, material, error)
         end if
         n = merge(2, 4, name == "Point")
         call element_words(tree, at, words)
         call take_word_numbers(words, "a coordinate of "//name, largest_coordinate, place(:n), &
            & error)
         if (allocated(error)) return
         if (n == 2) place(3:4) = place(1:2)
         call warn_of_rest(words, "coordinates of "//name, warnings)
         if (name == "Bolt") property = [-1.0_wp, -1.0_wp, -1.0_wp]
         do k = 1, merge(3, 0, name == "Bolt" .and. attribute_place(tree, at, "stiffness") > 0)
            call attribute_words(tree, at, trim(attribute(k)), words, error)
            call take_property(words, "the "//trim(attribute(k))//" of a bolt", property(k), error)
         end do
         if (.not. allocated(error)) call add_entity(entities, place, material, &
            & tree%element(at)%row, property)
      end associate
   end subroutine read_entity

end module dda_read_limerick
