!> A model in the terms of the original program: polygons, materials, points, and its constants
module dda_limerick_model
   use dda_boundary, only : boundary_t, records_before, value_at
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_constants_t
   use dda_material, only : friction_coefficient, joint_law_t, material_t
   implicit none
   private

   public :: limerick_model_t, limerick_material_t
   public :: contact_law, finite_law, force_at, half_size, loads_end, next_record

   !> Friction angle of a joint that cannot slide [deg]
   real(wp), parameter :: no_slip_deg = 89.9_wp

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
      !> Laws of the joints, of the corners of blocks of each kind on edges of each number: (n_kind,
      !> n_law)
      type(joint_law_t), allocatable :: law(:, :)
      !> Kind of each block's corners: (n_block)
      integer, allocatable :: kind(:)
      !> Direction of the weight; its length scales it: (2)
      real(wp) :: load_direction(2) = [0.0_wp, -1.0_wp]
      !> Points that are held where they are, loaded, measured; all three lists are allocated
      type(boundary_t) :: boundary
      !> Whether loads go straight on before the first and beyond the last two of their records, as
      !> the original's files want it; otherwise they stay as they are
      logical :: loads_go_on = .true.
      !> Constants of the scheme
      type(limerick_constants_t) :: constants
   end type limerick_model_t

contains

   !> Half the larger side of the box around all blocks: the original's scale of length (Shi: df01)
   pure real(wp) function half_size(model)
      type(limerick_model_t), intent(in) :: model

      half_size = maxval(maxval(model%vertex, dim=2) - minval(model%vertex, dim=2))/2.0_wp
   end function half_size

   !> The scheme knows friction alone: a joint that cannot slide has the most of it
   elemental type(joint_law_t) function finite_law(given)
      type(joint_law_t), intent(in) :: given

      finite_law = given
      if (finite_law%no_slip) finite_law%friction = friction_coefficient(no_slip_deg)
   end function finite_law

   !> Law of a corner on an edge: that of the edge, for corners of the block's kind
   pure type(joint_law_t) function contact_law(model, block, edge) result(law)
      type(limerick_model_t), intent(in) :: model
      integer, intent(in) :: block  !! Block of the corner
      integer, intent(in) :: edge   !! Vertex at which the edge starts

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

   !> Time of the last record of all loads that change: before it nothing is at rest for good
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
end module dda_limerick_model
