!> What a deck says of live loads
module dda_deck_check_live
   use dda_deck, only : deck_error, deck_place_t, deck_t, flag_of, has_group, is_given, list_of, &
      & parameter_t, place_of, word_of
   use dda_deck_keys, only : deck_key, group_index, key_index
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: check_live

contains

   !> Check the live loads of one case
   pure subroutine check_live(deck, searched, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What is searched; key 0 if nothing is
      type(parameter_t), intent(in) :: searched
      !> Lists that do not go together, or what has no effect
      type(error_t), allocatable, intent(out) :: error
      integer :: push
      logical :: pushed

      if (has_group(deck, "live")) call check_lists(deck, searched, error)
      if (.not. allocated(error) .and. has_group(deck, "vehicle")) &
         & call check_vehicle(deck, searched, error)
      if (allocated(error)) return
      push = key_index("load", "horizontal_coefficient")
      pushed = searched%key == push .or. abs(deck%value(push)%number) > 0.0_wp
      if (flag_of(deck, "load", "live_horizontal") .and. .not. pushed) &
         & call deck_error(error, "load%live_horizontal needs a horizontal_coefficient other "// &
         & "than 0, got 0; give one, or remove live_horizontal", deck, &
         & place_of(deck, key_index("load", "live_horizontal")))
   end subroutine check_live

   !> Check the lists of &live
   pure subroutine check_lists(deck, searched, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What is searched; key 0 if nothing is
      type(parameter_t), intent(in) :: searched
      !> Lists of different lengths, or a mode that has no use for them
      type(error_t), allocatable, intent(out) :: error
      character(len=2), parameter :: name(4) = ["x ", "y ", "fx", "fy"]
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: i, n

      place = deck%group(group_index("live"))
      problem = ""
      n = size(list_of(deck, "live", "x"))
      if (n == 0) problem = "&live needs x and y, where its forces act, got none; give both"
      do i = 2, size(name)
         if (len(problem) > 0) exit
         if (i > 2 .and. .not. is_given(deck, "live", name(i))) cycle
         if (size(list_of(deck, "live", name(i))) == n) cycle
         problem = "live%"//trim(name(i))//" needs as many numbers as live%x, "//to_text(n) &
            & //", got "//to_text(size(list_of(deck, "live", name(i))))//"; give one per force"
         place = place_of(deck, key_index("live", trim(name(i))))
      end do
      if (len(problem) > 0) then
         continue
      else if (word_of(deck, "analysis", "mode") == "limerick") then
         problem = "&live needs another mode than 'limerick', whose loads are those of its "// &
            & "files; remove one of the two"
      else if (group_of(searched) == "arch") then
         problem = "&live needs an arch that keeps its shape, but the search changes it, "// &
            & "and its points stay; sweep the shape, with x and y linked"
         place = place_of(deck, key_index("search", "parameter"))
      else if (group_of(searched) /= "live" .and. .not. has_forces(deck)) then
         problem = "&live needs a force other than 0, got none; give fx or fy"
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_lists

   !> Check the vehicle
   pure subroutine check_vehicle(deck, searched, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What is searched; key 0 if nothing is
      type(parameter_t), intent(in) :: searched
      !> Axles without distances or place, or a mode that has no use for them
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      logical :: worst
      integer :: n

      place = deck%group(group_index("vehicle"))
      worst = flag_of(deck, "vehicle", "worst")
      n = size(list_of(deck, "vehicle", "axles"))
      problem = ""
      if (n == 0) then
         problem = "&vehicle needs axles, got none; give their weights"
      else if (size(list_of(deck, "vehicle", "spacings")) /= n - 1) then
         problem = "vehicle%spacings needs one number fewer than there are axles, "// &
            & to_text(n - 1)//", got "//to_text(size(list_of(deck, "vehicle", "spacings"))) &
            & //"; give the distances between axles"
      else if (.not. (is_given(deck, "vehicle", "position") .or. worst &
         & .or. searched%key == key_index("vehicle", "position"))) then
         problem = "&vehicle needs a position, got none; give it, or worst = .true."
      else if (worst .and. is_given(deck, "vehicle", "position")) then
         problem = "vehicle%worst needs no position, got one; remove one of the two"
         place = place_of(deck, key_index("vehicle", "position"))
      else if (word_of(deck, "analysis", "mode") == "limerick") then
         problem = "&vehicle needs another mode than 'limerick', whose loads are those of "// &
            & "its files; remove one of the two"
      else if (worst .and. (searched%key /= key_index("load", "load_factor") &
         & .or. word_of(deck, "analysis", "mode") /= "static" &
         & .or. word_of(deck, "analysis", "geometry") /= "reference")) then
         problem = "vehicle%worst needs a search for load_factor in static reference "// &
            & "geometry, got none; add &search parameter = 'load_factor'"
         place = place_of(deck, key_index("vehicle", "worst"))
      else if (group_of(searched) == "arch") then
         problem = "&vehicle needs an arch that keeps its shape, but the search changes it; "// &
            & "sweep the shape"
         place = place_of(deck, key_index("search", "parameter"))
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_vehicle

   !> Group of what is searched; empty if nothing is
   pure function group_of(searched) result(group)
      !> What is searched; key 0 if nothing is
      type(parameter_t), intent(in) :: searched
      !> Name of the group
      character(len=len(deck_key%group)) :: group

      group = ""
      if (searched%key > 0) group = deck_key(searched%key)%group
   end function group_of

   !> Whether a force of &live is not 0
   pure logical function has_forces(deck)
      !> The deck of the case
      type(deck_t), intent(in) :: deck

      has_forces = any(abs(list_of(deck, "live", "fx")) > 0.0_wp) &
         & .or. any(abs(list_of(deck, "live", "fy")) > 0.0_wp)
   end function has_forces
end module dda_deck_check_live
