!> Registry of the keys of arches, fill and ties
module dda_arch_keys
   use dda_deck_key, only : key_kind, key_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: arch_keys, fill_keys, support_keys, tie_keys

   !> Keys of &arch
   type(key_t), parameter :: arch_keys(*) = [ &
      key_t("arch", "radius", unit="m", default="10.0", within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Radius of the centre line, half way between intrados and extrados."), &
      key_t("arch", "thickness_ratio", default="0.15", within=[1.0e-15_wp, 2.0_wp], below=2.0_wp, &
            search_low=0.0_wp, search_high=2.0_wp, &
            meaning="Thickness of the ring over its radius."), &
      key_t("arch", "half_angle_deg", unit="deg", default="90.0", within=[1.0e-6_wp, 180.0_wp], &
            below=180.0_wp, search_low=5.0_wp, search_high=175.0_wp, &
            meaning="Angle from the crown to a springing; follows from joints_deg if given."), &
      key_t("arch", "voussoirs", kind=key_kind%whole, default="36", within=[1.0_wp, 1.0e6_wp], &
            meaning="Number of equal voussoirs; an odd number has no joint at the crown."), &
      key_t("arch", "joints_deg", kind=key_kind%numbers, unit="deg", without="equal voussoirs", &
            within=[0.0_wp, 180.0_wp], below=180.0_wp, &
            meaning="Joints of one half, from 0 at the crown to the springing; mirrored."), &
      key_t("arch", "facet_deg", unit="deg", without="one chord per voussoir", &
            within=[1.0e-3_wp, 180.0_wp], below=180.0_wp, &
            meaning="Largest angle of one chord of the intrados or extrados."), &
      key_t("arch", "springing", kind=key_kind%word, default="'frictional'", &
            words="frictional no-slip", meaning="Friction at the springing joints, or no slip."), &
      key_t("arch", "abutment_size", unit="m", without="0.43 of the radius", &
            within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Depth of the abutments (mode = 'limerick', dda export)."), &
      key_t("arch", "abutment_overhang", unit="m", without="abutment_size", &
            within=[0.0_wp, 1.0e9_wp], &
            meaning="Projection of the abutments beyond either end of the springing joints."), &
      key_t("arch", "shape", kind=key_kind%word, default="'circular'", &
            words="circular segmental pointed elliptic basket parabolic catenary flat", &
            meaning="Shape of the arch."), &
      key_t("arch", "span", unit="m", without="radius and half_angle_deg", &
            within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Horizontal distance between the springings of the intrados."), &
      key_t("arch", "rise", unit="m", without="radius and half_angle_deg", &
            within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Height of the crown of the intrados above its left springing."), &
      key_t("arch", "right_rise", unit="m", without="rise", within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Height of the crown above the right springing."), &
      key_t("arch", "thickness", unit="m", without="thickness_ratio times radius", &
            within=[1.0e-12_wp, 1.0e9_wp], meaning="Total thickness of all rings."), &
      key_t("arch", "crown_thickness", unit="m", without="thickness", &
            within=[1.0e-12_wp, 1.0e9_wp], &
            meaning="Thickness at the crown; varies linearly along the arch."), &
      key_t("arch", "springing_thickness", unit="m", without="thickness", &
            within=[1.0e-12_wp, 1.0e9_wp], meaning="Thickness at the springings."), &
      key_t("arch", "joint_direction", kind=key_kind%word, &
            without="radial in flat arches, else normal", words="normal radial", &
            meaning="Joints normal to the centre line, or towards a centre."), &
      key_t("arch", "rings", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Number of rings of equal thickness, with joints between them."), &
      key_t("arch", "spans", kind=key_kind%whole, default="1", within=[1.0_wp, 1000.0_wp], &
            meaning="Number of equal spans on piers."), &
      key_t("arch", "pier_width", unit="m", without="a single span", within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Width of the piers between spans, from intrados to intrados."), &
      key_t("arch", "pier_height", unit="m", without="a single span", &
            within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Height of the piers from the ground to the springings."), &
      key_t("arch", "pier_courses", kind=key_kind%whole, default="1", within=[1.0_wp, 10000.0_wp], &
            meaning="Number of blocks per pier or buttress; 1 is a monolith."), &
      key_t("arch", "buttress_width", unit="m", without="fixed springings", &
            within=[1.0e-9_wp, 1.0e9_wp], meaning="Width of the buttresses at both ends."), &
      key_t("arch", "buttress_height", unit="m", without="pier_height", &
            within=[1.0e-9_wp, 1.0e9_wp], &
            meaning="Height of the buttresses from the ground to the springings."), &
      key_t("arch", "lune_deg", unit="deg", without="1 m of depth", within=[0.0_wp, 360.0_wp], &
            above=0.0_wp, meaning="Angle of the lune of a dome about x = 0.")]

   !> Keys of &support
   type(key_t), parameter :: support_keys(*) = [ &
      key_t("support", "left_dx", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="Displacement of the left springing, positive to the right."), &
      key_t("support", "left_dy", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="Displacement of the left springing, positive upwards."), &
      key_t("support", "left_rotation_deg", unit="deg", default="0.0", &
            within=[-90.0_wp, 90.0_wp], &
            meaning="Rotation about the middle of its joint, anticlockwise."), &
      key_t("support", "right_dx", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="Displacement of the right springing, positive to the right."), &
      key_t("support", "right_dy", unit="m", default="0.0", within=[-1.0e9_wp, 1.0e9_wp], &
            meaning="Displacement of the right springing, positive upwards."), &
      key_t("support", "right_rotation_deg", unit="deg", default="0.0", &
            within=[-90.0_wp, 90.0_wp], &
            meaning="Rotation about the middle of its joint, anticlockwise.")]

   !> Keys of &fill
   type(key_t), parameter :: fill_keys(*) = [ &
      key_t("fill", "height", unit="m", without="required", within=[0.0_wp, 1.0e9_wp], &
            meaning="Depth of the surface above the highest point of the extrados."), &
      key_t("fill", "unit_weight", unit="N/m3", without="required", within=[0.0_wp, 1.0e30_wp], &
            bare=.false., meaning="Weight per volume of the fill."), &
      key_t("fill", "friction_deg", unit="deg", without="no passive_share", &
            within=[0.0_wp, 90.0_wp], below=90.0_wp, bare=.false., &
            meaning="Friction angle of the fill, for passive_share."), &
      key_t("fill", "spread", default="0.5", within=[0.0_wp, 100.0_wp], &
            meaning="Spread of an axle load to either side per depth below the surface."), &
      key_t("fill", "passive_coefficient", default="0.0", within=[0.0_wp, 1.0e6_wp], &
            search_low=0.0_wp, &
            meaning="Largest horizontal pressure on the arch over the weight of fill above."), &
      key_t("fill", "passive_share", without="passive_coefficient", within=[0.0_wp, 1.0_wp], &
            meaning="The same coefficient as a share of Rankine's Kp for friction_deg."), &
      key_t("fill", "passive_stiffness", unit="N/m3", without="reference geometry only", &
            within=[0.0_wp, 1.0e30_wp], above=0.0_wp, &
            meaning="Pressure per displacement in current geometry, up to the passive limit."), &
      key_t("fill", "backing_height", unit="m", without="no backing", within=[0.0_wp, 1.0e9_wp], &
            meaning="Height of rigid backing above the left springing of the arch."), &
      key_t("fill", "backing_unit_weight", unit="N/m3", without="that of &material", &
            within=[0.0_wp, 1.0e30_wp], meaning="Weight per volume of the backing.")]

   !> Keys of &tie
   type(key_t), parameter :: tie_keys(*) = [ &
      key_t("tie", "x1", kind=key_kind%numbers, unit="m", without="no tie", &
            within=[-1.0e15_wp, 1.0e15_wp], &
            meaning="x of the first end of each tie, in a block."), &
      key_t("tie", "y1", kind=key_kind%numbers, unit="m", without="no tie", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="y of the first end of each tie."), &
      key_t("tie", "x2", kind=key_kind%numbers, unit="m", without="no tie", &
            within=[-1.0e15_wp, 1.0e15_wp], &
            meaning="x of the second end of each tie, in another block."), &
      key_t("tie", "y2", kind=key_kind%numbers, unit="m", without="no tie", &
            within=[-1.0e15_wp, 1.0e15_wp], meaning="y of the second end of each tie."), &
      key_t("tie", "ea", kind=key_kind%numbers, unit="N", without="required", &
            within=[0.0_wp, 1.0e30_wp], above=0.0_wp, &
            meaning="Young's modulus times cross section, per metre of depth."), &
      key_t("tie", "strength", kind=key_kind%numbers, unit="N", without="unlimited", &
            within=[0.0_wp, 1.0e30_wp], meaning="Yield force of each tie."), &
      key_t("tie", "prestress", kind=key_kind%numbers, unit="N", without="none", &
            within=[0.0_wp, 1.0e30_wp], meaning="Initial force of each tie in current geometry.")]
end module dda_arch_keys
