!> Positions of the blocks of a file, points inside them, and compatible restraints
module dda_block_sites
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : held_point_t, history_t, value_at
   use dda_box_tree, only : box_tree_t, boxes_along, new_box_tree
   use dda_error, only : error_t, fatal_error
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_polygon, only : depth_in, edge_tree
   use dda_small_systems, only : least_squares
   use dda_text, only : to_text
   implicit none
   private

   public :: compare_paths, site_t, add_held, block_at, close_held, depth_of, rivals_at, rounded
   public :: survey

   !> Distance below which positions coincide, over the block size
   real(wp), parameter :: same = 1.0e-9_wp
   !> Number of points per block and direction that restraints are compared with
   integer, parameter :: enough = 16

   !> Permitted distance of a point outside its block, over the block size
   real(wp), parameter :: rounded = 1.0e-4_wp

   !> Positions of the blocks, and the points on them
   type :: site_t
      type(box_tree_t) :: tree  !! Boxes of the blocks, with a margin for rounded coordinates
      real(wp), allocatable :: size_of(:)  !! Diagonals of the blocks: (n_block) [m]
      !> Index of each block's tree of edges, 0 for blocks with few edges: (n_block)
      integer, allocatable :: edges_of(:)
      type(box_tree_t), allocatable :: edges(:)  !! Trees of edges, the first one empty: (0:n)
      !> Number of restrained, loaded and monitoring points
      integer :: n_held = 0, n_loaded = 0, n_measured = 0
      !> Last restrained point of each block with independent information: (n_block)
      integer, allocatable :: last_held(:)
      integer, allocatable :: before(:)  !! Previous such point of the same block: (n_held or more)
   end type site_t

   !> Number of corners above which a block has a tree of its edges
   integer, parameter :: few_corners = 32

