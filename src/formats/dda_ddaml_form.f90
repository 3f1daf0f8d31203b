!> Elements of DDAML files with their parents and contents; unknown ones are reported
module dda_ddaml_form
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_word_list, only : quoted, split_words, this_row, this_word, word_list_t
   use dda_xml_tree, only : attribute_place, find_child, xml_tree_t
   implicit none
   private

   public :: form_t, geometry_form, analysis_form, find_part, check_elements

   !> Elements with one meaning inside one parent
   type :: form_t
      character(len=18) :: outer = ""       !! Name of the outer element
      character(len=34) :: names = ""       !! Names of the elements, a blank before and after each
      character(len=36) :: attributes = ""  !! Names of the attributes, likewise
      logical :: has_numbers = .false.      !! True if the elements contain numbers
      logical :: repeats = .false.          !! True if the element may occur more than once
   end type form_t

   logical, parameter :: yes = .true., no = .false.

   !> Elements of a geometry file
   type(form_t), parameter :: geometry_form(*) = [ &
      & form_t("Geometry", " Edgenodedist ", " distance ", no, no), &
      & form_t("Geometry", " Boundlist Jointlist Matlinelist ", "", no, yes), &
      & form_t("Geometry", " Fixedpointlist Loadpointlist ", "", no, yes), &
      & form_t("Geometry", " Measuredpointlist ", "", no, yes), &
      & form_t("Geometry", " Holepointlist Seismicpointlist ", "", no, yes), &
      & form_t("Geometry", " Boltlist ", "", no, yes), &
      & form_t("Boltlist", " Bolt ", " type stiffness strength pretension ", yes, yes), &
      & form_t("Boundlist", " Line Joint ", " type ", yes, yes), &
      & form_t("Jointlist", " Joint ", " type ", yes, yes), &
      & form_t("Matlinelist", " Line ", " type ", yes, yes), &
      & form_t("Fixedpointlist", " Point Line ", "", yes, yes), &
      & form_t("Loadpointlist", " Point ", "", yes, yes), &
      & form_t("Measuredpointlist", " Point ", "", yes, yes), &
      & form_t("Holepointlist", " Point ", "", yes, yes), &
      & form_t("Seismicpointlist", " Point ", "", yes, yes)]

   !> Elements of an analysis file
   type(form_t), parameter :: analysis_form(*) = [ &
      & form_t("Analysis", " Analysistype ", " type ", no, no), &
      & form_t("Analysis", " Rotation ", " type ", no, no), &
      & form_t("Analysis", " Gravity ", " flag ", no, no), &
      & form_t("Gravity", " Gravitysteplimit ", " val ", no, no), &
      & form_t("Gravity", " Normaltolerance ", " val ", no, no), &
      & form_t("Gravity", " Sheartolerance ", " val ", no, no), &
      & form_t("Analysis", " Gravaccel ", " value ", no, no), &
      & form_t("Analysis", " Autotimestep ", " flag ", no, no), &
      & form_t("Analysis", " Autopenalty ", " flag pfactor ", no, no), &
      & form_t("Analysis", " Planestrain ", " flag ", no, no), &
      & form_t("Analysis", " Numtimesteps ", " timesteps ", no, no), &
      & form_t("Analysis", " Maxtimestep ", " maxtimestep ", no, no), &
      & form_t("Analysis", " Mintimestep ", " mintimestep ", no, no), &
      & form_t("Analysis", " Maxdisplacement ", " maxdisplacement ", no, no), &
      & form_t("Analysis", " Opencloselimit OCLimit ", " maxopenclose ", no, no), &
      & form_t("Analysis", " Saveinterval ", " step ", no, no), &
      & form_t("Analysis", " Contactdamping ContactDamping ", " value ", no, no), &
      & form_t("Analysis", " Writevertices ", " flag ", no, no), &
      & form_t("Analysis", " AConstants ", "", no, no), &
      & form_t("Analysis", " Blockmaterial Jointproperties ", " type ", no, yes), &
      & form_t("Analysis", " Loadpointlist ", "", no, yes), &
      & form_t("Analysis", " Boltproperties ", " type ", yes, yes), &
      & form_t("AConstants", " Openclose ", " value ", no, no), &
      & form_t("AConstants", " Opencriteria ", " value ", no, no), &
      & form_t("AConstants", " NormSpringPen ", " value ", no, no), &
      & form_t("AConstants", " AngleOverlap ", " value ", no, no), &
      & form_t("AConstants", " ShearNormRatio ", " value ", no, no), &
      & form_t("AConstants", " MinReflineFactor ", " value ", no, no), &
      & form_t("Blockmaterial", " Unitmass ", "", yes, no), &
      & form_t("Blockmaterial", " Unitweight ", "", yes, no), &
      & form_t("Blockmaterial", " Youngsmod ", "", yes, no), &
      & form_t("Blockmaterial", " Poissonratio ", "", yes, no), &
      & form_t("Blockmaterial", " Damping ", "", yes, no), &
      & form_t("Blockmaterial", " Istress ", "", yes, no), &
      & form_t("Blockmaterial", " Ivelocity ", "", yes, no), &
      & form_t("Blockmaterial", " Istrain ", "", yes, no), &
      & form_t("Jointproperties", " Friction ", "", yes, no), &
      & form_t("Jointproperties", " Cohesion ", "", yes, no), &
      & form_t("Jointproperties", " Tensile ", "", yes, no), &
      & form_t("Loadpointlist", " Loadpoint ", " numpoints ", yes, yes)]

