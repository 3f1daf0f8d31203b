!> Points of a file of blocks, and what acts on them in time
module dda_block_points
   use dda_block_input, only : block_at, block_plan_t
   use dda_block_lines, only : entry_t, take_numbers
   use dda_boundary, only : held_point_t, history_t, loaded_point_t, measured_point_t
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: add_point

contains

   !> Take in a point, or the motion of the ground, once all blocks are known
   pure subroutine add_point(entry, plan, error)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> Receives it
      type(block_plan_t), intent(inout) :: plan
      !> Anything wrong
      type(error_t), allocatable, intent(out) :: error
      type(history_t) :: history
      real(wp) :: point(2), value(2)
      integer :: block, i
      logical :: is_ground, has_value

      is_ground = entry%head%word(1) == "base_acceleration"
      i = 1
      point = 0.0_wp
      if (.not. is_ground) call take_numbers(entry%head, i, point, error)
      if (is_ground) i = 2
      if (allocated(error)) return
      has_value = entry%n_column == 3 .and. entry%head%n >= i
      if (has_value) then
         i = i - 1
         call take_numbers(entry%head, i, value, error)
      end if
      if (allocated(error)) return
      if (entry%n_column == 3) then
         call read_history(entry, has_value, value, history, error)
         if (allocated(error)) return
      end if
      if (is_ground) then
         plan%boundary%base_acceleration = history
         return
      end if
      point = point - plan%origin
      block = block_at(plan, point)
      if (block == 0) then
         call fatal_error(error, "wanted a point of a block, found (" &
            & //to_text(point(1) + plan%origin(1))//", "//to_text(point(2) + plan%origin(2)) &
            & //"), which lies in none", line=entry%head%number)
         return
      end if
      call keep_point(entry, i, block, point, history, plan, error)
   end subroutine add_point

   !> Put a point where it belongs
   pure subroutine keep_point(entry, i, block, point, history, plan, error)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> Place of the word after the numbers
      integer, intent(in) :: i
      !> Block that owns the point
      integer, intent(in) :: block
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Its force or displacement in time
      type(history_t), intent(in) :: history
      !> Receives it
      type(block_plan_t), intent(inout) :: plan
      !> A word too many
      type(error_t), allocatable, intent(out) :: error
      logical :: along(2), has_word

      has_word = i <= entry%head%n
      along = .true.
      associate (boundary => plan%boundary)
         if (.not. allocated(boundary%held)) &
            & allocate (boundary%held(0), boundary%loaded(0), boundary%measured(0))
         select case (entry%head%word(1))
         case ("fix")
            if (has_word) along = entry%head%word(i) == ["x", "y"]
            has_word = has_word .and. .not. any(along)
            call keep_held(boundary%held, block, point, along, history)
         case ("displacement")
            call keep_held(boundary%held, block, point, along, history)
         case ("load")
            call keep_load(boundary%loaded, block, point, history)
         case ("measure")
            boundary%measured = [boundary%measured, measured_point_t(block, point)]
         end select
      end associate
      if (has_word) call fatal_error(error, "unknown word '" &
         & //shown(trim(entry%head%word(i)))//"'", &
         & line=entry%head%number)
   end subroutine keep_point

   !> Add a held point to a list; gfortran's array constructors would lose the memory of histories
   pure subroutine keep_held(list, block, point, along, history)
      !> The list
      type(held_point_t), allocatable, intent(inout) :: list(:)
      !> Block that owns the point
      integer, intent(in) :: block
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Directions that are held: (2)
      logical, intent(in) :: along(2)
      !> Its displacement in time
      type(history_t), intent(in) :: history
      type(held_point_t), allocatable :: longer(:)
      integer :: n

      n = size(list) + 1
      allocate (longer(n))
      longer(:n - 1) = list
      longer(n)%block = block
      longer(n)%point = point
      longer(n)%along = along
      longer(n)%path = history
      call move_alloc(longer, list)
   end subroutine keep_held

   !> Add a loaded point to a list
   pure subroutine keep_load(list, block, point, history)
      !> The list
      type(loaded_point_t), allocatable, intent(inout) :: list(:)
      !> Block that owns the point
      integer, intent(in) :: block
      !> The point: (2) [m]
      real(wp), intent(in) :: point(2)
      !> Its force in time
      type(history_t), intent(in) :: history
      type(loaded_point_t), allocatable :: longer(:)
      integer :: n

      n = size(list) + 1
      allocate (longer(n))
      longer(:n - 1) = list
      longer(n)%block = block
      longer(n)%point = point
      longer(n)%force = history
      call move_alloc(longer, list)
   end subroutine keep_load

   !> A vector in time: one value behind the word, or rows of time and components below it
   pure subroutine read_history(entry, has_value, value, history, error)
      !> The entry
      type(entry_t), intent(in) :: entry
      !> Whether there is one value behind the word
      logical, intent(in) :: has_value
      !> That value: (2)
      real(wp), intent(in) :: value(2)
      !> The history
      type(history_t), intent(out) :: history
      !> Neither or both, or times that do not increase
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      n = entry%n_row
      if (has_value .eqv. n > 0) then
         call fatal_error(error, "wanted either two components behind the point or rows of time " &
            & //"and components below it", line=entry%head%number)
      else if (has_value) then
         allocate (history%time(1), source=0.0_wp)
         allocate (history%value(2, 1))
         history%value(:, 1) = value
      else if (any(entry%row(1, 2:n) <= entry%row(1, :n - 1))) then
         call fatal_error(error, "wanted increasing times [s]", line=entry%head%number)
      else
         allocate (history%time, source=entry%row(1, :n))
         allocate (history%value, source=entry%row(2:3, :n))
      end if
   end subroutine read_history
end module dda_block_points
