!> What a deck says of joints that crush
module dda_deck_check_strength
   use dda_deck, only : deck_error, deck_place_t, deck_t, place_of
   use dda_deck_keys, only : key_index
   use dda_error, only : error_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: check_strength

contains

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
         problem = needs//"mode = 'static' and geometry = 'reference', got others: joints of "// &
            & "blocks that move are not crushed; change the run, or remove it"
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
end module dda_deck_check_strength
