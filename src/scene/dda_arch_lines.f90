!> An arch as lines, points and an analysis in the Limerick format
module dda_arch_lines
   use dda_arch_scene, only : arch_scene, unit_weight
   use dda_block_system, only : block_system_t
   use dda_deck, only : deck_error, deck_t, has_group
   use dda_error, only : error_t
   use dda_key_names, only : analysis_collapse_displacement, analysis_mode, arch_abutment_size, &
      & arch_springing, joint_cohesion, joint_friction_deg, joint_tension, live_group, &
      & load_gravity_direction_deg, load_horizontal_coefficient, material_density, &
      & material_plane, material_poisson, material_young, vehicle_group
   use dda_kinds, only : wp
   use dda_material, only : no_slip_deg
   use dda_limerick_analysis, only : limerick_analysis_t, limerick_constants_t, &
      & limerick_joint_t, analysis_material_t
   use dda_limerick_scene, only : abutment_depth, set_constants, widen
   use dda_line_model, only : add_entity, entity_role, line_model_t
   use dda_scene, only : scene_t
   use dda_text, only : short_text
   implicit none
   private

   public :: arch_lines, arch_analysis, lost_keys

   !> Overshoot of a joint over its length
   real(wp), parameter :: overshoot = 0.02_wp
   !> Position of the fixed points of an abutment over its sides
   real(wp), parameter :: inset = 0.15_wp
   !> Largest edge-node distance ratio
   real(wp), parameter :: largest_ratio = 0.01_wp

