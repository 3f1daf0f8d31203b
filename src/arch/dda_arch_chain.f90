!> An arch of rigid voussoirs as a chain
!>
!> Coordinates are seen from the middle of the crown, and each voussoir from its own first joint:
!> the thickness of a shallow arch, a millionth of its radius, then keeps its digits.
module dda_arch_chain
   use dda_arch, only : arch_shape_t, section_directions
   use dda_chain, only : chain_t, new_chain
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_simplex, only : area_moments, area_moments_t
   use dda_vector, only : cross, right_normal
   implicit none
   private

   public :: arch_numbers_t, arch_rays_t, arch_rays, arch_chain

   !> What an arch of one material is made from
   type :: arch_numbers_t
      !> Its shape
      type(arch_shape_t) :: shape
      !> Mass per volume [kg/m3]
      real(wp) :: density = 0.0_wp
      !> Young's modulus [Pa]
      real(wp) :: young = 0.0_wp
      !> Load per volume: (2) [N/m3]
      real(wp) :: body_force(2) = 0.0_wp
      !> Contact stiffness over the stiffness of the block across the joint
      real(wp) :: penalty_ratio = 0.0_wp
      !> Law of the joints, without cohesion and tensile strength
      type(joint_law_t) :: law
      !> Whether the springings cannot slide
      logical :: no_slip_springing = .false.
   end type arch_numbers_t

   !> What does not depend on the thickness
   type :: arch_rays_t
      !> Directions of the sections from left to right: (2, m)
      real(wp), allocatable :: direction(:, :)
      !> Where they cross the circle halfway through the thickness, from its top, over the radius:
      !> (2, m)
      real(wp), allocatable :: point(:, :)
      !> Which of them are joints: (n_joint)
      integer, allocatable :: joint(:)
   end type arch_rays_t

   !> Most that the stiffness of two joints may differ by, as for other springs
   real(wp), parameter :: stiffest = 1.0e2_wp

contains

   !> Sections of an arch of any thickness
   pure subroutine arch_rays(numbers, rays)
      !> The arch
      type(arch_numbers_t), intent(in) :: numbers
      !> Its sections
      type(arch_rays_t), intent(out) :: rays
      logical, allocatable :: is_joint(:)
      integer :: i, n

      call section_directions(numbers%shape, rays%direction, is_joint)
      allocate (rays%point(2, size(is_joint)), rays%joint(count(is_joint)))
      rays%point(1, :) = rays%direction(1, :)
      ! cos - 1
      rays%point(2, :) = -rays%direction(1, :)**2/(1.0_wp + rays%direction(2, :))
      n = 0
      do i = 1, size(is_joint)
         if (.not. is_joint(i)) cycle
         n = n + 1
         rays%joint(n) = i
      end do
   end subroutine arch_rays

   !> The arch of one thickness ratio
   pure subroutine arch_chain(numbers, rays, thickness_ratio, chain)
      !> The arch
      type(arch_numbers_t), intent(in) :: numbers
      !> Its sections
      type(arch_rays_t), intent(in) :: rays
      !> Thickness over radius
      real(wp), intent(in) :: thickness_ratio
      !> The chain
      type(chain_t), intent(out) :: chain
      type(area_moments_t) :: moments
      real(wp), allocatable :: vertex(:, :)
      real(wp) :: thickness, radius, way(2)
      integer :: b, first, i, k, last, m, n

      n = size(rays%joint) - 1
      call new_chain(n, chain)
      radius = numbers%shape%radius
      thickness = thickness_ratio*radius
      allocate (vertex(2, 2*(1 + maxval(rays%joint(2:) - rays%joint(:n)))))
      chain%stiffness = huge(1.0_wp)
      chain%rounding = 4.0_wp*epsilon(1.0_wp)*real(n, wp)
      do b = 1, n
         first = rays%joint(b)
         last = rays%joint(b + 1)
         m = last - first + 1
         way = 0.0_wp
         do i = 1, m
            k = first + i - 1
            way = radius*(rays%point(:, k) - rays%point(:, first))
            vertex(:, i) = way - thickness/2.0_wp*rays%direction(:, k)
            vertex(:, 2*m + 1 - i) = way + thickness/2.0_wp*rays%direction(:, k)
         end do
         moments = area_moments(vertex(:, :2*m))
         chain%centroid(:, b) = radius*rays%point(:, first) + moments%centroid
         chain%mass(b) = numbers%density*moments%area
         chain%inertia(b) = numbers%density*(moments%second(1) + moments%second(2))
         chain%weight(:, b) = moments%area*numbers%body_force
         chain%arm(:, 2, b) = arms(-moments%centroid, rays%direction(:, first))
         chain%arm(:, 1, b + 1) = arms(way - moments%centroid, rays%direction(:, last))
         chain%stiffness(b:b + 1) = min(chain%stiffness(b:b + 1), &
            & numbers%penalty_ratio*numbers%young*thickness**2/moments%area)
      end do
      chain%stiffness = min(chain%stiffness, stiffest*minval(chain%stiffness))
      chain%arm(:, 1, 1) = 0.0_wp
      chain%arm(:, 2, n + 1) = 0.0_wp
      chain%half = thickness/2.0_wp
      chain%tangent = rays%direction(:, rays%joint)
      chain%middle = radius*rays%point(:, rays%joint)
      chain%friction = numbers%law%friction
      chain%limit = merge(huge(1.0_wp), 0.0_wp, numbers%law%no_slip)
      if (numbers%no_slip_springing) chain%limit([1, n + 1]) = huge(1.0_wp)
   end subroutine arch_chain

   !> Moments of unit forces along the normal and along the tangent of a joint
   pure function arms(way, tangent)
      !> From the centre to the joint's middle: (2) [m]
      real(wp), intent(in) :: way(2)
      !> The tangent: (2)
      real(wp), intent(in) :: tangent(2)
      !> The moments: (2) [m]
      real(wp) :: arms(2)

      arms = [cross(way, right_normal(tangent)), cross(way, tangent)]
   end function arms
end module dda_arch_chain
