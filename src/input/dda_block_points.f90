!> Points of a file of blocks and their actions
submodule (dda_read_blocks) dda_block_points
   use dda_block_lines, only : take_numbers, take_record
   use dda_block_sites, only : add_held, block_at, close_held, depth_of, rivals_at, rounded
   use dda_boundary, only : boundary_t, held_point_t, history_t, measured_point_t
   use dda_box_tree, only : boxes_along
   use dda_ground_motion, only : acceleration_of_displacement, acceleration_of_record, &
      & acceleration_of_velocity
   use dda_polygon, only : parts_inside
   use dda_error, only : add_warning, place_error
   implicit none

   !> Distance below which points coincide, over the block size
   real(wp), parameter :: touching = 1.0e-8_wp

   interface

      !> Read a bar:
      !> bar x1 y1 x2 y2 (stiffness S | ea V) [strength T] [prestress P] [slack] [breaks]
      pure module subroutine take_bar(entry, plan, site, file, warnings, error)
         type(entry_t), intent(in) :: entry
         type(block_plan_t), intent(inout) :: plan
         type(site_t), intent(in) :: site
         character(len=*), intent(in) :: file  !! Name of the file, for warnings
         type(warnings_t), intent(inout) :: warnings
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_bar

      !> Read a piezometric line: water x y x y ... [unit_weight W] [factor F], followed by rows of
      !> time and rise
      pure module subroutine take_water(entry, plan, error)
         type(entry_t), intent(in) :: entry
         type(block_plan_t), intent(inout) :: plan
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_water

      !> Read absorb x1 y1 x2 y2 [x or y] [p_speed V] [s_speed V]: two Gauss points on its part
      !> along each block, where linear forces do their exact work
      pure module subroutine take_absorbing(entry, plan, site, error)
         type(entry_t), intent(in) :: entry
         type(block_plan_t), intent(inout) :: plan
         type(site_t), intent(in) :: site
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_absorbing

      !> Read remove|add block N ... at T, or remove|add polygon at T followed by its corners, for
      !> the blocks with their centre of gravity inside
      pure module subroutine take_change(entry, plan, error)
         type(entry_t), intent(in) :: entry
         type(block_plan_t), intent(inout) :: plan  !! Receives one change per block
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_change

      !> Sort the changes by time, and check each of them
      pure module subroutine close_changes(plan, error)
         type(block_plan_t), intent(inout) :: plan
         !> Allocated for a repeated change, or a bar without its block
         type(error_t), allocatable, intent(out) :: error
      end subroutine close_changes

   end interface

