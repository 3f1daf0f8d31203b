!> The registry of all groups and keys of a deck
!>
!> A new key is one entry here, its name in dda_key_names, and its paragraph in docs/input.md.
!> Reading, range checks, --set, sweeps, searches and the printed help follow from the entry.
module dda_deck_keys
   use dda_arch_keys, only : arch_keys, fill_keys, support_keys, tie_keys
   use dda_deck_key, only : group_t, key_kind, key_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: deck_key, deck_group, key_index, group_index, joint_keys, material_keys

   !> All groups, in the order of the contract
   type(group_t), parameter :: deck_group(*) = [ &
      group_t("scene", "subject of the study"), &
      group_t("arch", "shape of an arch, with its rings, spans and piers"), &
      group_t("support", "displacements of the springings of an arch"), &
      group_t("material", "material of the blocks"), &
      group_t("joint", "Mohr-Coulomb law of the joints"), &
      group_t("load", "loads on all blocks"), &
      group_t("live", "forces on points, multiplied by the load factor"), &
      group_t("vehicle", "axle loads above the blocks, multiplied by the load factor"), &
      group_t("fill", "fill and backing above an arch"), &
      group_t("tie", "bars between two blocks of an arch"), &
      group_t("ground", "ground motion, with mode = 'dynamic'"), &
      group_t("analysis", "computation of a single case"), &
      group_t("limerick", "Shi's scheme, with mode = 'limerick'"), &
      group_t("search", "critical value of one parameter"), &
      group_t("sweep", "one case per value; up to 8 such groups"), &
      group_t("output", "tables and files of a run")]

   !> Keys of &scene
   type(key_t), parameter :: scene_keys(*) = [ &
      key_t("scene", "title", kind=key_kind%text, default="''", varies=.false., &
            meaning="Title of the deck, one line."), &
      key_t("scene", "kind", kind=key_kind%word, default="'arch'", words="arch lines blocks", &
            varies=.false., &
            meaning="Source of the blocks: &arch, a file of lines, or a file of blocks."), &
      key_t("scene", "geometry", kind=key_kind%text, without="an arch", varies=.false., &
            meaning="File of lines or of blocks, relative to the deck or absolute."), &
      key_t("scene", "analysis", kind=key_kind%text, without="the keys of this deck", &
            varies=.false., &
            meaning="File of materials and loads (.ana, plain or DDAML) for kind = 'lines'."), &
      key_t("scene", "contact_tolerance", default="1e-4", within=[1.0e-12_wp, 1.0e-2_wp], &
            varies=.false., meaning="Largest gap of a joint over the size of the smaller block.")]

   !> Keys of &material
   type(key_t), parameter :: material_keys(*) = [ &
      key_t("material", "density", unit="kg/m3", default="2240.0", within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Mass per volume."), &
      key_t("material", "unit_weight", unit="N/m3", without="density times gravity", &
            within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Weight per volume; replaces density times gravity."), &
      key_t("material", "young", unit="Pa", default="5e9", within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Young's modulus of the blocks."), &
      key_t("material", "poisson", default="0.2", within=[-1.0_wp, 0.5_wp], above=-1.0_wp, &
            below=0.5_wp, meaning="Poisson's ratio of the blocks."), &
      key_t("material", "compressive_strength", unit="Pa", without="unlimited", &
            within=[1.0e-12_wp, 1.0e30_wp], meaning="Compressive strength of the joints."), &
      key_t("material", "plane", kind=key_kind%word, default="'stress'", words="stress strain", &
            meaning="Plane stress or plane strain.")]

   !> Keys of &joint
   type(key_t), parameter :: joint_keys(*) = [ &
      key_t("joint", "friction_deg", unit="deg", default="50.0", within=[0.0_wp, 90.0_wp], &
            search_low=0.0_wp, search_high=90.0_wp, &
            meaning="Friction angle; from 89.9 degrees no joint slides."), &
      key_t("joint", "cohesion", unit="Pa", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Shear strength without normal force."), &
      key_t("joint", "tension", unit="Pa", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Tensile strength, at most the apex cohesion/tan(friction_deg)."), &
      key_t("joint", "residual_deg", unit="deg", without="friction_deg", within=[0.0_wp, 90.0_wp], &
            meaning="Residual friction angle of joints that have slid or opened."), &
      key_t("joint", "slip_length", unit="m", default="0.0", within=[0.0_wp, 1.0e9_wp], &
            meaning="Slip over which strength decreases to its residual; 0 for the first slip.")]

   !> Keys of &load
   type(key_t), parameter :: load_keys(*) = [ &
      key_t("load", "gravity", unit="m/s2", default="9.81", within=[0.0_wp, 1.0e12_wp], &
            meaning="Acceleration of gravity."), &
      key_t("load", "gravity_direction_deg", unit="deg", default="-90.0", &
            within=[-360.0_wp, 360.0_wp], &
            meaning="Direction of self-weight, anticlockwise from +x; -90 is down."), &
      key_t("load", "horizontal_coefficient", default="0.0", within=[-1.0e6_wp, 1.0e6_wp], &
            search_low=0.0_wp, search_high=1.0_wp, &
            meaning="Pseudo-static force towards +x on each block over its weight."), &
      key_t("load", "load_factor", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            search_low=0.0_wp, search_high=1.0e9_wp, &
            meaning="Factor of the live loads; dead loads are unchanged."), &
      key_t("load", "live_horizontal", kind=key_kind%flag, default=".false.", &
            meaning="Treat the forces of horizontal_coefficient as live loads."), &
      key_t("load", "displacement_factor", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="Factor of the displacements of &support and of a file of blocks."), &
      key_t("load", "water_rise", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="Rise of the piezometric lines of a file of blocks.")]

   !> Keys of &live
   type(key_t), parameter :: live_keys(*) = [ &
      key_t("live", "x", kind=key_kind%numbers, unit="m", without="no live load", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="x of each force."), &
      key_t("live", "y", kind=key_kind%numbers, unit="m", without="no live load", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="y of each force."), &
      key_t("live", "fx", kind=key_kind%numbers, unit="N/m", without="0 for each force", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Component of each force towards +x, per metre of depth."), &
      key_t("live", "fy", kind=key_kind%numbers, unit="N/m", without="0 for each force", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Component of each force upwards; -1000 acts down.")]

   !> Keys of &vehicle
   type(key_t), parameter :: vehicle_keys(*) = [ &
      key_t("vehicle", "axles", kind=key_kind%numbers, unit="N/m", without="no vehicle", &
            within=[0.0_wp, 1.0e30_wp], above=0.0_wp, meaning="Axle loads, per metre of depth."), &
      key_t("vehicle", "spacings", kind=key_kind%numbers, unit="m", without="a single axle", &
            within=[0.0_wp, 1.0e9_wp], above=0.0_wp, &
            meaning="Distances between the axles, from left to right."), &
      key_t("vehicle", "length", unit="m", default="0.3", within=[0.0_wp, 1.0e9_wp], &
            meaning="Loaded length per axle; 0 for a point."), &
      key_t("vehicle", "position", unit="m", without="required, or worst", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="x of the leftmost axle."), &
      key_t("vehicle", "worst", kind=key_kind%flag, default=".false.", &
            meaning="Search the position of the least load factor."), &
      key_t("vehicle", "both_directions", kind=key_kind%flag, default=".true.", &
            meaning="Include both directions of travel in worst.")]

   !> Keys of &ground
   type(key_t), parameter :: ground_keys(*) = [ &
      key_t("ground", "scale", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="Factor of the ground motion."), &
      key_t("ground", "pulse", kind=key_kind%word, without="a record, or the file of blocks", &
            words="rectangular sine", &
            meaning="Constant acceleration or sine, of given amplitude and duration."), &
      key_t("ground", "record", kind=key_kind%text, without="a pulse, or the file of blocks", &
            meaning="Record file, relative to the deck or absolute."), &
      key_t("ground", "amplitude", unit="m/s2", without="required for a pulse", &
            within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="Largest acceleration of the pulse; with a record, its scaled maximum."), &
      key_t("ground", "duration", unit="s", without="one period of a sine", &
            within=[1.0e-12_wp, 1.0e12_wp], bare=.false., &
            meaning="Duration of the pulse, required for a rectangular one."), &
      key_t("ground", "frequency", unit="Hz", without="required for a sine", &
            within=[1.0e-9_wp, 1.0e9_wp], meaning="Frequency of the sine."), &
      key_t("ground", "direction_deg", unit="deg", default="0.0", within=[-360.0_wp, 360.0_wp], &
            meaning="Direction of the pulse, or rotation of the record, anticlockwise from +x."), &
      key_t("ground", "columns", kind=key_kind%text, default="'1 2'", varies=.false., &
            meaning="Columns of time, x and y: numbers from 1, 0 for none, or header names."), &
      key_t("ground", "quantity", kind=key_kind%word, default="'acceleration'", &
            words="acceleration velocity displacement", meaning="Quantity of the record."), &
      key_t("ground", "unit", default="1.0", within=[1.0e-12_wp, 1.0e12_wp], &
            meaning="Unit of the record in m/s2, m/s or m: 9.81 for g.")]

   !> Keys of &analysis
   type(key_t), parameter :: analysis_keys(*) = [ &
      key_t("analysis", "mode", kind=key_kind%word, default="'static'", &
            words="static dynamic limerick", &
            meaning="Zero velocity at each step, velocity carried on, or Shi's scheme."), &
      key_t("analysis", "geometry", kind=key_kind%word, default="'reference'", &
            words="reference current", &
            meaning="Small displacements (limit analysis), or large ones (classical DDA)."), &
      key_t("analysis", "flow", kind=key_kind%word, default="'coulomb'", &
            words="coulomb associated", &
            meaning="Flow rule of a static verdict: Coulomb friction, or limit analysis."), &
      key_t("analysis", "steps", kind=key_kind%whole, default="400", within=[1.0_wp, 1.0e9_wp], &
            meaning="Maximum number of steps per run."), &
      key_t("analysis", "max_displacement_ratio", default="0.05", within=[1.0e-12_wp, 1.0_wp], &
            meaning="Largest corner displacement per step over the size of the smallest block."), &
      key_t("analysis", "time_step", unit="s", without="chosen by the program", &
            within=[1.0e-15_wp, 1.0e15_wp], &
            meaning="First step of a static run; longest step of a dynamic run."), &
      key_t("analysis", "duration", unit="s", without="until the step limit", &
            within=[1.0e-15_wp, 1.0e15_wp], meaning="End time of a dynamic run."), &
      key_t("analysis", "restitution", default="0.0", within=[0.0_wp, 1.0_wp], &
            meaning="Speed after an impact over the speed before it (dynamic, current)."), &
      key_t("analysis", "damping", unit="1/s", default="0.0", within=[0.0_wp, 1.0e15_wp], &
            meaning="Decay rate of velocities, proportional to mass."), &
      key_t("analysis", "penalty_ratio", default="100.0", within=[1.0e-6_wp, 1.0e12_wp], &
            meaning="Contact stiffness over the stiffness of the block across the joint."), &
      key_t("analysis", "collapse_displacement", unit="m", without="no limit", &
            within=[1.0e-15_wp, 1.0e15_wp], &
            meaning="Largest corner displacement that counts as collapse."), &
      key_t("analysis", "collapse_rotation_deg", unit="deg", without="45 in a search", &
            within=[0.0_wp, 360.0_wp], above=0.0_wp, &
            meaning="Block rotation that counts as collapse (dynamic, current geometry)."), &
      key_t("analysis", "collapse_point", kind=key_kind%whole, without="any corner", &
            within=[1.0_wp, 1.0e7_wp], &
            meaning="Monitoring point whose collapse_displacement counts, by its number."), &
      key_t("analysis", "open_close_limit", kind=key_kind%whole, default="400", &
            within=[1.0_wp, 1.0e9_wp], &
            meaning="Open-close changes per step before the line search starts."), &
      key_t("analysis", "restart", kind=key_kind%text, without="start at time 0", varies=.false., &
            meaning="Restart file of an earlier dynamic run of the same blocks."), &
      key_t("analysis", "start", kind=key_kind%word, default="'unloaded'", &
            words="unloaded static", &
            meaning="Initial forces of a dynamic run: none, or those of a static run."), &
      key_t("analysis", "unknowns", kind=key_kind%whole, without="chosen by the program", &
            within=[3.0_wp, 6.0_wp], meaning="Unknowns per block: 6, or 3 without strain.")]

   !> Keys of &limerick
   type(key_t), parameter :: limerick_keys(*) = [ &
      key_t("limerick", "dynamic", kind=key_kind%flag, default=".false.", &
            meaning="Keep velocities between steps; the run ends completed."), &
      key_t("limerick", "auto_penalty", kind=key_kind%flag, default=".true.", &
            meaning="Adapt the contact stiffness to the penetration."), &
      key_t("limerick", "penetration_ratio", default="4e-4", within=[1.0e-12_wp, 1.0_wp], &
            meaning="g3: target penetration of the automatic penalty over the half size."), &
      key_t("limerick", "close_ratio", default="2e-4", within=[0.0_wp, 1.0_wp], &
            meaning="s0: penetration over the half size above which an open contact closes."), &
      key_t("limerick", "open_ratio", default="2e-7", within=[0.0_wp, 1.0_wp], &
            meaning="f0: opening over the half size above which a closed contact opens."), &
      key_t("limerick", "overlap_deg", unit="deg", default="3.0", within=[0.0_wp, 45.0_wp], &
            meaning="h1: permitted overlap angle of two corners in contact detection."), &
      key_t("limerick", "stiffness_ratio", default="2.5", within=[1.0e-6_wp, 1.0e6_wp], &
            meaning="h2: normal over shear stiffness of a contact."), &
      key_t("limerick", "rotation", kind=key_kind%word, default="'linear'", words="linear exact", &
            meaning="Rotation of corners along the tangent (blocks grow) or exact."), &
      key_t("limerick", "contact_damping", unit="Ns/m2", default="0.0", &
            within=[0.0_wp, 1.0e30_wp], &
            meaning="Contact force per speed of approach and locked slip, with dynamic."), &
      key_t("limerick", "gravity_steps", kind=key_kind%whole, default="0", &
            within=[0.0_wp, 1.0e6_wp], &
            meaning="Maximum number of steps of the gravity phase; 0 for none.")]

   !> Keys of &search
   type(key_t), parameter :: search_keys(*) = [ &
      key_t("search", "parameter", kind=key_kind%text, default="'thickness_ratio'", &
            varies=.false., meaning="Real-valued key whose critical value is sought."), &
      key_t("search", "low", without="lower end of the parameter", within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Lower end of the search, in the unit of the parameter."), &
      key_t("search", "high", without="upper end of the parameter", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Upper end of the search, in the unit of the parameter."), &
      key_t("search", "tolerance", default="1e-8", within=[0.0_wp, 1.0_wp], above=0.0_wp, &
            below=1.0_wp, meaning="Relative width of the final bracket.")]

   !> Keys of &sweep
   type(key_t), parameter :: sweep_keys(*) = [ &
      key_t("sweep", "parameter", kind=key_kind%text, without="required", varies=.false., &
            meaning="Key that takes one value after the other."), &
      key_t("sweep", "values", kind=key_kind%numbers, without="texts, or first, last, count", &
            varies=.false., meaning="Numbers, in the unit of the parameter."), &
      key_t("sweep", "texts", kind=key_kind%texts, without="values, or first, last, count", &
            varies=.false., meaning="Words, each of at most 64 characters."), &
      key_t("sweep", "first", without="values or texts", within=[-1.0e30_wp, 1.0e30_wp], &
            varies=.false., meaning="First of count evenly spaced numbers."), &
      key_t("sweep", "last", without="values or texts", within=[-1.0e30_wp, 1.0e30_wp], &
            varies=.false., meaning="Last of count evenly spaced numbers."), &
      key_t("sweep", "count", kind=key_kind%whole, without="values or texts", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Number of values from first to last, both included."), &
      key_t("sweep", "linked", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Advance together with the previous &sweep.")]

   !> Keys of &output
   type(key_t), parameter :: output_keys(*) = [ &
      key_t("output", "vtu", kind=key_kind%flag, default=".true.", varies=.false., &
            meaning="Write the frames for ParaView, with stresses, forces and states."), &
      key_t("output", "joints", kind=key_kind%flag, without="for up to 100 cases", varies=.false., &
            meaning="Write joints.csv: forces, openings and states."), &
      key_t("output", "blocks", kind=key_kind%flag, without="for up to 100 cases", varies=.false., &
            meaning="Write blocks.csv: corners and displacements."), &
      key_t("output", "proof", kind=key_kind%flag, without="as joints, for up to 100 cases", &
            varies=.false., meaning="Write the certificate of each static verdict."), &
      key_t("output", "thrust_bar", kind=key_kind%whole, without="none", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Bar with reported least and greatest force."), &
      key_t("output", "reactions", kind=key_kind%flag, without="as joints, for static runs", &
            varies=.false., meaning="Write reactions.csv: support forces."), &
      key_t("output", "thrust_joint", kind=key_kind%whole, without="the one nearest to the crown", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Joint with reported thrust range, by its number in joints.csv."), &
      key_t("output", "condition", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Estimate the condition number of the last equations."), &
      key_t("output", "frames", kind=key_kind%whole, default="0", within=[0.0_wp, 10000.0_wp], &
            varies=.false., &
            meaning="Approximate number of frames of the motion, with current geometry."), &
      key_t("output", "energy", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Write energy.csv: energies after each step of a dynamic run."), &
      key_t("output", "restart", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Write the end of each dynamic case N to case_N.restart."), &
      key_t("output", "max_cases", kind=key_kind%whole, default="100000", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Upper limit on the number of cases.")]

   !> All keys, group by group, in the order of the groups
   type(key_t), parameter :: deck_key(*) = [scene_keys, arch_keys, support_keys, material_keys, &
      joint_keys, load_keys, live_keys, vehicle_keys, fill_keys, tie_keys, ground_keys, &
      analysis_keys, limerick_keys, &
      search_keys, sweep_keys, output_keys]

contains

   !> Place of a key in the registry: place in deck_key, counted from 1; 0 if there is no such key
   pure integer function key_index(group, name)
      character(len=*), intent(in) :: group  !! Name of the group, lower case
      character(len=*), intent(in) :: name   !! Name of the key, lower case

      key_index = findloc(deck_key%group == group .and. deck_key%name == name, .true., dim=1)
   end function key_index

   !> Place of a group in the registry: place in deck_group, counted from 1; 0 if there is no such
   !> group
   pure integer function group_index(name)
      character(len=*), intent(in) :: name  !! Name of the group, lower case

      group_index = findloc(deck_group%name == name, .true., dim=1)
   end function group_index
end module dda_deck_keys
