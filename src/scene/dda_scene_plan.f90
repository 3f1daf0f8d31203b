!> Model options of a scene: the parts of the method that its result depends on
!>
!> In reference geometry equilibrium alone decides stability. Strain matters in current geometry, in
!> dynamic runs, for joints that break one after the other, and for a displacement that means
!> collapse; it also distributes the joint forces at rest.
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

   !> Reasons for or against strain
   type :: strain_reason_enum
      integer :: forced = 0   !! Number of unknowns given in the deck
      integer :: none = 1     !! No strain: equilibrium alone decides
      integer :: moving = 2   !! Current geometry: strain moves the corners
      integer :: dynamic = 3  !! Dynamic run: vibrations of the blocks are part of the motion
      !> Joint strength: the distribution of forces determines which joint breaks first
      integer :: strength = 4
      integer :: displacement = 5  !! Displacement that means collapse: strain contributes to it
      integer :: forces = 6  !! Output of joint forces without a search: strain distributes them
      integer :: original = 7  !! Shi's scheme, which has strain
      integer :: files = 8  !! Blocks from files, with their own joint laws and stresses
   end type strain_reason_enum

   !> Names of the reasons
   type(strain_reason_enum), parameter :: strain_reason = strain_reason_enum()

   !> Model options of a scene
   type :: scene_plan_t
      !> Unknowns of a block in the decisions: 6, or 3 without strain
      integer :: unknowns = n_unknown
      integer :: reason = 0            !! Reason, one of strain_reason
      logical :: velocities = .false.  !! True if velocities are kept from step to step
      logical :: moving = .false.      !! True in current geometry
      !> True if joints have cohesion, tensile strength or residual friction
      logical :: strength = .false.
      !> True for a row of blocks in reference geometry, each with two neighbours only
      logical :: row = .false.
      !> True for a chain: a row of rigid blocks, stored in arrays without pattern and search
      logical :: chain = .false.
      logical :: halved = .false.  !! True if the left half of a symmetric row suffices
   end type scene_plan_t

contains

   !> Model options of a case
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
      ! a chain has no condition number, which needs equations with a pattern, and no displacements
      ! of corners
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
