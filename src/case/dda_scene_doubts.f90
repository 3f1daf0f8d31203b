!> Stages, widths, supports and units of a deck that its scene contradicts or makes doubtful
submodule (dda_scene_check) dda_scene_doubts
   use dda_block_scene, only : floating_block
   use dda_deck, only : has_group
   use dda_key_names, only : analysis_flow, analysis_geometry, material_compressive_strength, &
      & output_energy, output_reactions, search_group
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none

   !> A block whose weight strains it more than this is doubtful
   real(wp), parameter :: doubtful_strain = 1.0e-3_wp

contains

   !> Check that a static scene can come to rest at all
   module procedure check_support
      integer :: b

      b = floating_block(scene)
      if (b > 0) call fatal_error(error, "block "//to_text(b)//" has no support: no chain of "// &
         & "joints ties it to a fixed block, as mode = 'static' needs; add a joint or remove it", &
         & geometry_file(deck), deck%plan%line(b))
   end procedure check_support

   !> Check that a deck can be run in stages
   module procedure check_stages
      character(len=:), allocatable :: problem

      problem = ""
      if (has_group(deck, search_group)) then
         problem = "a search needs blocks that stay"
      else if (deck%value(analysis_mode)%text == "limerick") then
         problem = "mode = 'limerick' knows no blocks that come or go"
      else if (deck%value(output_energy)%flag) then
         problem = "output%energy needs blocks that stay"
      else if (deck%value(output_reactions)%given .and. deck%value(output_reactions)%flag &
         & .and. deck%value(analysis_mode)%text == "dynamic") then
         problem = "output%reactions of a dynamic run needs blocks that stay"
      else if ((deck%value(material_compressive_strength)%given &
         & .or. any(deck%plan%materials%given(5))) &
         & .and. deck%value(analysis_flow)%text /= "associated") then
         problem = "blocks with a compressive_strength need flow = 'associated' where some "// &
            & "come or go"
      else if ((deck%value(analysis_mode)%text == "dynamic") &
         & .neqv. deck%value(analysis_geometry)%text == "current") then
         problem = "stages need mode = 'static' with geometry = 'reference', or mode = 'dynamic' " &
            & //"with geometry = 'current'"
      end if
      if (len(problem) > 0) call fatal_error(error, problem//"; change it or remove this line", &
         & geometry_file(deck), deck%plan%boundary%change(1)%line)
   end procedure check_stages

   !> Check that what may be crushed does not stand on corners, which bear nothing then
   module procedure check_widths
      integer :: j

      do j = 1, size(scene%contacts%joint)
         associate (joint => scene%contacts%joint(j))
            if (.not. (scene%contacts%law(joint%law)%strength < huge(1.0_wp) &
               & .and. joint%n_contact == 1)) cycle
            call fatal_error(error, "compressive_strength needs joints with a width, got a "// &
               & "corner of blocks "//to_text(joint%block(1))//" and "//to_text(joint%block(2)) &
               & //" on an edge, which any force crushes; cut the corner off, or remove "// &
               & "compressive_strength", geometry_file(deck), deck%plan%line(joint%block(1)))
            return
         end associate
      end do
   end procedure check_widths

   !> Warn of blocks that will fall, and of units that are no metres
   module procedure doubt_scene
      integer :: b

      call doubt_units(deck, scene, warnings)
      b = floating_block(scene)
      if (b > 0 .and. any(deck%plan%fixed)) call add_warning(warnings, "block " &
         & //to_text(b)//" has no support and falls freely", geometry_file(deck), &
         & deck%plan%line(b))
      if (any(deck%plan%fixed)) return
      b = 0
      if (allocated(deck%plan%boundary%held)) b = size(deck%plan%boundary%held)
      if (b == 0) call add_warning(warnings, "nothing is fixed", geometry_file(deck), 1)
   end procedure doubt_scene

   !> Warn where the weight of the blocks would strain them as no masonry is strained: lengths are
   !> then often millimetres
   pure subroutine doubt_units(deck, scene, warnings)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(warnings_t), intent(inout) :: warnings
      character(len=10) :: figure
      real(wp) :: height, strain
      integer :: b

      strain = 0.0_wp
      associate (system => scene%system)
         do b = 1, size(system%area)
            if (system%equation(b) == 0) cycle
            associate (vertex => system%vertex(:, &
               & system%first_vertex(b):system%first_vertex(b + 1) - 1))
               height = maxval(maxval(vertex, dim=2) - minval(vertex, dim=2))
            end associate
            strain = max(strain, system%unit_weight(b)*height &
               & /system%materials(system%material(b))%young)
         end do
      end associate
      if (.not. strain > doubtful_strain) return
      write (figure, "(es10.1)") strain
      call add_warning(warnings, "the weight of a block strains it by "// &
         & trim(adjustl(figure))//": lengths, weights or young in other units than m, N, Pa?", &
         & geometry_file(deck), 1)
   end subroutine doubt_units

end submodule dda_scene_doubts
