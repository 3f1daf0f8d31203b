!> Axles of a vehicle on the upper faces of the blocks
module dda_vehicle
   use dda_block_system, only : block_system_t
   use dda_boundary, only : constant_history, loaded_point_t
   use dda_deck, only : deck_t
   use dda_fill_loads, only : fill_t
   use dda_key_names, only : vehicle_axles, vehicle_length, vehicle_position, vehicle_spacings
   use dda_kinds, only : wp
   use dda_sort, only : sorted_order
   implicit none
   private

   public :: road_t, vehicle_t, axle_loads, is_symmetric, passages, road_of, turn_round, vehicle_of

   !> A vehicle
   type :: vehicle_t
      real(wp), allocatable :: axle(:)    !! Weight of each axle: (n) [N/m]
      real(wp), allocatable :: offset(:)  !! Distance to the right of the first axle: (n) [m]
      real(wp) :: length = 0.0_wp         !! Loaded length of each axle, about its middle [m]
      real(wp) :: position = 0.0_wp       !! Position of the first axle [m]
      !> Load spread: width to either side over the depth of the blocks below the surface
      real(wp) :: spread = 0.0_wp
      real(wp) :: surface = 0.0_wp  !! Height of the road surface [m]
   end type vehicle_t

   !> Edges that carry axles: upper edges of blocks
   type :: road_t
      real(wp), allocatable :: left(:, :), right(:, :)  !! Left, right end of each edge: (2, n) [m]
      integer, allocatable :: block(:)                  !! Block of each edge: (n)
      logical, allocatable :: moves(:)                  !! True for edges of movable blocks: (n)
      !> Abscissae between which the highest edge is the same, ascending: (m) [m]
      real(wp), allocatable :: corner(:)
      !> Highest edge between each of them and the next; 0 if there is none: (0:m)
      integer, allocatable :: highest(:)
      real(wp) :: reach(2) = 0.0_wp  !! Range of the edges of movable blocks along x: (2) [m]
      real(wp) :: size = 0.0_wp      !! Size of all blocks [m]
   end type road_t

   !> Depth below the upper face within which a corner belongs to it, over the total size
   real(wp), parameter :: on_top = 1.0e-9_wp
   !> Width of an upper edge over its height, beyond that of an upright joint off by rounding
   real(wp), parameter :: upright = 1.0e-9_wp
   !> Distance beyond all corners and loaded lengths, over the total size
   real(wp), parameter :: beyond_all = 1.0e6_wp

