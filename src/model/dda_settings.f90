!> Settings of a run, and its possible ends
module dda_settings
   use dda_boundary, only : boundary_t, loaded_point_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: settings_t, flow_rule, flow_rule_enum, gravity_direction, load_direction
   public :: contact_tolerance, factor_of, full_push, verdict

   !> How a sliding joint moves
   type :: flow_rule_enum
      !> Along the normal of its friction cone: sliding opens the joint. Convex; no structure that
      !> falls under this rule can stand under any other
      integer :: associated = 1
      integer :: coulomb = 2  !! Along the joint: Coulomb friction without dilatancy
   end type flow_rule_enum

   !> Names of the flow rules
   type(flow_rule_enum), parameter :: flow_rule = flow_rule_enum()

   !> Answers of an analysis
   type :: verdict_enum
      integer :: undecided = 0  !! Not known
      integer :: stable = 1     !! At rest under the full load
      integer :: collapsed = 2  !! A mechanism that gains speed without end
      integer :: completed = 3  !! A dynamic run that reached its end
      integer :: found = 4      !! A search that closed its bracket
   end type verdict_enum

   !> Names of the verdicts
   type(verdict_enum), parameter :: verdict = verdict_enum()

   !> Gap within which blocks touch, over the size of the smaller one
   real(wp), parameter :: contact_tolerance = 1.0e-4_wp

   !> Settings of an analysis; never changed while it runs
   type :: settings_t
      !> Velocities are kept from step to step; otherwise every step starts at rest
      logical :: dynamic = .false.
      !> Blocks move and contacts follow them; otherwise all is taken from the undeformed shape
      logical :: current = .false.
      !> Unknowns of a block: 6, or 3 for rigid blocks
      integer :: n_dof = 6
      !> Sliding of the joints in a run, one of flow_rule
      integer :: flow = 1
      !> Sliding of the joints that a verdict is of, one of flow_rule
      integer :: verdict_flow = 2
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp) :: penalty_ratio = 100.0_wp
      !> Most steps of a run
      integer :: max_steps = 400
      !> Most changes of state in one step before Newton's method takes over
      integer :: max_changes = 400
      !> Length of the first static step or of every dynamic one; 0 to choose it [s]
      real(wp) :: time_step = 0.0_wp
      !> Speed after an impact over that before it, where blocks move in time
      real(wp) :: restitution = 0.0_wp
      !> Rate at which velocities decay by damping in proportion to mass [1/s]
      real(wp) :: damping = 0.0_wp
      !> Whether a dynamic run begins with the forces of a static one
      logical :: settles = .false.
      !> Time at which a dynamic run ends; 0 to end with its last step [s]
      real(wp) :: duration = 0.0_wp
      !> Time of the histories at which this stage of a run begins [s]
      real(wp) :: from = 0.0_wp
      !> Time at which it ends [s]
      real(wp) :: until = huge(1.0_wp)
      !> Largest motion of a corner in a step over the size of the smallest block
      real(wp) :: max_displacement_ratio = 0.05_wp
      !> Motion of a corner that means collapse; 0 for a test without a length [m]
      real(wp) :: collapse_displacement = 0.0_wp
      !> Rotation of a block that means collapse in a dynamic run; 0 for none [rad]
      real(wp) :: collapse_rotation = 0.0_wp
      !> Measured point whose displacement means collapse then; 0 for any corner
      integer :: collapse_point = 0
      !> Angle of gravity from upright, to the right [rad]
      real(wp) :: tilt = 0.0_wp
      !> Horizontal force over the weight, to the right; where it is live, at a load factor of one
      real(wp) :: push = 0.0_wp
      !> Whether the load factor multiplies it
      logical :: live_push = .false.
      !> What live loads are multiplied by
      real(wp) :: load_factor = 1.0_wp
      !> Held, loaded and measured points, and the motion of the ground
      type(boundary_t) :: boundary
      !> Remaining acceleration over that of the loads below which a structure is at rest
      real(wp) :: rest_tolerance = 1.0e-11_wp
      !> Whether the condition number of the last equations is wanted
      logical :: tells_condition = .false.
   end type settings_t

contains

   !> Body force per unit of weight. The four main directions of gravity are free of rounding, so
   !> that what is symmetric stays so
   pure function load_direction(settings) result(direction)
      type(settings_t), intent(in) :: settings
      real(wp) :: direction(2)  !! Components to the right and up: (2)

      direction = gravity_direction(settings%tilt)
      direction(1) = direction(1) + full_push(settings)
   end function load_direction

   !> Horizontal force over the weight, the load factor in it where it is live
   pure real(wp) function full_push(settings)
      type(settings_t), intent(in) :: settings

      full_push = settings%push
      if (settings%live_push) full_push = settings%load_factor*settings%push
   end function full_push

   !> What the force on a point is multiplied by
   pure real(wp) function factor_of(settings, loaded)
      type(settings_t), intent(in) :: settings
      type(loaded_point_t), intent(in) :: loaded

      factor_of = merge(settings%load_factor, 1.0_wp, loaded%live)
   end function factor_of

   !> Direction of gravity that is turned from upright
   pure function gravity_direction(tilt) result(direction)
      real(wp), intent(in) :: tilt  !! Angle to the right [rad]
      real(wp) :: direction(2)      !! Unit vector: (2)

      direction = [sin(tilt), -cos(tilt)]
      where (abs(direction) < epsilon(1.0_wp)) direction = 0.0_wp
   end function gravity_direction
end module dda_settings
