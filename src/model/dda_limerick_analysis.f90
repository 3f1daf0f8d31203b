!> Contents of an analysis file of the Limerick format: materials, loads, constants of the scheme
module dda_limerick_analysis
   use dda_kinds, only : wp
   implicit none
   private

   public :: analysis_material_t, limerick_analysis_t, limerick_constants_t, limerick_joint_t
   public :: load_history_t

   !> What blocks are made of, and their state at the beginning; any consistent units
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

   !> Force on a load point against time, straight between the records and beyond them
   type :: load_history_t
      real(wp), allocatable :: record(:, :)  !! Time, force along x, force along y: (3, n_record)
   end type load_history_t

   !> Constants of the scheme, with the original's defaults and letters
   type :: limerick_constants_t
      !> An open contact closes beyond this penetration over the half size (s0)
      real(wp) :: close_ratio = 2.0e-4_wp
      !> A closed contact opens beyond this opening over the half size (f0)
      real(wp) :: open_ratio = 2.0e-7_wp
      !> Penetration over the half size that the automatic penalty aims at (g3)
      real(wp) :: penetration_ratio = 4.0e-4_wp
      !> Overlap of two corners that is overlooked (h1) [deg]
      real(wp) :: overlap_deg = 3.0_wp
      !> Normal over shear stiffness of a contact (h2)
      real(wp) :: stiffness_ratio = 2.5_wp
      !> Contact stiffness at the beginning over the largest Young's modulus
      real(wp) :: penalty_factor = 50.0_wp
      !> Whether the contact stiffness follows the penetration
      logical :: auto_penalty = .true.
      !> Whether the time step follows the motion
      logical :: auto_time_step = .true.
      !> Length of every step that is not chosen; a hundredth of it is the shortest that is [s]
      real(wp) :: time_step = 0.01_wp
      !> Largest motion of a vertex in a step over the half size (g2)
      real(wp) :: max_displacement_ratio = 1.0e-3_wp
      !> Most steps of a run
      integer :: max_steps = 20000
      !> Velocities are kept from step to step; otherwise every step starts at rest
      logical :: dynamic = .false.
      !> Whether vertices turn by sine and cosine; otherwise along the tangent, which lets blocks
      !> grow
      logical :: exact_rotation = .false.
      !> Force of a closed contact over the speed of approach, in a dynamic run [N s/m2]
      real(wp) :: contact_damping = 0.0_wp
      !> Most steps of the phase that turns gravity on; 0 for none
      integer :: gravity_steps = 0
      !> Relative change of normal and shear forces in a step at which that phase ends: (2)
      real(wp) :: gravity_tolerance(2) = 0.01_wp
      !> Motion of a vertex that ends a static run as collapse [m]
      real(wp) :: collapse_displacement = 0.5_wp
   end type limerick_constants_t

   !> Everything that an analysis file says; the values here hold where it says nothing
   type, extends(limerick_constants_t) :: limerick_analysis_t
      character(len=:), allocatable :: file  !! Name of the file, for messages
      logical :: plane_strain = .false.      !! Plane strain instead of plane stress
      real(wp) :: min_time_step = 0.0_wp     !! Smallest time step; 0 if none is given
      integer :: open_close_limit = 8        !! Most open-close iterations of a step
      integer :: save_interval = 1           !! Steps between two saved ones
      real(wp) :: gravity = 9.81_wp          !! Acceleration of gravity
      !> Materials of blocks: (n)
      type(analysis_material_t), allocatable :: material(:)
      type(limerick_joint_t), allocatable :: joint(:)  !! Materials of joints: (n)
      !> Forces on the load points, in their order: (n)
      type(load_history_t), allocatable :: load(:)
      !> Stiffness, strength and prestress of bolts that say none of their own: (3)
      real(wp) :: bolt(3) = 0.0_wp
   end type limerick_analysis_t
end module dda_limerick_analysis
