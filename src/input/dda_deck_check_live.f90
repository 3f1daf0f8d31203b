!> What a deck says of live loads, and of the strength of its blocks
module dda_deck_check_live
   use dda_deck, only : deck_error, deck_place_t, deck_t, place_of
   use dda_deck_keys, only : deck_key, group_index, key_index
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: check_live, check_strength

contains

   !> Check the live loads of one case
   pure subroutine check_live(deck, error)
      type(deck_t), intent(in) :: deck
      !> Lists that do not go together, or what has no effect
      type(error_t), allocatable, intent(out) :: error
      integer :: push
      logical :: pushed

      if (deck%live%given) call check_lists(deck, error)
      if (.not. allocated(error) .and. deck%vehicle%given) call check_vehicle(deck, error)
      if (allocated(error)) return
      push = key_index("load", "horizontal_coefficient")
      pushed = deck%searched%key == push .or. abs(deck%value(push)%number) > 0.0_wp
      if (deck%load%live_horizontal%flag .and. .not. pushed) &
         & call deck_error(error, "load%live_horizontal needs a horizontal_coefficient other "// &
         & "than 0, got 0; give one, or remove live_horizontal", deck, &
         & place_of(deck, key_index("load", "live_horizontal")))
   end subroutine check_live

   !> Check the lists of &live
   pure subroutine check_lists(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=2), parameter :: name(4) = ["x ", "y ", "fx", "fy"]
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: i, key, n

      place = deck%group(group_index("live"))
      problem = ""
      n = size(deck%live%x%numbers)
      if (n == 0) problem = "&live needs x and y, where its forces act, got none; give both"
      do i = 2, size(name)
         if (len(problem) > 0) exit
         key = key_index("live", name(i))
         if (i > 2 .and. .not. (deck%value(key)%given .or. deck%searched%key == key)) cycle
         if (size(deck%value(key)%numbers) == n) cycle
         problem = "live%"//trim(name(i))//" needs as many numbers as live%x, "//to_text(n) &
            & //", got "//to_text(size(deck%value(key)%numbers))//"; give one per force"
         place = place_of(deck, key)
      end do
      if (len(problem) > 0) then
         continue
      else if (deck%analysis%mode%word == "limerick") then
         problem = "&live needs another mode than 'limerick', whose loads are those of its "// &
            & "files; remove one of the two"
      else if (group_of(deck) == "arch") then
         problem = "&live needs an arch that keeps its shape, but the search changes it, "// &
            & "and its points stay; sweep the shape, with x and y linked"
         place = place_of(deck, key_index("search", "parameter"))
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

      place = deck%group(group_index("vehicle"))
      worst = deck%vehicle%worst%flag
      n = size(deck%vehicle%axles%numbers)
      problem = ""
      if (n == 0) then
         problem = "&vehicle needs axles, got none; give their weights"
      else if (size(deck%vehicle%spacings%numbers) /= n - 1) then
         problem = "vehicle%spacings needs one number fewer than there are axles, "// &
            & to_text(n - 1)//", got "//to_text(size(deck%vehicle%spacings%numbers)) &
            & //"; give the distances between axles"
      else if (.not. (deck%vehicle%position%given .or. worst &
         & .or. deck%searched%key == key_index("vehicle", "position"))) then
         problem = "&vehicle needs a position, got none; give it, or worst = .true."
      else if (worst .and. deck%vehicle%position%given) then
         problem = "vehicle%worst needs no position, got one; remove one of the two"
         place = place_of(deck, key_index("vehicle", "position"))
      else if (deck%analysis%mode%word == "limerick") then
         problem = "&vehicle needs another mode than 'limerick', whose loads are those of "// &
            & "its files; remove one of the two"
      else if (worst .and. (deck%searched%key /= key_index("load", "load_factor") &
         & .or. deck%analysis%mode%word /= "static" &
         & .or. deck%analysis%geometry%word /= "reference")) then
         problem = "vehicle%worst needs a search for load_factor in static reference "// &
            & "geometry, got none; add &search parameter = 'load_factor'"
         place = place_of(deck, key_index("vehicle", "worst"))
      else if (group_of(deck) == "arch") then
         problem = "&vehicle needs an arch that keeps its shape, but the search changes it; "// &
            & "sweep the shape"
         place = place_of(deck, key_index("search", "parameter"))
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_vehicle

   !> Group of what is searched; empty if nothing is
   pure function group_of(deck) result(group)
      type(deck_t), intent(in) :: deck
      !> Name of the group
      character(len=len(deck_key%group)) :: group

      group = ""
      if (deck%searched%key > 0) group = deck_key(deck%searched%key)%group
   end function group_of

   !> Whether a force of &live is not 0
   pure logical function has_forces(deck)
      type(deck_t), intent(in) :: deck

      has_forces = any(abs(deck%live%fx%numbers) > 0.0_wp) &
         & .or. any(abs(deck%live%fy%numbers) > 0.0_wp)
   end function has_forces

   !> Check that limit analysis decides blocks that may be crushed: nothing else knows it
   pure subroutine check_strength(deck, error)
      type(deck_t), intent(in) :: deck
      !> What it cannot be beside
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: needs = "material%compressive_strength needs "
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: own

      own = key_index("material", "compressive_strength")
      if (deck%material%compressive_strength%given) then
         place = place_of(deck, own)
      else if (deck%searched%key == own) then
         place = place_of(deck, key_index("search", "parameter"))
      else if (any(deck%plan%materials%given(5))) then
         place = place_of(deck, key_index("scene", "geometry"))
      else
         return
      end if
      problem = ""
      if (deck%scene%kind%word == "lines") then
         problem = needs//"an arch or a file of blocks, got lines; remove it"
      else if (deck%analysis%mode%word /= "static" &
         & .or. deck%analysis%geometry%word /= "reference") then
         problem = needs//"mode = 'static' and geometry = 'reference', got others: corners of "// &
            & "blocks that move have no strip to crush; make the arch thinner, or remove it"
      else if (deck%analysis%collapse_displacement%given .or. has_bond(deck)) then
         problem = needs//"joints without cohesion and tension, and no collapse_displacement, "// &
            & "got one; remove one of the two"
      else if (deck%searched%key == key_index("load", "gravity_direction_deg")) then
         problem = "search%parameter: expected another key beside compressive_strength, got "// &
            & "gravity_direction_deg; search horizontal_coefficient"
         place = place_of(deck, key_index("search", "parameter"))
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_strength

   !> Whether joints have strength of their own
   pure logical function has_bond(deck)
      type(deck_t), intent(in) :: deck
      integer :: i

      has_bond = deck%joint%cohesion%number > 0.0_wp .or. deck%joint%tension%number > 0.0_wp &
         & .or. deck%joint%residual_deg%given
      do i = 1, size(deck%plan%laws)
         associate (law => deck%plan%laws(i))
            has_bond = has_bond .or. any(law%given(2:3) .and. law%value(2:3) > 0.0_wp) &
               & .or. law%given(4)
         end associate
      end do
   end function has_bond
end module dda_deck_check_live
