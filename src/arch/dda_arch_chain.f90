!> An arch of rigid voussoirs as a chain
!>
!> The origin is the middle of the crown, and for each voussoir that of its own first joint:
!> the thickness t of a shallow arch, a millionth of its radius, then keeps its digits. Area, centre
!> and moment of inertia are polynomials of t, whose coefficients are found once: a point of a
!> voussoir is X0 + s X1, with X0 on a chord halfway through the thickness, X1 between the
!> directions of the chord's ends, and s from -t/2 to t/2.
module dda_arch_chain
   use dda_arch, only : arch_shape_t, left_directions, section_directions
   use dda_chain, only : chain_block_t, chain_joint_t, chain_t, new_chain
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   implicit none
   private

   public :: arch_numbers_t, arch_rays_t, arch_rays, arch_chain

   !> Shape, material and joints of an arch
   type :: arch_numbers_t
      type(arch_shape_t) :: shape         !! Its shape
      real(wp) :: density = 0.0_wp        !! Mass per volume [kg/m3]
      real(wp) :: young = 0.0_wp          !! Young's modulus [Pa]
      real(wp) :: body_force(2) = 0.0_wp  !! Load per volume: (2) [N/m3]
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp) :: penalty_ratio = 0.0_wp
      type(joint_law_t) :: law  !! Law of the joints, without cohesion and tensile strength
      !> True if the springings cannot slide
      logical :: no_slip_springing = .false.
      logical :: halved = .false.  !! True if the left half alone suffices: under vertical loads
   end type arch_numbers_t

   !> Numbers that do not depend on the thickness, of the whole arch or its left half
   type :: arch_rays_t
      !> True if the plane of symmetry cuts a voussoir, whose left half is the last one
      logical :: keystone = .false.
      !> Directions of the sections from left to right: (2, m)
      real(wp), allocatable :: direction(:, :)
      !> Where they cross the circle halfway through the thickness, from its top, over the radius:
      !> (2, m)
      real(wp), allocatable :: point(:, :)
      !> Numbers of those at joints or at the plane of symmetry: (n_joint)
      integer, allocatable :: joint(:)
      !> Areas of the voussoirs over t: (n) [m]
      real(wp), allocatable :: area(:)
      !> Stiffness of the joints over that of the blocks' material, per thickness: (n + 1) [1/m]
      real(wp), allocatable :: stiffness(:)
      !> Their centres from the middles of their first joints: centre(:, 1) + centre(:, 2) t**2:
      !> (2, 2, n) [m, 1/m]
      real(wp), allocatable :: centre(:, :, :)
      !> Squares of their radii of gyration about these middles, likewise: (2, n) [m2, 1]
      real(wp), allocatable :: gyration(:, :)
   end type arch_rays_t

   !> Largest ratio of joint stiffnesses
   real(wp), parameter :: stiffest = 1.0e2_wp
   !> Least size of a block at a joint, over the root of its area
   real(wp), parameter :: least_size = 0.1_wp

