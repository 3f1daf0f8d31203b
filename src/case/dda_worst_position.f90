!> The position of a vehicle at which the least load factor is carried
!>
!> Between two passages of an axle from block to block its loads are quadratic in the position.
!> Which of all these is carried at the least factor, under the associated rule, is a question of
!> the joint graph; the pressure of fill, which the arch leans against on the side away from the
!> vehicle, makes as many graphs as there are sides.
submodule (dda_compute_case) dda_worst_position
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_boundary, only : loaded_point_t, value_at
   use dda_deck, only : deck_t, has_group, parameter_t, put_number
   use dda_deck_scene, only : deck_scene
   use dda_error, only : error_t
   use dda_fill_loads, only : fill_of, fill_t, live_side, press_side
   use dda_key_names, only : fill_group, vehicle_position
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_load_coefficient, only : added_loads, full_loads, with_coefficient
   use dda_scene_graph, only : has_limit_analysis, scene_graph
   use dda_settings, only : factor_of
   use dda_shape_scene, only : shape_assembly
   use dda_submatrices, only : point_load
   use dda_vehicle, only : axle_loads, passages, road_of, road_t, vehicle_of, vehicle_t
   implicit none

   !> How far beside a passage an axle is on the next block, and how near the least is closed in,
   !> over the size of all
   real(wp), parameter :: beside = 1.0e-10_wp, near = 1.0e-6_wp

   !> What the positions have in common
   type :: bridge_t
      !> The scene without the vehicle, its live loads at a factor of one
      type(scene_t) :: scene
      type(vehicle_t) :: vehicle         !! The vehicle
      type(road_t) :: road               !! What it stands on
      type(fill_t), allocatable :: fill  !! Fill that it stands on
      logical :: stands = .false.        !! Whether it stands without live loads
   end type bridge_t

   !> A part of the road
   type :: stretch_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp  !! Where it begins and ends [m]
      integer :: side = 0                     !! Where the live load is on it, see live_side
   end type stretch_t

