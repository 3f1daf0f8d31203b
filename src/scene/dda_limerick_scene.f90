!> Model of Shi's scheme for a deck or a file of blocks
module dda_limerick_scene
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : boundary_t, held_point_t, measured_point_t
   use dda_deck, only : deck_t, number_or
   use dda_error, only : error_t, fatal_error
   use dda_key_names, only : analysis_collapse_displacement, analysis_max_displacement_ratio, &
      & analysis_penalty_ratio, analysis_steps, analysis_time_step, arch_abutment_overhang, &
      & arch_abutment_size, arch_radius, limerick_auto_penalty, limerick_close_ratio, &
      & limerick_contact_damping, limerick_dynamic, limerick_gravity_steps, limerick_open_ratio, &
      & limerick_overlap_deg, limerick_penetration_ratio, limerick_rotation, &
      & limerick_stiffness_ratio, scene_kind
   use dda_key_value, only : deck_value_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_constants_t
   use dda_limerick_model, only : finite_law, half_size, limerick_model_t
   use dda_cut_model, only : bond_joint
   use dda_line_scene, only : law_of_joint, points_of_lines
   use dda_scene, only : scene_t
   use dda_settings, only : load_direction
   use dda_text, only : to_text
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: abutment_depth, check_limerick_blocks, limerick_scene, set_constants, widen

   !> Default depth of abutments over the radius; half size 14.9 m for a radius of 10 m
   real(wp), parameter :: usual_depth = 0.43_wp
   !> Default displacement that means collapse, over the radius or half size
   real(wp), parameter :: usual_collapse = 0.05_wp

   !> Position of restraints from the corners towards the middle of a block
   real(wp), parameter :: inset = 0.3_wp

