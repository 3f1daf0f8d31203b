!> Index of every key and group of the registry, by name: deck%value(arch_radius)
module dda_key_names
   implicit none
   public

   !> Keys, in the order of the registry
   enum, bind(c)
      enumerator :: scene_title = 1, scene_kind, scene_geometry, scene_analysis, &
         & scene_contact_tolerance
      enumerator :: arch_radius, arch_thickness_ratio, arch_half_angle_deg, arch_voussoirs, &
         & arch_joints_deg, arch_facet_deg, arch_springing, arch_abutment_size, &
         & arch_abutment_overhang, arch_shape, arch_span, arch_rise, arch_right_rise, &
         & arch_thickness, arch_crown_thickness, arch_springing_thickness, arch_joint_direction, &
         & arch_rings, arch_spans, arch_pier_width, arch_pier_height, arch_pier_courses, &
         & arch_buttress_width, arch_buttress_height, arch_lune_deg
      enumerator :: support_left_dx, support_left_dy, support_left_rotation_deg, &
         & support_right_dx, support_right_dy, support_right_rotation_deg
      enumerator :: material_density, material_unit_weight, material_young, material_poisson, &
         & material_compressive_strength, material_plane
      enumerator :: joint_friction_deg, joint_cohesion, joint_tension, joint_residual_deg, &
         & joint_slip_length
      enumerator :: load_gravity, load_gravity_direction_deg, load_horizontal_coefficient, &
         & load_load_factor, load_live_horizontal, load_displacement_factor, load_water_rise
      enumerator :: live_x, live_y, live_fx, live_fy
      enumerator :: vehicle_axles, vehicle_spacings, vehicle_length, vehicle_position, &
         & vehicle_worst, vehicle_both_directions
      enumerator :: fill_height, fill_unit_weight, fill_friction_deg, fill_spread, &
         & fill_passive_coefficient, fill_passive_share, fill_passive_stiffness, &
         & fill_backing_height, fill_backing_unit_weight
      enumerator :: tie_x1, tie_y1, tie_x2, tie_y2, tie_ea, tie_strength, tie_prestress
      enumerator :: ground_scale, ground_pulse, ground_record, ground_amplitude, &
         & ground_duration, ground_frequency, ground_direction_deg, ground_columns, &
         & ground_quantity, ground_unit
      enumerator :: analysis_mode, analysis_geometry, analysis_flow, analysis_steps, &
         & analysis_max_displacement_ratio, analysis_time_step, analysis_duration, &
         & analysis_restitution, analysis_damping, analysis_penalty_ratio, &
         & analysis_collapse_displacement, analysis_collapse_rotation_deg, &
         & analysis_collapse_point, analysis_open_close_limit, analysis_restart, analysis_start, &
         & analysis_unknowns
      enumerator :: limerick_dynamic, limerick_auto_penalty, limerick_penetration_ratio, &
         & limerick_close_ratio, limerick_open_ratio, limerick_overlap_deg, &
         & limerick_stiffness_ratio, limerick_rotation, limerick_contact_damping, &
         & limerick_gravity_steps
      enumerator :: search_parameter, search_low, search_high, search_tolerance
      enumerator :: sweep_parameter, sweep_values, sweep_texts, sweep_first, sweep_last, &
         & sweep_count, sweep_linked
      enumerator :: output_vtu, output_joints, output_blocks, output_proof, output_thrust_bar, &
         & output_reactions, output_thrust_joint, output_condition, output_frames, &
         & output_energy, output_restart, output_max_cases
   end enum

   !> Groups, likewise
   enum, bind(c)
      enumerator :: scene_group = 1, arch_group, support_group, material_group, joint_group, &
         & load_group, live_group, vehicle_group, fill_group, tie_group, ground_group, &
         & analysis_group, limerick_group, search_group, sweep_group, output_group
   end enum
end module dda_key_names
