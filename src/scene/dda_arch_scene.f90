!> Scenes of an arch from a deck, and its exact critical value
module dda_arch_scene
   use couplet_heyman_discrete, only : discrete_critical, discrete_solution_t, discrete_status
   use dda_arch, only : arch_blocks, arch_shape_t, equal_joints, facet_count
   use dda_arch_chain, only : arch_numbers_t
   use dda_contacts, only : find_contacts
   use dda_deck, only : deck_t, has_group, number_or
   use dda_key_names, only : analysis_collapse_displacement, analysis_collapse_point, &
      & analysis_collapse_rotation_deg, analysis_damping, analysis_duration, analysis_flow, &
      & analysis_max_displacement_ratio, analysis_open_close_limit, analysis_penalty_ratio, &
      & analysis_restitution, analysis_start, analysis_steps, analysis_time_step, &
      & arch_facet_deg, arch_half_angle_deg, arch_joints_deg, arch_radius, arch_springing, &
      & arch_thickness_ratio, arch_voussoirs, joint_cohesion, joint_friction_deg, &
      & joint_residual_deg, joint_slip_length, joint_tension, live_group, load_gravity, &
      & load_gravity_direction_deg, load_horizontal_coefficient, load_live_horizontal, &
      & load_load_factor, material_compressive_strength, material_density, material_plane, &
      & material_poisson, material_unit_weight, material_young, output_condition, search_group, &
      & search_tolerance, vehicle_group
   use dda_kinds, only : degree, pi, wp
   use dda_material, only : friction_coefficient, joint_law_t, material_t, no_slip_deg, set_friction
   use dda_scene, only : scene_t
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : flow_rule, overturned, settings_t
   implicit none
   private

   public :: arch_scene, arch_numbers, joint_angles_deg, half_joints_deg, exact_thickness
   public :: search_start, arch_resolution
   public :: joint_law, material_of, set_loads, settings_of, unit_weight

   !> Default number of steps per step of full length
   real(wp), parameter :: cut_steps = 20.0_wp

