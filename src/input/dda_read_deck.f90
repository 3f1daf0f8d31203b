!> Reading of a deck: file, --set values, sweeps, and all checks
module dda_read_deck
   use dda_deck, only : add_file_mark, deck_error, deck_t, file_beside, find_parameter, &
      & follow_joints, group_index, has_group, new_deck, parameter_t, put_text, split_name
   use dda_deck_check_loads, only : check_block_file
   use dda_deck_key, only : full_name, key_kind, key_t, near_group
   use dda_deck_keys, only : deck_group, deck_key
   use dda_deck_scan, only : scan_values
   use dda_deck_sweep, only : add_sweep, few_cases, n_cases
   use dda_deck_token, only : deck_scan_t, shown
   use dda_error, only : error_t
   use dda_key_entry, only : find_key, key_group_t, read_groups, read_value
   use dda_key_names, only : analysis_mode, analysis_restart, arch_group, output_blocks, &
      & output_joints, output_proof, output_reactions, scene_contact_tolerance, scene_geometry, &
      & scene_kind, search_group, search_parameter, sweep_group
   use dda_key_value, only : deck_place_t
   use dda_read_blocks, only : parse_blocks
   use dda_text, only : to_text
   use dda_text_file, only : file_mark, read_text_file, text_mark
   use dda_vehicle_list, only : read_vehicle
   use dda_watch, only : watch_t
   implicit none
   private

   public :: read_deck, parse_deck, geometry_file, check_deck

   !> Setting of --tight for a search
   character(len=*), parameter :: tightest = "search%tolerance=1e-11"

   interface

      !> Read all ground motion records of a deck
      module subroutine read_ground_records(deck, error)
         type(deck_t), intent(inout) :: deck  !! The deck, checked; receives the records
         type(error_t), allocatable, intent(out) :: error
      end subroutine read_ground_records

      !> Read the files of a deck with kind = 'lines'; other decks are unchanged
      module subroutine read_lines(deck, error)
         !> The deck, checked; receives lines, analysis and warnings
         type(deck_t), intent(inout) :: deck
         !> Allocated if the files are invalid or do not match
         type(error_t), allocatable, intent(out) :: error
      end subroutine read_lines

      !> Add the place of a key to an error about a file that cannot be read, because the line of
      !> the deck is more useful
      pure module subroutine name_key(deck, key, error)
         type(deck_t), intent(in) :: deck
         integer, intent(in) :: key  !! Index of the key in the registry
         type(error_t), allocatable, intent(inout) :: error
      end subroutine name_key

      !> Check a deck and all cases of its sweeps before any computation
      pure module subroutine check_deck(deck, cases, error)
         type(deck_t), intent(in) :: deck
         character(len=*), intent(in) :: cases  !! Selected cases, as in choose_cases; empty for all
         type(error_t), allocatable, intent(out) :: error  !! The first problem
      end subroutine check_deck

   end interface

   !> Page of the help with the list of groups and keys
   character(len=*), parameter :: topic = "keys"

