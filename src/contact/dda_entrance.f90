!> Joints between two near blocks (Shi: df05): coinciding edges, corners at edges, and corners at
!> corners by the entrance edge
module dda_entrance
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_contact_types, only : contact_t, joint_t
   use dda_key_set, only : add_key, has_key, key_set_t, new_key_set
   use dda_kinds, only : wp
   use dda_outline, only : corner_view_t, is_convex, outline_t, view_corner
   use dda_sort, only : place_in
   use dda_vector, only : cross
   implicit none
   private

   public :: neighbourhood_t, joint_list_t, add_joints, add_single, contact_key, join_edges
   public :: take_joints, was_closed

   !> Data of a search around two blocks
   type :: neighbourhood_t
      !> Outline of the blocks, measured
      type(outline_t) :: outline
      !> First corner of each block, and one past the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> Present corners: (2, n_vertex) [m]
      real(wp), allocatable :: vertex(:, :)
      !> Expected motion of the corners, for directions and ratios only: (2, n_vertex) [m]
      real(wp), allocatable :: travel(:, :)
      !> Expected corners, if convex blocks use separating axes: (2, n_vertex) [m]
      real(wp), allocatable :: ahead(:, :)
      !> True if the expected motion is that of a try
      logical :: tried = .false.
      !> Penetration within which two blocks still count as separated [m]
      real(wp) :: level = 0.0_wp
      !> True in the reference shape, before any contact
      logical :: beginning = .false.
      !> In the reference shape, a corner closer to the end of an edge than this share of the reach
      !> touches the end
      real(wp) :: ends = 1.0_wp
      !> Keys of the contacts that were closed, ascending: (n_closed)
      integer(int64), allocatable :: closed(:)
   end type neighbourhood_t

   !> Joints per piece of a list
   integer, parameter :: most_joints = 64

   !> A piece of a list
   type :: joint_piece_t
      type(joint_t), allocatable :: joint(:)  !! Its joints: (most_joints)
   end type joint_piece_t

   !> List of joints in pieces: a single growing array would temporarily need several times its size
   type :: joint_list_t
      integer :: n = 0                              !! Number of joints
      type(joint_piece_t), allocatable :: piece(:)  !! The joints; all pieces but the last are full
   end type joint_list_t

   !> Sine of the largest angle between edges of a joint
   real(wp), parameter :: parallel = 0.1_wp
   !> Smallest overlap of two edges, over the shorter one
   real(wp), parameter :: least_overlap = 1.0e-6_wp
   !> Distance below which two corners count as coincident, over the shorter edge
   real(wp), parameter :: met = 1.0e-3_wp
   !> Round-off of corners that are computed in two ways, over their coordinates
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp)

