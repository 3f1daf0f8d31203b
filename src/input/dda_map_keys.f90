!> The registry of `dda lines`: keys of a joint map and their index by name:
!> group%value(outline_left)
module dda_map_keys
   use dda_deck_key, only : group_t, key_kind, key_t
   use dda_kinds, only : wp
   implicit none
   public
   private :: far, near, laws, law_meaning, randomness_meaning, outline_keys, surface_keys, &
      & set_keys, hand_keys, group_t, key_kind, key_t, wp

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

   !> Largest coordinate and length
   real(wp), parameter :: far = 1.0e9_wp
   !> Smallest length
   real(wp), parameter :: near = 1.0e-6_wp
   !> Words of the laws
   character(len=*), parameter :: laws = "constant uniform exponential normal"
   !> What a law is
   character(len=*), parameter :: law_meaning = "How it is spread about its mean: evenly, "// &
      & "negative exponential, normal."
   !> What a degree of randomness is
   character(len=*), parameter :: randomness_meaning = "Largest deviation of 'uniform', "// &
      & "standard deviation of 'normal', over the mean."

   !> All groups
   type(group_t), parameter :: map_group(*) = [ &
      group_t("lines", "the file of lines"), &
      group_t("outline", "region that is cut into blocks"), &
      group_t("slope", "ground surface; without it the top of the outline"), &
      group_t("opening", "a tunnel; repeatable"), &
      group_t("joint_set", "a set of joints; repeatable"), &
      group_t("line", "single lines; repeatable"), &
      group_t("point", "single points; repeatable"), &
      group_t("bolts", "bolts around an opening; repeatable")]

   !> Keys of &lines and &outline
   type(key_t), parameter :: outline_keys(*) = [ &
      key_t("lines", "title", kind=key_kind%text, default="''", &
            meaning="Title of the map, one line."), &
      key_t("lines", "seed", kind=key_kind%whole, default="1", within=[0.0_wp, 1.0e8_wp], &
            meaning="Seed of all random numbers; equal seeds give equal lines."), &
      key_t("lines", "edge_node_ratio", default="0.001", within=[0.0_wp, 0.5_wp], &
            meaning="Shi's e00: largest distance of merged nodes over the model size."), &
      key_t("lines", "form", kind=key_kind%word, default="'plain'", words="plain ddaml", &
            meaning="Format of the file."), &
      key_t("outline", "left", unit="m", without="x and y", within=[-far, far], &
            meaning="Left side of a rectangle."), &
      key_t("outline", "right", unit="m", without="x and y", within=[-far, far], &
            meaning="Right side of a rectangle."), &
      key_t("outline", "bottom", unit="m", without="x and y", within=[-far, far], &
            meaning="Bottom of a rectangle."), &
      key_t("outline", "top", unit="m", without="&slope", within=[-far, far], &
            meaning="Top of a rectangle."), &
      key_t("outline", "x", kind=key_kind%numbers, unit="m", without="a rectangle", &
            within=[-far, far], meaning="x of the corners of a polygon."), &
      key_t("outline", "y", kind=key_kind%numbers, unit="m", without="a rectangle", &
            within=[-far, far], meaning="y of the corners of a polygon."), &
      key_t("outline", "fixed", kind=key_kind%texts, without="none", &
            meaning="Sides with fixed blocks: 'left', 'right', 'bottom'."), &
      key_t("outline", "hold_depth", unit="m", without="0.2 edge_node_ratio of the outline size", &
            within=[0.0_wp, far], above=0.0_wp, &
            meaning="Distance of the line that fixes the blocks from the side."), &
      key_t("outline", "material", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Joint material of the edges.")]

   !> Keys of &slope and &opening
   type(key_t), parameter :: surface_keys(*) = [ &
      key_t("slope", "x", kind=key_kind%numbers, unit="m", without="benches", within=[-far, far], &
            meaning="x of the surface, from left to right."), &
      key_t("slope", "y", kind=key_kind%numbers, unit="m", without="benches", within=[-far, far], &
            meaning="y of the surface, from left to right."), &
      key_t("slope", "foot_x", unit="m", without="x and y", within=[-far, far], &
            meaning="x of the foot of a benched slope that rises to the right."), &
      key_t("slope", "foot_y", unit="m", without="x and y", within=[-far, far], &
            meaning="y of the foot of a benched slope."), &
      key_t("slope", "face_deg", unit="deg", default="60.0", within=[0.0_wp, 90.0_wp], &
            above=0.0_wp, meaning="Angle of each face."), &
      key_t("slope", "bench_height", unit="m", default="10.0", within=[near, far], &
            meaning="Height of each face."), &
      key_t("slope", "bench_width", unit="m", default="0.0", within=[0.0_wp, far], &
            meaning="Width of the berm between two faces."), &
      key_t("slope", "benches", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Number of faces."), &
      key_t("opening", "shape", kind=key_kind%word, default="'circle'", &
            words="circle ellipse arch horseshoe polygon", &
            meaning="Shape; 'arch' is a half ellipse on walls, 'horseshoe' narrows downwards."), &
      key_t("opening", "x", unit="m", default="0.0", within=[-far, far], &
            meaning="x of the centre, or of the middle of the floor ('arch', 'horseshoe')."), &
      key_t("opening", "y", unit="m", default="0.0", within=[-far, far], &
            meaning="y of the centre, or of the floor ('arch', 'horseshoe')."), &
      key_t("opening", "width", unit="m", default="5.0", within=[near, far], &
            meaning="Largest width."), &
      key_t("opening", "height", unit="m", without="the width", within=[near, far], &
            meaning="Height of an ellipse."), &
      key_t("opening", "wall", unit="m", default="0.0", within=[0.0_wp, far], &
            meaning="Height of the walls."), &
      key_t("opening", "rise", unit="m", without="half the width", within=[near, far], &
            meaning="Height of the arch above the walls."), &
      key_t("opening", "sides", kind=key_kind%whole, default="24", within=[3.0_wp, 10000.0_wp], &
            meaning="Number of chords of the curve."), &
      key_t("opening", "corner_x", kind=key_kind%numbers, unit="m", without="another shape", &
            within=[-far, far], meaning="x of the corners of a polygon."), &
      key_t("opening", "corner_y", kind=key_kind%numbers, unit="m", without="another shape", &
            within=[-far, far], meaning="y of the corners of a polygon."), &
      key_t("opening", "material", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Joint material of the edges."), &
      key_t("opening", "excavated", kind=key_kind%flag, default=".true.", &
            meaning="Remove the rock inside; otherwise joints cross the outline.")]

   !> Keys of &joint_set
   type(key_t), parameter :: set_keys(*) = [ &
      key_t("joint_set", "dip_deg", unit="deg", default="0.0", within=[-180.0_wp, 180.0_wp], &
            meaning="Angle of the joints, anticlockwise from x."), &
      key_t("joint_set", "dip_spread_deg", unit="deg", default="0.0", within=[0.0_wp, 90.0_wp], &
            meaning="Largest deviation from dip_deg, uniformly distributed."), &
      key_t("joint_set", "spacing", unit="m", default="1.0", within=[near, far], &
            meaning="Mean distance of neighbours, normal to the joints."), &
      key_t("joint_set", "spacing_law", kind=key_kind%word, default="'constant'", words=laws, &
            meaning=law_meaning), &
      key_t("joint_set", "spacing_randomness", default="0.0", within=[0.0_wp, 1.0_wp], &
            meaning=randomness_meaning), &
      key_t("joint_set", "trace", unit="m", without="unlimited joints", within=[near, far], &
            meaning="Mean length of a trace."), &
      key_t("joint_set", "trace_law", kind=key_kind%word, default="'constant'", words=laws, &
            meaning=law_meaning), &
      key_t("joint_set", "trace_randomness", default="0.0", within=[0.0_wp, 1.0_wp], &
            meaning=randomness_meaning), &
      key_t("joint_set", "bridge", unit="m", default="0.0", within=[0.0_wp, far], &
            meaning="Mean length of intact rock between two traces of a joint."), &
      key_t("joint_set", "bridge_law", kind=key_kind%word, default="'constant'", words=laws, &
            meaning=law_meaning), &
      key_t("joint_set", "bridge_randomness", default="0.0", within=[0.0_wp, 1.0_wp], &
            meaning=randomness_meaning), &
      key_t("joint_set", "material", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Joint material."), &
      key_t("joint_set", "seed", kind=key_kind%whole, without="number of the set", &
            within=[0.0_wp, 1000.0_wp], meaning="Seed of the set."), &
      key_t("joint_set", "through_x", unit="m", without="random", within=[-far, far], &
            meaning="x of a point on one joint of the set."), &
      key_t("joint_set", "through_y", unit="m", without="random", within=[-far, far], &
            meaning="y of a point on one joint of the set."), &
      key_t("joint_set", "region_x", kind=key_kind%numbers, unit="m", without="the whole outline", &
            within=[-far, far], meaning="x of the corners of the region with the set."), &
      key_t("joint_set", "region_y", kind=key_kind%numbers, unit="m", without="the whole outline", &
            within=[-far, far], meaning="y of the corners of the region with the set.")]

   !> Keys of &line, &point and &bolts
   type(key_t), parameter :: hand_keys(*) = [ &
      key_t("line", "role", kind=key_kind%word, default="'joint'", &
            words="joint material fix bolt", &
            meaning="Joint, boundary of a material, line that fixes blocks, or bolt."), &
      key_t("line", "x", kind=key_kind%numbers, unit="m", without="required", within=[-far, far], &
            meaning="x of two points or more."), &
      key_t("line", "y", kind=key_kind%numbers, unit="m", without="required", within=[-far, far], &
            meaning="y of two points or more."), &
      key_t("line", "material", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Joint material, or material of the blocks."), &
      key_t("line", "stiffness", unit="N/m", default="1e8", within=[0.0_wp, 1.0e30_wp], &
            above=0.0_wp, meaning="Force of a bolt per elongation."), &
      key_t("line", "strength", unit="N", default="1e30", within=[0.0_wp, 1.0e30_wp], &
            meaning="Largest force of a bolt."), &
      key_t("line", "prestress", unit="N", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Initial force of a bolt."), &
      key_t("point", "role", kind=key_kind%word, default="'measure'", &
            words="measure fix load hole", &
            meaning="Monitoring point, restraint, load, or hole (the block is removed)."), &
      key_t("point", "x", kind=key_kind%numbers, unit="m", without="required", within=[-far, far], &
            meaning="x of the points."), &
      key_t("point", "y", kind=key_kind%numbers, unit="m", without="required", within=[-far, far], &
            meaning="y of the points."), &
      key_t("bolts", "opening", kind=key_kind%whole, default="1", within=[1.0_wp, 1.0e5_wp], &
            meaning="Number of the opening."), &
      key_t("bolts", "number", kind=key_kind%whole, default="1", within=[1.0_wp, 1.0e5_wp], &
            meaning="Number of bolts."), &
      key_t("bolts", "from_deg", unit="deg", default="0.0", within=[-360.0_wp, 360.0_wp], &
            meaning="Direction of the first bolt from the middle of the opening."), &
      key_t("bolts", "to_deg", unit="deg", default="180.0", within=[-360.0_wp, 360.0_wp], &
            meaning="Direction of the last bolt; the others are evenly spaced."), &
      key_t("bolts", "length", unit="m", default="3.0", within=[near, far], &
            meaning="Length of each bolt."), &
      key_t("bolts", "inset", unit="m", default="0.05", within=[near, far], &
            meaning="Depth of the inner end of a bolt in the rock."), &
      key_t("bolts", "stiffness", unit="N/m", default="1e8", within=[0.0_wp, 1.0e30_wp], &
            above=0.0_wp, meaning="Force of a bolt per elongation."), &
      key_t("bolts", "strength", unit="N", default="1e30", within=[0.0_wp, 1.0e30_wp], &
            meaning="Largest force of a bolt."), &
      key_t("bolts", "prestress", unit="N", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Initial force of a bolt.")]

   !> All keys
   type(key_t), parameter :: map_key(*) = [outline_keys, surface_keys, set_keys, hand_keys]
end module dda_map_keys
