!> Crushing joints as layers of joints
!>
!> A joint whose strength is S carries a normal force N within a strip of the share N/S of its
!> length: N**2/(2 S) <= N1 and N2. The edges of that are parabolas, and forces below a tangent of
!> one are a half-plane: any force along the tangent, and a couple that turns away from it, about a
!> couple that is given. Plates without weight between the two blocks, one layer on the other, carry
!> what all half-planes allow. Tangents where the forces lie beyond a parabola bring them to it as
!> fast as Newton's method does.
!>
!> Kelley, The cutting-plane method for solving convex programs, J. SIAM 8 (1960)
module dda_joint_layers
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   implicit none
   private

   public :: joint_layers_t
   public :: add_layers, beyond_parabola, no_layers, touch_parabola

   !> Tangents of the parabolas of joints
   type :: joint_layers_t
      !> Joint of each: (n)
      integer, allocatable :: joint(:)
      !> Its corner that presses more where the tangent touches, 1 or 2: (n)
      integer, allocatable :: side(:)
      !> Normal force there, over the strength: (n)
      real(wp), allocatable :: share(:)
   end type joint_layers_t

   !> Distance below which two tangents of a joint coincide
   real(wp), parameter :: same = 1.0e-10_wp

   !> Compliance of a layer over that of its joint, and mass of its plate over the mean
   real(wp), parameter :: stiff_share = 1.0e-3_wp, plate_mass = 1.0e-3_wp