contains

   !> Make the vehicle of a deck
   pure type(vehicle_t) function vehicle_of(deck, fill) result(vehicle)
      type(deck_t), intent(in) :: deck            !! The deck of the case, with &vehicle
      type(fill_t), intent(in), optional :: fill  !! Fill below the vehicle
      real(wp), allocatable :: spacing(:)
      integer :: i

      allocate (vehicle%axle, source=deck%value(vehicle_axles)%numbers)
      allocate (spacing, source=deck%value(vehicle_spacings)%numbers)
      allocate (vehicle%offset(size(vehicle%axle)))
      do i = 1, size(vehicle%axle)
         vehicle%offset(i) = sum(spacing(:i - 1))
      end do
      vehicle%length = deck%value(vehicle_length)%number
      vehicle%position = deck%value(vehicle_position)%number
      if (.not. present(fill)) return
      vehicle%spread = fill%spread
      vehicle%surface = fill%surface
   end function vehicle_of

   !> True if the vehicle of a deck is its own mirror image
   pure logical function is_symmetric(deck)
      type(deck_t), intent(in) :: deck

      associate (axle => deck%value(vehicle_axles)%numbers, &
         & spacing => deck%value(vehicle_spacings)%numbers)
         is_symmetric = .not. (any(abs(axle - axle(size(axle):1:-1)) > 0.0_wp) &
            & .or. any(abs(spacing - spacing(size(spacing):1:-1)) > 0.0_wp))
      end associate
   end function is_symmetric

   !> Turn the vehicle of a deck round
   pure subroutine turn_round(deck)
      type(deck_t), intent(inout) :: deck

      associate (axle => deck%value(vehicle_axles)%numbers, &
         & spacing => deck%value(vehicle_spacings)%numbers)
         axle = axle(size(axle):1:-1)
         spacing = spacing(size(spacing):1:-1)
      end associate
   end subroutine turn_round

   !> Edges that may carry axles
   pure type(road_t) function road_of(system) result(road)
      type(block_system_t), intent(in) :: system
      integer :: b, k, n, next

      road%size = norm2(maxval(system%vertex, dim=2) - minval(system%vertex, dim=2))
      n = size(system%vertex, 2)
      allocate (road%left(2, n), road%right(2, n), road%block(n))
      n = 0
      do b = 1, size(system%area)
         do k = system%first_vertex(b), system%first_vertex(b + 1) - 1
            next = merge(system%first_vertex(b), k + 1, k + 1 == system%first_vertex(b + 1))
            associate (left => system%vertex(:, next), right => system%vertex(:, k))
               if (.not. right(1) - left(1) > upright*abs(right(2) - left(2))) cycle
               n = n + 1
               road%left(:, n) = left
               road%right(:, n) = right
               road%block(n) = b
            end associate
         end do
      end do
      road%left = road%left(:, :n)
      road%right = road%right(:, :n)
      road%block = road%block(:n)
      road%moves = system%equation(road%block) > 0
      road%reach = [minval(road%left(1, :), road%moves), maxval(road%right(1, :), road%moves)]
      call find_highest(road)
   end function road_of

   !> Find the highest edge of each interval, by a sweep from left to right
   pure subroutine find_highest(road)
      type(road_t), intent(inout) :: road
      integer, allocatable :: above(:), order(:)
      real(wp) :: top, y
      integer :: i, j, k, n, next

      road%corner = [road%left(1, :), road%right(1, :)]
      road%corner = road%corner(sorted_order(spread(0, 1, size(road%corner)), road%corner))
      allocate (road%highest(0:size(road%corner)), source=0)
      allocate (order, source=sorted_order(spread(0, 1, size(road%block)), road%left(1, :)))
      allocate (above(size(order)))
      n = 0
      next = 1
      do i = 1, size(road%corner) - 1
         associate (middle => 0.5_wp*(road%corner(i) + road%corner(i + 1)))
            do while (next <= size(order))
               if (road%left(1, order(next)) > middle) exit
               n = n + 1
               above(n) = order(next)
               next = next + 1
            end do
            k = 0
            do j = 1, n
               if (middle > road%right(1, above(j))) cycle
               k = k + 1
               above(k) = above(j)
            end do
            n = k
            top = -huge(top)
            do j = 1, n
               y = height(road, above(j), middle)
               ! of two equally high edges, the first
               if (y < top .or. .not. y > top .and. above(j) > road%highest(i)) cycle
               top = y
               road%highest(i) = above(j)
            end do
         end associate
      end do
   end subroutine find_highest

   !> Live loads of the axles, without parts that are not above a movable block
   pure function axle_loads(vehicle, road, origin) result(loaded)
      type(vehicle_t), intent(in) :: vehicle
      type(road_t), intent(in) :: road
      real(wp), intent(in) :: origin(2)  !! Origin of the coordinates of the blocks: (2) [m]
      type(loaded_point_t), allocatable :: loaded(:)  !! The loads: (n)
      real(wp), allocatable :: cut(:), force(:), point(:, :)
      integer, allocatable :: block(:)
      real(wp) :: half, middle, top, width, x
      integer :: edge, i, k, n

      n = size(vehicle%axle)*(size(road%left, 2) + 2)
      allocate (block(n), force(n), point(2, n))
      n = 0
      do i = 1, size(vehicle%axle)
         x = vehicle%position + vehicle%offset(i) - origin(1)
         half = half_length(vehicle, road, origin, x)
         if (allocated(cut)) deallocate (cut)
         allocate (cut, source=[x - half, pack(road%left(1, :), abs(road%left(1, :) - x) < half), &
            & pack(road%right(1, :), abs(road%right(1, :) - x) < half), x + half])
         cut = cut(sorted_order(spread(0, 1, size(cut)), cut))
         do k = 1, size(cut) - 1
            width = cut(k + 1) - cut(k)
            if (.not. width > 0.0_wp .and. half > 0.0_wp) cycle
            middle = 0.5_wp*(cut(k) + cut(k + 1))
            call find_top(road, middle, edge, top)
            if (edge == 0) cycle
            if (.not. road%moves(edge)) cycle
            n = n + 1
            block(n) = road%block(edge)
            point(:, n) = [middle, top]
            force(n) = vehicle%axle(i)
            if (half > 0.0_wp) force(n) = width/(2.0_wp*half)*force(n)
         end do
      end do
      allocate (loaded(n))
      do i = 1, n
         loaded(i)%block = block(i)
         loaded(i)%point = point(:, i)
         loaded(i)%live = .true.
         loaded(i)%force = constant_history([0.0_wp, -force(i)])
      end do
   end function axle_loads

   !> Half the loaded length of an axle [m]. The load spreads down to the lower end of the upper
   !> edge below the axle, or of the nearest end edge beyond the movable blocks
   pure real(wp) function half_length(vehicle, road, origin, x) result(half)
      type(vehicle_t), intent(in) :: vehicle
      type(road_t), intent(in) :: road
      real(wp), intent(in) :: origin(2)
      real(wp), intent(in) :: x  !! Abscissa of the axle, relative to the origin [m]
      real(wp) :: top
      integer :: edge

      half = 0.5_wp*vehicle%length
      if (.not. vehicle%spread > 0.0_wp) return
      if (x > road%reach(1) .and. x < road%reach(2)) then
         call find_top(road, x, edge, top)
      else
         edge = end_edge(road, x)
      end if
      if (edge > 0) top = min(road%left(2, edge), road%right(2, edge))
      half = half + vehicle%spread*max(0.0_wp, vehicle%surface - origin(2) - top)
   end function half_length

   !> Upper edge at the nearest end of the movable blocks. Adjacent fixed edges are excluded,
   !> because round-off would decide between them
   pure integer function end_edge(road, x)
      type(road_t), intent(in) :: road
      real(wp), intent(in) :: x  !! Abscissa of the axle, beyond the movable blocks [m]
      real(wp) :: top, y
      logical :: ends
      integer :: k

      end_edge = 0
      top = -huge(top)
      do k = 1, size(road%block)
         if (.not. road%moves(k)) cycle
         if (x <= road%reach(1)) then
            ends = .not. road%left(1, k) > road%reach(1)
            y = road%left(2, k)
         else
            ends = .not. road%right(1, k) < road%reach(2)
            y = road%right(2, k)
         end if
         if (.not. (ends .and. y > top)) cycle
         top = y
         end_edge = k
      end do
   end function end_edge

   !> Positions between which the loads of all axles vary smoothly: an end of a loaded length is at
   !> a corner of an upper face, or its middle where the loaded length changes
   pure function passages(vehicle, road, origin) result(at)
      type(vehicle_t), intent(in) :: vehicle
      type(road_t), intent(in) :: road
      real(wp), intent(in) :: origin(2)
      real(wp), allocatable :: at(:)  !! The positions, ascending: (n) [m]
      real(wp), allocatable :: corner(:), edge(:), place(:)
      real(wp) :: far, half, middle
      integer :: i, j, n

      allocate (corner, source=upper_corners(road))
      n = size(corner)
      far = beyond_all*(corner(n) - corner(1) + vehicle%length)
      allocate (edge(0:n + 1), source=[corner(1) - far, corner, corner(n) + far])
      allocate (place, source=corner)
      do j = 0, n
         if (.not. edge(j + 1) > edge(j)) cycle
         middle = 0.5_wp*(edge(j) + edge(j + 1))
         half = half_length(vehicle, road, origin, middle)
         if (.not. half > 0.0_wp) cycle
         place = [place, pack([corner - half, corner + half], &
            & ([corner - half, corner + half] - edge(j))*([corner - half, corner + half] &
            & - edge(j + 1)) <= 0.0_wp)]
      end do
      allocate (at(size(place)*size(vehicle%axle)))
      do i = 1, size(vehicle%axle)
         at((i - 1)*size(place) + 1:i*size(place)) = place + origin(1) - vehicle%offset(i)
      end do
      at = at(sorted_order(spread(0, 1, size(at)), at))
   end function passages

   !> Find the highest edge at an abscissa
   pure subroutine find_top(road, x, edge, top)
      type(road_t), intent(in) :: road
      real(wp), intent(in) :: x
      integer, intent(out) :: edge  !! Number of the edge; 0 if there is none
      real(wp), intent(out) :: top  !! Height of the edge [m]
      real(wp) :: y
      integer :: after, before, k, middle

      edge = 0
      top = -huge(top)
      ! the last corner at or to the left of x
      before = 0
      after = size(road%corner) + 1
      do while (after - before > 1)
         middle = (before + after)/2
         if (road%corner(middle) <= x) then
            before = middle
         else
            after = middle
         end if
      end do
      ! at a corner the edge to its left counts too, across coincident corners
      do k = before, 0, -1
         associate (other => road%highest(k))
            if (other > 0) then
               y = height(road, other, x)
               ! of two equally high edges, the first
               if (y > top .or. .not. y < top .and. other <= edge) then
                  top = y
                  edge = other
               end if
            end if
         end associate
         if (k == 0) exit
         if (road%corner(k) < x) exit
      end do
   end subroutine find_top

   !> Height of an edge at an abscissa
   pure real(wp) function height(road, k, x)
      type(road_t), intent(in) :: road
      integer, intent(in) :: k  !! Number of the edge
      real(wp), intent(in) :: x

      height = road%left(2, k) + (x - road%left(1, k))/(road%right(1, k) - road%left(1, k)) &
         & *(road%right(2, k) - road%left(2, k))
   end function height

   !> Abscissae of the corners of the upper faces
   pure function upper_corners(road) result(x)
      type(road_t), intent(in) :: road
      real(wp), allocatable :: x(:)  !! Distinct abscissae, ascending: (n) [m]
      real(wp) :: corner(2, 2*size(road%block)), top
      logical :: upper(2*size(road%block))
      integer :: edge, k

      corner(:, :size(road%block)) = road%left
      corner(:, size(road%block) + 1:) = road%right
      do k = 1, size(upper)
         call find_top(road, corner(1, k), edge, top)
         upper(k) = corner(2, k) >= top - on_top*road%size
      end do
      allocate (x, source=pack(corner(1, :), upper))
      x = x(sorted_order(spread(0, 1, size(x)), x))
      x = pack(x, [.true., x(2:) > x(:size(x) - 1)])
   end function upper_corners
end module dda_vehicle