contains

   !> Make the model of a deck
   pure subroutine limerick_scene(deck, scene, model)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(limerick_model_t), intent(out) :: model
      real(wp) :: acceleration

      if (allocated(deck%file_analysis)) model%constants = deck%file_analysis%limerick_constants_t
      select case (deck%value(scene_kind)%text)
      case ("arch")
         call arch_model(deck, scene, model)
         model%constants%collapse_displacement = usual_collapse*deck%value(arch_radius)%number
      case ("lines")
         call lines_model(deck, scene, model)
         model%constants%collapse_displacement = usual_collapse*half_size(model)
      case ("blocks")
         call blocks_model(deck%plan, scene, model)
         model%constants%collapse_displacement = usual_collapse*half_size(model)
      end select
      model%load_direction = load_direction(scene%settings)
      call set_constants(deck, model%constants)
      if (allocated(deck%file_analysis) .or. .not. model%constants%auto_time_step) return
      acceleration = norm2(model%load_direction)*model%material(1)%unit_weight &
         & /model%material(1)%density
      if (acceleration > 0.0_wp) model%constants%time_step = sqrt(2.0_wp &
         & *model%constants%max_displacement_ratio*half_size(model)/acceleration)
   end subroutine limerick_scene

   !> Model of an arch between its abutments
   pure subroutine arch_model(deck, scene, model)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene  !! Its scene; the springings are its last two blocks
      !> The model; all parts except the direction of gravity are set
      type(limerick_model_t), intent(inout) :: model
      integer :: b, i, n, nv

      n = size(scene%system%area) - 2
      nv = scene%system%first_vertex(n + 1) - 1
      allocate (model%first_vertex, source=scene%system%first_vertex)
      allocate (model%vertex, source=scene%system%vertex)
      allocate (model%edge_law(size(model%vertex, 2)), model%block_material(n + 2), &
         & model%kind(n + 2), source=1)
      allocate (model%boundary%held(8), model%boundary%loaded(0), model%boundary%measured(0))
      allocate (model%material(1))
      model%material(1)%material_t = scene%system%materials(1)
      model%material(1)%unit_weight = scene%system%unit_weight(1)
      do b = 1, 2
         associate (abutment => model%vertex(:, nv + 4*b - 3:nv + 4*b), &
            & held => model%boundary%held(4*b - 3:4*b))
            call widen(deck, abutment)
            held%block = n + b
            do i = 1, 2
               held%point(i) = inner_points(abutment(i, :))
            end do
         end associate
      end do
      ! the first law is that of all joints; the second that of springings without slip, at the
      ! faces of the abutments and the adjacent voussoirs
      allocate (model%law(1, 2))
      model%law(1, :) = finite_law(scene%contacts%law(scene%contacts%joint([2, 1])%law))
      i = model%first_vertex(n)
      model%edge_law([nv + 4, nv + 8, model%first_vertex(2) - 1, i + (nv + 1 - i)/2 - 1]) = 2
   end subroutine arch_model

   !> Depth of the abutments, normal to the springing joint [m]
   pure real(wp) function abutment_depth(deck)
      type(deck_t), intent(in) :: deck

      abutment_depth = number_or(deck, arch_abutment_size, &
         & usual_depth*deck%value(arch_radius)%number)
   end function abutment_depth

   !> Enlarge an abutment as given in the deck; it extends beyond the joint at both ends
   pure subroutine widen(deck, vertex)
      type(deck_t), intent(in) :: deck
      !> Corners, counter-clockwise; the last edge contains the springing joint: (2, 4) [m]
      real(wp), intent(inout) :: vertex(:, :)
      real(wp) :: depth, overhang, tangent(2), outward(2)

      depth = abutment_depth(deck)
      overhang = number_or(deck, arch_abutment_overhang, depth)
      tangent = along(vertex(:, 1), vertex(:, 4))
      outward = depth*right_normal(tangent)
      vertex(:, 1) = vertex(:, 1) - overhang*tangent
      vertex(:, 4) = vertex(:, 4) + overhang*tangent
      vertex(:, 2) = vertex(:, 1) + outward
      vertex(:, 3) = vertex(:, 4) + outward
   end subroutine widen

   !> Set the constants of the scheme that the deck gives
   pure subroutine set_constants(deck, constants)
      type(deck_t), intent(in) :: deck
      type(limerick_constants_t), intent(inout) :: constants  !! The constants; others are unchanged

      call take(deck%value(limerick_close_ratio), constants%close_ratio)
      call take(deck%value(limerick_open_ratio), constants%open_ratio)
      call take(deck%value(limerick_penetration_ratio), constants%penetration_ratio)
      call take(deck%value(limerick_overlap_deg), constants%overlap_deg)
      call take(deck%value(limerick_stiffness_ratio), constants%stiffness_ratio)
      call take(deck%value(limerick_contact_damping), constants%contact_damping)
      call take(deck%value(analysis_penalty_ratio), constants%penalty_factor)
      call take(deck%value(analysis_max_displacement_ratio), constants%max_displacement_ratio)
      call take(deck%value(analysis_collapse_displacement), constants%collapse_displacement)
      call take(deck%value(analysis_time_step), constants%time_step)
      if (deck%value(analysis_time_step)%given) constants%auto_time_step = .false.
      constants%max_steps = nint(number_or(deck, analysis_steps, real(constants%max_steps, wp)))
      if (deck%value(limerick_gravity_steps)%given) &
         & constants%gravity_steps = nint(deck%value(limerick_gravity_steps)%number)
      if (deck%value(limerick_auto_penalty)%given) constants%auto_penalty = &
         & deck%value(limerick_auto_penalty)%flag
      if (deck%value(limerick_dynamic)%given) constants%dynamic = deck%value(limerick_dynamic)%flag
      if (deck%value(limerick_rotation)%given) &
         & constants%exact_rotation = deck%value(limerick_rotation)%text == "exact"
   end subroutine set_constants

   !> Set a number if the deck gives it
   pure subroutine take(value, number)
      type(deck_value_t), intent(in) :: value
      real(wp), intent(inout) :: number  !! The number; unchanged if the deck does not give it

      if (value%given) number = value%number
   end subroutine take

   !> Model of the blocks from a deck's files, without constants. The corners of the scene's joints
   !> are its last monitoring points
   pure subroutine lines_model(deck, scene, model)
      type(deck_t), intent(in) :: deck  !! The deck of one case, with its blocks; checked
      type(scene_t), intent(in) :: scene
      type(limerick_model_t), intent(inout) :: model
      integer :: j, n

      allocate (model%first_vertex, source=deck%cut%first_vertex)
      allocate (model%vertex, source=deck%cut%vertex)
      allocate (model%edge_law, source=deck%cut%edge_joint)
      allocate (model%block_material, source=scene%system%material)
      allocate (model%kind(size(model%block_material)), source=1)
      call set_materials(deck, scene, model)
      n = max(1, maxval(model%edge_law))
      allocate (model%law(1, n + 1))
      do j = 1, n
         model%law(1, j) = finite_law(law_of_joint(deck, j))
      end do
      model%law(1, n + 1) = finite_law(law_of_joint(deck, bond_joint))
      where (model%edge_law == bond_joint) model%edge_law = n + 1
      call add_corners(deck, scene, model%boundary)
   end subroutine lines_model

   !> Set materials with their weights and initial states
   pure subroutine set_materials(deck, scene, model)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(limerick_model_t), intent(inout) :: model  !! The model; its materials are set
      integer :: b, m

      allocate (model%material(size(scene%system%materials)))
      do m = 1, size(model%material)
         model%material(m)%material_t = scene%system%materials(m)
         if (.not. allocated(deck%file_analysis)) cycle
         associate (listed => deck%file_analysis%material(m))
            ! heights are relative to zero in the file, here to the origin of the cut
            model%material(m)%stress = listed%stress &
               & + listed%stress_gradient*deck%cut%scale%origin(2)
            model%material(m)%stress_gradient = listed%stress_gradient
            model%material(m)%velocity = listed%velocity
         end associate
      end do
      do b = 1, size(model%block_material)
         model%material(model%block_material(b))%unit_weight = scene%system%unit_weight(b)
      end do
   end subroutine set_materials

   !> Restraints, loads and monitoring points. The corners of the scene's blocks are the last
   !> monitoring points, from which the state of joints is computed
   pure subroutine add_corners(deck, scene, boundary)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene  !! The scene; edges that coincide in part are split there
      type(boundary_t), intent(out) :: boundary
      type(measured_point_t), allocatable :: measured(:)
      integer :: b, n, v

      call points_of_lines(deck, spread(.false., 1, size(deck%cut%area)), boundary)
      if (allocated(scene%settings%boundary%bar)) boundary%bar = scene%settings%boundary%bar
      n = size(boundary%measured)
      associate (system => scene%system)
         allocate (measured(n + size(system%vertex, 2)))
         measured(:n) = boundary%measured
         do b = 1, size(system%area)
            do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
               measured(n + v) = measured_point_t(b, system%vertex(:, v))
            end do
         end do
      end associate
      call move_alloc(measured, boundary%measured)
   end subroutine add_corners

   !> Model of a block plan, without constants. Each block has its own material because of its own
   !> stress and velocity. The first material, which the first step uses, is that of a movable block
   pure subroutine blocks_model(plan, scene, model)
      type(block_plan_t), intent(in) :: plan
      type(scene_t), intent(in) :: scene
      !> The model; all parts except the direction of gravity are set
      type(limerick_model_t), intent(inout) :: model
      integer :: b, n

      n = size(plan%fixed)
      allocate (model%first_vertex, source=plan%first_vertex)
      allocate (model%vertex, source=plan%vertex)
      allocate (model%law, source=scene%contacts%search%law)
      allocate (model%kind, source=plan%material)
      allocate (model%edge_law(size(plan%vertex, 2)))
      allocate (model%material(n + 1), model%block_material(n))
      do b = 1, n
         model%edge_law(plan%first_vertex(b):plan%first_vertex(b + 1) - 1) = plan%material(b)
         model%block_material(b) = b + 1
         associate (material => model%material(b + 1))
            material%material_t = scene%system%materials(plan%material(b))
            material%unit_weight = scene%system%unit_weight(b)
         end associate
      end do
      do b = 1, size(plan%starts)
         associate (block => plan%starts(b), material => model%material(plan%starts(b) + 1))
            material%stress = plan%start(4:, b)
            if (.not. plan%fixed(block)) material%velocity = plan%start(:3, b)
         end associate
      end do
      model%material(1) = model%material(1 + max(1, findloc(plan%fixed, .false., dim=1)))
      model%loads_go_on = .false.
      model%boundary = scene%settings%boundary
      call take_points(plan, scene%settings%load_factor, model%boundary)
   end subroutine blocks_model

   !> Points of the plan, and fixed points of its fixed blocks
   pure subroutine take_points(plan, load_factor, boundary)
      type(block_plan_t), intent(in) :: plan
      real(wp), intent(in) :: load_factor          !! Factor of live loads
      type(boundary_t), intent(inout) :: boundary  !! The points of the scene; points may be added
      type(held_point_t), allocatable :: held(:)
      integer :: b, i, n, v

      if (.not. allocated(boundary%held)) allocate (boundary%held(0))
      if (.not. allocated(boundary%loaded)) allocate (boundary%loaded(0))
      if (.not. allocated(boundary%measured)) allocate (boundary%measured(0))
      do i = 1, size(boundary%loaded)
         if (boundary%loaded(i)%live) &
            & boundary%loaded(i)%force%value = load_factor*boundary%loaded(i)%force%value
      end do
      n = size(boundary%held)
      allocate (held(n + size(plan%vertex, 2)))
      held(:n) = boundary%held
      do b = 1, size(plan%fixed)
         if (.not. plan%fixed(b)) cycle
         associate (first => plan%first_vertex(b), last => plan%first_vertex(b + 1) - 1)
            held(n + 1:n + 1 + last - first)%block = b
            do v = 1, 2
               held(n + 1:n + 1 + last - first)%point(v) = inner_points(plan%vertex(v, first:last))
            end do
            n = n + 1 + last - first
         end associate
      end do
      boundary%held = held(:n)
   end subroutine take_points

   !> Coordinates of the fixed points of a block: its corners, shifted towards their mean
   pure function inner_points(corner) result(point)
      real(wp), intent(in) :: corner(:)  !! One coordinate of all corners: (n) [m]
      real(wp) :: point(size(corner))    !! The same coordinate of the points: (n) [m]

      point = (1.0_wp - inset)*corner + inset*sum(corner)/real(size(corner), wp)
   end function inner_points

   !> Check that Shi's scheme can run a plan: it has no ground motion or absorbing boundaries,
   !> restrains points in both directions, and starts every static step at rest
   pure subroutine check_limerick_blocks(plan, file, dynamic, error)
      type(block_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: file              !! Name of the file
      logical, intent(in) :: dynamic                    !! True to keep velocities
      type(error_t), allocatable, intent(out) :: error  !! Allocated for an unsupported item
      integer :: b, i

      if (allocated(plan%boundary%base_acceleration%time)) call fatal_error(error, &
         & "mode = 'limerick' has no ground motion; remove it or " &
         & //"choose mode = 'dynamic'", file, plan%ground_line)
      if (allocated(error)) return
      if (allocated(plan%boundary%absorbing)) call fatal_error(error, &
         & "mode = 'limerick' has no absorbing boundaries; remove this line " &
         & //"or choose mode = 'dynamic'", file, plan%boundary%absorbing(1)%line)
      if (allocated(error)) return
      do i = 1, size(plan%starts)
         if (dynamic .or. .not. any(abs(plan%start(:3, i)) > 0.0_wp)) cycle
         b = plan%starts(i)
         call fatal_error(error, "mode = 'limerick' starts every static step at rest, but block " &
            & //to_text(b)//" has a velocity; remove it or set limerick%dynamic = .true.", file, &
            & plan%line(b))
         return
      end do
      if (.not. allocated(plan%boundary%held)) return
      do i = 1, size(plan%boundary%held)
         associate (held => plan%boundary%held(i))
            if (allocated(held%path%time)) then
               call fatal_error(error, "mode = 'limerick' has no prescribed displacements; " &
                  & //"remove the line or choose another mode", file, held%line)
            else if (.not. all(held%along)) then
               call fatal_error(error, "mode = 'limerick' restrains points along x and y; " &
                  & //"remove the direction or choose another mode", file, held%line)
            end if
         end associate
         if (allocated(error)) return
      end do
   end subroutine check_limerick_blocks
end module dda_limerick_scene
