!> The position of a vehicle at which the least load factor is carried
!>
!> Between two passages of an axle from block to block its loads are quadratic in the position.
!> Which of all these is carried at the least factor, under the associated rule, is a question of
!> the joint graph; the pressure of fill, which the arch leans against on the side away from the
!> vehicle, makes as many graphs as there are sides.
module dda_worst_position
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_boundary, only : bounded_force_t, loaded_point_t, value_at
   use dda_deck, only : deck_t
   use dda_fill_loads, only : fill_of, fill_t, press_fill
   use dda_graph_decision, only : decides_as_graph
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_load_coefficient, only : added_loads, full_loads, with_coefficient
   use dda_loads, only : point_load
   use dda_scene, only : scene_t, searched_load
   use dda_scene_graph, only : scene_graph
   use dda_settings, only : factor_of
   use dda_shape_scene, only : add_loads, shape_assembly
   use dda_vehicle, only : axle_loads, passages, road_of, road_t, vehicle_of, vehicle_t
   use dda_worst_load, only : least_factor_t, load_arc_t, seek_least_factor
   use dda_interior_state, only : no_limit
   implicit none
   private

   public :: find_worst_position

   !> How far beside a passage an axle is on the next block, and how near the least is closed in,
   !> over the size of all
   real(wp), parameter :: beside = 1.0e-10_wp, near = 1.0e-6_wp

   !> What the positions have in common
   type :: bridge_t
      !> The scene without the vehicle, its live loads at a factor of one
      type(scene_t) :: scene
      !> The vehicle
      type(vehicle_t) :: vehicle
      !> What it stands on
      type(road_t) :: road
      !> Fill that it stands on
      type(fill_t), allocatable :: fill
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
      type(least_factor_t) :: least
      real(wp), allocatable :: at(:)
      integer :: first, last

      position = 0.0_wp
      found = .false.
      if (.not. decides_as_graph(scene%settings, scene%contacts)) return
      call take_bridge(deck, scene, bridge)
      allocate (at, source=stretches(bridge))
      first = 1
      do while (first < size(at))
         last = first + 1
         do while (last + 1 < size(at))
            if (.not. lean_alike(bridge, at(first), at(last + 1))) exit
            last = last + 2
         end do
         call seek_on_side(bridge, at(first:last), least)
         first = last + 1
      end do
      found = least%factor < no_limit
      if (found) position = least%place
   end subroutine find_worst_position

   !> What a deck has of a bridge
   pure subroutine take_bridge(deck, scene, bridge)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> Its scene with a vehicle anywhere
      type(scene_t), intent(in) :: scene
      type(bridge_t), intent(out) :: bridge
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(loaded_point_t), allocatable :: other(:)

      bridge%scene = scene
      bridge%road = road_of(scene%system)
      if (deck%fill%given) then
         call shape_assembly(deck, assembly, problem)
         allocate (bridge%fill)
         bridge%fill = fill_of(deck, assembly)
         bridge%vehicle = vehicle_of(deck, bridge%fill)
      else
         bridge%vehicle = vehicle_of(deck)
      end if
      ! the loads of the vehicle are the last
      associate (loaded => scene%settings%boundary%loaded)
         allocate (other, source=loaded(:size(loaded) &
            & - size(axle_loads(bridge%vehicle, bridge%road, scene%origin))))
      end associate
      call move_alloc(other, bridge%scene%settings%boundary%loaded)
      bridge%scene%settings = with_coefficient(bridge%scene%settings, searched_load%factor, 1.0_wp)
      bridge%stands = stands_alone(bridge%scene)
   end subroutine take_bridge

   !> Whether a bridge stands without live loads, and without leaning against fill, which could only
   !> help
   pure logical function stands_alone(scene)
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

   !> Stretches of the road along which the loads change smoothly and the bridge leans against the
   !> same fill
   pure function stretches(bridge) result(at)
      type(bridge_t), intent(in) :: bridge
      !> Beginning and end of each, one after the other: (2 n) [m]
      real(wp), allocatable :: at(:)
      real(wp), allocatable :: passage(:)
      real(wp) :: from, other, to
      integer :: k, n

      allocate (passage, source=passages(bridge%vehicle, bridge%road, bridge%scene%origin))
      allocate (at(4*size(passage)))
      n = 0
      do k = 1, size(passage) - 1
         from = passage(k) + beside*bridge%road%size
         to = passage(k + 1) - beside*bridge%road%size
         if (.not. to > from) cycle
         if (.not. lean_alike(bridge, from, to)) then
            other = turning_point(bridge, from, to)
            at(n + 1:n + 2) = [from, other - beside*bridge%road%size]
            n = n + 2
            from = other + beside*bridge%road%size
         end if
         at(n + 1:n + 2) = [from, to]
         n = n + 2
      end do
      at = at(:n)
   end function stretches

   !> Position between two others at which the bridge begins to lean against other fill
   pure real(wp) function turning_point(bridge, from, to) result(middle)
      type(bridge_t), intent(in) :: bridge
      !> The two positions [m]
      real(wp), intent(in) :: from, to
      real(wp) :: ends(2)

      ends = [from, to]
      do
         middle = 0.5_wp*sum(ends)
         if (ends(2) - ends(1) <= 0.1_wp*beside*bridge%road%size) return
         if (lean_alike(bridge, from, middle)) then
            ends(1) = middle
         else
            ends(2) = middle
         end if
      end do
   end function turning_point

   !> Whether the bridge leans against the same fill at two positions
   pure logical function lean_alike(bridge, one, other)
      type(bridge_t), intent(in) :: bridge
      !> The two positions [m]
      real(wp), intent(in) :: one, other
      type(bounded_force_t), allocatable :: a(:), b(:)

      lean_alike = .true.
      if (.not. allocated(bridge%fill)) return
      allocate (a, source=leant_against(bridge, one))
      allocate (b, source=leant_against(bridge, other))
      lean_alike = size(a) == size(b)
      if (lean_alike) lean_alike = all(a%block == b%block)
   end function lean_alike

   !> What the bridge leans against with the vehicle at a position
   pure function leant_against(bridge, position) result(bounded)
      !> The bridge, with fill
      type(bridge_t), intent(in) :: bridge
      !> The position [m]
      real(wp), intent(in) :: position
      !> The forces: (n)
      type(bounded_force_t), allocatable :: bounded(:)
      type(scene_t) :: loads

      loads%origin = bridge%scene%origin
      loads%settings%boundary%loaded = bridge%scene%settings%boundary%loaded
      call add_loads(axles_at(bridge, position), loads)
      call press_fill(bridge%fill, loads)
      allocate (bounded(0))
      if (allocated(loads%settings%boundary%bounded)) bounded = loads%settings%boundary%bounded
   end function leant_against

   !> Loads of the vehicle at a position
   pure function axles_at(bridge, position) result(axles)
      type(bridge_t), intent(in) :: bridge
      !> The position [m]
      real(wp), intent(in) :: position
      !> The loads: (n)
      type(loaded_point_t), allocatable :: axles(:)
      type(vehicle_t) :: vehicle

      vehicle = bridge%vehicle
      vehicle%position = position
      allocate (axles, source=axle_loads(vehicle, bridge%road, bridge%scene%origin))
   end function axles_at

   !> Seek the least factor on stretches on which the bridge leans against the same fill
   pure subroutine seek_on_side(bridge, at, least)
      type(bridge_t), intent(in) :: bridge
      !> Beginning and end of each stretch: (2 n) [m]
      real(wp), intent(in) :: at(:)
      !> The least factor so far
      type(least_factor_t), intent(inout) :: least
      type(load_arc_t) :: arc(size(at)/2)
      type(joint_graph_t) :: graph
      type(scene_t) :: scene
      real(wp), allocatable :: dead(:, :), other(:, :)
      integer :: k

      scene = bridge%scene
      if (allocated(bridge%fill)) scene%settings%boundary%bounded = leant_against(bridge, at(1))
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      other = added_loads(searched_load%factor, scene%settings, scene, graph)
      scene%settings%load_factor = 0.0_wp
      dead = full_loads(scene%settings, scene, graph)
      do k = 1, size(arc)
         arc(k) = arc_of(bridge, at(2*k - 1), at(2*k), other)
      end do
      call seek_least_factor(graph, dead, arc, bridge%stands, near*bridge%road%size, least)
   end subroutine seek_on_side

   !> Live loads with the vehicle on a stretch
   pure function arc_of(bridge, from, to, other) result(arc)
      type(bridge_t), intent(in) :: bridge
      !> Beginning and end of the stretch [m]
      real(wp), intent(in) :: from, to
      !> Live loads beside the vehicle: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: other(:, :)
      !> The loads
      type(load_arc_t) :: arc
      type(loaded_point_t), allocatable :: axles(:)
      real(wp) :: live(3, size(other, 2), 3), load(6)
      logical :: is_loaded(size(other, 2))
      integer :: e, i, j

      is_loaded = any(abs(other) > 0.0_wp, dim=1)
      do j = 1, 3
         live(:, :, j) = other
         if (allocated(axles)) deallocate (axles)
         allocate (axles, source=axles_at(bridge, from + 0.5_wp*real(j - 1, wp)*(to - from)))
         do i = 1, size(axles)
            associate (axle => axles(i), system => bridge%scene%system)
               e = system%equation(axle%block)
               load = point_load(factor_of(bridge%scene%settings, axle)*value_at(axle%force, &
                  & 0.0_wp), axle%point, system%centroid(:, axle%block))
               live(:, e, j) = live(:, e, j) + load(:3)
               is_loaded(e) = .true.
            end associate
         end do
      end do
      arc%from = from
      arc%to = to
      arc%block = pack([(i, i=1, size(is_loaded))], is_loaded)
      arc%load = live(:, arc%block, :)
   end function arc_of
end module dda_worst_position