contains

   !> Compare a prescribed displacement with those of the same block. A block moves and strains
   !> linearly: along each axis, a linear combination of points has the same linear combination of
   !> displacements
   pure subroutine compare_paths(held, other, more, size_of_block, contradicts, independent)
      type(held_point_t), intent(in) :: held(:)  !! Restrained points: (n)
      integer, intent(in) :: other(:)            !! Independent points of the same block: (n)
      type(held_point_t), intent(in) :: more
      real(wp), intent(in) :: size_of_block  !! Size of the block [m]
      logical, intent(out) :: contradicts    !! True if the displacements are incompatible
      !> True if the point is independent; only such points are compared with later ones
      logical, intent(out) :: independent
      integer, allocatable :: same_axis(:)
      real(wp), allocatable :: row(:, :), share(:)
      integer :: axis, i

      contradicts = .false.
      independent = .false.
      do axis = 1, 2
         if (.not. more%along(axis)) cycle
         same_axis = pack(other, held(other)%along(axis))
         independent = independent .or. size(same_axis) < enough
         if (size(same_axis) == 0) cycle
         row = reshape([(1.0_wp, (held(same_axis(i))%point - more%point)/size_of_block, &
            & i=1, size(same_axis))], [3, size(same_axis)])
         share = least_squares(row, [1.0_wp, 0.0_wp, 0.0_wp], same)
         if (norm2(matmul(row, share) - [1.0_wp, 0.0_wp, 0.0_wp]) > same) then
            independent = .true.
            cycle
         end if
         same_axis = pack(same_axis, abs(share) > 0.0_wp)
         share = pack(share, abs(share) > 0.0_wp)
         contradicts = contradicts .or. &
            & far_from(held, same_axis, share, more, axis, same*size_of_block)
      end do
   end subroutine compare_paths

   !> True if a displacement differs from the combination of others at any time; all are piecewise
   !> linear
   pure logical function far_from(held, other, share, more, axis, tolerance)
      type(held_point_t), intent(in) :: held(:)
      integer, intent(in) :: other(:)   !! Numbers of the other points: (m)
      real(wp), intent(in) :: share(:)  !! Their coefficients: (m)
      type(held_point_t), intent(in) :: more
      integer, intent(in) :: axis        !! Direction, 1 or 2 for x or y
      real(wp), intent(in) :: tolerance  !! Permitted difference [m]
      real(wp), allocatable :: time(:)
      real(wp) :: way(2), off
      integer :: i, k

      allocate (time, source=times_of(more%path))
      do i = 1, size(other)
         time = [time, times_of(held(other(i))%path)]
      end do
      far_from = .false.
      do k = 1, size(time)
         way = value_at(more%path, time(k))
         off = way(axis)
         do i = 1, size(other)
            way = value_at(held(other(i))%path, time(k))
            off = off - share(i)*way(axis)
         end do
         far_from = abs(off) > tolerance
         if (far_from) return
      end do
   end function far_from

   !> Times of a history, none if it is unallocated
   pure function times_of(history) result(time)
      type(history_t), intent(in) :: history
      real(wp), allocatable :: time(:)  !! The times: (n) [s]

      allocate (time(0))
      if (allocated(history%time)) time = history%time
   end function times_of

   !> Compute the positions of the blocks
   pure subroutine survey(plan, site)
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(out) :: site
      real(wp), allocatable :: low(:, :), high(:, :)
      integer :: b, k, n

      n = size(plan%fixed)
      allocate (low(2, n), high(2, n), site%size_of(n))
      allocate (site%last_held(n), site%edges_of(n), source=0)
      allocate (site%edges(0:count(plan%first_vertex(2:) - plan%first_vertex(:n) > few_corners)))
      k = 0
      do b = 1, n
         associate (vertex => plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1))
            low(:, b) = minval(vertex, dim=2)
            high(:, b) = maxval(vertex, dim=2)
            if (size(vertex, 2) > few_corners) then
               k = k + 1
               site%edges_of(b) = k
               call edge_tree(vertex, site%edges(k))
            end if
         end associate
         site%size_of(b) = norm2(high(:, b) - low(:, b))
         low(:, b) = low(:, b) - rounded*site%size_of(b)
         high(:, b) = high(:, b) + rounded*site%size_of(b)
      end do
      call new_box_tree(low, high, site%tree)
   end subroutine survey

   !> Block that contains a point most deeply or on its outline; 0 if there is none
   pure integer function block_at(plan, site, point)
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(in) :: site
      real(wp), intent(in) :: point(2)  !! The point relative to the origin of the plan: (2) [m]
      real(wp) :: deepest, depth
      integer, allocatable :: near(:)
      integer :: i

      block_at = 0
      deepest = -huge(deepest)
      allocate (near, source=boxes_along(site%tree, [point, point]))
      do i = 1, size(near)
         depth = depth_of(plan, site, near(i), point)
         if (depth < -rounded*site%size_of(near(i)) .or. .not. depth > deepest) cycle
         deepest = depth
         block_at = near(i)
      end do
   end function block_at

   !> Other blocks with a point on their outlines, within tolerances
   pure function rivals_at(plan, site, point, block) result(rival)
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(in) :: site
      real(wp), intent(in) :: point(2)
      integer, intent(in) :: block      !! The block of the point
      integer, allocatable :: rival(:)  !! The other blocks: (n)
      integer, allocatable :: near(:)
      real(wp) :: depth, margin
      integer :: i, n

      n = 0
      depth = depth_of(plan, site, block, point)
      allocate (near, source=boxes_along(site%tree, [point, point]))
      do i = 1, size(near)
         if (near(i) == block) cycle
         margin = rounded*minval(site%size_of([near(i), block]))
         if (depth > margin) cycle
         if (depth_of(plan, site, near(i), point) < -margin) cycle
         n = n + 1
         near(n) = near(i)
      end do
      allocate (rival, source=near(:n))
   end function rivals_at

   !> Depth of a point inside a block, negative outside [m]
   pure real(wp) function depth_of(plan, site, block, point)
      type(block_plan_t), intent(in) :: plan
      type(site_t), intent(in) :: site
      integer, intent(in) :: block
      real(wp), intent(in) :: point(2)

      depth_of = depth_in(plan%vertex(:, plan%first_vertex(block): &
         & plan%first_vertex(block + 1) - 1), point, site%edges(site%edges_of(block)))
   end function depth_of

   !> Add a restrained point, if it is compatible with the others of its block
   pure subroutine add_held(held, plan, site, error)
      type(held_point_t), intent(in) :: held
      type(block_plan_t), intent(inout) :: plan
      type(site_t), intent(inout) :: site
      !> Allocated for a moving fixed block, or an incompatible point
      type(error_t), allocatable, intent(out) :: error
      logical :: contradicts, independent

      if (plan%fixed(held%block) .and. allocated(held%path%value)) then
         if (any(abs(held%path%value) > 0.0_wp)) call fatal_error(error, "block " &
            & //to_text(held%block)//" is fixed and cannot have a prescribed displacement")
         if (allocated(error)) return
      end if
      call compare_paths(plan%boundary%held, held_before(site, held%block), held, &
         & site%size_of(held%block), contradicts, independent)
      if (contradicts) call fatal_error(error, &
         & "the prescribed displacement conflicts with the other fixed or " &
         & //"prescribed points of the block")
      if (allocated(error)) return
      if (site%n_held == size(plan%boundary%held)) &
         & call close_held(2*site%n_held + 8, plan%boundary%held)
      site%n_held = site%n_held + 1
      plan%boundary%held(site%n_held) = held
      call make_room(site%before, site%n_held)
      if (.not. independent) return
      site%before(site%n_held) = site%last_held(held%block)
      site%last_held(held%block) = site%n_held
   end subroutine add_held

   !> Independent restrained points of a block
   pure function held_before(site, block) result(list)
      type(site_t), intent(in) :: site
      integer, intent(in) :: block
      integer, allocatable :: list(:)  !! Numbers of the points: (n)
      integer :: i, n

      n = 0
      i = site%last_held(block)
      do while (i > 0)
         n = n + 1
         i = site%before(i)
      end do
      allocate (list(n))
      i = site%last_held(block)
      do n = n, 1, -1
         list(n) = i
         i = site%before(i)
      end do
   end function held_before

   !> Change the length of the list of restrained points
   pure subroutine close_held(n, list)
      integer, intent(in) :: n                                   !! New length
      type(held_point_t), allocatable, intent(inout) :: list(:)  !! The list
      type(held_point_t), allocatable :: other(:)

      if (n == size(list)) return
      allocate (other(n))
      other(:min(n, size(list))) = list(:min(n, size(list)))
      call move_alloc(other, list)
   end subroutine close_held

end module dda_block_sites
