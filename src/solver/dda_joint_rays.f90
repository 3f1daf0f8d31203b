!> What joints can carry as sums of rays: the columns of a linear programme
!>
!> The forces of a joint are sums of up to four rays with factors that are not negative; kinds that
!> carry a force of either sign have free rays. Rays of one joint stand side by side, empty ones
!> are zero, so that all loops are alike. Lengths are divided by half the mean length of a joint
!> and loads by the mean load of a block: all numbers are near one.
module dda_joint_rays
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use dda_limit_certificate, only : unit_of_length
   use, intrinsic :: iso_fortran_env, only : int8
   implicit none
   private

   public :: joint_rays_t, n_side, set_rays, scale_load, ray_rates, add_ray_forces, forces_of_rays

   !> Rays of a joint
   integer, parameter :: n_side = 4

   !> The rays of all joints
   type :: joint_rays_t
      !> Number of blocks that can move
      integer :: n_block = 0
      !> The two blocks of each joint, 0 for none: (2, n_joint)
      integer, allocatable :: block(:, :)
      !> Force and moment of each ray on the first block, then on the second:
      !> (n_side, 6, n_joint)
      real(wp), allocatable :: arm(:, :, :)
      !> One for rays whose factor may not be negative, zero for free and for empty ones:
      !> (n_side, n_joint)
      integer(int8), allocatable :: bounded(:, :)
      !> One for rays of any sign: (n_side, n_joint)
      integer(int8), allocatable :: free(:, :)
      !> Number of rays whose factor may not be negative
      integer :: n_bounded = 0
      !> Unit of length: [m]
      real(wp) :: length = 1.0_wp
   end type joint_rays_t

