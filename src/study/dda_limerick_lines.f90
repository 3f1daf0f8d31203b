!> The model of the original program that files of lines describe
module dda_limerick_lines
   use dda_cut_model, only : block_point_t, cut_model_t, point_kind
   use dda_deck, only : deck_error, deck_t
   use dda_deck_keys, only : key_index
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_limerick_model, only : limerick_constants_t, limerick_model_t, load_history_t
   use dda_line_scene, only : law_of_joint, line_scene
   use dda_material, only : friction_coefficient
   use dda_scene, only : scene_t
   use dda_settings, only : load_direction
   use dda_text, only : to_text
   implicit none
   private

   public :: lines_model, take_constants, check_limerick_lines

   !> Friction angle of a joint that cannot slide [deg]
   real(wp), parameter :: no_slip_deg = 89.9_wp

contains

   !> The model of the blocks that a deck's files make, without its constants. The corners of the
   !> scene's joints are measured points, the last ones
   pure subroutine lines_model(deck, model)
      !> The deck of one case, with its blocks; checked
      type(deck_t), intent(in) :: deck
      !> The model
      type(limerick_model_t), intent(out) :: model
      type(scene_t) :: scene
      integer :: j

      call line_scene(deck, scene)
      allocate (model%first_vertex, source=deck%cut%first_vertex)
      allocate (model%vertex, source=deck%cut%vertex)
      allocate (model%edge_law, source=deck%cut%edge_joint)
      allocate (model%block_material, source=scene%system%material)
      model%load_direction = load_direction(scene%settings)
      call set_materials(deck, scene, model)
      allocate (model%law(max(1, maxval(model%edge_law))))
      do j = 1, size(model%law)
         model%law(j) = law_of_joint(deck, j)
         if (model%law(j)%no_slip) model%law(j)%friction = friction_coefficient(no_slip_deg)
      end do
      call take_points(deck%cut, point_kind%fixed, model%fixed_point, model%fixed_block)
      call take_points(deck%cut, point_kind%load, model%load_point, model%load_block)
      call take_points(deck%cut, point_kind%measured, model%measured_point, model%measured_block)
      call take_loads(deck, model)
      call follow_corners(scene, model)
   end subroutine lines_model

   !> Materials with their weights and states at the beginning
   pure subroutine set_materials(deck, scene, model)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> The blocks
      type(scene_t), intent(in) :: scene
      !> The model; its materials are set
      type(limerick_model_t), intent(inout) :: model
      integer :: b, m

      allocate (model%material(size(scene%system%materials)))
      do m = 1, size(model%material)
         model%material(m)%material_t = scene%system%materials(m)
         if (.not. allocated(deck%analysis)) cycle
         associate (listed => deck%analysis%material(m))
            ! height counts from zero in the file, here from the origin of the cut
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

   !> The points of one kind
   pure subroutine take_points(cut, kind, place, block)
      !> The blocks
      type(cut_model_t), intent(in) :: cut
      !> One of point_kind
      integer, intent(in) :: kind
      !> Where they are: (2, n) [m]
      real(wp), allocatable, intent(out) :: place(:, :)
      !> Their blocks: (n)
      integer, allocatable, intent(out) :: block(:)
      integer :: i, n

      n = count(cut%point%kind == kind)
      allocate (place(2, n), block(n))
      n = 0
      do i = 1, size(cut%point)
         if (cut%point(i)%kind /= kind) cycle
         n = n + 1
         place(:, n) = cut%point(i)%place
         block(n) = cut%point(i)%block
      end do
   end subroutine take_points

   !> Forces of the load points; those of which the analysis says nothing have none
   pure subroutine take_loads(deck, model)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> The model; its loads are set
      type(limerick_model_t), intent(inout) :: model
      type(block_point_t), allocatable :: point(:)
      integer :: i

      allocate (point, source=pack(deck%cut%point, deck%cut%point%kind == point_kind%load))
      allocate (model%load(size(point)))
      do i = 1, size(point)
         model%load(i) = load_history_t([0.0_wp, 1.0_wp], reshape(spread(0.0_wp, 1, 4), [2, 2]))
         if (.not. allocated(deck%analysis)) cycle
         if (point(i)%source > size(deck%analysis%load)) cycle
         associate (record => deck%analysis%load(point(i)%source)%record)
            model%load(i) = load_history_t(record(1, :), record(2:3, :))
         end associate
      end do
   end subroutine take_loads

   !> Let the run follow the corners of the scene's blocks, from which its joints are told
   pure subroutine follow_corners(scene, model)
      !> The scene; edges that lie together in part are parted there
      type(scene_t), intent(in) :: scene
      !> The model; its measured points are lengthened
      type(limerick_model_t), intent(inout) :: model
      real(wp), allocatable :: place(:, :)
      integer, allocatable :: block(:)
      integer :: n, b

      n = size(model%measured_block)
      allocate (place(2, n + size(scene%system%vertex, 2)), block(n + size(scene%system%vertex, 2)))
      place(:, :n) = model%measured_point
      block(:n) = model%measured_block
      place(:, n + 1:) = scene%system%vertex
      do b = 1, size(scene%system%area)
         block(n + scene%system%first_vertex(b):n + scene%system%first_vertex(b + 1) - 1) = b
      end do
      call move_alloc(place, model%measured_point)
      call move_alloc(block, model%measured_block)
   end subroutine follow_corners

   !> Take the constants of the scheme that an analysis file gives
   pure subroutine take_constants(analysis, constants)
      !> What the file says
      type(limerick_analysis_t), intent(in) :: analysis
      !> The constants; what ends a run is left as it is
      type(limerick_constants_t), intent(inout) :: constants

      constants%close_ratio = analysis%close_limit
      constants%open_ratio = analysis%open_limit
      constants%penetration_ratio = analysis%spring_penetration
      constants%overlap_deg = analysis%overlap_deg
      constants%stiffness_ratio = analysis%shear_ratio
      constants%penalty_factor = analysis%penalty_factor
      constants%auto_penalty = analysis%auto_penalty
      constants%auto_time_step = analysis%auto_time_step
      constants%time_step = analysis%max_time_step
      constants%max_displacement_ratio = analysis%displacement_ratio
      constants%max_steps = analysis%steps
      constants%dynamic = analysis%dynamic
      constants%exact_rotation = analysis%exact_rotation
   end subroutine take_constants

   !> Whether the original's scheme, as it is here, can run the files of a deck
   pure subroutine check_limerick_lines(deck, error)
      !> The deck of a case
      type(deck_t), intent(in) :: deck
      !> What it cannot do
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(deck%analysis)) return
      if (abs(deck%analysis%contact_damping) > 0.0_wp) call deck_error(error, &
         & "scene%analysis: contacts without damping are wanted, found damping of " &
         & //to_text(deck%analysis%contact_damping)//"; remove it", deck, &
         & deck%value(key_index("scene", "analysis"))%place)
   end subroutine check_limerick_lines
end module dda_limerick_lines
