!> Contents of an analysis file of the Limerick format: materials, loads, constants of the scheme
module dda_limerick_analysis
   use dda_kinds, only : wp
   implicit none
   private

   public :: analysis_material_t, limerick_analysis_t, limerick_constants_t, limerick_joint_t
   public :: load_history_t

   !> Material properties and initial state of blocks, in any consistent units
   type :: analysis_material_t
      real(wp) :: density = 0.0_wp             !! Mass per volume
      real(wp) :: unit_weight = 0.0_wp         !! Weight per volume
      real(wp) :: young = 0.0_wp               !! Young's modulus
      real(wp) :: poisson = 0.0_wp             !! Poisson's ratio
      real(wp) :: stress(3) = 0.0_wp           !! Initial stress sx, sy, txy
      real(wp) :: stress_gradient(3) = 0.0_wp  !! Change of the initial stress with y
      real(wp) :: velocity(3) = 0.0_wp         !! Initial velocity u, v and rotation
      real(wp) :: strain(3) = 0.0_wp           !! Initial strain ex, ey, gxy
   end type analysis_material_t

   !> Mohr-Coulomb law of a kind of joints
   type :: limerick_joint_t
      real(wp) :: friction_deg = 0.0_wp  !! Friction angle [deg]
      real(wp) :: cohesion = 0.0_wp      !! Cohesion
      real(wp) :: tension = 0.0_wp       !! Tensile strength
   end type limerick_joint_t

   !> Force on a load point against time, linear between and beyond the records
   type :: load_history_t
      real(wp), allocatable :: record(:, :)  !! Time, force along x, force along y: (3, n_record)
   end type load_history_t

   !> Constants of the scheme, with Shi's defaults and letters
   type :: limerick_constants_t
      !> An open contact closes beyond this penetration over the half size (s0)
      real(wp) :: close_ratio = 2.0e-4_wp
      !> A closed contact opens beyond this opening over the half size (f0)
      real(wp) :: open_ratio = 2.0e-7_wp
      !> Target penetration of the automatic penalty over the half size (g3)
      real(wp) :: penetration_ratio = 4.0e-4_wp
      real(wp) :: overlap_deg = 3.0_wp      !! Overlap of two corners that is neglected (h1) [deg]
      real(wp) :: stiffness_ratio = 2.5_wp  !! Normal over shear stiffness of a contact (h2)
      !> Initial contact stiffness over the largest Young's modulus
      real(wp) :: penalty_factor = 50.0_wp
      !> True if the contact stiffness is adapted to the penetration
      logical :: auto_penalty = .true.
      logical :: auto_time_step = .true.  !! True if the time step is adapted to the motion
      !> Length of fixed steps; a hundredth of it is the shortest adapted step [s]
      real(wp) :: time_step = 0.01_wp
      !> Largest motion of a vertex in a step over the half size (g2)
      real(wp) :: max_displacement_ratio = 1.0e-3_wp
      integer :: max_steps = 20000  !! Maximum number of steps
      !> True to keep velocities from step to step; otherwise each step starts at rest
      logical :: dynamic = .false.
      !> True to rotate vertices by sine and cosine; otherwise along the tangent, which enlarges
      !> blocks
      logical :: exact_rotation = .false.
      !> Force of a closed contact over the speed of approach, in a dynamic run [N s/m2]
      real(wp) :: contact_damping = 0.0_wp
      !> Maximum number of steps of the phase that applies gravity; 0 for none
      integer :: gravity_steps = 0
      !> Relative change of normal and shear forces per step that ends this phase: (2)
      real(wp) :: gravity_tolerance(2) = 0.01_wp
      !> Motion of a vertex that means collapse in a static run [m]
      real(wp) :: collapse_displacement = 0.5_wp
   end type limerick_constants_t

   !> Contents of an analysis file, with default values
   type, extends(limerick_constants_t) :: limerick_analysis_t
      character(len=:), allocatable :: file  !! Name of the file, for messages
      logical :: plane_strain = .false.      !! True for plane strain, otherwise plane stress
      real(wp) :: min_time_step = 0.0_wp     !! Smallest time step; 0 if none is given
      integer :: open_close_limit = 8        !! Maximum number of open-close iterations per step
      integer :: save_interval = 1           !! Number of steps per saved step
      real(wp) :: gravity = 9.81_wp          !! Acceleration of gravity
      type(analysis_material_t), allocatable :: material(:)  !! Materials of blocks: (n)
      type(limerick_joint_t), allocatable :: joint(:)  !! Materials of joints: (n)
      !> Forces on the load points, in the order of the points: (n)
      type(load_history_t), allocatable :: load(:)
      !> Stiffness, strength and prestress of bolts without their own: (3)
      real(wp) :: bolt(3) = 0.0_wp
   end type limerick_analysis_t
end module dda_limerick_analysis
