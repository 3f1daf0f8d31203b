!> Geometry and analysis files in the plain format: numbers in a fixed order (Shi: dc01, df02)
module dda_plain_files
   use dda_error, only : error_t, fatal_error, warnings_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : analysis_material_t, limerick_analysis_t, limerick_joint_t
   use dda_line_model, only : add_entity, entities_t, entity_name, entity_role, line_model_t
   use dda_text, only : to_text
   use dda_word_list, only : check_number, largest_coordinate, largest_material, split_words, &
      & take_number, take_property, take_whole, take_word_numbers, this_row, warn_of_rest, &
      & word_list_t, words_left
   implicit none
   private

   public :: read_plain_geometry, read_plain_analysis, check_material, check_joint, check_steps
   public :: largest_value, n_coordinates, plain_order

   !> Roles of the records after the lines, in the order of the file
   integer, parameter :: plain_order(6) = [entity_role%material, entity_role%bolt, &
      & entity_role%fix, entity_role%load, entity_role%measure, entity_role%hole]
   !> Maximum number of entities of a kind
   integer, parameter :: most_things = 100000000
   !> Largest magnitude of a number in an analysis
   real(wp), parameter :: largest_value = 1.0e30_wp
   !> Maximum number of materials of a kind
   integer, parameter :: most_materials = 1000000
   !> Maximum number of steps
   integer, parameter :: most_steps = 1000000000