contains

   !> Read points, restrained lines and ground motion, after all blocks
   module procedure add_points
      integer :: i

      if (size(later) == 0) return
      call make_lists(later, plan%boundary)
      do i = 1, size(later)
         if (present(watch) .and. modulo(i, 1000) == 0) &
            & call watch%tell("reading points", real(i, wp)/real(size(later), wp))
         associate (entry => later(i))
            call take_record(entry, file, plan%record_marks, error)
            call place_error(error, entry%head%number)
            if (allocated(error)) return
            select case (entry%head%word(1))
            case ("base_acceleration", "base_velocity", "base_displacement")
               call take_ground(entry, plan, error)
            case ("fix_line")
               call restrain_line(entry, plan, site, error)
            case ("bar")
               call take_bar(entry, plan, site, file, warnings, error)
            case ("water")
               call take_water(entry, plan, error)
            case ("absorb")
               call take_absorbing(entry, plan, site, error)
            case ("remove", "add")
               call take_change(entry, plan, error)
            case default
               call take_point(entry, plan, site, file, warnings, error)
            end select
            call place_error(error, entry%head%number)
            if (allocated(error)) return
            deallocate (entry%row)
         end associate
      end do
      call close_held(site%n_held, plan%boundary%held)
      call close_changes(plan, error)
   end procedure add_points

   !> Allocate lists for the entries of the file; lines may need more points
   pure subroutine make_lists(later, boundary)
      type(entry_t), intent(in) :: later(:)
      type(boundary_t), intent(inout) :: boundary
      integer :: i, n_held, n_loaded, n_measured

      n_held = 0
      n_loaded = 0
      n_measured = 0
      do i = 1, size(later)
         select case (later(i)%head%word(1))
         case ("fix", "displacement")
            n_held = n_held + 1
         case ("load", "live")
            n_loaded = n_loaded + 1
         case ("measure")
            n_measured = n_measured + 1
         end select
      end do
      allocate (boundary%held(n_held), boundary%loaded(n_loaded), boundary%measured(n_measured))
   end subroutine make_lists

   !> Read the ground motion
   pure subroutine take_ground(entry, plan, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(error_t), allocatable, intent(out) :: error
      type(history_t) :: history
      real(wp) :: value(2)
      logical :: has_value
      integer :: i

      if (allocated(plan%boundary%base_acceleration%time)) call fatal_error(error, &
         & "expected the motion of the ground once, got it a second time")
      if (allocated(error)) return
      has_value = entry%head%n > 1
      i = 1
      if (has_value) call take_numbers(entry%head, i, value, error)
      if (allocated(error)) return
      if (has_value .and. i <= entry%head%n) call fatal_error(error, "unknown word '" &
         & //shown(trim(entry%head%word(i)))//"'")
      if (allocated(error)) return
      call read_history(entry, has_value, value, history, error)
      if (allocated(error)) return
      plan%ground_line = entry%head%number
      if (entry%head%word(1) == "base_acceleration" .and. allocated(entry%head%quoted)) then
         plan%boundary%base_acceleration = acceleration_of_record(history)
      else if (entry%head%word(1) == "base_acceleration") then
         plan%boundary%base_acceleration = history
      else if (size(history%time) < 2) then
         call fatal_error(error, "expected two rows of time and components or more below " &
            & //trim(entry%head%word(1)))
      else if (entry%head%word(1) == "base_velocity") then
         plan%boundary%base_acceleration = acceleration_of_velocity(history)
      else
         plan%boundary%base_acceleration = acceleration_of_displacement(history)
      end if
   end subroutine take_ground

   !> Restrain a line: the ends of its part in each block that it crosses or touches
   pure subroutine restrain_line(entry, plan, site, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(site_t), intent(inout) :: site  !! Positions of the blocks and their restraints
      type(error_t), allocatable, intent(out) :: error
      type(held_point_t) :: held
      real(wp), allocatable :: part(:, :)
      real(wp) :: ends(4)
      integer, allocatable :: near(:)
      integer :: b, i, k, n_before

      i = 1
      ends = 0.0_wp
      held%line = entry%head%number
      call take_numbers(entry%head, i, ends, error)
      if (allocated(error)) return
      call take_directions(entry, i, held%along, error)
      if (allocated(error)) return
      ends = ends - [plan%origin, plan%origin]
      n_before = site%n_held
      allocate (near(0))
      if (norm2(ends(3:4) - ends(1:2)) > 0.0_wp) near = boxes_along(site%tree, ends)
      do i = 1, size(near)
         b = near(i)
         part = parts_inside(plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1), &
            & ends, touching*site%size_of(b), site%edges(site%edges_of(b)))
         do k = 1, size(part, 2)
            held%block = b
            held%point = part(:, k)
            call add_held(held, plan, site, error)
            if (allocated(error)) return
         end do
      end do
      if (site%n_held == n_before) call fatal_error(error, &
         & "expected a line that crosses a block or runs along its edge, got one that does not")
   end subroutine restrain_line

   !> Read a point of a block
   pure subroutine take_point(entry, plan, site, file, warnings, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(inout) :: plan
      type(site_t), intent(inout) :: site
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      type(history_t) :: history
      type(held_point_t) :: held
      real(wp) :: value(2)
      integer :: i
      logical :: has_value

      call take_place(entry, plan, site, i, held%block, held%point, error)
      if (.not. allocated(error) .and. entry%head%word(2) /= "block") &
         & call warn_of_rivals(entry, held%block, rivals_at(plan, site, held%point, held%block), &
         & file, warnings)
      if (allocated(error)) return
      has_value = entry%n_column == 3 .and. entry%head%n >= i
      if (has_value) then
         i = i - 1
         call take_numbers(entry%head, i, value, error)
      end if
      if (allocated(error)) return
      if (entry%n_column == 3) call read_history(entry, has_value, value, history, error)
      if (allocated(error)) return
      held%path = history
      held%line = entry%head%number
      if (entry%head%word(1) == "fix") then
         call take_directions(entry, i, held%along, error)
      else if (i <= entry%head%n) then
         call fatal_error(error, "unknown word '"//shown(trim(entry%head%word(i)))//"'")
      end if
      if (allocated(error)) return
      associate (boundary => plan%boundary)
         select case (entry%head%word(1))
         case ("fix", "displacement")
            call add_held(held, plan, site, error)
         case ("load", "live")
            site%n_loaded = site%n_loaded + 1
            associate (loaded => boundary%loaded(site%n_loaded))
               loaded%block = held%block
               loaded%point = held%point
               loaded%force = history
               loaded%live = entry%head%word(1) == "live"
            end associate
         case ("measure")
            site%n_measured = site%n_measured + 1
            boundary%measured(site%n_measured) = measured_point_t(held%block, held%point)
         end select
      end associate
   end subroutine take_point

   !> Read the position of a point: [block N] x y; without a number, the block that contains it
   pure subroutine take_place(entry, plan, site, i, block, point, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(in) :: site
      integer, intent(out) :: i          !! Index of the word after the coordinates
      integer, intent(out) :: block      !! Number of the block
      real(wp), intent(out) :: point(2)  !! The point relative to the origin of the plan: (2) [m]
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: shown_point
      logical :: ok

      i = 1
      block = 0
      point = 0.0_wp
      if (entry%head%word(2) == "block") then
         call read_integer(trim(entry%head%word(3)), block, ok)
         if (ok) ok = block >= 1 .and. block <= size(plan%fixed)
         if (.not. ok) call fatal_error(error, "expected the number of a block from 1 to " &
            & //to_text(size(plan%fixed))//", got '"//shown(trim(entry%head%word(3)))//"'")
         if (allocated(error)) return
         i = 3
      end if
      call take_numbers(entry%head, i, point, error)
      if (allocated(error)) return
      point = point - plan%origin
      shown_point = place_text(point + plan%origin)
      if (block == 0) then
         block = block_at(plan, site, point)
         if (block == 0) call fatal_error(error, "expected a point of a block, got " &
            & //shown_point//", which lies in none")
      else if (depth_of(plan, site, block, point) < -rounded*site%size_of(block)) then
         call fatal_error(error, "expected a point of block "//to_text(block)//", got " &
            & //shown_point//", which lies outside it")
      end if
   end subroutine take_place

   !> Warn of a point on several blocks, with their numbers
   pure subroutine warn_of_rivals(entry, block, rival, file, warnings)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: block     !! The block of the point
      integer, intent(in) :: rival(:)  !! The other blocks: (n)
      character(len=*), intent(in) :: file
      type(warnings_t), intent(inout) :: warnings
      character(len=:), allocatable :: others
      integer :: k

      if (size(rival) == 0) return
      others = to_text(rival(1))
      do k = 2, min(size(rival), 3)
         others = others//", "//to_text(rival(k))
      end do
      if (size(rival) > 3) others = others//" and others"
      call add_warning(warnings, "the point lies on block "//to_text(block) &
         & //", which it is taken for, and on block "//others//"; write '" &
         & //trim(entry%head%word(1))//" block N x y' to say which", file, entry%head%number)
   end subroutine warn_of_rivals

   !> Read the restrained directions: both, or the given one
   pure subroutine take_directions(entry, i, along, error)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: i          !! Index of the word after the numbers
      logical, intent(out) :: along(2)  !! True for restrained directions x, y: (2)
      type(error_t), allocatable, intent(out) :: error

      along = .true.
      if (i > entry%head%n) return
      along = entry%head%word(i) == ["x", "y"]
      if (.not. any(along) .or. i < entry%head%n) call fatal_error(error, &
         & "expected x, y or nothing after the numbers, got '" &
         & //shown(trim(entry%head%word(i)))//"'")
   end subroutine take_directions

   !> Read a vector as a function of time: one value after the word, or rows of time and components
   pure subroutine read_history(entry, has_value, value, history, error)
      type(entry_t), intent(in) :: entry
      logical, intent(in) :: has_value  !! True if there is one value after the word
      real(wp), intent(in) :: value(2)  !! The value: (2)
      type(history_t), intent(out) :: history
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      n = entry%n_row
      if (has_value .eqv. n > 0) then
         call fatal_error(error, "expected two components after the point or rows of time and " &
            & //"components below it, got "//trim(merge("both   ", "neither", has_value)))
      else if (has_value) then
         allocate (history%time(1), source=0.0_wp)
         allocate (history%value(2, 1))
         history%value(:, 1) = value
      else if (any(entry%row(1, 2:n) <= entry%row(1, :n - 1))) then
         call fatal_error(error, "expected increasing times [s]")
      else
         allocate (history%time, source=entry%row(1, :n))
         allocate (history%value, source=entry%row(2:3, :n))
      end if
   end subroutine read_history

end submodule dda_block_points
