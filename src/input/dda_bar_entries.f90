!> Bars and water of a file of blocks
module dda_bar_entries
   use dda_bar, only : bar_t
   use dda_block_input, only : block_plan_t
   use dda_block_lines, only : entry_t, take_numbers
   use dda_block_sites, only : block_at, site_t
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_text, only : read_number, to_text
   use dda_warnings, only : add_warning, warnings_t
   use dda_water, only : water_t
   implicit none
   private

   public :: take_bar, take_water

contains

   !> Take in a bar:
   !> bar x1 y1 x2 y2 (stiffness S | ea V) [strength T] [prestress P] [slack] [breaks]
   pure subroutine take_bar(entry, plan, site, file, warnings, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(site_t), intent(in) :: site
      !> Name of the file, for warnings
      character(len=*), intent(in) :: file
      !> Receives ends that no block has
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(bar_t) :: bar
      real(wp) :: ends(4)
      integer :: i, side

      bar%line = entry%head%number
      i = 1
      ends = 0.0_wp
      call take_numbers(entry%head, i, ends, error)
      if (.not. allocated(error)) call take_properties(entry, i, norm2(ends(3:4) - ends(1:2)), &
         & bar, error)
      if (allocated(error)) return
      bar%point = reshape(ends, [2, 2]) - spread(plan%origin, 2, 2)
      if (.not. norm2(bar%point(:, 1) - bar%point(:, 2)) > 0.0_wp) then
         call fatal_error(error, "expected a bar with a length, got one between equal points", &
            & line=bar%line)
         return
      end if
      do side = 1, 2
         bar%block(side) = block_at(plan, site, bar%point(:, side))
         if (bar%block(side) == 0) call add_warning(warnings, "the end of the bar at (" &
            & //to_text(ends(2*side - 1))//", "//to_text(ends(2*side)) &
            & //") lies in no block: the ground holds it", file, bar%line)
      end do
      if (bar%block(1) == bar%block(2)) then
         call fatal_error(error, "expected a bar between two blocks or a block and the ground, " &
            & //"got one with both ends in "//trim(merge("the ground", "one block ", &
            & bar%block(1) == 0)), line=bar%line)
         return
      end if
      if (.not. allocated(plan%boundary%bar)) allocate (plan%boundary%bar(0))
      plan%boundary%bar = [plan%boundary%bar, bar]
   end subroutine take_bar

   !> What a bar is like
   pure subroutine take_properties(entry, first, length, bar, error)
      type(entry_t), intent(in) :: entry
      !> Place of the first word
      integer, intent(in) :: first
      !> Length of the bar [m]
      real(wp), intent(in) :: length
      type(bar_t), intent(inout) :: bar
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: word(6) = [character(len=9) :: "stiffness", "ea", &
         & "strength", "prestress", "slack", "breaks"]
      logical :: given(6)
      real(wp) :: value(1)
      integer :: i, k

      given = .false.
      value = 0.0_wp
      i = first
      do while (i <= entry%head%n)
         k = findloc(word == entry%head%word(i), .true., dim=1)
         if (k == 0) then
            call fatal_error(error, "expected stiffness, ea, strength, prestress, slack or " &
               & //"breaks, got '"//shown(trim(entry%head%word(i)))//"'", line=entry%head%number)
         else if (given(k)) then
            call fatal_error(error, trim(word(k))//" is given twice", line=entry%head%number)
         else if (k <= 4) then
            call take_numbers(entry%head, i, value, error)
            if (.not. allocated(error) .and. (value(1) < 0.0_wp .or. k <= 2 &
               & .and. .not. value(1) > 0.0_wp)) call fatal_error(error, "expected " &
               & //trim(word(k))//trim(merge(" above 0", " from 0 ", k <= 2))//", got " &
               & //to_text(value(1)), line=entry%head%number)
         else
            i = i + 1
         end if
         if (allocated(error)) return
         given(k) = .true.
         if (k == 1) bar%stiffness = value(1)
         if (k == 2) bar%stiffness = value(1)/max(length, tiny(length))
         if (k == 3) bar%strength = value(1)
         if (k == 4) bar%prestress = value(1)
      end do
      bar%pushes = .not. given(5)
      bar%breaks = given(6)
      if (given(1) .eqv. given(2)) then
         call fatal_error(error, "expected either stiffness or ea, got "//trim(merge("both   ", &
            & "neither", given(1))), line=entry%head%number)
      else if (bar%prestress > bar%strength) then
         call fatal_error(error, "expected a prestress of at most the strength, got " &
            & //to_text(bar%prestress), line=entry%head%number)
      end if
   end subroutine take_properties

   !> Take in water: water x y x y ... [unit_weight W] [factor F], and rows of time and rise below
   pure subroutine take_water(entry, plan, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(error_t), allocatable, intent(out) :: error
      type(water_t) :: water
      type(water_t), allocatable :: longer(:)
      real(wp) :: place(entry%head%n)
      integer :: i, n
      logical :: ok

      water%line = entry%head%number
      n = 0
      do i = 2, entry%head%n
         call read_number(trim(entry%head%word(i)), place(n + 1), ok)
         if (.not. ok) exit
         if (.not. abs(place(n + 1)) <= 1.0e9_wp) then
            call fatal_error(error, "expected places of at most 1e9, got " &
               & //to_text(place(n + 1)), line=water%line)
            return
         end if
         n = n + 1
      end do
      if (n < 4 .or. modulo(n, 2) == 1) then
         call fatal_error(error, "expected the coordinates of two points or more after water, " &
            & //"got "//to_text(n)//" numbers", line=water%line)
         return
      end if
      water%x = place(1:n:2)
      water%head = place(2:n:2)
      if (any(water%x(2:) <= water%x(:n/2 - 1))) then
         call fatal_error(error, "expected points of the line of heads from left to right", &
            & line=water%line)
         return
      end if
      call take_water_words(entry, n + 2, water, error)
      if (allocated(error)) return
      water%time = entry%row(1, :entry%n_row)
      water%rise = entry%row(2, :entry%n_row)
      if (any(water%time(2:) <= water%time(:entry%n_row - 1)) .or. any(water%time < 0.0_wp)) then
         call fatal_error(error, "expected increasing times from 0 [s]", line=water%line)
         return
      end if
      ! one by one, for an array made of both would lose the memory of their points
      allocate (longer(size(plan%water) + 1))
      do i = 1, size(plan%water)
         longer(i) = plan%water(i)
      end do
      longer(size(longer)) = water
      call move_alloc(longer, plan%water)
   end subroutine take_water

   !> What the water is like
   pure subroutine take_water_words(entry, first, water, error)
      type(entry_t), intent(in) :: entry
      !> Place of the first word
      integer, intent(in) :: first
      type(water_t), intent(inout) :: water
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: value(1)
      integer :: i
      logical :: is_weight

      i = first
      value = 0.0_wp
      do while (i <= entry%head%n)
         is_weight = entry%head%word(i) == "unit_weight"
         if (.not. is_weight .and. entry%head%word(i) /= "factor") then
            call fatal_error(error, "expected unit_weight or factor, got '" &
               & //shown(trim(entry%head%word(i)))//"'", line=water%line)
            return
         end if
         call take_numbers(entry%head, i, value, error)
         if (allocated(error)) return
         if (value(1) < 0.0_wp .or. .not. is_weight .and. value(1) > 1.0_wp) then
            call fatal_error(error, "expected a unit_weight from 0 or a factor from 0 to 1, got " &
               & //to_text(value(1)), line=water%line)
            return
         end if
         if (is_weight) water%unit_weight = value(1)
         if (.not. is_weight) water%factor = value(1)
      end do
   end subroutine take_water_words
end module dda_bar_entries
