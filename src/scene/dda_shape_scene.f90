!> Shaped arches of a deck: form, blocks, actions
module dda_shape_scene
   use dda_arch_assembly, only : arch_assembly_t, assemble_arch
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_block_input, only : block_plan_t
   use dda_block_system, only : block_system_t
   use dda_boundary, only : constant_history, loaded_point_t
   use dda_contacts, only : joint_place
   use dda_deck, only : deck_t, number_or
   use dda_key_names, only : arch_abutment_overhang, arch_abutment_size, arch_buttress_height, &
      & arch_buttress_width, arch_crown_thickness, arch_facet_deg, arch_half_angle_deg, &
      & arch_joint_direction, arch_joints_deg, arch_lune_deg, arch_pier_courses, &
      & arch_pier_height, arch_pier_width, arch_radius, arch_right_rise, arch_rings, arch_rise, &
      & arch_shape, arch_span, arch_spans, arch_springing, arch_springing_thickness, &
      & arch_thickness, arch_thickness_ratio, arch_voussoirs, load_displacement_factor, &
      & support_left_dx, support_right_rotation_deg
   use dda_kinds, only : degree, wp
   use dda_scene, only : scene_t
   use dda_vector, only : area_moments, area_moments_t
   implicit none
   private

   public :: add_loads, add_lune_weights, find_crown_joint, prescribe_springings
   public :: shape_assembly, shape_form

   !> Default angle of the skewbacks of a flat arch [deg]
   real(wp), parameter :: usual_skewback_deg = 30.0_wp

