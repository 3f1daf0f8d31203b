!> Contents of a joint map: outline, openings, sets, points
!>
!> The outlines of openings are computed here: circle and ellipse, arch on walls, horseshoe.
module dda_joint_map
   use dda_kinds, only : pi, wp
   use dda_line_model, only : entity_role
   implicit none
   private

   public :: bolts_t, joint_map_t, joint_set_t, length_t, length_law, map_line_t
   public :: opening_t, arched_opening, horseshoe, ring

   !> Distributions of a length about its mean
   type :: length_law_enum
      integer :: constant = 1     !! No variation
      integer :: uniform = 2      !! Uniform, within the mean plus or minus the randomness
      integer :: exponential = 3  !! Negative exponential
      !> Normal, with the randomness as coefficient of variation, cut off at 0 and at twice the mean
      integer :: normal = 4
   end type length_law_enum

   !> Names of the distributions
   type(length_law_enum), parameter :: length_law = length_law_enum()

   !> A length with its distribution
   type :: length_t
      real(wp) :: mean = 0.0_wp             !! Its mean [m]
      integer :: law = length_law%constant  !! One of length_law
      real(wp) :: randomness = 0.0_wp       !! Degree of randomness, 0 to 1
   end type length_t

   !> A set of joints
   type :: joint_set_t
      real(wp) :: dip = 0.0_wp         !! Angle of the joints, anticlockwise from x [rad]
      real(wp) :: dip_spread = 0.0_wp  !! Largest deviation of a joint from it, uniform [rad]
      type(length_t) :: spacing        !! Distance between neighbours
      type(length_t) :: trace          !! Length of a trace; unlimited joints if the mean is 0
      type(length_t) :: bridge         !! Length of rock between two traces of a joint
      integer :: material = 1          !! Number of the joint material
      integer :: seed(2) = 0           !! Seed and stream of the random numbers of the set: (2)
      logical :: anchored = .false.    !! True if one joint of the set runs through a given point
      real(wp) :: anchor(2) = 0.0_wp   !! The given point, or the origin of the set: (2) [m]
      !> Corners of the region of the set; without corners the whole outline: (2, n) [m]
      real(wp), allocatable :: region(:, :)
      integer :: row = 0  !! Line of the file
   end type joint_set_t

   !> An opening
   type :: opening_t
      real(wp), allocatable :: corner(:, :)  !! Corners, anticlockwise: (2, n) [m]
      integer :: material = 1                !! Number of the joint material of its edges
      !> True if it exists from the beginning; otherwise joints continue through it
      logical :: excavated = .true.
      integer :: row = 0  !! Line of the file
   end type opening_t

   !> A line or a point given explicitly
   type :: map_line_t
      integer :: role = entity_role%joint  !! One of entity_role
      real(wp) :: ends(4) = 0.0_wp  !! Ends, equal for a point: (4) [m]
      integer :: material = 1       !! Number of its material, or of the bolt properties
      real(wp) :: bolt(3) = 0.0_wp  !! Stiffness, strength and prestress of a bolt: (3) [N/m, N, N]
      integer :: row = 0            !! Line of the file
   end type map_line_t

   !> Bolts in a pattern around an opening
   type :: bolts_t
      integer :: opening = 1  !! Number of the opening
      integer :: number = 0   !! Number of bolts
      !> Directions of the first and last bolt from the opening's centre: (2) [rad]
      real(wp) :: fan(2) = 0.0_wp
      !> Length of the bolts, and depth of their heads in the rock: (2) [m]
      real(wp) :: reach(2) = 0.0_wp
      real(wp) :: property(3) = 0.0_wp  !! Stiffness, strength and prestress: (3) [N/m, N, N]
      integer :: row = 0                !! Line of the file
   end type bolts_t

   !> Contents of a map
   type :: joint_map_t
      character(len=:), allocatable :: file   !! Name of the file, for messages
      real(wp) :: edge_node_ratio = 0.0_wp    !! Shi's e00
      real(wp), allocatable :: outline(:, :)  !! Corners of the outline, anticlockwise: (2, n) [m]
      integer :: outline_material = 1         !! Number of the joint material of the outline
      logical :: held_side(3) = .false.       !! Fixed sides: left, right, bottom (3)
      !> Distance of the line with the fixed points from the side [m]
      real(wp) :: hold_depth = 0.0_wp
      type(joint_set_t), allocatable :: set(:)    !! Sets of joints
      type(opening_t), allocatable :: opening(:)  !! Openings
      type(map_line_t), allocatable :: line(:)    !! Lines and points given explicitly
      type(bolts_t), allocatable :: bolts(:)      !! Bolts around openings
   end type joint_map_t