contains

   !> Key of a contact
   elemental integer(int64) function contact_key(corner, edge, n_vertex)
      integer, intent(in) :: corner    !! Number of the corner, among all corners
      integer, intent(in) :: edge      !! Number of the edge, among all edges
      integer, intent(in) :: n_vertex  !! Total number of corners

      contact_key = int(corner, int64)*int(n_vertex + 1, int64) + int(edge, int64)
   end function contact_key

   !> Add the joints of two blocks
   pure subroutine add_joints(near, edge_pair, reach, list)
      type(neighbourhood_t), intent(in) :: near
      !> Edges near one another, of the first block and of the second: (2, n_pair)
      integer, intent(in) :: edge_pair(:, :)
      real(wp), intent(in) :: reach  !! Largest gap [m]
      type(joint_list_t), intent(inout) :: list
      type(key_set_t) :: taken
      integer :: i

      call new_key_set(taken, 5*size(edge_pair, 2))
      do i = 1, size(edge_pair, 2)
         call join_edges(near, edge_pair(:, i), reach, taken, list)
      end do
      do i = 1, size(edge_pair, 2)
         call join_corner(near, edge_pair(1, i), edge_pair(2, i), 2, reach, taken, list)
         call join_corner(near, edge_pair(2, i), edge_pair(1, i), 1, reach, taken, list)
      end do
      ! in the reference shape, two corners that only touch each other have no joint
      if (near%beginning) return
      do i = 1, size(edge_pair, 2)
         call join_corners(near, edge_pair(:, i), reach, taken, list)
      end do
   end subroutine add_joints

   !> Join two coinciding edges: each end of the overlap is a corner of one of them
   pure subroutine join_edges(near, pair, reach, taken, list)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: pair(2)           !! Edge of the first block, edge of the second: (2)
      real(wp), intent(in) :: reach
      type(key_set_t), intent(inout) :: taken  !! Keys of contacts that are in a joint
      type(joint_list_t), intent(inout) :: list
      type(joint_t) :: joint
      type(corner_view_t) :: view
      real(wp) :: first(2), second(2), direction(2), from(2), to(2), angle, length, shorter
      integer(int64) :: key(2)
      integer :: corner(2), edge(2), k

      associate (v => near%vertex, next => near%outline%next)
         first = near%outline%direction(:, pair(1))
         second = near%outline%direction(:, pair(2))
         angle = abs(cross(first, second))
         if (dot_product(first, second) > 0.0_wp .or. angle > parallel) return
         direction = (first - second)/norm2(first - second)
         ! positions of the ends of both edges along the direction, from the start of the first
         from(1) = 0.0_wp
         to(1) = dot_product(direction, v(:, next(pair(1))) - v(:, pair(1)))
         from(2) = dot_product(direction, v(:, next(pair(2))) - v(:, pair(1)))
         to(2) = dot_product(direction, v(:, pair(2)) - v(:, pair(1)))
         length = minval(to) - maxval(from)
         shorter = minval(to - from)
         if (.not. length > least_overlap*shorter) return
         call choose_end(near, [pair(1), pair(2)], [next(pair(2)), pair(1)], from(1) - from(2), &
            & min(met, angle)*shorter, corner(1), edge(1))
         call choose_end(near, [next(pair(1)), pair(2)], [pair(2), pair(1)], to(2) - to(1), &
            & min(met, angle)*shorter, corner(2), edge(2))
      end associate
      ! corners that have just passed each other have no common edge yet
      if (length < met*shorter .and. .not. (near%beginning .or. was_closed(near, corner(1), &
         & edge(1)) .or. was_closed(near, corner(2), edge(2)))) return
      joint%n_contact = 2
      joint%length = length
      do k = 1, 2
         view = view_corner(near%outline, near%vertex, corner(k), edge(k), reach)
         if (abs(view%gap) > reach) return
         joint%contact(k) = contact_t(corner(k), edge(k), near%outline%next(edge(k)), &
            & edge_side=merge(1, 2, edge(k) == pair(1)), length=length/2.0_wp)
         key(k) = contact_key(corner(k), edge(k), size(near%vertex, 2))
      end do
      call add_key(taken, key(1))
      call add_key(taken, key(2))
      call add_joint(near, pair, joint, list)
   end subroutine join_edges

   !> Corner at one end of the overlap of two edges: the inner one; of two coincident corners, the
   !> one that touched before, or else that of the first block. Both are right, but contacts of an
   !> edge of the other block give other forces once the joint opens
   pure subroutine choose_end(near, of_first, of_second, ahead, zone, corner, edge)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: of_first(2)   !! Corner of the first block and edge of the second: (2)
      integer, intent(in) :: of_second(2)  !! Corner of the second block and edge of the first: (2)
      !> Distance of the corner of the first block inside the other edge [m]
      real(wp), intent(in) :: ahead
      real(wp), intent(in) :: zone  !! Distance within which corners are coincident [m]
      integer, intent(out) :: corner, edge
      logical :: by_first

      by_first = ahead >= -rounding*maxval(abs(near%vertex(:, [of_first, of_second])))
      if (abs(ahead) <= zone) then
         if (was_closed(near, of_first(1), of_first(2))) by_first = .true.
         if (was_closed(near, of_second(1), of_second(2))) by_first = .false.
      end if
      ! a reflex corner touches no edge
      by_first = (by_first .and. is_convex(near%outline, near%vertex, of_first(1))) &
         & .or. .not. is_convex(near%outline, near%vertex, of_second(1))
      corner = merge(of_first(1), of_second(1), by_first)
      edge = merge(of_first(2), of_second(2), by_first)
   end subroutine choose_end

   !> Join a corner and an edge that it faces, except near the ends of the edge: in the reference
   !> shape within the touching distance, later within the distance of coincident corners
   pure subroutine join_corner(near, corner, edge, edge_side, reach, taken, list)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: corner, edge
      !> 1 if the edge belongs to the first block, 2 if to the second
      integer, intent(in) :: edge_side
      real(wp), intent(in) :: reach
      type(key_set_t), intent(inout) :: taken
      type(joint_list_t), intent(inout) :: list
      type(corner_view_t) :: view
      real(wp) :: zone(2)

      view = view_corner(near%outline, near%vertex, corner, edge, reach)
      if (.not. view%faces) return
      ! at a reflex corner the edge ends at its neighbour; at a convex corner another edge may be
      ! nearer
      zone = merge(near%ends*reach, meeting_zone(near, corner, edge), near%beginning)
      if (.not. is_convex(near%outline, near%vertex, edge)) zone(1) = -zone(1)
      if (.not. is_convex(near%outline, near%vertex, near%outline%next(edge))) zone(2) = -zone(2)
      if (view%way < zone(1) .or. view%way > view%length - zone(2)) return
      if (has_key(taken, contact_key(corner, edge, size(near%vertex, 2)))) return
      call add_single(near, corner, edge, edge_side, taken, list)
   end subroutine join_corner

   !> Join two corners: the entrance is the adjacent edge whose line the other corner would cross
   !> last. Corners that only touch each other have none
   pure subroutine join_corners(near, pair, reach, taken, list)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: pair(2)  !! Corner of the first block, corner of the second: (2)
      real(wp), intent(in) :: reach
      type(key_set_t), intent(inout) :: taken
      type(joint_list_t), intent(inout) :: list
      type(corner_view_t) :: view
      real(wp) :: distance, zone, time, best_gap, best_time
      integer :: corner(4), edge(4), i, best, n_level
      logical :: has_met

      distance = norm2(near%vertex(:, pair(2)) - near%vertex(:, pair(1)))
      if (distance > 2.0_wp*reach) return
      corner = pair([1, 1, 2, 2])
      edge = [pair(2), near%outline%previous(pair(2)), pair(1), near%outline%previous(pair(1))]
      do i = 1, 4
         if (has_key(taken, contact_key(corner(i), edge(i), size(near%vertex, 2)))) return
      end do
      if (.not. is_convex(near%outline, near%vertex, pair(1))) return
      if (.not. is_convex(near%outline, near%vertex, pair(2))) return
      zone = minval([(maxval(meeting_zone(near, corner(i), edge(i))), i=1, 4)])
      has_met = distance <= zone
      best = 0
      n_level = 0
      best_gap = -huge(best_gap)
      best_time = -huge(best_time)
      do i = 1, 4
         view = view_corner(near%outline, near%vertex, corner(i), edge(i), reach)
         if (.not. view%faces) cycle
         if (has_met .and. was_closed(near, corner(i), edge(i))) then
            best = i
            n_level = 0
            exit
         end if
         if (has_met .and. abs(view%gap) <= zone) n_level = n_level + 1
         time = crossing_time(near, corner(i), edge(i), view, zone)
         if (time < best_time .or. .not. time > best_time .and. .not. view%gap > best_gap) cycle
         best = i
         best_gap = view%gap
         best_time = time
      end do
      if (best == 0 .or. n_level > 1) return
      call add_single(near, corner(best), edge(best), merge(2, 1, best <= 2), taken, list)
   end subroutine join_corners

   !> Time at which a corner crosses the line of an edge, in units of its expected motion: huge if
   !> it stays outside, -huge if it stays inside
   pure real(wp) function crossing_time(near, corner, edge, view, slack)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: corner, edge
      type(corner_view_t), intent(in) :: view
      !> Penetration that does not count as crossing, because of compliant springs [m]
      real(wp), intent(in) :: slack
      real(wp) :: approach, gap

      gap = view%gap + slack
      approach = -dot_product(view%normal, near%travel(:, corner) - near%travel(:, edge))
      if (approach*huge(1.0_wp)**0.5_wp > abs(gap)) then
         crossing_time = gap/approach
      else
         crossing_time = sign(huge(1.0_wp), gap)
      end if
   end function crossing_time

   !> Distance from the ends of an edge within which a corner coincides with them [m]
   pure function meeting_zone(near, corner, edge) result(zone)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: corner, edge
      real(wp) :: zone(2)  !! At the start and at the end of the edge: (2) [m]

      associate (length => near%outline%length)
         zone = met*min(length(edge), length(corner), length(near%outline%previous(corner)))
      end associate
   end function meeting_zone

   !> True if a contact was closed before
   pure logical function was_closed(near, corner, edge)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: corner, edge
      integer(int64) :: key
      integer :: place

      key = contact_key(corner, edge, size(near%vertex, 2))
      place = place_in(near%closed, key)
      was_closed = .false.
      if (place <= size(near%closed)) was_closed = near%closed(place) == key
   end function was_closed

   !> Add the joint of one corner and one edge
   pure subroutine add_single(near, corner, edge, edge_side, taken, list)
      type(neighbourhood_t), intent(in) :: near
      integer, intent(in) :: corner, edge, edge_side
      type(key_set_t), intent(inout) :: taken
      type(joint_list_t), intent(inout) :: list
      type(joint_t) :: joint
      integer :: pair(2)

      joint%n_contact = 1
      joint%contact(1) = contact_t(corner, edge, near%outline%next(edge), edge_side=edge_side)
      joint%contact(1)%share = 1.0_wp
      joint%contact(2) = joint%contact(1)
      joint%contact(2)%share = 0.0_wp
      call add_key(taken, contact_key(corner, edge, size(near%vertex, 2)))
      pair = merge([edge, corner], [corner, edge], edge_side == 1)
      call add_joint(near, pair, joint, list)
   end subroutine add_single

   !> Append a joint to the list
   pure subroutine add_joint(near, pair, joint, list)
      type(neighbourhood_t), intent(in) :: near
      !> A corner or edge of the first block and one of the second: (2)
      integer, intent(in) :: pair(2)
      type(joint_t), intent(inout) :: joint  !! The joint; its blocks are set
      type(joint_list_t), intent(inout) :: list
      type(joint_piece_t), allocatable :: more(:)
      integer :: i, k

      joint%block = near%outline%block(pair)
      joint%found = .true.
      k = list%n/most_joints + 1
      if (.not. allocated(list%piece)) allocate (list%piece(16))
      if (k > size(list%piece)) then
         allocate (more(2*k))
         do i = 1, k - 1
            call move_alloc(list%piece(i)%joint, more(i)%joint)
         end do
         call move_alloc(more, list%piece)
      end if
      if (.not. allocated(list%piece(k)%joint)) allocate (list%piece(k)%joint(most_joints))
      list%n = list%n + 1
      list%piece(k)%joint(list%n - (k - 1)*most_joints) = joint
   end subroutine add_joint

   !> Move all joints out of a list
   pure subroutine take_joints(list, joint)
      type(joint_list_t), intent(inout) :: list            !! The list, empty afterwards
      type(joint_t), allocatable, intent(out) :: joint(:)  !! The joints: (n)
      integer :: i, n

      allocate (joint(list%n))
      do i = 1, list%n, most_joints
         n = min(most_joints, list%n - i + 1)
         associate (piece => list%piece(i/most_joints + 1))
            joint(i:i + n - 1) = piece%joint(:n)
            deallocate (piece%joint)
         end associate
      end do
      list%n = 0
   end subroutine take_joints
end module dda_entrance
