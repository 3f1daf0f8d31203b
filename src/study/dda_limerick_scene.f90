!> The model of the original program that a deck describes: an arch between blocks held by points,
!> or blocks cut from lines
module dda_limerick_scene
   use dda_arch_scene, only : arch_scene
   use dda_deck, only : deck_t, flag_of, integer_of, is_given, real_of, word_of
   use dda_kinds, only : wp
   use dda_limerick_lines, only : lines_model, take_constants
   use dda_limerick_model, only : half_size, limerick_constants_t, limerick_model_t
   use dda_material, only : friction_coefficient
   use dda_scene, only : scene_t
   use dda_settings, only : load_direction
   use dda_vector, only : along, right_normal
   implicit none
   private

   public :: limerick_scene, abutment_sides, set_constants

   !> Depth of the abutments over the radius: with the overhang as large, an arch of 10 m has the
   !> half size of 14.9 m that the published results of the original point to
   real(wp), parameter :: usual_depth = 0.43_wp
   !> Motion that means collapse over the radius, or over the half size
   real(wp), parameter :: usual_collapse = 0.05_wp
   !> Where the four points are that hold an abutment: this share of its sides from its corners
   real(wp), parameter :: inset = 0.15_wp
   !> Friction angle of a joint that cannot slide [deg]
   real(wp), parameter :: no_slip_deg = 89.9_wp

