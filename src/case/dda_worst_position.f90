!> The position of a vehicle at which the least load factor is carried
!>
!> While no axle passes from one block to another, the load goes with the position in proportion,
!> and the inverse of its associated limit is convex in it: of axles that are points the least
!> factor is at a corner, on one side of it. Axles that are spread are closed in around the least.
module dda_worst_position
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_boundary, only : loaded_point_t
   use dda_deck, only : deck_t, has_group
   use dda_fill_loads, only : fill_of, fill_t, press_fill
   use dda_graph_decision, only : decides_as_graph
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_limit_load, only : find_limit, limit_load_t, limit_state
   use dda_load_coefficient, only : added_loads, full_loads, with_coefficient
   use dda_scene, only : scene_t, searched_load
   use dda_scene_graph, only : scene_graph
   use dda_shape_scene, only : add_loads, shape_assembly
   use dda_sort, only : sorted_order
   use dda_vehicle, only : axle_loads, upper_corners, vehicle_of, vehicle_t
   implicit none
   private

   public :: find_worst_position

   !> Relative gap of the limits that choose the positions to look at, and of those that decide
   real(wp), parameter :: coarse = 1.0e-3_wp, fine = 1.0e-9_wp
   !> How far beside a corner an axle is on the next block, and how near the least is closed in,
   !> over the size of all
   real(wp), parameter :: beside = 1.0e-10_wp, near = 1.0e-6_wp

   !> Positions whose inverse factor is this share of the largest are closed in
   real(wp), parameter :: promising = 0.9_wp

   !> What the positions have in common
   type :: bridge_t
      !> The scene without the vehicle
      type(scene_t) :: scene
      !> Its joints
      type(joint_graph_t) :: graph
      !> Loads at a factor of zero: (3, n_block) [N/m, N/m, N]
      real(wp), allocatable :: dead(:, :)
      !> The vehicle
      type(vehicle_t) :: vehicle
      !> Fill that it stands on
      type(fill_t), allocatable :: fill
      !> All other loads on points: (n)
      type(loaded_point_t), allocatable :: other(:)
      !> Whether it stands without live loads
      logical :: stands = .false.
   end type bridge_t

