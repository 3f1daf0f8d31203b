!> Checks of shaped arches and their ties
module dda_shape_check
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_bar, only : bar_t
   use dda_block_input, only : block_plan_t
   use dda_block_sites, only : block_at, site_t, survey
   use dda_deck, only : deck_error, deck_t, has_group, key_error, key_index, place_of, &
      & put_number, source_of
   use dda_deck_key, only : full_name
   use dda_deck_keys, only : deck_key
   use dda_deck_sweep, only : turn_to_case
   use dda_error, only : error_t
   use dda_fill_loads, only : fill_yields
   use dda_key_names, only : analysis_collapse_displacement, analysis_geometry, analysis_mode, &
      & arch_buttress_width, arch_crown_thickness, arch_lune_deg, arch_shape, arch_thickness, &
      & arch_thickness_ratio, &
      & fill_backing_height, fill_backing_unit_weight, fill_friction_deg, fill_group, fill_height, &
      & fill_passive_coefficient, fill_passive_share, fill_passive_stiffness, fill_unit_weight, &
      & joint_cohesion, joint_tension, load_gravity_direction_deg, load_horizontal_coefficient, &
      & load_live_horizontal, search_group, search_high, search_low, search_parameter, &
      & support_left_dx, support_right_rotation_deg, tie_ea, tie_group, tie_prestress, &
      & tie_strength, tie_x1, tie_x2, tie_y1
   use dda_kinds, only : wp
   use dda_shape_scene, only : shape_assembly
   use dda_text, only : place_text, to_text
   implicit none
   private

   public :: check_form, check_shapes
   public :: add_ties, check_ties

