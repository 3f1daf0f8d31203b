!> Stations of the loading path of a static scene, from zero to the full load
!>
!> Dead loads come first and at once: weight, upright, and forces on points as they are at the
!> beginning. Then what is live comes from nothing to its value, one after the other: prescribed
!> displacements, gravity that tilts, the horizontal push, live loads, histories from their
!> beginning to their end. Between two stations everything is linear.
module dda_load_stations
   use dda_block_system, only : block_system_t
   use dda_boundary, only : history_t, value_at
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use dda_settings, only : factor_of, full_push, gravity_direction, settings_t
   use dda_sort, only : sorted_order
   use dda_submatrices, only : body_load, point_load
   implicit none
   private

   public :: load_stations_t, bears_live_load, load_stations, loads_at, last_history_time
   public :: history_times, leads_at_once, only_weight

   !> Stations of the path; station 0 has the dead loads alone
   type :: load_stations_t
      !> Share of the prescribed displacements at the beginning of their histories: (0:n_leg)
      real(wp), allocatable :: led(:)
      !> Angle of gravity from upright, to the right: (0:n_leg) [rad]
      real(wp), allocatable :: tilt(:)
      !> Share of the weight: somewhat less than one where gravity tilts on a chord: (0:n_leg)
      real(wp), allocatable :: weight(:)
      real(wp), allocatable :: push(:)  !! Horizontal coefficient: (0:n_leg)
      real(wp), allocatable :: live(:)  !! Share of the live loads: (0:n_leg)
      real(wp), allocatable :: time(:)  !! Time of the histories: (0:n_leg) [s]
   end type load_stations_t

   !> Legs of tilting gravity, for self-weight alone and beside other loads [rad]
   real(wp), parameter :: tilt_leg = 4.4e-3_wp, leg_beside = 8.0e-4_wp
   !> Shortest leg over the usual one
   real(wp), parameter :: shortest_leg = 1.0e-9_wp
   !> Load below which a difference is round-off, over its parts
   real(wp), parameter :: rounding = 16.0_wp*epsilon(1.0_wp)