contains

   !> Find the worst position
   pure subroutine find_worst_position(deck, scene, position, found)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Its scene with a vehicle anywhere
      type(scene_t), intent(in) :: scene
      !> The position of the first axle [m]
      real(wp), intent(out) :: position
      !> Whether any position is bounded
      logical, intent(out) :: found
      type(bridge_t) :: bridge
      real(wp), allocatable :: at(:), inverse(:)
      real(wp) :: best, size_of_all
      integer :: k

      position = 0.0_wp
      found = .false.
      if (.not. decides_as_graph(scene%settings, scene%contacts)) return
      bridge%scene = scene
      call take_vehicle(deck, bridge)
      ! those of the vehicle are the last
      associate (loaded => scene%settings%boundary%loaded, vehicle => bridge%vehicle)
         allocate (bridge%other, source=loaded(:size(loaded) &
            & - size(axle_loads(vehicle, scene%system, scene%origin))))
      end associate
      call scene_graph(scene%settings, scene%system, scene%contacts, bridge%graph)
      allocate (bridge%dead, source=full_loads(with_coefficient(scene%settings, &
         & searched_load%factor, 0.0_wp), scene, bridge%graph))
      bridge%scene%settings = with_coefficient(scene%settings, searched_load%factor, 1.0_wp)
      bridge%stands = stands_alone(scene)
      size_of_all = norm2(maxval(scene%system%vertex, dim=2) - minval(scene%system%vertex, dim=2))
      allocate (at, source=positions(bridge, size_of_all))
      allocate (inverse(size(at)))
      do k = 1, size(at)
         inverse(k) = inverse_factor(bridge, at(k), coarse)
      end do
      best = maxval(inverse)
      do k = 1, size(at)
         if (inverse(k) >= (1.0_wp - 4.0_wp*coarse)*best) &
            & inverse(k) = inverse_factor(bridge, at(k), fine)
      end do
      k = maxloc(inverse, dim=1)
      found = inverse(k) > 0.0_wp
      if (.not. found) return
      position = at(k)
      best = inverse(k)
      if (.not. bridge%vehicle%length > 0.0_wp) return
      do k = 1, size(at)
         if (inverse(k) < promising*maxval(inverse) &
            & .or. inverse(k) < (1.0_wp - 4.0_wp*coarse) &
            & *maxval(inverse(max(1, k - 1):min(size(at), k + 1)))) cycle
         call close_in(bridge, at(max(1, k - 1)), at(min(size(at), k + 1)), near*size_of_all, &
            & position, best)
      end do
   end subroutine find_worst_position

   !> Whether the bridge stands without live loads, and without leaning against fill, which could
   !> only help
   pure logical function stands_alone(scene)
      !> The scene
      type(scene_t), intent(in) :: scene
      type(load_decision_t) :: decision
      type(joint_graph_t) :: graph
      type(scene_t) :: bare

      bare = scene
      if (allocated(bare%settings%boundary%bounded)) deallocate (bare%settings%boundary%bounded)
      bare%settings = with_coefficient(bare%settings, searched_load%factor, 0.0_wp)
      call scene_graph(bare%settings, bare%system, bare%contacts, graph)
      call decide_load(graph, full_loads(bare%settings, bare, graph), decision)
      stands_alone = decision%state == load_state%stands
   end function stands_alone

   !> Positions at which an axle is at a corner, on either side of it; of axles that are spread, an
   !> end or the middle
   pure function positions(bridge, size_of_all) result(at)
      !> The scene and the vehicle
      type(bridge_t), intent(in) :: bridge
      !> Size of the scene [m]
      real(wp), intent(in) :: size_of_all
      !> The positions, rising: (n) [m]
      real(wp), allocatable :: at(:)
      real(wp), allocatable :: corner(:)
      real(wp) :: shift(3)
      integer :: i, j, n

      allocate (corner, source=upper_corners(bridge%scene%system) + bridge%scene%origin(1))
      shift = beside*size_of_all*[-1.0_wp, 0.0_wp, 1.0_wp]
      if (bridge%vehicle%length > 0.0_wp) &
         & shift = 0.5_wp*bridge%vehicle%length*[-1.0_wp, 0.0_wp, 1.0_wp]
      n = 0
      allocate (at(3*size(corner)*size(bridge%vehicle%axle)))
      do i = 1, size(bridge%vehicle%axle)
         do j = 1, 3
            at(n + 1:n + size(corner)) = corner - bridge%vehicle%offset(i) + shift(j)
            n = n + size(corner)
         end do
      end do
      at = at(sorted_order(spread(0, 1, n), at))
   end function positions

   !> Inverse of the associated limit at a position; 0 where there is none
   pure real(wp) function inverse_factor(bridge, position, gap) result(inverse)
      !> The scene and the vehicle
      type(bridge_t), intent(in) :: bridge
      !> The position [m]
      real(wp), intent(in) :: position
      !> Relative gap
      real(wp), intent(in) :: gap
      type(vehicle_t) :: vehicle
      type(scene_t) :: scene
      type(limit_load_t) :: limit
      type(loaded_point_t), allocatable :: axles(:)
      real(wp) :: live(3, bridge%graph%n_block)

      inverse = 0.0_wp
      vehicle = bridge%vehicle
      vehicle%position = position
      scene%system = bridge%scene%system
      scene%settings = bridge%scene%settings
      if (allocated(scene%settings%boundary%loaded)) deallocate (scene%settings%boundary%loaded)
      allocate (axles, source=axle_loads(vehicle, scene%system, bridge%scene%origin))
      if (size(axles) == 0) return
      if (allocated(bridge%fill)) then
         inverse = inverse_in_fill(bridge, axles, gap)
         return
      end if
      allocate (scene%settings%boundary%loaded(size(bridge%other) + size(axles)))
      scene%settings%boundary%loaded(:size(bridge%other)) = bridge%other
      scene%settings%boundary%loaded(size(bridge%other) + 1:) = axles
      live = added_loads(searched_load%factor, scene%settings, scene, bridge%graph)
      if (.not. maxval(abs(live)) > 0.0_wp) return
      call find_limit(bridge%graph, bridge%dead, live, gap, limit, bridge%stands)
      if (limit%state == limit_state%found) inverse = 2.0_wp/(limit%lower + limit%upper)
   end function inverse_factor

   !> The vehicle of a deck, and the fill that it stands on
   pure subroutine take_vehicle(deck, bridge)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Receives them
      type(bridge_t), intent(inout) :: bridge
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem

      if (has_group(deck, "fill")) then
         call shape_assembly(deck, assembly, problem)
         allocate (bridge%fill)
         bridge%fill = fill_of(deck, assembly)
         bridge%vehicle = vehicle_of(deck, bridge%fill)
      else
         bridge%vehicle = vehicle_of(deck)
      end if
   end subroutine take_vehicle

   !> Inverse of the associated limit for axles on fill, which is leant against on the side away
   !> from them; 0 where there is none
   pure real(wp) function inverse_in_fill(bridge, axles, gap) result(inverse)
      !> The scene and the vehicle
      type(bridge_t), intent(in) :: bridge
      !> Loads of the axles
      type(loaded_point_t), intent(in) :: axles(:)
      !> Relative gap
      real(wp), intent(in) :: gap
      type(joint_graph_t) :: graph
      type(limit_load_t) :: limit
      type(scene_t) :: scene
      real(wp), allocatable :: dead(:, :), live(:, :)

      inverse = 0.0_wp
      scene = bridge%scene
      deallocate (scene%settings%boundary%loaded)
      allocate (scene%settings%boundary%loaded, source=bridge%other)
      call add_loads(axles, scene)
      call press_fill(bridge%fill, scene)
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      live = full_loads(scene%settings, scene, graph)
      scene%settings%load_factor = 0.0_wp
      dead = full_loads(scene%settings, scene, graph)
      live = live - dead
      if (.not. maxval(abs(live)) > 0.0_wp) return
      call find_limit(graph, dead, live, gap, limit, bridge%stands)
      if (limit%state == limit_state%found) inverse = 2.0_wp/(limit%lower + limit%upper)
   end function inverse_in_fill

   !> Close in around the least factor by golden sections
   pure subroutine close_in(bridge, left, right, least, position, best)
      !> The scene and the vehicle
      type(bridge_t), intent(in) :: bridge
      !> A position before it [m]
      real(wp), intent(in) :: left
      !> A position behind it [m]
      real(wp), intent(in) :: right
      !> How near it is to be [m]
      real(wp), intent(in) :: least
      !> The position so far; a worse one takes its place [m]
      real(wp), intent(inout) :: position
      !> Inverse of its factor
      real(wp), intent(inout) :: best
      real(wp), parameter :: golden = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
      real(wp) :: a, b, value(2), x(2)
      integer :: k

      a = left
      b = right
      x = [b - golden*(b - a), a + golden*(b - a)]
      value = [inverse_factor(bridge, x(1), fine), inverse_factor(bridge, x(2), fine)]
      do
         k = merge(1, 2, value(1) > value(2))
         if (value(k) > best) then
            best = value(k)
            position = x(k)
         end if
         if (k == 1) then
            b = x(2)
         else
            a = x(1)
         end if
         if (b - a <= least) exit
         ! the better one is one of the next two
         x(3 - k) = x(k)
         value(3 - k) = value(k)
         x(k) = merge(b - golden*(b - a), a + golden*(b - a), k == 1)
         value(k) = inverse_factor(bridge, x(k), fine)
      end do
   end subroutine close_in
end module dda_worst_position