contains

   !> Find a part of a file: inside the root, or the root itself
   pure subroutine find_part(tree, name, part, error)
      type(xml_tree_t), intent(in) :: tree
      character(len=*), intent(in) :: name              !! Name of the part
      integer, intent(out) :: part                      !! Its place
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the part is missing

      part = 1
      if (tree%element(1)%name == name) return
      part = find_child(tree, 1, name)
      if (part == 0) call fatal_error(error, "expected an element "//name//" inside the root, " &
         & //"got none; add it", tree%file, tree%element(1)%row)
   end subroutine find_part

   !> Check all elements of a file and mark those to be skipped
   pure subroutine check_elements(tree, part, form, warnings, error)
      type(xml_tree_t), intent(inout) :: tree
      integer, intent(in) :: part                       !! Place of the part that is read
      type(form_t), intent(in) :: form(:)               !! Elements allowed in it
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid element
      !> Entry of each element in the form: 0 for the root and the part, below 0 if it is skipped
      integer, allocatable :: entry(:)
      !> Parent in which each entry last occurred: (size of form)
      integer :: met_in(size(form)), i, outer

      allocate (entry(tree%n))
      entry(1) = 0
      met_in = 0
      call check_text(tree, 1, warnings)
      do i = 2, tree%n
         outer = tree%element(i)%parent
         entry(i) = -1
         if (entry(outer) < 0) cycle
         entry(i) = entry_of(tree, i, part, form)
         if (entry(i) < 0) then
            tree%element(i)%is_read = .false.
            call refuse_element(tree, i, entry(outer), form, warnings, error)
         else if (entry(i) == 0) then
            if (i /= part) call refuse_second(tree, i, error)
            call check_text(tree, i, warnings)
         else
            associate (this => form(entry(i)))
               if (met_in(entry(i)) == outer .and. .not. this%repeats) &
                  & call refuse_second(tree, i, error)
               if (.not. allocated(error)) call check_attributes(tree, i, this, warnings, error)
               if (.not. this%has_numbers) call check_text(tree, i, warnings)
               met_in(entry(i)) = outer
            end associate
         end if
         if (allocated(error)) return
      end do
   end subroutine check_elements

   !> Entry of an element in a form: 0 for the part itself, -1 if unknown
   pure integer function entry_of(tree, at, part, form)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of the element
      integer, intent(in) :: part
      type(form_t), intent(in) :: form(:)
      integer :: i

      associate (element => tree%element(at))
         if (element%parent == 1 .and. part /= 1) then
            entry_of = merge(0, -1, element%name == tree%element(part)%name)
            return
         end if
         do i = 1, size(form)
            if (form(i)%outer /= tree%element(element%parent)%name) cycle
            if (index(form(i)%names, " "//element%name//" ") == 0) cycle
            entry_of = i
            return
         end do
      end associate
      entry_of = -1
   end function entry_of

   !> Report an unknown element: an error among numbers, else a warning
   pure subroutine refuse_element(tree, at, outer, form, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      integer, intent(in) :: outer         !! Entry of the outer element in the form
      type(form_t), intent(in) :: form(:)  !! Elements allowed in the part
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(inout) :: error
      logical :: among_numbers

      associate (element => tree%element(at), around => tree%element(tree%element(at)%parent))
         among_numbers = .false.
         if (outer > 0) among_numbers = form(outer)%has_numbers
         if (among_numbers) then
            call fatal_error(error, "expected numbers alone in "//quoted(around%name) &
               & //", got the element "//quoted(element%name)//" among them; move it out", &
               & tree%file, element%row)
         else
            call add_warning(warnings, "the element "//quoted(element%name)//" has no meaning in " &
               & //quoted(around%name)//" and is ignored", tree%file, element%row)
         end if
      end associate
   end subroutine refuse_element

   !> Report the second of two elements where only one is allowed
   pure subroutine refuse_second(tree, at, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(error_t), allocatable, intent(inout) :: error

      associate (element => tree%element(at), around => tree%element(tree%element(at)%parent))
         call fatal_error(error, "expected one element "//quoted(element%name)//" in " &
            & //quoted(around%name)//", got a second one; remove one of them", tree%file, &
            & element%row)
      end associate
   end subroutine refuse_second

   !> Warn of unknown attributes; report one that occurs twice
   pure subroutine check_attributes(tree, at, form, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(form_t), intent(in) :: form
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(inout) :: error
      integer :: i

      associate (element => tree%element(at))
         do i = 1, size(element%attribute)
            associate (name => element%attribute(i)%name)
               if (index(form%attributes, " "//name//" ") == 0) then
                  call add_warning(warnings, "the attribute "//quoted(name) &
                     & //" has no meaning in "//quoted(element%name)//" and is ignored", &
                     & tree%file, element%row)
               else if (attribute_place(tree, at, name) /= i) then
                  call fatal_error(error, "expected one attribute "//quoted(name)//" of " &
                     & //quoted(element%name)//", got two; remove one of them", tree%file, &
                     & element%row)
                  return
               end if
            end associate
         end do
      end associate
   end subroutine check_attributes

   !> Warn of text in an element that must be empty
   pure subroutine check_text(tree, at, warnings)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(warnings_t), intent(inout) :: warnings
      type(word_list_t) :: words

      call split_words(tree%element(at)%text, tree%file, tree%element(at)%text_row, words)
      if (words%n > 0) call add_warning(warnings, "text has no meaning in " &
         & //quoted(tree%element(at)%name)//" and is ignored: "//quoted(this_word(words)), &
         & tree%file, this_row(words))
   end subroutine check_text
end module dda_ddaml_form
