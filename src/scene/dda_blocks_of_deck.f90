!> Scenes of shaped arches and of files of blocks
submodule (dda_deck_scene) dda_blocks_of_deck
   use dda_arch_assembly, only : arch_assembly_t, n_movable
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_arch_scene, only : joint_angles_deg, material_of
   use dda_block_scene, only : base_t, block_scene
   use dda_deck, only : has_group
   use dda_fill_loads, only : add_fill_weight, fill_of, fill_t, press_fill
   use dda_key_names, only : arch_lune_deg, fill_group, joint_cohesion, joint_friction_deg, &
      & joint_residual_deg, joint_slip_length, joint_tension, load_gravity, &
      & load_water_rise, scene_kind, tie_group
   use dda_kinds, only : pi
   use dda_line_scene, only : held_blocks
   use dda_shape_check, only : add_ties
   use dda_shape_scene, only : add_lune_weights, find_crown_joint, prescribe_springings, &
      & shape_assembly, shape_form
   implicit none

contains

   !> Make the scene of a shaped arch
   module procedure shape_scene
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(fill_t) :: fill

      call shape_assembly(deck, assembly, problem)
      if (len_trim(problem%text) > 0) return
      if (has_group(deck, tie_group)) call add_ties(deck, assembly%plan)
      call prescribe_springings(deck, assembly%plan)
      call file_scene(deck, assembly%plan, scene)
      call find_crown_joint(assembly, scene)
      if (deck%value(arch_lune_deg)%given) call add_lune_weights(deck%value(arch_lune_deg)%number, &
         & scene)
      if (has_group(deck, fill_group)) then
         fill = fill_of(deck, assembly)
         call add_fill_weight(fill, scene)
         call add_live_loads(deck, scene, fill)
         call press_fill(fill, scene)
      else
         call add_live_loads(deck, scene)
      end if
   end procedure shape_scene

   !> Make the scene of a block plan
   module procedure file_scene
      type(base_t) :: base

      base%material = material_of(deck)
      base%unit_weight = unit_weight(deck)
      base%gravity = deck%value(load_gravity)%number
      base%law = [deck%value(joint_friction_deg)%number, deck%value(joint_cohesion)%number, &
         & deck%value(joint_tension)%number, 90.0_wp, deck%value(joint_slip_length)%number]
      if (deck%value(joint_residual_deg)%given) base%law(4) = deck%value(joint_residual_deg)%number
      base%water_rise = deck%value(load_water_rise)%number
      scene%settings = settings_of(deck, pi/2.0_wp, size(blocks%fixed))
      call block_scene(blocks, base, scene)
   end procedure file_scene

   !> Number of movable blocks in the scene of a case
   module procedure movable_blocks
      type(arch_form_t) :: form
      type(form_problem_t) :: problem

      if (allocated(deck%cut)) then
         movable_blocks = count(.not. held_blocks(deck%cut))
      else if (deck%value(scene_kind)%text == "blocks") then
         movable_blocks = count(.not. deck%plan%fixed)
      else if (source_of(deck) == "shape") then
         call shape_form(deck, form, problem)
         movable_blocks = n_movable(form)
      else
         movable_blocks = size(joint_angles_deg(deck)) - 1
      end if
   end procedure movable_blocks
end submodule dda_blocks_of_deck