contains

   !> No tangents
   pure type(joint_layers_t) function no_layers()

      allocate (no_layers%joint(0), no_layers%side(0), no_layers%share(0))
   end function no_layers

   !> Excess of the forces of a joint over its crushing limit [N/m]
   elemental real(wp) function beyond_parabola(strength, n1, n2) result(beyond)
      !> Strength over the whole length; huge where it does not crush [N/m]
      real(wp), intent(in) :: strength
      !> Normal force at the first corner [N/m]
      real(wp), intent(in) :: n1
      !> Normal force at the second corner [N/m]
      real(wp), intent(in) :: n2

      beyond = 0.0_wp
      if (strength < huge(strength)) &
         & beyond = max(0.0_wp, (n1 + n2)*((n1 + n2)/strength)/2.0_wp - min(n1, n2))
   end function beyond_parabola

   !> Add tangents where forces lie beyond the parabolas
   pure subroutine touch_parabola(graph, force, most, layers, touched)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: force(:, :)  !! N1, N2, T of each: (3, n_joint) [N/m]
      real(wp), intent(in) :: most         !! Permitted excess [N/m]
      type(joint_layers_t), intent(inout) :: layers
      logical, intent(out) :: touched      !! True if there are new ones
      real(wp) :: share
      integer :: j, side

      touched = .false.
      do j = 1, size(graph%kind)
         if (.not. beyond_parabola(graph%crush(j), force(1, j), force(2, j)) > most) cycle
         share = min(1.0_wp, sum(force(1:2, j))/graph%crush(j))
         side = merge(1, 2, force(1, j) > force(2, j))
         if (any(layers%joint == j .and. layers%side == side &
            & .and. abs(layers%share - share) <= same*share)) cycle
         call add_tangent(j, side, share, layers)
         touched = .true.
      end do
   end subroutine touch_parabola

   !> Add a tangent
   pure subroutine add_tangent(joint, side, share, layers)
      integer, intent(in) :: joint   !! The joint
      integer, intent(in) :: side    !! Its corner that presses more, 1 or 2
      real(wp), intent(in) :: share  !! Normal force where it touches, over the strength
      type(joint_layers_t), intent(inout) :: layers

      layers%joint = [layers%joint, joint]
      layers%side = [layers%side, side]
      layers%share = [layers%share, share]
   end subroutine add_tangent

   !> The joints with their layers, two joints each, behind the others. The last block of a layer is
   !> the plate of the layer before, or the joint's own second block
   pure subroutine add_layers(graph, layers, layered, couple)
      type(joint_graph_t), intent(in) :: graph
      !> Tangents of their parabolas
      type(joint_layers_t), intent(in) :: layers
      !> Joints and layers; none of them crushes
      type(joint_graph_t), intent(out) :: layered
      !> Loads by the couples of the layers: (3, n_block of layered)
      real(wp), allocatable, intent(out) :: couple(:, :)
      integer :: i, m, n

      m = size(layers%joint)
      n = size(graph%kind)
      layered%n_block = graph%n_block + m
      allocate (layered%block(2, n + 2*m), source=0)
      layered%block(:, :n) = graph%block
      layered%kind = [graph%kind, (joint_kind%pin, joint_kind%corner, i=1, m)]
      layered%friction = [graph%friction, spread(0.0_wp, 1, 2*m)]
      layered%length = [graph%length, spread(0.0_wp, 1, 2*m)]
      allocate (layered%row(3, 3, 2, n + 2*m), source=0.0_wp)
      layered%row(:, :, :, :n) = graph%row
      allocate (couple(3, layered%n_block), source=0.0_wp)
      do i = 1, m
         call place_layer(layers, i, graph%crush(layers%joint(i)), n + 2*i - 1, &
            & graph%n_block + i, layered, couple)
      end do
      if (allocated(graph%compliance)) call add_springs(graph, layers, layered)
   end subroutine add_layers

   !> Properties of layers on a loading path: stiff springs, light plates
   pure subroutine add_springs(graph, layers, layered)
      type(joint_graph_t), intent(in) :: graph
      type(joint_layers_t), intent(in) :: layers
      type(joint_graph_t), intent(inout) :: layered
      integer :: i, m, n

      m = size(layers%joint)
      n = size(graph%kind)
      if (allocated(graph%gap)) then
         allocate (layered%gap(2, n + 2*m), source=0.0_wp)
         layered%gap(:, :n) = graph%gap
      end if
      layered%compliance = [graph%compliance, &
         & (stiff_share*graph%compliance(layers%joint((i + 1)/2)), i=1, 2*m)]
      allocate (layered%mass(3, layered%n_block), source=plate_mass*sum(graph%mass(1, :)) &
         & /real(max(1, graph%n_block), wp))
      layered%mass(:, :graph%n_block) = graph%mass
   end subroutine add_springs

   !> Put a plate in the place of a joint's second block, and a layer between the two
   pure subroutine place_layer(layers, number, strength, at, plate, layered, couple)
      type(joint_layers_t), intent(in) :: layers
      !> Number of the layer
      integer, intent(in) :: number
      !> Strength of its joint [N/m]
      real(wp), intent(in) :: strength
      !> Number of the first of its two joints
      integer, intent(in) :: at
      !> Number of the plate
      integer, intent(in) :: plate
      !> The joints; the joint and its layer are changed
      type(joint_graph_t), intent(inout) :: layered
      !> Receives the loads: (3, n_block)
      real(wp), intent(inout) :: couple(:, :)
      real(wp) :: own(3, 3), row(3, 3, 2), force
      integer :: b, less, more, side

      associate (joint => layers%joint(number), share => layers%share(number))
         more = layers%side(number)
         less = 3 - more
         own = layered%row(:, :, 2, joint)
         if (layered%block(2, joint) == 0) own = -layered%row(:, :, 1, joint)
         row(:, :, 1) = -own
         row(:, :, 2) = layered%row(:, :, 2, joint)
         layered%block(:, at) = [plate, layered%block(2, joint)]
         layered%block(2, joint) = plate
         layered%row(:, :, 2, joint) = own
         layered%block(:, at + 1) = layered%block(:, at)
         force = 0.5_wp*share**2*strength
         do side = 1, 2
            b = layered%block(side, at)
            if (b == 0) cycle
            couple(:, b) = couple(:, b) + force*(row(:, more, side) - row(:, less, side))
            layered%row(:, 1, side, at) = share*row(:, less, side) &
               & + (1.0_wp - share)*row(:, more, side)
            layered%row(:, 3, side, at) = row(:, 3, side)
            layered%row(:, 1, side, at + 1) = 0.5_wp*(row(:, less, side) - row(:, more, side))
         end do
      end associate
   end subroutine place_layer
end module dda_joint_layers
