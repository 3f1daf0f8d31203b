!> From a deck of any kind to its scene
module dda_deck_scene
   use dda_arch_chain, only : arch_chain, arch_numbers_t, arch_rays_t
   use dda_arch_scene, only : arch_numbers, arch_scene, half_joints_deg, joint_angles_deg, &
      & material_of, settings_of, unit_weight
   use dda_block_scene, only : base_t, block_scene, floating_block
   use dda_chain, only : chain_t
   use dda_constants, only : degree, pi
   use dda_deck, only : deck_error, deck_t, file_beside, is_given, parameter_t, place_of, &
      & real_of, text_of, word_of
   use dda_deck_keys, only : key_index
   use dda_deck_set, only : number_fits, put_number
   use dda_deck_sweep, only : n_cases
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_lines, only : check_limerick_lines
   use dda_line_scene, only : check_line_scene, held_blocks, line_scene
   use dda_read_deck, only : geometry_file
   use dda_restart, only : check_restart
   use dda_scene, only : family_t, scene_t
   use dda_scene_plan, only : scene_plan_t
   use dda_settings, only : load_direction, settings_t
   use dda_text, only : to_text
   use dda_warnings, only : add_warning
   implicit none
   private

   public :: check_lines, check_scene, deck_family_t, deck_scene, movable_blocks, new_family
   public :: warning_line

   !> The scenes of one deck whose searched parameter varies
   type, extends(family_t) :: deck_family_t
      !> The deck of one case
      type(deck_t) :: deck
      !> The parameter
      type(parameter_t) :: parameter
      !> Whether its scenes are chains but for strain, and differ by their thickness ratio alone
      logical :: chains = .false.
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

   !> A block whose weight strains it more than this is doubtful
   real(wp), parameter :: doubtful_strain = 1.0e-3_wp

