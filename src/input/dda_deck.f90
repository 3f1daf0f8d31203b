!> A deck in memory: a value and its origin for every key, and checked changes of values
module dda_deck
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use dda_block_input, only : block_plan_t, new_plan
   use dda_boundary, only : history_t
   use dda_cut_model, only : cut_model_t
   use dda_deck_key, only : full_name, key_kind, key_t, near_key, word_length
   use dda_deck_keys, only : deck_group, deck_key
   use dda_deck_token, only : shown
   use dda_error, only : error_t, fatal_error, warnings_t
   use dda_key_names, only : analysis_geometry, analysis_mode, arch_half_angle_deg, &
      & arch_joints_deg, arch_shape, arch_span, arch_voussoirs, fill_group, &
      & ground_record, limerick_dynamic, material_compressive_strength, scene_kind, search_group, &
      & search_parameter, support_right_rotation_deg, tie_group
   use dda_key_value, only : deck_place_t, deck_value_t, default_value, set_number, set_text
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_line_model, only : line_model_t
   use dda_text, only : lower_case, read_integer, to_text
   implicit none
   private

   public :: deck_t, deck_sweep_t, parameter_t
   public :: ground_record_t
   public :: new_deck, has_group, geometry_of, keeps_velocities, place_of, deck_error, key_error
   public :: number_or, refuse, source_of
   public :: add_file_mark, file_beside
   public :: follow_joints, put_number, put_text
   public :: split_name, find_parameter, parameter_name, group_index, key_index

   !> A key, or one item of a list
   type :: parameter_t
      integer :: key = 0   !! Place in the registry
      integer :: item = 0  !! Item of a list, counted from 1; 0 for a single value
   end type parameter_t

   !> One &sweep
   type :: deck_sweep_t
      type(parameter_t) :: parameter  !! The swept parameter
      !> Name of the parameter, such as friction_deg or joints_deg(2)
      character(len=word_length) :: name = ""
      type(deck_place_t) :: place          !! Place of the values
      logical :: linked = .false.          !! True if it advances together with the previous sweep
      real(wp), allocatable :: numbers(:)  !! Numbers of the parameter; empty if it takes words: (n)
      !> Words of the parameter; empty if it takes numbers: (n)
      character(len=word_length), allocatable :: texts(:)
   end type deck_sweep_t

   !> A record of ground motion named in the deck
   type :: ground_record_t
      character(len=:), allocatable :: name  !! Name of the record in the deck
      type(history_t) :: motion              !! The motion in the units of the file
   end type ground_record_t

   !> A deck: values of all keys in the order of the registry, and contents of its files
   type :: deck_t
      character(len=:), allocatable :: file  !! Name of the file
      !> Values, indexed by dda_key_names: (0:n); 0 is a key that does not exist
      type(deck_value_t), allocatable :: value(:)
      !> Place of each group, likewise; line 0 if it is not given: (n)
      type(deck_place_t), allocatable :: group(:)
      type(parameter_t) :: searched  !! Searched parameter; key 0 if there is no search
      type(deck_sweep_t), allocatable :: sweeps(:)  !! The sweeps in their order: (n)
      !> Lines of the file scene%geometry for kind = 'lines', until they are cut
      type(line_model_t), allocatable :: lines
      type(cut_model_t), allocatable :: cut  !! Blocks cut from them
      !> Contents of the file scene%analysis; unallocated if there is none
      type(limerick_analysis_t), allocatable :: file_analysis
      !> Identifications of all files named in the deck, each preceded by a blank; unallocated
      !> without files
      character(len=:), allocatable :: file_marks
      type(warnings_t) :: warnings  !! Warnings about ignored contents of these files
      type(block_plan_t) :: plan    !! Blocks of the file of blocks
      !> Records of ground motion; unallocated if there are none: (n)
      type(ground_record_t), allocatable :: ground_record(:)
   end type deck_t

