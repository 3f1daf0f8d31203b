!> Joints of a scene in reference geometry as a graph of rigid blocks
module dda_scene_graph
   use dda_bar_joints, only : add_bar_joints, add_nodes, n_bar_joints
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t
   use dda_contact_types, only : joint_place_t, joint_t, rows_of_joint
   use dda_contacts, only : contacts_t, joint_place
   use dda_coulomb_law, only : coulomb_state_t
   use dda_deformation, only : displacement_matrix
   use dda_joint_graph, only : breaks, joint_graph_t, joint_kind, rubs
   use dda_kinds, only : wp
   use dda_limit_decision, only : load_decision_t
   use dda_material, only : breaks_at_once, loses_strength
   use dda_settings, only : flow_rule, settings_t
   use dda_submatrices, only : mass_matrix
   implicit none
   private

   public :: scene_graph, decides_as_graph, has_friction, has_limit_analysis, graph_verdict_t

   !> Mass of the node of a bounded force over that of a block
   real(wp), parameter :: node_mass = 1.0e-6_wp
   !> Unknowns of a rigid block
   integer, parameter :: n_rigid = 3
   !> Least size of a block at a joint, over the root of its area
   real(wp), parameter :: least_size = 0.1_wp
   !> Stiffness of a restraint over the stiffest joint
   real(wp), parameter :: pin_stiffness = 10.0_wp
   !> Stiffness of a restraint over that of a bounded force
   real(wp), parameter :: softness = 1.0e4_wp

   !> A verdict and its proof
   type :: graph_verdict_t
      integer :: end = 0  !! One of path_end
      !> Decision of the full load by limit analysis
      type(load_decision_t), allocatable :: limit
      character(len=:), allocatable :: reason  !! Why it is undecided; unallocated otherwise
      !> Flow rule that it was found under, one of flow_rule
      integer :: flow = flow_rule%associated
      real(wp), allocatable :: mechanism(:, :)     !! Velocities of the collapse: (3, n_block)
      !> Power of the load on it by limit analysis, over what the loads could do at most
      real(wp) :: power_share = 0.0_wp
      type(coulomb_state_t), allocatable :: state  !! Last state in balance under Coulomb friction
      !> Forces of what stands under the associated rule: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Forces with which it goes on falling, where they are others: (3, n_joint) [N/m]
      real(wp), allocatable :: fall_force(:, :)
      !> True if the mechanism is the one in which the blocks fall; else a run finds it
      logical :: is_told = .false.
      logical :: on_path = .false.  !! True if something live was followed to the state
      !> True if steps may prove what limit analysis did not, as no path leads to the load
      logical :: unproven = .false.
      !> True if forces balance the dead loads, and the path has found no state under them
      logical :: no_start = .false.
      !> Last station of the path that was reached, and the share of the leg after it
      integer :: station = 0
      real(wp) :: share = 0.0_wp         !! Likewise
      !> Least and largest share, as jumps may lead elsewhere and joints crush
      real(wp) :: reach(2) = 0.0_wp
      real(wp), allocatable :: jump(:)   !! Shares of that leg at which the path jumps: (n)
      integer :: n_jump = 0              !! Jumps on the path
      real(wp) :: largest_jump = 0.0_wp  !! The largest of them [m]
      integer :: n_event = 0             !! Events on the path
      integer :: n_factorisation = 0     !! Factorisations
   end type graph_verdict_t

