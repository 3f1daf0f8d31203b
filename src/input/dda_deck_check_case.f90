!> Consistency of the keys of one case
module dda_deck_check_case
   use dda_key_names, only : analysis_damping, analysis_duration, analysis_flow, &
      & analysis_geometry, analysis_mode, analysis_restart, analysis_restitution, &
      & analysis_start, analysis_unknowns, arch_facet_deg, arch_group, arch_half_angle_deg, &
      & arch_joints_deg, arch_voussoirs, joint_residual_deg, joint_slip_length, load_gravity, &
      & material_unit_weight, output_energy, output_frames, output_restart, scene_analysis, &
      & scene_kind, search_high, search_low, search_parameter
   use dda_key_value, only : deck_place_t, number_problem
   use dda_kinds, only : wp
   use dda_error, only : error_t
   use dda_text, only : short_text, to_text
   use dda_deck_keys, only : deck_key
   use dda_deck, only : deck_error, deck_t, geometry_of, keeps_velocities, key_error, number_or, &
      & parameter_name, put_number, refuse, source_of
   use dda_deck_check_loads, only : check_ground, check_live, check_strength
   use dda_deck_key, only : full_name
   use dda_model_table, only : model_problem, search_problem
   implicit none
   private

   public :: check_case, check_model, search_bracket

   !> Angle below which joints coincide [deg]
   real(wp), parameter :: same_angle = 1.0e-9_wp

