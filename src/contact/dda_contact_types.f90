!> Contacts between blocks: a vertex against an edge; contacts of two edges that lie together form
!> a joint, which has one shear spring
module dda_contact_types
   use dda_block_system, only : block_system_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: contact_t, joint_t, edge_to_edge_joint, place_joint, vertex_number

   !> A vertex of one block against an edge of another
   type :: contact_t
      !> Block that owns the vertex
      integer :: vertex_block = 0
      !> Number of the vertex within its block
      integer :: vertex = 0
      !> Block that owns the edge
      integer :: edge_block = 0
      !> Number of the edge within its block; edge k runs from vertex k to vertex k + 1
      integer :: edge = 0
      !> Where the vertex is: (2) [m]
      real(wp) :: point(2) = 0.0_wp
      !> Foot of its perpendicular on the edge: (2) [m]
      real(wp) :: foot(2) = 0.0_wp
      !> Part of the joint's length that the contact stands for [m]
      real(wp) :: length = 0.0_wp
   end type contact_t

   !> One or two contacts with one shear spring
   type :: joint_t
      !> Block that owns the edge, block that owns the vertices: (2)
      integer :: block(2) = 0
      !> Contacts; the second is unused where n_contact is 1: (2)
      type(contact_t) :: contact(2)
      !> Number of contacts, 1 or 2
      integer :: n_contact = 0
      !> Points of the two blocks where the shear force acts, halfway along the edges: (2, 2) [m]
      real(wp) :: middle(2, 2) = 0.0_wp
      !> Unit normal of the edge, from the first block to the second: (2)
      real(wp) :: normal(2) = 0.0_wp
      !> Unit vector along the edge: (2)
      real(wp) :: tangent(2) = 0.0_wp
      !> Length over which the blocks touch [m]
      real(wp) :: length = 0.0_wp
      !> Bounds of the joint force
      type(joint_law_t) :: law
   end type joint_t

contains

   !> Place of a block's vertex among all vertices; counts on past the last vertex
   pure integer function vertex_number(system, block, vertex)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Number of the block
      integer, intent(in) :: block
      !> Number of the vertex within the block, from 1 to its number of vertices + 1
      integer, intent(in) :: vertex
      integer :: n

      n = system%first_vertex(block + 1) - system%first_vertex(block)
      vertex_number = system%first_vertex(block) + modulo(vertex - 1, n)
   end function vertex_number

   !> Joint of two edges that coincide and run against each other: both vertices of the second
   !> block's edge touch the first block's edge
   pure function edge_to_edge_joint(system, edge_pair, law) result(joint)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Block and edge of the first, block and edge of the second: (4)
      integer, intent(in) :: edge_pair(4)
      !> Law of the joint
      type(joint_law_t), intent(in) :: law
      !> The joint
      type(joint_t) :: joint
      real(wp) :: start(2), finish(2), gap(3)

      start = system%vertex(:, vertex_number(system, edge_pair(1), edge_pair(2)))
      finish = system%vertex(:, vertex_number(system, edge_pair(1), edge_pair(2) + 1))
      joint%block = edge_pair([1, 3])
      joint%law = law
      joint%length = norm2(finish - start)
      joint%n_contact = 2
      joint%contact%vertex_block = edge_pair(3)
      joint%contact%vertex = edge_pair(4) + [1, 0]
      joint%contact%edge_block = edge_pair(1)
      joint%contact%edge = edge_pair(2)
      joint%contact%length = joint%length/2.0_wp
      call place_joint(system, system%vertex, joint, gap)
   end function edge_to_edge_joint

   !> Where a joint is, and how far it is open
   pure subroutine place_joint(system, vertex, joint, gap)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Their corners: (2, n_vertex) [m]
      real(wp), intent(in) :: vertex(:, :)
      !> The joint; normal, tangent and points are set
      type(joint_t), intent(inout) :: joint
      !> Opening at the two contacts, and how far the second block lies ahead along the edge: (3)
      !> [m]
      real(wp), intent(out) :: gap(3)
      real(wp) :: start(2), finish(2), corner(2, 2)
      integer :: k

      associate (edge => joint%contact(1))
         start = vertex(:, vertex_number(system, edge%edge_block, edge%edge))
         finish = vertex(:, vertex_number(system, edge%edge_block, edge%edge + 1))
      end associate
      joint%tangent = along(start, finish)
      joint%normal = right_normal(joint%tangent)
      do k = 1, 2
         associate (contact => joint%contact(k))
            corner(:, k) = vertex(:, vertex_number(system, contact%vertex_block, contact%vertex))
            gap(k) = dot_product(joint%normal, corner(:, k) - start)
            contact%point = corner(:, k)
            contact%foot = corner(:, k) - gap(k)*joint%normal
         end associate
      end do
      joint%middle(:, 1) = (start + finish)/2.0_wp
      joint%middle(:, 2) = (corner(:, 1) + corner(:, 2))/2.0_wp
      gap(3) = dot_product(joint%tangent, joint%middle(:, 2) - joint%middle(:, 1))
      ! both blocks feel the shear force on the line of the edge: off it, an open joint would turn
      ! them
      joint%middle(:, 2) = joint%middle(:, 1) + gap(3)*joint%tangent
   end subroutine place_joint
end module dda_contact_types
