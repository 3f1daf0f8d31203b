!> The position of a vehicle at which the least load factor is carried
!>
!> Between two passages of an axle from block to block its loads are quadratic in the position. The
!> joint graph gives the load of least factor under the associated rule. The pressure of fill, which
!> the arch leans against on the side away from the vehicle, makes as many graphs as there are
!> sides.
submodule (dda_compute_case) dda_worst_position
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_boundary, only : loaded_point_t, value_at
   use dda_deck, only : deck_t, has_group, parameter_t, put_number
   use dda_deck_scene, only : deck_scene
   use dda_error, only : error_t
   use dda_fill_loads, only : fill_of, fill_t, live_side, live_total, press_side, side_changes
   use dda_key_names, only : analysis_flow, fill_group, vehicle_both_directions, vehicle_position
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_load_coefficient, only : added_loads, can_follow, full_loads, knows_no_order, &
      & with_coefficient
   use dda_scene_graph, only : has_limit_analysis, scene_graph
   use dda_settings, only : factor_of
   use dda_shape_scene, only : shape_assembly
   use dda_submatrices, only : point_load
   use dda_vehicle, only : axle_loads, is_symmetric, passages, road_of, road_t, turn_round, &
      & vehicle_of, vehicle_t
   implicit none

   !> Offset of an axle beside a passage, and resolution of the worst position, over the total size
   real(wp), parameter :: beside = 1.0e-10_wp, near = 1.0e-6_wp

   !> Data that all positions share
   type :: bridge_t
      type(scene_t) :: scene  !! The scene without the vehicle, its live loads at a factor of one
      type(vehicle_t) :: vehicle         !! The vehicle
      type(road_t) :: road               !! Road below it
      type(fill_t), allocatable :: fill  !! Fill that it stands on
      logical :: stands = .false.        !! True if it stands without live loads
   end type bridge_t

   !> A part of the road
   type :: stretch_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp  !! Where it begins and ends [m]
      integer :: side = 0                     !! Where the live load is on it, see live_side
   end type stretch_t

   interface

      !> Follow the loading paths of positions along the road
      pure module subroutine follow_road(this, bridge, backward, least)
         !> The case, whose deck has the vehicle as it drives; where it stands changes
         type(case_t), intent(inout) :: this
         type(bridge_t), intent(in) :: bridge
         logical, intent(in) :: backward  !! True if it drives the other way
         type(least_factor_t), intent(inout) :: least
      end subroutine follow_road

      !> Follow the loading path of a position
      pure module subroutine try_place(this, place, least, trial)
         type(case_t), intent(inout) :: this  !! Likewise
         real(wp), intent(in) :: place        !! The position [m]
         type(least_factor_t), intent(inout) :: least
         type(trial_t), intent(out), optional :: trial  !! Its path
      end subroutine try_place

      !> Compare the least factor with that of the mirrored position in the other direction
      pure module subroutine try_other_direction(this, bridge, least)
         type(case_t), intent(inout) :: this  !! Likewise
         type(bridge_t), intent(in) :: bridge
         type(least_factor_t), intent(in) :: least
      end subroutine try_other_direction

   end interface

