!> The joints of a scene whose blocks keep their places, as a graph of rigid blocks
module dda_scene_graph
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t
   use dda_contact_detection, only : contacts_t
   use dda_contact_types, only : joint_t
   use dda_deformation, only : displacement_matrix
   use dda_inertia, only : mass_matrix
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   implicit none
   private

   public :: scene_graph, has_pure_friction

   !> Unknowns of a rigid block
   integer, parameter :: n_rigid = 3
   !> A block counts as no smaller at a joint than this share of the root of its area
   real(wp), parameter :: least_size = 0.1_wp
   !> A held point is stiffer than the stiffest joint by this factor
   real(wp), parameter :: pin_stiffness = 10.0_wp

contains

   !> Joints first, then a pin for each held point
   pure subroutine scene_graph(settings, system, contacts, graph)
      !> Settings of the run, for the held points
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Their contacts
      type(contacts_t), intent(in) :: contacts
      !> The graph
      type(joint_graph_t), intent(out) :: graph
      type(held_point_t), allocatable :: pin(:)
      real(wp) :: full(6, 6), compliance
      integer :: b, e, i, j, k, n

      allocate (pin, source=pins(settings, system))
      n = size(contacts%joint)
      graph%n_block = maxval(system%equation)
      graph%n_dof = n_rigid
      call allocate_joints(n + size(pin), graph)
      do j = 1, n
         associate (cone => contacts%springs%cone(j), law => contacts%joint(j)%law)
            graph%block(:, j) = contacts%springs%equation(:, j)
            graph%row(:, :, :, j) = contacts%springs%row(:n_rigid, :, :, j)
            graph%length(j) = contacts%joint(j)%length
            graph%friction(j) = law%friction
            graph%compliance(:, j) = block_compliance(system, contacts%joint(j))
            if (law%no_slip) then
               graph%kind(j) = merge(joint_kind%corner_no_slip, joint_kind%no_slip, cone%single)
            else
               graph%kind(j) = merge(joint_kind%corner, joint_kind%contact, cone%single)
            end if
         end associate
         do k = 1, 2
            if (graph%block(k, j) == 0) graph%row(:, :, k, j) = 0.0_wp
         end do
      end do
      compliance = 1.0_wp
      if (n > 0) compliance = minval(graph%compliance(:, :n))/pin_stiffness
      do i = 1, size(pin)
         j = n + i
         graph%kind(j) = joint_kind%pin
         graph%compliance(:, j) = compliance
         graph%block(:, j) = [0, system%equation(pin(i)%block)]
         graph%row(:, :, 2, j) = pin_rows(pin(i), system%centroid(:, pin(i)%block))
      end do
      allocate (graph%mass(n_rigid, graph%n_block))
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = mass_matrix(system%density(b), system%area(b), system%second(:, b))
         graph%mass(:, e) = [full(1, 1), full(2, 2), full(3, 3)]
      end do
   end subroutine scene_graph

   !> Compliance l/(E t) of what lies between two centres of gravity, l across the joint and t along
   !> it: rigid blocks have that of their halves in the joints
   pure real(wp) function block_compliance(system, joint) result(compliance)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The joint
      type(joint_t), intent(in) :: joint
      real(wp) :: across, least, length
      integer :: side

      compliance = 0.0_wp
      do side = 1, 2
         associate (b => joint%block(side))
            if (system%equation(b) == 0) cycle
            least = least_size*sqrt(system%area(b))
            across = abs(dot_product(joint%normal, joint%middle(:, side) - system%centroid(:, b)))
            length = max(joint%length, least)
            compliance = compliance + max(across, least) &
               & /(system%materials(system%material(b))%young*length)
         end associate
      end do
   end function block_compliance

   !> Whether no joint has cohesion or tensile strength, which would be spent along the way
   pure logical function has_pure_friction(contacts)
      !> The contacts
      type(contacts_t), intent(in) :: contacts

      has_pure_friction = .not. (any(contacts%joint%law%cohesion > 0.0_wp) &
         & .or. any(contacts%joint%law%tension > 0.0_wp))
   end function has_pure_friction

   !> Held points of blocks that could move
   pure function pins(settings, system) result(pin)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The points: (n_pin)
      type(held_point_t), allocatable :: pin(:)

      allocate (pin(0))
      if (.not. allocated(settings%boundary%held)) return
      associate (held => settings%boundary%held)
         pin = pack(held, system%equation(held%block) > 0)
      end associate
   end function pins

   !> What a pin sees of its block; one that holds along one axis alone does so with both forces
   pure function pin_rows(pin, centroid) result(row)
      !> The held point
      type(held_point_t), intent(in) :: pin
      !> Centre of gravity of its block: (2) [m]
      real(wp), intent(in) :: centroid(2)
      !> Motion of the point that its two forces prevent; there is no second corner: (3, 3)
      real(wp) :: row(n_rigid, 3)
      real(wp) :: t(2, 6)
      integer :: axis(2)

      axis = [1, 2]
      if (.not. pin%along(1)) axis = 2
      if (.not. pin%along(2)) axis = 1
      t = displacement_matrix(pin%point, centroid)
      row(:, 1) = t(axis(1), :n_rigid)
      row(:, 2) = 0.0_wp
      row(:, 3) = t(axis(2), :n_rigid)
   end function pin_rows

   !> Joints without numbers
   pure subroutine allocate_joints(n, graph)
      !> How many
      integer, intent(in) :: n
      !> The graph
      type(joint_graph_t), intent(inout) :: graph

      allocate (graph%block(2, n), graph%kind(n))
      allocate (graph%row(n_rigid, 3, 2, n), source=0.0_wp)
      allocate (graph%friction(n), graph%length(n), source=0.0_wp)
      allocate (graph%compliance(3, n), source=1.0_wp)
      allocate (graph%gap(2, n), source=0.0_wp)
   end subroutine allocate_joints
end module dda_scene_graph