contains

   !> True if nothing but weight acts, so that gravity that tilts is a push of fixed weight
   pure logical function only_weight(settings)
      type(settings_t), intent(in) :: settings

      only_weight = .not. allocated(settings%boundary%loaded)
      if (.not. only_weight) only_weight = size(settings%boundary%loaded) == 0
      only_weight = only_weight .and. .not. allocated(settings%boundary%base_acceleration%time)
   end function only_weight

   !> Stations of a scene, or of a later stage of it: histories alone go on there
   pure type(load_stations_t) function load_stations(settings, upright) result(stations)
      type(settings_t), intent(in) :: settings
      !> True if gravity is upright at first and then tilts; otherwise it is dead as it is
      logical, intent(in) :: upright
      real(wp), allocatable :: time(:)
      real(wp) :: half
      integer :: at, i, n_led, n_live, n_push, n_tilt
      logical :: later

      later = settings%from > 0.0_wp
      allocate (time, source=history_times(settings))
      n_led = merge(1, 0, leads_at_once(settings))
      half = 0.5_wp*merge(tilt_leg, leg_beside, only_weight(settings))
      n_tilt = merge(ceiling(abs(settings%tilt)/(2.0_wp*half) - shortest_leg), 0, upright)
      if (n_tilt > 0) n_tilt = n_tilt + 1
      n_push = merge(1, 0, abs(settings%push) > 0.0_wp .and. .not. settings%live_push)
      n_live = merge(1, 0, bears_live_load(settings))
      if (later) then
         n_led = 0
         n_tilt = 0
         n_push = 0
         n_live = 0
      end if
      at = n_led + n_tilt + n_push + n_live
      allocate (stations%led(0:at + size(time)), source=1.0_wp)
      allocate (stations%tilt(0:at + size(time)), source=settings%tilt)
      allocate (stations%weight(0:at + size(time)), source=1.0_wp)
      allocate (stations%push(0:at + size(time)), source=full_push(settings))
      allocate (stations%live(0:at + size(time)), source=1.0_wp)
      allocate (stations%time(0:at + size(time)), source=settings%from)
      stations%time(at + 1:) = time
      if (later) return
      stations%led(0) = 0.0_wp
      if (n_tilt > 0) then
         at = n_led + n_tilt - 1
         stations%tilt(:at - 1) = sign(2.0_wp*half, settings%tilt) &
            & *[(real(max(0, i - n_led), wp), i=0, at - 1)]
         stations%weight(at) = cos(half)/cos(abs(settings%tilt - stations%tilt(at - 1)) - half)
      end if
      stations%push(:n_led + n_tilt) = 0.0_wp
      stations%live(:n_led + n_tilt + n_push) = 0.0_wp
      if (n_live == 0) stations%live = 1.0_wp
      if (settings%live_push) stations%push = stations%live*full_push(settings)
   end function load_stations

   !> Loads on the blocks and displacements of their supports at a station
   pure subroutine loads_at(stations, station, settings, system, graph, load, opening)
      type(load_stations_t), intent(in) :: stations
      integer, intent(in) :: station  !! Number of the station, from 0
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> Their joints, then the pins of restrained points, then those of bounded forces
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(out) :: load(:, :)  !! Loads: (3, n_block) [N/m, N/m, N]
      !> Opening of the joints by what supports have gone: (3, n_joint) [m]
      real(wp), intent(out), optional :: opening(:, :)
      real(wp) :: direction(2), force(2), shaking(2), of_block(6), total(size(load, 2))
      integer :: b, e, i

      load = 0.0_wp
      call press_carriers(settings, system, load)
      direction = stations%weight(station)*gravity_direction(stations%tilt(station))
      direction(1) = direction(1) + stations%push(station)
      shaking = -value_at(settings%boundary%base_acceleration, stations%time(station))
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         of_block = body_load(system%unit_weight(b)*direction + system%density(b)*shaking, &
            & system%area(b))
         load(:, e) = of_block(:3)
      end do
      if (allocated(graph%bound)) then
         b = graph%n_block - size(graph%bound)
         load(:, b + 1:) = 0.0_wp
         load(1, b + 1:) = -graph%bound
      end if
      if (present(opening)) call lead_pins(stations, station, settings, system, graph, opening)
      if (.not. allocated(settings%boundary%loaded)) return
      total = norm2(load(1:2, :), dim=1)
      do i = 1, size(settings%boundary%loaded)
         associate (loaded => settings%boundary%loaded(i))
            e = system%equation(loaded%block)
            if (e == 0) cycle
            force = factor_of(settings, loaded)*value_at(loaded%force, stations%time(station))
            if (loaded%live) force = stations%live(station)*force
            of_block = point_load(force, loaded%point, system%centroid(:, loaded%block))
            load(:, e) = load(:, e) + of_block(:3)
            total(e) = total(e) + norm2(force)
         end associate
      end do
      ! what is left of loads that cancel is rounding, and must move nothing
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         where (abs(load(1:2, e)) <= rounding*total(e)) load(1:2, e) = 0.0_wp
         if (abs(load(3, e)) <= rounding*total(e)*(norm2(system%centroid(:, b)) &
            & + sqrt(system%area(b)))) load(3, e) = 0.0_wp
      end do
   end subroutine loads_at

   !> Loads of the carriers of bounded forces, the last blocks of a graph
   pure subroutine press_carriers(settings, system, load)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      !> Loads; theirs are set: (3, n_block) [N/m, N/m, N]
      real(wp), intent(inout) :: load(:, :)
      integer :: e, i

      if (.not. allocated(settings%boundary%bounded)) return
      e = maxval(system%equation)
      do i = 1, size(settings%boundary%bounded)
         associate (most => settings%boundary%bounded(i)%most)
            if (.not. most < huge(most)) cycle
            e = e + 1
            load(1, e) = most
         end associate
      end do
   end subroutine press_carriers

   !> Openings of the pins by prescribed displacements
   pure subroutine lead_pins(stations, station, settings, system, graph, opening)
      type(load_stations_t), intent(in) :: stations
      integer, intent(in) :: station
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(in) :: graph
      !> Opening of the joints, none but that of the pins: (3, n_joint) [m]
      real(wp), intent(out) :: opening(:, :)
      real(wp) :: displacement(2)
      integer :: i, j

      opening = 0.0_wp
      if (.not. allocated(settings%boundary%held)) return
      if (.not. any(graph%kind == joint_kind%pin)) return
      j = findloc(graph%kind, joint_kind%pin, dim=1) - 1
      do i = 1, size(settings%boundary%held)
         associate (held => settings%boundary%held(i))
            if (system%equation(held%block) == 0) cycle
            j = j + 1
            displacement = stations%led(station)*value_at(held%path, stations%time(station))
            if (.not. held%along(1)) displacement(1) = displacement(2)
            if (.not. held%along(2)) displacement(2) = displacement(1)
            opening([1, 3], j) = -displacement
         end associate
      end do
   end subroutine lead_pins

   !> True if something live acts before histories begin
   pure logical function bears_live_load(settings)
      type(settings_t), intent(in) :: settings
      integer :: i

      bears_live_load = settings%live_push .and. abs(settings%push) > 0.0_wp
      if (allocated(settings%boundary%loaded)) then
         do i = 1, size(settings%boundary%loaded)
            associate (loaded => settings%boundary%loaded(i))
               bears_live_load = bears_live_load &
                  & .or. loaded%live .and. any(abs(value_at(loaded%force, 0.0_wp)) > 0.0_wp)
            end associate
         end do
      end if
      bears_live_load = bears_live_load .and. abs(settings%load_factor) > 0.0_wp
   end function bears_live_load

   !> True if a support has a prescribed displacement at time 0
   pure logical function leads_at_once(settings)
      type(settings_t), intent(in) :: settings
      integer :: i

      leads_at_once = .false.
      if (.not. allocated(settings%boundary%held)) return
      do i = 1, size(settings%boundary%held)
         leads_at_once = leads_at_once &
            & .or. any(abs(value_at(settings%boundary%held(i)%path, 0.0_wp)) > 0.0_wp)
      end do
   end function leads_at_once

   !> Times at which a history bends, after the beginning
   pure function history_times(settings) result(time)
      type(settings_t), intent(in) :: settings
      real(wp), allocatable :: time(:)  !! The times, ascending, each once: (n) [s]
      integer :: i, n

      n = bends(settings%boundary%base_acceleration)
      if (allocated(settings%boundary%held)) n = n + sum(bends(settings%boundary%held%path))
      if (allocated(settings%boundary%loaded)) n = n + sum(bends(settings%boundary%loaded%force))
      allocate (time(n))
      if (n == 0) return
      n = 0
      call take_times(settings%boundary%base_acceleration, time, n)
      if (allocated(settings%boundary%held)) then
         do i = 1, size(settings%boundary%held)
            call take_times(settings%boundary%held(i)%path, time, n)
         end do
      end if
      if (allocated(settings%boundary%loaded)) then
         do i = 1, size(settings%boundary%loaded)
            call take_times(settings%boundary%loaded(i)%force, time, n)
         end do
      end if
      if (settings%until < huge(1.0_wp)) then
         time = [time, settings%until]
         n = n + 1
      end if
      time = time(sorted_order(spread(0, 1, n), time))
      time = pack(time, time > [settings%from, time(:n - 1)] .and. time > settings%from &
         & .and. time <= settings%until)
   end function history_times

   !> Add the times of one history to a list
   pure subroutine take_times(history, time, n)
      type(history_t), intent(in) :: history
      real(wp), intent(inout) :: time(:)  !! The list, with room for them: (:) [s]
      integer, intent(inout) :: n         !! Number of its times

      if (bends(history) == 0) return
      time(n + 1:n + size(history%time)) = history%time
      n = n + size(history%time)
   end subroutine take_times

   !> Number of times that a history is given at; one time is no change
   elemental integer function bends(history)
      type(history_t), intent(in) :: history

      bends = 0
      if (allocated(history%time)) bends = size(history%time)
      if (bends == 1) bends = 0
   end function bends

   !> Time at which the last history of a scene ends, 0 where there is none [s]
   pure real(wp) function last_history_time(settings)
      type(settings_t), intent(in) :: settings

      last_history_time = maxval([settings%from, history_times(settings)])
   end function last_history_time
end module dda_load_stations
