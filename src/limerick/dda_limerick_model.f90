!> Model in the terms of DDA for Windows: polygons, materials, points, constants; and the state of
!> its blocks in a run
module dda_limerick_model
   use dda_block_system, only : n_unknown
   use dda_boundary, only : boundary_t, records_before, value_at
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_constants_t
   use dda_material, only : friction_coefficient, joint_law_t, material_t, no_slip_deg
   use dda_vector, only : area_moments, area_moments_t
   implicit none
   private

   public :: limerick_model_t, limerick_material_t
   public :: contact_law, finite_law, force_at, half_size, loads_end, next_record
   public :: limerick_blocks_t, limerick_march_t, limerick_state, limerick_state_enum
   public :: new_blocks, new_march, measure_blocks

   !> Material and initial state of a block
   type, extends(material_t) :: limerick_material_t
      real(wp) :: unit_weight = 0.0_wp  !! Weight per volume [N/m3]
      real(wp) :: stress(3) = 0.0_wp    !! Stress at height 0: sx, sy, txy (3) [Pa]
      real(wp) :: stress_gradient(3) = 0.0_wp  !! Growth of that stress with height: (3) [Pa/m]
      real(wp) :: velocity(3) = 0.0_wp  !! Velocities u, v and rotation: (3) [m/s, m/s, rad/s]
   end type limerick_material_t

   !> Input of a run
   type :: limerick_model_t
      !> First vertex of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      real(wp), allocatable :: vertex(:, :)  !! Corners, counter-clockwise: (2, n_vertex) [m]
      !> Number of the law of the edge that starts at each vertex: (n_vertex)
      integer, allocatable :: edge_law(:)
      integer, allocatable :: block_material(:)  !! Number of each block's material: (n_block)
      type(limerick_material_t), allocatable :: material(:)  !! Materials
      !> Law of a corner on an edge, by the kind of the corner's block and the number of the
      !> edge: (n_kind, n_law)
      type(joint_law_t), allocatable :: law(:, :)
      integer, allocatable :: kind(:)  !! Kind of each block's corners: (n_block)
      !> Direction of gravity; its length is a load factor: (2)
      real(wp) :: load_direction(2) = [0.0_wp, -1.0_wp]
      !> Fixed, load and monitoring points; all three lists are allocated
      type(boundary_t) :: boundary
      !> True to extrapolate loads beyond their first and last two records, as in Shi's files;
      !> otherwise they are constant there
      logical :: loads_go_on = .true.
      type(limerick_constants_t) :: constants  !! Constants of the scheme
   end type limerick_model_t

   !> States of a contact
   type :: limerick_state_enum
      integer :: open = 0  !! No spring
      !> Normal spring and friction; for two corners, a normal spring at the first line
      integer :: sliding = 1
      integer :: locked = 2       !! A normal and a shear spring
      integer :: second_line = 3  !! For two corners, a normal spring at the second line
   end type limerick_state_enum

   !> Names of the states
   type(limerick_state_enum), parameter :: limerick_state = limerick_state_enum()

   !> Present state of the blocks
   type :: limerick_blocks_t
      !> First vertex of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      integer, allocatable :: owner(:)         !! Block of each vertex: (n_vertex)
      integer, allocatable :: next(:)          !! Next vertex along the block: (n_vertex)
      integer, allocatable :: previous(:)      !! Previous vertex: (n_vertex)
      real(wp), allocatable :: vertex(:, :)    !! Corners: (2, n_vertex) [m]
      real(wp), allocatable :: area(:)         !! Area: (n_block) [m2]
      real(wp), allocatable :: centroid(:, :)  !! Centre of gravity: (2, n_block) [m]
      !> Central second moments Sxx, Syy, Sxy: (3, n_block) [m4]
      real(wp), allocatable :: second(:, :)
      real(wp), allocatable :: stress(:, :)       !! Stress sx, sy, txy: (3, n_block) [Pa]
      real(wp), allocatable :: rotation(:)        !! Rotation since the beginning: (n_block) [rad]
      real(wp), allocatable :: velocity(:, :)     !! Rates of the unknowns: (n_unknown, n_block)
      real(wp), allocatable :: fixed_point(:, :)  !! Fixed points: (2, n_fixed) [m]
      !> Drift of each fixed point from its initial position: (2, n_fixed) [m]
      real(wp), allocatable :: fixed_drift(:, :)
      real(wp), allocatable :: load_point(:, :)     !! Load points: (2, n_load) [m]
      real(wp), allocatable :: bolt_point(:, :, :)  !! Ends of the bolts: (2, 2, n_bolt) [m]
      !> Force of each bolt, positive in tension: (n_bolt) [N]
      real(wp), allocatable :: bolt_force(:)
      real(wp), allocatable :: measured_point(:, :)  !! Monitoring points: (2, n_measured) [m]
   end type limerick_blocks_t

   !> Scalar state of a run
   type :: limerick_march_t
      real(wp) :: half_size = 0.0_wp        !! Half the larger side of the model (w0) [m]
      real(wp) :: reach = 0.0_wp            !! Search distance of contacts (d0) [m]
      real(wp) :: mean_area = 0.0_wp        !! Initial mean area of the blocks [m2]
      real(wp) :: fixed_stiffness = 0.0_wp  !! Stiffness of the springs at the fixed points [N/m2]
      real(wp) :: penalty = 0.0_wp          !! Stiffness of the contacts in the next solution [N/m2]
      real(wp) :: used_penalty = 0.0_wp     !! Stiffness of the contacts in the last solution [N/m2]
      !> Deepest penetration of the last step over the half size; 0 with a fixed penalty
      real(wp) :: penetration = 0.0_wp
      real(wp) :: time_step = 0.0_wp  !! Length of the step [s]
      real(wp) :: time = 0.0_wp       !! Time at the end of the last accepted step [s]
      !> Largest motion of a vertex in the step over the permitted one
      real(wp) :: displacement_ratio = 0.0_wp
      integer :: steps = 0   !! Accepted steps
      integer :: passes = 0  !! Open-close iterations, one factorisation each
   end type limerick_march_t

