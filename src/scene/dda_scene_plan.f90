!> Model options of a scene: the parts of the method without which its answer would be another one
!>
!> Whether a structure stands is a matter of equilibrium alone as long as its shape stays. Strain
!> matters where blocks move, where they keep their velocities, where joints break one after the
!> other, and where a displacement means collapse; and it shares out the joint forces at rest.
module dda_scene_plan
   use dda_block_system, only : n_unknown
   use dda_deck, only : deck_t, has_group, source_of
   use dda_key_names, only : analysis_collapse_displacement, analysis_geometry, analysis_mode, &
      & analysis_unknowns, joint_cohesion, joint_residual_deg, joint_tension, live_group, &
      & load_gravity_direction_deg, load_horizontal_coefficient, output_condition, output_joints, &
      & search_group, vehicle_group
   use dda_kinds, only : wp
   implicit none
   private

   public :: scene_plan_t, plan_scene, strain_reason

   !> Unknowns of a rigid block: u0, v0, r0
   integer, parameter :: n_rigid = 3

   !> Why blocks have strains or not
   type :: strain_reason_enum
      integer :: forced = 0   !! The deck says how many unknowns a block has
      integer :: none = 1     !! Equilibrium alone decides
      integer :: moving = 2   !! Blocks move, and strain moves their corners
      integer :: dynamic = 3  !! Velocities are kept: the blocks' vibrations are part of the motion
      !> Which joint breaks first follows from how the blocks share out the forces
      integer :: strength = 4
      integer :: displacement = 5  !! A displacement means collapse, and strain is part of it
      !> The joint forces of a single decision are wanted, and strain shares them out
      integer :: forces = 6
      integer :: original = 7  !! Shi's scheme has strain
      !> Blocks from files, whose joints have laws and whose states have stress of their own
      integer :: files = 8
   end type strain_reason_enum

   !> Names of the reasons
   type(strain_reason_enum), parameter :: strain_reason = strain_reason_enum()

   !> Parts of a scene
   type :: scene_plan_t
      !> Unknowns of a block in the decisions: 6, or 3 without strain
      integer :: unknowns = n_unknown
      !> Why, one of strain_reason
      integer :: reason = 0
      !> Whether velocities are kept
      logical :: velocities = .false.
      !> Whether blocks move and contacts follow them
      logical :: moving = .false.
      !> Whether joints have cohesion or tensile strength, and may lose it
      logical :: strength = .false.
      !> Whether the blocks lie in a row, unmoved, each touching its two neighbours alone
      logical :: row = .false.
      !> Whether the blocks are a chain: rigid, unmoved, each touching its two neighbours alone,
      !> which flat arrays without pattern and search can hold
      logical :: chain = .false.
      !> Whether the left half of the row will do, as the loads are upright
      logical :: halved = .false.
   end type scene_plan_t

contains

   !> What the scene of one case needs
   pure type(scene_plan_t) function plan_scene(deck) result(plan)
      type(deck_t), intent(in) :: deck

      plan%velocities = deck%value(analysis_mode)%text == "dynamic"
      plan%moving = deck%value(analysis_geometry)%text == "current"
      plan%strength = deck%value(joint_cohesion)%number > 0.0 &
         & .or. deck%value(joint_tension)%number > 0.0 .or. deck%value(joint_residual_deg)%given
      plan%reason = strain_reason%none
      if (deck%value(output_joints)%flag .and. .not. has_group(deck, search_group)) plan%reason = &
         & strain_reason%forces
      if (deck%value(analysis_collapse_displacement)%given) plan%reason = strain_reason%displacement
      if (plan%strength) plan%reason = strain_reason%strength
      if (plan%velocities) plan%reason = strain_reason%dynamic
      if (plan%moving) plan%reason = strain_reason%moving
      if (source_of(deck) /= "arch") plan%reason = strain_reason%files
      if (deck%value(analysis_mode)%text == "limerick") plan%reason = strain_reason%original
      if (plan%reason == strain_reason%none) plan%unknowns = n_rigid
      if (deck%value(analysis_unknowns)%given) then
         plan%reason = strain_reason%forced
         plan%unknowns = nint(deck%value(analysis_unknowns)%number)
      end if
      ! the condition number is one of the equations with a pattern, and a displacement that means
      ! collapse one of corners: neither is known of a chain
      plan%row = source_of(deck) == "arch" .and. deck%value(analysis_mode)%text == "static" &
         & .and. .not. (plan%moving .or. plan%strength .or. has_group(deck, live_group) &
         & .or. has_group(deck, vehicle_group))
      plan%chain = plan%row .and. plan%unknowns == n_rigid &
         & .and. .not. (deck%value(output_condition)%flag &
         & .or. deck%value(analysis_collapse_displacement)%given)
      plan%halved = plan%row &
         & .and. .not. abs(deck%value(load_gravity_direction_deg)%number + 90.0_wp) > 0.0_wp &
         & .and. .not. abs(deck%value(load_horizontal_coefficient)%number) > 0.0_wp
   end function plan_scene
end module dda_scene_plan
