!> Checks of ground motion, collapse criteria, live loads and strengths
module dda_deck_check_loads
   use dda_deck, only : deck_error, deck_t, has_group, key_error, place_of, refuse
   use dda_deck_keys, only : deck_key
   use dda_deck_key, only : full_name
   use dda_error, only : error_t
   use dda_key_names, only : analysis_collapse_displacement, analysis_collapse_point, &
      & analysis_duration, analysis_flow, analysis_geometry, &
      & analysis_mode, analysis_restart, ground_amplitude, ground_direction_deg, &
      & ground_duration, ground_frequency, ground_group, ground_pulse, ground_record, &
      & ground_unit, joint_cohesion, joint_residual_deg, joint_tension, live_fx, live_fy, &
      & live_group, live_x, live_y, load_gravity_direction_deg, load_horizontal_coefficient, &
      & load_live_horizontal, load_load_factor, material_compressive_strength, scene_geometry, &
      & scene_kind, search_high, search_low, search_parameter, vehicle_axles, vehicle_group, &
      & vehicle_list, vehicle_position, vehicle_spacings, vehicle_worst
   use dda_key_value, only : deck_place_t
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: check_block_file, check_ground, check_live, check_strength

contains

   !> Check the ground motion of one case
   pure subroutine check_ground(deck, error)
      type(deck_t), intent(in) :: deck
      !> Allocated for contradicting keys, or a mode without ground motion
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: key

      if (deck%searched%key > 0) call check_search_in_time(deck, error)
      if (allocated(error)) return
      key = ground_key(deck)
      if (.not. has_group(deck, ground_group) .and. key == 0) return
      place = deck%group(ground_group)
      if (place%line == 0) place = deck%value(key)%place
      if (place%line == 0) place = place_of(deck, search_parameter)
      key = 0
      problem = ""
      if (deck%value(analysis_mode)%text /= "dynamic") then
         problem = "&ground needs mode = 'dynamic', got '" &
            & //deck%value(analysis_mode)%text//"'; change the one or remove the other"
      else if (is_given(deck, ground_pulse) .and. is_given(deck, ground_record)) then
         problem = "&ground needs a pulse or a record, got both; remove one of them"
         key = ground_record
      else if (.not. (is_given(deck, ground_pulse) .or. is_given(deck, ground_record)) &
         & .and. deck%value(scene_kind)%text /= "blocks") then
         problem = "&ground needs a pulse or a record, got none; give one"
      end if
      if (len(problem) == 0) call check_keys(deck, problem, key)
      if (key > 0) place = place_of(deck, key)
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_ground

   !> The first key of &ground that is searched, given or swept; 0 if there is none
   pure integer function ground_key(deck)
      type(deck_t), intent(in) :: deck

      ground_key = deck%searched%key
      if (ground_key > 0) then
         if (deck_key(ground_key)%group == "ground") return
      end if
      ground_key = findloc(deck_key%group == "ground" .and. deck%value(1:)%given, .true., dim=1)
   end function ground_key

   !> True if a key is given or searched
   pure logical function is_given(deck, key)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of the key in the registry

      is_given = deck%value(key)%given .or. deck%searched%key == key
   end function is_given

   !> Check required keys of a pulse or a record, and keys without effect
   pure subroutine check_keys(deck, problem, key)
      type(deck_t), intent(in) :: deck
      !> The problem; unchanged if there is none
      character(len=:), allocatable, intent(inout) :: problem
      integer, intent(inout) :: key  !! Key of the problem, 0 for a missing key
      logical, dimension(ground_amplitude:ground_unit) :: needed, fits
      character(len=:), allocatable :: what, name
      integer :: i

      needed = .false.
      fits = .false.
      if (is_given(deck, ground_record)) then
         what = "a record"
         fits = .true.
         fits(ground_duration:ground_frequency) = .false.
      else if (.not. is_given(deck, ground_pulse)) then
         what = "the motion of the file of blocks"
      else if (deck%value(ground_pulse)%text == "sine") then
         what = "a sine"
         needed([ground_amplitude, ground_frequency]) = .true.
         fits(:ground_direction_deg) = .true.
      else
         what = "a rectangular pulse"
         needed(:ground_duration) = .true.
         fits([ground_amplitude, ground_duration, ground_direction_deg]) = .true.
      end if
      do i = ground_amplitude, ground_unit
         name = trim(deck_key(i)%name)
         if (needed(i) .and. .not. is_given(deck, i)) then
            problem = "&ground needs "//name//" for "//what//", got none; give it"
         else if (is_given(deck, i) .and. .not. fits(i)) then
            problem = "ground%"//name//" has no effect on "//what//"; remove it"
            key = i
         end if
         if (len(problem) > 0) return
      end do
   end subroutine check_keys

   !> Check a deck against its file of blocks: one ground motion, a monitoring point for collapse,
   !> and loss of strength by slip only if slip is computed
   pure subroutine check_block_file(deck, error)
      type(deck_t), intent(in) :: deck
      !> Allocated for missing or contradicting items
      type(error_t), allocatable, intent(out) :: error
      logical :: is_given
      integer :: measured, point, s

      measured = 0
      if (allocated(deck%plan%boundary%measured)) measured = size(deck%plan%boundary%measured)
      point = nint(deck%value(analysis_collapse_point)%number)
      call refuse(point > measured, &
         & "analysis%collapse_point needs a monitoring point, from 1 to "//to_text(measured) &
         & //", got "//to_text(point)//"; add 'measure' lines", deck, analysis_collapse_point, &
         & error)
      if (allocated(error)) return
      call check_wear(deck, error)
      if (allocated(error)) return
      is_given = deck%value(ground_pulse)%given .or. allocated(deck%ground_record)
      do s = 1, size(deck%sweeps)
         is_given = is_given .or. deck%sweeps(s)%parameter%key == ground_pulse
      end do
      if (is_given .and. deck%plan%ground_line > 0) then
         call deck_error(error, "&ground needs a file of blocks whose ground is at rest, got "// &
            & "one that moves it in line "//to_text(deck%plan%ground_line)//"; remove one", &
            & deck, deck%group(ground_group))
      else if (has_group(deck, ground_group) .and. .not. is_given &
         & .and. deck%plan%ground_line == 0) then
         call deck_error(error, "&ground needs a pulse, a record, or a file of blocks that "// &
            & "moves the ground, got none; give one", deck, deck%group(ground_group))
      end if
   end subroutine check_block_file

   !> Check that joints may lose strength by slip, if the file has such joints
   pure subroutine check_wear(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(inout) :: error
      integer :: i, key

      key = 0
      if (deck%value(analysis_mode)%text == "limerick") key = analysis_mode
      if (deck%value(analysis_flow)%text == "associated") key = analysis_flow
      if (key == 0) return
      do i = 1, size(deck%plan%laws)
         if (.not. any(deck%plan%laws(i)%given(4:5))) cycle
         call key_error(error, full_name(deck_key(key))//" needs joints without " &
            & //"residual_deg and slip_length, got line "//to_text(deck%plan%laws(i)%line) &
            & //" of the file of blocks; change one of the two", deck, key)
         return
      end do
   end subroutine check_wear

   !> Check the keys of a dynamic search
   pure subroutine check_search_in_time(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error

      if (deck%value(analysis_mode)%text /= "dynamic") return
      call refuse(deck%value(analysis_geometry)%text /= "current", "a search with mode = "// &
         & "'dynamic' needs geometry = 'current', where blocks move, got 'reference'; change it", &
         & deck, search_parameter, error)
      call refuse(.not. deck%value(analysis_duration)%given, "a search with mode = 'dynamic' "// &
         & "needs analysis%duration, in which blocks can collapse, got none; give it", deck, &
         & search_parameter, error)
      call refuse(deck%value(analysis_restart)%given, "a search needs a run from its "// &
         & "beginning, got analysis%restart; remove it", deck, search_parameter, error)
      call refuse(.not. all(deck%value([search_low, search_high])%given), "a search with "// &
         & "mode = 'dynamic' needs search%low and search%high; give both", deck, &
         & search_parameter, error)
   end subroutine check_search_in_time

   !> Check the live loads of one case
   pure subroutine check_live(deck, error)
      type(deck_t), intent(in) :: deck
      !> Allocated for lists of different lengths, or keys without effect
      type(error_t), allocatable, intent(out) :: error
      logical :: pushed

      if (has_group(deck, live_group)) call check_lists(deck, error)
      if (.not. allocated(error) .and. has_group(deck, vehicle_group)) &
         & call check_vehicle(deck, error)
      pushed = deck%searched%key == load_horizontal_coefficient &
         & .or. abs(deck%value(load_horizontal_coefficient)%number) > 0.0_wp
      call refuse(deck%value(load_live_horizontal)%flag .and. .not. pushed, &
         & "load%live_horizontal needs a horizontal_coefficient other "// &
         & "than 0, got 0; give one, or remove live_horizontal", deck, load_live_horizontal, error)
   end subroutine check_live

   !> Check the lists of &live
   pure subroutine check_lists(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: key, n

      place = deck%group(live_group)
      problem = ""
      n = size(deck%value(live_x)%numbers)
      if (n == 0) problem = "&live needs x and y, where its forces act, got none; give both"
      do key = live_y, live_fy
         if (len(problem) > 0) exit
         if (key > live_y .and. .not. is_given(deck, key)) cycle
         if (size(deck%value(key)%numbers) == n) cycle
         problem = full_name(deck_key(key))//" needs as many numbers as live%x, "//to_text(n) &
            & //", got "//to_text(size(deck%value(key)%numbers))//"; give one per force"
         place = place_of(deck, key)
      end do
      if (len(problem) > 0) then
         continue
      else if (deck%value(analysis_mode)%text == "limerick") then
         problem = "&live needs another mode than 'limerick', whose loads are those of its "// &
            & "files; remove one of the two"
      else if (group_of(deck) == "arch") then
         problem = "&live needs an arch that keeps its shape, but the search changes it, "// &
            & "and its points stay; sweep the shape, with x and y linked"
         place = place_of(deck, search_parameter)
      else if (group_of(deck) /= "live" .and. .not. has_forces(deck)) then
         problem = "&live needs a force other than 0, got none; give fx or fy"
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_lists

   !> Check the vehicle
   pure subroutine check_vehicle(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      logical :: worst
      integer :: n

      place = deck%group(vehicle_group)
      worst = deck%value(vehicle_worst)%flag
      n = size(deck%value(vehicle_axles)%numbers)
      problem = ""
      if (deck%value(vehicle_list)%given) then
         continue
      else if (n == 0) then
         problem = "&vehicle needs axles, got none; give their weights, or a list and a name"
      else if (size(deck%value(vehicle_spacings)%numbers) /= n - 1) then
         problem = "vehicle%spacings needs one number fewer than there are axles, "// &
            & to_text(n - 1)//", got "//to_text(size(deck%value(vehicle_spacings)%numbers)) &
            & //"; give the distances between axles"
      end if
      if (len(problem) > 0) then
         continue
      else if (.not. (deck%value(vehicle_position)%given .or. worst &
         & .or. deck%searched%key == vehicle_position)) then
         problem = "&vehicle needs a position, got none; give it, or worst = .true."
      else if (worst .and. deck%value(vehicle_position)%given) then
         problem = "vehicle%worst needs no position, got one; remove one of the two"
         place = place_of(deck, vehicle_position)
      else if (deck%value(analysis_mode)%text == "limerick") then
         problem = "&vehicle needs another mode than 'limerick', whose loads are those of "// &
            & "its files; remove one of the two"
      else if (worst .and. (deck%searched%key /= load_load_factor &
         & .or. deck%value(analysis_mode)%text /= "static" &
         & .or. deck%value(analysis_geometry)%text /= "reference")) then
         problem = "vehicle%worst needs a search for load_factor in static reference "// &
            & "geometry, got none; add &search parameter = 'load_factor'"
         place = place_of(deck, vehicle_worst)
      else if (group_of(deck) == "arch") then
         problem = "&vehicle needs an arch that keeps its shape, but the search changes it; "// &
            & "sweep the shape"
         place = place_of(deck, search_parameter)
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_vehicle

   !> Group of the searched parameter; empty if there is none
   pure function group_of(deck) result(group)
      type(deck_t), intent(in) :: deck
      character(len=len(deck_key%group)) :: group  !! Name of the group

      group = ""
      if (deck%searched%key > 0) group = deck_key(deck%searched%key)%group
   end function group_of

   !> True if any force of &live is nonzero
   pure logical function has_forces(deck)
      type(deck_t), intent(in) :: deck

      has_forces = any(abs(deck%value(live_fx)%numbers) > 0.0_wp) &
         & .or. any(abs(deck%value(live_fy)%numbers) > 0.0_wp)
   end function has_forces

   !> Check that limit analysis is used for blocks that may be crushed; no other method includes
   !> crushing
   pure subroutine check_strength(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! Allocated for contradicting keys
      character(len=*), parameter :: needs = "material%compressive_strength needs "
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place

      if (deck%value(material_compressive_strength)%given) then
         place = place_of(deck, material_compressive_strength)
      else if (deck%searched%key == material_compressive_strength) then
         place = place_of(deck, search_parameter)
      else if (any(deck%plan%materials%given(5))) then
         place = place_of(deck, scene_geometry)
      else
         return
      end if
      problem = ""
      if (deck%value(scene_kind)%text == "lines") then
         problem = needs//"an arch or a file of blocks, got lines; remove it"
      else if (deck%value(analysis_mode)%text /= "static" &
         & .or. deck%value(analysis_geometry)%text /= "reference") then
         problem = needs//"mode = 'static' and geometry = 'reference', got others: corners of "// &
            & "blocks that move have no strip to crush; make the arch thinner, or remove it"
      else if (deck%value(analysis_collapse_displacement)%given .or. has_bond(deck)) then
         problem = needs//"joints without cohesion and tension, and no collapse_displacement, "// &
            & "got one; remove one of the two"
      else if (deck%searched%key == load_gravity_direction_deg) then
         problem = "search%parameter: expected another key beside compressive_strength, got "// &
            & "gravity_direction_deg; search horizontal_coefficient"
         place = place_of(deck, search_parameter)
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_strength

   !> True if joints have strength other than friction
   pure logical function has_bond(deck)
      type(deck_t), intent(in) :: deck
      integer :: i

      has_bond = deck%value(joint_cohesion)%number > 0.0_wp &
         & .or. deck%value(joint_tension)%number > 0.0_wp &
         & .or. deck%value(joint_residual_deg)%given
      do i = 1, size(deck%plan%laws)
         associate (law => deck%plan%laws(i))
            has_bond = has_bond .or. any(law%given(2:3) .and. law%value(2:3) > 0.0_wp) &
               & .or. law%given(4)
         end associate
      end do
   end function has_bond

end module dda_deck_check_loads
