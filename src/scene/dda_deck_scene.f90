!> From a deck of any kind to its scene
module dda_deck_scene
   use dda_arch_chain, only : arch_numbers_t, arch_rays_t
   use dda_arch_scene, only : arch_scene
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : history_t
   use dda_chain, only : chain_t
   use dda_deck, only : deck_t, parameter_t, scene_kind
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_line_scene, only : line_scene
   use dda_live_loads, only : add_live_loads
   use dda_scene, only : family_t, scene_t
   use dda_scene_plan, only : scene_plan_t
   use dda_settings, only : settings_t
   implicit none
   private

   public :: deck_family_t, deck_scene, movable_blocks, move_ground, new_family

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      !> The deck of one case
      type(deck_t), allocatable :: deck
      !> The parameter
      type(parameter_t) :: parameter
      !> Whether its scenes are chains but for strain, and differ by their thickness ratio alone
      logical :: chains = .false.
      !> Then: what all of them need
      type(scene_plan_t) :: plan
      !> Then: what the arches are made from
      type(arch_numbers_t) :: numbers
      !> Settings of their runs
      type(settings_t) :: settings
      !> Angle of each joint from the crown: (n_joint) [deg]
      real(wp), allocatable :: joint_angle_deg(:)
      !> What does not depend on the thickness; made by the one who searches
      type(arch_rays_t) :: rays
   contains
      !> Make the chain of one value
      procedure :: link => link_arch
      !> Make the scene of one value
      procedure :: build => build_deck_scene
   end type deck_family_t

   interface

      !> Give the ground of a scene the motion that &ground asks for
      pure module subroutine move_ground(deck, acceleration)
         type(deck_t), intent(in) :: deck
         !> Acceleration of the ground: that of the file of blocks in, that of the case out
         type(history_t), intent(inout) :: acceleration
      end subroutine move_ground

      !> Make a deck a family, its numbers read
      pure module subroutine new_family(plan, parameter, family)
         type(scene_plan_t), intent(in) :: plan
         type(parameter_t), intent(in) :: parameter
         !> New but for the deck
         type(deck_family_t), intent(inout) :: family
      end subroutine new_family

      !> Make the chain of one thickness ratio
      pure module subroutine link_arch(family, value, settings, chain, linked)
         class(deck_family_t), intent(in) :: family
         !> The thickness ratio
         real(wp), intent(in) :: value
         type(settings_t), intent(out) :: settings
         !> Any chain in, whose arrays are used again where they fit
         type(chain_t), intent(inout) :: chain
         !> Whether the scenes are chains, and one has this value
         logical, intent(out) :: linked
      end subroutine link_arch

      !> Make the scene of one value of the parameter
      pure module subroutine build_deck_scene(family, value, scene, error)
         class(deck_family_t), intent(in) :: family
         !> Value of its parameter
         real(wp), intent(in) :: value
         type(scene_t), intent(out) :: scene
         type(error_t), allocatable, intent(out) :: error
      end subroutine build_deck_scene

      !> The scene of an arch of any shape
      pure module subroutine shape_scene(deck, plan, scene)
         type(deck_t), intent(in) :: deck
         type(scene_plan_t), intent(in) :: plan
         !> The scene; of an arch that cannot be, without blocks
         type(scene_t), intent(out) :: scene
      end subroutine shape_scene

      !> The scene of blocks as a file or an arch gives them
      pure module subroutine file_scene(deck, plan, blocks, scene)
         type(deck_t), intent(in) :: deck
         type(scene_plan_t), intent(in) :: plan
         type(block_plan_t), intent(in) :: blocks
         type(scene_t), intent(out) :: scene
      end subroutine file_scene

      !> Number of blocks that can move in the scene of a case
      pure integer module function movable_blocks(deck)
         type(deck_t), intent(in) :: deck
      end function movable_blocks

   end interface

contains

   !> The scene that the deck of one case describes
   pure subroutine deck_scene(deck, plan, scene)
      type(deck_t), intent(in) :: deck
      type(scene_plan_t), intent(in) :: plan
      type(scene_t), intent(out) :: scene

      select case (scene_kind(deck))
      case ("arch")
         call arch_scene(deck, plan, scene)
      case ("lines")
         call line_scene(deck, plan, scene)
      case ("blocks")
         call file_scene(deck, plan, deck%plan, scene)
      case ("shape")
         call shape_scene(deck, plan, scene)
      end select
      call move_ground(deck, scene%settings%boundary%base_acceleration)
      if (scene_kind(deck) /= "shape") call add_live_loads(deck, scene)
   end subroutine deck_scene
end module dda_deck_scene