contains

   !> Put the vehicle where the least load factor is carried
   module procedure place_vehicle
      type(bridge_t) :: bridge
      type(least_factor_t) :: least
      type(scene_t) :: scene
      real(wp) :: before
      integer :: ways

      found = .false.
      before = this%family%deck%value(vehicle_position)%number
      this%jump_note = ""
      associate (deck => this%family%deck)
         call move_scene(this%critical%scene, scene)
         if (.not. allocated(scene%contacts%joint)) call deck_scene(deck, scene)
         if (.not. has_limit_analysis(scene%settings, scene%contacts)) return
         call take_bridge(deck, scene, bridge)
         ways = merge(2, 1, deck%value(vehicle_both_directions)%flag .and. .not. is_symmetric(deck))
         call drive(this, bridge, ways, .false., least)
         this%misses_worst = .not. least%is_known
         if (this%misses_worst) then
            least%factor = no_limit
         else if (.not. least%factor > 0.0_wp) then
            ! dead loads that collapse do so under either rule; the associated one has no order of
            ! loads and would go on to live loads that prop them
            deck%value(analysis_flow)%text = "coulomb"
         else if (has_path(bridge)) then
            call begin_paths(this, least)
            ! where the least limit is not decided, nothing is
            if (least%decided) call drive(this, bridge, ways, .true., least)
         end if
         ! what falls wherever the axles stand, and leans against nothing, has no worst position
         this%has_worst = least%factor < no_limit .and. (least%factor > 0.0_wp .or. leans(bridge))
         if (.not. this%has_worst) least = least_factor_t(place=before)
         this%drives_backward = least%backward
         if (this%has_worst .and. deck%value(vehicle_both_directions)%flag) &
            & call try_other_direction(this, bridge, least)
         if (least%backward) call turn_round(deck)
         call put_vehicle(least%place, deck)
         found = allocated(least%critical)
         if (found) this%critical = least%critical
      end associate
   end procedure place_vehicle

   !> Follow the loading path where the associated limit is least
   pure subroutine begin_paths(this, least)
      type(case_t), intent(inout) :: this
      !> The least associated limit in; out, what ends the path there
      type(least_factor_t), intent(inout) :: least
      logical :: known

      known = least%factor < no_limit
      least%factor = no_limit
      if (.not. known) return
      if (least%backward) call turn_round(this%family%deck)
      call try_place(this, least%place, least)
      if (least%backward) call turn_round(this%family%deck)
   end subroutine begin_paths

   !> Drive the vehicle along the road in search of the least factor, one way or both
   pure subroutine drive(this, bridge, ways, by_path, least)
      type(case_t), intent(inout) :: this      !! Its deck has the vehicle as it drives
      type(bridge_t), intent(inout) :: bridge  !! Likewise; both end as they were
      integer, intent(in) :: ways              !! Number of ways it drives, 1 or 2
      logical, intent(in) :: by_path           !! By loading paths, else by associated limits
      type(least_factor_t), intent(inout) :: least
      real(wp) :: before
      integer :: way

      do way = 1, ways
         before = least%factor
         if (by_path) call follow_road(this, bridge, way == 2, least)
         if (least%is_known .and. .not. by_path) call seek_along_road(bridge, least)
         if (least%factor < before) least%backward = way == 2
         if (ways == 1) return
         call turn_round(this%family%deck)
         call seat_vehicle(this%family%deck, bridge)
      end do
   end subroutine drive

   !> True if the first collapse on a loading path may come before the associated limit
   pure logical function has_path(bridge)
      type(bridge_t), intent(in) :: bridge
      type(joint_graph_t) :: graph

      associate (scene => bridge%scene)
         call scene_graph(scene%settings, scene%system, scene%contacts, graph)
         has_path = can_follow(searched_load%factor, scene, 1.0_wp) &
            & .and. .not. knows_no_order(scene%settings, graph)
      end associate
   end function has_path

   !> Seek the least associated limit along the road
   pure subroutine seek_along_road(bridge, least)
      type(bridge_t), intent(in) :: bridge
      type(least_factor_t), intent(inout) :: least
      type(stretch_t), allocatable :: stretch(:)
      integer :: first, last

      call part_road(bridge, stretch)
      first = 1
      do while (first <= size(stretch) .and. least%factor > 0.0_wp .and. least%is_known)
         last = last_of_side(stretch, first)
         call seek_on_side(bridge, stretch(first:last), least)
         first = last + 1
      end do
   end subroutine seek_along_road

   !> The last of the stretches from one on along which the bridge leans against the same fill
   pure integer function last_of_side(stretch, first) result(last)
      type(stretch_t), intent(in) :: stretch(:)  !! The stretches, from left to right: (n)
      integer, intent(in) :: first               !! Number of the first

      last = first
      do while (last < size(stretch))
         if (stretch(last + 1)%side /= stretch(first)%side) return
         last = last + 1
      end do
   end function last_of_side

   !> Put the vehicle of a deck at a position
   pure subroutine put_vehicle(place, deck)
      real(wp), intent(in) :: place  !! The position [m]
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable :: error

      call put_number(deck, parameter_t(key=vehicle_position), place, &
         & deck%value(vehicle_position)%place, error)
   end subroutine put_vehicle

   !> True if there is fill that the bridge can lean against
   pure logical function leans(bridge)
      type(bridge_t), intent(in) :: bridge
      type(scene_t) :: scene

      leans = allocated(bridge%fill)
      if (.not. leans) return
      scene = bridge%scene
      call press_side(bridge%fill, 0, scene)
      leans = allocated(scene%settings%boundary%bounded)
   end function leans

   !> Bridge of a deck
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
      end if
      call seat_vehicle(deck, bridge)
      ! the loads of the vehicle are the last
      axles = axle_loads(bridge%vehicle, bridge%road, scene%origin)
      associate (loaded => scene%settings%boundary%loaded)
         allocate (other, source=loaded(:size(loaded) - size(axles)))
      end associate
      call move_alloc(other, bridge%scene%settings%boundary%loaded)
      bridge%scene%settings = with_coefficient(bridge%scene%settings, searched_load%factor, 1.0_wp)
      bridge%stands = stands_alone(bridge%scene)
   end subroutine take_bridge

   !> Take the vehicle of a deck as it drives
   pure subroutine seat_vehicle(deck, bridge)
      type(deck_t), intent(in) :: deck
      type(bridge_t), intent(inout) :: bridge

      ! what is not allocated is not present
      bridge%vehicle = vehicle_of(deck, bridge%fill)
   end subroutine seat_vehicle

   !> True if a bridge stands without live loads, and without leaning against fill, which could only
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
      real(wp), allocatable :: cut(:), passage(:)
      real(wp) :: from, gap, to
      integer :: i, k

      allocate (passage, source=passages(bridge%vehicle, bridge%road, bridge%scene%origin))
      gap = beside*bridge%road%size
      allocate (stretch(0))
      do k = 1, size(passage) - 1
         if (.not. passage(k + 1) - passage(k) > 2.0_wp*gap) cycle
         cut = [passage(k), turns(bridge, passage(k) + gap, passage(k + 1) - gap), passage(k + 1)]
         do i = 1, size(cut) - 1
            from = cut(i) + gap
            to = cut(i + 1) - gap
            if (to > from) stretch = [stretch, &
               & stretch_t(from, to, side_at(bridge, 0.5_wp*(from + to)))]
         end do
      end do
   end subroutine part_road

   !> Positions between two others at which the bridge begins to lean against other fill
   pure function turns(bridge, from, to) result(at)
      type(bridge_t), intent(in) :: bridge
      real(wp), intent(in) :: from, to  !! The two positions, the loads smooth between them [m]
      real(wp), allocatable :: at(:)    !! Those between, rising: (n) [m]
      real(wp) :: total(2, 3)
      integer :: i

      allocate (at(0))
      if (.not. allocated(bridge%fill)) return
      do i = 1, 3
         total(:, i) = live_total(bridge%scene%settings%boundary%loaded) &
            & + live_total(axles_at(bridge, from + 0.5_wp*real(i - 1, wp)*(to - from)))
      end do
      at = from + (to - from)*side_changes(bridge%fill, bridge%scene%origin, total)
   end function turns

   !> Side of the fill that the bridge leans against with the vehicle at a position
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