contains

   !> Check the chosen cases of a deck, and the ends of its search
   pure subroutine check_shapes(deck, chosen, error)
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: chosen(:)                  !! Cases that will be computed: (n)
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an unsupported arch
      type(deck_t) :: work
      integer :: number
      logical :: one_kind

      ! all cases have the same given keys
      one_kind = .not. any(deck%sweeps%parameter%key == arch_shape)
      do number = 1, size(chosen)
         if (.not. chosen(number)) cycle
         call turn_to_case(deck, number, work, error)
         if (source_of(work) == "shape") then
            if (.not. allocated(error)) call check_one(work, error)
         else if (one_kind) then
            return
         end if
         if (.not. allocated(error)) cycle
         if (size(chosen) > 1) error%message = error%message//" (case "//to_text(number)//")"
         return
      end do
   end subroutine check_shapes

   !> Check one case
   pure subroutine check_one(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: trial
      integer :: from, key

      call check_models(deck, error)
      if (allocated(error)) return
      if (has_group(deck, tie_group)) call check_ties(deck, error)
      if (allocated(error)) return
      if (deck%searched%key == 0 .or. all(deck_key(max(1, deck%searched%key))%group &
         & /= ["arch", "fill"])) then
         call check_form(deck, error)
         return
      end if
      do key = search_low, search_high
         ! without a given end, the value of the deck
         from = merge(key, deck%searched%key, deck%value(key)%given)
         trial = deck
         call put_number(trial, deck%searched, deck%value(from)%number, place_of(deck, key), error)
         if (.not. allocated(error)) call check_form(trial, error)
         if (.not. allocated(error)) cycle
         if (from == key) error%message = full_name(deck_key(key))//": "//error%message
         return
      end do
   end subroutine check_one

   !> Check that the arch exists
   pure subroutine check_form(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error  !! Allocated if it does not exist
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      integer :: key

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) == 0) return
      key = key_index("arch", trim(problem%key))
      if (key == arch_thickness .and. .not. deck%value(arch_thickness)%given) then
         if (deck%value(arch_crown_thickness)%given) key = arch_crown_thickness
         if (deck%value(arch_thickness_ratio)%given) key = arch_thickness_ratio
      end if
      call key_error(error, full_name(deck_key(key))//": "//trim(problem%text), deck, key)
   end subroutine check_form

   !> Check that the models of the deck support shaped arches
   pure subroutine check_models(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      integer :: key
      logical :: at_rest

      at_rest = deck%value(analysis_mode)%text == "static" &
         & .and. deck%value(analysis_geometry)%text == "reference" &
         & .and. .not. deck%value(analysis_collapse_displacement)%given &
         & .and. .not. deck%value(joint_cohesion)%number > 0.0_wp &
         & .and. .not. deck%value(joint_tension)%number > 0.0_wp
      key = fill_height
      problem = ""
      if (has_group(deck, fill_group) .and. .not. (deck%value(fill_height)%given &
         & .and. deck%value(fill_unit_weight)%given)) then
         problem = "expected height and unit_weight of the fill, got one or none; give both"
      else if (deck%value(fill_passive_share)%given &
         & .and. deck%value(fill_passive_coefficient)%given) then
         key = fill_passive_share
         problem = "expected passive_share or passive_coefficient, got both; remove one"
      else if (deck%value(fill_passive_share)%given &
         & .and. .not. deck%value(fill_friction_deg)%given) then
         key = fill_passive_share
         problem = "expected friction_deg of the fill, got none; give it"
      else if (deck%value(fill_backing_unit_weight)%given &
         & .and. .not. deck%value(fill_backing_height)%given) then
         key = fill_backing_unit_weight
         problem = "expected backing_height with it, got none; give it"
      else if (fill_yields(deck) .and. .not. deck%value(fill_passive_stiffness)%given) then
         key = fill_passive_coefficient
         if (deck%value(fill_passive_share)%given) key = fill_passive_share
         if (deck%value(fill_backing_height)%given) key = fill_backing_height
         problem = "expected passive_stiffness in current geometry, or with strength of "// &
            & "joints, got none; give it in N/m3, or remove this key"
      else if (deck%value(arch_buttress_width)%given &
         & .and. any(deck%value(support_left_dx:support_right_rotation_deg)%given)) then
         key = arch_buttress_width
         problem = "expected springings that &support can displace, got buttresses; remove one "// &
            & "of the two"
      else if (deck%value(arch_lune_deg)%given) then
         key = arch_lune_deg
         if (.not. at_rest) problem = "expected a static run in reference geometry, without "// &
            & "cohesion, tension and collapse_displacement, for a lune has the mass of no "// &
            & "plane block; change the run"
         if (has_group(deck, fill_group)) problem = "expected a lune without fill, got fill; "// &
            & "remove one of the two"
         if (changes_weight(deck)) problem = "expected weight that acts downwards alone, got "// &
            & "horizontal_coefficient or gravity_direction_deg; remove one of the two"
      end if
      if (len(problem) > 0) &
         & call key_error(error, full_name(deck_key(key))//": "//problem, deck, key)
   end subroutine check_models

   !> True if gravity is not vertical
   pure logical function changes_weight(deck)
      type(deck_t), intent(in) :: deck

      changes_weight = deck%value(load_gravity_direction_deg)%given &
         & .or. deck%value(load_horizontal_coefficient)%given &
         & .or. deck%value(load_live_horizontal)%flag
      if (has_group(deck, search_group)) changes_weight = changes_weight &
         & .or. index(deck%value(search_parameter)%text, "horizontal_coefficient") > 0 &
         & .or. index(deck%value(search_parameter)%text, "gravity_direction_deg") > 0
   end function changes_weight

   !> Add the bars of &tie to the blocks at their ends
   pure subroutine add_ties(deck, plan)
      type(deck_t), intent(in) :: deck           !! The deck of the case with &tie, checked
      type(block_plan_t), intent(inout) :: plan  !! The blocks; receives the bars
      type(bar_t), allocatable :: bar(:)
      type(site_t) :: site
      real(wp), allocatable :: ends(:, :)
      integer :: i, side

      call tie_ends(deck, ends)
      allocate (bar(size(ends, 2)))
      call survey(plan, site)
      do i = 1, size(bar)
         bar(i)%point = reshape(ends(:, i), [2, 2]) - spread(plan%origin, 2, 2)
         do side = 1, 2
            bar(i)%block(side) = block_at(plan, site, bar(i)%point(:, side))
         end do
         bar(i)%pushes = .false.
         bar(i)%stiffness = deck%value(tie_ea)%numbers(i)/norm2(ends(3:4, i) - ends(1:2, i))
         if (deck%value(tie_strength)%given) bar(i)%strength = deck%value(tie_strength)%numbers(i)
         if (deck%value(tie_prestress)%given) bar(i)%prestress = &
            & deck%value(tie_prestress)%numbers(i)
      end do
      call move_alloc(bar, plan%boundary%bar)
   end subroutine add_ties

   !> End points of all ties
   pure subroutine tie_ends(deck, ends)
      type(deck_t), intent(in) :: deck
      !> Coordinates x, y of the first end, then of the second: (4, n) [m]
      real(wp), allocatable, intent(out) :: ends(:, :)

      integer :: i

      allocate (ends(4, size(deck%value(tie_x1)%numbers)))
      do i = 1, 4
         ends(i, :) = deck%value(tie_x1 + i - 1)%numbers
      end do
   end subroutine tie_ends

   !> Check the ties of a case
   pure subroutine check_ties(deck, error)
      type(deck_t), intent(in) :: deck
      !> Allocated for lists of different lengths or an end outside all blocks
      type(error_t), allocatable, intent(out) :: error
      integer :: key, n

      n = size(deck%value(tie_x1)%numbers)
      if (n == 0) call deck_error(error, &
         & "&tie needs x1, y1, x2 and y2, the ends of each tie, got none; give them", deck, &
         & deck%group(tie_group))
      if (allocated(error)) return
      do key = tie_y1, tie_prestress
         if (key > tie_ea .and. .not. deck%value(key)%given) cycle
         if (size(deck%value(key)%numbers) == n) cycle
         call key_error(error, full_name(deck_key(key))//" needs as many numbers as tie%x1, " &
            & //to_text(n)//", got "//to_text(size(deck%value(key)%numbers)) &
            & //"; give one per tie", deck, key)
         return
      end do
      if (deck_key(max(1, deck%searched%key))%group == "arch" .and. deck%searched%key > 0) &
         & call key_error(error, "&tie needs an arch that keeps its shape, but the search " &
         & //"changes it, and its ends stay; sweep the shape, with the ends linked", deck, &
         & search_parameter)
      if (allocated(error)) return
      call check_ends(deck, error)
   end subroutine check_ties

   !> Check that ties lie between blocks
   pure subroutine check_ends(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: no_form
      real(wp), allocatable :: ends(:, :)
      integer :: i, side

      call tie_ends(deck, ends)
      call shape_assembly(deck, assembly, no_form)
      if (len_trim(no_form%text) > 0) return
      do i = 1, size(ends, 2)
         if (norm2(ends(3:4, i) - ends(1:2, i)) > 0.0_wp) cycle
         call key_error(error, "&tie needs ends that are apart, got tie "//to_text(i)// &
            & " between equal points; move one", deck, tie_x1)
         return
      end do
      call add_ties(deck, assembly%plan)
      problem = ""
      do i = 1, size(ends, 2)
         associate (bar => assembly%plan%boundary%bar(i))
            side = findloc(bar%block, 0, dim=1)
            if (side > 0) then
               problem = "&tie needs ends in blocks, got " &
                  & //place_text(ends(2*side - 1:2*side, i))//" of tie "//to_text(i) &
                  & //", which lies in none; move it"
            else if (bar%block(1) == bar%block(2)) then
               side = 1
               problem = "&tie needs ends in two blocks, got both of tie "//to_text(i) &
                  & //" in block "//to_text(bar%block(1))//"; move one"
            else if (all(assembly%plan%fixed(bar%block))) then
               side = 1
               problem = "&tie needs a block that moves, got tie "//to_text(i) &
                  & //" between two that are fixed; move one end, or remove the tie"
            else if (bar%prestress > bar%strength) then
               call key_error(error, "tie%prestress must be at most tie%strength, got " &
                  & //to_text(bar%prestress)//" for tie "//to_text(i)//"; lower it", deck, &
                  & tie_prestress)
               return
            end if
         end associate
         if (len(problem) == 0) cycle
         call key_error(error, problem, deck, merge(tie_x1, tie_x2, side == 1))
         return
      end do
   end subroutine check_ends
end module dda_shape_check