contains

   !> Half the larger side of the box around all blocks: Shi's scale of length (Shi: df01)
   pure real(wp) function half_size(model)
      type(limerick_model_t), intent(in) :: model

      half_size = maxval(maxval(model%vertex, dim=2) - minval(model%vertex, dim=2))/2.0_wp
   end function half_size

   !> Law with finite friction: joints without slip get the largest friction of the scheme
   elemental type(joint_law_t) function finite_law(given)
      type(joint_law_t), intent(in) :: given

      finite_law = given
      if (finite_law%no_slip) finite_law%friction = friction_coefficient(no_slip_deg)
   end function finite_law

   !> Law of a corner on an edge: that of the edge, for the kind of the corner's block
   pure type(joint_law_t) function contact_law(model, block, edge) result(law)
      type(limerick_model_t), intent(in) :: model
      integer, intent(in) :: block  !! Block of the corner
      integer, intent(in) :: edge   !! Start of the edge

      law = model%law(model%kind(block), model%edge_law(edge))
   end function contact_law

   !> Force on a load point at a time: linear between the records (Shi: df09)
   pure function force_at(model, point, time) result(force)
      type(limerick_model_t), intent(in) :: model
      integer, intent(in) :: point  !! Number of the load point
      real(wp), intent(in) :: time  !! The time [s]
      real(wp) :: force(2)          !! The force: (2) [N/m]
      real(wp) :: share
      integer :: i, n

      associate (load => model%boundary%loaded(point)%force)
         n = size(load%time)
         if (.not. model%loads_go_on .or. n < 2) then
            force = value_at(load, time)
            return
         end if
         i = min(max(1, records_before(load%time, time)), n - 1)
         share = (time - load%time(i))/(load%time(i + 1) - load%time(i))
         force = (1.0_wp - share)*load%value(:, i) + share*load%value(:, i + 1)
      end associate
   end function force_at

   !> Time of the last record of all loads that change; rest is not tested before it
   pure real(wp) function loads_end(model)
      type(limerick_model_t), intent(in) :: model
      integer :: i, n

      loads_end = 0.0_wp
      do i = 1, size(model%boundary%loaded)
         associate (load => model%boundary%loaded(i)%force)
            n = size(load%time)
            if (any(abs(load%value(:, 2:) - load%value(:, :n - 1)) > 0.0_wp)) &
               & loads_end = max(loads_end, load%time(n))
         end associate
      end do
   end function loads_end

   !> Time of the first record of any load after a time; huge if there is none
   pure real(wp) function next_record(model, time)
      type(limerick_model_t), intent(in) :: model
      real(wp), intent(in) :: time
      integer :: i, n

      next_record = huge(next_record)
      do i = 1, size(model%boundary%loaded)
         associate (load => model%boundary%loaded(i)%force)
            n = records_before(load%time, time) + 1
            if (n <= size(load%time)) n = n + merge(0, 1, load%time(n) > time)
            if (n <= size(load%time)) next_record = min(next_record, load%time(n))
         end associate
      end do
   end function next_record

   !> Initial state of the blocks
   pure subroutine new_blocks(model, blocks)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(out) :: blocks
      integer :: b, i, n, nv, v, first, last

      nv = size(model%vertex, 2)
      blocks%first_vertex = model%first_vertex
      blocks%vertex = model%vertex
      associate (boundary => model%boundary)
         allocate (blocks%fixed_point(2, size(boundary%held)))
         allocate (blocks%load_point(2, size(boundary%loaded)))
         allocate (blocks%measured_point(2, size(boundary%measured)))
         do v = 1, 2
            blocks%fixed_point(v, :) = boundary%held%point(v)
            blocks%load_point(v, :) = boundary%loaded%point(v)
            blocks%measured_point(v, :) = boundary%measured%point(v)
         end do
         allocate (blocks%fixed_drift(2, size(boundary%held)), source=0.0_wp)
         n = 0
         if (allocated(boundary%bar)) n = size(boundary%bar)
         allocate (blocks%bolt_point(2, 2, n), blocks%bolt_force(n))
         do i = 1, n
            blocks%bolt_point(:, :, i) = boundary%bar(i)%point
            blocks%bolt_force(i) = boundary%bar(i)%prestress
         end do
      end associate
      n = size(model%first_vertex) - 1
      allocate (blocks%owner(nv), blocks%next(nv), blocks%previous(nv))
      allocate (blocks%area(n), blocks%centroid(2, n), blocks%second(3, n), blocks%stress(3, n))
      allocate (blocks%velocity(n_unknown, n), source=0.0_wp)
      allocate (blocks%rotation(n), source=0.0_wp)
      call measure_blocks(blocks)
      do b = 1, n
         first = model%first_vertex(b)
         last = model%first_vertex(b + 1) - 1
         blocks%owner(first:last) = b
         blocks%next(first:last) = [(v, v=first + 1, last), first]
         blocks%previous(first:last) = [last, (v, v=first, last - 1)]
         associate (material => model%material(model%block_material(b)))
            blocks%stress(:, b) = material%stress + blocks%centroid(2, b)*material%stress_gradient
            blocks%velocity(1:3, b) = material%velocity
         end associate
      end do
   end subroutine new_blocks

   !> Areas and moments of the present blocks (Shi: area)
   pure subroutine measure_blocks(blocks)
      type(limerick_blocks_t), intent(inout) :: blocks  !! The blocks; their vertices must be set
      type(area_moments_t) :: moments
      integer :: b

      do b = 1, size(blocks%area)
         moments = area_moments(blocks%vertex(:, &
            & blocks%first_vertex(b):blocks%first_vertex(b + 1) - 1))
         blocks%area(b) = moments%area
         blocks%centroid(:, b) = moments%centroid
         blocks%second(:, b) = moments%second
      end do
   end subroutine measure_blocks

   !> Scales of a run before its first step
   pure type(limerick_march_t) function new_march(model, blocks) result(march)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks

      associate (constants => model%constants)
         march%half_size = half_size(model)
         march%reach = march%half_size*max(2.5_wp*constants%max_displacement_ratio, &
            & 3.0_wp*constants%penetration_ratio)
         march%mean_area = sum(blocks%area)/real(size(blocks%area), wp)
         march%penalty = constants%penalty_factor*maxval(model%material%young)
         march%used_penalty = march%penalty
         march%fixed_stiffness = 100.0_wp*march%penalty
         march%time_step = constants%time_step
      end associate
   end function new_march
end module dda_limerick_model
