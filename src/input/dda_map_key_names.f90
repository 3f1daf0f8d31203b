!> The place of every key of the registry of `dda lines`, by name: group%value(outline_left)
module dda_map_key_names
   implicit none
   public

   !> Keys, in the order of the registry
   enum, bind(c)
      enumerator :: lines_title = 1, lines_seed, lines_edge_node_ratio, lines_form
      enumerator :: outline_left, outline_right, outline_bottom, outline_top, outline_x, &
         & outline_y, outline_fixed, outline_hold_depth, outline_material
      enumerator :: slope_x, slope_y, slope_foot_x, slope_foot_y, slope_face_deg, &
         & slope_bench_height, slope_bench_width, slope_benches
      enumerator :: opening_shape, opening_x, opening_y, opening_width, opening_height, &
         & opening_wall, opening_rise, opening_sides, opening_corner_x, opening_corner_y, &
         & opening_material, opening_excavated
      enumerator :: joint_set_dip_deg, joint_set_dip_spread_deg, joint_set_spacing, &
         & joint_set_spacing_law, joint_set_spacing_randomness, joint_set_trace, &
         & joint_set_trace_law, joint_set_trace_randomness, joint_set_bridge, &
         & joint_set_bridge_law, joint_set_bridge_randomness, joint_set_material, &
         & joint_set_seed, joint_set_through_x, joint_set_through_y, joint_set_region_x, &
         & joint_set_region_y
      enumerator :: line_role, line_x, line_y, line_material, line_stiffness, line_strength, &
         & line_prestress
      enumerator :: point_role, point_x, point_y
      enumerator :: bolts_opening, bolts_number, bolts_from_deg, bolts_to_deg, bolts_length, &
         & bolts_inset, bolts_stiffness, bolts_strength, bolts_prestress
   end enum
end module dda_map_key_names
