!> Water as forces on the corners of blocks
module dda_water_loads
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : boundary_t, loaded_point_t
   use dda_box_tree, only : box_tree_t, find_boxes, new_box_tree
   use dda_kinds, only : wp
   use dda_polygon, only : depth_in
   use dda_sort, only : sorted_order
   use dda_vector, only : cross
   use dda_water, only : edge_forces, water_t
   implicit none
   private

   public :: add_water_loads

   !> Points nearer to an edge than this share of its length lie on it
   real(wp), parameter :: touching = 1.0e-8_wp
   !> Records between two of the file, where the force grows with the square of the level
   integer, parameter :: between = 32

contains

   !> Add the forces of all water to the loaded points
   pure subroutine add_water_loads(plan, rise, boundary)
      type(block_plan_t), intent(in) :: plan
      !> By how much all lines of heads have risen [m]
      real(wp), intent(in) :: rise
      type(boundary_t), intent(inout) :: boundary
      type(loaded_point_t), allocatable :: point(:)
      real(wp), allocatable :: force(:, :, :), time(:), part(:, :)
      logical, allocatable :: covered(:)
      integer, allocatable :: start(:)
      type(box_tree_t) :: tree
      integer :: b, e, i, k, n, next

      call edge_boxes(plan, tree)
      do i = 1, size(plan%water)
         call times_of(plan%water(i), time)
         allocate (force(2, size(time), size(plan%vertex, 2)), source=0.0_wp)
         do b = 1, size(plan%fixed)
            if (plan%fixed(b)) cycle
            do e = plan%first_vertex(b), plan%first_vertex(b + 1) - 1
               next = e + 1
               if (next == plan%first_vertex(b + 1)) next = plan%first_vertex(b)
               call split_edge(plan, tree, b, [plan%vertex(:, e), plan%vertex(:, next)], part, &
                  & covered)
               do k = 1, size(covered)
                  call add_part(plan, plan%water(i), rise, time, part(:, k), covered(k), &
                     & [plan%vertex(:, e), plan%vertex(:, next)], force(:, :, e), &
                     & force(:, :, next))
               end do
            end do
         end do
         start = pack([(k, k=1, size(force, 3))], [(any(abs(force(:, :, k)) > 0.0_wp), &
            & k=1, size(force, 3))])
         n = size(start)
         allocate (point(n))
         do k = 1, n
            point(k)%block = count(plan%first_vertex(:size(plan%fixed)) <= start(k))
            point(k)%point = plan%vertex(:, start(k))
            allocate (point(k)%force%time, source=time)
            allocate (point(k)%force%value, source=force(:, :, start(k)))
         end do
         if (allocated(boundary%loaded)) point = [boundary%loaded, point]
         call move_alloc(point, boundary%loaded)
         deallocate (force)
      end do
   end subroutine add_water_loads

   !> Times at which the forces are recorded
   pure subroutine times_of(water, time)
      type(water_t), intent(in) :: water
      !> The times: (n) [s]
      real(wp), allocatable, intent(out) :: time(:)
      integer :: i, k, n

      n = size(water%time)
      if (n <= 1) then
         allocate (time(1), source=0.0_wp)
         return
      end if
      allocate (time((n - 1)*between + 1))
      do i = 1, n - 1
         do k = 0, between
            time((i - 1)*between + k + 1) = water%time(i) + (water%time(i + 1) - water%time(i)) &
               & *real(k, wp)/real(between, wp)
         end do
      end do
   end subroutine times_of

   !> By how much a line of heads has risen at a time
   pure real(wp) function rise_at(water, time)
      type(water_t), intent(in) :: water
      !> The time [s]
      real(wp), intent(in) :: time
      integer :: i, n

      n = size(water%time)
      rise_at = 0.0_wp
      if (n > 0) rise_at = water%rise(n)
      do i = 2, n
         if (time > water%time(i)) cycle
         rise_at = water%rise(i - 1) + (water%rise(i) - water%rise(i - 1)) &
            & *max(0.0_wp, time - water%time(i - 1))/(water%time(i) - water%time(i - 1))
         return
      end do
   end function rise_at

   !> Add the pressure on a part of an edge to both ends of the edge
   pure subroutine add_part(plan, water, rise, time, part, covered, edge, at_start, at_end)
      type(block_plan_t), intent(in) :: plan
      type(water_t), intent(in) :: water
      real(wp), intent(in) :: rise, time(:)
      !> Ends of the part: (4) [m]
      real(wp), intent(in) :: part(4)
      !> Whether another block lies on it: a joint
      logical, intent(in) :: covered
      !> Ends of the edge: (4) [m]
      real(wp), intent(in) :: edge(4)
      !> Receives the force at the start of the edge: (2, n) [N/m]
      real(wp), intent(inout) :: at_start(:, :)
      !> Receives that at its end: (2, n) [N/m]
      real(wp), intent(inout) :: at_end(:, :)
      real(wp) :: force(2, 2), share(2), along(2)
      integer :: i, k

      along = edge(3:4) - edge(1:2)
      share = [dot_product(part(1:2) - edge(1:2), along), &
         & dot_product(part(3:4) - edge(1:2), along)]/dot_product(along, along)
      do i = 1, size(time)
         force = edge_forces(water, rise + rise_at(water, time(i)), &
            & part + [plan%origin, plan%origin])
         if (covered) force = water%factor*force
         do k = 1, 2
            at_start(:, i) = at_start(:, i) + (1.0_wp - share(k))*force(:, k)
            at_end(:, i) = at_end(:, i) + share(k)*force(:, k)
         end do
      end do
   end subroutine add_part

   !> Boxes of all blocks
   pure subroutine edge_boxes(plan, tree)
      type(block_plan_t), intent(in) :: plan
      type(box_tree_t), intent(out) :: tree
      real(wp) :: low(2, size(plan%fixed)), high(2, size(plan%fixed))
      integer :: b

      do b = 1, size(plan%fixed)
         associate (v => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
            low(:, b) = minval(v, 2)
            high(:, b) = maxval(v, 2)
         end associate
      end do
      call new_box_tree(low, high, tree)
   end subroutine edge_boxes

   !> Parts of an edge between the corners of other blocks on it, and which of them are joints
   pure subroutine split_edge(plan, tree, block, edge, part, covered)
      type(block_plan_t), intent(in) :: plan
      type(box_tree_t), intent(in) :: tree
      !> Block of the edge
      integer, intent(in) :: block
      real(wp), intent(in) :: edge(4)
      !> Ends of the parts: (4, n) [m]
      real(wp), allocatable, intent(out) :: part(:, :)
      !> Whether another block lies on each: (n)
      logical, allocatable, intent(out) :: covered(:)
      integer, allocatable :: near(:)
      real(wp), allocatable :: share(:)
      real(wp) :: along(2), length, outward(2), s, place(2)
      integer :: i, k, n, v

      along = edge(3:4) - edge(1:2)
      length = norm2(along)
      outward = [along(2), -along(1)]/length
      allocate (near(16))
      call find_boxes(tree, min(edge(1:2), edge(3:4)) - touching*length, &
         & max(edge(1:2), edge(3:4)) + touching*length, near, n)
      share = [0.0_wp, 1.0_wp]
      do i = 1, n
         if (near(i) == block) cycle
         do v = plan%first_vertex(near(i)), plan%first_vertex(near(i) + 1) - 1
            place = plan%vertex(:, v) - edge(1:2)
            s = dot_product(place, along)/length**2
            if (s > touching .and. s < 1.0_wp - touching .and. abs(cross(along, place)) &
               & <= touching*length**2) share = [share, s]
         end do
      end do
      share = share(sorted_order(spread(0, 1, size(share)), share))
      allocate (part(4, size(share) - 1), covered(size(share) - 1))
      do k = 1, size(covered)
         part(:, k) = [edge(1:2) + share(k)*along, edge(1:2) + share(k + 1)*along]
         place = 0.5_wp*(part(1:2, k) + part(3:4, k)) + 10.0_wp*touching*length*outward
         covered(k) = .false.
         do i = 1, n
            if (near(i) == block) cycle
            covered(k) = covered(k) .or. depth_in(plan%vertex(:, plan%first_vertex(near(i)): &
               & plan%first_vertex(near(i) + 1) - 1), place) >= 0.0_wp
         end do
      end do
   end subroutine split_edge
end module dda_water_loads
