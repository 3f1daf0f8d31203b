!> Contacts of a corner and an edge; two contacts of coinciding edges form a joint with one shear
!> spring
!>
!> The springs of the joints as rows of a matrix (Shi: df18, df22)
!>
!> A row maps the unknowns of the two blocks to a relative displacement of the joint: the openings
!> at its two contacts and its slip. The three displacements have one stiffness.
module dda_contact_types
   use dda_block_system, only : block_system_t
   use dda_deformation, only : tangent_matrix
   use dda_friction_cone, only : cone_kind, cone_t
   use dda_kinds, only : wp
   use dda_material, only : friction_left, joint_law_t
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: contact_t, joint_t, joint_place_t, edge_to_edge_joint, place_joint, same_joint, slip_at
   public :: joint_springs_t, rows_of_joint, new_joint_springs, place_rows
   public :: mohr_coulomb, near_miss_t, unbounded

   !> A vertex of one block and an edge of another
   type :: contact_t
      integer :: vertex = 0        !! Number of the vertex, among all vertices
      integer :: edge = 0          !! Number of the edge, that of its first vertex
      integer :: edge_end = 0      !! Second vertex of the edge
      integer :: edge_side = 1     !! Block of the joint that owns the edge: 1 or 2
      real(wp) :: length = 0.0_wp  !! Tributary length of the contact [m]
      !> Share of the joint's shear force at this contact; the shares of a joint add up to one
      real(wp) :: share = 0.5_wp
      !> Position of the vertex at zero slip, as a share of the edge from its start
      real(wp) :: lock = 0.0_wp
      !> Height of the vertex above the edge in the closed state: initial gaps of rounded
      !> coordinates count as closed [m]
      real(wp) :: closed_at = 0.0_wp
   end type contact_t

   !> One or two contacts with one shear spring
   type :: joint_t
      !> The two blocks; in a joint of given edges the first owns the edge, the second the
      !> vertices: (2)
      integer :: block(2) = 0
      type(contact_t) :: contact(2)  !! Contacts; the second is unused if n_contact is 1: (2)
      integer :: n_contact = 0       !! Number of contacts, 1 or 2
      real(wp) :: length = 0.0_wp    !! Length over which the blocks touch [m]
      !> True if it was found by a search; otherwise it was given and is kept
      logical :: found = .false.
      integer :: law = 1  !! Number of the joint law, among those of the contacts
   end type joint_t

   !> Two blocks that almost touch
   type :: near_miss_t
      type(joint_t) :: joint          !! Joint that they would have
      real(wp) :: gap = 0.0_wp        !! Widest gap, negative where the blocks overlap [m]
      real(wp) :: place(2) = 0.0_wp   !! Corner at that gap: (2) [m]
      real(wp) :: allowed = 0.0_wp    !! Gap that the contact tolerance allows [m]
      real(wp) :: tilt = 0.0_wp       !! Angle between the edges [rad]
      logical :: is_joined = .false.  !! True if static runs join the blocks
   end type near_miss_t

   !> Position of a joint
   type :: joint_place_t
      !> Vertex of each contact: (2, 2) [m]
      real(wp) :: point(2, 2) = 0.0_wp
      !> Foot of its perpendicular on the edge: (2, 2) [m]
      real(wp) :: foot(2, 2) = 0.0_wp
      !> Unit normal of the edge, oriented from the joint's first block to its second: (2, 2)
      real(wp) :: across(2, 2) = 0.0_wp
      !> Points of the two blocks where the shear force acts: (2, 2) [m]
      real(wp) :: middle(2, 2) = 0.0_wp
      !> Unit normal of the joint, from the first block to the second: (2)
      real(wp) :: normal(2) = 0.0_wp
      !> Unit vector along the joint; edges of the first block run along it: (2)
      real(wp) :: tangent(2) = 0.0_wp
   end type joint_place_t

   !> Springs of all joints
   type :: joint_springs_t
      !> Equations of the two blocks, 0 for a fixed one: (2, n_joint)
      integer, allocatable :: equation(:, :)
      !> Rows (opening 1, opening 2, slip) for the unknowns of the two blocks:
      !> (n_dof, 3, 2, n_joint)
      real(wp), allocatable :: row(:, :, :, :)
      !> Stiffness: (n_joint) [N/m per metre depth]
      real(wp), allocatable :: stiffness(:)
      !> Bounds of the joint force: (n_joint)
      type(cone_t), allocatable :: cone(:)
      !> Tensile strength of the contacts, an offset of the cone, and a zero: (3, n_joint) [N/m]
      real(wp), allocatable :: shift(:, :)
      !> Compliance of each row, unallocated without bars: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: soft(:, :)
      !> Force of each row at zero opening, likewise: (3, n_joint) [N/m]
      real(wp), allocatable :: rest(:, :)
      !> True for permanently compliant springs: found joints may be redundant, and the forces of
      !> rigid ones would not be unique
      logical :: give = .false.
   end type joint_springs_t

   !> Unlimited strength or force [N/m]
   real(wp), parameter :: unbounded = sqrt(huge(1.0_wp))

   !> Smallest size of a block across a joint, over the square root of its area
   real(wp), parameter :: least_size = 0.1_wp
   !> Largest ratio of joint stiffnesses; without it slivers shorten the longest step
   real(wp), parameter :: stiffest = 1.0e2_wp