contains

   !> The model that the deck of one case describes
   pure subroutine limerick_scene(deck, model)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The model
      type(limerick_model_t), intent(out) :: model
      real(wp) :: acceleration

      if (allocated(deck%cut)) then
         call lines_model(deck, model)
         model%constants%collapse_displacement = usual_collapse*half_size(model)
      else
         call arch_model(deck, model)
         model%constants%collapse_displacement = usual_collapse*real_of(deck, "arch", "radius")
      end if
      if (allocated(deck%analysis)) call take_constants(deck%analysis, model%constants)
      call set_constants(deck, model%constants)
      if (allocated(deck%analysis) .or. .not. model%constants%auto_time_step) return
      acceleration = norm2(model%load_direction)*model%material(1)%unit_weight &
         & /model%material(1)%density
      if (acceleration > 0.0_wp) model%constants%time_step = sqrt(2.0_wp &
         & *model%constants%max_displacement_ratio*half_size(model)/acceleration)
   end subroutine limerick_scene

   !> The arch that a deck describes, between its abutments
   pure subroutine arch_model(deck, model)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The model
      type(limerick_model_t), intent(out) :: model
      type(scene_t) :: scene
      integer :: b, n, nv

      call arch_scene(deck, scene)
      n = size(scene%system%area) - 2
      nv = scene%system%first_vertex(n + 1) - 1
      allocate (model%first_vertex, source=scene%system%first_vertex)
      allocate (model%vertex, source=scene%system%vertex)
      allocate (model%edge_law(size(model%vertex, 2)), model%block_material(n + 2), source=1)
      allocate (model%fixed_point(2, 8), model%fixed_block(8))
      allocate (model%load_point(2, 0), model%load_block(0), model%load(0))
      allocate (model%measured_point(2, 0), model%measured_block(0))
      allocate (model%material(1))
      model%material(1)%material_t = scene%system%materials(1)
      model%material(1)%unit_weight = scene%system%unit_weight(1)
      model%load_direction = load_direction(scene%settings)
      do b = 1, 2
         call widen(deck, model%vertex(:, nv + 4*b - 3:nv + 4*b), &
            & model%fixed_point(:, 4*b - 3:4*b))
         model%fixed_block(4*b - 3:4*b) = n + b
      end do
      call set_laws(scene, n, nv, model)
   end subroutine arch_model

   !> How large the abutments are
   pure subroutine abutment_sides(deck, depth, overhang)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> Depth, away from the springing joint [m]
      real(wp), intent(out) :: depth
      !> How far they reach beyond the joint at either end [m]
      real(wp), intent(out) :: overhang

      depth = usual_depth*real_of(deck, "arch", "radius")
      if (is_given(deck, "arch", "abutment_size")) &
         & depth = real_of(deck, "arch", "abutment_size")
      overhang = depth
      if (is_given(deck, "arch", "abutment_overhang")) &
         & overhang = real_of(deck, "arch", "abutment_overhang")
   end subroutine abutment_sides

   !> Make an abutment as large as the deck says, and place the points that hold it
   pure subroutine widen(deck, vertex, fixed_point)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> Corners, counter-clockwise; the last edge contains the springing joint: (2, 4) [m]
      real(wp), intent(inout) :: vertex(:, :)
      !> The points: (2, 4) [m]
      real(wp), intent(out) :: fixed_point(:, :)
      real(wp) :: depth, overhang, tangent(2), outward(2)
      integer :: i

      call abutment_sides(deck, depth, overhang)
      tangent = along(vertex(:, 1), vertex(:, 4))
      outward = depth*right_normal(tangent)
      vertex(:, 1) = vertex(:, 1) - overhang*tangent
      vertex(:, 4) = vertex(:, 4) + overhang*tangent
      vertex(:, 2) = vertex(:, 1) + outward
      vertex(:, 3) = vertex(:, 4) + outward
      do i = 1, 4
         fixed_point(:, i) = (1.0_wp - 2.0_wp*inset)*vertex(:, i) &
            & + 2.0_wp*inset*sum(vertex, dim=2)/4.0_wp
      end do
   end subroutine widen

   !> Laws of the edges: the first for all joints, the second for springings that cannot slide
   pure subroutine set_laws(scene, n, nv, model)
      !> The arch
      type(scene_t), intent(in) :: scene
      !> Number of voussoirs
      integer, intent(in) :: n
      !> Number of their vertices
      integer, intent(in) :: nv
      !> The model; its laws are set
      type(limerick_model_t), intent(inout) :: model
      integer :: i

      allocate (model%law(2))
      model%law(1) = scene%contacts%joint(2)%law
      model%law(2) = scene%contacts%joint(1)%law
      do i = 1, 2
         if (model%law(i)%no_slip) model%law(i)%friction = friction_coefficient(no_slip_deg)
      end do
      ! the abutments' faces, and the voussoirs' edges upon them
      model%edge_law([nv + 4, nv + 8]) = 2
      model%edge_law(model%first_vertex(2) - 1) = 2
      i = model%first_vertex(n)
      model%edge_law(i + (nv + 1 - i)/2 - 1) = 2
   end subroutine set_laws

   !> Constants of the scheme that the deck gives
   pure subroutine set_constants(deck, constants)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> The constants; those that the deck does not give are left as they are
      type(limerick_constants_t), intent(inout) :: constants

      call take("limerick", "close_ratio", constants%close_ratio)
      call take("limerick", "open_ratio", constants%open_ratio)
      call take("limerick", "penetration_ratio", constants%penetration_ratio)
      call take("limerick", "overlap_deg", constants%overlap_deg)
      call take("limerick", "stiffness_ratio", constants%stiffness_ratio)
      call take("analysis", "penalty_ratio", constants%penalty_factor)
      call take("analysis", "max_displacement_ratio", constants%max_displacement_ratio)
      call take("analysis", "collapse_displacement", constants%collapse_displacement)
      call take("analysis", "time_step", constants%time_step)
      if (is_given(deck, "analysis", "time_step")) constants%auto_time_step = .false.
      if (is_given(deck, "analysis", "steps")) &
         & constants%max_steps = integer_of(deck, "analysis", "steps")
      if (is_given(deck, "limerick", "auto_penalty")) &
         & constants%auto_penalty = flag_of(deck, "limerick", "auto_penalty")
      if (is_given(deck, "limerick", "dynamic")) &
         & constants%dynamic = flag_of(deck, "limerick", "dynamic")
      if (is_given(deck, "limerick", "rotation")) &
         & constants%exact_rotation = word_of(deck, "limerick", "rotation") == "exact"

   contains

      !> Take a number that the deck gives
      pure subroutine take(group, key, number)
         !> Group of the key
         character(len=*), intent(in) :: group
         !> The key
         character(len=*), intent(in) :: key
         !> The number; left as it is if the deck does not give it
         real(wp), intent(inout) :: number

         if (is_given(deck, group, key)) number = real_of(deck, group, key)
      end subroutine take
   end subroutine set_constants
end module dda_limerick_scene
