!> Whether the arches of a deck can be made, and run as it asks
module dda_shape_check
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_deck, only : deck_error, deck_place_t, deck_t, place_of, scene_kind
   use dda_deck_key, only : name_length
   use dda_deck_keys, only : deck_key, key_index
   use dda_deck_set, only : put_number
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_error, only : error_t
   use dda_fill_loads, only : fill_yields
   use dda_kinds, only : wp
   use dda_shape_scene, only : shape_assembly
   use dda_text, only : to_text
   use dda_tie_bars, only : check_ties
   implicit none
   private

   public :: check_form, check_shapes

contains

   !> Check every case of a deck; the ends of a search take the place of what is searched
   pure subroutine check_shapes(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! An arch that cannot be, or be run so
      type(deck_t) :: work
      integer :: number, n
      logical :: one_kind

      n = n_cases(deck)
      ! which keys are given is the same for all cases
      one_kind = .not. any(deck%sweeps%parameter%key == key_index("arch", "shape"))
      do number = 1, n
         call turn_to_case(deck, number, work, error)
         if (scene_kind(work) == "shape") then
            if (.not. allocated(error)) call check_one(work, error)
         else if (one_kind) then
            return
         end if
         if (.not. allocated(error)) cycle
         if (n > 1) error%message = error%message//" (case "//to_text(number)//")"
         return
      end do
   end subroutine check_shapes

   !> Check one case
   pure subroutine check_one(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=4), parameter :: ends(2) = ["low ", "high"]
      type(deck_t) :: trial
      integer :: i, key

      call check_models(deck, error)
      if (allocated(error)) return
      if (deck%tie%given) call check_ties(deck, error)
      if (allocated(error)) return
      if (deck%searched%key == 0 .or. all(deck_key(max(1, deck%searched%key))%group &
         & /= ["arch", "fill"])) then
         call check_form(deck, error)
         return
      end if
      do i = 1, 2
         key = key_index("search", trim(ends(i)))
         if (.not. deck%value(key)%given) cycle
         trial = deck
         call put_number(trial, deck%searched, deck%value(key)%number, place_of(deck, key), error)
         if (.not. allocated(error)) call check_form(trial, error)
         if (.not. allocated(error)) cycle
         error%message = "search%"//trim(ends(i))//": "//error%message
         return
      end do
   end subroutine check_one

   !> Check that there is such an arch
   pure subroutine check_form(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! What makes none
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(deck_place_t) :: place
      character(len=name_length) :: key

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) == 0) return
      key = problem%key
      if (key == "thickness" .and. .not. deck%arch%thickness%given) then
         if (deck%arch%crown_thickness%given) key = "crown_thickness"
         if (deck%arch%thickness_ratio%given) key = "thickness_ratio"
      end if
      place = place_of(deck, key_index("arch", trim(key)))
      call deck_error(error, "arch%"//trim(key)//": "//trim(problem%text), deck, place)
   end subroutine check_form

   !> Check that what is asked of such an arch can be computed
   pure subroutine check_models(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: group, key, problem
      logical :: at_rest

      at_rest = deck%analysis%mode%word == "static" .and. deck%analysis%geometry%word &
         & == "reference" .and. .not. deck%analysis%collapse_displacement%given &
         & .and. .not. deck%joint%cohesion%number > 0.0_wp .and. .not. deck%joint%tension%number &
         & > 0.0_wp
      group = "fill"
      key = "height"
      problem = ""
      if (deck%fill%given .and. .not. (deck%fill%height%given &
         & .and. deck%fill%unit_weight%given)) then
         problem = "expected height and unit_weight of the fill, got one or none; give both"
      else if (deck%fill%passive_share%given .and. deck%fill%passive_coefficient%given) then
         key = "passive_share"
         problem = "expected passive_share or passive_coefficient, got both; remove one"
      else if (deck%fill%passive_share%given .and. .not. deck%fill%friction_deg%given) then
         key = "passive_share"
         problem = "expected friction_deg of the fill beside it, got none; give it"
      else if (deck%fill%backing_unit_weight%given .and. .not. deck%fill%backing_height%given) then
         key = "backing_unit_weight"
         problem = "expected backing_height beside it, got none; give it"
      else if (fill_yields(deck) .and. .not. deck%fill%passive_stiffness%given) then
         key = "passive_coefficient"
         if (deck%fill%passive_share%given) key = "passive_share"
         if (deck%fill%backing_height%given) key = "backing_height"
         problem = "expected passive_stiffness beside it where blocks move or joints have "// &
            & "strength, got none; give it"
      else if (deck%arch%lune_deg%given) then
         group = "arch"
         key = "lune_deg"
         if (.not. at_rest) problem = "expected a static run in reference geometry, without "// &
            & "cohesion, tension and collapse_displacement, for a lune has the mass of no "// &
            & "plane block; change the run"
         if (deck%fill%given) problem = "expected a lune without fill, got some; "// &
            & "remove one of the two"
         if (changes_weight(deck)) problem = "expected weight that acts downwards alone, got "// &
            & "horizontal_coefficient or gravity_direction_deg; remove one of the two"
      end if
      if (len(problem) > 0) call deck_error(error, group//"%"//key//": "//problem, deck, &
         & place_of(deck, key_index(group, key)))
   end subroutine check_models

   !> Whether weight acts otherwise than downwards
   pure logical function changes_weight(deck)
      type(deck_t), intent(in) :: deck

      changes_weight = deck%load%gravity_direction_deg%given &
         & .or. deck%load%horizontal_coefficient%given .or. deck%load%live_horizontal%flag
      if (deck%search%given) changes_weight = changes_weight &
         & .or. index(deck%search%parameter%text, "horizontal_coefficient") > 0 &
         & .or. index(deck%search%parameter%text, "gravity_direction_deg") > 0
   end function changes_weight
end module dda_shape_check