contains

   !> Corners of a circle or an ellipse
   pure function ring(centre, half_axis, n) result(corner)
      real(wp), intent(in) :: centre(2)     !! Centre: (2) [m]
      real(wp), intent(in) :: half_axis(2)  !! Half axes along x and y: (2) [m]
      integer, intent(in) :: n              !! Number of corners
      real(wp) :: corner(2, n)              !! The corners, anticlockwise: (2, n) [m]

      corner = arc(centre, half_axis, 0.0_wp, 2.0_wp*pi*real(n - 1, wp)/real(n, wp), n)
   end function ring

   !> Corners of an opening with walls on a level floor below half an ellipse
   pure function arched_opening(middle, width, wall, rise, n) result(corner)
      real(wp), intent(in) :: middle(2)      !! Middle of the floor: (2) [m]
      real(wp), intent(in) :: width          !! Distance of the walls [m]
      real(wp), intent(in) :: wall           !! Height of the walls [m]
      real(wp), intent(in) :: rise           !! Height of the arch above the walls [m]
      integer, intent(in) :: n               !! Number of edges of the arch
      real(wp), allocatable :: corner(:, :)  !! The corners, anticlockwise: (2, n_corner) [m]
      real(wp) :: roof(2, n + 1)

      roof = arc(middle + [0.0_wp, wall], [0.5_wp*width, rise], 0.0_wp, pi, n + 1)
      if (wall <= 0.0_wp) then
         corner = roof
      else
         corner = reshape([middle + [-0.5_wp*width, 0.0_wp], middle + [0.5_wp*width, 0.0_wp], &
            & roof], [2, n + 3])
      end if
   end function arched_opening

   !> Corners of a horseshoe: half a circle above, walls that narrow to the floor on arcs of twice
   !> its radius
   pure function horseshoe(middle, radius, wall, n) result(corner)
      real(wp), intent(in) :: middle(2)
      real(wp), intent(in) :: radius  !! Radius of the roof [m]
      !> Height of the roof's centre above the floor, less than twice the radius [m]
      real(wp), intent(in) :: wall
      integer, intent(in) :: n  !! Number of edges of the roof; each wall has half as many
      real(wp), allocatable :: corner(:, :)
      real(wp) :: centre(2), fall, right(2, max(1, n/2) + 1), left(2, max(1, n/2) + 1)
      integer :: m

      m = max(1, n/2)
      centre = middle + [0.0_wp, wall]
      fall = asin(wall/(2.0_wp*radius))
      right = arc(centre - [radius, 0.0_wp], [2.0_wp, 2.0_wp]*radius, -fall, 0.0_wp, m + 1)
      left = arc(centre + [radius, 0.0_wp], [2.0_wp, 2.0_wp]*radius, pi, pi + fall, m + 1)
      corner = reshape([right(:, :m), arc(centre, [radius, radius], 0.0_wp, pi, n + 1), &
         & left(:, 2:)], [2, 2*m + n + 1])
   end function horseshoe

   !> Points on an ellipse
   pure function arc(centre, half_axis, from, to, n) result(point)
      real(wp), intent(in) :: centre(2), half_axis(2)
      real(wp), intent(in) :: from, to  !! First and last angle [rad]
      integer, intent(in) :: n          !! Number of points
      real(wp) :: point(2, n)           !! The points: (2, n) [m]
      real(wp) :: angle
      integer :: i

      do i = 1, n
         angle = from + (to - from)*real(i - 1, wp)/real(max(1, n - 1), wp)
         point(:, i) = centre + half_axis*[cos(angle), sin(angle)]
      end do
   end function arc

end module dda_joint_map