contains

   !> Make the lines and fixed points of an arch
   pure subroutine arch_lines(deck, model, error)
      type(deck_t), intent(in) :: deck  !! The deck of a case, with an arch
      type(line_model_t), intent(out) :: model
      !> Allocated if the abutments are too large to be placed side by side
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene
      real(wp) :: corner(2, 4, 2)
      integer :: n, b, first, side

      call arch_scene(deck, scene)
      n = size(scene%system%area) - 2
      do side = 1, 2
         first = scene%system%first_vertex(n + side)
         corner(:, :, side) = scene%system%vertex(:, first:first + 3)
         call widen(deck, corner(:, :, side))
      end do
      ! the springing face first, from the intrados to the extrados
      corner(:, :, 1) = corner(:, [4, 1, 2, 3], 1)
      corner(:, :, 2) = corner(:, [1, 4, 3, 2], 2)
      if (maxval(corner(1, :, 1)) >= 0.0_wp .or. minval(corner(1, :, 2)) <= 0.0_wp) &
         & call deck_error(error, "arch%abutment_size must keep the abutments apart, got " &
         & //short_text(abutment_depth(deck))//" m, where they meet below the arch; make it " &
         & //"smaller", deck, deck%value(arch_abutment_size)%place)
      if (allocated(error)) return
      model%file = deck%file
      do b = 1, n
         call add_chords(scene%system, b, model)
      end do
      do b = 1, n - 1
         call add_joint(scene%system, b, model)
      end do
      do side = 1, 2
         call add_abutment(corner(:, :, side), face_material(deck), model)
      end do
      model%edge_node_ratio = edge_node_ratio(model)
   end subroutine arch_lines

   !> Add the chords of a voussoir at the intrados and at the extrados
   pure subroutine add_chords(system, block, model)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block  !! Number of the voussoir
      type(line_model_t), intent(inout) :: model
      integer :: first, last, k

      first = system%first_vertex(block)
      last = system%first_vertex(block + 1) - 1
      do k = 0, (last - first + 1)/2 - 2
         call add_entity(model%line, [system%vertex(:, first + k), &
            & system%vertex(:, first + k + 1)], 1, 0)
         call add_entity(model%line, [system%vertex(:, last - k), &
            & system%vertex(:, last - k - 1)], 1, 0)
      end do
   end subroutine add_chords

   !> Add the joint between a voussoir and the next one, with an overshoot
   pure subroutine add_joint(system, block, model)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block  !! Number of the voussoir on the left
      type(line_model_t), intent(inout) :: model
      real(wp) :: intrados(2), extrados(2), more(2)
      integer :: first, n

      first = system%first_vertex(block)
      n = system%first_vertex(block + 1) - first
      intrados = system%vertex(:, first + n/2 - 1)
      extrados = system%vertex(:, first + n/2)
      more = overshoot*(extrados - intrados)
      call add_entity(model%line, [intrados - more, extrados + more], 1, 0)
   end subroutine add_joint

   !> Add an abutment with its four fixed points
   pure subroutine add_abutment(corner, material, model)
      real(wp), intent(in) :: corner(2, 4)  !! Corners, starting with the springing face: (2, 4) [m]
      integer, intent(in) :: material       !! Joint material of the face
      type(line_model_t), intent(inout) :: model
      real(wp) :: share(2), point(2)
      integer :: k, i, j

      do k = 1, 4
         call add_entity(model%line, [corner(:, k), corner(:, 1 + mod(k, 4))], &
            & merge(material, 1, k == 1), 0)
      end do
      do i = 0, 1
         do j = 0, 1
            share = inset + (1.0_wp - 2.0_wp*inset)*real([i, j], wp)
            point = corner(:, 1) + share(1)*(corner(:, 2) - corner(:, 1)) &
               & + share(2)*(corner(:, 4) - corner(:, 1))
            call add_entity(model%of(entity_role%fix), [point, point], 0, 0)
         end do
      end do
   end subroutine add_abutment

   !> Joint material of the springings: a separate one if only they cannot slide
   pure integer function face_material(deck)
      type(deck_t), intent(in) :: deck

      face_material = 1
      if (deck%value(arch_springing)%text == "no-slip") face_material = 2
   end function face_material

   !> Edge-node distance ratio that merges no two nodes of the arch: Shi's 0.01, or less for short
   !> edges
   pure real(wp) function edge_node_ratio(model)
      type(line_model_t), intent(in) :: model
      real(wp) :: shortest, height, width
      integer :: i

      shortest = huge(shortest)
      associate (place => model%line%place(:, :model%line%n))
         do i = 1, model%line%n
            shortest = min(shortest, norm2(place(3:4, i) - place(1:2, i)))
         end do
         width = maxval(place([1, 3], :)) - minval(place([1, 3], :))
         height = maxval(place([2, 4], :)) - minval(place([2, 4], :))
      end associate
      edge_node_ratio = min(largest_ratio, 0.2_wp*shortest/(1.02_wp*max(height/2.0_wp, &
         & width/2.6_wp)))
   end function edge_node_ratio

   !> Analysis of an arch, with Shi's constants
   pure type(limerick_analysis_t) function arch_analysis(deck) result(analysis)
      type(deck_t), intent(in) :: deck
      type(analysis_material_t) :: stone
      type(limerick_constants_t) :: usual
      type(limerick_joint_t) :: joint

      analysis%file = deck%file
      call set_constants(deck, analysis%limerick_constants_t)
      analysis%dynamic = analysis%dynamic .or. deck%value(analysis_mode)%text == "dynamic"
      if (deck%value(analysis_mode)%text /= "limerick") then
         ! in the other modes these keys have another meaning
         analysis%auto_time_step = usual%auto_time_step
         analysis%penalty_factor = usual%penalty_factor
      end if
      analysis%plane_strain = deck%value(material_plane)%text == "strain"
      stone%density = deck%value(material_density)%number
      stone%unit_weight = unit_weight(deck)
      stone%young = deck%value(material_young)%number
      stone%poisson = deck%value(material_poisson)%number
      analysis%gravity = stone%unit_weight/stone%density
      joint%friction_deg = min(deck%value(joint_friction_deg)%number, no_slip_deg)
      joint%cohesion = deck%value(joint_cohesion)%number
      joint%tension = deck%value(joint_tension)%number
      allocate (analysis%material(1), analysis%load(0))
      analysis%material(1) = stone
      allocate (analysis%joint(face_material(deck)))
      analysis%joint = joint
      analysis%joint(2:)%friction_deg = no_slip_deg
   end function arch_analysis

   !> Keys that the Limerick files cannot represent
   pure function lost_keys(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Keys separated by commas; empty if there are none

      text = ""
      if (abs(deck%value(load_gravity_direction_deg)%number + 90.0_wp) > 0.0_wp) &
         & text = text//", load%gravity_direction_deg"
      if (abs(deck%value(load_horizontal_coefficient)%number) > 0.0_wp) &
         & text = text//", load%horizontal_coefficient"
      if (has_group(deck, live_group)) text = text//", &live"
      if (has_group(deck, vehicle_group)) text = text//", &vehicle"
      if (deck%value(analysis_collapse_displacement)%given) text = text &
         & //", analysis%collapse_displacement"
      if (len(text) > 0) text = text(3:)
   end function lost_keys
end module dda_arch_lines
