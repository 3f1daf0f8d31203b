!> Checks of a deck that require its scene: modes, stages, widths, supports, units
module dda_scene_check
   use dda_block_scene, only : floating_block
   use dda_boundary, only : boundary_t
   use dda_contact_types, only : near_miss_t
   use dda_contacts, only : joint_search_t
   use dda_deck, only : deck_error, deck_t, file_beside, has_group, keeps_velocities, key_error, &
      & place_of, source_of
   use dda_deck_check_case, only : check_model
   use dda_deck_keys, only : deck_key
   use dda_deck_scene, only : deck_scene
   use dda_deck_sweep, only : choose_cases, n_cases, turn_to_case
   use dda_error, only : add_warning, error_t, fatal_error, warnings_t
   use dda_key_names, only : analysis_flow, analysis_geometry, analysis_mode, analysis_restart, &
      & limerick_dynamic, live_group, load_displacement_factor, load_load_factor, &
      & material_compressive_strength, output_energy, output_reactions, scene_kind, search_group, &
      & search_parameter, support_left_dx, support_right_rotation_deg, vehicle_group
   use dda_key_value, only : deck_place_t
   use dda_kinds, only : wp
   use dda_limerick_scene, only : check_limerick_blocks
   use dda_line_scene, only : check_line_scene, cut_lines
   use dda_live_loads, only : bears_live, check_live_points
   use dda_near_miss, only : find_near_misses
   use dda_outline, only : outline_of
   use dda_read_deck, only : geometry_file
   use dda_restart, only : check_restart, load_restart
   use dda_scene, only : scene_t
   use dda_shape_check, only : check_shapes
   use dda_step_context, only : march_t
   use dda_text, only : place_text, raised_text, short_text, to_text
   use dda_watch, only : watch_t
   implicit none
   private

   public :: check_lines, check_scene

   !> Strain under self-weight that causes a warning
   real(wp), parameter :: doubtful_strain = 1.0e-3_wp