contains

   !> Sections of an arch of any thickness
   pure subroutine arch_rays(numbers, rays)
      type(arch_numbers_t), intent(in) :: numbers
      type(arch_rays_t), intent(out) :: rays
      logical, allocatable :: is_joint(:)
      real(wp), allocatable :: length(:)
      real(wp) :: longest
      integer :: b, i, n

      if (numbers%halved) then
         call left_directions(numbers%shape, rays%direction, is_joint)
      else
         call section_directions(numbers%shape, rays%direction, is_joint)
      end if
      allocate (rays%point(2, size(is_joint)))
      rays%point(1, :) = rays%direction(1, :)
      ! cos - 1, without loss of digits at the crown and opposite to it
      rays%point(2, :) = rays%direction(2, :) - 1.0_wp
      where (rays%direction(2, :) > 0.0_wp) rays%point(2, :) = &
         & -rays%direction(1, :)**2/(1.0_wp + rays%direction(2, :))
      if (numbers%halved) call meet_plane(rays, is_joint)
      allocate (rays%joint(count(is_joint)))
      n = 0
      do i = 1, size(is_joint)
         if (.not. is_joint(i)) cycle
         n = n + 1
         rays%joint(n) = i
      end do
      n = size(rays%joint) - 1
      allocate (rays%area(n), rays%centre(2, 2, n), rays%gyration(2, n))
      do b = 1, n
         call find_moments(numbers%shape%radius, rays, b)
      end do
      allocate (rays%stiffness(n + 1))
      length = rays%area
      if (rays%keystone) then
         length(n) = 2.0_wp*length(n)
         rays%direction(:, rays%joint(n + 1)) = [0.0_wp, 1.0_wp]
      end if
      longest = maxval(length)
      do b = 1, n + 1
         rays%stiffness(b) = min(stiffest/longest, &
            & 1.0_wp/max(length(max(1, b - 1)), length(min(b, n))))
      end do
   end subroutine arch_rays

   !> Let the left half of an arch end on its plane of symmetry, where the direction is the mean of
   !> those on either side
   pure subroutine meet_plane(rays, is_joint)
      type(arch_rays_t), intent(inout) :: rays
      !> True for sections at joints; the plane counts as one
      logical, allocatable, intent(inout) :: is_joint(:)
      integer :: m

      m = size(is_joint)
      rays%keystone = .not. is_joint(m) .or. rays%direction(1, m) < 0.0_wp
      if (rays%direction(1, m) < 0.0_wp) then
         rays%direction = reshape([rays%direction, 0.0_wp, rays%direction(2, m)], [2, m + 1])
         rays%point = reshape([rays%point, 0.0_wp, rays%point(2, m)], [2, m + 1])
         is_joint = [is_joint, .true.]
      else
         is_joint(m) = .true.
      end if
   end subroutine meet_plane

   !> Coefficients of one voussoir. As its chords lie across the mean directions of their ends, an
   !> area is rate (1 + s/radius) ds du, with u from 0 to 1 along the chord
   pure subroutine find_moments(radius, rays, b)
      real(wp), intent(in) :: radius  !! Radius halfway through the thickness [m]
      !> The sections; the coefficients of the voussoir are set
      type(arch_rays_t), intent(inout) :: rays
      integer, intent(in) :: b  !! Number of the voussoir
      real(wp) :: chord(2), from(2), mean(2), spread(2), area, rate, first(2, 2), polar(2)
      integer :: k

      area = 0.0_wp
      first = 0.0_wp
      polar = 0.0_wp
      do k = rays%joint(b), rays%joint(b + 1) - 1
         chord = radius*(rays%point(:, k + 1) - rays%point(:, k))
         from = radius*(rays%point(:, k) - rays%point(:, rays%joint(b))) + chord/2.0_wp
         spread = rays%direction(:, k + 1) - rays%direction(:, k)
         mean = rays%direction(:, k) + spread/2.0_wp
         rate = chord(1)*mean(2) - chord(2)*mean(1)
         area = area + rate
         first(:, 1) = first(:, 1) + rate*from
         first(:, 2) = first(:, 2) + (rate/(12.0_wp*radius))*mean
         polar(1) = polar(1) + rate*(dot_product(from, from) + dot_product(chord, chord)/12.0_wp)
         polar(2) = polar(2) + (rate/12.0_wp)*(dot_product(mean, mean) &
            & + dot_product(spread, spread)/12.0_wp + (dot_product(from, mean) &
            & + dot_product(chord, spread)/12.0_wp)*(2.0_wp/radius))
      end do
      rays%area(b) = area
      rays%centre(:, :, b) = first/area
      rays%gyration(:, b) = polar/area
   end subroutine find_moments

   !> The arch of one thickness ratio
   pure subroutine arch_chain(numbers, rays, thickness_ratio, chain)
      type(arch_numbers_t), intent(in) :: numbers
      type(arch_rays_t), intent(in) :: rays
      real(wp), intent(in) :: thickness_ratio  !! Thickness over radius
      !> Any chain in, whose arrays are used again where they fit
      type(chain_t), intent(inout) :: chain
      real(wp) :: thickness
      integer :: m, n

      n = size(rays%joint)
      m = size(rays%point, 2)
      call new_chain(n - 1, chain)
      thickness = thickness_ratio*numbers%shape%radius
      call set_joints(numbers, thickness, n, m, rays%joint, rays%direction, rays%point, &
         & rays%stiffness, chain%joint, chain%reach)
      call set_blocks(numbers, thickness, n, m, rays%joint, rays%point, rays%area, rays%centre, &
         & rays%gyration, chain%joint, chain%block, chain%whole_load)
      if (.not. numbers%law%no_slip) call add_compliances(numbers, rays, thickness, chain)
      if (numbers%no_slip_springing) chain%joint([1, n])%no_slip = .true.
      if (numbers%halved) call add_plane(rays, chain)
   end subroutine arch_chain

   !> Set the joints except their arms
   pure subroutine set_joints(numbers, thickness, n, m, section, direction, point, stiffness, &
      & joint, reach)
      type(arch_numbers_t), intent(in) :: numbers
      real(wp), intent(in) :: thickness  !! Thickness of the arch [m]
      integer, intent(in) :: n, m        !! Numbers of joints and of sections
      integer, intent(in) :: section(n)  !! Sections of the joints
      !> Of the rays: directions and points of the sections, stiffness of the joints
      real(wp), intent(in) :: direction(2, m), point(2, m), stiffness(n)
      type(chain_joint_t), intent(inout) :: joint(n)  !! The joints
      real(wp), intent(out) :: reach  !! Farthest coordinate of their middles [m]
      type(chain_joint_t) :: this
      real(wp) :: spring
      integer :: b

      reach = 0.0_wp
      spring = numbers%penalty_ratio*numbers%young*thickness
      this%half = thickness/2.0_wp
      this%friction = numbers%law%friction
      this%no_slip = numbers%law%no_slip
      do b = 1, n
         this%tangent = direction(:, section(b))
         this%middle = numbers%shape%radius*point(:, section(b))
         this%stiffness = spring*stiffness(b)
         reach = max(reach, abs(this%middle(1)), abs(this%middle(2)))
         joint(b) = this
      end do
   end subroutine set_joints

   !> Set the blocks, and the arms of the joints
   pure subroutine set_blocks(numbers, thickness, n, m, section, point, areas, centres, gyration, &
      & joint, block, whole_load)
      type(arch_numbers_t), intent(in) :: numbers
      real(wp), intent(in) :: thickness
      integer, intent(in) :: n, m
      integer, intent(in) :: section(n)
      !> Of the rays: points of the sections; areas, centres and gyrations of the voussoirs
      real(wp), intent(in) :: point(2, m), areas(n - 1), centres(2, 2, n - 1), gyration(2, n - 1)
      type(chain_joint_t), intent(inout) :: joint(n)      !! The joints
      type(chain_block_t), intent(inout) :: block(n - 1)  !! The blocks
      real(wp), intent(out) :: whole_load  !! Sum of the sizes of the loads [N/m]
      real(wp) :: area, centre(2), square, way(2)
      integer :: b

      whole_load = 0.0_wp
      square = thickness**2
      do b = 1, n - 1
         area = areas(b)*thickness
         centre = centres(:, 1, b) + centres(:, 2, b)*square
         block(b)%centroid = joint(b)%middle + centre
         block(b)%mass = numbers%density*area
         block(b)%inertia = block(b)%mass*(gyration(1, b) + gyration(2, b)*square &
            & - centre(1)**2 - centre(2)**2)
         block(b)%weight = area*numbers%body_force
         whole_load = whole_load + abs(block(b)%weight(1)) + abs(block(b)%weight(2))
         way = numbers%shape%radius*(point(:, section(b + 1)) - point(:, section(b))) - centre
         call find_arms(-centre, joint(b)%tangent, joint(b)%arm(:, 2))
         call find_arms(way, joint(b + 1)%tangent, joint(b + 1)%arm(:, 1))
      end do
   end subroutine set_blocks

   !> Add the compliances of the voussoirs: the loading path depends on them
   pure subroutine add_compliances(numbers, rays, thickness, chain)
      type(arch_numbers_t), intent(in) :: numbers
      type(arch_rays_t), intent(in) :: rays
      real(wp), intent(in) :: thickness  !! Thickness of the arch [m]
      type(chain_t), intent(inout) :: chain
      real(wp) :: area, give
      integer :: b, first, n

      n = size(chain%block)
      give = 1.0_wp/(numbers%young*thickness)
      do b = 1, n - merge(1, 0, rays%keystone)
         area = rays%area(b)*thickness
         associate (before => chain%joint(b), behind => chain%joint(b + 1))
            call add_compliance(give, area, before%arm(2, 2), thickness, before%compliance)
            call add_compliance(give, area, behind%arm(2, 1), thickness, behind%compliance)
         end associate
      end do
      if (.not. rays%keystone) return
      first = rays%joint(n)
      associate (radius => numbers%shape%radius)
         call add_compliance(give, 2.0_wp*rays%area(n)*thickness, radius*(rays%direction(2, first) &
            & *rays%point(1, first)) - rays%direction(1, first)*(radius*rays%point(2, first) &
            & - chain%block(n)%centroid(2)), thickness, chain%joint(n)%compliance)
      end associate
   end subroutine add_compliances

   !> Add the half of a block at a joint to its compliance
   pure subroutine add_compliance(give, area, across, thickness, compliance)
      real(wp), intent(in) :: give       !! One over Young's modulus and thickness [m/N]
      real(wp), intent(in) :: area       !! Area of the block [m2]
      real(wp), intent(in) :: across     !! Distance of its centre from the joint, of any sign [m]
      real(wp), intent(in) :: thickness  !! Length of the joint [m]
      !> Receives it [m2/N]
      real(wp), intent(inout) :: compliance
      real(wp) :: least

      if (min(across**2, thickness**2) >= least_size**2*area) then
         compliance = compliance + abs(across)*give
      else
         least = least_size*sqrt(area)
         compliance = compliance + max(abs(across), least)*give*thickness/max(thickness, least)
      end if
   end subroutine add_compliance

   !> Make the last joint the plane of symmetry
   pure subroutine add_plane(rays, chain)
      type(arch_rays_t), intent(in) :: rays
      type(chain_t), intent(inout) :: chain
      integer :: last

      last = size(chain%joint)
      chain%halved = .true.
      chain%keystone = rays%keystone
      chain%joint(last)%stiffness = 2.0_wp*chain%joint(last)%stiffness
      chain%joint(last)%friction = 0.0_wp
      chain%joint(last)%no_slip = .false.
   end subroutine add_plane

   !> Moments of unit forces along the normal and along the tangent of a joint
   pure subroutine find_arms(way, tangent, arms)
      real(wp), intent(in) :: way(2)      !! From the centre to the joint's middle: (2) [m]
      real(wp), intent(in) :: tangent(2)  !! The tangent: (2)
      real(wp), intent(out) :: arms(2)    !! The moments: (2) [m]

      arms(1) = -way(1)*tangent(1) - way(2)*tangent(2)
      arms(2) = way(1)*tangent(2) - way(2)*tangent(1)
   end subroutine find_arms
end module dda_arch_chain
