!> Read a file of blocks: polygons, materials, points and what acts on them, one thing a line
module dda_read_blocks
   use dda_block_input, only : block_plan_t, law_plan_t, material_plan_t, new_plan
   use dda_block_lines, only : entry_t, line_t, split_line, take_keys, take_numbers, word_size
   use dda_block_points, only : add_point
   use dda_check_plan, only : add_plan_block, check_plan
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : read_integer, read_number, to_text
   implicit none
   private

   public :: parse_blocks

   !> Keys that a material may have
   character(len=word_size), parameter :: material_key(4) = [character(len=word_size) :: &
      & "density", "unit_weight", "young", "poisson"]
   !> Keys that a joint may have
   character(len=word_size), parameter :: law_key(3) = [character(len=word_size) :: &
      & "friction_deg", "cohesion", "tension"]
   !> Words that begin an entry
   character(len=*), parameter :: entries = "block, material, joint, fix, fix_line, "// &
      & "measure, load, displacement, base_acceleration, base_velocity, base_displacement"

   !> A point entry, kept until all blocks are known
   type :: point_entry_t
      !> The entry
      type(entry_t) :: entry
   end type point_entry_t

contains

   !> Blocks from the text of a file
   pure subroutine parse_blocks(text, file, plan, error)
      !> The text, lines ended by line feeds
      character(len=*), intent(in) :: text
      !> Name that errors will show
      character(len=*), intent(in) :: file
      !> The blocks
      type(block_plan_t), intent(out) :: plan
      !> Bad input, with file and line
      type(error_t), allocatable, intent(out) :: error
      type(point_entry_t), allocatable :: later(:)
      type(entry_t) :: entry
      type(line_t) :: line
      integer :: number, start, finish

      call new_plan(plan)
      allocate (later(0))
      start = 1
      number = 0
      do while (start <= len(text) .and. .not. allocated(error))
         finish = index(text(start:)//achar(10), achar(10)) + start - 2
         number = number + 1
         call split_line(text(start:finish), number, line, error)
         if (.not. allocated(error) .and. line%n > 0) &
            & call take_line(line, entry, later, plan, error)
         start = finish + 2
      end do
      if (.not. allocated(error)) call close_entry(entry, later, plan, error)
      if (.not. allocated(error)) call check_plan(plan, error)
      do number = 1, size(later)
         if (.not. allocated(error)) call add_point(later(number)%entry, plan, error)
      end do
      if (allocated(error)) error%file = file
   end subroutine parse_blocks

   !> Take a line: the beginning of an entry, or a row of the one before
   pure subroutine take_line(line, entry, later, plan, error)
      !> The line
      type(line_t), intent(in) :: line
      !> The entry that is being read
      type(entry_t), intent(inout) :: entry
      !> Entries of points so far
      type(point_entry_t), allocatable, intent(inout) :: later(:)
      !> The blocks so far
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: wider(:, :)
      real(wp) :: value
      integer :: i
      logical :: ok

      if (scan(line%word(1)(1:1), "0123456789+-.") == 0) then
         call close_entry(entry, later, plan, error)
         if (allocated(error)) return
         call open_entry(line, entry, error)
         return
      end if
      if (line%n /= entry%n_column) then
         call fatal_error(error, row_wanted(entry)//", found "//to_text(line%n)//" words", &
            & line=line%number)
         return
      end if
      if (.not. allocated(entry%row)) allocate (entry%row(3, 8))
      if (entry%n_row == size(entry%row, 2)) then
         allocate (wider(3, 2*entry%n_row))
         wider(:, :entry%n_row) = entry%row
         call move_alloc(wider, entry%row)
      end if
      entry%n_row = entry%n_row + 1
      do i = 1, line%n
         call read_number(trim(line%word(i)), value, ok)
         if (.not. ok) then
            call fatal_error(error, row_wanted(entry)//", found '" &
               & //shown(trim(line%word(i)))//"'", line=line%number)
            return
         end if
         entry%row(i, entry%n_row) = value
      end do
   end subroutine take_line

   !> What a row below an entry ought to be
   pure function row_wanted(entry) result(text)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> The text
      character(len=:), allocatable :: text

      select case (entry%n_column)
      case (2)
         text = "wanted a corner x y [m]"
      case (3)
         text = "wanted a row of three numbers: a time [s] and two components"
      case default
         text = "wanted one of "//entries
      end select
   end function row_wanted

   !> Begin an entry
   pure subroutine open_entry(line, entry, error)
      !> Its first line
      type(line_t), intent(in) :: line
      !> The entry
      type(entry_t), intent(out) :: entry
      !> No such entry
      type(error_t), allocatable, intent(out) :: error

      entry%head = line
      select case (line%word(1))
      case ("block")
         entry%n_column = 2
      case ("load", "displacement", "base_acceleration", "base_velocity", "base_displacement")
         entry%n_column = 3
      case ("material", "joint", "fix", "fix_line", "measure")
         entry%n_column = 0
      case default
         call fatal_error(error, "wanted one of "//entries//", found '" &
            & //shown(trim(line%word(1)))//"'", &
            & line=line%number)
      end select
   end subroutine open_entry

   !> Take in an entry that is complete; points wait until all blocks are known
   pure subroutine close_entry(entry, later, plan, error)
      !> The entry; left without a head
      type(entry_t), intent(inout) :: entry
      !> Entries of points so far
      type(point_entry_t), allocatable, intent(inout) :: later(:)
      !> The blocks so far
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      type(point_entry_t) :: point

      if (.not. allocated(entry%row)) allocate (entry%row(3, 0))
      select case (entry%head%word(1))
      case ("block")
         call close_block(entry, plan, error)
      case ("material")
         call add_material(entry%head, plan, error)
      case ("joint")
         call add_law(entry%head, plan, error)
      case ("fix", "fix_line", "measure", "load", "displacement", "base_acceleration", &
         & "base_velocity", "base_displacement")
         point%entry = entry
         later = [later, point]
      end select
      entry = entry_t()
   end subroutine close_entry

   !> Take in a block: block [fixed] [material N] [velocity vx vy w] [stress sx sy txy]
   pure subroutine close_block(entry, plan, error)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> Receives the block
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: velocity(3), stress(3), number(1)
      integer :: i, material
      logical :: fixed

      fixed = .false.
      velocity = 0.0_wp
      stress = 0.0_wp
      number = 1.0_wp
      i = 2
      do while (i <= entry%head%n .and. .not. allocated(error))
         select case (entry%head%word(i))
         case ("fixed")
            fixed = .true.
            i = i + 1
         case ("material")
            call take_numbers(entry%head, i, number, error)
         case ("velocity")
            call take_numbers(entry%head, i, velocity, error)
         case ("stress")
            call take_numbers(entry%head, i, stress, error)
         case default
            call fatal_error(error, "wanted fixed, material, velocity or stress, found '" &
               & //shown(trim(entry%head%word(i)))//"'", line=entry%head%number)
         end select
      end do
      if (allocated(error)) return
      material = nint(number(1))
      if (abs(number(1) - anint(number(1))) > 0.0_wp .or. number(1) < 1.0_wp &
         & .or. number(1) > 1000.0_wp) then
         call fatal_error(error, "wanted the number of a material from 1 to 1000, found " &
            & //to_text(number(1)), line=entry%head%number)
         return
      end if
      call add_plan_block(plan, entry%row(:2, :entry%n_row), fixed, material, &
         & entry%head%number, error)
      if (allocated(error)) return
      plan%velocity(:, size(plan%fixed)) = velocity
      plan%stress(:, size(plan%fixed)) = stress
   end subroutine close_block

   !> Take in a material: material N [density d] [unit_weight w] [young e] [poisson p]
   pure subroutine add_material(line, plan, error)
      !> The line
      type(line_t), intent(in) :: line
      !> Receives the material
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      type(material_plan_t) :: material
      logical :: ok

      call read_integer(trim(line%word(2)), material%number, ok)
      if (.not. ok .or. material%number < 2 .or. material%number > 1000) then
         call fatal_error(error, "wanted the number of a material from 2 to 1000 (1 is that of " &
            & //"the deck), found '"//shown(trim(line%word(2)))//"'", line=line%number)
         return
      else if (any(plan%materials%number == material%number)) then
         call fatal_error(error, "material "//to_text(material%number)//" is given twice", &
            & line=line%number)
         return
      end if
      call take_keys(line, 3, material_key, material%value, material%given, error)
      if (allocated(error)) return
      if (any(material%given(:3) .and. .not. material%value(:3) > 0.0_wp)) then
         call fatal_error(error, "density, unit_weight and young want numbers above 0", &
            & line=line%number)
      else if (material%given(4) .and. .not. abs(material%value(4) + 0.25_wp) < 0.75_wp) then
         call fatal_error(error, "poisson wants a number between -1 and 0.5, found " &
            & //to_text(material%value(4)), line=line%number)
      else
         plan%materials = [plan%materials, material]
      end if
   end subroutine add_material

   !> Take in a law: joint I J [friction_deg f] [cohesion c] [tension t]
   pure subroutine add_law(line, plan, error)
      !> The line
      type(line_t), intent(in) :: line
      !> Receives the law
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      type(law_plan_t) :: law
      logical :: ok(2)
      integer :: i

      do i = 1, 2
         call read_integer(trim(line%word(i + 1)), law%material(i), ok(i))
      end do
      if (.not. all(ok) .or. any(law%material < 1) .or. any(law%material > 1000)) then
         call fatal_error(error, "wanted the numbers of two materials from 1 to 1000 after joint", &
            & line=line%number)
         return
      end if
      call take_keys(line, 4, law_key, law%value, law%given, error)
      if (allocated(error)) return
      if (any(law%value < 0.0_wp) .or. law%value(1) > 90.0_wp) then
         call fatal_error(error, "wanted 0 <= friction_deg <= 90 and no negative strength", &
            & line=line%number)
      else
         plan%laws = [plan%laws, law]
      end if
   end subroutine add_law
end module dda_read_blocks
