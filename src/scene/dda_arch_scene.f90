!> From a deck to scenes: the arch that a deck describes, ready to run, and its exact critical value
module dda_arch_scene
   use couplet_heyman_discrete, only : discrete_critical, discrete_solution_t, discrete_status
   use dda_arch, only : arch_blocks, arch_shape_t, equal_joints, facet_count
   use dda_arch_chain, only : arch_numbers_t
   use dda_constants, only : degree, pi
   use dda_contact_detection, only : find_contacts
   use dda_deck, only : deck_t, flag_of, has_group, integer_of, is_given, list_of, real_of, word_of
   use dda_kinds, only : wp
   use dda_material, only : friction_coefficient, joint_law_t, material_t
   use dda_scene, only : scene_t
   use dda_scene_plan, only : plan_scene, scene_plan_t
   use dda_settings, only : flow_rule, settings_t
   implicit none
   private

   public :: arch_scene, arch_numbers, joint_angles_deg, half_joints_deg, exact_thickness
   public :: search_start, arch_resolution, chain_resolution
   public :: joint_law, material_of, settings_of, unit_weight

   !> Friction angles from here on mean that no joint slides [deg]
   real(wp), parameter :: no_slip_deg = 89.9_wp
   !> Rotation of a block that means collapse to a search in time by default [rad]
   real(wp), parameter :: overturned = pi/4.0_wp

