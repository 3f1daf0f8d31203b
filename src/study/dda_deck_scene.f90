!> From a deck of any kind to scenes
module dda_deck_scene
   use dda_arch_scene, only : arch_scene
   use dda_deck, only : deck_t, parameter_t, word_of
   use dda_deck_set, only : number_fits, put_number
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_lines, only : check_limerick_lines
   use dda_line_scene, only : check_line_scene, line_scene
   use dda_scene, only : family_t, scene_t
   implicit none
   private

   public :: deck_family_t, deck_scene, check_deck_scene

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      !> The deck of one case
      type(deck_t) :: deck
      !> The parameter
      type(parameter_t) :: parameter
   contains
      !> Make the scene of one value
      procedure :: build => build_deck_scene
   end type deck_family_t

contains

   !> The scene that the deck of one case describes
   pure subroutine deck_scene(deck, scene)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The scene
      type(scene_t), intent(out) :: scene

      if (allocated(deck%cut)) then
         call line_scene(deck, scene)
      else
         call arch_scene(deck, scene)
      end if
   end subroutine deck_scene

   !> Whether this version can run the blocks of a deck
   pure subroutine check_deck_scene(deck, error)
      !> The deck of a case
      type(deck_t), intent(in) :: deck
      !> What it cannot do
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(deck%cut)) return
      if (word_of(deck, "analysis", "mode") == "limerick") then
         call check_limerick_lines(deck, error)
      else
         call check_line_scene(deck, error)
      end if
   end subroutine check_deck_scene

   !> Make the scene of one value of the parameter
   pure subroutine build_deck_scene(family, value, scene, error)
      !> The family
      class(deck_family_t), intent(in) :: family
      !> Value of its parameter
      real(wp), intent(in) :: value
      !> The scene
      type(scene_t), intent(out) :: scene
      !> Allocated if the parameter cannot have the value
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck

      if (.not. number_fits(family%parameter%key, value)) then
         call fatal_error(error, "the searched parameter cannot have this value")
         return
      end if
      deck = family%deck
      call put_number(deck, family%parameter, value, deck%value(family%parameter%key)%place, error)
      if (.not. allocated(error)) call deck_scene(deck, scene)
   end subroutine build_deck_scene
end module dda_deck_scene
