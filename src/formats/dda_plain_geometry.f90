!> Geometry files in the plain form: numbers between blanks, in a fixed order (Shi: dc01)
module dda_plain_geometry
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_line_model, only : add_bolt, add_entity, entities_t, line_model_t, new_entities, &
      & new_line_model
   use dda_text, only : to_text
   use dda_warnings, only : add_warning, warnings_t
   use dda_word_list, only : quoted, largest_coordinate, split_words, take_material, take_number, &
      & take_word_numbers, take_property, take_whole, this_row, this_word, word_list_t, words_left
   implicit none
   private

   public :: read_plain_geometry

   !> How many things of each kind a file announces
   type :: counts_t
      !> Lines, boundary lines among them
      integer :: lines = 0
      !> Boundary lines
      integer :: boundary = 0
      !> Material lines
      integer :: material_lines = 0
      !> Bolts
      integer :: bolts = 0
      !> Fixed points or lines
      integer :: fixed = 0
      !> Load points
      integer :: load = 0
      !> Measured points
      integer :: measured = 0
      !> Hole points
      integer :: hole = 0
   end type counts_t

contains

   !> Read a geometry file
   pure subroutine read_plain_geometry(text, file, model, warnings, error)
      !> The file's text
      character(len=*), intent(in) :: text
      !> Name of the file
      character(len=*), intent(in) :: file
      type(line_model_t), intent(out) :: model
      type(warnings_t), intent(inout) :: warnings
      !> What is wrong, with its line
      type(error_t), allocatable, intent(out) :: error
      type(word_list_t) :: words
      type(counts_t) :: n

      call new_line_model(model)
      model%file = file
      call split_words(text, file, 1, words)
      call take_number(words, "the edge-node distance ratio e00", model%edge_node_ratio, error)
      if (allocated(error)) return
      if (model%edge_node_ratio < 0.0_wp .or. model%edge_node_ratio > 0.5_wp) then
         call fatal_error(error, "the edge-node distance ratio e00 must be from 0 to 0.5, " &
            & //"got "//to_text(model%edge_node_ratio)//"; correct it", file, words%row(1))
         return
      end if
      call read_counts(words, n, error)
      if (allocated(error)) return
      model%n_boundary = n%boundary
      call read_records(words, "line", n%lines, 4, .true., model%line, error)
      if (.not. allocated(error)) call read_records(words, "material line", n%material_lines, 4, &
         & .true., model%material_line, error)
      if (.not. allocated(error)) call read_bolts(words, n%bolts, model, error)
      if (.not. allocated(error)) &
         & call read_records(words, "fixed point", n%fixed, 4, .false., model%fixed, error)
      if (.not. allocated(error)) &
         & call read_records(words, "load point", n%load, 2, .false., model%load, error)
      if (.not. allocated(error)) &
         & call read_records(words, "measured point", n%measured, 2, .false., model%measured, error)
      if (.not. allocated(error)) &
         & call read_records(words, "hole point", n%hole, 2, .false., model%hole, error)
      if (allocated(error)) return
      if (words_left(words) > 0) call add_warning(warnings, "trailing text ignored after the " &
         & //"last record: "//quoted(this_word(words)), file, this_row(words))
   end subroutine read_plain_geometry

   !> Read how many things there are
   pure subroutine read_counts(words, n, error)
      type(word_list_t), intent(inout) :: words
      type(counts_t), intent(out) :: n
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most = 100000000

      call take_whole(words, "the number of lines", 0, most, n%lines, error)
      if (.not. allocated(error)) call take_whole(words, "the number of boundary lines " &
         & //"(counted among the lines)", 0, n%lines, n%boundary, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of material lines", 0, most, n%material_lines, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of bolts", 0, most, n%bolts, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of fixed points", 0, most, n%fixed, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of load points", 0, most, n%load, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of measured points", 0, most, n%measured, error)
      if (.not. allocated(error)) &
         & call take_whole(words, "the number of hole points", 0, most, n%hole, error)
   end subroutine read_counts

   !> Read bolts: ends, stiffness, strength and prestress of each, as Shi's programs have them
   pure subroutine read_bolts(words, n, model, error)
      type(word_list_t), intent(inout) :: words
      !> How many there are
      integer, intent(in) :: n
      type(line_model_t), intent(inout) :: model
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: what(3) = [character(len=9) :: "stiffness", "strength", &
         & "prestress"]
      real(wp) :: place(4), property(3)
      integer :: i, k, row

      do i = 1, n
         row = this_row(words)
         call take_word_numbers(words, "a coordinate of bolt "//to_text(i)//" of "//to_text(n), &
            & largest_coordinate, place, error)
         do k = 1, 3
            if (.not. allocated(error)) call take_property(words, "the "//trim(what(k)) &
               & //" of bolt "//to_text(i)//" of "//to_text(n), property(k), error)
         end do
         if (allocated(error)) return
         call add_bolt(model, place, property, row)
      end do
   end subroutine read_bolts

   !> Read the records of one kind
   pure subroutine read_records(words, what, n, n_number, has_material, entities, error)
      type(word_list_t), intent(inout) :: words
      !> What a record is called
      character(len=*), intent(in) :: what
      integer, intent(in) :: n
      !> Coordinates of each, 2 or 4
      integer, intent(in) :: n_number
      !> Whether a material follows
      logical, intent(in) :: has_material
      type(entities_t), intent(out) :: entities
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name
      real(wp) :: place(4)
      integer :: i, row, material

      call new_entities(entities, min(n, words_left(words)))
      do i = 1, n
         row = this_row(words)
         name = what//" "//to_text(i)//" of "//to_text(n)
         call take_word_numbers(words, "a coordinate of "//name, largest_coordinate, &
            & place(:n_number), error)
         if (n_number == 2) place(3:4) = place(1:2)
         material = 0
         if (has_material .and. .not. allocated(error)) &
            & call take_material(words, "the material of "//name, material, error)
         if (allocated(error)) return
         call add_entity(entities, place, material, row)
      end do
   end subroutine read_records
end module dda_plain_geometry
