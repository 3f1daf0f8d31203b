!> Bars, water, absorbing boundaries and stages of a file of blocks
submodule (dda_read_blocks:dda_block_points) dda_block_entries
   use dda_bar, only : bar_t
   use dda_boundary, only : absorbing_point_t, stage_change_t
   use dda_polygon, only : contains_point
   use dda_sort, only : sorted_order
   use dda_vector, only : area_moments, area_moments_t
   use dda_water, only : water_t
   implicit none

   !> Distance below which points coincide, over the block size
   real(wp), parameter :: touching = 1.0e-8_wp
   !> Numbers that are not negative
   real(wp), parameter :: from_zero(2) = [0.0_wp, huge(1.0_wp)]

contains

   !> Read a bar
   module procedure take_bar
      type(bar_t) :: bar
      real(wp) :: ends(4)
      integer :: i, side

      bar%line = entry%head%number
      i = 1
      ends = 0.0_wp
      call take_numbers(entry%head, i, ends, error)
      if (.not. allocated(error)) call take_properties(entry%head, i, &
         & norm2(ends(3:4) - ends(1:2)), bar, error)
      if (allocated(error)) return
      bar%point = reshape(ends, [2, 2]) - spread(plan%origin, 2, 2)
      if (.not. norm2(bar%point(:, 1) - bar%point(:, 2)) > 0.0_wp) call fatal_error(error, &
         & "expected a bar with a length, got one between equal points")
      if (allocated(error)) return
      do side = 1, 2
         bar%block(side) = block_at(plan, site, bar%point(:, side))
         if (bar%block(side) == 0) call add_warning(warnings, "the end of the bar at " &
            & //place_text(ends(2*side - 1:2*side)) &
            & //" lies in no block and is anchored in the ground", file, bar%line)
      end do
      if (bar%block(1) == bar%block(2)) call fatal_error(error, &
         & "expected a bar between two blocks or a block and the ground, " &
         & //"got one with both ends in "//trim(merge("the ground", "one block ", &
         & bar%block(1) == 0)))
      if (allocated(error)) return
      if (.not. allocated(plan%boundary%bar)) allocate (plan%boundary%bar(0))
      plan%boundary%bar = [plan%boundary%bar, bar]
   end procedure take_bar

   !> Read the properties of a bar
   pure subroutine take_properties(line, first, length, bar, error)
      type(line_t), intent(in) :: line
      integer, intent(in) :: first    !! Index of the first word
      real(wp), intent(in) :: length  !! Length of the bar [m]
      type(bar_t), intent(inout) :: bar
      type(error_t), allocatable, intent(out) :: error
      type(key_t), parameter :: key(6) = [key_t(name="stiffness", above=0.0_wp), &
         & key_t(name="ea", above=0.0_wp), key_t(name="strength", within=from_zero), &
         & key_t(name="prestress", within=from_zero), key_t(name="slack", kind=key_kind%flag), &
         & key_t(name="breaks", kind=key_kind%flag)]
      logical :: given(size(key))
      real(wp) :: value(4)

      value = [0.0_wp, 0.0_wp, bar%strength, bar%prestress]
      call take_words(line, first, key, value, given, error)
      if (allocated(error)) return
      bar%stiffness = value(1)
      if (given(2)) bar%stiffness = value(2)/max(length, tiny(length))
      bar%strength = value(3)
      bar%prestress = value(4)
      bar%pushes = .not. given(5)
      bar%breaks = given(6)
      if (given(1) .eqv. given(2)) then
         call fatal_error(error, "expected either stiffness or ea, got "//trim(merge("both   ", &
            & "neither", given(1))))
      else if (bar%prestress > bar%strength) then
         call fatal_error(error, "expected a prestress of at most the strength, got " &
            & //short_text(bar%prestress))
      end if
   end subroutine take_properties

   !> Read a piezometric line
   module procedure take_water
      type(key_t), parameter :: key(2) = [key_t(name="unit_weight", within=from_zero), &
         & key_t(name="factor", within=[0.0_wp, 1.0_wp])]
      type(water_t) :: water
      type(water_t), allocatable :: longer(:)
      real(wp) :: place(entry%head%n), value(2)
      integer :: i, n
      logical :: given(2), ok

      water%line = entry%head%number
      n = 0
      do i = 2, entry%head%n
         call read_number(trim(entry%head%word(i)), place(n + 1), ok)
         if (.not. ok) exit
         if (.not. abs(place(n + 1)) <= 1.0e9_wp) call fatal_error(error, &
            & "expected places of at most 1e9, got "//short_text(place(n + 1)))
         if (allocated(error)) return
         n = n + 1
      end do
      if (n < 4 .or. modulo(n, 2) == 1) call fatal_error(error, &
         & "expected the coordinates of two points or more after water, got "//to_text(n) &
         & //" numbers")
      if (allocated(error)) return
      water%x = place(1:n:2)
      water%head = place(2:n:2)
      if (any(water%x(2:) <= water%x(:n/2 - 1))) call fatal_error(error, &
         & "expected points of the piezometric line from left to right")
      if (allocated(error)) return
      value = [water%unit_weight, water%factor]
      call take_words(entry%head, n + 2, key, value, given, error)
      if (allocated(error)) return
      water%unit_weight = value(1)
      water%factor = value(2)
      water%time = entry%row(1, :entry%n_row)
      water%rise = entry%row(2, :entry%n_row)
      if (any(water%time(2:) <= water%time(:entry%n_row - 1)) .or. any(water%time < 0.0_wp)) &
         & call fatal_error(error, "expected increasing times from 0 [s]")
      if (allocated(error)) return
      ! gfortran loses the memory of points in an array constructor
      allocate (longer(size(plan%water) + 1))
      longer(:size(plan%water)) = plan%water
      longer(size(longer)) = water
      call move_alloc(longer, plan%water)
   end procedure take_water

   !> Read absorb x1 y1 x2 y2 [x or y] [p_speed V] [s_speed V]
   module procedure take_absorbing
      type(key_t), parameter :: key(4) = [key_t(name="x", kind=key_kind%flag), &
         & key_t(name="y", kind=key_kind%flag), key_t(name="p_speed", unit="m/s", above=0.0_wp), &
         & key_t(name="s_speed", unit="m/s", above=0.0_wp)]
      type(absorbing_point_t) :: point
      real(wp), allocatable :: part(:, :)
      real(wp) :: ends(4), half(2), middle(2)
      integer, allocatable :: near(:)
      integer :: b, i, k, n_before
      logical :: given(4)

      i = 1
      ends = 0.0_wp
      given = .false.
      point%line = entry%head%number
      call take_numbers(entry%head, i, ends, error)
      if (.not. allocated(error)) call take_words(entry%head, i, key, point%speed, given, error)
      if (.not. allocated(error) .and. all(given(:2))) call fatal_error(error, &
         & "expected one direction, got both x and y")
      if (allocated(error)) return
      if (any(given(:2))) point%along = given(:2)
      ends = ends - [plan%origin, plan%origin]
      if (.not. allocated(plan%boundary%absorbing)) allocate (plan%boundary%absorbing(0))
      n_before = size(plan%boundary%absorbing)
      allocate (near(0))
      if (norm2(ends(3:4) - ends(1:2)) > 0.0_wp) then
         near = boxes_along(site%tree, ends)
         point%tangent = (ends(3:4) - ends(1:2))/norm2(ends(3:4) - ends(1:2))
      end if
      do i = 1, size(near)
         b = near(i)
         part = parts_inside(plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1), &
            & ends, touching*site%size_of(b), site%edges(site%edges_of(b)))
         point%block = b
         do k = 1, size(part, 2), 2
            middle = (part(:, k) + part(:, k + 1))/2.0_wp
            half = (part(:, k + 1) - part(:, k))/2.0_wp
            point%length = norm2(half)
            if (.not. point%length > touching*site%size_of(b)) cycle
            point%point = middle - half/sqrt(3.0_wp)
            plan%boundary%absorbing = [plan%boundary%absorbing, point]
            point%point = middle + half/sqrt(3.0_wp)
            plan%boundary%absorbing = [plan%boundary%absorbing, point]
         end do
      end do
      if (size(plan%boundary%absorbing) == n_before) call fatal_error(error, &
         & "expected a line along faces of blocks, got one along none")
   end procedure take_absorbing

   !> Read remove|add block N ... at T, or remove|add polygon at T followed by its corners
   module procedure take_change
      type(stage_change_t), allocatable :: more(:)
      integer, allocatable :: block(:)
      real(wp) :: time(1)
      integer :: at

      at = findloc(entry%head%word(:entry%head%n), "at", dim=1)
      time = 0.0_wp
      if (at == 0 .or. all(entry%head%word(2) /= ["block  ", "polygon"])) then
         call fatal_error(error, "expected 'block' and numbers or 'polygon', then 'at' and a " &
            & //"time after '"//trim(entry%head%word(1))//"'")
      else
         call take_numbers(entry%head, at, time, error)
      end if
      if (allocated(error)) return
      if (at <= entry%head%n) then
         call fatal_error(error, "unknown word '"//shown(trim(entry%head%word(at)))//"'")
      else if (time(1) < 0.0_wp) then
         call fatal_error(error, "expected a time from 0 [s], got "//short_text(time(1)))
      else if (entry%head%word(2) == "polygon") then
         call blocks_inside(entry, plan, block, error)
      else
         call blocks_of(entry, size(plan%fixed), block, error)
      end if
      if (allocated(error)) return
      allocate (more(size(block)))
      more%block = block
      more%time = time(1)
      more%adds = entry%head%word(1) == "add"
      more%line = entry%head%number
      if (.not. allocated(plan%boundary%change)) allocate (plan%boundary%change(0))
      plan%boundary%change = [plan%boundary%change, more]
   end procedure take_change

   !> Blocks whose numbers are in an entry
   pure subroutine blocks_of(entry, n_block, block, error)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: n_block                 !! Number of blocks
      integer, allocatable, intent(out) :: block(:)  !! Block numbers: (n)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      logical :: ok

      if (entry%n_row > 0) call fatal_error(error, "expected corners below 'polygon' only")
      if (allocated(error)) return
      allocate (block(entry%head%n - 4), source=0)
      ok = size(block) > 0
      do i = 1, size(block)
         call read_integer(trim(entry%head%word(i + 2)), block(i), ok)
         if (ok) ok = block(i) >= 1 .and. block(i) <= n_block
         if (.not. ok) exit
      end do
      if (.not. ok) call fatal_error(error, "expected numbers of blocks from 1 to " &
         & //to_text(n_block)//" between 'block' and 'at', got '" &
         & //shown(trim(entry%head%word(min(i, size(block)) + 2)))//"'")
   end subroutine blocks_of

   !> Blocks with their centre of gravity in the polygon of an entry
   pure subroutine blocks_inside(entry, plan, block, error)
      type(entry_t), intent(in) :: entry
      type(block_plan_t), intent(in) :: plan
      integer, allocatable, intent(out) :: block(:)
      type(error_t), allocatable, intent(out) :: error
      type(area_moments_t) :: moments
      real(wp), allocatable :: corner(:, :)
      logical :: inside(size(plan%fixed))
      integer :: b

      if (entry%n_row < 3) call fatal_error(error, &
         & "expected three corners x y or more below 'polygon', got "//to_text(entry%n_row))
      if (allocated(error)) return
      corner = entry%row(:2, :entry%n_row) - spread(plan%origin, 2, entry%n_row)
      do b = 1, size(inside)
         moments = area_moments(plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
         inside(b) = contains_point(corner, moments%centroid)
      end do
      block = pack([(b, b=1, size(inside))], inside)
      if (size(block) == 0) call fatal_error(error, "expected a polygon around the centre of a " &
         & //"block, got one around none")
   end subroutine blocks_inside

   !> Sort the changes by time, and check each of them
   module procedure close_changes
      integer :: b, i, last(size(plan%fixed))

      if (.not. allocated(plan%boundary%change)) return
      associate (change => plan%boundary%change)
         change = change(sorted_order(spread(0, 1, size(change)), change%time))
         last = 0
         do i = 1, size(change)
            b = change(i)%block
            if (last(b) > 0) then
               if (change(last(b))%adds .eqv. change(i)%adds) call fatal_error(error, "block " &
                  & //to_text(b)//" is already "//trim(merge("there    ", "not there", &
                  & change(i)%adds))//" at "//short_text(change(i)%time)//" s", line=change(i)%line)
               if (.not. change(last(b))%time < change(i)%time) call fatal_error(error, &
                  & "expected one change of block "//to_text(b)//" at a time", line=change(i)%line)
            end if
            last(b) = i
         end do
      end associate
      if (.not. allocated(error) .and. allocated(plan%boundary%bar)) then
         do i = 1, size(plan%boundary%bar)
            do b = 1, 2
               if (plan%boundary%bar(i)%block(b) == 0) cycle
               if (last(plan%boundary%bar(i)%block(b)) > 0) call fatal_error(error, &
                  & "expected bars on blocks without stages, got one on block " &
                  & //to_text(plan%boundary%bar(i)%block(b))//", which 'remove' or 'add' names", &
                  & line=plan%boundary%bar(i)%line)
            end do
         end do
      end if
      if (.not. allocated(error) .and. size(plan%water) > 0) call fatal_error(error, &
         & "expected a file with either stages or water: the pressure on new faces is " &
         & //"not known; remove one of them", line=plan%boundary%change(1)%line)
   end procedure close_changes

end submodule dda_block_entries
