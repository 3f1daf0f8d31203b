!> Axles of a vehicle on the upper faces of the blocks of a scene
module dda_vehicle
   use dda_block_system, only : block_system_t
   use dda_boundary, only : constant_history, loaded_point_t
   use dda_deck, only : deck_t, list_of, real_of
   use dda_fill_loads, only : fill_t
   use dda_kinds, only : wp
   use dda_sort, only : sorted_order
   implicit none
   private

   public :: vehicle_t, axle_loads, upper_corners, vehicle_of

   !> A vehicle
   type :: vehicle_t
      !> Weight of each axle: (n) [N/m]
      real(wp), allocatable :: axle(:)
      !> Distance of each from the first, to the right: (n) [m]
      real(wp), allocatable :: offset(:)
      !> Length over which each is spread, about its middle [m]
      real(wp) :: length = 0.0_wp
      !> Where the first axle is [m]
      real(wp) :: position = 0.0_wp
      !> How far an axle spreads to either side, over the depth of the blocks below the surface
      real(wp) :: spread = 0.0_wp
      !> Height of the surface that it stands on [m]
      real(wp) :: surface = 0.0_wp
   end type vehicle_t

   !> A corner no lower than the upper face by this share of the size of all is on it
   real(wp), parameter :: on_top = 1.0e-9_wp

contains

   !> The vehicle of a deck
   pure function vehicle_of(deck, fill) result(vehicle)
      !> The deck of the case, with &vehicle
      type(deck_t), intent(in) :: deck
      !> Fill that it stands on
      type(fill_t), intent(in), optional :: fill
      !> The vehicle
      type(vehicle_t) :: vehicle
      real(wp), allocatable :: spacing(:)
      integer :: i

      allocate (vehicle%axle, source=list_of(deck, "vehicle", "axles"))
      allocate (spacing, source=list_of(deck, "vehicle", "spacings"))
      allocate (vehicle%offset(size(vehicle%axle)))
      do i = 1, size(vehicle%axle)
         vehicle%offset(i) = sum(spacing(:i - 1))
      end do
      vehicle%length = real_of(deck, "vehicle", "length")
      vehicle%position = real_of(deck, "vehicle", "position")
      if (.not. present(fill)) return
      vehicle%spread = fill%spread
      vehicle%surface = fill%surface
   end function vehicle_of

   !> Live loads of the axles; what is not above a block that moves is left out
   pure function axle_loads(vehicle, system, origin) result(loaded)
      !> The vehicle
      type(vehicle_t), intent(in) :: vehicle
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Origin of their coordinates: (2) [m]
      real(wp), intent(in) :: origin(2)
      !> The loads: (n)
      type(loaded_point_t), allocatable :: loaded(:)
      type(loaded_point_t), allocatable :: piece(:)
      real(wp), allocatable :: cut(:)
      real(wp) :: half, middle, top, width, x
      integer :: b, i, k, n

      allocate (piece(size(vehicle%axle)*(size(system%vertex, 2) + 1)))
      n = 0
      do i = 1, size(vehicle%axle)
         x = vehicle%position + vehicle%offset(i) - origin(1)
         half = 0.5_wp*vehicle%length
         if (vehicle%spread > 0.0_wp) half = half + vehicle%spread &
            & *max(0.0_wp, vehicle%surface - origin(2) - top_below(system, x))
         if (allocated(cut)) deallocate (cut)
         allocate (cut, source=[x - half, pack(system%vertex(1, :), &
            & abs(system%vertex(1, :) - x) < half), x + half])
         cut = cut(sorted_order(spread(0, 1, size(cut)), cut))
         do k = 1, size(cut) - 1
            width = cut(k + 1) - cut(k)
            if (.not. width > 0.0_wp .and. half > 0.0_wp) cycle
            middle = 0.5_wp*(cut(k) + cut(k + 1))
            call find_top(system, middle, b, top)
            if (b == 0) cycle
            if (system%equation(b) == 0) cycle
            n = n + 1
            piece(n)%block = b
            piece(n)%point = [middle, top]
            piece(n)%live = .true.
            piece(n)%force = constant_history([0.0_wp, -vehicle%axle(i)])
            if (half > 0.0_wp) piece(n)%force%value = width/(2.0_wp*half)*piece(n)%force%value
         end do
      end do
      allocate (loaded, source=piece(:n))
   end function axle_loads

   !> Height of the lower end of the upper edge below an axle, of blocks that move; beside them all,
   !> of the nearest end
   pure real(wp) function top_below(system, x) result(top)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The place [m]
      real(wp), intent(in) :: x
      real(wp) :: low, high, top_low
      integer :: b, block

      low = huge(low)
      high = -huge(high)
      do b = 1, size(system%area)
         if (system%equation(b) == 0) cycle
         associate (place => system%vertex(1, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            low = min(low, minval(place))
            high = max(high, maxval(place))
         end associate
      end do
      call find_top(system, min(max(x, low), high), block, top, top_low)
      top = top_low
   end function top_below

   !> The highest block at a place
   pure subroutine find_top(system, x, block, top, lower_end)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The place [m]
      real(wp), intent(in) :: x
      !> Its number; 0 if there is none
      integer, intent(out) :: block
      !> Its height [m]
      real(wp), intent(out) :: top
      !> Height of the lower end of that edge [m]
      real(wp), intent(out), optional :: lower_end
      real(wp) :: share, y
      integer :: b, first, k, n, next

      block = 0
      top = -huge(top)
      do b = 1, size(system%area)
         first = system%first_vertex(b)
         n = system%first_vertex(b + 1) - first
         do k = 0, n - 1
            next = first + modulo(k + 1, n)
            associate (from => system%vertex(:, first + k), to => system%vertex(:, next))
               if ((from(1) - x)*(to(1) - x) > 0.0_wp) cycle
               y = max(from(2), to(2))
               if (abs(to(1) - from(1)) > 0.0_wp) then
                  share = (x - from(1))/(to(1) - from(1))
                  y = from(2) + share*(to(2) - from(2))
               end if
            end associate
            if (.not. y > top) cycle
            top = y
            if (present(lower_end)) lower_end = min(system%vertex(2, first + k), &
               & system%vertex(2, next))
            block = b
         end do
      end do
   end subroutine find_top

   !> Places of the corners of the upper faces, where an axle goes from block to block
   pure function upper_corners(system) result(x)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Their places, rising: (n) [m]
      real(wp), allocatable :: x(:)
      logical :: upper(size(system%vertex, 2))
      real(wp) :: size_of_all, top
      integer :: block, v

      size_of_all = norm2(maxval(system%vertex, dim=2) - minval(system%vertex, dim=2))
      do v = 1, size(upper)
         call find_top(system, system%vertex(1, v), block, top)
         upper(v) = system%vertex(2, v) >= top - on_top*size_of_all
      end do
      allocate (x, source=pack(system%vertex(1, :), upper))
      x = x(sorted_order(spread(0, 1, size(x)), x))
   end function upper_corners
end module dda_vehicle
