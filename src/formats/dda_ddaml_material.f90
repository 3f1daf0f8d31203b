!> Attributes and words of DDAML elements, and the materials and loads of an analysis file.
!> Procedures that read do nothing after an error, so the first error is kept
module dda_ddaml_material
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : analysis_material_t, limerick_joint_t, load_history_t
   use dda_plain_files, only : check_joint, check_material, largest_value
   use dda_text, only : short_text, to_text
   use dda_word_list, only : check_number, quoted, split_words, take_whole, take_word_numbers, &
      & this_row, warn_of_rest, word_list_t
   use dda_xml_tree, only : attribute_of, find_child, xml_tree_t
   implicit none
   private

   public :: attribute_words, choose, element_error, element_words, number_attribute
   public :: read_material, read_joint, read_history, whole_attribute

   !> Largest integer
   integer, parameter :: largest_whole = 1000000000

   !> Relative difference within which unit weights are equal
   real(wp), parameter :: same_weight = 1.0e-6_wp

contains

   !> Words of a required attribute
   pure subroutine attribute_words(tree, at, name, words, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at             !! Place of the element
      character(len=*), intent(in) :: name  !! Name of the attribute
      type(word_list_t), intent(out) :: words
      type(error_t), allocatable, intent(inout) :: error  !! An earlier error or a missing attribute

      call split_words(attribute_of(tree, at, name), tree%file, tree%element(at)%row, words)
      words%row = tree%element(at)%row
      if (words%n /= 1) call element_error(tree, at, "expected the attribute "//name &
         & //" with one value in "//quoted(tree%element(at)%name)//", got " &
         & //quoted(attribute_of(tree, at, name))//"; write one value", error)
   end subroutine attribute_words

   !> The words inside an element
   pure subroutine element_words(tree, at, words, also_blank)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(word_list_t), intent(out) :: words
      character(len=*), intent(in), optional :: also_blank  !! Separators of words besides blanks

      call split_words(tree%element(at)%text, tree%file, tree%element(at)%text_row, words, &
         & also_blank)
   end subroutine element_words

   !> Set an error at an element, unless one is set already
   pure subroutine element_error(tree, at, message, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      character(len=*), intent(in) :: message  !! Expected and actual value
      type(error_t), allocatable, intent(inout) :: error

      if (.not. allocated(error)) &
         & call fatal_error(error, message, tree%file, tree%element(at)%row)
   end subroutine element_error

   !> Read an attribute with two choices from an optional element
   pure subroutine choose(tree, outer, element, name, words_for_yes, word_for_no, yes, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: outer             !! Place of the outer element
      character(len=*), intent(in) :: element  !! Name of the element
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: words_for_yes       !! Words for yes, separated by blanks
      character(len=*), intent(in) :: word_for_no         !! The word for no
      logical, intent(inout) :: yes                       !! The choice
      type(error_t), allocatable, intent(inout) :: error  !! An earlier error or another word
      character(len=:), allocatable :: word
      integer :: at

      at = find_child(tree, outer, element)
      if (at == 0) return
      word = attribute_of(tree, at, name)
      yes = len(word) > 0 .and. index(" "//words_for_yes//" ", " "//word//" ") > 0
      if (.not. yes .and. word /= word_for_no) call element_error(tree, at, "the attribute " &
         & //name//" of "//quoted(element)//" must be one of "//words_for_yes//" " &
         & //word_for_no//", got "//quoted(word)//"; choose one", error)
   end subroutine choose

   !> Read a number from an attribute of an optional element
   pure subroutine number_attribute(tree, outer, element, name, low, value, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: outer
      character(len=*), intent(in) :: element, name
      real(wp), intent(in) :: low       !! Smallest value
      real(wp), intent(inout) :: value  !! The number
      type(error_t), allocatable, intent(inout) :: error
      type(word_list_t) :: words
      real(wp) :: number(1)
      integer :: at

      at = find_child(tree, outer, element)
      if (at == 0) return
      call attribute_words(tree, at, name, words, error)
      call take_word_numbers(words, "the attribute "//name, largest_value, number, error)
      if (allocated(error)) return
      value = number(1)
      call check_number(value >= low, "the attribute "//name//" must be "//short_text(low) &
         & //" or more", value, tree%file, tree%element(at)%row, error)
   end subroutine number_attribute

   !> Read an integer from an attribute of an optional element
   pure subroutine whole_attribute(tree, outer, element, name, low, value, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: outer
      character(len=*), intent(in) :: element, name
      integer, intent(in) :: low       !! Smallest value
      integer, intent(inout) :: value  !! The number
      type(error_t), allocatable, intent(inout) :: error
      type(word_list_t) :: words
      integer :: at

      at = find_child(tree, outer, element)
      if (at == 0) return
      call attribute_words(tree, at, name, words, error)
      call take_whole(words, "the attribute "//name, low, largest_whole, value, error)
   end subroutine whole_attribute

   !> Read a Blockmaterial
   pure subroutine read_material(tree, at, gravity, material, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      real(wp), intent(in) :: gravity  !! Acceleration of gravity, for a missing weight
      type(analysis_material_t), intent(out) :: material
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: value(4), unused(1)

      value = 0.0_wp
      call read_child(tree, at, "Unitmass", .true., value(1:1), warnings, error)
      value(2) = min(value(1), largest_value)*gravity
      call read_child(tree, at, "Youngsmod", .true., value(3:3), warnings, error)
      call read_child(tree, at, "Poissonratio", .true., value(4:4), warnings, error)
      call read_child(tree, at, "Unitweight", .false., value(2:2), warnings, error)
      material = analysis_material_t(value(1), value(2), value(3), value(4))
      if (.not. allocated(error)) call check_weight(tree, at, gravity, material, warnings)
      unused = 0.0_wp
      call read_child(tree, at, "Damping", .false., unused, warnings, error)
      call read_child(tree, at, "Istress", .false., material%stress, warnings, error)
      call read_child(tree, at, "Ivelocity", .false., material%velocity, warnings, error)
      call read_child(tree, at, "Istrain", .false., material%strain, warnings, error)
      call check_material(material, tree%file, tree%element(at)%row, error)
   end subroutine read_material

   !> Warn of a unit weight that differs from unit mass times gravity, which Shi's program uses
   pure subroutine check_weight(tree, at, gravity, material, warnings)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      real(wp), intent(in) :: gravity
      type(analysis_material_t), intent(inout) :: material
      type(warnings_t), intent(inout) :: warnings  !! Receives unused unit weights
      real(wp) :: weight

      weight = material%density*gravity
      if (abs(material%unit_weight - weight) <= same_weight*abs(weight)) return
      call add_warning(warnings, "expected Unitweight = Unitmass*Gravaccel = "//short_text(weight) &
         & //", got "//to_text(material%unit_weight)//": using the former", tree%file, &
         & tree%element(at)%row)
      material%unit_weight = weight
   end subroutine check_weight

   !> Read a Jointproperties
   pure subroutine read_joint(tree, at, joint, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(limerick_joint_t), intent(out) :: joint
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: value(3)

      value = 0.0_wp
      call read_child(tree, at, "Friction", .true., value(1:1), warnings, error)
      call read_child(tree, at, "Cohesion", .false., value(2:2), warnings, error)
      call read_child(tree, at, "Tensile", .false., value(3:3), warnings, error)
      joint = limerick_joint_t(value(1), value(2), value(3))
      call check_joint(joint, tree%file, tree%element(at)%row, error)
   end subroutine read_joint

   !> Read the numbers of a child element
   pure subroutine read_child(tree, at, name, needed, value, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at             !! Place of the parent
      character(len=*), intent(in) :: name  !! Name of the child
      logical, intent(in) :: needed         !! True if the child is required
      real(wp), intent(inout) :: value(:)   !! Numbers of the child; unchanged if it is missing: (n)
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(inout) :: error
      type(word_list_t) :: words
      integer :: child

      if (allocated(error)) return
      child = find_child(tree, at, name)
      if (child > 0) then
         call element_words(tree, child, words)
         call take_word_numbers(words, "a number of "//name, largest_value, value, error)
         if (.not. allocated(error)) call warn_of_rest(words, "numbers of "//name, warnings)
      else if (needed) then
         call element_error(tree, at, "expected the element "//name//" in " &
            & //tree%element(at)%name//", got none; add it", error)
         value = 0.0_wp
      end if
   end subroutine read_child

   !> Read a Loadpoint: records of time and force, separated by semicolons
   pure subroutine read_history(tree, at, history, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(load_history_t), intent(out) :: history
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      integer, parameter :: most_records = 10000000
      integer :: n, i, row

      call attribute_words(tree, at, "numpoints", words, error)
      call take_whole(words, "the attribute numpoints", 1, most_records, n, error)
      if (allocated(error)) return
      call element_words(tree, at, words, also_blank=";")
      if (words%n /= 3*n) call element_error(tree, at, "expected "//to_text(n) &
         & //" records of 3 numbers in Loadpoint, got "//to_text(words%n) &
         & //" numbers; correct numpoints or the records", error)
      if (allocated(error)) return
      allocate (history%record(3, n))
      do i = 1, n
         row = this_row(words)
         call take_word_numbers(words, "a number of record "//to_text(i), largest_value, &
            & history%record(:, i), error)
         if (allocated(error)) return
         if (i == 1) cycle
         if (history%record(1, i) > history%record(1, i - 1)) cycle
         call fatal_error(error, "expected increasing times in Loadpoint, got " &
            & //to_text(history%record(1, i))//" after "//to_text(history%record(1, i - 1)) &
            & //"; sort the records", tree%file, row)
         return
      end do
   end subroutine read_history

end module dda_ddaml_material
