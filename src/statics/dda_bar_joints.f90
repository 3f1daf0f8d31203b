!> Bars as joints of a graph: strengths and forces
module dda_bar_joints
   use dda_bar, only : bar_condition
   use dda_bar_place, only : bar_rows
   use dda_block_system, only : block_system_t
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   implicit none
   private

   public :: add_bar_joints, add_nodes, bar_joint, keep_bar_forces, n_bar_joints

   !> Unknowns of a rigid block
   integer, parameter :: n_rigid = 3
   !> Strength from which a bar does not yield [N]
   real(wp), parameter :: unbounded = 1.0e29_wp
   !> Relative distance from its strength at which a bar yields
   real(wp), parameter :: near_strength = 1.0e-9_wp
   !> Compliance of the node of a bar over that of the bar
   real(wp), parameter :: stiff_share = 1.0e-3_wp

contains

   !> Nodes of the bars that yield
   pure subroutine add_nodes(settings, graph)
      type(settings_t), intent(in) :: settings
      type(joint_graph_t), intent(inout) :: graph

      allocate (graph%bound(0))
      if (.not. allocated(settings%boundary%bar)) return
      associate (bar => settings%boundary%bar)
         graph%bound = pack(bar%strength, bar%strength < unbounded)
      end associate
      graph%n_block = graph%n_block + size(graph%bound)
   end subroutine add_nodes

   !> Joints that the bars are made of: one for each, three where it yields
   pure integer function n_bar_joints(settings)
      type(settings_t), intent(in) :: settings

      n_bar_joints = 0
      if (.not. allocated(settings%boundary%bar)) return
      n_bar_joints = size(settings%boundary%bar) &
         & + 2*count(settings%boundary%bar%strength < unbounded)
   end function n_bar_joints

   !> A bar only pulls: a joint of one corner without friction that closes as the bar grows longer.
   !> One that yields pulls between its first block and a node, which is loaded by the strength and
   !> leans on the ground with what the bar leaves of it; the node hands the pull on to the second
   pure subroutine add_bar_joints(settings, system, first, graph)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: first  !! Joints before those of the bars
      type(joint_graph_t), intent(inout) :: graph
      real(wp) :: row(6, 2)
      integer :: equation(2), i, j, node, side

      if (.not. allocated(settings%boundary%bar)) return
      j = first
      node = graph%n_block - size(graph%bound)
      do i = 1, size(settings%boundary%bar)
         associate (bar => settings%boundary%bar(i))
            row = -bar_rows(bar%point, bar%block, system%centroid)
            equation = 0
            do side = 1, 2
               if (bar%block(side) > 0) equation(side) = system%equation(bar%block(side))
               if (equation(side) == 0) row(:, side) = 0.0_wp
            end do
            j = j + 1
            graph%kind(j) = joint_kind%corner
            graph%compliance(j) = 1.0_wp/bar%stiffness
            graph%block(:, j) = equation
            graph%row(:, 1, :, j) = row(:n_rigid, :)
            if (.not. bar%strength < unbounded) cycle
            node = node + 1
            graph%block(2, j) = node
            graph%row(:, 1, 2, j) = [1.0_wp, 1.0_wp, 0.0_wp]
            graph%kind(j + 1) = joint_kind%mirror
            graph%compliance(j + 1) = stiff_share/bar%stiffness
            graph%block(:, j + 1) = [equation(2), node]
            graph%row(:, 1, 1, j + 1) = row(:n_rigid, 2)
            graph%row(:, 1, 2, j + 1) = [0.0_wp, -1.0_wp, 0.0_wp]
            graph%row(:, 2, 2, j + 1) = [0.0_wp, 0.0_wp, 1.0_wp]
            graph%kind(j + 2) = joint_kind%corner
            graph%compliance(j + 2) = stiff_share/bar%stiffness
            graph%block(:, j + 2) = [0, node]
            graph%row(:, 1, 2, j + 2) = [1.0_wp, 0.0_wp, 0.0_wp]
            j = j + 2
         end associate
      end do
   end subroutine add_bar_joints

   !> The joint that is a bar
   pure integer function bar_joint(settings, n_joint, bar)
      type(settings_t), intent(in) :: settings
      integer, intent(in) :: n_joint  !! Number of joints of the graph
      integer, intent(in) :: bar      !! Number of the bar

      bar_joint = n_joint - n_bar_joints(settings) + bar + 2*count( &
         & settings%boundary%bar(:bar - 1)%strength < unbounded)
   end function bar_joint

   !> Forces of the bars from those of the joints
   pure subroutine keep_bar_forces(settings, force, system)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: force(:, :)            !! N1, N2, T of all joints: (3, n_joint) [N/m]
      type(block_system_t), intent(inout) :: system  !! The blocks; the states of the bars are set
      integer :: i

      if (.not. allocated(system%bar)) return
      do i = 1, size(system%bar)
         associate (bar => system%bar(i), strength => settings%boundary%bar(i)%strength)
            bar%force = max(0.0_wp, force(1, bar_joint(settings, size(force, 2), i)))
            bar%condition = bar_condition%elastic
            if (.not. bar%force > 0.0_wp) bar%condition = bar_condition%slack
            if (bar%force >= (1.0_wp - near_strength)*strength) then
               bar%force = strength
               bar%condition = bar_condition%yielding
            end if
         end associate
      end do
   end subroutine keep_bar_forces
end module dda_bar_joints
