!> Reading of a file of blocks: polygons, materials, points and actions, one per line
module dda_read_blocks
   use dda_block_input, only : block_plan_t, law_plan_t, material_plan_t, most_materials, new_plan
   use dda_block_lines, only : entry_t, keep_entry, largest_number, line_t, listed, split_line, &
      & take_words
   use dda_block_sites, only : site_t, survey
   use dda_deck_key, only : key_kind, key_t
   use dda_deck_keys, only : joint_keys, material_keys
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error, place_error, warnings_t
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_read_record, only : find_line
   use dda_text, only : place_text, read_integer, read_number, short_text, to_text
   use dda_watch, only : watch_t
   use dda_word_list, only : largest_coordinate
   implicit none
   private

   public :: parse_blocks

   !> Kinds of entries
   type :: entry_kind_t
      character(len=17) :: word  !! First word of the entry
      integer :: n_column        !! Number of numbers per row
   end type entry_kind_t

   !> All kinds of entries
   type(entry_kind_t), parameter :: entries(*) = [entry_kind_t("block", 2), &
      & entry_kind_t("material", 0), entry_kind_t("joint", 0), entry_kind_t("fix", 0), &
      & entry_kind_t("fix_line", 0), entry_kind_t("measure", 0), entry_kind_t("load", 3), &
      & entry_kind_t("live", 3), entry_kind_t("displacement", 3), &
      & entry_kind_t("base_acceleration", 3), entry_kind_t("base_velocity", 3), &
      & entry_kind_t("base_displacement", 3), entry_kind_t("bar", 0), entry_kind_t("water", 2), &
      & entry_kind_t("absorb", 0), entry_kind_t("remove", 2), entry_kind_t("add", 2)]

   !> Lines between two progress reports
   integer, parameter :: report_lines = 10000

   !> State of reading a file
   type :: reading_t
      character(len=:), allocatable :: file  !! Name of the file
      !> Blocks, materials and laws read so far, in arrays with spare capacity
      type(block_plan_t) :: plan
      integer :: n_block = 0   !! Number of blocks
      integer :: n_vertex = 0  !! Number of corners
      integer :: n_start = 0   !! Number of blocks with an initial velocity or stress
      integer :: n_law = 0     !! Number of laws
      type(entry_t) :: entry   !! The entry being read
      !> Entries of points, kept until all blocks are read: (n_later or more)
      type(entry_t), allocatable :: later(:)
      integer :: n_later = 0  !! Number of kept entries
   end type reading_t

   interface

      !> Read points, restrained lines and ground motion, after all blocks
      module subroutine add_points(later, plan, site, file, warnings, error, watch)
         !> Entries of points in the order of the file; their rows are deallocated
         type(entry_t), intent(inout) :: later(:)
         type(block_plan_t), intent(inout) :: plan
         type(site_t), intent(inout) :: site  !! Positions of the blocks; receives the points
         !> Name of the file, for warnings and relative paths of records
         character(len=*), intent(in) :: file
         type(warnings_t), intent(inout) :: warnings
         type(error_t), allocatable, intent(out) :: error
         class(watch_t), intent(inout), optional :: watch
      end subroutine add_points

      !> Add the block of an entry; repeated corners are merged, a clockwise order is reversed
      pure module subroutine add_plan_block(reading, fixed, material, warnings, error)
         type(reading_t), intent(inout) :: reading
         logical, intent(in) :: fixed     !! True for a fixed block
         integer, intent(in) :: material  !! Number of the material
         type(warnings_t), intent(inout) :: warnings
         type(error_t), allocatable, intent(out) :: error  !! Allocated if the block is invalid
      end subroutine add_plan_block

      !> Check a plan as a whole, and move its origin near the blocks
      pure module subroutine check_plan(plan, file, warnings, error)
         type(block_plan_t), intent(inout) :: plan
         character(len=*), intent(in) :: file  !! Name of the file, for warnings
         type(warnings_t), intent(inout) :: warnings
         !> Allocated if there is no block, or a missing or extra material or law
         type(error_t), allocatable, intent(out) :: error
      end subroutine check_plan

      !> Check that no two blocks overlap, except fixed ones
      module subroutine check_overlaps(plan, site, error, watch)
         type(block_plan_t), intent(in) :: plan
         type(site_t), intent(in) :: site
         type(error_t), allocatable, intent(out) :: error  !! Allocated for overlapping blocks
         class(watch_t), intent(inout), optional :: watch
      end subroutine check_overlaps

   end interface

