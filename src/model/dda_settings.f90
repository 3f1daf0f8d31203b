!> Settings and verdicts of a run
module dda_settings
   use dda_boundary, only : boundary_t, loaded_point_t
   use dda_kinds, only : pi, wp
   implicit none
   private

   public :: settings_t, flow_rule, flow_rule_enum, gravity_direction, load_direction
   public :: contact_tolerance, factor_of, full_push, overturned, verdict

   !> Flow rules of sliding joints
   type :: flow_rule_enum
      !> Along the normal of the friction cone: sliding opens the joint. Convex; a structure that
      !> collapses under this rule collapses under any other
      integer :: associated = 1
      integer :: coulomb = 2  !! Along the joint: Coulomb friction without dilatancy
   end type flow_rule_enum

   !> Names of the flow rules
   type(flow_rule_enum), parameter :: flow_rule = flow_rule_enum()

   !> Verdicts of an analysis
   type :: verdict_enum
      integer :: undecided = 0  !! Not known
      integer :: stable = 1     !! At rest under the full load
      integer :: collapsed = 2  !! A mechanism that accelerates without end
      integer :: completed = 3  !! A dynamic run that reached its end
      integer :: found = 4      !! A search with a closed bracket
   end type verdict_enum

   !> Names of the verdicts
   type(verdict_enum), parameter :: verdict = verdict_enum()

   !> Gap within which blocks touch, over the size of the smaller one
   real(wp), parameter :: contact_tolerance = 1.0e-4_wp
   !> Rotation of a block that has fallen over [rad]
   real(wp), parameter :: overturned = pi/4.0_wp

   !> Settings of an analysis; constant during a run
   type :: settings_t
      !> True to keep velocities from step to step; otherwise each step starts at rest
      logical :: dynamic = .false.
      !> True for current geometry: contacts follow the blocks; otherwise reference geometry
      logical :: current = .false.
      integer :: n_dof = 6         !! Unknowns of a block: 6, or 3 for rigid blocks
      integer :: flow = 1          !! Flow rule of the run, one of flow_rule
      integer :: verdict_flow = 2  !! Flow rule of the verdict, one of flow_rule
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp) :: penalty_ratio = 100.0_wp
      integer :: max_steps = 400  !! Maximum number of steps
      !> Maximum number of state changes in one step before Newton's method is used
      integer :: max_changes = 400
      !> Length of the first static step or of every dynamic step; 0 for automatic [s]
      real(wp) :: time_step = 0.0_wp
      !> Speed after an impact over speed before it, in dynamic runs
      real(wp) :: restitution = 0.0_wp
      real(wp) :: damping = 0.0_wp  !! Decay rate of velocities by mass-proportional damping [1/s]
      logical :: settles = .false.  !! True if a dynamic run starts from the forces of a static one
      !> Time at the end of a dynamic run; 0 to end after max_steps [s]
      real(wp) :: duration = 0.0_wp
      real(wp) :: from = 0.0_wp         !! Time of the histories at the start of this stage [s]
      real(wp) :: until = huge(1.0_wp)  !! Time at the end of this stage [s]
      !> Largest motion of a corner in a step over the size of the smallest block
      real(wp) :: max_displacement_ratio = 0.05_wp
      !> Displacement of a corner that means collapse; 0 for a test without a length [m]
      real(wp) :: collapse_displacement = 0.0_wp
      !> Rotation of a block that means collapse in a dynamic run; 0 for no such test [rad]
      real(wp) :: collapse_rotation = 0.0_wp
      !> Monitoring point of the collapse displacement in a dynamic run; 0 for any corner
      integer :: collapse_point = 0
      real(wp) :: tilt = 0.0_wp  !! Angle of gravity from the vertical, to the right [rad]
      !> Horizontal force over the weight, to the right; if live, at a load factor of one
      real(wp) :: push = 0.0_wp
      logical :: live_push = .false.    !! True if it is multiplied by the load factor
      real(wp) :: load_factor = 1.0_wp  !! Factor of live loads
      type(boundary_t) :: boundary      !! Actions on points and ground motion
      !> Remaining acceleration over that of the loads below which a structure is at rest
      real(wp) :: rest_tolerance = 1.0e-11_wp
      !> True to compute the condition number of the last equations
      logical :: tells_condition = .false.
   end type settings_t

contains

   !> Body force per unit weight. Vertical and horizontal gravity have no round-off, which preserves
   !> symmetry
   pure function load_direction(settings) result(direction)
      type(settings_t), intent(in) :: settings
      real(wp) :: direction(2)  !! Components to the right and up: (2)

      direction = gravity_direction(settings%tilt)
      direction(1) = direction(1) + full_push(settings)
   end function load_direction

   !> Horizontal force over the weight, including the load factor if live
   pure real(wp) function full_push(settings)
      type(settings_t), intent(in) :: settings

      full_push = settings%push
      if (settings%live_push) full_push = settings%load_factor*settings%push
   end function full_push

   !> Factor of the force on a point
   pure real(wp) function factor_of(settings, loaded)
      type(settings_t), intent(in) :: settings
      type(loaded_point_t), intent(in) :: loaded

      factor_of = merge(settings%load_factor, 1.0_wp, loaded%live)
   end function factor_of

   !> Direction of gravity at a tilt
   pure function gravity_direction(tilt) result(direction)
      real(wp), intent(in) :: tilt  !! Angle to the right [rad]
      real(wp) :: direction(2)      !! Unit vector: (2)

      direction = [sin(tilt), -cos(tilt)]
      where (abs(direction) < epsilon(1.0_wp)) direction = 0.0_wp
   end function gravity_direction
end module dda_settings
