!> Put values into a deck: each one is checked against the registry first
module dda_deck_set
   use dda_deck, only : deck_error, deck_t, parameter_t
   use dda_deck_keys, only : deck_key
   use dda_error, only : error_t
   use dda_key_names, only : arch_half_angle_deg, arch_joints_deg, arch_voussoirs
   use dda_key_value, only : deck_place_t, set_number, set_text
   use dda_kinds, only : wp
   implicit none
   private

   public :: follow_joints, put_number, put_text

contains

   !> Put a number into a key or into one item of its list
   pure subroutine put_number(deck, parameter, number, place, error)
      type(deck_t), intent(inout) :: deck
      !> The key, with the item if it is a list
      type(parameter_t), intent(in) :: parameter
      !> The number in the unit of the registry
      real(wp), intent(in) :: number
      type(deck_place_t), intent(in) :: place
      !> Not a number's key, out of range, or an item that the list lacks
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem

      call set_number(deck%value(parameter%key), deck_key(parameter%key), parameter%item, number, &
         & problem)
      call close_value(deck, parameter%key, problem, place, error)
   end subroutine put_number

   !> Put a text, a word or the text of a flag into a key
   pure subroutine put_text(deck, parameter, text, place, error)
      type(deck_t), intent(inout) :: deck
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: text  !! The value, without quotes
      type(deck_place_t), intent(in) :: place
      !> Not a text's key, or a word that it does not know
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem

      call set_text(deck%value(parameter%key), deck_key(parameter%key), text, problem)
      call close_value(deck, parameter%key, problem, place, error)
   end subroutine put_text

   !> Say where a key was given, or what kept it from its value
   pure subroutine close_value(deck, key, problem, place, error)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: key               !! Place of the key in the registry
      character(len=*), intent(in) :: problem  !! Why it has no value; empty if it has
      type(deck_place_t), intent(in) :: place
      type(error_t), allocatable, intent(out) :: error

      if (len(problem) > 0) then
         call deck_error(error, problem, deck, place)
      else
         deck%value(key)%place = place
         if (key == arch_joints_deg) call follow_joints(deck)
      end if
   end subroutine close_value

   !> Half angle and number of voussoirs follow joints_deg where they are not given
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
end module dda_deck_set
