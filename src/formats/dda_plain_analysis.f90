!> Analysis files in the plain form: numbers between blanks, in a fixed order (Shi: df02)
module dda_plain_analysis
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t, limerick_joint_t, analysis_material_t
   use dda_text, only : to_text
   use dda_warnings, only : add_warning, warnings_t
   use dda_word_list, only : quoted, split_words, take_word_numbers, take_whole, this_row, &
      & this_word, word_list_t, words_left
   implicit none
   private

   public :: read_plain_analysis, check_material, check_joint, check_steps, largest_value

   !> Largest magnitude of any number of an analysis
   real(wp), parameter :: largest_value = 1.0e30_wp
   !> Most materials of a kind
   integer, parameter :: most_materials = 1000000
   !> Most steps
   integer, parameter :: most_steps = 1000000000

contains

   !> Read an analysis file; the constants that it cannot give are the original's own
   pure subroutine read_plain_analysis(text, file, analysis, warnings, error)
      !> The file's text
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      type(limerick_analysis_t), intent(out) :: analysis
      type(warnings_t), intent(inout) :: warnings
      !> What is wrong, with its line
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      integer :: kind, n_material, n_joint, row

      analysis%file = file
      allocate (analysis%load(0))
      call split_words(text, file, 1, words)
      call take_whole(words, "the type of analysis (0 static, 1 dynamic)", 0, 1, kind, error)
      analysis%dynamic = kind == 1
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of time steps", 1, most_steps, analysis%max_steps, &
         & error)
      if (.not. allocated(error)) call take_whole(words, "the number of block materials", 1, &
         & most_materials, n_material, error)
      if (.not. allocated(error)) call take_whole(words, "the number of joint materials", 1, &
         & most_materials, n_joint, error)
      if (.not. allocated(error)) row = this_row(words)
      if (.not. allocated(error)) call read_steps(words, analysis, error)
      if (.not. allocated(error)) call check_steps(analysis, file, row, error)
      if (.not. allocated(error)) call read_materials(words, n_material, analysis, error)
      if (.not. allocated(error)) call read_joints(words, n_joint, analysis, error)
      if (allocated(error)) return
      analysis%gravity = 0.0_wp
      if (analysis%material(1)%density > 0.0_wp) &
         & analysis%gravity = analysis%material(1)%unit_weight/analysis%material(1)%density
      if (words_left(words) > 0) call add_warning(warnings, "trailing text ignored after the " &
         & //"last record: "//quoted(this_word(words)), file, this_row(words))
   end subroutine read_plain_analysis

   !> Read the two numbers that bound a step
   pure subroutine read_steps(words, analysis, error)
      type(word_list_t), intent(inout) :: words
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: value(1)

      call take_word_numbers(words, "the largest displacement ratio", largest_value, value, error)
      if (allocated(error)) return
      analysis%max_displacement_ratio = value(1)
      call take_word_numbers(words, "the largest time step", largest_value, value, error)
      analysis%time_step = value(1)
   end subroutine read_steps

   !> Read the materials of the blocks
   pure subroutine read_materials(words, n, analysis, error)
      type(word_list_t), intent(inout) :: words
      !> How many there are
      integer, intent(in) :: n
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(out) :: error
      type(analysis_material_t), allocatable :: list(:)
      real(wp) :: value(13)
      integer :: i, row

      if (words_left(words) < 13*n) then
         call fatal_error(error, "expected "//to_text(n)//" block materials of 13 numbers, " &
            & //"got "//to_text(words_left(words))//" more words; add what is missing", &
            & words%file, this_row(words))
         return
      end if
      allocate (list(n))
      do i = 1, n
         row = this_row(words)
         call take_word_numbers(words, "a number of block material "//to_text(i), largest_value, &
            & value, error)
         if (allocated(error)) return
         list(i) = analysis_material_t(value(1), value(2), value(3), value(4), value(5:7), &
            & value(8:10), value(11:13))
         call check_material(list(i), words%file, row, error)
         if (allocated(error)) return
      end do
      call move_alloc(list, analysis%material)
   end subroutine read_materials

   !> Read the materials of the joints
   pure subroutine read_joints(words, n, analysis, error)
      type(word_list_t), intent(inout) :: words
      integer, intent(in) :: n
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(out) :: error
      type(limerick_joint_t), allocatable :: list(:)
      real(wp) :: value(3)
      integer :: i, row

      if (words_left(words) < 3*n) then
         call fatal_error(error, "expected "//to_text(n)//" joint materials of 3 numbers, got " &
            & //to_text(words_left(words))//" more words; add what is missing", words%file, &
            & this_row(words))
         return
      end if
      allocate (list(n))
      do i = 1, n
         row = this_row(words)
         call take_word_numbers(words, "a number of joint material "//to_text(i), largest_value, &
            & value, error)
         if (allocated(error)) return
         list(i) = limerick_joint_t(value(1), value(2), value(3))
         call check_joint(list(i), words%file, row, error)
         if (allocated(error)) return
      end do
      call move_alloc(list, analysis%joint)
   end subroutine read_joints

   !> Whether a block material can exist
   pure subroutine check_material(material, file, row, error)
      type(analysis_material_t), intent(in) :: material
      character(len=*), intent(in) :: file
      !> Line of the file
      integer, intent(in) :: row
      type(error_t), allocatable, intent(out) :: error

      if (.not. material%density > 0.0_wp) then
         call fatal_error(error, "the unit mass must be above 0, got " &
            & //to_text(material%density)//"; correct it", file, row)
      else if (material%unit_weight < 0.0_wp) then
         call fatal_error(error, "the unit weight must be 0 or more, got " &
            & //to_text(material%unit_weight)//"; correct it", file, row)
      else if (.not. material%young > 0.0_wp) then
         call fatal_error(error, "Young's modulus must be above 0, got " &
            & //to_text(material%young)//"; correct it", file, row)
      else if (material%poisson <= -1.0_wp .or. material%poisson >= 0.5_wp) then
         call fatal_error(error, "Poisson's ratio must be between -1 and 0.5, got " &
            & //to_text(material%poisson)//"; correct it", file, row)
      end if
   end subroutine check_material

   !> Whether a joint material can exist
   pure subroutine check_joint(joint, file, row, error)
      type(limerick_joint_t), intent(in) :: joint
      character(len=*), intent(in) :: file
      integer, intent(in) :: row
      type(error_t), allocatable, intent(out) :: error

      if (joint%friction_deg < 0.0_wp .or. joint%friction_deg > 90.0_wp) then
         call fatal_error(error, "the friction angle must be from 0 to 90 degrees, got " &
            & //to_text(joint%friction_deg)//"; correct it", file, row)
      else if (joint%cohesion < 0.0_wp .or. joint%tension < 0.0_wp) then
         call fatal_error(error, "cohesion and tensile strength must be 0 or more, got " &
            & //to_text(min(joint%cohesion, joint%tension))//"; correct it", file, row)
      end if
   end subroutine check_joint

   !> Whether the bounds of a step make sense
   pure subroutine check_steps(analysis, file, row, error)
      type(limerick_analysis_t), intent(in) :: analysis
      character(len=*), intent(in) :: file
      integer, intent(in) :: row
      type(error_t), allocatable, intent(out) :: error

      if (.not. analysis%max_displacement_ratio > 0.0_wp &
         & .or. analysis%max_displacement_ratio > 1.0_wp) then
         call fatal_error(error, "the largest displacement ratio must be above 0 and at most 1, " &
            & //"got "//to_text(analysis%max_displacement_ratio)//"; correct it", file, row)
      else if (.not. analysis%time_step > 0.0_wp) then
         call fatal_error(error, "the largest time step must be above 0, got " &
            & //to_text(analysis%time_step)//"; correct it", file, row)
      end if
   end subroutine check_steps
end module dda_plain_analysis