contains

   !> Check that the modes of a deck can run the blocks of its file, and that a run that goes on has
   !> a file; warn of blocks that will fall, and of units that are no metres
   subroutine check_scene(deck, scene, error, watch, cases)
      type(deck_t), intent(inout) :: deck
      !> Scene of the first case, if its blocks are from a file or if it is the only one and a
      !> check needs it; without blocks otherwise
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error  !! Fault of the scene, or a missing file
      class(watch_t), intent(inout), optional :: watch  !! Progress callback
      !> Cases that will be computed, as choose_cases reads them: the others are not checked
      character(len=*), intent(in), optional :: cases
      logical, allocatable :: chosen(:)

      allocate (chosen(n_cases(deck)), source=.true.)
      if (present(cases)) call choose_cases(cases, n_cases(deck), chosen, error)
      if (allocated(error)) return
      if (present(watch)) call watch%tell("looking for joints", -1.0_wp)
      call cut_lines(deck, error)
      if (.not. allocated(error) .and. deck%value(analysis_restart)%given) &
         & call check_start(deck, scene, error)
      if (.not. allocated(error)) call check_shapes(deck, chosen, error)
      if (.not. allocated(error)) call check_live_cases(deck, chosen, scene, error)
      if (size(chosen) > 1 .and. allocated(scene%contacts%joint)) deallocate (scene%contacts%joint)
      if (allocated(error) .or. deck%value(scene_kind)%text /= "blocks") return
      call check_modes(deck, scene, error)
   end subroutine check_scene

   !> Check that the modes of a deck can run the blocks that were cut from its lines
   pure subroutine check_lines(deck, error)
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene

      if (deck%value(scene_kind)%text == "lines") call check_modes(deck, scene, error)
   end subroutine check_lines

   !> Check the first case of each mode
   pure subroutine check_modes(deck, scene, error)
      type(deck_t), intent(inout) :: deck
      type(scene_t), intent(inout) :: scene  !! Scene of the first case, made if not there
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: work
      integer :: number, mode
      logical :: seen(4)

      seen = .false.
      do number = 1, n_cases(deck)
         call turn_to_case(deck, number, work, error)
         if (allocated(error)) return
         mode = findloc(["static  ", "dynamic ", "limerick"] == &
            & work%value(analysis_mode)%text, .true., dim=1)
         if (mode == 3 .and. keeps_velocities(work)) mode = 4
         if (work%value(scene_kind)%text == "blocks" &
            & .and. .not. allocated(scene%contacts%joint)) call deck_scene(work, scene)
         if (.not. seen(mode)) call check_mode(work, number == 1, scene, deck%warnings, error)
         seen(mode) = .true.
         if (allocated(error) .or. all(seen) .or. .not. any( &
            & deck%sweeps%parameter%key == analysis_mode &
            & .or. deck%sweeps%parameter%key == limerick_dynamic)) return
      end do
   end subroutine check_modes

   !> Check that the mode of one case can run its scene
   pure subroutine check_mode(deck, warns, scene, warnings, error)
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: warns  !! True if warnings are reported
      !> A scene of these blocks and joints, if they are from a file
      type(scene_t), intent(in) :: scene
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: floating
      logical :: static

      select case (deck%value(scene_kind)%text)
      case ("lines")
         ! the analysis file may ask for velocities
         call check_model(deck, error)
         if (allocated(error)) return
         if (deck%value(analysis_mode)%text /= "limerick") call check_line_scene(deck, error)
      case ("blocks")
         static = deck%value(analysis_mode)%text == "static"
         if (deck%value(analysis_mode)%text == "limerick") call check_limerick_blocks( &
            & deck%plan, geometry_file(deck), keeps_velocities(deck), error)
         if (allocated(deck%plan%boundary%change) .and. .not. allocated(error)) &
            & call check_stages(deck, error)
         if (allocated(error)) return
         floating = floating_block(scene)
         if (static .and. floating > 0) call fatal_error(error, "block "//to_text(floating) &
            & //" has no support: no chain of joints ties it to a fixed block, as "// &
            & "mode = 'static' needs; move its edges onto those of its neighbours, or remove " &
            & //"it", geometry_file(deck), deck%plan%line(floating))
         if (.not. allocated(error)) call check_widths(deck, scene, error)
         if (static .and. .not. allocated(error)) call check_loads(deck, scene, error)
         if (allocated(error)) return
         if (warns) call doubt_scene(deck, scene, floating, warnings)
         if (static .and. allocated(deck%plan%boundary%absorbing)) call add_warning(warnings, &
            & "absorb has no effect: mode = 'static' has no time", geometry_file(deck), &
            & deck%plan%boundary%absorbing(1)%line)
      end select
   end subroutine check_mode

   !> True if anything bears on the blocks of a static scene
   pure subroutine check_loads(deck, scene, error)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      if (any(scene%system%unit_weight > 0.0_wp)) return
      if (allocated(scene%system%initial_stress)) then
         if (any(abs(scene%system%initial_stress) > 0.0_wp)) return
      end if
      associate (boundary => scene%settings%boundary)
         if (allocated(boundary%base_acceleration%time)) return
         if (allocated(boundary%loaded)) then
            if (size(boundary%loaded) > 0) return
         end if
         if (leads_points(boundary)) return
      end associate
      call fatal_error(error, "expected a load, got none: load%gravity is 0, no material has a "// &
         & "unit_weight, and no point has a load or a prescribed displacement; add one", &
         & geometry_file(deck), 1)
   end subroutine check_loads

   !> Check that a deck can be run in stages
   pure subroutine check_stages(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem

      problem = ""
      if (has_group(deck, search_group)) then
         problem = "a search needs a model without stages"
      else if (deck%value(analysis_mode)%text == "limerick") then
         problem = "mode = 'limerick' has no stages"
      else if (deck%value(output_energy)%flag) then
         problem = "output%energy needs a model without stages"
      else if (deck%value(output_reactions)%given .and. deck%value(output_reactions)%flag &
         & .and. deck%value(analysis_mode)%text == "dynamic") then
         problem = "output%reactions of a dynamic run needs a model without stages"
      else if ((deck%value(material_compressive_strength)%given &
         & .or. any(deck%plan%materials%given(5))) &
         & .and. deck%value(analysis_flow)%text /= "associated") then
         problem = "blocks with a compressive_strength need flow = 'associated' in "// &
            & "stages"
      else if ((deck%value(analysis_mode)%text == "dynamic") &
         & .neqv. deck%value(analysis_geometry)%text == "current") then
         problem = "stages need mode = 'static' with geometry = 'reference', or mode = 'dynamic' " &
            & //"with geometry = 'current'"
      end if
      if (len(problem) > 0) call fatal_error(error, problem//"; change it or remove this line", &
         & geometry_file(deck), deck%plan%boundary%change(1)%line)
   end subroutine check_stages

   !> Check that what may be crushed does not stand on corners, which bear nothing then
   pure subroutine check_widths(deck, scene, error)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: j

      do j = 1, size(scene%contacts%joint)
         associate (joint => scene%contacts%joint(j))
            if (.not. (scene%contacts%law(joint%law)%strength < huge(1.0_wp) &
               & .and. joint%n_contact == 1)) cycle
            call fatal_error(error, "compressive_strength needs joints with a width, got a "// &
               & "corner of blocks "//to_text(joint%block(1))//" and "//to_text(joint%block(2)) &
               & //" on an edge without bearing area; cut the corner off, or remove "// &
               & "compressive_strength", geometry_file(deck), deck%plan%line(joint%block(1)))
            return
         end associate
      end do
   end subroutine check_widths

   !> Warn of blocks that will fall, and of units that are no metres
   pure subroutine doubt_scene(deck, scene, floating, warnings)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: floating  !! A block without support, or 0
      type(warnings_t), intent(inout) :: warnings
      integer :: n_held

      call doubt_units(deck, scene, warnings)
      call doubt_gaps(deck, scene, warnings)
      if (floating > 0 .and. any(deck%plan%fixed)) call add_warning(warnings, "block " &
         & //to_text(floating)//" has no support and falls freely", geometry_file(deck), &
         & deck%plan%line(floating))
      if (any(deck%plan%fixed)) return
      n_held = 0
      if (allocated(deck%plan%boundary%held)) n_held = size(deck%plan%boundary%held)
      if (n_held == 0) call add_warning(warnings, "nothing is fixed", geometry_file(deck), 1)
   end subroutine doubt_scene

   !> Warn of blocks that almost touch, and whether they are joined
   pure subroutine doubt_gaps(deck, scene, warnings)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(warnings_t), intent(inout) :: warnings
      type(near_miss_t), allocatable :: miss(:)
      type(joint_search_t) :: search
      character(len=:), allocatable :: fate
      integer :: i

      search = scene%contacts%search
      if (allocated(scene%contacts%near_miss)) then
         miss = scene%contacts%near_miss
      else
         search%outline = outline_of(scene%system)
         call find_near_misses(search, scene%system, miss)
      end if
      do i = 1, size(miss)
         fate = "They are not joined"
         if (miss(i)%is_joined) fate = "They are joined"
         if (scene%settings%dynamic .and. scene%settings%current) fate = "They may meet in time"
         call add_warning(warnings, gap_text(miss(i), scene%origin)//". "//fate &
            & //"; correct the corners or set scene%contact_tolerance = " &
            & //raised_text(abs(miss(i)%gap)/miss(i)%allowed*search%tolerance), &
            & geometry_file(deck), deck%plan%line(maxval(miss(i)%joint%block)))
      end do
   end subroutine doubt_gaps

   !> Two blocks that almost touch, how far they are apart, and where
   pure function gap_text(miss, origin) result(text)
      type(near_miss_t), intent(in) :: miss
      real(wp), intent(in) :: origin(2)  !! Where the origin of the scene is: (2) [m]
      character(len=:), allocatable :: text
      character(len=:), allocatable :: verb

      verb = " have a gap of "
      if (miss%gap < 0.0_wp) verb = " overlap by "
      text = "blocks "//to_text(minval(miss%joint%block))//" and " &
         & //to_text(maxval(miss%joint%block))//verb//short_text(abs(miss%gap))//" m at " &
         & //place_text(miss%place + origin)//", contact_tolerance allows " &
         & //short_text(miss%allowed)//" m"
   end function gap_text

   !> Warn where the weight of the blocks would strain them as no masonry is strained: lengths are
   !> then often millimetres
   pure subroutine doubt_units(deck, scene, warnings)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(warnings_t), intent(inout) :: warnings
      character(len=10) :: figure
      real(wp) :: height, strain
      integer :: b

      strain = 0.0_wp
      associate (system => scene%system)
         do b = 1, size(system%area)
            if (system%equation(b) == 0) cycle
            associate (vertex => system%vertex(:, &
               & system%first_vertex(b):system%first_vertex(b + 1) - 1))
               height = maxval(maxval(vertex, dim=2) - minval(vertex, dim=2))
            end associate
            strain = max(strain, system%unit_weight(b)*height &
               & /system%materials(system%material(b))%young)
         end do
      end associate
      if (.not. strain > doubtful_strain) return
      write (figure, "(es10.1)") strain
      call add_warning(warnings, "the weight of a block strains it by "// &
         & trim(adjustl(figure))//": lengths, weights or young in other units than m, N, Pa?", &
         & geometry_file(deck), 1)
   end subroutine doubt_units

   !> Check the file that a run goes on from: a single case must be able to, of many each finds
   !> out
   subroutine check_start(deck, scene, error)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(inout) :: scene  !! Scene of a single case, made here
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name
      type(scene_t) :: begun
      type(march_t) :: march
      logical :: exists

      name = deck%value(analysis_restart)%text
      inquire (file=file_beside(deck, name), exist=exists)
      if (.not. exists) then
         call key_error(error, "there is no restart file '"//name//"'; check the name", deck, &
            & analysis_restart)
      else if (n_cases(deck) == 1) then
         call deck_scene(deck, scene)
         begun = scene
         call load_restart(file_beside(deck, name), begun%settings, begun%system, &
            & begun%contacts, march, error)
      else
         call check_restart(file_beside(deck, name), error)
      end if
   end subroutine check_start

   !> Check that live loads act on blocks that move, and that the load factor has loads
   pure subroutine check_live_cases(deck, chosen, scene, error)
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: chosen(:)  !! Cases that will be computed: (n)
      !> Scene of a single case, made here if it is not there and needed; else of any case
      type(scene_t), intent(inout) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(deck_place_t) :: place
      type(deck_t) :: work
      logical :: points, reshaped
      integer :: number

      place = factor_place(deck, load_displacement_factor)
      if (place%line > 0 .and. .not. (leads_points(deck%plan%boundary) &
         & .or. source_of(deck) == "shape" &
         & .and. any(deck%value(support_left_dx:support_right_rotation_deg)%given))) &
         & call deck_error(error, "load%displacement_factor needs a prescribed displacement, got " &
         & //"none; add &support or a displacement line of a file of blocks", deck, place)
      if (allocated(error)) return
      place = factor_place(deck, load_load_factor)
      points = has_group(deck, live_group) .or. has_group(deck, vehicle_group)
      if (place%line == 0 .and. .not. points) return
      reshaped = any(deck_key(deck%sweeps%parameter%key)%group == "arch" &
         & .or. deck_key(deck%sweeps%parameter%key)%group == "fill")
      do number = 1, size(chosen)
         if (.not. chosen(number)) cycle
         call turn_to_case(deck, number, work, error)
         if (allocated(error)) return
         if (place%line > 0 .and. .not. bears_live(work)) then
            call deck_error(error, "load%load_factor needs a live load, got none; add "// &
               & "&live, a live line of a file of blocks, or load%live_horizontal", deck, place)
         else if (points) then
            if (reshaped .or. .not. allocated(scene%contacts%joint)) call deck_scene(work, scene)
            call check_live_points(work, scene, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_live_cases

   !> True if displacements are prescribed
   pure logical function leads_points(boundary)
      type(boundary_t), intent(in) :: boundary
      integer :: i

      leads_points = .false.
      if (.not. allocated(boundary%held)) return
      do i = 1, size(boundary%held)
         associate (path => boundary%held(i)%path)
            if (allocated(path%value)) leads_points = leads_points &
               & .or. any(abs(path%value) > 0.0_wp)
         end associate
      end do
   end function leads_points

   !> Where a factor is given, swept or searched
   pure type(deck_place_t) function factor_place(deck, key) result(place)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of its key in the registry
      integer :: s

      if (deck%value(key)%given) place = deck%value(key)%place
      do s = 1, size(deck%sweeps)
         if (deck%sweeps(s)%parameter%key == key) place = deck%sweeps(s)%place
      end do
      if (deck%searched%key == key) place = place_of(deck, search_parameter)
   end function factor_place
end module dda_scene_check
