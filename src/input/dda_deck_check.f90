!> Reading of the files of a deck, and checks of its searches, sweeps and cases
submodule (dda_read_deck) dda_deck_check
   use dda_deck, only : ground_record_t, key_error, parameter_name, place_of
   use dda_deck_check_case, only : check_case
   use dda_deck_sweep, only : choose_cases, turn_to_case
   use dda_key_names, only : fill_group, fill_passive_share, fill_unit_weight, ground_columns, &
      & ground_record, load_gravity, material_density, material_unit_weight, output_max_cases, &
      & scene_analysis, support_group, tie_group, vehicle_axles, vehicle_list
   use dda_kinds, only : wp
   use dda_read_limerick, only : check_materials, read_analysis, read_geometry
   use dda_read_record, only : column_size, field_of, n_columns, read_record, &
      & separator_of
   implicit none

contains

   !> Read all ground motion records of a deck
   module procedure read_ground_records
      integer :: i, s

      if (deck%value(ground_record)%given) call add_record(deck%value(ground_record)%text, &
         & deck%value(ground_record)%place, deck, error)
      do s = 1, size(deck%sweeps)
         if (deck%sweeps(s)%parameter%key /= ground_record) cycle
         do i = 1, size(deck%sweeps(s)%texts)
            if (allocated(error)) return
            call add_record(trim(deck%sweeps(s)%texts(i)), deck%sweeps(s)%place, deck, error)
         end do
      end do
   end procedure read_ground_records

   !> Read one record, unless it is present
   subroutine add_record(name, place, deck, error)
      character(len=*), intent(in) :: name     !! Name of the record in the deck
      type(deck_place_t), intent(in) :: place  !! Place of the name
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: mark, message
      character(len=column_size) :: column(3)
      real(wp), allocatable :: row(:, :)
      type(ground_record_t), allocatable :: longer(:)
      integer :: i, n

      n = 0
      if (allocated(deck%ground_record)) n = size(deck%ground_record)
      do i = 1, n
         if (deck%ground_record(i)%name == name) return
      end do
      call split_columns(deck, column, error)
      if (allocated(error)) return
      call read_record(file_beside(deck, name), column, 1.0_wp, row, mark, error)
      if (allocated(error)) then
         if (error%line > 0) return
         message = "ground%record = '"//shown(name)//"': "//error%message
         call deck_error(error, message, deck, place)
         return
      end if
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = deck%ground_record
      longer(n + 1)%name = name
      longer(n + 1)%motion%time = row(1, :)
      longer(n + 1)%motion%value = row(2:3, :)
      call move_alloc(longer, deck%ground_record)
      call add_file_mark(mark, deck)
   end subroutine add_record

   !> Split ground%columns into the columns of time, x and y: at semicolons, else at commas, else at
   !> blanks
   pure subroutine split_columns(deck, column, error)
      type(deck_t), intent(in) :: deck
      character(len=column_size), intent(out) :: column(3)  !! The columns; 0 for none: (3)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      character :: separator
      integer :: i, n

      column = "0"
      text = trim(deck%value(ground_columns)%text)
      separator = separator_of(text)
      n = n_columns(text, separator)
      do i = 1, min(n, 3)
         column(i) = field_of(text, i, separator)
      end do
      if (n == 2 .or. n == 3) return
      call deck_error(error, "ground%columns needs two or three columns, of time, x and y, "// &
         & "got '"//shown(trim(deck%value(ground_columns)%text))//"'; write them as in '1 2', " &
         & //"or with commas where a name has blanks", deck, &
         & deck%value(ground_columns)%place)
   end subroutine split_columns

   !> Read the files of a deck with kind = 'lines'; other decks are unchanged
   module procedure read_lines
      character(len=:), allocatable :: file

      if (deck%value(scene_kind)%text /= "lines") return
      file = file_beside(deck, deck%value(scene_geometry)%text)
      allocate (deck%lines)
      call read_geometry(file, deck%lines, deck%warnings, error)
      call name_key(deck, scene_geometry, error)
      if (allocated(error)) return
      call add_file_mark(file_mark(file), deck)
      if (.not. deck%value(scene_analysis)%given) return
      file = file_beside(deck, deck%value(scene_analysis)%text)
      allocate (deck%file_analysis)
      call read_analysis(file, deck%file_analysis, deck%warnings, error)
      call name_key(deck, scene_analysis, error)
      if (allocated(error)) return
      call add_file_mark(file_mark(file), deck)
      call check_materials(deck%lines, deck%file_analysis, deck%warnings, error)
   end procedure read_lines

   !> Add the place of a key to an error about a file that cannot be read
   module procedure name_key
      character(len=:), allocatable :: message

      if (.not. allocated(error)) return
      if (error%line > 0) return
      message = full_name(deck_key(key))//" = '"//deck%value(key)%text//"': "//error%message
      call deck_error(error, message, deck, deck%value(key)%place)
   end procedure name_key

   !> Check a deck and all cases of its sweeps before any computation
   module procedure check_deck
      integer :: s

      call check_kind(deck, error)
      if (.not. allocated(error)) call check_search(deck, error)
      do s = 1, size(deck%sweeps)
         if (.not. allocated(error)) call check_sweep(deck, s, error)
      end do
      if (.not. allocated(error)) call check_cases(deck, cases, error)
   end procedure check_deck

   !> Check that the source of the blocks is given exactly once
   pure subroutine check_kind(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: kind

      kind = deck%value(scene_kind)%text
      if (kind /= "arch" .and. .not. deck%value(scene_geometry)%given) then
         call key_error(error, "scene%kind = '"//kind//"' needs scene%geometry, a file of "// &
            kind//"; name one", deck, scene_kind)
      else if (kind /= "arch" .and. has_group(deck, arch_group)) then
         call deck_error(error, "&arch has no effect: scene%kind is '"//kind// &
            "'; remove one of the two", deck, deck%group(arch_group))
      else if (kind /= "arch" .and. has_group(deck, support_group)) then
         call deck_error(error, "&support needs an arch, got scene%kind = '"//kind// &
            "'; remove it, and add displacement lines to a file of blocks", deck, &
            deck%group(support_group))
      else if (kind /= "arch" .and. has_group(deck, fill_group)) then
         call deck_error(error, "&fill needs an arch, got scene%kind = '"//kind// &
            "'; remove one of the two", deck, deck%group(fill_group))
      else if (kind /= "arch" .and. has_group(deck, tie_group)) then
         call deck_error(error, "&tie needs an arch, got scene%kind = '"//kind// &
            "'; remove it, and add bar lines to a file of blocks", deck, &
            deck%group(tie_group))
      end if
   end subroutine check_kind

   !> Check the search
   pure subroutine check_search(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      type(parameter_t) :: unused
      type(key_t) :: key

      if (.not. has_group(deck, search_group)) return
      place = place_of(deck, search_parameter)
      call find_parameter(deck%value(search_parameter)%text, unused, problem)
      if (len(problem) == 0) then
         key = deck_key(deck%searched%key)
         if (key%group == "search" .or. &
            .not. any(key%kind == [key_kind%number, key_kind%numbers])) then
            problem = "expected a key with real values, got "//full_name(key)// &
               "; sweep it instead, or search one like thickness_ratio"
         end if
      end if
      if (len(problem) > 0) then
         call deck_error(error, "search%parameter: "//problem, deck, place)
      else
         call check_varied(deck, deck%searched, "searched", place, error)
      end if
   end subroutine check_search

   !> Check one sweep against the previous ones and the search
   pure subroutine check_sweep(deck, s, error)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: s  !! Number of the sweep
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, problem
      integer :: other

      associate (sweep => deck%sweeps(s))
         name = parameter_name(sweep%parameter)
         problem = ""
         if (sweep%parameter%key == deck%searched%key &
            .and. sweep%parameter%item == deck%searched%item) problem = name// &
            " is both swept and searched; remove one of the two"
         if (deck_key(sweep%parameter%key)%group == "search" .and. deck%searched%key == 0) &
            problem = name//" is swept, but the deck has no &search; add one"
         do other = 1, s - 1
            if (sweep%name == deck%sweeps(other)%name) problem = name// &
               " is swept twice: first in line "//to_text(deck%sweeps(other)%place%line)// &
               "; put all values into one &sweep"
         end do
         if (sweep%linked) call check_link(deck, s, problem)
         if (len(problem) > 0) then
            call deck_error(error, problem, deck, sweep%place)
         else
            call check_varied(deck, sweep%parameter, "swept", sweep%place, error)
         end if
      end associate
   end subroutine check_sweep

   !> Check that a linked sweep has the length of the previous one
   pure subroutine check_link(deck, s, problem)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: s
      !> The problem; unchanged if there is none
      character(len=:), allocatable, intent(inout) :: problem
      integer :: here, before

      if (s == 1) then
         problem = "the first &sweep cannot be linked: there is none before it; remove linked"
         return
      end if
      here = size(deck%sweeps(s)%numbers) + size(deck%sweeps(s)%texts)
      before = size(deck%sweeps(s - 1)%numbers) + size(deck%sweeps(s - 1)%texts)
      if (here /= before) problem = "a linked &sweep needs as many values as the one before, "// &
         to_text(before)//", got "//to_text(here)//"; make them equal"
   end subroutine check_link

   !> Check that varying a parameter has an effect and does not override a --set
   pure subroutine check_varied(deck, parameter, how, place, error)
      type(deck_t), intent(in) :: deck
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: how  !! swept or searched
      type(deck_place_t), intent(in) :: place
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, why

      name = full_name(deck_key(parameter%key))
      why = reason_of_no_effect(deck, parameter%key)
      if (len(why) > 0) then
         call deck_error(error, name//" is "//how//", but it has no effect: "//why, deck, place)
      else if (deck%value(parameter%key)%place%from_command .and. parameter%item == 0) then
         call deck_error(error, name//" cannot be set: it is "//how//" in line " &
            & //to_text(place%line)//" of "//deck%file//"; remove the --set", deck, &
            & deck%value(parameter%key)%place)
      end if
   end subroutine check_varied

   !> Reason why varying a key has no effect, and the remedy; empty if it has one
   pure function reason_of_no_effect(deck, varied) result(why)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: varied  !! Place of the key in the registry
      character(len=:), allocatable :: why
      type(key_t) :: key

      why = ""
      key = deck_key(varied)
      if (key%group == "arch" .and. deck%value(scene_kind)%text /= "arch") then
         why = "scene%kind is '"//deck%value(scene_kind)%text//"'; name another key"
      else if (any(varied == [material_density, load_gravity]) &
         .and. deck%value(material_unit_weight)%given &
         .and. deck%value(analysis_mode)%text == "static") then
         why = "material%unit_weight is given; remove that"
      else if ((key%group == "limerick" .or. key%name(:9) == "abutment_") &
         & .and. deck%value(analysis_mode)%text /= "limerick" &
         & .and. .not. any(deck%sweeps%parameter%key == analysis_mode)) then
         why = "analysis%mode is '"//deck%value(analysis_mode)%text//"'; name another key"
      else if (key%group == "vehicle" .and. .not. (is_known(deck, vehicle_axles) &
         & .or. deck%value(vehicle_list)%given)) then
         why = "vehicle%axles are not given; give them"
      else if (key%group == "fill" .and. key%name /= "unit_weight" &
         .and. .not. is_known(deck, fill_unit_weight)) then
         why = "fill%unit_weight is not given; give it"
      else if (key%group == "fill" .and. key%name == "friction_deg" &
         .and. .not. is_known(deck, fill_passive_share)) then
         why = "fill%passive_share is not given; give it"
      else if (key%name == "water_rise" .and. deck%value(scene_kind)%text /= "blocks") then
         why = "for files of blocks only; name another key"
      end if
   end function reason_of_no_effect

   !> True if a key is given or varied
   pure logical function is_known(deck, key)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: key  !! Place of the key in the registry

      is_known = deck%value(key)%given .or. deck%searched%key == key &
         & .or. any(deck%sweeps%parameter%key == key)
   end function is_known

   !> Check every case of the sweeps
   pure subroutine check_cases(deck, cases, error)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: cases
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: work
      logical, allocatable :: chosen(:)
      integer :: number, n

      n = n_cases(deck)
      if (n > nint(deck%value(output_max_cases)%number)) call deck_error(error, &
         & "expected at most "//to_text(nint(deck%value(output_max_cases)%number))//" cases, got " &
         & //to_text(n)//" or more; raise output%max_cases for more", deck, &
         & deck%sweeps(size(deck%sweeps))%place)
      if (allocated(error)) return
      call choose_cases(cases, n, chosen, error)
      if (allocated(error)) return
      do number = 1, n
         if (.not. chosen(number)) cycle
         call turn_to_case(deck, number, work, error)
         if (.not. allocated(error)) call check_case(work, error)
         if (.not. allocated(error)) cycle
         if (n > 1) error%message = error%message//" (case "//to_text(number)//")"
         return
      end do
   end subroutine check_cases

end submodule dda_deck_check