contains

   !> Put the vehicle where the least load factor is carried
   module procedure place_vehicle
      type(bridge_t) :: bridge
      type(error_t), allocatable :: error
      type(least_factor_t) :: least
      type(parameter_t) :: position
      type(scene_t) :: scene
      type(stretch_t), allocatable :: stretch(:)
      integer :: first, last

      call deck_scene(this%family%deck, scene)
      if (.not. has_limit_analysis(scene%settings, scene%contacts)) return
      call take_bridge(this%family%deck, scene, bridge)
      call part_road(bridge, stretch)
      first = 1
      do while (first <= size(stretch) .and. least%factor > 0.0_wp)
         last = first
         do while (last < size(stretch))
            if (stretch(last + 1)%side /= stretch(first)%side) exit
            last = last + 1
         end do
         call seek_on_side(bridge, stretch(first:last), least)
         first = last + 1
      end do
      ! what falls wherever the axles stand, and leans against nothing, has no worst position
      this%has_worst = least%factor < no_limit .and. (least%factor > 0.0_wp .or. leans(bridge))
      if (.not. this%has_worst) return
      position%key = vehicle_position
      associate (deck => this%family%deck)
         call put_number(deck, position, least%place, deck%value(position%key)%place, error)
      end associate
   end procedure place_vehicle

   !> Whether there is fill that the bridge can lean against
   pure logical function leans(bridge)
      type(bridge_t), intent(in) :: bridge
      type(scene_t) :: scene

      leans = allocated(bridge%fill)
      if (.not. leans) return
      scene = bridge%scene
      call press_side(bridge%fill, 0, scene)
      leans = allocated(scene%settings%boundary%bounded)
   end function leans

   !> What a deck has of a bridge
   pure subroutine take_bridge(deck, scene, bridge)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(bridge_t), intent(out) :: bridge
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(loaded_point_t), allocatable :: axles(:), other(:)

      bridge%scene = scene
      bridge%road = road_of(scene%system)
      if (has_group(deck, fill_group)) then
         call shape_assembly(deck, assembly, problem)
         allocate (bridge%fill)
         bridge%fill = fill_of(deck, assembly)
         bridge%vehicle = vehicle_of(deck, bridge%fill)
      else
         bridge%vehicle = vehicle_of(deck)
      end if
      ! the loads of the vehicle are the last
      axles = axle_loads(bridge%vehicle, bridge%road, scene%origin)
      associate (loaded => scene%settings%boundary%loaded)
         allocate (other, source=loaded(:size(loaded) - size(axles)))
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

   !> Part the road into stretches along which the loads change smoothly and the bridge leans
   !> against the same fill
   pure subroutine part_road(bridge, stretch)
      type(bridge_t), intent(in) :: bridge
      !> The stretches, from left to right: (n)
      type(stretch_t), allocatable, intent(out) :: stretch(:)
      real(wp), allocatable :: passage(:)
      real(wp) :: at(4), turn
      integer :: side(2), i, k, n

      allocate (passage, source=passages(bridge%vehicle, bridge%road, bridge%scene%origin))
      allocate (stretch(2*size(passage)))
      n = 0
      do k = 1, size(passage) - 1
         at = [passage(k), passage(k), passage(k + 1), passage(k + 1)] &
            & + [1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp]*beside*bridge%road%size
         if (.not. at(4) > at(1)) cycle
         side = [side_at(bridge, at(1)), side_at(bridge, at(4))]
         if (side(1) == side(2)) then
            stretch(n + 1) = stretch_t(at(1), at(4), side(1))
            n = n + 1
         else
            turn = turning_point(bridge, at(1), at(4))
            at(2:3) = turn + [-1.0_wp, 1.0_wp]*beside*bridge%road%size
            do i = 1, 2
               if (.not. at(2*i) > at(2*i - 1)) cycle
               stretch(n + 1) = stretch_t(at(2*i - 1), at(2*i), side(i))
               n = n + 1
            end do
         end if
      end do
      stretch = stretch(:n)
   end subroutine part_road

   !> Position between two others at which the bridge begins to lean against other fill
   pure real(wp) function turning_point(bridge, from, to) result(middle)
      type(bridge_t), intent(in) :: bridge
      real(wp), intent(in) :: from, to  !! The two positions [m]
      real(wp) :: ends(2)
      integer :: side

      ends = [from, to]
      side = side_at(bridge, from)
      do
         middle = 0.5_wp*sum(ends)
         if (ends(2) - ends(1) <= 0.1_wp*beside*bridge%road%size) return
         ends(merge(1, 2, side_at(bridge, middle) == side)) = middle
      end do
   end function turning_point

   !> Which fill the bridge leans against with the vehicle at a position
   pure integer function side_at(bridge, position) result(side)
      type(bridge_t), intent(in) :: bridge
      real(wp), intent(in) :: position  !! Where its first axle is [m]

      side = 0
      if (allocated(bridge%fill)) side = live_side(bridge%fill, bridge%scene%origin, &
         & bridge%scene%settings%boundary%loaded, axles_at(bridge, position))
   end function side_at

   !> Loads of the vehicle at a position
   pure function axles_at(bridge, position) result(axles)
      type(bridge_t), intent(in) :: bridge
      real(wp), intent(in) :: position
      type(loaded_point_t), allocatable :: axles(:)  !! The loads: (n)
      type(vehicle_t) :: vehicle

      vehicle = bridge%vehicle
      vehicle%position = position
      axles = axle_loads(vehicle, bridge%road, bridge%scene%origin)
   end function axles_at

   !> Seek the least factor on stretches on which the bridge leans against the same fill
   pure subroutine seek_on_side(bridge, stretch, least)
      type(bridge_t), intent(in) :: bridge
      type(stretch_t), intent(in) :: stretch(:)
      type(least_factor_t), intent(inout) :: least
      type(load_arc_t) :: arc(size(stretch))
      type(joint_graph_t) :: graph
      type(scene_t) :: scene
      real(wp), allocatable :: dead(:, :), other(:, :)
      integer :: k

      scene = bridge%scene
      if (allocated(bridge%fill)) call press_side(bridge%fill, stretch(1)%side, scene)
      call scene_graph(scene%settings, scene%system, scene%contacts, graph)
      other = added_loads(searched_load%factor, scene%settings, scene, graph)
      scene%settings%load_factor = 0.0_wp
      dead = full_loads(scene%settings, scene, graph)
      do k = 1, size(arc)
         arc(k) = arc_of(bridge, stretch(k)%from, stretch(k)%to, other)
      end do
      call seek_least_factor(graph, dead, arc, bridge%stands, near*bridge%road%size, least)
   end subroutine seek_on_side

   !> Live loads with the vehicle on a stretch
   pure type(load_arc_t) function arc_of(bridge, from, to, other) result(arc)
      type(bridge_t), intent(in) :: bridge
      real(wp), intent(in) :: from, to  !! Beginning and end of the stretch [m]
      !> Live loads beside the vehicle: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: other(:, :)
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

end submodule dda_worst_position