contains

   !> The family of a deck, its numbers read
   pure subroutine new_family(deck, plan, parameter, family)
      !> The deck of one case
      type(deck_t), intent(in) :: deck
      !> What its scenes need
      type(scene_plan_t), intent(in) :: plan
      !> The parameter that varies
      type(parameter_t), intent(in) :: parameter
      !> The family
      type(deck_family_t), intent(out) :: family

      family%deck = deck
      family%parameter = parameter
      family%chains = plan%row .and. parameter%key == key_index("arch", "thickness_ratio")
      family%decides_chains = family%chains .and. plan%chain
      if (.not. family%chains) return
      family%settings = settings_of(deck, degree*real_of(deck, "arch", "half_angle_deg"), &
         & size(half_joints_deg(deck)))
      family%numbers = arch_numbers(deck)
      family%numbers%body_force = unit_weight(deck)*load_direction(family%settings)
      family%numbers%halved = family%decides_chains .and. plan%halved
      allocate (family%joint_angle_deg, source=joint_angles_deg(deck))
   end subroutine new_family

   !> Make the chain of one thickness ratio
   pure subroutine link_arch(family, value, settings, chain, linked)
      !> The family
      class(deck_family_t), intent(in) :: family
      !> The thickness ratio
      real(wp), intent(in) :: value
      !> Settings of the run
      type(settings_t), intent(out) :: settings
      !> The chain
      type(chain_t), intent(out) :: chain
      !> Whether the scenes are chains, and one has this value
      logical, intent(out) :: linked

      linked = family%chains
      if (linked) linked = number_fits(family%parameter%key, value)
      if (.not. linked) return
      settings = family%settings
      call arch_chain(family%numbers, family%rays, value, chain)
   end subroutine link_arch

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

   !> The scene that the deck of one case describes
   pure subroutine deck_scene(deck, scene)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The scene
      type(scene_t), intent(out) :: scene

      if (allocated(deck%cut)) then
         call line_scene(deck, scene)
      else if (word_of(deck, "scene", "kind") == "blocks") then
         call file_scene(deck, scene)
      else
         call arch_scene(deck, scene)
      end if
   end subroutine deck_scene

   !> Number of blocks that can move in the scene of a case
   pure integer function movable_blocks(deck)
      !> The deck, checked
      type(deck_t), intent(in) :: deck

      if (allocated(deck%cut)) then
         movable_blocks = count(.not. held_blocks(deck%cut))
      else if (word_of(deck, "scene", "kind") == "blocks") then
         movable_blocks = count(.not. deck%plan%fixed)
      else
         movable_blocks = size(joint_angles_deg(deck)) - 1
      end if
   end function movable_blocks

   !> The scene of a deck's file of blocks
   pure subroutine file_scene(deck, scene)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The scene
      type(scene_t), intent(out) :: scene
      type(base_t) :: base

      base%material = material_of(deck)
      base%unit_weight = unit_weight(deck)
      base%gravity = real_of(deck, "load", "gravity")
      base%law = [real_of(deck, "joint", "friction_deg"), real_of(deck, "joint", "cohesion"), &
         & real_of(deck, "joint", "tension")]
      scene%settings = settings_of(deck, pi/2.0_wp, size(deck%plan%fixed))
      call block_scene(deck%plan, base, scene)
   end subroutine file_scene

   !> Whether this version can run the blocks that were cut from lines
   pure subroutine check_lines(deck, error)
      !> The deck of a case
      type(deck_t), intent(in) :: deck
      !> What it cannot do
      type(error_t), allocatable, intent(inout) :: error

      if (.not. allocated(deck%cut)) return
      if (word_of(deck, "analysis", "mode") == "limerick") then
         call check_limerick_lines(deck, error)
      else
         call check_line_scene(deck, error)
      end if
   end subroutine check_lines

   !> A warning about the blocks as the line that a user sees
   pure function warning_line(deck, i) result(line)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> Number of the warning
      integer, intent(in) :: i
      !> FILE:LINE: warning: message
      character(len=:), allocatable :: line

      line = geometry_file(deck)//":"//to_text(max(1, deck%plan%warning_line(i)))//": warning: " &
         & //trim(deck%plan%warning(i))
   end function warning_line

   !> Check that a static scene can come to rest at all, and that a run that goes on has a file;
   !> warn of blocks that will fall, and of units that are no metres
   subroutine check_scene(deck, error)
      !> The deck, checked; receives the warnings
      type(deck_t), intent(inout) :: deck
      !> Allocated if nothing holds a block, or no file is there
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene
      integer :: b
      logical :: exists

      if (is_given(deck, "analysis", "restart")) then
         inquire (file=file_beside(deck, text_of(deck, "analysis", "restart")), exist=exists)
         if (.not. exists) then
            call deck_error(error, "there is no restart file '"// &
               & text_of(deck, "analysis", "restart")//"'; check the name", deck, &
               & place_of(deck, key_index("analysis", "restart")))
            return
         end if
         call deck_scene(deck, scene)
         if (n_cases(deck) == 1) then
            call check_restart(file_beside(deck, text_of(deck, "analysis", "restart")), &
               & scene%system, error)
         else
            call check_restart(file_beside(deck, text_of(deck, "analysis", "restart")), error=error)
         end if
         if (allocated(error)) return
      end if
      if (word_of(deck, "scene", "kind") /= "blocks") return
      call deck_scene(deck, scene)
      b = floating_block(scene)
      if (b > 0 .and. word_of(deck, "analysis", "mode") == "static") then
         call fatal_error(error, "block "//to_text(b)//" rests on nothing: no chain of joints "// &
            & "ties it to a fixed block, as mode = 'static' wants; add a joint or remove it", &
            & geometry_file(deck), deck%plan%line(b))
         return
      end if
      call doubt_units(deck, scene)
      if (b > 0 .and. any(deck%plan%fixed)) call add_warning(deck%warnings, "block " &
         & //to_text(b)//" rests on nothing, and will fall", geometry_file(deck), &
         & deck%plan%line(b))
      if (any(deck%plan%fixed)) return
      b = 0
      if (allocated(deck%plan%boundary%held)) b = size(deck%plan%boundary%held)
      if (b == 0) call add_warning(deck%warnings, "nothing is fixed", geometry_file(deck), 1)
   end subroutine check_scene

   !> Warn where the weight of the blocks would strain them as no masonry is strained: lengths are
   !> then often millimetres
   pure subroutine doubt_units(deck, scene)
      !> The deck; receives the warning
      type(deck_t), intent(inout) :: deck
      !> Its scene
      type(scene_t), intent(in) :: scene
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
      call add_warning(deck%warnings, "the weight of a block strains it by "// &
         & trim(adjustl(figure))//": lengths, weights or young in other units than m, N, Pa?", &
         & geometry_file(deck), 1)
   end subroutine doubt_units
end module dda_deck_scene
