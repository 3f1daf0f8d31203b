!> What a deck says, by name: a component for each key of the registry
module dda_input
   use dda_deck_key, only : word_length
   use dda_kinds, only : wp
   implicit none
   private

   public :: input_list_t, input_t, input_text_t, input_value_t

   !> A number, whole number, flag or word; the default where it is not given
   type :: input_value_t
      logical :: given = .false.
      real(wp) :: number = 0.0_wp
      integer :: whole = 0
      logical :: flag = .false.
      character(len=word_length) :: word = ""
   end type input_value_t

   !> A text
   type :: input_text_t
      logical :: given = .false.
      character(len=:), allocatable :: text
   end type input_text_t

   !> A list of numbers; of none where it is not given
   type :: input_list_t
      logical :: given = .false.
      real(wp), allocatable :: numbers(:)
   end type input_list_t

   !> A group of keys, and whether the deck has it
   type :: group_input_t
      logical :: given = .false.
   end type group_input_t

   !> &scene: what is studied
   type, extends(group_input_t) :: scene_input_t
      type(input_text_t) :: title, geometry, analysis
      type(input_value_t) :: kind
   end type scene_input_t

   !> &arch: the shape of an arch
   type, extends(group_input_t) :: arch_input_t
      type(input_value_t) :: radius, thickness_ratio, half_angle_deg, voussoirs, facet_deg, &
         & springing, abutment_size, abutment_overhang, shape, span, rise, right_rise, thickness, &
         & crown_thickness, springing_thickness, joint_direction, rings, spans, pier_width, &
         & pier_height, pier_courses, buttress_width, buttress_height, lune_deg
      type(input_list_t) :: joints_deg
   end type arch_input_t

   !> &material: the blocks' material
   type, extends(group_input_t) :: material_input_t
      type(input_value_t) :: density, unit_weight, young, poisson, compressive_strength, plane
   end type material_input_t

   !> &joint: the law of the joints
   type, extends(group_input_t) :: joint_input_t
      type(input_value_t) :: friction_deg, cohesion, tension, residual_deg, slip_length
   end type joint_input_t

   !> &load: what acts on the blocks
   type, extends(group_input_t) :: load_input_t
      type(input_value_t) :: gravity, gravity_direction_deg, horizontal_coefficient, load_factor, &
         & live_horizontal, displacement_factor, water_rise
   end type load_input_t

   !> &live: forces that the load factor multiplies
   type, extends(group_input_t) :: live_input_t
      type(input_list_t) :: x, y, fx, fy
   end type live_input_t

   !> &vehicle: axles above the blocks
   type, extends(group_input_t) :: vehicle_input_t
      type(input_list_t) :: axles, spacings
      type(input_value_t) :: length, position, worst
   end type vehicle_input_t

   !> &fill: what lies on an arch
   type, extends(group_input_t) :: fill_input_t
      type(input_value_t) :: height, unit_weight, friction_deg, spread, passive_coefficient, &
         & passive_share, passive_stiffness, backing_height, backing_unit_weight
   end type fill_input_t

   !> &tie: bars between blocks of an arch
   type, extends(group_input_t) :: tie_input_t
      type(input_list_t) :: x1, y1, x2, y2, ea, strength, prestress
   end type tie_input_t

   !> &ground: how the ground moves
   type, extends(group_input_t) :: ground_input_t
      type(input_value_t) :: scale, pulse, amplitude, duration, frequency, direction_deg, &
         & quantity, unit
      type(input_text_t) :: record, columns
   end type ground_input_t

   !> &analysis: how a case is computed
   type, extends(group_input_t) :: analysis_input_t
      type(input_value_t) :: mode, geometry, flow, steps, max_displacement_ratio, time_step, &
         & duration, restitution, damping, penalty_ratio, collapse_displacement, &
         & collapse_rotation_deg, collapse_point, open_close_limit, start, unknowns
      type(input_text_t) :: restart
   end type analysis_input_t

   !> &limerick: the original's scheme
   type, extends(group_input_t) :: limerick_input_t
      type(input_value_t) :: dynamic, auto_penalty, penetration_ratio, close_ratio, open_ratio, &
         & overlap_deg, stiffness_ratio, rotation, contact_damping, gravity_steps
   end type limerick_input_t

   !> &search: what is searched
   type, extends(group_input_t) :: search_input_t
      type(input_text_t) :: parameter
      type(input_value_t) :: low, high, tolerance
   end type search_input_t

   !> &sweep: the sweep that is being read
   type, extends(group_input_t) :: sweep_input_t
      type(input_text_t) :: parameter
      type(input_list_t) :: values, texts
      type(input_value_t) :: first, last, count, linked
   end type sweep_input_t

   !> &output: what is written
   type, extends(group_input_t) :: output_input_t
      type(input_value_t) :: vtu, joints, blocks, proof, thrust_bar, reactions, thrust_joint, &
         & condition, frames, energy, restart, max_cases
   end type output_input_t

   !> All groups. A key that is not there does not compile
   type :: input_t
      type(scene_input_t) :: scene
      type(arch_input_t) :: arch
      type(material_input_t) :: material
      type(joint_input_t) :: joint
      type(load_input_t) :: load
      type(live_input_t) :: live
      type(vehicle_input_t) :: vehicle
      type(fill_input_t) :: fill
      type(tie_input_t) :: tie
      type(ground_input_t) :: ground
      type(analysis_input_t) :: analysis
      type(limerick_input_t) :: limerick
      type(search_input_t) :: search
      type(sweep_input_t) :: sweep
      type(output_input_t) :: output
   end type input_t
end module dda_input