contains

   !> Place of a key in the registry, counted from 1; 0 if there is no such key
   pure integer function key_index(group, name)
      character(len=*), intent(in) :: group  !! Name of the group, lower case
      character(len=*), intent(in) :: name   !! Name of the key, lower case

      key_index = findloc(deck_key%group == group .and. deck_key%name == name, .true., dim=1)
   end function key_index

   !> Place of a group in the registry, counted from 1; 0 if there is no such group
   pure integer function group_index(name)
      character(len=*), intent(in) :: name  !! Name of the group, lower case

      group_index = findloc(deck_group%name == name, .true., dim=1)
   end function group_index

   !> Make a deck with defaults
   pure subroutine new_deck(deck, file)
      type(deck_t), intent(out) :: deck
      character(len=*), intent(in) :: file  !! Name for messages
      integer :: i

      deck%file = file
      call new_plan(deck%plan)
      allocate (deck%value(0:size(deck_key)), deck%group(size(deck_group)), deck%sweeps(0))
      deck%value(0)%number = ieee_value(1.0_wp, ieee_quiet_nan)
      do i = 1, size(deck_key)
         deck%value(i) = default_value(deck_key(i))
      end do
   end subroutine new_deck

   !> True if a deck has a group
   pure logical function has_group(deck, group)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: group  !! Place of the group in the registry

      has_group = deck%group(group)%line > 0
   end function has_group

   !> True if velocities are kept from step to step: in mode 'dynamic', or in mode 'limerick' by its
   !> key or else by the analysis file
   pure logical function keeps_velocities(deck)
      type(deck_t), intent(in) :: deck

      keeps_velocities = deck%value(analysis_mode)%text == "dynamic"
      if (deck%value(analysis_mode)%text /= "limerick") return
      keeps_velocities = deck%value(limerick_dynamic)%flag
      if (allocated(deck%file_analysis) .and. .not. deck%value(limerick_dynamic)%given) &
         & keeps_velocities = deck%file_analysis%dynamic
   end function keeps_velocities

   !> Source of the blocks of a case: scene%kind, but `shape` for arches other than a circular ring
   !> of voussoirs
   pure function source_of(deck) result(kind)
      type(deck_t), intent(in) :: deck
      character(len=word_length) :: kind  !! arch, shape, lines or blocks
      character(len=word_length) :: name
      logical :: shaped

      kind = deck%value(scene_kind)%text
      if (kind /= "arch") return
      shaped = any(deck%value(arch_span:support_right_rotation_deg)%given) &
         & .or. has_group(deck, fill_group) .or. has_group(deck, tie_group) &
         & .or. deck%value(material_compressive_strength)%given &
         & .or. deck%value(arch_shape)%text /= "circular"
      if (.not. shaped .and. deck%searched%key > 0) then
         shaped = deck%searched%key >= arch_shape &
            & .and. deck%searched%key <= support_right_rotation_deg &
            & .or. deck%searched%key == material_compressive_strength
      else if (.not. shaped .and. has_group(deck, search_group)) then
         name = lower_case(deck%value(search_parameter)%text)
         name = name(index(name, "%") + 1:)
         shaped = any(name == deck_key(arch_shape:support_right_rotation_deg)%name) &
            & .or. name == "compressive_strength"
      end if
      if (shaped) kind = "shape"
   end function source_of

   !> Geometry of a case; the default of mode 'limerick' is 'current'
   pure function geometry_of(deck) result(word)
      type(deck_t), intent(in) :: deck
      character(len=word_length) :: word  !! reference or current

      word = deck%value(analysis_geometry)%text
      if (deck%value(analysis_mode)%text == "limerick" &
         & .and. .not. deck%value(analysis_geometry)%given) word = "current"
   end function geometry_of

   !> Value of a key, or another number if it is not given
   pure real(wp) function number_or(deck, key, other)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key     !! Place of the key in the registry
      real(wp), intent(in) :: other  !! Value if the key is not given

      number_or = merge(deck%value(key)%number, other, deck%value(key)%given)
   end function number_or

   !> Place of a key, else that of its group; line 0 if neither is given
   pure type(deck_place_t) function place_of(deck, key) result(place)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of the key in the registry

      place = deck%value(key)%place
      if (place%line == 0) place = deck%group(group_index(deck_key(key)%group))
   end function place_of

   !> Set an error with deck and line, or with --set and its number
   pure subroutine deck_error(error, message, deck, place)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: message  !! Expected and actual value
      type(deck_t), intent(in) :: deck
      type(deck_place_t), intent(in) :: place

      if (place%from_command) then
         call fatal_error(error, message, file="--set", line=place%line)
      else
         call fatal_error(error, message, file=deck%file, line=max(place%line, 1))
      end if
   end subroutine deck_error

   !> Set an error at the place of a key, or else of its group
   pure subroutine key_error(error, message, deck, key)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: message
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of the key in the registry

      call deck_error(error, message, deck, place_of(deck, key))
   end subroutine key_error

   !> Set an error if a condition holds, unless there is one already
   pure subroutine refuse(is_wrong, message, deck, key, error)
      logical, intent(in) :: is_wrong          !! The condition
      character(len=*), intent(in) :: message  !! Expected and actual value
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key               !! Place of the key in the registry
      type(error_t), allocatable, intent(inout) :: error

      if (is_wrong .and. .not. allocated(error)) call key_error(error, message, deck, key)
   end subroutine refuse

   !> Add the identification of a file named in the deck
   pure subroutine add_file_mark(mark, deck)
      character(len=*), intent(in) :: mark  !! Identification of the file
      type(deck_t), intent(inout) :: deck

      if (.not. allocated(deck%file_marks)) deck%file_marks = ""
      deck%file_marks = deck%file_marks//" "//mark
   end subroutine add_file_mark

   !> Path of a file named in the deck: relative to the deck unless it begins with a slash
   pure function file_beside(deck, name) result(path)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: name   !! The name in the deck
      character(len=:), allocatable :: path  !! Path of the file

      path = name
      if (index(path, "/") /= 1) path = deck%file(:index(deck%file, "/", back=.true.))//path
   end function file_beside

   !> Set a key, or one item of its list, to a number
   pure subroutine put_number(deck, parameter, number, place, error)
      type(deck_t), intent(inout) :: deck
      type(parameter_t), intent(in) :: parameter  !! The key, with the item if it is a list
      real(wp), intent(in) :: number              !! The number in the unit of the registry
      type(deck_place_t), intent(in) :: place
      !> Allocated for a key without numbers, a value out of range, or a missing item
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem

      call set_number(deck%value(parameter%key), deck_key(parameter%key), parameter%item, number, &
         & problem)
      call close_value(deck, parameter%key, problem, place, error)
   end subroutine put_number

   !> Set a key to a text, a word or a flag
   pure subroutine put_text(deck, parameter, text, place, error)
      type(deck_t), intent(inout) :: deck
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: text  !! The value, without quotes
      type(deck_place_t), intent(in) :: place
      !> Allocated for a key without texts, or an unknown word
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem

      call set_text(deck%value(parameter%key), deck_key(parameter%key), text, problem)
      call close_value(deck, parameter%key, problem, place, error)
   end subroutine put_text

   !> Record the place of a key, or set the error
   pure subroutine close_value(deck, key, problem, place, error)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: key               !! Place of the key in the registry
      character(len=*), intent(in) :: problem  !! The problem; empty if there is none
      type(deck_place_t), intent(in) :: place
      type(error_t), allocatable, intent(out) :: error

      if (len(problem) > 0) then
         call deck_error(error, problem, deck, place)
      else
         deck%value(key)%place = place
         if (key == arch_joints_deg) call follow_joints(deck)
      end if
   end subroutine close_value

   !> Set half angle and number of voussoirs from joints_deg, unless they are given
   pure subroutine follow_joints(deck)
      type(deck_t), intent(inout) :: deck
      integer :: n

      associate (joints => deck%value(arch_joints_deg), angle => deck%value(arch_half_angle_deg), &
         & voussoirs => deck%value(arch_voussoirs))
         n = size(joints%numbers)
         if (n == 0) return
         if (.not. angle%given) angle%number = joints%numbers(n)
         if (.not. voussoirs%given) voussoirs%number = real(2*(n - 1), wp)
      end associate
   end subroutine follow_joints

   !> Split a name such as arch%joints_deg(2)
   pure subroutine split_name(name, group, key, item, ok)
      character(len=*), intent(in) :: name  !! The name
      !> Group, lower case; empty if the name has none
      character(len=:), allocatable, intent(out) :: group
      character(len=:), allocatable, intent(out) :: key  !! Key, lower case
      integer, intent(out) :: item                       !! Item of a list; 0 if the name has none
      !> False if parentheses contain anything other than a number from 1 on
      logical, intent(out) :: ok
      integer :: percent, open

      key = trim(adjustl(lower_case(name)))
      percent = index(key, "%")
      group = trim(key(:max(percent - 1, 0)))
      key = trim(adjustl(key(percent + 1:)))
      item = 0
      ok = .true.
      open = index(key, "(")
      if (open == 0) return
      ok = key(len(key):) == ")"
      if (ok) call read_integer(trim(adjustl(key(open + 1:len(key) - 1))), item, ok)
      ok = ok .and. item >= 1
      key = trim(key(:open - 1))
   end subroutine split_name

   !> Find a key that may vary, by its name
   pure subroutine find_parameter(name, parameter, problem)
      !> Name of the key, with or without its group: friction_deg, joints_deg(2), arch%radius
      character(len=*), intent(in) :: name
      type(parameter_t), intent(out) :: parameter
      character(len=:), allocatable, intent(out) :: problem  !! The problem; empty if there is none
      character(len=:), allocatable :: group, key
      logical :: ok, fits(size(deck_key))
      integer :: i

      call split_name(name, group, key, parameter%item, ok)
      fits = deck_key%name == key .and. (deck_key%group == group &
         .or. len(group) == 0 .and. deck_key%bare)
      problem = ""
      if (.not. ok) then
         problem = "expected a name such as joints_deg(2), got '"//shown(name)// &
            "'; number the items from 1"
      else if (.not. any(fits)) then
         problem = "'"//shown(name)//"' is no key: "//near_key(key, group, deck_key, "keys")
      else if (.not. any(fits .and. deck_key%varies)) then
         problem = "'"//shown(name)//"' cannot be varied; choose a key of the groups arch to "// &
            "analysis"
      else if (count(fits .and. deck_key%varies) > 1) then
         problem = "'"//shown(name)//"' is a key of several groups; write group%key"
      end if
      if (len(problem) > 0) return
      parameter%key = maxloc(merge(1, 0, fits .and. deck_key%varies), dim=1)
      i = parameter%key
      if (deck_key(i)%kind == key_kind%numbers .eqv. parameter%item > 0) return
      problem = trim(deck_key(i)%name)//" is a list; name one item, such as "// &
         trim(deck_key(i)%name)//"(1)"
      if (parameter%item > 0) problem = trim(deck_key(i)%name)//" has no items; remove the "// &
         "parentheses"
   end subroutine find_parameter

   !> Name of a parameter in a header
   pure function parameter_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter
      !> Key, with its group only if the key alone would be ambiguous, and with its item
      character(len=:), allocatable :: name
      type(key_t) :: key
      integer :: alike, i

      key = deck_key(parameter%key)
      name = trim(key%name)
      alike = 0
      do i = 1, size(deck_key)
         if (.not. (deck_key(i)%varies .and. deck_key(i)%bare)) cycle
         ! compare first letters first, because comparing texts is slow
         if (deck_key(i)%name(1:1) /= name(1:1)) cycle
         if (deck_key(i)%name == key%name) alike = alike + 1
      end do
      if (.not. key%bare .or. alike > 1) name = full_name(key)
      if (parameter%item > 0) name = name//"("//to_text(parameter%item)//")"
   end function parameter_name
end module dda_deck
