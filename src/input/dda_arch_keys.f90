!> The registry: what a deck says of the shape of an arch and of what lies on it
module dda_arch_keys
   use dda_deck_key, only : key_kind, key_t
   use dda_key_names, only : search_high, search_low
   use dda_kinds, only : wp
   implicit none
   private

   public :: arch_keys, fill_keys, tie_keys

   !> Keys of &arch
   type(key_t), parameter :: arch_keys(*) = [ &
      key_t(group="arch", name="radius", unit="m", default="10.0", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Radius of the circle half way between intrados and extrados."), &
      key_t(group="arch", name="thickness_ratio", default="0.15", &
            at_least=1.0e-15_wp, below=2.0_wp, search_low=0.0_wp, search_high=2.0_wp, &
            meaning="Thickness of the ring over the radius of its middle circle."), &
      key_t(group="arch", name="half_angle_deg", unit="deg", default="90.0", &
            at_least=1.0e-6_wp, below=180.0_wp, search_low=5.0_wp, search_high=175.0_wp, &
            meaning="Angle from the crown to a springing; follows from joints_deg if given."), &
      key_t(group="arch", name="voussoirs", kind=key_kind%whole, default="36", &
            at_least=1.0_wp, at_most=1.0e6_wp, &
            meaning="Number of equal voussoirs; an odd number leaves no joint at the crown."), &
      key_t(group="arch", name="joints_deg", kind=key_kind%numbers, unit="deg", &
            without="equal voussoirs", at_least=0.0_wp, below=180.0_wp, &
            meaning="Joints of one half from the crown, 0 first, the springing last; mirrored."), &
      key_t(group="arch", name="facet_deg", unit="deg", without="one chord a voussoir", &
            at_least=1.0e-3_wp, below=180.0_wp, &
            meaning="Largest angle of one chord of a voussoir's intrados or extrados."), &
      key_t(group="arch", name="springing", kind=key_kind%word, default="'frictional'", &
            words="frictional no-slip", &
            meaning="Whether the two springing joints obey friction or cannot slide."), &
      key_t(group="arch", name="abutment_size", unit="m", without="0.43 of the radius", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Depth of the abutments of mode 'limerick' and of dda export."), &
      key_t(group="arch", name="abutment_overhang", unit="m", without="abutment_size", &
            at_least=0.0_wp, at_most=1.0e9_wp, &
            meaning="By how much such abutments are longer than the joints, at either end."), &
      key_t(group="arch", name="shape", kind=key_kind%word, default="'circular'", &
            words="circular segmental pointed elliptic basket parabolic catenary flat", &
            meaning="Form of the arch."), &
      key_t(group="arch", name="span", unit="m", without="radius and half_angle_deg", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Distance of the springings of the intrados along x."), &
      key_t(group="arch", name="rise", unit="m", without="radius and half_angle_deg", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Height of the crown of the intrados above its left springing."), &
      key_t(group="arch", name="right_rise", unit="m", without="rise", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Height of the crown of the intrados above its right springing."), &
      key_t(group="arch", name="thickness", unit="m", without="thickness_ratio times radius", &
            at_least=1.0e-12_wp, at_most=1.0e9_wp, meaning="Thickness of all rings together."), &
      key_t(group="arch", name="crown_thickness", unit="m", without="thickness", &
            at_least=1.0e-12_wp, at_most=1.0e9_wp, &
            meaning="Thickness at the crown; it changes with the length along the arch."), &
      key_t(group="arch", name="springing_thickness", unit="m", without="thickness", &
            at_least=1.0e-12_wp, at_most=1.0e9_wp, meaning="Thickness at the springings."), &
      key_t(group="arch", name="joint_direction", kind=key_kind%word, &
            without="radial in flat arches, else normal", words="normal radial", &
            meaning="Joints square to the middle line, or pointing from a centre."), &
      key_t(group="arch", name="rings", kind=key_kind%whole, default="1", &
            at_least=1.0_wp, at_most=1000.0_wp, &
            meaning="Rings of equal thickness, one on the other."), &
      key_t(group="arch", name="spans", kind=key_kind%whole, default="1", &
            at_least=1.0_wp, at_most=1000.0_wp, meaning="Spans alike, one beside the other."), &
      key_t(group="arch", name="pier_width", unit="m", without="a single span", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, meaning="Width of the piers between spans."), &
      key_t(group="arch", name="pier_height", unit="m", without="a single span", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Height of the piers from the ground to the springings."), &
      key_t(group="arch", name="pier_courses", kind=key_kind%whole, default="1", &
            at_least=1.0_wp, at_most=10000.0_wp, &
            meaning="Blocks of a pier or buttress, one on the other."), &
      key_t(group="arch", name="buttress_width", unit="m", without="springings that are fixed", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, &
            meaning="Width of the buttresses that the two ends stand on."), &
      key_t(group="arch", name="buttress_height", unit="m", without="pier_height", &
            at_least=1.0e-9_wp, at_most=1.0e9_wp, meaning="Their height up to the springings."), &
      key_t(group="arch", name="lune_deg", unit="deg", without="1 m of depth", &
            above=0.0_wp, at_most=360.0_wp, &
            meaning="Angle of the lune of a dome, whose depth grows from its axis.")]

   !> Keys of &fill
   type(key_t), parameter :: fill_keys(*) = [ &
      key_t(group="fill", name="height", unit="m", without="must be given", &
            at_least=0.0_wp, at_most=1.0e9_wp, &
            meaning="Depth of the level surface above the highest point of the extrados."), &
      key_t(group="fill", name="unit_weight", unit="N/m3", without="must be given", bare=.false., &
            at_least=0.0_wp, at_most=1.0e30_wp, meaning="Weight per volume of the fill."), &
      key_t(group="fill", name="friction_deg", unit="deg", without="no Kp is needed", &
            bare=.false., &
            at_least=0.0_wp, below=90.0_wp, meaning="Friction angle, for passive_share."), &
      key_t(group="fill", name="spread", default="0.5", at_least=0.0_wp, at_most=100.0_wp, &
            meaning="How far axles spread to either side, over the depth below the surface."), &
      key_t(group="fill", name="passive_coefficient", default="0.0", &
            at_least=0.0_wp, at_most=1.0e6_wp, search_low=0.0_wp, &
            meaning="Largest horizontal pressure on the arch over the weight above."), &
      key_t(group="fill", name="passive_share", without="passive_coefficient", &
            at_least=0.0_wp, at_most=1.0_wp, &
            meaning="The same as a share of Rankine's Kp of friction_deg."), &
      key_t(group="fill", name="passive_stiffness", unit="N/m3", without="blocks do not move", &
            above=0.0_wp, at_most=1.0e30_wp, &
            meaning="Pressure over displacement where blocks move, up to the largest."), &
      key_t(group="fill", name="backing_height", unit="m", without="no backing", &
            at_least=0.0_wp, at_most=1.0e9_wp, &
            meaning="Height of rigid masonry behind the arch above its left springing."), &
      key_t(group="fill", name="backing_unit_weight", unit="N/m3", without="that of &material", &
            at_least=0.0_wp, at_most=1.0e30_wp, meaning="Weight per volume of the backing.")]

   !> Keys of &tie
   type(key_t), parameter :: tie_keys(*) = [ &
      key_t(group="tie", name="x1", kind=key_kind%numbers, unit="m", without="no tie", &
            at_least=-1.0e15_wp, at_most=1.0e15_wp, &
            meaning="Where ties begin, in a block: one number a tie."), &
      key_t(group="tie", name="y1", kind=key_kind%numbers, unit="m", without="no tie", &
            at_least=-1.0e15_wp, at_most=1.0e15_wp, meaning="Likewise, upwards."), &
      key_t(group="tie", name="x2", kind=key_kind%numbers, unit="m", without="no tie", &
            at_least=-1.0e15_wp, at_most=1.0e15_wp, &
            meaning="Where they end, in another block."), &
      key_t(group="tie", name="y2", kind=key_kind%numbers, unit="m", without="no tie", &
            at_least=-1.0e15_wp, at_most=1.0e15_wp, meaning="Likewise, upwards."), &
      key_t(group="tie", name="ea", kind=key_kind%numbers, unit="N", without="must be given", &
            above=0.0_wp, at_most=1.0e30_wp, &
            meaning="Force over strain of each tie, per metre of depth as all forces."), &
      key_t(group="tie", name="strength", kind=key_kind%numbers, unit="N", &
            without="ties that do not yield", at_least=0.0_wp, at_most=1.0e30_wp, &
            meaning="Force at which each tie yields."), &
      key_t(group="tie", name="prestress", kind=key_kind%numbers, unit="N", without="none", &
            at_least=0.0_wp, at_most=1.0e30_wp, &
            meaning="Force of each tie at the beginning.")]
end module dda_arch_keys