contains

   !> Read and check a deck and all cases of its sweeps
   subroutine read_deck(file, settings, deck, error, watch, cases, tight)
      character(len=*), intent(in) :: file         !! Name of the file
      character(len=*), intent(in) :: settings(:)  !! --set values, as group%key=value: (n)
      type(deck_t), intent(out) :: deck
      !> Allocated for bad input, with file and line, or with --set and its number
      type(error_t), allocatable, intent(out) :: error
      class(watch_t), intent(inout), optional :: watch
      !> Selected cases, such as 1-500,812; only these are checked; absent or empty for all
      character(len=*), intent(in), optional :: cases
      logical, intent(in), optional :: tight  !! True for search bounds at the limit of round-off
      character(len=:), allocatable :: text, geometry

      call read_text_file(file, text, error)
      if (.not. allocated(error)) call parse_deck(text, file, settings, deck, error, cases, tight)
      if (.not. allocated(error)) call read_lines(deck, error)
      if (.not. allocated(error)) call read_ground_records(deck, error)
      if (.not. allocated(error)) call read_vehicle(deck, error)
      if (allocated(error)) return
      if (deck%value(analysis_restart)%given) call add_file_mark(file_mark( &
         & file_beside(deck, deck%value(analysis_restart)%text)), deck)
      if (deck%value(scene_kind)%text /= "blocks") return
      geometry = geometry_file(deck)
      call read_text_file(geometry, text, error)
      call name_key(deck, scene_geometry, error)
      if (allocated(error)) return
      call parse_blocks(text, geometry, deck%plan, deck%warnings, error, watch, &
         & deck%value(scene_contact_tolerance)%number)
      call add_file_mark(text_mark(text), deck)
      if (allocated(deck%plan%record_marks)) call add_file_mark(deck%plan%record_marks, deck)
      if (.not. allocated(error)) call check_block_file(deck, error)
   end subroutine read_deck

   !> Path of the file of blocks: relative to the deck unless it begins with a slash
   pure function geometry_file(deck) result(path)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: path

      path = file_beside(deck, deck%value(scene_geometry)%text)
   end function geometry_file

   !> Read and check a deck from its text
   pure subroutine parse_deck(text, file, settings, deck, error, cases, tight)
      character(len=*), intent(in) :: text  !! The text, lines ended by line feeds
      character(len=*), intent(in) :: file  !! Name for messages
      character(len=*), intent(in) :: settings(:)
      type(deck_t), intent(out) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in), optional :: cases  !! As in read_deck
      logical, intent(in), optional :: tight           !! As in read_deck
      type(key_group_t), allocatable :: group(:)
      character(len=:), allocatable :: checked, problem
      integer :: i

      call new_deck(deck, file)
      call read_groups(text, file, deck_group, deck_key, topic, group, error)
      do i = 1, size(group)
         if (.not. allocated(error)) call take_group(group(i), deck, error)
      end do
      do i = 1, size(settings)
         if (allocated(error)) return
         call apply_setting(trim(settings(i)), deck_place_t(i, .true.), deck, error)
      end do
      if (present(tight) .and. .not. allocated(error)) then
         if (tight .and. has_group(deck, search_group)) call apply_setting( &
            & tightest, deck_place_t(0, .true.), deck, error)
      end if
      if (has_group(deck, search_group)) call find_parameter(deck%value(search_parameter)%text, &
         & deck%searched, problem)
      checked = ""
      if (present(cases)) checked = cases
      if (.not. allocated(error)) call check_deck(deck, checked, error)
      if (.not. allocated(error)) call choose_tables(deck)
   end subroutine parse_deck

   !> Enable unset tables if there are few cases; reactions follow the table of joints
   pure subroutine choose_tables(deck)
      type(deck_t), intent(inout) :: deck
      logical :: few

      few = n_cases(deck) <= few_cases
      associate (joints => deck%value(output_joints), blocks => deck%value(output_blocks), &
         & proof => deck%value(output_proof), reactions => deck%value(output_reactions))
         if (.not. joints%given) joints%flag = few
         if (.not. blocks%given) blocks%flag = few
         if (.not. proof%given) proof%flag = few .and. joints%flag
         if (.not. reactions%given) &
            & reactions%flag = joints%flag .and. deck%value(analysis_mode)%text == "static"
      end associate
   end subroutine choose_tables

   !> Set the values of one group
   pure subroutine take_group(group, deck, error)
      type(key_group_t), intent(in) :: group
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(deck_place_t) :: place
      integer :: g

      place%line = group%row
      g = group_index(group%name)
      if (deck%group(g)%line > 0 .and. g /= sweep_group) call deck_error(error, "group &" &
         & //trim(group%name)//" is repeated: the first is in line "//to_text(deck%group(g)%line) &
         & //"; join the two", deck, place)
      if (allocated(error)) return
      deck%group(g) = place
      deck%value(lbound(group%value, 1):ubound(group%value, 1)) = group%value
      if (g == arch_group) call follow_joints(deck)
      if (g == sweep_group) call add_sweep(deck, place, error)
   end subroutine take_group

   !> Set a key from a --set
   pure subroutine apply_setting(setting, place, deck, error)
      character(len=*), intent(in) :: setting  !! Text such as arch%radius=5.0
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: group, name, problem
      type(parameter_t) :: parameter
      integer :: equals
      logical :: ok

      equals = index(setting, "=")
      call split_name(setting(:max(equals - 1, 0)), group, name, parameter%item, ok)
      if (.not. ok .or. equals == 0 .or. len(group) == 0 .or. has_control(setting)) then
         problem = "expected group%key=value, got '"//shown(setting) &
            & //"'; write it like arch%radius=5.0"
      else if (group == "sweep") then
         problem = "&sweep cannot be set; change the deck"
      else if (group_index(group) == 0) then
         problem = "unknown group &"//shown(group)//": "//near_group(group, deck_group, topic)
      else
         call find_key(deck_key, group, name, topic, parameter%key, problem)
      end if
      if (len(problem) > 0) then
         call deck_error(error, problem, deck, place)
      else
         call set_value(setting(equals + 1:), parameter, place, deck, error)
      end if
   end subroutine apply_setting

   !> True if a text contains control characters
   pure logical function has_control(text)
      character(len=*), intent(in) :: text  !! Any text
      integer :: i

      has_control = any([(ichar(text(i:i)) < 32 .or. ichar(text(i:i)) == 127, i=1, len(text))])
   end function has_control

   !> Set a key from the text after the equals sign of a --set
   pure subroutine set_value(text, parameter, place, deck, error)
      !> The value as in a namelist; words and texts may lack quotes
      character(len=*), intent(in) :: text
      type(parameter_t), intent(in) :: parameter  !! The key, with its item if only one is set
      type(deck_place_t), intent(in) :: place
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_scan_t) :: scan
      type(key_t) :: key
      logical :: has_quotes
      integer :: g

      key = deck_key(parameter%key)
      has_quotes = index(adjustl(text), "'") == 1 .or. index(adjustl(text), """") == 1
      if (any(key%kind == [key_kind%text, key_kind%word]) .and. .not. has_quotes) then
         call put_text(deck, parameter, trim(adjustl(text)), place, error)
      else if (parameter%item > 0 .and. key%kind /= key_kind%numbers) then
         call deck_error(error, full_name(key)//" has no items; remove the parentheses", deck, &
            & place)
      else
         call scan_values(text, scan, error)
         if (allocated(error)) then
            error%file = "--set"
            error%line = place%line
            return
         end if
         associate (value => deck%value(parameter%key))
            call read_value(scan, 1, scan%n, deck_key, parameter%key, parameter%item, place, &
               & value, problem)
            if (len(problem) > 0) call deck_error(error, problem, deck, value%place)
         end associate
         call follow_joints(deck)
      end if
      if (allocated(error)) return
      g = group_index(key%group)
      if (deck%group(g)%line == 0) deck%group(g) = place
   end subroutine set_value

end module dda_read_deck