contains

   !> Number of a block's vertex among all vertices; past the last vertex it continues with the
   !> first
   pure integer function vertex_number(system, block, vertex)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block  !! Number of the block
      !> Number of the vertex within the block, from 1 to its number of vertices + 1
      integer, intent(in) :: vertex
      integer :: n

      n = system%first_vertex(block + 1) - system%first_vertex(block)
      vertex_number = system%first_vertex(block) + modulo(vertex - 1, n)
   end function vertex_number

   !> True if two joints have the same corners and edges in the same order
   elemental logical function same_joint(a, b)
      type(joint_t), intent(in) :: a  !! One joint
      type(joint_t), intent(in) :: b

      same_joint = all(a%block == b%block) .and. a%n_contact == b%n_contact .and. all( &
         & a%contact%vertex == b%contact%vertex .and. a%contact%edge == b%contact%edge)
   end function same_joint

   !> Joint of two coinciding edges of opposite direction: both vertices of the second block's edge
   !> touch the first block's edge
   pure type(joint_t) function edge_to_edge_joint(system, edge_pair, law) result(joint)
      type(block_system_t), intent(in) :: system
      !> Block and edge of the first, block and edge of the second: (4)
      integer, intent(in) :: edge_pair(4)
      integer, intent(in) :: law  !! Number of the joint law
      integer :: edge(2), k

      edge = [(vertex_number(system, edge_pair(1), edge_pair(2) + k), k=0, 1)]
      joint%block = edge_pair([1, 3])
      joint%law = law
      joint%length = norm2(system%vertex(:, edge(2)) - system%vertex(:, edge(1)))
      joint%n_contact = 2
      joint%contact%vertex = &
         & [(vertex_number(system, edge_pair(3), edge_pair(4) + k), k=1, 0, -1)]
      joint%contact%edge = edge(1)
      joint%contact%edge_end = edge(2)
      joint%contact%length = joint%length/2.0_wp
      joint%contact%lock = [0.0_wp, 1.0_wp]
   end function edge_to_edge_joint

   !> Position of a joint, and its opening and slip
   pure subroutine place_joint(vertex, joint, place, gap)
      real(wp), intent(in) :: vertex(:, :)  !! Corners of the blocks: (2, n_vertex) [m]
      type(joint_t), intent(in) :: joint
      type(joint_place_t), intent(out) :: place
      !> Opening at the two contacts, and slip of the second block along the edge: (3) [m]
      real(wp), intent(out) :: gap(3)
      real(wp) :: start(2), finish(2), lock(2), tangent(2), slip
      integer :: k

      gap = 0.0_wp
      do k = 1, joint%n_contact
         associate (c => joint%contact(k), point => place%point(:, k), across => place%across(:, k))
            start = vertex(:, c%edge)
            finish = vertex(:, c%edge_end)
            tangent = along(start, finish)
            across = right_normal(tangent)
            point = vertex(:, c%vertex)
            gap(k) = dot_product(across, point - start)
            place%foot(:, k) = point - gap(k)*across
            gap(k) = gap(k) - c%closed_at
            slip = slip_at(vertex, c)
            gap(3) = gap(3) + c%share*slip
            ! the shear force acts on both blocks along the line of the edge; otherwise it would
            ! rotate them at an open joint
            lock = c%share*((1.0_wp - c%lock)*start + c%lock*finish)
            place%middle(:, c%edge_side) = place%middle(:, c%edge_side) + lock
            lock = lock + c%share*slip*tangent
            place%middle(:, 3 - c%edge_side) = place%middle(:, 3 - c%edge_side) + lock
            if (c%edge_side == 2) then
               across = -across
               tangent = -tangent
            end if
            place%tangent = place%tangent + c%share*tangent
         end associate
      end do
      if (any(joint%contact%edge_side /= joint%contact(1)%edge_side)) &
         & place%tangent = place%tangent/norm2(place%tangent)
      place%normal = right_normal(place%tangent)
   end subroutine place_joint

   !> Slip of the joint's second block at a contact, along the edges of the first [m]
   pure real(wp) function slip_at(vertex, contact)
      real(wp), intent(in) :: vertex(:, :)
      type(contact_t), intent(in) :: contact
      real(wp) :: edge(2), way(2)

      edge = vertex(:, contact%edge_end) - vertex(:, contact%edge)
      way = vertex(:, contact%vertex) - vertex(:, contact%edge)
      slip_at = dot_product(edge, way - contact%lock*edge)/norm2(edge)
   end function slip_at

   !> Springs of all joints
   pure subroutine new_joint_springs(system, motion, joint, law, place, penalty_ratio, n_dof, &
      & springs)
      type(block_system_t), intent(in) :: system
      !> Motion of the blocks at the position of the joints: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      type(joint_t), intent(in) :: joint(:)        !! The joints: (n_joint)
      type(joint_law_t), intent(in) :: law(:)      !! Laws of the joints: (n_law)
      type(joint_place_t), intent(in) :: place(:)  !! Positions of the joints: (n_joint)
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp), intent(in) :: penalty_ratio
      integer, intent(in) :: n_dof  !! Unknowns of one block
      type(joint_springs_t), intent(out) :: springs
      real(wp) :: centroid(2, size(system%area))
      integer :: j, n

      centroid = system%centroid + motion(1:2, :)
      n = size(joint)
      allocate (springs%equation(2, n), springs%row(n_dof, 3, 2, n), springs%stiffness(n))
      allocate (springs%cone(n), springs%shift(3, n))
      springs%give = any(joint%found)
      call place_rows(system, motion, joint, place, springs%row)
      do j = 1, n
         springs%equation(:, j) = system%equation(joint(j)%block)
         springs%stiffness(j) = penalty_ratio*block_stiffness(system, centroid, joint(j), &
            & place(j))
         call mohr_coulomb(joint(j), law(joint(j)%law), [1.0_wp, 1.0_wp], springs%cone(j), &
            & springs%shift(:, j))
      end do
      if (n > 0 .and. .not. springs%give) &
         & springs%stiffness = min(springs%stiffness, stiffest*minval(springs%stiffness))
   end subroutine new_joint_springs

   !> Rows of the springs of placed joints
   pure subroutine place_rows(system, motion, joint, place, row)
      type(block_system_t), intent(in) :: system
      !> Motion of the blocks at the position of the joints: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      type(joint_t), intent(in) :: joint(:)
      type(joint_place_t), intent(in) :: place(:)  !! Positions of the joints: (n_joint)
      real(wp), intent(out) :: row(:, :, :, :)     !! The rows: (n_dof, 3, 2, n_joint)
      integer :: j, side

      do j = 1, size(joint)
         do side = 1, 2
            associate (b => joint(j)%block(side))
               row(:, :, side, j) = rows_of_joint(joint(j), place(j), side, &
                  & system%centroid(:, b) + motion(1:2, b), motion(:, b), size(row, 1))
            end associate
         end do
      end do
   end subroutine place_rows

   !> Rows of a joint for the unknowns of one block
   pure function rows_of_joint(joint, place, side, centroid, motion, n_dof) result(row)
      type(joint_t), intent(in) :: joint
      type(joint_place_t), intent(in) :: place
      integer, intent(in) :: side          !! Block of the joint: 1 or 2
      real(wp), intent(in) :: centroid(2)  !! Centre of gravity of the block: (2) [m]
      real(wp), intent(in) :: motion(6)    !! Motion of the block: (6)
      integer, intent(in) :: n_dof
      real(wp) :: row(n_dof, 3)            !! Opening at both contacts, slip: (n_dof, 3)
      real(wp) :: t(2, 6)
      integer :: k

      row = 0.0_wp
      do k = 1, joint%n_contact
         t = tangent_matrix(merge(place%foot(:, k), place%point(:, k), &
            & side == joint%contact(k)%edge_side), centroid, motion)
         row(:, k) = place%across(1, k)*t(1, :n_dof) + place%across(2, k)*t(2, :n_dof)
      end do
      t = tangent_matrix(place%middle(:, side), centroid, motion)
      row(:, 3) = place%tangent(1)*t(1, :n_dof) + place%tangent(2)*t(2, :n_dof)
      row = real(2*side - 3, wp)*row
   end function rows_of_joint

   !> Stiffness E t/l = E area/l**2 of the softer movable block at a joint: l is the block's size
   !> across the joint, t along it. For given edges t is their length; for found ones l is twice the
   !> distance of the centre
   pure function block_stiffness(system, centroid, joint, place) result(stiffness)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: centroid(:, :)  !! Centres of gravity of the blocks: (2, n_block) [m]
      type(joint_t), intent(in) :: joint
      type(joint_place_t), intent(in) :: place
      real(wp) :: stiffness                   !! The stiffness [N/m per metre depth]
      real(wp) :: young, size_across
      integer :: side

      stiffness = huge(stiffness)
      do side = 1, 2
         associate (b => joint%block(side))
            if (system%equation(b) == 0) cycle
            young = system%materials(system%material(b))%young
            if (joint%found) then
               size_across = max(least_size*sqrt(system%area(b)), &
                  & 2.0_wp*abs(dot_product(place%normal, place%middle(:, side) - centroid(:, b))))
               stiffness = min(stiffness, young*system%area(b)/size_across**2)
            else
               size_across = system%area(b)/joint%length
               stiffness = min(stiffness, young*joint%length/size_across)
            end if
         end associate
      end do
   end function block_stiffness

   !> Bounds of a joint's force and the tensile strength of its contacts. The tension is at most
   !> that at the apex of the Mohr-Coulomb cone. A contact that has slid or opened has no cohesion
   !> and no tensile strength; a joint without intact contacts has the residual friction
   pure subroutine mohr_coulomb(joint, law, intact, cone, shift)
      type(joint_t), intent(in) :: joint
      type(joint_law_t), intent(in) :: law
      real(wp), intent(in) :: intact(2)  !! Remaining share of each contact's strength: (2)
      type(cone_t), intent(out) :: cone  !! Bounds of the force, with the cone offset by the tension
      !> Tension of each contact and a zero for the shear force: (3) [N/m]
      real(wp), intent(out) :: shift(3)
      real(wp) :: whole(2), cohesion

      cone%single = joint%n_contact == 1
      whole = intact*joint%contact%length
      shift = [law%tension*whole, 0.0_wp]
      if (law%no_slip) then
         cone%kind = cone_kind%no_slip
         return
      end if
      cone%friction = friction_left(law, maxval(intact(:joint%n_contact)))
      cohesion = law%cohesion*sum(whole)
      if (cone%friction*sum(shift) > cohesion) shift = shift*(cohesion/(cone%friction*sum(shift)))
      cone%limit = max(0.0_wp, cohesion - cone%friction*sum(shift))
   end subroutine mohr_coulomb

end module dda_contact_types