contains

   !> Make the scene of an arch
   pure subroutine arch_scene(deck, scene)
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(out) :: scene
      type(joint_law_t), allocatable :: law(:)
      integer, allocatable :: edge_pair(:, :)
      real(wp) :: half_angle
      integer :: n

      call arch_blocks(shape_of(deck), material_of(deck), scene%system, edge_pair)
      scene%system%unit_weight = unit_weight(deck)
      half_angle = degree*deck%value(arch_half_angle_deg)%number
      scene%settings = settings_of(deck, half_angle, size(half_joints_deg(deck)))
      ! acceleration by round-off: an error eps r of a corner changes the weight of a voussoir by
      ! eps over the thickness ratio
      scene%settings%rest_tolerance = max(scene%settings%rest_tolerance, min(1.0_wp, &
         & half_angle**2/2.0_wp)*epsilon(1.0_wp)/deck%value(arch_thickness_ratio)%number)
      n = size(edge_pair, 2)
      allocate (law(n), source=joint_law(deck))
      if (deck%value(arch_springing)%text == "no-slip") law([1, n])%no_slip = .true.
      call find_contacts(scene%system, edge_pair, law, scene%contacts)
      allocate (scene%joint_angle_deg, source=joint_angles_deg(deck))
   end subroutine arch_scene

   !> Data of a chain of rigid voussoirs, without settings
   pure type(arch_numbers_t) function arch_numbers(deck) result(numbers)
      type(deck_t), intent(in) :: deck

      numbers%shape = shape_of(deck)
      numbers%density = deck%value(material_density)%number
      numbers%young = deck%value(material_young)%number
      numbers%penalty_ratio = deck%value(analysis_penalty_ratio)%number
      numbers%law = joint_law(deck)
      numbers%no_slip_springing = deck%value(arch_springing)%text == "no-slip"
   end function arch_numbers

   !> Angles of all joints from the crown, positive to the right
   pure function joint_angles_deg(deck) result(angle)
      type(deck_t), intent(in) :: deck
      real(wp), allocatable :: angle(:)  !! The angles, from left to right: (n_joint) [deg]
      real(wp), allocatable :: half(:)
      integer :: n

      allocate (half, source=half_joints_deg(deck))
      n = 2*size(half)
      if (.not. half(1) > 0.0_wp) n = n - 1
      allocate (angle(n))
      angle(:size(half)) = -half(size(half):1:-1)
      angle(n - size(half) + 1:) = half
   end function joint_angles_deg

   !> Material of the blocks
   pure type(material_t) function material_of(deck) result(material)
      type(deck_t), intent(in) :: deck

      material%density = deck%value(material_density)%number
      material%young = deck%value(material_young)%number
      material%poisson = deck%value(material_poisson)%number
      material%strength = number_or(deck, material_compressive_strength, material%strength)
      material%plane_strain = deck%value(material_plane)%text == "strain"
   end function material_of

   !> Law of the joints
   pure type(joint_law_t) function joint_law(deck) result(law)
      type(deck_t), intent(in) :: deck

      call set_friction(deck%value(joint_friction_deg)%number, law)
      law%cohesion = deck%value(joint_cohesion)%number
      law%tension = deck%value(joint_tension)%number
      if (deck%value(joint_residual_deg)%given) law%residual = friction_coefficient( &
         & min(deck%value(joint_residual_deg)%number, no_slip_deg))
      law%slip_length = deck%value(joint_slip_length)%number
   end function joint_law

   !> Joints of one half of the arch, from the crown
   pure function half_joints_deg(deck) result(joints)
      type(deck_t), intent(in) :: deck
      real(wp), allocatable :: joints(:)  !! Angles from the crown: (n) [deg]

      if (deck%value(arch_joints_deg)%given) then
         joints = deck%value(arch_joints_deg)%numbers
      else
         joints = equal_joints(nint(deck%value(arch_voussoirs)%number), &
            & deck%value(arch_half_angle_deg)%number)
      end if
   end function half_joints_deg

   !> Shape of the arch
   pure type(arch_shape_t) function shape_of(deck) result(shape)
      type(deck_t), intent(in) :: deck
      real(wp), allocatable :: joints(:), span(:)
      integer :: crown

      allocate (joints, source=half_joints_deg(deck))
      shape%radius = deck%value(arch_radius)%number
      shape%thickness_ratio = deck%value(arch_thickness_ratio)%number
      allocate (shape%joint_angle, source=joints*degree)
      crown = merge(1, 0, joints(1) > 0.0_wp)
      allocate (span(size(joints) - 1 + crown))
      span(1) = 2.0_wp*joints(1)
      span(1 + crown:) = joints(2:) - joints(:size(joints) - 1)
      allocate (shape%facets, source=facet_count(span, deck%value(arch_facet_deg)%number))
   end function shape_of

   !> Weight per volume [N/m3]
   pure real(wp) function unit_weight(deck)
      type(deck_t), intent(in) :: deck

      unit_weight = number_or(deck, material_unit_weight, &
         & deck%value(material_density)%number*deck%value(load_gravity)%number)
   end function unit_weight

   !> Settings of a run. The tolerance of accelerations at rest follows the search tolerance and the
   !> rise: with the same deficit of thickness, a shallow arch accelerates less
   pure type(settings_t) function settings_of(deck, half_angle, joints) result(settings)
      type(deck_t), intent(in) :: deck
      !> Angle from the crown to a springing; a right angle for other structures [rad]
      real(wp), intent(in) :: half_angle
      integer, intent(in) :: joints  !! Joints of one half of an arch, or all joints
      type(scene_plan_t) :: plan
      real(wp) :: noise, rise

      plan = plan_scene(deck)
      settings%dynamic = plan%velocities
      settings%current = plan%moving
      settings%n_dof = plan%unknowns
      settings%tells_condition = deck%value(output_condition)%flag
      settings%penalty_ratio = deck%value(analysis_penalty_ratio)%number
      settings%max_steps = nint(deck%value(analysis_steps)%number)
      settings%max_changes = nint(deck%value(analysis_open_close_limit)%number)
      settings%time_step = deck%value(analysis_time_step)%number
      settings%collapse_displacement = deck%value(analysis_collapse_displacement)%number
      settings%duration = deck%value(analysis_duration)%number
      if (.not. deck%value(analysis_steps)%given .and. deck%value(analysis_duration)%given &
         & .and. deck%value(analysis_time_step)%given) settings%max_steps = int(min(1.0e9_wp, &
         & max(real(settings%max_steps, wp), cut_steps*settings%duration/settings%time_step)))
      if (deck%value(analysis_collapse_rotation_deg)%given) then
         settings%collapse_rotation = degree*deck%value(analysis_collapse_rotation_deg)%number
      else if (has_group(deck, search_group) .and. .not. settings%collapse_displacement &
         & > 0.0_wp) then
         settings%collapse_rotation = overturned
      end if
      settings%collapse_point = nint(deck%value(analysis_collapse_point)%number)
      settings%restitution = deck%value(analysis_restitution)%number
      settings%damping = deck%value(analysis_damping)%number
      settings%settles = deck%value(analysis_start)%text == "static"
      settings%max_displacement_ratio = deck%value(analysis_max_displacement_ratio)%number
      settings%verdict_flow = merge(flow_rule%associated, flow_rule%coulomb, &
         & deck%value(analysis_flow)%text == "associated")
      call set_loads(deck, settings)
      rise = min(1.0_wp, half_angle**2/2.0_wp)
      settings%rest_tolerance = 1.0e-3_wp*rise*deck%value(search_tolerance)%number
      ! round-off: the thrust is w r, the weight of a voussoir 2 w r alpha/n
      noise = 16.0_wp*epsilon(1.0_wp)*real(joints, wp)/half_angle
      settings%rest_tolerance = max(settings%rest_tolerance, noise)
   end function settings_of

   !> Set the load coefficients
   pure subroutine set_loads(deck, settings)
      type(deck_t), intent(in) :: deck
      type(settings_t), intent(inout) :: settings

      settings%tilt = degree*modulo(deck%value(load_gravity_direction_deg)%number + 270.0_wp, &
         & 360.0_wp) - pi
      settings%push = deck%value(load_horizontal_coefficient)%number
      settings%live_push = deck%value(load_live_horizontal)%flag
      settings%load_factor = deck%value(load_load_factor)%number
   end subroutine set_loads

   !> Exact critical thickness ratio of the same polygons by limit analysis
   pure subroutine exact_thickness(deck, eta, known)
      type(deck_t), intent(in) :: deck
      real(wp), intent(out) :: eta   !! The ratio
      logical, intent(out) :: known  !! True if it exists and is known
      type(arch_shape_t) :: shape
      type(discrete_solution_t) :: solution
      real(wp) :: friction
      logical :: own_weight, no_strength

      eta = 0.0_wp
      own_weight = unit_weight(deck) > 0.0_wp &
         & .and. .not. abs(deck%value(load_gravity_direction_deg)%number + 90.0_wp) > 0.0_wp &
         & .and. .not. abs(deck%value(load_horizontal_coefficient)%number) > 0.0_wp &
         & .and. .not. (has_group(deck, live_group) .or. has_group(deck, vehicle_group))
      no_strength = .not. (deck%value(joint_cohesion)%number > 0.0_wp &
         & .or. deck%value(joint_tension)%number > 0.0_wp)
      known = own_weight .and. no_strength
      if (.not. known) return
      friction = deck%value(joint_friction_deg)%number
      friction = merge(pi, friction*degree, friction >= no_slip_deg)
      shape = shape_of(deck)
      call discrete_critical(shape%joint_angle, shape%facets, friction, &
         & deck%value(arch_springing)%text == "no-slip", solution)
      known = solution%status == discrete_status%found
      if (known) eta = solution%eta
   end subroutine exact_thickness

   !> Start of a search for the thickness ratio: slightly below that of an arch of many voussoirs,
   !> by the first two terms of its series in the half angle
   pure real(wp) function search_start(deck)
      type(deck_t), intent(in) :: deck
      real(wp) :: square

      square = (degree*deck%value(arch_half_angle_deg)%number)**2
      search_start = 0.8_wp*square**2/48.0_wp*max(0.3_wp, 1.0_wp - square/10.0_wp)
   end function search_start

   !> Relative error of the critical thickness ratio eta by round-off of corners, at the deck's own
   !> thickness. An error eps r of a corner changes the weight of a voussoir by eps/eta and the
   !> position of the thrust by alpha^2/8*eps/eta of the radius, which is compared with eta; with a
   !> margin of 8
   pure real(wp) function arch_resolution(deck)
      type(deck_t), intent(in) :: deck
      real(wp) :: square

      square = (degree*deck%value(arch_half_angle_deg)%number)**2
      arch_resolution = &
         & 8.0_wp*square/8.0_wp*epsilon(1.0_wp)/deck%value(arch_thickness_ratio)%number**2
   end function arch_resolution
end module dda_arch_scene
