!> Consistency of the keys of one case
module dda_deck_check_case
   use dda_key_names, only : analysis_geometry, analysis_mode, analysis_unknowns, &
      & arch_facet_deg, arch_group, arch_half_angle_deg, arch_joints_deg, arch_voussoirs, &
      & load_gravity, material_unit_weight, scene_analysis, scene_kind, search_high, search_low, &
      & search_parameter
   use dda_key_value, only : deck_place_t, deck_value_t, default_value, number_problem
   use dda_kinds, only : wp
   use dda_error, only : error_t
   use dda_text, only : short_text, to_text
   use dda_deck_keys, only : deck_key
   use dda_deck, only : deck_error, deck_t, geometry_of, keeps_velocities, key_error, key_index, &
      & number_or, parameter_name, put_number, refuse, source_of
   use dda_deck_check_loads, only : check_ground, check_live, check_strength
   use dda_deck_key, only : full_name, key_t
   use dda_model_table, only : model_problem, search_problem
   implicit none
   private

   public :: check_case, check_model, search_bracket

   !> Angle below which joints coincide [deg]
   real(wp), parameter :: same_angle = 1.0e-9_wp

contains

   !> Check the keys of one case against each other
   pure subroutine check_case(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! The first problem
      integer :: unknowns

      call check_model(deck, error)
      if (.not. allocated(error)) call check_needs(deck, error)
      if (.not. allocated(error)) call check_live(deck, error)
      if (.not. allocated(error)) call check_ground(deck, error)
      if (.not. allocated(error)) call check_strength(deck, error)
      if (allocated(error)) return
      ! files of blocks have their own loads
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

   !> Check that the model exists and that the parameter can be searched in it
   pure subroutine check_model(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the model does not exist
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

   !> Check that a case has the keys that others require, except for keys with default values
   pure subroutine check_needs(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      integer :: key, first, last

      do key = 1, size(deck_key)
         if (deck_key(key)%needs == "" .or. .not. is_active(deck%value(key), deck_key(key))) cycle
         first = 1
         do while (first <= len_trim(deck_key(key)%needs) .and. .not. allocated(error))
            last = first + index(trim(deck_key(key)%needs(first:))//", ", ", ") - 2
            call check_need(deck, key, deck_key(key)%needs(first:last), error)
            first = last + 3
         end do
         if (allocated(error)) return
      end do
   end subroutine check_needs

   !> True if a value is given and differs from the default
   pure logical function is_active(value, key)
      type(deck_value_t), intent(in) :: value
      type(key_t), intent(in) :: key
      type(deck_value_t) :: default

      is_active = value%given
      if (.not. is_active .or. key%default == "") return
      default = default_value(key)
      is_active = abs(value%number - default%number) > 0.0_wp .or. (value%flag .neqv. default%flag)
      if (allocated(value%text)) is_active = value%text /= default%text
   end function is_active

   !> Check one requirement of a key
   pure subroutine check_need(deck, key, need, error)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key            !! Place of the key in the registry
      character(len=*), intent(in) :: need  !! The requirement: one of key_t%needs
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: group, found, name
      integer :: other

      name = need(:index(need//" = ", " = ") - 1)
      if (index(name, "no ") == 1) name = name(4:)
      group = trim(deck_key(key)%group)
      if (index(need, " = ") > 0) group = "analysis"
      if (index(name, "%") > 0) group = name(:index(name, "%") - 1)
      other = key_index(group, name(index(name, "%") + 1:))
      if (index(need, "no ") == 1) then
         call refuse(deck%value(other)%given, full_name(deck_key(key))//" needs "//need &
            & //", got one; remove one of the two", deck, key, error)
      else if (index(need, " = ") == 0) then
         call refuse(.not. deck%value(other)%given, full_name(deck_key(key))//" needs "//need &
            & //", got none; give it", deck, key, error)
      else
         found = deck%value(other)%text
         if (other == analysis_geometry) found = trim(geometry_of(deck))
         call refuse(index(need, "'"//found//"'") == 0, full_name(deck_key(key))//" needs " &
            & //need//", got '"//found//"'; change it, or remove "//trim(deck_key(key)%name), &
            & deck, key, error)
      end if
   end subroutine check_need

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

   !> Check joints_deg and the keys that depend on it
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

   !> Check that half_angle_deg, if given, is the angle of the last joint
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

   !> Place of the later one of two keys of &arch; a --set is later than the deck
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

   !> Check that the parameter can have the value of one end of the search
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

   !> Ends of the search for a parameter
   pure subroutine search_bracket(deck, low, high)
      type(deck_t), intent(in) :: deck
      real(wp), intent(out) :: low   !! Lower end; -huge if there is none
      real(wp), intent(out) :: high  !! Upper end; huge if there is none

      low = number_or(deck, search_low, deck_key(deck%searched%key)%search_low)
      high = number_or(deck, search_high, deck_key(deck%searched%key)%search_high)
   end subroutine search_bracket
end module dda_deck_check_case