contains

   !> The rays of all joints of a graph; of blocks that strain, the motion as rigid bodies
   pure subroutine set_rays(graph, rays)
      type(joint_graph_t), intent(in) :: graph
      type(joint_rays_t), intent(out) :: rays
      real(wp) :: force(3, n_side)
      integer :: i, j, k, n, side

      n = size(graph%kind)
      rays%n_block = graph%n_block
      allocate (rays%block, source=graph%block)
      rays%length = unit_of_length(graph)
      allocate (rays%arm(n_side, 6, n), source=0.0_wp)
      allocate (rays%bounded(n_side, n), rays%free(n_side, n))
      do j = 1, n
         call span_joint(graph%kind(j), graph%friction(j), force, rays%bounded(:, j), &
            & rays%free(:, j))
         ! a block that touches itself has one arm, the sum of both
         if (rays%block(1, j) == rays%block(2, j)) rays%block(2, j) = 0
         do side = 1, 2
            if (graph%block(side, j) == 0) cycle
            k = merge(3, 0, side == 2 .and. rays%block(2, j) /= 0)
            do i = 1, n_side
               rays%arm(i, k + 1:k + 3, j) = rays%arm(i, k + 1:k + 3, j) &
                  & + matmul(graph%row(1:3, :, side, j), force(:, i)) &
                  & /[1.0_wp, 1.0_wp, rays%length]
            end do
         end do
      end do
      rays%n_bounded = count(rays%bounded > 0)
   end subroutine set_rays

   !> The rays of one joint
   pure subroutine span_joint(kind, friction, force, bounded, free)
      integer, intent(in) :: kind           !! What it can carry, one of joint_kind
      real(wp), intent(in) :: friction      !! Coefficient of friction
      real(wp), intent(out) :: force(:, :)  !! N1, N2, T of each ray: (3, n_side)
      !> One where the factor may not be negative: (n_side)
      integer(int8), intent(out) :: bounded(:)
      !> One where it may have any sign: (n_side)
      integer(int8), intent(out) :: free(:)
      real(wp), parameter :: first(3) = [1.0_wp, 0.0_wp, 0.0_wp]
      real(wp), parameter :: second(3) = [0.0_wp, 1.0_wp, 0.0_wp]
      real(wp), parameter :: shear(3) = [0.0_wp, 0.0_wp, 1.0_wp]
      real(wp) :: long

      force = 0.0_wp
      bounded = 0
      free = 0
      select case (kind)
      case (joint_kind%contact, joint_kind%corner)
         ! rays of joints with much friction are as long as the others
         long = max(1.0_wp, friction)
         force(:, 1) = (first + friction*shear)/long
         bounded(1) = 1
         if (friction > 0.0_wp) then
            force(:, 2) = (first - friction*shear)/long
            bounded(2) = 1
         end if
         if (kind == joint_kind%contact) then
            force(:, 3) = (second + friction*shear)/long
            force(:, 4) = (second - friction*shear)/long
            bounded(3) = 1
            bounded(4) = bounded(2)
            if (.not. friction > 0.0_wp) force(:, 4) = 0.0_wp
         end if
      case (joint_kind%no_slip)
         force(:, 1:3) = reshape([first, second, shear], [3, 3])
         bounded(1:2) = 1
         free(3) = 1
      case (joint_kind%corner_no_slip)
         force(:, 1:2) = reshape([first, shear], [3, 2])
         bounded(1) = 1
         free(2) = 1
      case (joint_kind%pin)
         force(:, 1:2) = reshape([first, shear], [3, 2])
         free(1:2) = 1
      case (joint_kind%mirror)
         force(:, 1:2) = reshape([first, second], [3, 2])
         free(1:2) = 1
      end select
   end subroutine span_joint

   !> Loads of the blocks in the units of the rays
   pure subroutine scale_load(rays, load, unit, scaled)
      type(joint_rays_t), intent(in) :: rays
      !> Loads: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: load(:, :)
      !> Unit of force: [N/m]
      real(wp), intent(in) :: unit
      !> In the units of the rays, none on what cannot move: (3, 0:n_block)
      real(wp), intent(out) :: scaled(:, 0:)

      scaled(:, 0) = 0.0_wp
      scaled(1:2, 1:) = load(1:2, :)/unit
      scaled(3, 1:) = load(3, :)/(unit*rays%length)
   end subroutine scale_load

   !> Rate at which motion opens the joints along each ray
   pure subroutine ray_rates(rays, v, rate)
      type(joint_rays_t), intent(in) :: rays
      real(wp), intent(in) :: v(:, 0:)                 !! Motion: (3, 0:n_block)
      real(wp), intent(out), contiguous :: rate(:, :)  !! Rates: (n_side, n_joint)
      real(wp) :: p(3), q(3)
      integer :: i, j

      do j = 1, size(rays%block, 2)
         p = v(:, rays%block(1, j))
         q = v(:, rays%block(2, j))
         do i = 1, n_side
            rate(i, j) = rays%arm(i, 1, j)*p(1) + rays%arm(i, 2, j)*p(2) &
               & + rays%arm(i, 3, j)*p(3) + rays%arm(i, 4, j)*q(1) &
               & + rays%arm(i, 5, j)*q(2) + rays%arm(i, 6, j)*q(3)
         end do
      end do
   end subroutine ray_rates

   !> Add what the forces along the rays do to the blocks
   pure subroutine add_ray_forces(rays, x, load)
      type(joint_rays_t), intent(in) :: rays
      !> Their factors: (n_side, n_joint)
      real(wp), intent(in), contiguous :: x(:, :)
      !> Loads, to which theirs are added; what falls to 0 is lost: (3, 0:n_block)
      real(wp), intent(inout) :: load(:, 0:)
      real(wp) :: p(6)
      integer :: a, b, j, k

      do j = 1, size(rays%block, 2)
         a = rays%block(1, j)
         b = rays%block(2, j)
         do k = 1, 6
            p(k) = rays%arm(1, k, j)*x(1, j) + rays%arm(2, k, j)*x(2, j) &
               & + rays%arm(3, k, j)*x(3, j) + rays%arm(4, k, j)*x(4, j)
         end do
         load(:, a) = load(:, a) + p(1:3)
         load(:, b) = load(:, b) + p(4:6)
      end do
      load(:, 0) = 0.0_wp
   end subroutine add_ray_forces

   !> Forces of the joints from the factors of their rays
   pure subroutine forces_of_rays(graph, x, unit, force)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: x(:, :)       !! Their factors: (n_side, n_joint)
      real(wp), intent(in) :: unit
      real(wp), intent(out) :: force(:, :)  !! N1, N2, T: (3, n_joint) [N/m]
      real(wp) :: ray(3, n_side)
      integer(int8) :: bounded(n_side), free(n_side)
      integer :: j

      do j = 1, size(x, 2)
         call span_joint(graph%kind(j), graph%friction(j), ray, bounded, free)
         force(:, j) = unit*matmul(ray, x(:, j))
      end do
   end subroutine forces_of_rays
end module dda_joint_rays