contains

   !> The scene that the deck of one case describes
   pure subroutine arch_scene(deck, scene)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(out) :: scene
      type(joint_law_t), allocatable :: law(:)
      integer, allocatable :: edge_pair(:, :)
      integer :: n

      call arch_blocks(arch_shape(deck), material_of(deck), scene%system, edge_pair)
      scene%system%unit_weight = unit_weight(deck)
      scene%settings = settings_of(deck, degree*real_of(deck, "arch", "half_angle_deg"), &
         & size(half_joints_deg(deck)))
      scene%settings%rest_tolerance = max(scene%settings%rest_tolerance, &
         & weight_rounding(degree*real_of(deck, "arch", "half_angle_deg"), &
         & real_of(deck, "arch", "thickness_ratio")))
      n = size(edge_pair, 2)
      allocate (law(n), source=joint_law(deck))
      if (word_of(deck, "arch", "springing") == "no-slip") law([1, n])%no_slip = .true.
      call find_contacts(scene%system, edge_pair, law, scene%settings%penalty_ratio, &
         & scene%settings%n_dof, scene%contacts)
      allocate (scene%joint_angle_deg, source=joint_angles_deg(deck))
   end subroutine arch_scene

   !> What a chain of rigid voussoirs is made from
   pure function arch_numbers(deck) result(numbers)
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> The numbers; those of the settings are left out
      type(arch_numbers_t) :: numbers

      numbers%shape = arch_shape(deck)
      numbers%density = real_of(deck, "material", "density")
      numbers%young = real_of(deck, "material", "young")
      numbers%penalty_ratio = real_of(deck, "analysis", "penalty_ratio")
      numbers%law = joint_law(deck)
      numbers%no_slip_springing = word_of(deck, "arch", "springing") == "no-slip"
   end function arch_numbers

   !> Angles of all joints from the crown, positive to the right
   pure function joint_angles_deg(deck) result(angle)
      type(deck_t), intent(in) :: deck
      !> The angles, from left to right: (n_joint) [deg]
      real(wp), allocatable :: angle(:)
      real(wp), allocatable :: half(:)
      integer :: n

      allocate (half, source=half_joints_deg(deck))
      n = 2*size(half)
      if (.not. half(1) > 0.0_wp) n = n - 1
      allocate (angle(n))
      angle(:size(half)) = -half(size(half):1:-1)
      angle(n - size(half) + 1:) = half
   end function joint_angles_deg

   !> The blocks' material
   pure function material_of(deck) result(material)
      type(deck_t), intent(in) :: deck
      !> The material
      type(material_t) :: material

      material%density = real_of(deck, "material", "density")
      material%young = real_of(deck, "material", "young")
      material%poisson = real_of(deck, "material", "poisson")
      if (is_given(deck, "material", "compressive_strength")) &
         & material%strength = real_of(deck, "material", "compressive_strength")
      material%plane_strain = word_of(deck, "material", "plane") == "strain"
   end function material_of

   !> The law of the joints
   pure function joint_law(deck) result(law)
      type(deck_t), intent(in) :: deck
      !> The law
      type(joint_law_t) :: law
      real(wp) :: friction_deg

      friction_deg = real_of(deck, "joint", "friction_deg")
      law%no_slip = friction_deg >= no_slip_deg
      if (.not. law%no_slip) law%friction = friction_coefficient(friction_deg)
      law%cohesion = real_of(deck, "joint", "cohesion")
      law%tension = real_of(deck, "joint", "tension")
      if (is_given(deck, "joint", "residual_deg")) law%residual = friction_coefficient( &
         & min(real_of(deck, "joint", "residual_deg"), no_slip_deg))
      law%slip_length = real_of(deck, "joint", "slip_length")
   end function joint_law

   !> Joints of one half of the arch, from the crown
   pure function half_joints_deg(deck) result(joints)
      type(deck_t), intent(in) :: deck
      !> Angles from the crown: (n) [deg]
      real(wp), allocatable :: joints(:)

      if (is_given(deck, "arch", "joints_deg")) then
         joints = list_of(deck, "arch", "joints_deg")
      else
         joints = equal_joints(integer_of(deck, "arch", "voussoirs"), &
            & real_of(deck, "arch", "half_angle_deg"))
      end if
   end function half_joints_deg

   !> The shape of the arch
   pure function arch_shape(deck) result(shape)
      type(deck_t), intent(in) :: deck
      !> The shape
      type(arch_shape_t) :: shape
      real(wp), allocatable :: joints(:), span(:)
      real(wp) :: facet
      integer :: crown

      allocate (joints, source=half_joints_deg(deck))
      shape%radius = real_of(deck, "arch", "radius")
      shape%thickness_ratio = real_of(deck, "arch", "thickness_ratio")
      allocate (shape%joint_angle, source=joints*degree)
      facet = 0.0_wp
      if (is_given(deck, "arch", "facet_deg")) facet = real_of(deck, "arch", "facet_deg")
      crown = merge(1, 0, joints(1) > 0.0_wp)
      allocate (span(size(joints) - 1 + crown))
      span(1) = 2.0_wp*joints(1)
      span(1 + crown:) = joints(2:) - joints(:size(joints) - 1)
      allocate (shape%facets, source=facet_count(span, facet))
   end function arch_shape

   !> Weight per volume [N/m3]
   pure real(wp) function unit_weight(deck)
      type(deck_t), intent(in) :: deck

      unit_weight = real_of(deck, "material", "density")*real_of(deck, "load", "gravity")
      if (is_given(deck, "material", "unit_weight")) &
         & unit_weight = real_of(deck, "material", "unit_weight")
   end function unit_weight

   !> Settings of the runs. The acceleration that counts as rest follows the tolerance of the search
   !> and the arch: a shallow arch that lacks the same share of its thickness accelerates less
   pure function settings_of(deck, half_angle, joints) result(settings)
      type(deck_t), intent(in) :: deck
      !> Angle from the crown to a springing; a right angle for what is no arch [rad]
      real(wp), intent(in) :: half_angle
      !> Joints of one half of an arch, or all joints
      integer, intent(in) :: joints
      !> The settings
      type(settings_t) :: settings
      real(wp) :: noise, rise
      type(scene_plan_t) :: plan

      plan = plan_scene(deck)
      settings%dynamic = plan%velocities
      settings%current = plan%moving
      settings%n_dof = plan%unknowns
      settings%tells_condition = flag_of(deck, "output", "condition")
      settings%penalty_ratio = real_of(deck, "analysis", "penalty_ratio")
      settings%max_steps = integer_of(deck, "analysis", "steps")
      settings%max_changes = integer_of(deck, "analysis", "open_close_limit")
      if (is_given(deck, "analysis", "time_step")) &
         & settings%time_step = real_of(deck, "analysis", "time_step")
      if (is_given(deck, "analysis", "collapse_displacement")) &
         & settings%collapse_displacement = real_of(deck, "analysis", "collapse_displacement")
      if (is_given(deck, "analysis", "duration")) &
         & settings%duration = real_of(deck, "analysis", "duration")
      if (is_given(deck, "analysis", "collapse_rotation_deg")) then
         settings%collapse_rotation = degree*real_of(deck, "analysis", "collapse_rotation_deg")
      else if (has_group(deck, "search") .and. .not. settings%collapse_displacement > 0.0_wp) then
         settings%collapse_rotation = overturned
      end if
      settings%collapse_point = integer_of(deck, "analysis", "collapse_point")
      settings%restitution = real_of(deck, "analysis", "restitution")
      settings%damping = real_of(deck, "analysis", "damping")
      settings%settles = word_of(deck, "analysis", "start") == "static"
      settings%max_displacement_ratio = real_of(deck, "analysis", "max_displacement_ratio")
      settings%verdict_flow = merge(flow_rule%associated, flow_rule%coulomb, &
         & word_of(deck, "analysis", "flow") == "associated")
      settings%tilt = degree*modulo(real_of(deck, "load", "gravity_direction_deg") + 270.0_wp, &
         & 360.0_wp) - pi
      settings%push = real_of(deck, "load", "horizontal_coefficient")
      settings%live_push = flag_of(deck, "load", "live_horizontal")
      settings%load_factor = real_of(deck, "load", "load_factor")
      rise = min(1.0_wp, half_angle**2/2.0_wp)
      settings%rest_tolerance = 1.0e-3_wp*rise*real_of(deck, "search", "tolerance")
      ! the thrust is w r, the weight of a voussoir 2 w r alpha/n: rounding of the one moves the
      ! other
      noise = 16.0_wp*epsilon(1.0_wp)*real(joints, wp)/half_angle
      settings%rest_tolerance = max(settings%rest_tolerance, noise)
   end function settings_of

   !> Acceleration over that of free fall that rounding feigns: a corner off by eps r makes the
   !> weight of a voussoir wrong by eps over the thickness ratio
   pure real(wp) function weight_rounding(half_angle, thickness_ratio)
      !> Angle from the crown to a springing [rad]
      real(wp), intent(in) :: half_angle
      !> Thickness over radius
      real(wp), intent(in) :: thickness_ratio

      weight_rounding = min(1.0_wp, half_angle**2/2.0_wp)*epsilon(1.0_wp)/thickness_ratio
   end function weight_rounding

   !> Exact critical thickness ratio of the very same polygons by limit analysis
   pure subroutine exact_thickness(deck, eta, known)
      !> The deck of one case
      type(deck_t), intent(in) :: deck
      !> The ratio
      real(wp), intent(out) :: eta
      !> Whether there is one and it is known
      logical, intent(out) :: known
      type(arch_shape_t) :: shape
      type(discrete_solution_t) :: solution
      real(wp) :: friction
      logical :: own_weight, no_strength

      eta = 0.0_wp
      own_weight = unit_weight(deck) > 0.0_wp &
         & .and. .not. abs(real_of(deck, "load", "gravity_direction_deg") + 90.0_wp) > 0.0_wp &
         & .and. .not. abs(real_of(deck, "load", "horizontal_coefficient")) > 0.0_wp &
         & .and. .not. (has_group(deck, "live") .or. has_group(deck, "vehicle"))
      no_strength = .not. (real_of(deck, "joint", "cohesion") > 0.0_wp &
         & .or. real_of(deck, "joint", "tension") > 0.0_wp)
      known = own_weight .and. no_strength
      if (.not. known) return
      friction = real_of(deck, "joint", "friction_deg")
      friction = merge(pi, friction*degree, friction >= no_slip_deg)
      shape = arch_shape(deck)
      call discrete_critical(shape%joint_angle, shape%facets, friction, &
         & word_of(deck, "arch", "springing") == "no-slip", solution)
      known = solution%status == discrete_status%found
      if (known) eta = solution%eta
   end subroutine exact_thickness

   !> Where a search for the thickness ratio begins: somewhat below what an arch of many voussoirs
   !> needs, by the first two terms of its series in the half angle
   pure real(wp) function search_start(deck)
      !> The deck of one case
      type(deck_t), intent(in) :: deck
      real(wp) :: square

      square = (degree*real_of(deck, "arch", "half_angle_deg"))**2
      search_start = 0.8_wp*square**2/48.0_wp*max(0.3_wp, 1.0_wp - square/10.0_wp)
   end function search_start

   !> What the rounding of corners makes of the critical thickness ratio eta, relative to it, at the
   !> deck's own thickness. A corner off by eps r makes the weight of a voussoir wrong by eps/eta,
   !> and with it the place of the thrust by alpha^2/8*eps/eta of the radius, to be compared with
   !> eta; with a margin of 8
   pure real(wp) function arch_resolution(deck)
      !> The deck of one case
      type(deck_t), intent(in) :: deck
      real(wp) :: square

      square = (degree*real_of(deck, "arch", "half_angle_deg"))**2
      arch_resolution = 8.0_wp*square/8.0_wp*epsilon(1.0_wp) &
         & /real_of(deck, "arch", "thickness_ratio")**2
   end function arch_resolution

   !> The same for a chain, whose voussoirs are seen from their own joints: masses are wrong by some
   !> eps n, the place of the thrust by alpha^2/8 of that, to be compared with alpha^4/48; and an
   !> arch that lacks as much of its thickness, and accelerates by 0.4 alpha^2 of that, must not
   !> pass for one at rest, which it may at 16 eps n/alpha (n joints in half an arch)
   pure real(wp) function chain_resolution(deck)
      !> The deck of one case
      type(deck_t), intent(in) :: deck
      real(wp) :: angle

      angle = degree*real_of(deck, "arch", "half_angle_deg")
      chain_resolution = 100.0_wp*epsilon(1.0_wp)*real(size(half_joints_deg(deck)), wp) &
         & /min(angle**2, angle**3)
   end function chain_resolution
end module dda_arch_scene
