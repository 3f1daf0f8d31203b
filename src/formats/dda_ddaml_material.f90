!> Materials and loads of an analysis file in DDAML
module dda_ddaml_material
   use dda_ddaml_attributes, only : attribute_words
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_joint_t, analysis_material_t, load_history_t
   use dda_plain_analysis, only : check_joint, check_material, largest_value
   use dda_text, only : to_text
   use dda_warnings, only : add_warning, warnings_t
   use dda_word_list, only : quoted, split_words, take_word_numbers, take_whole, this_row, &
      & this_word, word_list_t, words_left
   use dda_xml_tree, only : find_child, xml_tree_t
   implicit none
   private

   public :: read_material, read_joint, read_history

   !> Weights that differ by less, relatively, are one weight with rounded digits
   real(wp), parameter :: same_weight = 1.0e-6_wp

contains

   !> Read a Blockmaterial
   pure subroutine read_material(tree, at, gravity, material, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      !> Place of the element
      integer, intent(in) :: at
      !> Acceleration of gravity, for a weight that is not given
      real(wp), intent(in) :: gravity
      type(analysis_material_t), intent(out) :: material
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: one(1), unused(1)

      call read_child(tree, at, "Unitmass", .true., one, warnings, error)
      material%density = one(1)
      if (.not. allocated(error)) call read_child(tree, at, "Youngsmod", .true., one, warnings, &
         & error)
      material%young = one(1)
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Poissonratio", .true., one, warnings, error)
      material%poisson = one(1)
      one = min(material%density, largest_value)*gravity
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Unitweight", .false., one, warnings, error)
      material%unit_weight = one(1)
      if (.not. allocated(error)) call check_weight(tree, at, gravity, material, warnings)
      unused = 0.0_wp
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Damping", .false., unused, warnings, error)
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Istress", .false., material%stress, warnings, error)
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Ivelocity", .false., material%velocity, warnings, error)
      if (.not. allocated(error)) &
         & call read_child(tree, at, "Istrain", .false., material%strain, warnings, error)
      if (.not. allocated(error)) &
         & call check_material(material, tree%file, tree%element(at)%row, error)
   end subroutine read_material

   !> The original weighs a block by unit mass times gravity, whatever the unit weight says
   pure subroutine check_weight(tree, at, gravity, material, warnings)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      real(wp), intent(in) :: gravity
      type(analysis_material_t), intent(inout) :: material
      !> Receives a unit weight that is not taken
      type(warnings_t), intent(inout) :: warnings
      real(wp) :: weight

      weight = material%density*gravity
      if (abs(material%unit_weight - weight) <= same_weight*abs(weight)) return
      call add_warning(warnings, "expected Unitweight = Unitmass*Gravaccel = "//to_text(weight) &
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
      real(wp) :: one(1)

      call read_child(tree, at, "Friction", .true., one, warnings, error)
      joint%friction_deg = one(1)
      one = 0.0_wp
      if (.not. allocated(error)) call read_child(tree, at, "Cohesion", .false., one, warnings, &
         & error)
      joint%cohesion = one(1)
      one = 0.0_wp
      if (.not. allocated(error)) call read_child(tree, at, "Tensile", .false., one, warnings, &
         & error)
      joint%tension = one(1)
      if (.not. allocated(error)) call check_joint(joint, tree%file, tree%element(at)%row, error)
   end subroutine read_joint

   !> Read the numbers of an element inside another
   pure subroutine read_child(tree, at, name, needed, value, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      !> Place of the outer element
      integer, intent(in) :: at
      !> Name of the inner element
      character(len=*), intent(in) :: name
      !> Whether it must be there
      logical, intent(in) :: needed
      !> Its numbers; left as they are if it is not there: (n)
      real(wp), intent(inout) :: value(:)
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      real(wp) :: number(size(value))
      integer :: child

      child = find_child(tree, at, name)
      if (child == 0) then
         if (needed) call fatal_error(error, "expected the element "//name//" in " &
            & //tree%element(at)%name//", got none; add it", tree%file, tree%element(at)%row)
         if (needed) value = 0.0_wp
         return
      end if
      call split_words(tree%element(child)%text, tree%file, tree%element(child)%text_row, words)
      call take_word_numbers(words, "a number of "//name, largest_value, number, error)
      value = number
      if (.not. allocated(error) .and. words_left(words) > 0) call add_warning(warnings, &
         & "trailing text ignored after the numbers of "//name//": "//quoted(this_word(words)), &
         & tree%file, this_row(words))
   end subroutine read_child

   !> Read a Loadpoint: records of time and force, parted by semicolons
   pure subroutine read_history(tree, at, history, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      type(load_history_t), intent(out) :: history
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      integer, parameter :: most_records = 10000000
      integer :: n, i, row

      call attribute_words(tree, at, "numpoints", words, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the attribute numpoints", 1, most_records, n, error)
      if (allocated(error)) return
      call split_words(tree%element(at)%text, tree%file, tree%element(at)%text_row, words, &
         & also_blank=";")
      if (words%n /= 3*n) then
         call fatal_error(error, "expected "//to_text(n)//" records of 3 numbers in Loadpoint, " &
            & //"got "//to_text(words%n)//" numbers; correct numpoints or the records", &
            & tree%file, tree%element(at)%row)
         return
      end if
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
