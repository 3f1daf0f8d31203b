!> Live loads of a deck on the blocks of a scene
module dda_live_loads
   use dda_block_system, only : block_system_t
   use dda_boundary, only : constant_history, loaded_point_t
   use dda_deck, only : deck_t, has_group, key_error
   use dda_error, only : error_t
   use dda_fill_loads, only : fill_t
   use dda_key_names, only : live_fx, live_fy, live_group, live_x, live_y, &
      & load_horizontal_coefficient, load_live_horizontal, vehicle_group, vehicle_position, &
      & vehicle_worst
   use dda_kinds, only : wp
   use dda_polygon, only : depth_in
   use dda_scene, only : scene_t
   use dda_shape_scene, only : add_loads
   use dda_text, only : place_text, short_text, to_text
   use dda_vehicle, only : axle_loads, road_of, vehicle_of
   implicit none
   private

   public :: add_live_loads, bears_live, check_live_points

   !> Permitted distance of a point outside its block, over the block size
   real(wp), parameter :: rounded = 1.0e-4_wp

contains

   !> Add the forces of &live and the axles of &vehicle to a scene
   pure subroutine add_live_loads(deck, scene, fill)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(inout) :: scene  !! The scene; forces outside all blocks are omitted
      type(fill_t), intent(in), optional :: fill  !! Fill that spreads the axle loads
      type(loaded_point_t), allocatable :: live(:)

      if (has_group(deck, live_group)) then
         live = loads_of_live(deck, scene)
         call add_loads(live, scene)
      end if
      if (has_group(deck, vehicle_group)) then
         live = axle_loads(vehicle_of(deck, fill), road_of(scene%system), scene%origin)
         call add_loads(live, scene)
      end if
   end subroutine add_live_loads

   !> Forces of &live on the blocks of a scene
   pure function loads_of_live(deck, scene) result(of_live)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      !> The forces, without those outside all blocks: (n)
      type(loaded_point_t), allocatable :: of_live(:)
      type(loaded_point_t), allocatable :: loaded(:)
      real(wp), allocatable :: point(:, :), force(:, :)
      integer :: b, i, n

      call live_lists(deck, scene%origin, point, force)
      allocate (loaded(size(point, 2)))
      n = 0
      do i = 1, size(point, 2)
         b = block_at(scene%system, point(:, i))
         if (b == 0) cycle
         n = n + 1
         loaded(n)%block = b
         loaded(n)%point = point(:, i)
         loaded(n)%force = constant_history(force(:, i))
         loaded(n)%live = .true.
      end do
      allocate (of_live, source=loaded(:n))
   end function loads_of_live

   !> Points and forces of &live
   pure subroutine live_lists(deck, origin, point, force)
      type(deck_t), intent(in) :: deck
      real(wp), intent(in) :: origin(2)  !! Origin of the blocks' coordinates: (2) [m]
      real(wp), allocatable, intent(out) :: point(:, :)  !! Points from the origin: (2, n) [m]
      real(wp), allocatable, intent(out) :: force(:, :)  !! The forces: (2, n) [N/m]
      integer :: n

      n = size(deck%value(live_x)%numbers)
      allocate (point(2, n))
      allocate (force(2, n), source=0.0_wp)
      point(1, :) = deck%value(live_x)%numbers - origin(1)
      point(2, :) = deck%value(live_y)%numbers - origin(2)
      if (deck%value(live_fx)%given) force(1, :) = deck%value(live_fx)%numbers
      if (deck%value(live_fy)%given) force(2, :) = deck%value(live_fy)%numbers
   end subroutine live_lists

   !> Movable block that contains a point most deeply or on its outline, else such a fixed block; 0
   !> if there is none
   pure integer function block_at(system, point)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: point(2)  !! The point: (2) [m]

      block_at = deepest_block(system, system%equation > 0, point)
      if (block_at == 0) block_at = deepest_block(system, system%equation == 0, point)
   end function block_at

   !> Selected block that contains a point most deeply or on its outline; 0 if there is none
   pure integer function deepest_block(system, of, point)
      type(block_system_t), intent(in) :: system
      logical, intent(in) :: of(:)  !! True for selected blocks: (n_block)
      real(wp), intent(in) :: point(2)
      real(wp) :: deepest, depth, low(2), high(2), margin
      integer :: b

      deepest_block = 0
      deepest = -huge(deepest)
      do b = 1, size(system%area)
         if (.not. of(b)) cycle
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            low = minval(vertex, dim=2)
            high = maxval(vertex, dim=2)
            margin = rounded*norm2(high - low)
            if (any(point < low - margin) .or. any(point > high + margin)) cycle
            depth = depth_in(vertex, point)
         end associate
         if (depth < -margin .or. .not. depth > deepest) cycle
         deepest = depth
         deepest_block = b
      end do
   end function deepest_block

   !> Check that the forces of &live act on movable blocks
   pure subroutine check_live_points(deck, scene, error)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene  !! The scene, with or without the forces
      !> Allocated for a point outside all blocks or in a fixed block
      type(error_t), allocatable, intent(out) :: error
      type(loaded_point_t), allocatable :: axle(:)
      character(len=:), allocatable :: text
      real(wp), allocatable :: point(:, :), force(:, :)
      integer :: b, i

      if (has_group(deck, vehicle_group) .and. .not. deck%value(vehicle_worst)%flag) then
         ! a separate variable: gfortran does not free all parts of a function result in an
         ! expression
         axle = axle_loads(vehicle_of(deck), road_of(scene%system), scene%origin)
         if (size(axle) == 0) call key_error(error, &
            & "&vehicle needs an axle above a block that moves, got none at position " &
            & //short_text(deck%value(vehicle_position)%number)//"; move it", deck, &
            & vehicle_position)
         if (allocated(error)) return
      end if
      if (.not. has_group(deck, live_group)) return
      call live_lists(deck, scene%origin, point, force)
      do i = 1, size(point, 2)
         b = block_at(scene%system, point(:, i))
         text = "&live needs points of blocks that move, got " &
            & //place_text(point(:, i) + scene%origin)//", which lies in "
         if (b == 0) then
            call key_error(error, text//"none; move point "//to_text(i), deck, live_x)
            return
         else if (scene%system%equation(b) == 0) then
            call key_error(error, text//"block "//to_text(b)//", which is fixed; move point " &
               & //to_text(i), deck, live_x)
            return
         end if
      end do
   end subroutine check_live_points

   !> True if a case has live loads
   pure logical function bears_live(deck)
      type(deck_t), intent(in) :: deck

      bears_live = has_group(deck, live_group) .or. has_group(deck, vehicle_group) &
         & .or. deck%value(load_live_horizontal)%flag &
         & .and. abs(deck%value(load_horizontal_coefficient)%number) > 0.0_wp
      if (allocated(deck%plan%boundary%loaded)) bears_live = bears_live &
         & .or. any(deck%plan%boundary%loaded%live)
   end function bears_live
end module dda_live_loads