contains

   !> Check what the keys of one case must be to one another
   pure subroutine check_case(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! The first thing that is wrong
      integer :: unknowns

      call check_model(deck, error)
      if (.not. allocated(error)) call check_use(deck, error)
      call check_slip(deck, error)
      if (.not. allocated(error)) call check_live(deck, error)
      if (.not. allocated(error)) call check_ground(deck, error)
      if (.not. allocated(error)) call check_strength(deck, error)
      if (allocated(error)) return
      ! files of blocks have loads of their own
      if (.not. keeps_velocities(deck) .and. .not. (deck%value(load_gravity)%number > 0.0_wp &
         & .or. deck%value(material_unit_weight)%given .or. deck%value(scene_analysis)%given &
         & .or. deck%value(scene_kind)%text == "blocks" &
         & .and. deck%value(analysis_mode)%text /= "limerick")) call deck_error(error, &
         & "a static analysis needs a weight: load%gravity is 0 and "// &
         & "material%unit_weight is not given; give one of them", deck, &
         & deck%value(load_gravity)%place)
      unknowns = nint(deck%value(analysis_unknowns)%number)
      call refuse(deck%value(analysis_unknowns)%given .and. all(unknowns /= [3, 6]), &
         & "analysis%unknowns must be 3 or 6, got "//to_text(unknowns) &
         & //"; choose one of the two", deck, analysis_unknowns, error)
      if (.not. allocated(error) .and. source_of(deck) == "arch") call check_shape(deck, error)
      if (.not. allocated(error) .and. deck%searched%key > 0) call check_bracket(deck, error)
   end subroutine check_case

   !> Check that there is such a model, and that the parameter can be searched in it
   pure subroutine check_model(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! What the table of models does not have
      character(len=:), allocatable :: mode, kind, problem

      mode = deck%value(analysis_mode)%text
      kind = trim(source_of(deck))
      problem = model_problem(kind, mode, trim(geometry_of(deck)))
      if (len(problem) > 0) call key_error(error, "expected a geometry that mode = '"//mode &
         & //"' of scene%kind = '"//kind//"' runs, got '"//trim(geometry_of(deck))//"': "//problem &
         & //"; 'dda help models' lists them", deck, analysis_geometry)
      if (allocated(error)) return
      if (deck%searched%key == 0) return
      problem = search_problem(deck_key(deck%searched%key), kind, mode)
      if (mode == "limerick" .and. keeps_velocities(deck)) &
         problem = "with velocities it ends 'completed'"
      if (len(problem) > 0) call key_error(error, "search%parameter: expected a key that "// &
         "mode = '"//deck%value(analysis_mode)%text//"' of scene%kind = '"//kind// &
         "' searches, got "//full_name(deck_key(deck%searched%key))//": "//problem// &
         "; 'dda help models' lists them", deck, search_parameter)
   end subroutine check_model

   !> Check that the mode and the geometry have a use for the keys that are given
   pure subroutine check_use(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: mode
      logical :: in_time, moves

      mode = deck%value(analysis_mode)%text
      in_time = mode == "dynamic"
      moves = deck%value(analysis_geometry)%text == "current"
      associate (value => deck%value)
         call refuse(value(analysis_restitution)%number > 0.0_wp &
            & .and. .not. (in_time .and. moves), "restitution needs mode = "// &
            & "'dynamic' and geometry = 'current'", deck, analysis_restitution, error)
         call refuse(value(analysis_damping)%number > 0.0_wp .and. .not. in_time, &
            & "damping needs mode = 'dynamic', got '"//mode//"'; remove one of the two", deck, &
            & analysis_damping, error)
         call refuse(value(analysis_duration)%given .and. .not. in_time, &
            & "duration needs mode = 'dynamic': a static run has no time", deck, &
            & analysis_duration, error)
         call refuse(value(analysis_restart)%given .and. .not. in_time, "analysis%restart "// &
            & "needs mode = 'dynamic': a static run has no time", deck, &
            & analysis_restart, error)
         call refuse(value(analysis_start)%text == "static" .and. (.not. in_time &
            & .or. value(analysis_restart)%given), "start = 'static' needs mode = 'dynamic' "// &
            & "and a run from its beginning; remove it", deck, analysis_start, error)
         call refuse(value(analysis_flow)%text == "associated" .and. mode /= "static", &
            & "flow = 'associated' needs mode = 'static', got '"//mode//"'; remove one of the "// &
            & "two", deck, analysis_flow, error)
         if (mode == "limerick") then
            call refuse(value(analysis_unknowns)%given, "analysis%unknowns needs another mode "// &
               & "than 'limerick', whose blocks have 6; remove it", deck, analysis_unknowns, error)
            call refuse(value(output_energy)%flag, "output%energy needs mode = 'dynamic', got "// &
               & "'limerick'; remove one of the two", deck, output_energy, error)
            call refuse(value(output_restart)%flag, "output%restart needs mode = 'dynamic', "// &
               & "got 'limerick'; remove one of the two", deck, output_restart, error)
         else
            call refuse(nint(value(output_frames)%number) > 0 .and. .not. moves, &
               & "output%frames needs geometry = 'current': in reference geometry no block "// &
               & "moves; change one of the two", deck, output_frames, error)
         end if
      end associate
   end subroutine check_use

   !> Check that joints may lose strength by slip
   pure subroutine check_slip(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(inout) :: error
      integer :: key

      if (allocated(error)) return
      do key = joint_residual_deg, joint_slip_length
         if (.not. deck%value(key)%given) cycle
         if (any(deck%value(scene_kind)%text == ["lines ", "blocks"]) &
            & .and. deck%value(analysis_mode)%text /= "limerick" &
            & .and. deck%value(analysis_flow)%text /= "associated") cycle
         call key_error(error, full_name(deck_key(key))//" needs scene%kind = 'lines' or "// &
            "'blocks', mode = 'static' or 'dynamic' and flow = 'coulomb'; remove it", deck, key)
         return
      end do
   end subroutine check_slip

   !> Check the joints of the arch
   pure subroutine check_shape(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: span

      if (deck%value(arch_joints_deg)%given) then
         call check_joints(deck, error)
         return
      end if
      span = 2.0_wp*deck%value(arch_half_angle_deg)%number/deck%value(arch_voussoirs)%number
      if (span < 180.0_wp .or. deck%value(arch_facet_deg)%given) return
      call deck_error(error, "one chord per voussoir needs voussoirs of less than 180 degrees, "// &
         "got "//short_text(span)//"; give facet_deg or more voussoirs", deck, &
         later(deck, arch_half_angle_deg, arch_voussoirs))
   end subroutine check_shape

   !> Check joints_deg, and what is given beside it
   pure subroutine check_joints(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: n, i

      place = deck%value(arch_joints_deg)%place
      problem = ""
      associate (joints => deck%value(arch_joints_deg)%numbers)
         n = size(joints)
         if (n < 2) then
            problem = "must be two angles or more, got "//to_text(n)// &
               "; write 0 (the crown) and the springing at least"
         else if (abs(joints(1)) > 0.0_wp) then
            problem = "must begin with 0 (the crown), got "//short_text(joints(1))// &
               "; write the joints of one half only"
         else if (deck%value(arch_voussoirs)%given) then
            problem = "and arch%voussoirs exclude one another; remove one of them"
            place = later(deck, arch_joints_deg, arch_voussoirs)
         end if
         do i = 2, n
            if (len(problem) > 0) exit
            if (joints(i) > joints(i - 1) + same_angle) cycle
            problem = "must be increasing angles [deg], got "//to_text(joints(i - 1))// &
               " before "//to_text(joints(i))//"; sort them, each one once"
         end do
      end associate
      if (len(problem) > 0) then
         call deck_error(error, "arch%joints_deg "//problem, deck, place)
      else
         call check_half_angle(deck, error)
      end if
   end subroutine check_joints

   !> Check that half_angle_deg, where given, is where the joints end
   pure subroutine check_half_angle(deck, error)
      !> The deck of one case, with two angles in joints_deg or more
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: half_angle, last

      if (.not. deck%value(arch_half_angle_deg)%given) return
      half_angle = deck%value(arch_half_angle_deg)%number
      associate (joints => deck%value(arch_joints_deg)%numbers)
         last = joints(size(joints))
      end associate
      if (.not. abs(last - half_angle) > same_angle) return
      call deck_error(error, "arch%joints_deg ends at "//to_text(last)// &
         ", but arch%half_angle_deg is "//to_text(half_angle)//"; remove half_angle_deg", deck, &
         later(deck, arch_joints_deg, arch_half_angle_deg))
   end subroutine check_half_angle

   !> Where the later one of two keys of &arch was given; a --set is later than the deck
   pure type(deck_place_t) function later(deck, a, b) result(place)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: a, b  !! Places of the keys in the registry
      type(deck_place_t) :: other
      logical :: other_is_later

      place = deck%value(a)%place
      other = deck%value(b)%place
      other_is_later = other%line > place%line .and. .not. place%from_command
      if (other%from_command .or. other_is_later) place = other
      if (place%line == 0) place = deck%group(arch_group)
   end function later

   !> Check the two ends of the search
   pure subroutine check_bracket(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: low, high

      call search_bracket(deck, low, high)
      call refuse(.not. low > -huge(low) .or. .not. high < huge(high), "a search for " &
         & //parameter_name(deck%searched)//" needs search%low and search%high, which have no "// &
         & "default; give both", deck, search_parameter, error)
      call refuse(.not. low < high, "search%low must be below search%high, got "//to_text(low)// &
         & " and "//to_text(high)//"; make low the smaller one", deck, &
         & merge(search_high, search_low, deck%value(search_high)%given), error)
      if (.not. allocated(error)) call check_end(deck, search_low, error)
      if (.not. allocated(error)) call check_end(deck, search_high, error)
   end subroutine check_bracket

   !> Check that the parameter can take one end of the search
   pure subroutine check_end(deck, key, error)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of the key of that end in the registry
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_t) :: trial

      associate (bound => deck%value(key))
         if (.not. bound%given) return
         problem = number_problem(deck_key(deck%searched%key), bound%number)
         if (len(problem) > 0) then
            call deck_error(error, full_name(deck_key(key))//": "//problem// &
               "; choose an end that it can take", deck, bound%place)
         else if (deck_key(deck%searched%key)%group == "arch" .and. source_of(deck) == "arch") then
            trial = deck
            call put_number(trial, deck%searched, bound%number, bound%place, error)
            if (.not. allocated(error)) call check_shape(trial, error)
         end if
      end associate
   end subroutine check_end

   !> Where the search for a parameter begins and ends
   pure subroutine search_bracket(deck, low, high)
      type(deck_t), intent(in) :: deck
      real(wp), intent(out) :: low   !! Lower end; -huge if there is none
      real(wp), intent(out) :: high  !! Upper end; huge if there is none

      low = number_or(deck, search_low, deck_key(deck%searched%key)%search_low)
      high = number_or(deck, search_high, deck_key(deck%searched%key)%search_high)
   end subroutine search_bracket
end module dda_deck_check_case