contains

   !> Read a geometry file
   pure subroutine read_plain_geometry(text, file, model, warnings, error)
      character(len=*), intent(in) :: text              !! The file's text
      character(len=*), intent(in) :: file              !! Name of the file
      type(line_model_t), intent(out) :: model
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an invalid file, with line
      type(word_list_t) :: words
      integer :: k, n(0:size(plain_order))

      model%file = file
      call split_words(text, file, 1, words)
      call take_number(words, "the edge-node distance ratio e00", model%edge_node_ratio, error)
      if (allocated(error) .and. index(text, ";") > 0) error%message = error%message// &
         & "; of a geometry of gmsh import the mesh: voussoir import FILE.msh"
      call check_number(model%edge_node_ratio >= 0.0_wp .and. model%edge_node_ratio <= 0.5_wp, &
         & "the edge-node distance ratio e00 must be from 0 to 0.5", model%edge_node_ratio, file, &
         & words%row(1), error)
      call take_whole(words, "the number of lines", 0, most_things, n(0), error)
      call take_whole(words, "the number of boundary lines (counted among the lines)", 0, n(0), &
         & model%n_boundary, error)
      do k = 1, size(plain_order)
         call take_whole(words, "the number of "//trim(entity_name(plain_order(k)))//"s", 0, &
            & most_things, n(k), error)
      end do
      if (allocated(error)) return
      call read_records(words, entity_role%joint, n(0), model%line, error)
      do k = 1, size(plain_order)
         call read_records(words, plain_order(k), n(k), model%of(plain_order(k)), error)
      end do
      if (.not. allocated(error)) call warn_of_rest(words, "last record", warnings)
   end subroutine read_plain_geometry

   !> Read the records of one role
   pure subroutine read_records(words, role, n, entities, error)
      type(word_list_t), intent(inout) :: words
      integer, intent(in) :: role  !! One of entity_role
      integer, intent(in) :: n     !! Number of records
      type(entities_t), intent(out) :: entities
      type(error_t), allocatable, intent(inout) :: error
      character(len=*), parameter :: what(3) = [character(len=9) :: "stiffness", "strength", &
         & "prestress"]
      character(len=:), allocatable :: name
      real(wp) :: place(4)
      real(wp), allocatable :: property(:)
      integer :: i, k, row, material, n_number

      n_number = n_coordinates(role)
      if (role == entity_role%bolt) allocate (property(size(what)))
      do i = 1, n
         row = this_row(words)
         name = trim(entity_name(role))//" "//to_text(i)//" of "//to_text(n)
         call take_word_numbers(words, "a coordinate of "//name, largest_coordinate, &
            & place(:n_number), error)
         if (n_number == 2) place(3:4) = place(1:2)
         material = 0
         if (role <= entity_role%material) call take_whole(words, "the material of "//name, 1, &
            & largest_material, material, error)
         do k = 1, merge(size(what), 0, allocated(property))
            call take_property(words, "the "//trim(what(k))//" of "//name, property(k), error)
         end do
         if (allocated(error)) return
         call add_entity(entities, place, material, row, property)
      end do
   end subroutine read_records

   !> Number of coordinates of a record: those of a point or of two ends
   pure integer function n_coordinates(role)
      integer, intent(in) :: role

      n_coordinates = merge(2, 4, &
         & any(role == [entity_role%load, entity_role%measure, entity_role%hole]))
   end function n_coordinates

   !> Read an analysis file; constants that the format lacks have Shi's values
   pure subroutine read_plain_analysis(text, file, analysis, warnings, error)
      character(len=*), intent(in) :: text
      character(len=*), intent(in) :: file
      type(limerick_analysis_t), intent(out) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      real(wp) :: step(2)
      integer :: kind, n_material, n_joint, row

      analysis%file = file
      allocate (analysis%load(0))
      call split_words(text, file, 1, words)
      call take_whole(words, "the type of analysis (0 static, 1 dynamic)", 0, 1, kind, error)
      analysis%dynamic = kind == 1
      call take_whole(words, "the number of time steps", 1, most_steps, analysis%max_steps, error)
      call take_whole(words, "the number of block materials", 1, most_materials, n_material, error)
      call take_whole(words, "the number of joint materials", 1, most_materials, n_joint, error)
      row = this_row(words)
      call take_word_numbers(words, "the largest displacement ratio", largest_value, step(:1), &
         & error)
      call take_word_numbers(words, "the largest time step", largest_value, step(2:), error)
      analysis%max_displacement_ratio = step(1)
      analysis%time_step = step(2)
      call check_steps(analysis, file, row, error)
      call read_materials(words, n_material, analysis, error)
      call read_joints(words, n_joint, analysis, error)
      if (allocated(error)) return
      analysis%gravity = 0.0_wp
      if (analysis%material(1)%density > 0.0_wp) &
         & analysis%gravity = analysis%material(1)%unit_weight/analysis%material(1)%density
      call warn_of_rest(words, "last record", warnings)
   end subroutine read_plain_analysis

   !> Read the materials of the blocks
   pure subroutine read_materials(words, n, analysis, error)
      type(word_list_t), intent(inout) :: words
      integer, intent(in) :: n
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: value(13)
      integer :: i, row

      call check_room(words, "block", n, size(value), error)
      allocate (analysis%material(merge(0, n, allocated(error))))
      do i = 1, size(analysis%material)
         row = this_row(words)
         call take_word_numbers(words, "a number of block material "//to_text(i), largest_value, &
            & value, error)
         analysis%material(i) = analysis_material_t(value(1), value(2), value(3), value(4), &
            & value(5:7), value(8:10), value(11:13))
         call check_material(analysis%material(i), words%file, row, error)
         if (allocated(error)) return
      end do
   end subroutine read_materials

   !> Read the materials of the joints
   pure subroutine read_joints(words, n, analysis, error)
      type(word_list_t), intent(inout) :: words
      integer, intent(in) :: n
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: value(3)
      integer :: i, row

      call check_room(words, "joint", n, size(value), error)
      allocate (analysis%joint(merge(0, n, allocated(error))))
      do i = 1, size(analysis%joint)
         row = this_row(words)
         call take_word_numbers(words, "a number of joint material "//to_text(i), largest_value, &
            & value, error)
         analysis%joint(i) = limerick_joint_t(value(1), value(2), value(3))
         call check_joint(analysis%joint(i), words%file, row, error)
         if (allocated(error)) return
      end do
   end subroutine read_joints

   !> Check that there are enough words for all materials before allocating them
   pure subroutine check_room(words, what, n, n_number, error)
      type(word_list_t), intent(in) :: words
      character(len=*), intent(in) :: what  !! Use of the materials, for the message
      integer, intent(in) :: n
      integer, intent(in) :: n_number       !! Numbers per material
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error) .or. words_left(words) >= n_number*n) return
      call fatal_error(error, "expected "//to_text(n)//" "//what//" materials of " &
         & //to_text(n_number)//" numbers, got "//to_text(words_left(words)) &
         & //" more words; add what is missing", words%file, this_row(words))
   end subroutine check_room

   !> Check a block material
   pure subroutine check_material(material, file, row, error)
      type(analysis_material_t), intent(in) :: material
      character(len=*), intent(in) :: file
      integer, intent(in) :: row  !! Line of the file
      type(error_t), allocatable, intent(inout) :: error

      call check_number(material%density > 0.0_wp, "the unit mass must be above 0", &
         & material%density, file, row, error)
      call check_number(material%unit_weight >= 0.0_wp, "the unit weight must be 0 or more", &
         & material%unit_weight, file, row, error)
      call check_number(material%young > 0.0_wp, "Young's modulus must be above 0", &
         & material%young, file, row, error)
      call check_number(material%poisson > -1.0_wp .and. material%poisson < 0.5_wp, &
         & "Poisson's ratio must be between -1 and 0.5", material%poisson, file, row, error)
   end subroutine check_material

   !> Check a joint material
   pure subroutine check_joint(joint, file, row, error)
      type(limerick_joint_t), intent(in) :: joint
      character(len=*), intent(in) :: file
      integer, intent(in) :: row
      type(error_t), allocatable, intent(inout) :: error

      call check_number(joint%friction_deg >= 0.0_wp .and. joint%friction_deg <= 90.0_wp, &
         & "the friction angle must be from 0 to 90 degrees", joint%friction_deg, file, row, error)
      call check_number(joint%cohesion >= 0.0_wp .and. joint%tension >= 0.0_wp, &
         & "cohesion and tensile strength must be 0 or more", &
         & min(joint%cohesion, joint%tension), file, row, error)
   end subroutine check_joint

   !> Check the limits of a step
   pure subroutine check_steps(analysis, file, row, error)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=*), intent(in) :: file
      integer, intent(in) :: row
      type(error_t), allocatable, intent(inout) :: error

      call check_number(analysis%max_displacement_ratio > 0.0_wp &
         & .and. analysis%max_displacement_ratio <= 1.0_wp, &
         & "the largest displacement ratio must be above 0 and at most 1", &
         & analysis%max_displacement_ratio, file, row, error)
      call check_number(analysis%time_step > 0.0_wp, "the largest time step must be above 0", &
         & analysis%time_step, file, row, error)
   end subroutine check_steps

end module dda_plain_files