contains

   !> Joints first, then a pin for each restrained point, then bounded forces, then the bars
   pure subroutine scene_graph(settings, system, contacts, graph)
      !> Settings of the run, for restrained points and bounded forces
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(joint_graph_t), intent(out) :: graph
      type(held_point_t), allocatable :: pin(:)
      real(wp), parameter :: no_motion(6) = 0.0_wp
      type(joint_place_t) :: place
      real(wp) :: compliance
      integer :: i, j, k, n

      allocate (pin, source=pins(settings, system))
      n = size(contacts%joint)
      graph%n_block = maxval(system%equation) + n_carrier(settings)
      call add_nodes(settings, graph)
      call allocate_joints(n + size(pin) + n_bounded_joint(settings) + n_bar_joints(settings), &
         & any(contacts%law(contacts%joint%law)%strength < huge(1.0_wp)), graph)
      do j = 1, n
         place = joint_place(system, contacts, j)
         associate (single => contacts%joint(j)%n_contact == 1, &
            & law => contacts%law(contacts%joint(j)%law))
            graph%block(:, j) = system%equation(contacts%joint(j)%block)
            graph%length(j) = contacts%joint(j)%length
            graph%friction(j) = law%friction
            if (law%strength < huge(1.0_wp)) graph%crush(j) = law%strength*contacts%joint(j)%length
            graph%compliance(j) = block_compliance(system, contacts%joint(j), place)
            if (law%no_slip) then
               graph%kind(j) = merge(joint_kind%corner_no_slip, joint_kind%no_slip, single)
            else
               graph%kind(j) = merge(joint_kind%corner, joint_kind%contact, single)
            end if
         end associate
         do k = 1, 2
            if (graph%block(k, j) == 0) cycle
            graph%row(:, :, k, j) = rows_of_joint(contacts%joint(j), place, k, &
               & system%centroid(:, contacts%joint(j)%block(k)), no_motion, n_rigid)
         end do
      end do
      if (.not. has_pure_friction(contacts)) call add_strength(contacts, graph)
      compliance = 1.0_wp
      if (n > 0) compliance = minval(graph%compliance(:n))/pin_stiffness
      do i = 1, size(pin)
         j = n + i
         graph%kind(j) = joint_kind%pin
         graph%compliance(j) = compliance
         graph%block(:, j) = [0, system%equation(pin(i)%block)]
         graph%row(:, :, 2, j) = pin_rows(pin(i), system%centroid(:, pin(i)%block))
      end do
      call add_bar_joints(settings, system, n + size(pin) + n_bounded_joint(settings), graph)
      call set_masses(system, graph)
      call add_bounded(settings, system, compliance, n + size(pin), graph)
   end subroutine scene_graph

   !> Masses of the blocks, and of the nodes of bars
   pure subroutine set_masses(system, graph)
      type(block_system_t), intent(in) :: system
      type(joint_graph_t), intent(inout) :: graph
      real(wp) :: full(6, 6)
      integer :: b, e

      allocate (graph%mass(n_rigid, graph%n_block), source=1.0_wp)
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = mass_matrix(system%density(b), system%area(b), system%second(:, b))
         graph%mass(:, e) = [full(1, 1), full(2, 2), full(3, 3)]
      end do
      e = graph%n_block - size(graph%bound)
      graph%mass(:, e + 1:) = node_mass*sum(graph%mass(1, :e))/real(max(1, e), wp)
   end subroutine set_masses

   !> Cohesion and tensile strength of joints that lose them where they slide or open
   pure subroutine add_strength(contacts, graph)
      type(contacts_t), intent(in) :: contacts
      type(joint_graph_t), intent(inout) :: graph
      integer :: j

      allocate (graph%pull(2, size(graph%kind)), graph%cohesion(2, size(graph%kind)), &
         & source=0.0_wp)
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j), law => contacts%law(contacts%joint(j)%law))
            graph%pull(:, j) = law%tension*joint%contact%length
            graph%cohesion(:, j) = law%cohesion*joint%contact%length
         end associate
      end do
   end subroutine add_strength

   !> Bounded forces of a scene that have a bound: each has a carrier without weight in the graph
   pure integer function n_carrier(settings)
      type(settings_t), intent(in) :: settings

      n_carrier = 0
      if (allocated(settings%boundary%bounded)) &
         & n_carrier = count(settings%boundary%bounded%most < huge(1.0_wp))
   end function n_carrier

   !> Joints that bounded forces are made from
   pure integer function n_bounded_joint(settings)
      type(settings_t), intent(in) :: settings

      n_bounded_joint = 2*n_carrier(settings)
      if (allocated(settings%boundary%bounded)) &
         & n_bounded_joint = n_bounded_joint + size(settings%boundary%bounded)
   end function n_bounded_joint

   !> Make bounded forces from joints. A force without a bound is that of a joint with the ground.
   !> One with a bound is that of a joint with a carrier: a block without weight, which a load as
   !> large as the bound presses against the block, and which a stop on the ground keeps where it
   !> is. The stop takes the rest of the load, so that the force has any value up to the
   !> bound. The joint with the block is soft: at rest the stop carries it all
   pure subroutine add_bounded(settings, system, compliance, before, graph)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: compliance  !! Compliance of a pin [m2/N]
      integer, intent(in) :: before       !! Joints and pins before them
      type(joint_graph_t), intent(inout) :: graph
      real(wp) :: t(2, 6)
      integer :: e, i, j

      if (.not. allocated(settings%boundary%bounded)) return
      j = before
      e = maxval(system%equation)
      do i = 1, size(settings%boundary%bounded)
         associate (force => settings%boundary%bounded(i))
            j = j + 1
            t = displacement_matrix(force%point, system%centroid(:, force%block))
            graph%kind(j) = joint_kind%corner
            graph%block(:, j) = [0, system%equation(force%block)]
            graph%row(:, 1, 2, j) = matmul(force%direction, t(:, :n_rigid))
            graph%compliance(j) = softness*compliance
            if (.not. force%most < huge(force%most)) cycle
            ! the carrier moves along the force by its first unknown
            e = e + 1
            graph%block(1, j) = e
            graph%row(1, 1, 1, j) = -1.0_wp
            graph%kind(j + 1) = joint_kind%corner
            graph%block(:, j + 1) = [0, e]
            graph%row(1, 1, 2, j + 1) = -1.0_wp
            graph%kind(j + 2) = joint_kind%pin
            graph%block(:, j + 2) = [0, e]
            graph%row(2, 1, 2, j + 2) = 1.0_wp
            graph%row(3, 3, 2, j + 2) = 1.0_wp
            graph%compliance(j + 1:j + 2) = compliance
            j = j + 2
         end associate
      end do
   end subroutine add_bounded

   !> Compliance l/(E t) of what lies between two centres of gravity, l across the joint and t along
   !> it: rigid blocks have that of their halves in the joints
   pure real(wp) function block_compliance(system, joint, place) result(compliance)
      type(block_system_t), intent(in) :: system
      type(joint_t), intent(in) :: joint
      type(joint_place_t), intent(in) :: place
      real(wp) :: across, least, length
      integer :: side

      compliance = 0.0_wp
      do side = 1, 2
         associate (b => joint%block(side))
            if (system%equation(b) == 0) cycle
            least = least_size*sqrt(system%area(b))
            across = abs(dot_product(place%normal, place%middle(:, side) - system%centroid(:, b)))
            length = max(joint%length, least)
            compliance = compliance + max(across, least) &
               & /(system%materials(system%material(b))%young*length)
         end associate
      end do
   end function block_compliance

   !> True if no joint has cohesion, tensile strength or friction that would be spent along the way
   pure logical function has_pure_friction(contacts)
      type(contacts_t), intent(in) :: contacts

      has_pure_friction = .not. any(loses_strength(contacts%law(contacts%joint%law)))
   end function has_pure_friction

   !> Restrained points of blocks that could move
   pure function pins(settings, system) result(pin)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(held_point_t), allocatable :: pin(:)  !! The points: (n_pin)

      allocate (pin(0))
      if (.not. allocated(settings%boundary%held)) return
      associate (held => settings%boundary%held)
         pin = pack(held, system%equation(held%block) > 0)
      end associate
   end function pins

   !> Rows of a pin; both forces act along a single restrained axis
   pure function pin_rows(pin, centroid) result(row)
      type(held_point_t), intent(in) :: pin
      real(wp), intent(in) :: centroid(2)  !! Centre of gravity of its block: (2) [m]
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
   pure subroutine allocate_joints(n, crush, graph)
      integer, intent(in) :: n      !! Number of them
      logical, intent(in) :: crush  !! True if some crush
      type(joint_graph_t), intent(inout) :: graph

      allocate (graph%block(2, n), graph%kind(n))
      allocate (graph%row(n_rigid, 3, 2, n), source=0.0_wp)
      allocate (graph%friction(n), graph%length(n), source=0.0_wp)
      if (crush) allocate (graph%crush(n), source=huge(1.0_wp))
      allocate (graph%compliance(n), source=1.0_wp)
   end subroutine allocate_joints

   !> True if a scene is decided so: at rest, where the blocks are, by friction, or on a loading
   !> path by strength that the first slip or opening takes
   pure logical function decides_as_graph(settings, contacts)
      type(settings_t), intent(in) :: settings
      type(contacts_t), intent(in) :: contacts

      decides_as_graph = keeps_places(settings)
      if (decides_as_graph .and. .not. has_pure_friction(contacts)) decides_as_graph = &
         & settings%verdict_flow == flow_rule%coulomb &
         & .and. all(breaks_at_once(contacts%law(contacts%joint%law)))
   end function decides_as_graph

   !> True if a scene has a limit analysis: it is decided by friction alone
   pure logical function has_limit_analysis(settings, contacts)
      type(settings_t), intent(in) :: settings
      type(contacts_t), intent(in) :: contacts

      has_limit_analysis = keeps_places(settings)
      if (has_limit_analysis) has_limit_analysis = has_pure_friction(contacts)
   end function has_limit_analysis

   !> True if blocks are at rest and keep their places
   pure logical function keeps_places(settings)
      type(settings_t), intent(in) :: settings

      keeps_places = .not. (settings%dynamic .or. settings%current &
         & .or. settings%collapse_displacement > 0.0_wp)
   end function keeps_places

   !> True if friction matters, or strength that is lost: where joints cannot slide, or slide
   !> freely, both rules are one
   pure logical function has_friction(graph)
      type(joint_graph_t), intent(in) :: graph

      has_friction = breaks(graph) .or. any(rubs(graph%kind, graph%friction))
   end function has_friction
end module dda_scene_graph
