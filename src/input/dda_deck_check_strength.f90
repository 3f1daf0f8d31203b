!> What a deck says of joints that crush
module dda_deck_check_strength
   use dda_deck, only : deck_error, deck_place_t, deck_t, is_given, parameter_t, place_of, &
      & real_of, word_of
   use dda_deck_keys, only : key_index
   use dda_error, only : error_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: check_strength

contains

   !> Check that limit analysis decides blocks that may be crushed: nothing else knows it
   pure subroutine check_strength(deck, searched, error)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      !> What is searched; key 0 if nothing is
      type(parameter_t), intent(in) :: searched
      !> What it cannot be beside
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: needs = "material%compressive_strength needs "
      character(len=:), allocatable :: problem
      type(deck_place_t) :: place
      integer :: own

      own = key_index("material", "compressive_strength")
      if (is_given(deck, "material", "compressive_strength")) then
         place = place_of(deck, own)
      else if (searched%key == own) then
         place = place_of(deck, key_index("search", "parameter"))
      else if (any(deck%plan%materials%given(5))) then
         place = place_of(deck, key_index("scene", "geometry"))
      else
         return
      end if
      problem = ""
      if (word_of(deck, "scene", "kind") == "lines") then
         problem = needs//"an arch or a file of blocks, got lines; remove it"
      else if (word_of(deck, "analysis", "mode") /= "static" &
         & .or. word_of(deck, "analysis", "geometry") /= "reference") then
         problem = needs//"mode = 'static' and geometry = 'reference', got others: joints of "// &
            & "blocks that move are not crushed; change the run, or remove it"
      else if (is_given(deck, "analysis", "collapse_displacement") .or. has_bond(deck)) then
         problem = needs//"joints without cohesion and tension, and no collapse_displacement, "// &
            & "got one; remove one of the two"
      else if (searched%key == key_index("load", "gravity_direction_deg")) then
         problem = "search%parameter: expected another key beside compressive_strength, got "// &
            & "gravity_direction_deg; search horizontal_coefficient"
         place = place_of(deck, key_index("search", "parameter"))
      end if
      if (len(problem) > 0) call deck_error(error, problem, deck, place)
   end subroutine check_strength

   !> Whether joints have strength of their own
   pure logical function has_bond(deck)
      !> The deck of the case
      type(deck_t), intent(in) :: deck
      integer :: i

      has_bond = real_of(deck, "joint", "cohesion") > 0.0_wp &
         & .or. real_of(deck, "joint", "tension") > 0.0_wp &
         & .or. is_given(deck, "joint", "residual_deg")
      do i = 1, size(deck%plan%laws)
         associate (law => deck%plan%laws(i))
            has_bond = has_bond .or. any(law%given(2:3) .and. law%value(2:3) > 0.0_wp) &
               & .or. law%given(4)
         end associate
      end do
   end function has_bond
end module dda_deck_check_strength
