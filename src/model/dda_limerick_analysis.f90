!> What an analysis file of the Limerick line says: materials, loads, constants of the scheme
module dda_limerick_analysis
   use dda_kinds, only : wp
   implicit none
   private

   public :: limerick_analysis_t, analysis_material_t, limerick_joint_t, load_history_t

   !> What blocks are made of, and their state at the beginning; any consistent units
   type :: analysis_material_t
      !> Mass per volume
      real(wp) :: density = 0.0_wp
      !> Weight per volume
      real(wp) :: unit_weight = 0.0_wp
      !> Young's modulus
      real(wp) :: young = 0.0_wp
      !> Poisson's ratio
      real(wp) :: poisson = 0.0_wp
      !> Initial stress sx, sy, txy
      real(wp) :: stress(3) = 0.0_wp
      !> Change of the initial stress with y
      real(wp) :: stress_gradient(3) = 0.0_wp
      !> Initial velocity u, v and rotation
      real(wp) :: velocity(3) = 0.0_wp
      !> Initial strain ex, ey, gxy
      real(wp) :: strain(3) = 0.0_wp
   end type analysis_material_t

   !> Mohr-Coulomb law of a kind of joints
   type :: limerick_joint_t
      !> Friction angle [deg]
      real(wp) :: friction_deg = 0.0_wp
      !> Cohesion
      real(wp) :: cohesion = 0.0_wp
      !> Tensile strength
      real(wp) :: tension = 0.0_wp
   end type limerick_joint_t

   !> Force on a load point against time, straight between the records and beyond them
   type :: load_history_t
      !> Time, force along x, force along y: (3, n_record)
      real(wp), allocatable :: record(:, :)
   end type load_history_t

   !> Everything that an analysis file says; the values here hold where it says nothing
   type :: limerick_analysis_t
      !> Name of the file, for messages
      character(len=:), allocatable :: file
      !> Velocities are kept from step to step
      logical :: dynamic = .false.
      !> Blocks turn by sine and cosine, not linearly
      logical :: exact_rotation = .false.
      !> Plane strain instead of plane stress
      logical :: plane_strain = .false.
      !> The step chooses its length
      logical :: auto_time_step = .true.
      !> The penalty follows the penetration
      logical :: auto_penalty = .true.
      !> Penalty over the largest Young's modulus at the beginning
      real(wp) :: penalty_factor = 50.0_wp
      !> Steps of the run
      integer :: steps = 0
      !> Largest time step, or the first one
      real(wp) :: max_time_step = 0.0_wp
      !> Smallest time step; 0 if none is given
      real(wp) :: min_time_step = 0.0_wp
      !> Shi's g2: largest displacement of a step over the half size of the model
      real(wp) :: displacement_ratio = 0.0_wp
      !> Most open-close iterations of a step
      integer :: open_close_limit = 8
      !> Steps between two saved ones
      integer :: save_interval = 1
      !> Acceleration of gravity
      real(wp) :: gravity = 9.81_wp
      !> Shi's s0: penetration, over the half size of the model, that closes a contact
      real(wp) :: close_limit = 2.0e-4_wp
      !> Shi's f0: distance, over the half size of the model, that opens a contact
      real(wp) :: open_limit = 2.0e-7_wp
      !> Shi's g3: penetration, over the half size of the model, that the penalty aims at
      real(wp) :: spring_penetration = 4.0e-4_wp
      !> Shi's h1: angle by which corners may overlap [deg]
      real(wp) :: overlap_deg = 3.0_wp
      !> Shi's h2: stiffness of normal over shear springs
      real(wp) :: shear_ratio = 2.5_wp
      !> Damping of contacts: force over speed of approach
      real(wp) :: contact_damping = 0.0_wp
      !> Most steps of the phase that turns gravity on; 0 for none
      integer :: gravity_steps = 0
      !> Relative change of normal and shear forces in a step at which that phase ends: (2)
      real(wp) :: gravity_tolerance(2) = 0.01_wp
      !> Materials of blocks: (n)
      type(analysis_material_t), allocatable :: material(:)
      !> Materials of joints: (n)
      type(limerick_joint_t), allocatable :: joint(:)
      !> Forces on the load points, in their order: (n)
      type(load_history_t), allocatable :: load(:)
      !> Stiffness, strength and prestress of bolts that say none of their own: (3)
      real(wp) :: bolt(3) = 0.0_wp
   end type limerick_analysis_t
end module dda_limerick_analysis
