!> A model in the terms of the original program: polygons, materials, points, and its constants
module dda_limerick_model
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t, material_t
   implicit none
   private

   public :: limerick_model_t, limerick_constants_t, limerick_material_t, load_history_t
   public :: half_size, force_at

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
      !> Motion of a vertex that ends a static run as collapse [m]
      real(wp) :: collapse_displacement = 0.5_wp
   end type limerick_constants_t

   !> What a block is made of, and how it begins
   type, extends(material_t) :: limerick_material_t
      !> Weight per volume [N/m3]
      real(wp) :: unit_weight = 0.0_wp
      !> Stress at height 0: sx, sy, txy (3) [Pa]
      real(wp) :: stress(3) = 0.0_wp
      !> Growth of that stress with height: (3) [Pa/m]
      real(wp) :: stress_gradient(3) = 0.0_wp
      !> Velocity u, v and of the rotation: (3) [m/s, m/s, rad/s]
      real(wp) :: velocity(3) = 0.0_wp
   end type limerick_material_t

   !> Force on a load point
   type :: load_history_t
      !> Times, increasing, two or more: (n) [s]
      real(wp), allocatable :: time(:)
      !> Forces at these times: (2, n) [N/m]
      real(wp), allocatable :: force(:, :)
   end type load_history_t

   !> Everything that a run is told
   type :: limerick_model_t
      !> First vertex of each block, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Corners, counter-clockwise: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Number of the law of the edge that starts at each vertex: (n_vertex)
      integer, allocatable :: edge_law(:)
      !> Number of each block's material: (n_block)
      integer, allocatable :: block_material(:)
      !> Materials
      type(limerick_material_t), allocatable :: material(:)
      !> Laws of the joints
      type(joint_law_t), allocatable :: law(:)
      !> Direction of the weight; its length scales it: (2)
      real(wp) :: load_direction(2) = [0.0_wp, -1.0_wp]
      !> Fixed points: (2, n_fixed) [m]
      real(wp), allocatable :: fixed_point(:, :)
      !> Their blocks: (n_fixed)
      integer, allocatable :: fixed_block(:)
      !> Load points: (2, n_load) [m]
      real(wp), allocatable :: load_point(:, :)
      !> Their blocks: (n_load)
      integer, allocatable :: load_block(:)
      !> Their forces: (n_load)
      type(load_history_t), allocatable :: load(:)
      !> Measured points: (2, n_measured) [m]
      real(wp), allocatable :: measured_point(:, :)
      !> Their blocks: (n_measured)
      integer, allocatable :: measured_block(:)
      !> Constants of the scheme
      type(limerick_constants_t) :: constants
   end type limerick_model_t

contains

   !> Half the larger side of the box around all blocks: the original's scale of length (Shi: df01)
   pure real(wp) function half_size(model)
      !> The model
      type(limerick_model_t), intent(in) :: model

      half_size = maxval(maxval(model%vertex, dim=2) - minval(model%vertex, dim=2))/2.0_wp
   end function half_size

   !> Force at a time: linear between the given times, and on beyond the last two (Shi: df09)
   pure function force_at(load, time) result(force)
      !> The history
      type(load_history_t), intent(in) :: load
      !> The time [s]
      real(wp), intent(in) :: time
      !> The force: (2) [N/m]
      real(wp) :: force(2)
      real(wp) :: share
      integer :: i

      do i = 1, size(load%time) - 2
         if (time < load%time(i + 1)) exit
      end do
      share = (time - load%time(i))/(load%time(i + 1) - load%time(i))
      force = (1.0_wp - share)*load%force(:, i) + share*load%force(:, i + 1)
   end function force_at
end module dda_limerick_model
