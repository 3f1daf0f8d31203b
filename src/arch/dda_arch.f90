!> Circular arches of polygon voussoirs between two fixed springings
module dda_arch
   use dda_block_system, only : block_system_t, new_block_system
   use dda_kinds, only : wp
   use dda_material, only : material_t
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: arch_shape_t, arch_blocks, equal_joints, facet_count
   public :: left_directions, section_directions, springing

   !> Shape of an arch that is its own mirror image; joints are radial
   type :: arch_shape_t
      real(wp) :: radius = 10.0_wp          !! Radius halfway through the thickness [m]
      real(wp) :: thickness_ratio = 0.1_wp  !! Thickness over radius
      !> Joints of one half from the crown, strictly increasing; the first is 0 if a joint lies at
      !> the crown, else half the crown voussoir; the last is the springing: (n) [rad]
      real(wp), allocatable :: joint_angle(:)
      !> Equal chords on each side of the voussoirs of one half, crown voussoir first: (n - 1) with
      !> a crown joint, else (n)
      integer, allocatable :: facets(:)
   end type arch_shape_t

contains

   !> Joints of one half of an arch of equal voussoirs
   pure function equal_joints(voussoirs, half_angle) result(joint_angle)
      integer, intent(in) :: voussoirs    !! Number of voussoirs of the whole arch, at least 1
      real(wp), intent(in) :: half_angle  !! Angle from the crown to the springing [rad]
      !> Joint angles from the crown: (voussoirs/2 + 1), or ((voussoirs + 1)/2) if odd [rad]
      real(wp), allocatable :: joint_angle(:)
      integer :: k

      joint_angle = [(half_angle*real(k, wp)/real(voussoirs, wp), &
         & k=mod(voussoirs, 2), voussoirs, 2)]
   end function equal_joints

   !> Number of equal chords of a voussoir none of which spans more than a facet
   elemental integer function facet_count(span_deg, facet_deg)
      real(wp), intent(in) :: span_deg  !! Angle of the voussoir [deg]
      !> Largest angle of a chord; zero or less for one chord [deg]
      real(wp), intent(in) :: facet_deg

      facet_count = 1
      if (facet_deg > 0.0_wp) facet_count = max(1, ceiling(span_deg/facet_deg - 1.0e-9_wp))
   end function facet_count

   !> Directions of the sections of the left half relative to the centre, from the springing to the
   !> crown
   pure subroutine left_directions(shape, direction, is_joint)
      type(arch_shape_t), intent(in) :: shape
      !> Unit vectors; the last is the crown's if there is a section: (2, m)
      real(wp), allocatable, intent(out) :: direction(:, :)
      logical, allocatable, intent(out) :: is_joint(:)  !! True for sections at joints: (m)
      real(wp) :: angle(sum(shape%facets) + 1), start, span
      logical :: joint(size(angle))
      integer :: i, k, n, crown

      crown = merge(0, 1, .not. shape%joint_angle(1) > 0.0_wp)
      joint = .false.
      n = 0
      ! from the crown to the springing
      if (crown == 1) then
         ! the crown voussoir: the sections of its right half only
         k = shape%facets(1)
         do i = mod(k, 2), k - 1, 2
            n = n + 1
            angle(n) = shape%joint_angle(1)*real(i, wp)/real(k, wp)
         end do
      end if
      do k = 1, size(shape%joint_angle) - 1
         start = shape%joint_angle(k)
         span = shape%joint_angle(k + 1) - start
         do i = 0, shape%facets(k + crown) - 1
            n = n + 1
            angle(n) = start + span*real(i, wp)/real(shape%facets(k + crown), wp)
            joint(n) = i == 0
         end do
      end do
      n = n + 1
      angle(n) = shape%joint_angle(size(shape%joint_angle))
      joint(n) = .true.
      allocate (direction(2, n), is_joint(n))
      do i = 1, n
         direction(:, n + 1 - i) = [-sin(angle(i)), cos(angle(i))]
         is_joint(n + 1 - i) = joint(i)
      end do
      if (.not. angle(1) > 0.0_wp) direction(1, n) = 0.0_wp
   end subroutine left_directions

   !> Directions of the sections of the whole arch relative to the centre, from the left springing
   !> to the right one; mirrored to the last bit
   pure subroutine section_directions(shape, direction, is_joint)
      type(arch_shape_t), intent(in) :: shape
      real(wp), allocatable, intent(out) :: direction(:, :)
      logical, allocatable, intent(out) :: is_joint(:)
      real(wp), allocatable :: half(:, :)
      logical, allocatable :: half_joint(:)
      integer :: m, n

      call left_directions(shape, half, half_joint)
      n = size(half_joint)
      m = 2*n - merge(0, 1, half(1, n) < 0.0_wp)
      allocate (direction(2, m), is_joint(m))
      direction(1, m:m - n + 1:-1) = -half(1, :)
      direction(2, m:m - n + 1:-1) = half(2, :)
      is_joint(m:m - n + 1:-1) = half_joint
      direction(:, :n) = half
      is_joint(:n) = half_joint
   end subroutine section_directions

   !> Voussoirs from left to right, then the left and the right springing, which are fixed blocks;
   !> and the pairs of edges that lie together, from left to right
   pure subroutine arch_blocks(shape, material, system, edge_pair)
      type(arch_shape_t), intent(in) :: shape
      !> Material of the voussoirs
      type(material_t), intent(in) :: material
      !> Blocks: voussoirs 1 to n, springings n + 1 and n + 2
      type(block_system_t), intent(out) :: system
      !> Block and edge on the left, block and edge on the right of each joint: (4, n + 1)
      integer, allocatable, intent(out) :: edge_pair(:, :)
      real(wp), allocatable :: direction(:, :), intrados(:, :), extrados(:, :), vertex(:, :)
      logical, allocatable :: is_joint(:)
      integer, allocatable :: joint_at(:), first_vertex(:)
      integer :: b, n, first, last, i

      call section_directions(shape, direction, is_joint)
      allocate (intrados, extrados, source=direction)
      intrados = shape%radius*(1.0_wp - shape%thickness_ratio/2.0_wp)*direction
      extrados = shape%radius*(1.0_wp + shape%thickness_ratio/2.0_wp)*direction
      joint_at = pack([(i, i=1, size(is_joint))], is_joint)
      n = size(joint_at) - 1
      allocate (first_vertex(n + 3), vertex(2, 2*(size(is_joint) + n - 1) + 8))
      allocate (edge_pair(4, n + 1))
      first_vertex(1) = 1
      do b = 1, n
         first = joint_at(b)
         last = joint_at(b + 1)
         first_vertex(b + 1) = first_vertex(b) + 2*(last - first + 1)
         vertex(:, first_vertex(b):first_vertex(b + 1) - 1) = &
            & reshape([intrados(:, first:last), extrados(:, last:first:-1)], &
            & [2, 2*(last - first + 1)])
         edge_pair(3:4, b) = [b, 2*(last - first + 1)]
         edge_pair(1:2, b + 1) = [b, last - first + 1]
      end do
      first_vertex(n + 2) = first_vertex(n + 1) + 4
      first_vertex(n + 3) = first_vertex(n + 2) + 4
      vertex(:, first_vertex(n + 1):first_vertex(n + 2) - 1) = &
         & springing(extrados(:, 1), intrados(:, 1))
      vertex(:, first_vertex(n + 2):first_vertex(n + 3) - 1) = &
         & springing(intrados(:, size(is_joint)), extrados(:, size(is_joint)))
      edge_pair(1:2, 1) = [n + 1, 4]
      edge_pair(3:4, n + 1) = [n + 2, 4]
      system = new_block_system(first_vertex, vertex(:, :first_vertex(n + 3) - 1), &
         & [(b > n, b=1, n + 2)], material)
   end subroutine arch_blocks

   !> Block below a fixed springing, as deep as the joint is long: its fourth edge
   pure function springing(start, finish) result(vertex)
      real(wp), intent(in) :: start(2)   !! Where the joint starts, the arch on its left: (2) [m]
      real(wp), intent(in) :: finish(2)  !! Where it ends: (2) [m]
      real(wp) :: vertex(2, 4)           !! Corners, counter-clockwise: (2, 4) [m]
      real(wp) :: outward(2)

      outward = norm2(finish - start)*right_normal(along(start, finish))
      vertex = reshape([start, start + outward, finish + outward, finish], [2, 4])
   end function springing
end module dda_arch
