!> The model of the original program that files of lines describe
module dda_limerick_lines
   use dda_boundary, only : boundary_t, constant_history, history_t, measured_point_t
   use dda_cut_model, only : point_kind
   use dda_deck, only : deck_t
   use dda_kinds, only : wp
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_limerick_model, only : finite_law, limerick_constants_t, limerick_model_t
   use dda_line_scene, only : law_of_joint
   use dda_scene, only : scene_t
   implicit none
   private

   public :: lines_model, take_constants

contains

   !> The model of the blocks that a deck's files make, without its constants. The corners of the
   !> scene's joints are measured points, the last ones
   pure subroutine lines_model(deck, scene, model)
      !> The deck of one case, with its blocks; checked
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      !> The model; its parts but for the direction of the weight are set
      type(limerick_model_t), intent(inout) :: model
      integer :: j

      allocate (model%first_vertex, source=deck%cut%first_vertex)
      allocate (model%vertex, source=deck%cut%vertex)
      allocate (model%edge_law, source=deck%cut%edge_joint)
      allocate (model%block_material, source=scene%system%material)
      allocate (model%kind(size(model%block_material)), source=1)
      call set_materials(deck, scene, model)
      allocate (model%law(1, max(1, maxval(model%edge_law))))
      do j = 1, size(model%law)
         model%law(1, j) = finite_law(law_of_joint(deck, j))
      end do
      call take_points(deck, scene, model%boundary)
   end subroutine lines_model

   !> Materials with their weights and states at the beginning
   pure subroutine set_materials(deck, scene, model)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      !> The model; its materials are set
      type(limerick_model_t), intent(inout) :: model
      integer :: b, m

      allocate (model%material(size(scene%system%materials)))
      do m = 1, size(model%material)
         model%material(m)%material_t = scene%system%materials(m)
         if (.not. allocated(deck%file_analysis)) cycle
         associate (listed => deck%file_analysis%material(m))
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

   !> Points that are held, loaded and measured; among the last the corners of the scene's blocks,
   !> from which its joints are told
   pure subroutine take_points(deck, scene, boundary)
      type(deck_t), intent(in) :: deck
      !> The scene; edges that lie together in part are parted there
      type(scene_t), intent(in) :: scene
      type(boundary_t), intent(out) :: boundary
      integer :: n(3), b, i, v

      associate (point => deck%cut%point, system => scene%system)
         allocate (boundary%held(count(point%kind == point_kind%fixed)))
         allocate (boundary%loaded(count(point%kind == point_kind%load)))
         allocate (boundary%measured(count(point%kind == point_kind%measured) &
            & + size(system%vertex, 2)))
         n = 0
         do i = 1, size(point)
            if (point(i)%kind == point_kind%fixed) then
               n(1) = n(1) + 1
               boundary%held(n(1))%block = point(i)%block
               boundary%held(n(1))%point = point(i)%place
            else if (point(i)%kind == point_kind%load) then
               n(2) = n(2) + 1
               boundary%loaded(n(2))%block = point(i)%block
               boundary%loaded(n(2))%point = point(i)%place
               boundary%loaded(n(2))%force = force_of(deck, point(i)%source)
            else if (point(i)%kind == point_kind%measured) then
               n(3) = n(3) + 1
               boundary%measured(n(3)) = measured_point_t(point(i)%block, point(i)%place)
            end if
         end do
         if (allocated(scene%settings%boundary%bar)) boundary%bar = scene%settings%boundary%bar
         do b = 1, size(system%area)
            do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
               boundary%measured(n(3) + v) = measured_point_t(b, system%vertex(:, v))
            end do
         end do
      end associate
   end subroutine take_points

   !> Force on a load point; one of which the analysis says nothing has none
   pure type(history_t) function force_of(deck, source)
      type(deck_t), intent(in) :: deck
      !> Number of the load point
      integer, intent(in) :: source

      force_of = constant_history([0.0_wp, 0.0_wp])
      if (.not. allocated(deck%file_analysis)) return
      if (source > size(deck%file_analysis%load)) return
      associate (record => deck%file_analysis%load(source)%record)
         force_of%time = record(1, :)
         force_of%value = record(2:3, :)
      end associate
   end function force_of

   !> Take the constants of the scheme that an analysis file gives
   pure subroutine take_constants(analysis, constants)
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
      constants%contact_damping = analysis%contact_damping
      constants%gravity_steps = analysis%gravity_steps
      constants%gravity_tolerance = analysis%gravity_tolerance
   end subroutine take_constants
end module dda_limerick_lines