contains

   !> Read blocks from the text of a file
   subroutine parse_blocks(text, file, plan, warnings, error, watch, tolerance)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: file  !! Name for messages
      type(block_plan_t), intent(out) :: plan
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      class(watch_t), intent(inout), optional :: watch
      !> Gap within which blocks touch, over the size of the smaller one
      real(wp), intent(in), optional :: tolerance
      type(reading_t) :: reading
      type(site_t) :: site
      type(line_t) :: line
      integer :: number, start, first, last

      reading%file = file
      call new_plan(reading%plan)
      if (present(tolerance)) reading%plan%tolerance = tolerance
      allocate (reading%later(0), reading%entry%row(3, 0))
      call split_line("", 0, reading%entry%head, error)
      start = 1
      number = 0
      do while (start <= len(text) .and. .not. allocated(error))
         call find_line(text, start, first, last, number)
         call split_line(text(first:last), number, line, error)
         if (.not. allocated(error) .and. line%n > 0) call take_line(line, reading, warnings, error)
         call place_error(error, number)
         if (present(watch) .and. modulo(number, report_lines) == 0) &
            & call watch%tell("reading blocks", real(start, wp)/real(len(text), wp))
      end do
      if (.not. allocated(error)) call close_entry(reading, warnings, error)
      call close_plan(reading, plan)
      if (.not. allocated(error)) call check_plan(plan, file, warnings, error)
      if (.not. allocated(error)) call survey(plan, site)
      if (.not. allocated(error)) call check_overlaps(plan, site, error, watch)
      if (.not. allocated(error)) &
         & call add_points(reading%later(:reading%n_later), plan, site, file, warnings, error, &
         & watch)
      if (.not. allocated(error)) return
      if (.not. allocated(error%file)) error%file = file
   end subroutine parse_blocks

   !> Read a line: the first one of an entry, or a row of the entry
   pure subroutine take_line(line, reading, warnings, error)
      type(line_t), intent(in) :: line
      type(reading_t), intent(inout) :: reading
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: value
      integer :: i, kind
      logical :: ok

      if (scan(line%word(1)(1:1), "0123456789+-.") == 0) then
         kind = findloc(entries%word == line%word(1), .true., dim=1)
         if (kind == 0) call fatal_error(error, "expected a number or one of " &
            & //listed(entries%word)//", got '"//shown(trim(line%word(1)))//"'")
         if (allocated(error)) return
         call close_entry(reading, warnings, error)
         reading%entry%head = line
         reading%entry%n_column = entries(kind)%n_column
         return
      end if
      associate (entry => reading%entry)
         if (line%n /= entry%n_column) call fatal_error(error, row_form(entry)//", got " &
            & //to_text(line%n)//" words")
         if (allocated(error)) return
         call make_room(entry%row, entry%n_row + 1)
         entry%n_row = entry%n_row + 1
         do i = 1, line%n
            call read_number(line%word(i)(:len_trim(line%word(i))), value, ok)
            if (.not. ok) then
               call fatal_error(error, row_form(entry)//", got '"//shown(trim(line%word(i)))//"'")
               return
            else if (abs(value) > merge(largest_coordinate, largest_number, &
               & entry%n_column == 2)) then
               call fatal_error(error, row_form(entry)//" of at most "//trim(merge("1e15", &
                  & "1e30", entry%n_column == 2))//" in magnitude, got "//short_text(value) &
                  & //"; correct it or change the unit")
               return
            end if
            entry%row(i, entry%n_row) = value
         end do
      end associate
   end subroutine take_line

   !> Description of a row of an entry
   pure function row_form(entry) result(text)
      type(entry_t), intent(in) :: entry
      character(len=:), allocatable :: text

      select case (entry%n_column)
      case (2)
         text = "expected a corner x y [m]"
         if (entry%head%word(1) == "water") text = "expected a row of a time [s] and a rise [m]"
      case (3)
         text = "expected a row of three numbers: a time [s] and two components"
      case default
         text = "expected one of "//listed(entries%word)
      end select
   end function row_form

   !> Return the plan, its arrays reduced to their contents
   pure subroutine close_plan(reading, plan)
      type(reading_t), intent(inout) :: reading  !! State of reading; its plan is moved
      type(block_plan_t), intent(out) :: plan

      associate (from => reading%plan, n => reading%n_block)
         from%first_vertex = from%first_vertex(:n + 1)
         from%vertex = from%vertex(:, :reading%n_vertex)
         from%fixed = from%fixed(:n)
         from%material = from%material(:n)
         from%line = from%line(:n)
         from%starts = from%starts(:reading%n_start)
         from%start = from%start(:, :reading%n_start)
         from%laws = from%laws(:reading%n_law)
      end associate
      plan = reading%plan
   end subroutine close_plan

   !> Read a complete entry; points are kept until all blocks are read
   pure subroutine close_entry(reading, warnings, error)
      type(reading_t), intent(inout) :: reading  !! State of reading; its entry is left without rows
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error

      select case (reading%entry%head%word(1))
      case ("block")
         call close_block(reading, warnings, error)
      case ("material")
         call add_material(reading%entry%head, reading%plan, error)
      case ("joint")
         call add_law(reading%entry%head, reading, error)
      case ("")
         continue
      case default
         call keep_entry(reading%entry, reading%later, reading%n_later)
      end select
      call place_error(error, reading%entry%head%number)
      reading%entry%n_row = 0
   end subroutine close_entry

   !> Read a block: block [fixed] [material N] [velocity vx vy w] [stress sx sy txy]
   pure subroutine close_block(reading, warnings, error)
      type(reading_t), intent(inout) :: reading  !! State of reading; receives the block
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(key_t), parameter :: key(4) = [key_t(name="fixed", kind=key_kind%flag), &
         & key_t(name="material", kind=key_kind%whole, &
         & within=real([1, most_materials], wp)), key_t(name="velocity", kind=key_kind%numbers), &
         & key_t(name="stress", kind=key_kind%numbers)]
      real(wp) :: value(7)
      logical :: given(4)

      value = [1.0_wp, spread(0.0_wp, 1, 6)]
      call take_words(reading%entry%head, 2, key, value, given, error)
      if (allocated(error)) return
      call add_plan_block(reading, given(1), nint(value(1)), warnings, error)
      if (allocated(error) .or. .not. any(given(3:4))) return
      reading%n_start = reading%n_start + 1
      call make_room(reading%plan%starts, reading%n_start)
      call make_room(reading%plan%start, reading%n_start)
      reading%plan%starts(reading%n_start) = reading%n_block
      reading%plan%start(:, reading%n_start) = value(2:7)
   end subroutine close_block

   !> Read a material:
   !> material N [density d] [unit_weight w] [young e] [poisson p] [compressive_strength s]
   pure subroutine add_material(line, plan, error)
      type(line_t), intent(in) :: line
      type(block_plan_t), intent(inout) :: plan
      type(error_t), allocatable, intent(out) :: error
      type(material_plan_t) :: material
      logical :: ok

      call read_integer(trim(line%word(2)), material%number, ok)
      if (.not. ok .or. material%number < 2 .or. material%number > most_materials) then
         call fatal_error(error, "expected the number of a material from 2 to " &
            & //to_text(most_materials)//" (1 is that of the deck), got '" &
            & //shown(trim(line%word(2)))//"'")
         return
      else if (any(plan%materials%number == material%number)) then
         call fatal_error(error, "material "//to_text(material%number)//" is given twice")
         return
      end if
      call take_words(line, 3, material_keys(:5), material%value, material%given, error)
      if (.not. allocated(error)) plan%materials = [plan%materials, material]
   end subroutine add_material

   !> Read a law: joint I J [friction_deg f] [cohesion c] [tension t] [residual_deg r]
   !> [slip_length d]
   pure subroutine add_law(line, reading, error)
      type(line_t), intent(in) :: line
      type(reading_t), intent(inout) :: reading
      type(error_t), allocatable, intent(out) :: error
      type(law_plan_t) :: law
      logical :: ok(2)
      integer :: i

      do i = 1, 2
         call read_integer(trim(line%word(i + 1)), law%material(i), ok(i))
      end do
      if (.not. all(ok) .or. any(law%material < 1) .or. any(law%material > most_materials)) &
         & call fatal_error(error, "expected the numbers of two materials from 1 to " &
         & //to_text(most_materials)//" after joint")
      if (allocated(error)) return
      call take_words(line, 4, joint_keys, law%value, law%given, error)
      if (allocated(error)) return
      if (law%given(1) .and. law%value(4) > law%value(1)) then
         call fatal_error(error, "residual_deg must be at most friction_deg, " &
            & //to_text(law%value(1))//", got "//to_text(law%value(4)))
         return
      end if
      law%line = line%number
      ! double the capacity
      if (reading%n_law == size(reading%plan%laws)) &
         & reading%plan%laws = [reading%plan%laws, reading%plan%laws, law]
      reading%n_law = reading%n_law + 1
      reading%plan%laws(reading%n_law) = law
   end subroutine add_law
end module dda_read_blocks