contains

   !> Form of a deck, with checks between its keys
   pure subroutine shape_form(deck, form, problem)
      type(deck_t), intent(in) :: deck
      type(arch_form_t), intent(out) :: form
      type(form_problem_t), intent(out) :: problem  !! Keys that contradict each other

      form%shape = deck%value(arch_shape)%text
      form%by_radius = (form%shape == "circular" .or. form%shape == "segmental") &
         & .and. .not. (deck%value(arch_span)%given .or. deck%value(arch_rise)%given)
      form%radius = deck%value(arch_radius)%number
      form%half_angle_deg = deck%value(arch_half_angle_deg)%number
      if (form%shape == "flat" .and. .not. deck%value(arch_half_angle_deg)%given) &
         & form%half_angle_deg = usual_skewback_deg
      form%span = deck%value(arch_span)%number
      form%rise = deck%value(arch_rise)%number
      form%rise(2) = number_or(deck, arch_right_rise, form%rise(1))
      form%radial = form%shape == "flat"
      if (deck%value(arch_joint_direction)%given) form%radial = &
         & deck%value(arch_joint_direction)%text == "radial"
      form%voussoirs = nint(deck%value(arch_voussoirs)%number)
      form%facet_deg = deck%value(arch_facet_deg)%number
      form%rings = nint(deck%value(arch_rings)%number)
      form%spans = nint(deck%value(arch_spans)%number)
      form%pier = [deck%value(arch_pier_width)%number, deck%value(arch_pier_height)%number]
      form%courses = nint(deck%value(arch_pier_courses)%number)
      form%buttress = [deck%value(arch_buttress_width)%number, &
         & number_or(deck, arch_buttress_height, form%pier(2))]
      form%no_slip = deck%value(arch_springing)%text == "no-slip"
      call check_lines(deck, form, problem)
      if (len_trim(problem%text) == 0) call check_supports(deck, form, problem)
      if (len_trim(problem%text) == 0) call take_thickness(deck, form, problem)
   end subroutine shape_form

   !> Check the keys of the line of an arch
   pure subroutine check_lines(deck, form, problem)
      type(deck_t), intent(in) :: deck
      type(arch_form_t), intent(in) :: form
      type(form_problem_t), intent(inout) :: problem
      logical :: flat

      flat = form%shape == "flat"
      if (deck%value(arch_joints_deg)%given) then
         problem = form_problem_t("expected voussoirs, got joints_deg, which is for circular "// &
            & "arches of one ring alone; remove it", "joints_deg")
      else if (.not. form%by_radius .and. deck%value(arch_radius)%given) then
         problem = form_problem_t("expected span and rise alone, got a radius beside them; "// &
            & "remove one of the two", "radius")
      else if (.not. (form%by_radius .or. flat) .and. deck%value(arch_half_angle_deg)%given) then
         problem = form_problem_t("expected span and rise alone, got half_angle_deg beside "// &
            & "them; remove one of the two", "half_angle_deg")
      else if (.not. form%by_radius .and. .not. deck%value(arch_span)%given) then
         problem = form_problem_t("expected a span, got none; give it", "span")
      else if (.not. (form%by_radius .or. flat .or. deck%value(arch_rise)%given)) then
         problem = form_problem_t("expected a rise, got none; give it", "rise")
      else if (flat .and. deck%value(arch_rise)%given) then
         problem = form_problem_t("expected no rise of a flat arch, got one; remove it", "rise")
      else if ((form%by_radius .or. flat) .and. deck%value(arch_right_rise)%given) then
         problem = form_problem_t("expected span and rise beside right_rise, got none; give "// &
            & "them, or remove it", "right_rise")
      else if (flat .and. form%half_angle_deg >= 90.0_wp) then
         problem = form_problem_t("expected skewbacks of a flat arch less than 90 degrees "// &
            & "from vertical, got more; lower it", "half_angle_deg")
      else if (deck%value(arch_abutment_size)%given &
         & .or. deck%value(arch_abutment_overhang)%given) then
         problem = form_problem_t("expected no abutment_size and abutment_overhang, which are "// &
            & "for mode = 'limerick' alone, got one; remove it", "abutment_size")
      else if (form%by_radius .and. 2.0_wp*form%half_angle_deg &
         & >= 180.0_wp*real(form%voussoirs, wp) .and. .not. form%facet_deg > 0.0_wp) then
         problem = form_problem_t("expected voussoirs of less than 180 degrees, got more; give "// &
            & "facet_deg or more voussoirs", "voussoirs")
      end if
   end subroutine check_lines

   !> Check the keys of piers and buttresses, and keys without effect
   pure subroutine check_supports(deck, form, problem)
      type(deck_t), intent(in) :: deck
      type(arch_form_t), intent(in) :: form
      type(form_problem_t), intent(inout) :: problem
      logical :: buttressed

      buttressed = deck%value(arch_buttress_width)%given
      if (form%spans > 1 .and. .not. deck%value(arch_pier_width)%given) then
         problem = form_problem_t("expected the width of the piers between spans, got none; "// &
            & "give it", "pier_width")
      else if ((form%spans > 1 .or. buttressed) .and. .not. form%buttress(2) > 0.0_wp &
         & .or. form%spans > 1 .and. .not. form%pier(2) > 0.0_wp) then
         problem = form_problem_t("expected the height of piers and buttresses, got none; "// &
            & "give it", "pier_height")
      else if (form%spans == 1 .and. deck%value(arch_pier_width)%given) then
         problem = form_problem_t("expected two spans or more on piers, got one; give spans, "// &
            & "or remove pier_width", "pier_width")
      else if (form%spans == 1 .and. .not. buttressed .and. (deck%value(arch_pier_height)%given &
         & .or. deck%value(arch_pier_courses)%given)) then
         problem = form_problem_t("expected piers or buttresses, got none; give spans or "// &
            & "buttress_width, or remove pier_height and pier_courses", "pier_height")
      else if (deck%value(arch_buttress_height)%given .and. .not. buttressed) then
         problem = form_problem_t("expected buttress_width beside it, got none; give it", &
            & "buttress_height")
      else if (deck%value(arch_lune_deg)%given .and. (form%spans > 1 .or. buttressed)) then
         problem = form_problem_t("expected a lune of one span on fixed springings, got more; "// &
            & "remove lune_deg, or spans and buttresses", "lune_deg")
      else if (deck%value(arch_lune_deg)%given .and. deck%value(arch_right_rise)%given) then
         problem = form_problem_t("expected a lune with springings of one height, got two; "// &
            & "remove right_rise", "lune_deg")
      end if
   end subroutine check_supports

   !> Set the thickness of a form at the crown and at the springings
   pure subroutine take_thickness(deck, form, problem)
      type(deck_t), intent(in) :: deck
      type(arch_form_t), intent(inout) :: form        !! The form; its thickness is set
      type(form_problem_t), intent(inout) :: problem  !! Contradicting keys, if any
      logical :: constant, crown, ratio, springing

      constant = deck%value(arch_thickness)%given
      crown = deck%value(arch_crown_thickness)%given
      springing = deck%value(arch_springing_thickness)%given
      ratio = deck%value(arch_thickness_ratio)%given
      if (crown .neqv. springing) then
         problem = form_problem_t("expected crown_thickness and springing_thickness, got one; "// &
            & "give both", merge("crown_thickness    ", "springing_thickness", crown))
      else if (count([constant, crown, ratio]) > 1) then
         problem = form_problem_t("expected the thickness once, got it twice; keep one of "// &
            & "thickness, thickness_ratio, and crown_thickness with springing_thickness", &
            & "thickness")
      else if (ratio .and. .not. form%by_radius) then
         problem = form_problem_t("expected thickness, got thickness_ratio without a radius; "// &
            & "give thickness", "thickness_ratio")
      else if (.not. (constant .or. crown .or. form%by_radius)) then
         problem = form_problem_t("expected a thickness, got none; give it", "thickness")
      end if
      form%thickness = deck%value(arch_thickness_ratio)%number*form%radius
      if (constant) form%thickness = deck%value(arch_thickness)%number
      if (crown) form%thickness = [deck%value(arch_crown_thickness)%number, &
         & deck%value(arch_springing_thickness)%number]
   end subroutine take_thickness

   !> Make the blocks of a deck's arch
   pure subroutine shape_assembly(deck, assembly, problem)
      type(deck_t), intent(in) :: deck
      type(arch_assembly_t), intent(out) :: assembly
      type(form_problem_t), intent(out) :: problem
      type(arch_form_t) :: form

      call shape_form(deck, form, problem)
      if (len_trim(problem%text) == 0) call assemble_arch(form, assembly, problem)
   end subroutine shape_assembly

   !> Prescribe the displacements of &support at both ends of the springing joints
   pure subroutine prescribe_springings(deck, plan)
      type(deck_t), intent(in) :: deck
      type(block_plan_t), intent(inout) :: plan  !! Blocks of an arch without buttresses
      integer :: block, i, key, n, side

      associate (given => deck%value(support_left_dx:support_right_rotation_deg)%given, &
         & factor => deck%value(load_displacement_factor)%number)
         n = count([any(given(:3)), any(given(4:))])
         if (n == 0) return
         allocate (plan%boundary%held(2*n))
         n = 0
         do side = 0, 1
            if (.not. any(given(3*side + 1:3*side + 3))) cycle
            key = support_left_dx + 3*side
            ! the first fixed block is left, the last one right
            block = merge(size(plan%fixed), findloc(plan%fixed, .true., dim=1), side == 1)
            plan%fixed(block) = .false.
            associate (ends => plan%vertex(:, [plan%first_vertex(block), &
               & plan%first_vertex(block + 1) - 1]))
               do i = 1, 2
                  n = n + 1
                  plan%boundary%held(n)%block = block
                  plan%boundary%held(n)%point = ends(:, i)
                  plan%boundary%held(n)%path = constant_history( &
                     & factor*[deck%value(key)%number, deck%value(key + 1)%number] &
                     & + turned(ends(:, i) - 0.5_wp*sum(ends, 2), &
                     & factor*degree*deck%value(key + 2)%number))
               end do
            end associate
         end do
      end associate

   contains

      !> Displacement of the end of an arm by an anticlockwise rotation
      pure function turned(arm, angle) result(way)
         real(wp), intent(in) :: arm(2)  !! Arm: (2) [m]
         real(wp), intent(in) :: angle   !! Angle [rad]
         real(wp) :: way(2)              !! Displacement: (2) [m]

         way = sin(angle)*[-arm(2), arm(1)] - 2.0_wp*sin(0.5_wp*angle)**2*arm
      end function turned
   end subroutine prescribe_springings

   !> Add loads to those of a scene
   pure subroutine add_loads(more, scene)
      type(loaded_point_t), intent(in) :: more(:)  !! The loads
      type(scene_t), intent(inout) :: scene
      type(loaded_point_t), allocatable :: loaded(:)
      integer :: before

      before = 0
      if (allocated(scene%settings%boundary%loaded)) before = size(scene%settings%boundary%loaded)
      allocate (loaded(before + size(more)))
      if (before > 0) loaded(:before) = scene%settings%boundary%loaded
      loaded(before + 1:) = more
      call move_alloc(loaded, scene%settings%boundary%loaded)
   end subroutine add_loads

   !> Find the joint of two voussoirs nearest to the crown of the first span
   pure subroutine find_crown_joint(assembly, scene)
      type(arch_assembly_t), intent(in) :: assembly
      type(scene_t), intent(inout) :: scene  !! The scene; the number is set
      real(wp) :: off, least
      integer :: j

      least = huge(least)
      do j = 1, size(scene%contacts%joint)
         associate (joint => scene%contacts%joint(j), &
            & place => joint_place(scene%system, scene%contacts, j))
            if (any(joint%block > assembly%n_voussoir) &
               & .or. abs(joint%block(1) - joint%block(2)) /= 1) cycle
            off = abs(0.5_wp*sum(place%middle(1, :)) + scene%origin(1) - assembly%crown_x(1))
         end associate
         if (off >= least) cycle
         least = off
         scene%crown_joint = j
      end do
   end subroutine find_crown_joint

   !> Set the weight of the wedges of a dome's lune, whose depth is the angle times the distance
   !> from the axis. A pair of forces shifts the weight from the centre of the face to the centre of
   !> the wedge
   pure subroutine add_lune_weights(lune_deg, scene)
      real(wp), intent(in) :: lune_deg  !! Angle of the lune [deg]
      !> The scene, with the axis at x = 0; weights are set and loads added
      type(scene_t), intent(inout) :: scene
      type(loaded_point_t) :: pair(2)
      real(wp) :: sums(3), weight
      integer :: b

      do b = 1, size(scene%system%area)
         if (scene%system%equation(b) == 0) cycle
         sums = wedge_sums(scene%system, b)
         weight = scene%system%unit_weight(b)*degree*lune_deg*sums(1)
         scene%system%unit_weight(b) = weight/scene%system%area(b)
         pair%block = b
         pair(1)%point = sums(2:3)/sums(1)
         pair(2)%point = scene%system%centroid(:, b)
         pair(1)%force = constant_history([0.0_wp, -weight])
         pair(2)%force = constant_history([0.0_wp, weight])
         call add_loads(pair, scene)
      end do
   end subroutine add_lune_weights

   !> Integrals of abs(x), abs(x) x and abs(x) y over a block
   pure function wedge_sums(system, block) result(sums)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: block  !! Number of the block
      real(wp) :: sums(3)           !! The integrals: (3)
      type(area_moments_t) :: moments
      integer :: side

      sums = 0.0_wp
      associate (vertex => system%vertex(:, &
         & system%first_vertex(block):system%first_vertex(block + 1) - 1))
         do side = -1, 1, 2
            if (.not. any(real(side, wp)*vertex(1, :) > 0.0_wp)) cycle
            moments = area_moments(half_plane(vertex, real(side, wp)))
            associate (a => moments%area, c => moments%centroid, s => moments%second)
               sums = sums + real(side, wp)*[a*c(1), s(1) + a*c(1)**2, s(3) + a*c(1)*c(2)]
            end associate
         end do
      end associate
   end function wedge_sums

   !> Part of a polygon on one side of the axis
   pure function half_plane(vertex, side) result(part)
      real(wp), intent(in) :: vertex(:, :)  !! Corners: (2, n) [m]
      real(wp), intent(in) :: side          !! 1 for x > 0, -1 for x < 0
      real(wp), allocatable :: part(:, :)   !! Corners of the part: (2, m) [m]
      real(wp) :: corner(2, 2*size(vertex, 2)), share
      integer :: i, m, n, next

      n = size(vertex, 2)
      m = 0
      do i = 1, n
         next = 1 + modulo(i, n)
         if (side*vertex(1, i) >= 0.0_wp) then
            m = m + 1
            corner(:, m) = vertex(:, i)
         end if
         if (.not. vertex(1, i)*vertex(1, next) < 0.0_wp) cycle
         m = m + 1
         share = vertex(1, i)/(vertex(1, i) - vertex(1, next))
         corner(:, m) = vertex(:, i) + share*(vertex(:, next) - vertex(:, i))
      end do
      allocate (part, source=corner(:, :m))
   end function half_plane
end module dda_shape_scene
