!> The registry of all groups and keys of a deck
!>
!> A new key is one entry here, its name in dda_key_names, and its paragraph in docs/input.md.
!> Reading, range checks, --set, sweeps, searches and the printed help follow from the entry.
module dda_deck_keys
   use dda_arch_keys, only : arch_keys, fill_keys, tie_keys
   use dda_deck_key, only : group_t, key_kind, key_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: deck_key, deck_group, key_index, group_index, joint_keys, material_keys

   !> All groups, in the order of the contract
   type(group_t), parameter :: deck_group(*) = [ &
      group_t("scene", "what is studied"), &
      group_t("arch", "the shape of an arch, its rings, spans and piers"), &
      group_t("material", "the blocks' material"), &
      group_t("joint", "the Mohr-Coulomb law of the joints"), &
      group_t("load", "what acts on the blocks"), &
      group_t("live", "forces on points that the load factor multiplies"), &
      group_t("vehicle", "axles above the blocks, multiplied by the load factor, too"), &
      group_t("fill", "what lies on an arch, up to a level surface"), &
      group_t("tie", "bars between two points of the blocks of an arch"), &
      group_t("ground", "how the ground moves, with mode = 'dynamic' only"), &
      group_t("analysis", "how a single case is computed"), &
      group_t("limerick", "Shi's scheme as it was: with mode = 'limerick' only"), &
      group_t("search", "looks for the critical value of one parameter"), &
      group_t("sweep", "runs one case a value; up to 8 such groups"), &
      group_t("output", "what is written")]

   !> Keys of &scene
   type(key_t), parameter :: scene_keys(*) = [ &
      key_t("scene", "title", kind=key_kind%text, default="''", varies=.false., &
            meaning="One line that says what the deck is about."), &
      key_t("scene", "kind", kind=key_kind%word, default="'arch'", words="arch lines blocks", &
            varies=.false., &
            meaning="What the blocks are made from: the keys of &arch, lines of a file, or "// &
            "polygons of a file."), &
      key_t("scene", "geometry", kind=key_kind%text, without="an arch", varies=.false., &
            meaning="File of lines or of blocks, beside the deck unless it begins with a slash."), &
      key_t("scene", "analysis", kind=key_kind%text, without="the keys of this deck", &
            varies=.false., &
            meaning="File of materials and loads for kind = 'lines'; keys of the deck take "// &
            "precedence."), &
      key_t("scene", "contact_tolerance", default="1e-4", within=[1.0e-12_wp, 1.0e-2_wp], &
            varies=.false., &
            meaning="Edges of blocks nearer than this share of the smaller block's size form a "// &
            "joint.")]

   !> Keys of &material
   type(key_t), parameter :: material_keys(*) = [ &
      key_t("material", "density", unit="kg/m3", default="2240.0", &
            within=[1.0e-12_wp, 1.0e30_wp], meaning="Mass per volume."), &
      key_t("material", "unit_weight", unit="N/m3", without="density times gravity", &
            within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Weight per volume; where given, density times gravity is not used."), &
      key_t("material", "young", unit="Pa", default="5e9", within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Young's modulus of the blocks."), &
      key_t("material", "poisson", default="0.2", within=[-1.0_wp, 0.5_wp], above=-1.0_wp, &
            below=0.5_wp, meaning="Poisson's ratio of the blocks."), &
      key_t("material", "compressive_strength", unit="Pa", &
            without="blocks that are never crushed", within=[1.0e-12_wp, 1.0e30_wp], &
            meaning="Pressure that joints carry at most, on the strip that bears it."), &
      key_t("material", "plane", kind=key_kind%word, default="'stress'", words="stress strain", &
            meaning="Plane stress or plane strain.")]

   !> Keys of &joint
   type(key_t), parameter :: joint_keys(*) = [ &
      key_t("joint", "friction_deg", unit="deg", default="50.0", within=[0.0_wp, 90.0_wp], &
            search_low=0.0_wp, search_high=90.0_wp, &
            meaning="Friction angle; 89.9 and more means that no joint can slide."), &
      key_t("joint", "cohesion", unit="Pa", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Shear strength without normal force."), &
      key_t("joint", "tension", unit="Pa", default="0.0", within=[0.0_wp, 1.0e30_wp], &
            meaning="Tensile strength; at most cohesion/tan(friction_deg) counts."), &
      key_t("joint", "residual_deg", unit="deg", without="friction_deg", &
            within=[0.0_wp, 90.0_wp], &
            meaning="Friction angle of joints that have slid or opened."), &
      key_t("joint", "slip_length", unit="m", default="0.0", within=[0.0_wp, 1.0e9_wp], &
            meaning="Slip over which strength goes to what remains; 0: the first slip takes all.")]

   !> Keys of &load
   type(key_t), parameter :: load_keys(*) = [ &
      key_t("load", "gravity", unit="m/s2", default="9.81", within=[0.0_wp, 1.0e12_wp], &
            meaning="Acceleration of gravity."), &
      key_t("load", "gravity_direction_deg", unit="deg", default="-90.0", &
            within=[-360.0_wp, 360.0_wp], &
            meaning="Direction in which the weight acts, anticlockwise from +x; -90 is down."), &
      key_t("load", "horizontal_coefficient", default="0.0", within=[-1.0e6_wp, 1.0e6_wp], &
            search_low=0.0_wp, search_high=1.0_wp, &
            meaning="Force towards +x on each block, as a multiple of its weight."), &
      key_t("load", "load_factor", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            search_low=0.0_wp, search_high=1.0e9_wp, &
            meaning="What live loads are multiplied by; dead loads stay."), &
      key_t("load", "live_horizontal", kind=key_kind%flag, default=".false.", &
            meaning="Whether the forces of horizontal_coefficient are live."), &
      key_t("load", "displacement_factor", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="What prescribed displacements are multiplied by."), &
      key_t("load", "water_rise", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="By how much the lines of heads of a file of blocks have risen.")]

   !> Keys of &live
   type(key_t), parameter :: live_keys(*) = [ &
      key_t("live", "x", kind=key_kind%numbers, unit="m", without="no live load", &
            within=[-1.0e15_wp, 1.0e15_wp], &
            meaning="Where live forces act: one number a force."), &
      key_t("live", "y", kind=key_kind%numbers, unit="m", without="no live load", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="Likewise, upwards."), &
      key_t("live", "fx", kind=key_kind%numbers, unit="N/m", without="0 for each force", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Their components towards +x, per metre of depth."), &
      key_t("live", "fy", kind=key_kind%numbers, unit="N/m", without="0 for each force", &
            within=[-1.0e30_wp, 1.0e30_wp], meaning="Their components upwards.")]

   !> Keys of &vehicle
   type(key_t), parameter :: vehicle_keys(*) = [ &
      key_t("vehicle", "axles", kind=key_kind%numbers, unit="N/m", without="no vehicle", &
            within=[0.0_wp, 1.0e30_wp], above=0.0_wp, &
            meaning="Weight of each axle per metre of depth, a live load."), &
      key_t("vehicle", "spacings", kind=key_kind%numbers, unit="m", without="a single axle", &
            within=[0.0_wp, 1.0e9_wp], above=0.0_wp, &
            meaning="Distances between the axles, from the first to the right."), &
      key_t("vehicle", "length", unit="m", default="0.3", within=[0.0_wp, 1.0e9_wp], &
            meaning="Length over which an axle is spread; 0 for a point."), &
      key_t("vehicle", "position", unit="m", without="must be given, or worst", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="Where the first axle is, along x."), &
      key_t("vehicle", "worst", kind=key_kind%flag, default=".false.", &
            meaning="Whether the position of the least load factor is sought."), &
      key_t("vehicle", "both_directions", kind=key_kind%flag, default=".true.", &
            meaning="Whether worst tries both directions of travel.")]

   !> Keys of &ground
   type(key_t), parameter :: ground_keys(*) = [ &
      key_t("ground", "scale", default="1.0", within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="What the motion of the ground is multiplied by."), &
      key_t("ground", "pulse", kind=key_kind%word, without="a record, or the file of blocks", &
            words="rectangular sine", &
            meaning="Acceleration that is constant for a time, or a sine."), &
      key_t("ground", "record", kind=key_kind%text, without="a pulse, or the file of blocks", &
            meaning="File of the motion, beside the deck unless it begins with a slash."), &
      key_t("ground", "amplitude", unit="m/s2", without="must be given for a pulse", &
            within=[-1.0e12_wp, 1.0e12_wp], &
            meaning="Largest acceleration: of the pulse, or that the record is brought to."), &
      key_t("ground", "duration", unit="s", without="one period of a sine", &
            within=[1.0e-12_wp, 1.0e12_wp], bare=.false., meaning="How long the pulse lasts."), &
      key_t("ground", "frequency", unit="Hz", without="must be given for a sine", &
            within=[1.0e-9_wp, 1.0e9_wp], meaning="Frequency of the sine."), &
      key_t("ground", "direction_deg", unit="deg", default="0.0", within=[-360.0_wp, 360.0_wp], &
            meaning="Direction of a pulse, or by how much a record is turned, from +x."), &
      key_t("ground", "columns", kind=key_kind%text, default="'1 2'", varies=.false., &
            meaning="Columns of time, x and y in the record: numbers, 0 for none, or names."), &
      key_t("ground", "quantity", kind=key_kind%word, default="'acceleration'", &
            words="acceleration velocity displacement", meaning="What the record holds."), &
      key_t("ground", "unit", default="1.0", within=[1.0e-12_wp, 1.0e12_wp], &
            meaning="One of the record's units in m/s2, m/s or m: 9.81 for accelerations in g.")]

   !> Keys of &analysis
   type(key_t), parameter :: analysis_keys(*) = [ &
      key_t("analysis", "mode", kind=key_kind%word, default="'static'", &
            words="static dynamic limerick", &
            meaning="Velocity put to zero at each step or carried on; or Shi's scheme."), &
      key_t("analysis", "geometry", kind=key_kind%word, default="'reference'", &
            words="reference current", &
            meaning="Small displacements on the undeformed shape, or blocks that move."), &
      key_t("analysis", "flow", kind=key_kind%word, default="'coulomb'", &
            words="coulomb associated", &
            meaning="Friction rule of a static verdict: sliding along the joint, or opening it."), &
      key_t("analysis", "steps", kind=key_kind%whole, default="400", within=[1.0_wp, 1.0e9_wp], &
            meaning="Step limit of one run; a static run that reaches it is undecided."), &
      key_t("analysis", "max_displacement_ratio", default="0.05", within=[1.0e-12_wp, 1.0_wp], &
            meaning="Largest vertex displacement of a step over the size of the smallest block."), &
      key_t("analysis", "time_step", unit="s", without="chosen by the program", &
            within=[1.0e-15_wp, 1.0e15_wp], &
            meaning="First time step of a static run, longest step of a dynamic one."), &
      key_t("analysis", "duration", unit="s", without="the run ends with its last step", &
            within=[1.0e-15_wp, 1.0e15_wp], meaning="Time at which a dynamic run ends."), &
      key_t("analysis", "restitution", default="0.0", within=[0.0_wp, 1.0_wp], &
            meaning="Speed after an impact over that before it, where blocks move in time."), &
      key_t("analysis", "damping", unit="1/s", default="0.0", within=[0.0_wp, 1.0e15_wp], &
            meaning="Rate at which velocities decay in a dynamic run, whatever the block."), &
      key_t("analysis", "penalty_ratio", default="100.0", within=[1.0e-6_wp, 1.0e12_wp], &
            meaning="Normal stiffness of a contact over the block's own across the joint."), &
      key_t("analysis", "collapse_displacement", unit="m", without="a test without a length", &
            within=[1.0e-15_wp, 1.0e15_wp], &
            meaning="Largest vertex displacement that means collapse."), &
      key_t("analysis", "collapse_rotation_deg", unit="deg", without="45 in a search", &
            within=[0.0_wp, 360.0_wp], above=0.0_wp, &
            meaning="Rotation of a block that means collapse, in a dynamic run."), &
      key_t("analysis", "collapse_point", kind=key_kind%whole, without="any corner", &
            within=[1.0_wp, 1.0e7_wp], &
            meaning="Measured point whose displacement means collapse, by its number."), &
      key_t("analysis", "open_close_limit", kind=key_kind%whole, default="400", &
            within=[1.0_wp, 1.0e9_wp], &
            meaning="Most open-close changes of a step before the line search takes over."), &
      key_t("analysis", "restart", kind=key_kind%text, &
            without="the run begins at the beginning", varies=.false., &
            meaning="Restart file that a dynamic run continues; steps counts those before."), &
      key_t("analysis", "start", kind=key_kind%word, default="'unloaded'", &
            words="unloaded static", &
            meaning="Forces that a dynamic run begins with: none, or those of a static one."), &
      key_t("analysis", "unknowns", kind=key_kind%whole, without="what the scene needs", &
            within=[3.0_wp, 6.0_wp], &
            meaning="Unknowns of a block: 6, or 3 for blocks without strain.")]

   !> Keys of &limerick
   type(key_t), parameter :: limerick_keys(*) = [ &
      key_t("limerick", "dynamic", kind=key_kind%flag, default=".false.", &
            meaning="Whether the velocity is carried on instead of put to zero at each step."), &
      key_t("limerick", "auto_penalty", kind=key_kind%flag, default=".true.", &
            meaning="Whether the contact stiffness follows the penetration."), &
      key_t("limerick", "penetration_ratio", default="4e-4", within=[1.0e-12_wp, 1.0_wp], &
            meaning="g3: penetration over the half size that the automatic penalty aims at."), &
      key_t("limerick", "close_ratio", default="2e-4", within=[0.0_wp, 1.0_wp], &
            meaning="s0: penetration over the half size beyond which an open contact closes."), &
      key_t("limerick", "open_ratio", default="2e-7", within=[0.0_wp, 1.0_wp], &
            meaning="f0: opening over the half size beyond which a closed contact opens."), &
      key_t("limerick", "overlap_deg", unit="deg", default="3.0", within=[0.0_wp, 45.0_wp], &
            meaning="h1: overlap of two corners that is overlooked."), &
      key_t("limerick", "stiffness_ratio", default="2.5", within=[1.0e-6_wp, 1.0e6_wp], &
            meaning="h2: normal over shear stiffness of a contact."), &
      key_t("limerick", "rotation", kind=key_kind%word, default="'linear'", &
            words="linear exact", &
            meaning="Whether vertices turn along the tangent or by sine and cosine."), &
      key_t("limerick", "contact_damping", unit="Ns/m2", default="0.0", &
            within=[0.0_wp, 1.0e30_wp], &
            meaning="Force of a closed contact over the speed of approach, with dynamic."), &
      key_t("limerick", "gravity_steps", kind=key_kind%whole, default="0", &
            within=[0.0_wp, 1.0e6_wp], &
            meaning="Most steps of the phase that turns gravity on; 0 for none.")]

   !> Keys of &search
   type(key_t), parameter :: search_keys(*) = [ &
      key_t("search", "parameter", kind=key_kind%text, default="'thickness_ratio'", &
            varies=.false., &
            meaning="Name of the real-valued key whose critical value is sought."), &
      key_t("search", "low", without="the parameter's own lower end", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Where the search begins, in the parameter's unit."), &
      key_t("search", "high", without="the parameter's own upper end", &
            within=[-1.0e30_wp, 1.0e30_wp], &
            meaning="Where the search ends, in the parameter's unit."), &
      key_t("search", "tolerance", default="1e-8", within=[0.0_wp, 1.0_wp], above=0.0_wp, &
            below=1.0_wp, &
            meaning="Width of the bracket that ends the search, relative to the critical value.")]

   !> Keys of &sweep
   type(key_t), parameter :: sweep_keys(*) = [ &
      key_t("sweep", "parameter", kind=key_kind%text, without="must be given", varies=.false., &
            meaning="Name of the key that takes one value after the other."), &
      key_t("sweep", "values", kind=key_kind%numbers, without="texts, or first, last, count", &
            varies=.false., meaning="The numbers it takes."), &
      key_t("sweep", "texts", kind=key_kind%texts, without="values, or first, last, count", &
            varies=.false., meaning="The words it takes."), &
      key_t("sweep", "first", without="values or texts", within=[-1.0e30_wp, 1.0e30_wp], &
            varies=.false., meaning="First of count evenly spaced numbers."), &
      key_t("sweep", "last", without="values or texts", within=[-1.0e30_wp, 1.0e30_wp], &
            varies=.false., meaning="Last of count evenly spaced numbers."), &
      key_t("sweep", "count", kind=key_kind%whole, without="values or texts", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="How many numbers from first to last, both included."), &
      key_t("sweep", "linked", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Advance together with the &sweep before, instead of multiplying the cases.")]

   !> Keys of &output
   type(key_t), parameter :: output_keys(*) = [ &
      key_t("output", "vtu", kind=key_kind%flag, default=".true.", varies=.false., &
            meaning="Write the frames for ParaView too."), &
      key_t("output", "joints", kind=key_kind%flag, without="up to 100 cases", varies=.false., &
            meaning="Write forces, openings and states of the joints to joints.csv."), &
      key_t("output", "blocks", kind=key_kind%flag, without="up to 100 cases", varies=.false., &
            meaning="Write corners and displacements of the blocks to blocks.csv."), &
      key_t("output", "proof", kind=key_kind%flag, without="as joints, for up to 100 cases", &
            varies=.false., &
            meaning="Prove static verdicts in proof_forces.csv and proof_motion.csv."), &
      key_t("output", "thrust_bar", kind=key_kind%whole, without="none", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Bar whose least and greatest force are reported for stable cases, in "// &
            "thrust_min and thrust_max."), &
      key_t("output", "reactions", kind=key_kind%flag, without="as joints, of static runs", &
            varies=.false., &
            meaning="Write the forces of fixed blocks and held points to reactions.csv."), &
      key_t("output", "thrust_joint", kind=key_kind%whole, &
            without="the one nearest to the crown of an arch", within=[1.0_wp, 1.0e7_wp], &
            varies=.false., meaning="Joint whose thrust range is reported for stable cases."), &
      key_t("output", "condition", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Estimate the condition number of the last equations of each case."), &
      key_t("output", "frames", kind=key_kind%whole, default="0", within=[0.0_wp, 10000.0_wp], &
            varies=.false., &
            meaning="Frames of moving blocks; a collapse is then followed for radius/10."), &
      key_t("output", "energy", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Write the energies after each step of a dynamic run to energy.csv."), &
      key_t("output", "restart", kind=key_kind%flag, default=".false.", varies=.false., &
            meaning="Write the end of each dynamic case to case_N.restart, to continue it."), &
      key_t("output", "max_cases", kind=key_kind%whole, default="100000", &
            within=[1.0_wp, 1.0e7_wp], varies=.false., &
            meaning="Most cases that the &sweep groups may make; more is an error.")]

   !> All keys, group by group, in the order of the groups
   type(key_t), parameter :: deck_key(*) = [scene_keys, arch_keys, material_keys, joint_keys, &
      load_keys, live_keys, vehicle_keys, fill_keys, tie_keys, ground_keys, analysis_keys, &
      limerick_keys, &
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
