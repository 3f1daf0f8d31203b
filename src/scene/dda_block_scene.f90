!> Scene from a block plan; water pressure becomes forces at the corners
module dda_block_scene
   use dda_block_input, only : block_plan_t, unsupported_block
   use dda_block_system, only : forget_rest, new_block_system
   use dda_boundary, only : boundary_t, loaded_point_t
   use dda_box_tree, only : box_tree_t, find_boxes, new_box_tree
   use dda_contact_search, only : new_joint_search
   use dda_contact_transfer, only : search_contacts
   use dda_kinds, only : wp
   use dda_material, only : friction_coefficient, joint_law_t, material_t, no_slip_deg
   use dda_outline, only : outline_t
   use dda_polygon, only : depth_in
   use dda_scene, only : scene_t
   use dda_sort, only : sorted_order
   use dda_vector, only : cross
   use dda_water, only : edge_forces, water_t
   implicit none
   private

   public :: base_t, block_scene, floating_block, lacks_friction

   !> Distance of a point on an edge, over its length
   real(wp), parameter :: touching = 1.0e-8_wp
   !> Interpolated times between two of the file, for forces that are quadratic in the water level
   integer, parameter :: between = 32

   !> Properties of the deck for all blocks and joints
   type :: base_t
      type(material_t) :: material      !! Material of the blocks
      real(wp) :: unit_weight = 0.0_wp  !! Weight per volume [N/m3]
      !> Acceleration of gravity, for materials with their own density [m/s2]
      real(wp) :: gravity = 9.81_wp
      !> Friction angle, cohesion and tensile strength of the joints, residual friction angle, slip
      !> over which strength is lost: (5) [deg, Pa, Pa, deg, m]
      real(wp) :: law(5) = [50.0_wp, 0.0_wp, 0.0_wp, 90.0_wp, 0.0_wp]
      real(wp) :: water_rise = 0.0_wp  !! Rise of all piezometric lines [m]
   end type base_t

