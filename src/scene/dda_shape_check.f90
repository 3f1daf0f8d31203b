!> Whether the arches of a deck can be made, and run as it asks
module dda_shape_check
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_deck, only : deck_error, deck_place_t, deck_t, flag_of, has_group, is_given, &
      & parameter_t, place_of, real_of, scene_kind, text_of, word_of
   use dda_deck_key, only : name_length
   use dda_deck_keys, only : deck_key, key_index
   use dda_deck_parameter, only : find_parameter
   use dda_deck_set, only : put_number
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_error, only : error_t
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
      !> The deck, checked otherwise
      type(deck_t), intent(in) :: deck
      !> An arch that cannot be, or be run so
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: work
      integer :: number, n
      logical :: one_kind

      n = n_cases(deck)
      ! which keys are given is the same for all cases
      one_kind = .not. any(deck%sweep%parameter%key == key_index("arch", "shape"))
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
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What cannot be
      type(error_t), allocatable, intent(out) :: error
      character(len=4), parameter :: ends(2) = ["low ", "high"]
      character(len=:), allocatable :: problem
      type(parameter_t) :: searched
      type(deck_t) :: trial
      integer :: i

      call check_models(deck, error)
      if (allocated(error)) return
      if (has_group(deck, "search")) &
         & call find_parameter(text_of(deck, "search", "parameter"), searched, problem)
      if (has_group(deck, "tie")) call check_ties(deck, searched, error)
      if (allocated(error)) return
      if (all(deck_key(max(1, searched%key))%group /= ["arch", "fill"])) then
         call check_form(deck, error)
         return
      end if
      if (searched%key == 0) then
         call check_form(deck, error)
         return
      end if
      do i = 1, 2
         if (.not. is_given(deck, "search", trim(ends(i)))) cycle
         trial = deck
         call put_number(trial, searched, real_of(deck, "search", trim(ends(i))), &
            & place_of(deck, key_index("search", trim(ends(i)))), error)
         if (.not. allocated(error)) call check_form(trial, error)
         if (.not. allocated(error)) cycle
         error%message = "search%"//trim(ends(i))//": "//error%message
         return
      end do
   end subroutine check_one

   !> Check that there is such an arch
   pure subroutine check_form(deck, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What makes none
      type(error_t), allocatable, intent(out) :: error
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(deck_place_t) :: place
      character(len=name_length) :: key

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) == 0) return
      key = problem%key
      if (key == "thickness" .and. .not. is_given(deck, "arch", "thickness")) then
         if (is_given(deck, "arch", "crown_thickness")) key = "crown_thickness"
         if (is_given(deck, "arch", "thickness_ratio")) key = "thickness_ratio"
      end if
      place = place_of(deck, key_index("arch", trim(key)))
      call deck_error(error, "arch%"//trim(key)//": "//trim(problem%text), deck, place)
   end subroutine check_form

   !> Check that what is asked of such an arch can be computed
   pure subroutine check_models(deck, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What cannot be
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: group, key, problem
      logical :: at_rest, leans

      at_rest = word_of(deck, "analysis", "mode") == "static" &
         & .and. word_of(deck, "analysis", "geometry") == "reference" &
         & .and. .not. is_given(deck, "analysis", "collapse_displacement") &
         & .and. .not. real_of(deck, "joint", "cohesion") > 0.0_wp &
         & .and. .not. real_of(deck, "joint", "tension") > 0.0_wp
      leans = real_of(deck, "fill", "passive_coefficient") > 0.0_wp &
         & .or. real_of(deck, "fill", "passive_share") > 0.0_wp &
         & .or. is_given(deck, "fill", "backing_height")
      group = "fill"
      key = "height"
      problem = ""
      if (has_group(deck, "fill") .and. .not. (is_given(deck, "fill", "height") &
         & .and. is_given(deck, "fill", "unit_weight"))) then
         problem = "expected height and unit_weight of the fill, got one or none; give both"
      else if (is_given(deck, "fill", "passive_share") &
         & .and. is_given(deck, "fill", "passive_coefficient")) then
         key = "passive_share"
         problem = "expected passive_share or passive_coefficient, got both; remove one"
      else if (is_given(deck, "fill", "passive_share") &
         & .and. .not. is_given(deck, "fill", "friction_deg")) then
         key = "passive_share"
         problem = "expected friction_deg of the fill beside it, got none; give it"
      else if (is_given(deck, "fill", "backing_unit_weight") &
         & .and. .not. is_given(deck, "fill", "backing_height")) then
         key = "backing_unit_weight"
         problem = "expected backing_height beside it, got none; give it"
      else if (leans .and. .not. at_rest) then
         key = "passive_coefficient"
         if (is_given(deck, "fill", "passive_share")) key = "passive_share"
         if (is_given(deck, "fill", "backing_height")) key = "backing_height"
         problem = "expected a static run in reference geometry, without cohesion, tension and "// &
            & "collapse_displacement, for what an arch leans against is a bounded force of "// &
            & "limit analysis; change the run, or remove it"
      else if (is_given(deck, "arch", "lune_deg")) then
         group = "arch"
         key = "lune_deg"
         if (.not. at_rest) problem = "expected a static run in reference geometry, without "// &
            & "cohesion, tension and collapse_displacement, for a lune has the mass of no "// &
            & "plane block; change the run"
         if (has_group(deck, "fill")) problem = "expected a lune without fill, got some; "// &
            & "remove one of the two"
         if (changes_weight(deck)) problem = "expected weight that acts downwards alone, got "// &
            & "horizontal_coefficient or gravity_direction_deg; remove one of the two"
      end if
      if (len(problem) > 0) call deck_error(error, group//"%"//key//": "//problem, deck, &
         & place_of(deck, key_index(group, key)))
   end subroutine check_models

   !> Whether weight acts otherwise than downwards
   pure logical function changes_weight(deck)
      !> The deck of the case
      type(deck_t), intent(in) :: deck

      changes_weight = is_given(deck, "load", "gravity_direction_deg") &
         & .or. is_given(deck, "load", "horizontal_coefficient") &
         & .or. flag_of(deck, "load", "live_horizontal")
      if (has_group(deck, "search")) changes_weight = changes_weight &
         & .or. index(text_of(deck, "search", "parameter"), "horizontal_coefficient") > 0 &
         & .or. index(text_of(deck, "search", "parameter"), "gravity_direction_deg") > 0
   end function changes_weight
end module dda_shape_check