contains

   !> Add the water forces to the loaded points
   pure subroutine add_water_loads(plan, rise, boundary)
      type(block_plan_t), intent(in) :: plan
      real(wp), intent(in) :: rise  !! Rise of all piezometric lines [m]
      type(boundary_t), intent(inout) :: boundary
      type(loaded_point_t), allocatable :: point(:)
      real(wp), allocatable :: force(:, :, :), time(:), part(:, :)
      logical, allocatable :: covered(:)
      integer, allocatable :: start(:)
      type(box_tree_t) :: tree
      integer :: b, e, i, k, n, next

      if (size(plan%water) == 0) return
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

   !> Times of the water forces
   pure subroutine times_of(water, time)
      type(water_t), intent(in) :: water
      real(wp), allocatable, intent(out) :: time(:)  !! The times: (n) [s]
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

   !> Rise of a piezometric line at a time [m]
   pure real(wp) function rise_at(water, time)
      type(water_t), intent(in) :: water
      real(wp), intent(in) :: time  !! The time [s]
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

   !> Add the pressure on a part of an edge to the forces at both ends of the edge
   pure subroutine add_part(plan, water, rise, time, part, covered, edge, at_start, at_end)
      type(block_plan_t), intent(in) :: plan
      type(water_t), intent(in) :: water
      real(wp), intent(in) :: rise, time(:)
      real(wp), intent(in) :: part(4)  !! Ends of the part: (4) [m]
      logical, intent(in) :: covered   !! True if another block covers the part: a joint
      real(wp), intent(in) :: edge(4)  !! Ends of the edge: (4) [m]
      !> Receives the force at the start of the edge: (2, n) [N/m]
      real(wp), intent(inout) :: at_start(:, :)
      real(wp), intent(inout) :: at_end(:, :)  !! Receives the force at its end: (2, n) [N/m]
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

   !> Tree of the bounding boxes of all blocks
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

   !> Divide an edge at the corners of other blocks on it, and find the parts that are joints
   pure subroutine split_edge(plan, tree, block, edge, part, covered)
      type(block_plan_t), intent(in) :: plan
      type(box_tree_t), intent(in) :: tree
      integer, intent(in) :: block                      !! Block of the edge
      real(wp), intent(in) :: edge(4)
      real(wp), allocatable, intent(out) :: part(:, :)  !! Ends of the parts: (4, n) [m]
      logical, allocatable, intent(out) :: covered(:)   !! True for covered parts: (n)
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

   !> Make the scene of a plan with its points; other settings must be present
   pure subroutine block_scene(plan, base, scene)
      type(block_plan_t), intent(in) :: plan
      type(base_t), intent(in) :: base       !! Properties of the deck for all blocks and joints
      type(scene_t), intent(inout) :: scene  !! The scene; its settings must be set
      type(joint_law_t), allocatable :: law(:, :)
      type(material_t), allocatable :: material(:)
      real(wp), allocatable :: unit_weight(:)
      integer :: b

      call materials_of(plan, base, material, unit_weight)
      allocate (law, source=laws_of(plan, base, size(material)))
      do b = 1, size(material)
         law(:, b)%strength = min(material%strength, material(b)%strength)
      end do
      scene%settings%boundary = plan%boundary
      scene%origin = plan%origin
      call add_water_loads(plan, base%water_rise, scene%settings%boundary)
      associate (system => scene%system)
         system = new_block_system(plan%first_vertex, plan%vertex, plan%fixed, base%material)
         deallocate (system%materials)
         allocate (system%materials, source=material)
         system%material = plan%material
         do b = 1, size(plan%fixed)
            system%density(b) = material(plan%material(b))%density
            system%unit_weight(b) = unit_weight(plan%material(b))
         end do
         system%velocity(:3, plan%starts) = plan%start(:3, :)
         system%stress(:, plan%starts) = plan%start(4:, :)
         system%initial_stress(:, plan%starts) = plan%start(4:, :)
         call forget_rest(system)
         if (allocated(plan%boundary%bar)) then
            allocate (system%bar(size(plan%boundary%bar)))
            system%bar%force = plan%boundary%bar%prestress
         end if
         scene%contacts%searched = .true.
         scene%contacts%search = new_joint_search(system, law, plan%tolerance)
         ! dynamic runs keep the gaps of the drawing, which close by motion
         call search_contacts(system, scene%contacts, closes_gaps=.not. &
            & (scene%settings%dynamic .and. scene%settings%current))
         ! a run in current geometry makes the outline again
         scene%contacts%search%outline = outline_t()
      end associate
      allocate (scene%joint_angle_deg(0))
   end subroutine block_scene

   !> The first movable block without a chain of joints to a fixed one or to a restrained point; 0
   !> if there is none
   pure integer function floating_block(scene)
      type(scene_t), intent(in) :: scene
      logical :: fixed(size(scene%system%area))
      integer, allocatable :: pair(:, :)
      integer :: i, n

      fixed = scene%system%equation == 0
      if (allocated(scene%settings%boundary%held)) then
         do i = 1, size(scene%settings%boundary%held)
            fixed(scene%settings%boundary%held(i)%block) = .true.
         end do
      end if
      n = size(scene%contacts%joint)
      allocate (pair(2, n))
      do i = 1, n
         pair(:, i) = scene%contacts%joint(i)%block
      end do
      if (allocated(scene%settings%boundary%bar)) then
         do i = 1, size(scene%settings%boundary%bar)
            associate (block => scene%settings%boundary%bar(i)%block)
               if (all(block > 0)) pair = reshape([pair, block], [2, size(pair, 2) + 1])
               if (any(block == 0)) fixed(maxval(block)) = .true.
            end associate
         end do
      end if
      floating_block = unsupported_block(fixed, pair)
   end function floating_block

   !> Materials by number; missing properties are those of the deck
   pure subroutine materials_of(plan, base, material, unit_weight)
      type(block_plan_t), intent(in) :: plan
      type(base_t), intent(in) :: base
      type(material_t), allocatable, intent(out) :: material(:)  !! The materials: (n_material)
      !> Weight per volume of each: (n_material) [N/m3]
      real(wp), allocatable, intent(out) :: unit_weight(:)
      integer :: i, n

      n = max(1, maxval(plan%material))
      if (size(plan%materials) > 0) n = max(n, maxval(plan%materials%number))
      allocate (material(n), source=base%material)
      allocate (unit_weight(n), source=base%unit_weight)
      do i = 1, size(plan%materials)
         associate (own => plan%materials(i), m => plan%materials(i)%number)
            if (own%given(1)) then
               material(m)%density = own%value(1)
               unit_weight(m) = own%value(1)*base%gravity
            end if
            if (own%given(2)) unit_weight(m) = own%value(2)
            if (own%given(3)) material(m)%young = own%value(3)
            if (own%given(4)) material(m)%poisson = own%value(4)
            if (own%given(5)) material(m)%strength = own%value(5)
         end associate
      end do
   end subroutine materials_of

   !> Laws of the joints between any two materials
   pure function laws_of(plan, base, n) result(law)
      type(block_plan_t), intent(in) :: plan
      type(base_t), intent(in) :: base
      integer, intent(in) :: n        !! Number of materials
      type(joint_law_t) :: law(n, n)  !! The laws: (n, n)
      real(wp) :: value(5)
      integer :: i

      law = law_of(base%law)
      do i = 1, size(plan%laws)
         associate (pair => plan%laws(i)%material)
            if (any(pair > n)) cycle
            value = merge(plan%laws(i)%value, base%law, plan%laws(i)%given)
            law(pair(1), pair(2)) = law_of(value)
            law(pair(2), pair(1)) = law(pair(1), pair(2))
         end associate
      end do
   end function laws_of

   !> True if blocks may touch whose materials have no friction in the plan
   pure logical function lacks_friction(plan)
      type(block_plan_t), intent(in) :: plan
      logical, allocatable :: given(:, :), moves(:)
      integer, allocatable :: blocks(:)
      integer :: b, i, j, n

      n = max(maxval(plan%material), maxval(plan%laws%material(1)), maxval(plan%laws%material(2)))
      allocate (given(n, n), source=.false.)
      do i = 1, size(plan%laws)
         associate (pair => plan%laws(i)%material)
            given(pair(1), pair(2)) = given(pair(1), pair(2)) .or. plan%laws(i)%given(1)
            given(pair(2), pair(1)) = given(pair(1), pair(2))
         end associate
      end do
      allocate (blocks(n), source=0)
      allocate (moves(n), source=.false.)
      do b = 1, size(plan%material)
         blocks(plan%material(b)) = blocks(plan%material(b)) + 1
         moves(plan%material(b)) = moves(plan%material(b)) .or. .not. plan%fixed(b)
      end do
      lacks_friction = .false.
      do j = 1, n
         do i = 1, j
            ! requires two blocks, not both fixed
            if (merge(blocks(i) < 2, min(blocks(i), blocks(j)) == 0, i == j)) cycle
            if (.not. given(i, j) .and. (moves(i) .or. moves(j))) lacks_friction = .true.
         end do
      end do
   end function lacks_friction

   !> Law of joints that may open
   pure type(joint_law_t) function law_of(value) result(law)
      !> Friction angle, cohesion, tensile strength, residual friction angle, slip over which
      !> strength is lost: (5) [deg, Pa, Pa, deg, m]
      real(wp), intent(in) :: value(5)

      ! an open joint must not carry unlimited friction
      law%friction = friction_coefficient(min(value(1), no_slip_deg))
      law%cohesion = value(2)
      law%tension = value(3)
      if (value(4) < value(1)) law%residual = friction_coefficient(value(4))
      law%slip_length = value(5)
   end function law_of

end module dda_block_scene
