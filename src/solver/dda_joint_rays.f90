!> Admissible joint forces as sums of rays: columns of a linear program
!>
!> The forces of a joint are sums of up to four rays with factors that are not negative; kinds that
!> carry a force of either sign have free rays. Rays of one joint stand side by side, empty ones
!> are zero, so that all loops are alike. Lengths are divided by a unit, half the mean length of a
!> joint, and loads by the mean load of a block: all numbers are near one.
module dda_joint_rays
   use dda_joint_graph, only : joint_graph_t, joint_kind
   use dda_kinds, only : wp
   use, intrinsic :: iso_fortran_env, only : int8
   implicit none
   private

   public :: n_side, bound_rays, sum_of_rays, joint_rays, joint_spring, scaled_rows, scale_load
   public :: ray_rates, add_ray_forces, forces_of_rays

   !> Rays of a joint
   integer, parameter :: n_side = 4
   !> Shapes of rays: those of joint_kind, and of frictionless joints of two corners and of one
   integer, parameter :: n_shape = 9, smooth_contact = 7, smooth_corner = 8
   !> Share of the normal force of the first corner in the first two rays, of the second corner in
   !> the others; share of the shear force: (n_side, n_shape)
   real(wp), parameter :: press(n_side, n_shape) = reshape(real([1, 1, 1, 1, 1, 0, 1, 0, &
      & 1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0], wp), &
      & [n_side, n_shape])
   real(wp), parameter :: shear(n_side, n_shape) = reshape(real([1, -1, 1, -1, 0, 1, 0, 0, &
      & 1, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], wp), &
      & [n_side, n_shape])
   !> Shear forces and those of joints that pull have any sign: (n_shape)
   logical, parameter :: pulls(n_shape) = [.false., .false., .false., .false., .true., .true., &
      & .false., .false., .false.]

contains

   !> Mark the rays that are bounded, and those that are free
   pure subroutine bound_rays(graph, bounded, free)
      type(joint_graph_t), intent(in) :: graph
      !> One for rays whose factor may not be negative, zero for free and for empty ones:
      !> (n_side, n_joint)
      integer(int8), allocatable, intent(out) :: bounded(:, :)
      !> One for rays of any sign: (n_side, n_joint)
      integer(int8), allocatable, intent(out) :: free(:, :)
      real(wp) :: part(2)
      integer :: j, shape

      allocate (bounded(n_side, size(graph%kind)), free(n_side, size(graph%kind)), source=0_int8)
      do j = 1, size(graph%kind)
         call ray_shape(graph%kind(j), graph%friction(j), shape, part)
         where (press(:, shape) > 0.0_wp .and. .not. pulls(shape))
            bounded(:, j) = 1_int8
         else where (abs(press(:, shape)) + abs(shear(:, shape)) > 0.0_wp)
            free(:, j) = 1_int8
         end where
         if (shape == joint_kind%strip) bounded(:2, j) = 1_int8
      end do
   end subroutine bound_rays

   !> The shape of the rays of a joint; those of joints with much friction are as long as the others
   pure subroutine ray_shape(kind, friction, shape, part)
      integer, intent(in) :: kind       !! Its kind, one of joint_kind
      real(wp), intent(in) :: friction  !! Coefficient of friction
      integer, intent(out) :: shape     !! Its number
      real(wp), intent(out) :: part(2)  !! Length of normal and of shear forces in them: (2)

      shape = kind
      part = 1.0_wp
      if (kind /= joint_kind%contact .and. kind /= joint_kind%corner) return
      if (friction > 1.0_wp) then
         part(1) = 1.0_wp/friction
      else if (friction > 0.0_wp) then
         part(2) = friction
      else
         shape = merge(smooth_contact, smooth_corner, kind == joint_kind%contact)
      end if
   end subroutine ray_shape

   !> The rays of a joint: N1, N2, T of each
   pure function joint_rays(kind, friction) result(ray)
      integer, intent(in) :: kind       !! Its kind, one of joint_kind
      real(wp), intent(in) :: friction  !! Coefficient of friction
      real(wp) :: ray(3, n_side)        !! N1, N2, T: (3, n_side)
      real(wp) :: part(2)
      integer :: shape

      call ray_shape(kind, friction, shape, part)
      ray = 0.0_wp
      ray(1, :2) = part(1)*press(:2, shape)
      ray(2, 3:) = part(1)*press(3:, shape)
      ray(3, :) = part(2)*shear(:, shape)
   end function joint_rays

   !> Stiffness of a joint against openings and slip: the sum of the springs of its rays
   pure function joint_spring(kind, friction, stiffness) result(spring)
      integer, intent(in) :: kind           !! Its kind, one of joint_kind
      real(wp), intent(in) :: friction      !! Coefficient of friction
      real(wp), intent(in) :: stiffness(n_side)  !! Stiffness of each ray
      real(wp) :: spring(3, 3)              !! Opening 1, opening 2, slip: (3, 3)
      real(wp) :: part(2)
      integer :: shape

      call ray_shape(kind, friction, shape, part)
      associate (k => stiffness, p => press(:, shape), s => shear(:, shape))
         spring(1, 1) = part(1)**2*(p(1)*k(1) + p(2)*k(2))
         spring(2, 2) = part(1)**2*(p(3)*k(3) + p(4)*k(4))
         spring(3, 3) = part(2)**2*(s(1)**2*k(1) + s(2)**2*k(2) + s(3)**2*k(3) + s(4)**2*k(4))
         spring(3, 1) = part(1)*part(2)*(p(1)*s(1)*k(1) + p(2)*s(2)*k(2))
         spring(3, 2) = part(1)*part(2)*(p(3)*s(3)*k(3) + p(4)*s(4)*k(4))
      end associate
      spring(2, 1) = 0.0_wp
      spring(1, 2) = 0.0_wp
      spring(1:2, 3) = spring(3, 1:2)
   end function joint_spring

   !> Forces of a joint from the factors of its rays
   pure function sum_of_rays(kind, friction, x) result(force)
      integer, intent(in) :: kind       !! Its kind, one of joint_kind
      real(wp), intent(in) :: friction  !! Coefficient of friction
      real(wp), intent(in) :: x(n_side) !! Their factors
      real(wp) :: force(3)              !! N1, N2, T: (3)
      real(wp) :: part(2)
      integer :: shape

      call ray_shape(kind, friction, shape, part)
      if (shape == joint_kind%contact) then
         force = [part(1)*(x(1) + x(2)), part(1)*(x(3) + x(4)), part(2)*(x(1) - x(2) + x(3) - x(4))]
         return
      end if
      associate (p => press(:, shape), s => shear(:, shape))
         force(1) = part(1)*(p(1)*x(1) + p(2)*x(2))
         force(2) = part(1)*(p(3)*x(3) + p(4)*x(4))
         force(3) = part(2)*(s(1)*x(1) + s(2)*x(2) + s(3)*x(3) + s(4)*x(4))
      end associate
   end function sum_of_rays

   !> Rows of a joint for rigid bodies; a block that touches itself has those of both sides as its
   !> first
   pure function scaled_rows(graph, j, length) result(row)
      type(joint_graph_t), intent(in) :: graph
      integer, intent(in) :: j            !! Number of the joint
      real(wp), intent(in) :: length      !! Unit of length [m]
      real(wp) :: row(3, 3, 2)            !! Opening 1, opening 2, slip by unit motion: (3, 3, 2)

      integer :: side

      do side = 1, 2
         row(1:2, :, side) = graph%row(1:2, :, side, j)
         row(3, :, side) = (1.0_wp/length)*graph%row(3, :, side, j)
      end do
      if (graph%block(1, j) /= graph%block(2, j)) return
      row(:, :, 1) = row(:, :, 1) + row(:, :, 2)
      row(:, :, 2) = 0.0_wp
   end function scaled_rows

   !> Loads of the blocks in the units of the rays
   pure subroutine scale_load(load, unit, length, scaled)
      real(wp), intent(in) :: load(:, :)         !! Loads: (3, n_block) [N/m, N/m, N]
      real(wp), intent(in) :: unit               !! Unit of force: [N/m]
      real(wp), intent(in) :: length             !! Unit of length [m]
      !> In the units of the rays, none on what cannot move: (3, 0:n_block)
      real(wp), intent(out) :: scaled(:, 0:)

      scaled(:, 0) = 0.0_wp
      scaled(1:2, 1:) = load(1:2, :)/unit
      scaled(3, 1:) = load(3, :)/(unit*length)
   end subroutine scale_load

   !> Rate at which motion opens the joints along each ray
   pure subroutine ray_rates(graph, length, v, rate)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: length                   !! Unit of length [m]
      real(wp), intent(in) :: v(3, 0:graph%n_block)    !! Motion
      real(wp), intent(out) :: rate(n_side, size(graph%kind))  !! Rates
      real(wp) :: arm, opening(3), part(2), p(3), q(3)
      integer :: i, j, shape

      arm = 1.0_wp/length
      do j = 1, size(rate, 2)
         p = v(:, graph%block(1, j))
         q = v(:, graph%block(2, j))
         p(3) = arm*p(3)
         q(3) = arm*q(3)
         do i = 1, 3
            opening(i) = graph%row(1, i, 1, j)*p(1) + graph%row(2, i, 1, j)*p(2) &
               & + graph%row(3, i, 1, j)*p(3) + graph%row(1, i, 2, j)*q(1) &
               & + graph%row(2, i, 2, j)*q(2) + graph%row(3, i, 2, j)*q(3)
         end do
         call ray_shape(graph%kind(j), graph%friction(j), shape, part)
         opening = opening*[part(1), part(1), part(2)]
         if (shape == joint_kind%contact) then
            rate(:, j) = [opening(1) + opening(3), opening(1) - opening(3), &
               & opening(2) + opening(3), opening(2) - opening(3)]
         else
            rate(:, j) = press(:, shape)*opening([1, 1, 2, 2]) + shear(:, shape)*opening(3)
         end if
      end do
   end subroutine ray_rates

   !> Add what the forces along the rays do to the blocks
   pure subroutine add_ray_forces(graph, length, x, load)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: length  !! Unit of length [m]
      real(wp), intent(in) :: x(n_side, size(graph%kind))  !! Their factors
      !> Loads, to which theirs are added; what falls to 0 is lost
      real(wp), intent(inout) :: load(3, 0:graph%n_block)
      real(wp) :: arm, f(3)
      integer :: b, j, side

      arm = 1.0_wp/length
      do j = 1, size(x, 2)
         f = sum_of_rays(graph%kind(j), graph%friction(j), x(:, j))
         do side = 1, 2
            b = graph%block(side, j)
            call add_rows(graph%row(1, 1, side, j), arm, f, load(:, b))
         end do
      end do
      load(:, 0) = 0.0_wp
   end subroutine add_ray_forces

   !> Add what the forces of a joint do to one of its blocks
   pure subroutine add_rows(row, arm, f, load)
      real(wp), intent(in) :: row(3, 3)     !! Opening 1, opening 2, slip by unit motion
      real(wp), intent(in) :: arm           !! One over the unit of length [1/m]
      real(wp), intent(in) :: f(3)          !! N1, N2, T
      real(wp), intent(inout) :: load(3)    !! Load to which theirs is added
      integer :: k

      do k = 1, 2
         load(k) = load(k) + (row(k, 1)*f(1) + row(k, 2)*f(2) + row(k, 3)*f(3))
      end do
      load(3) = load(3) + arm*(row(3, 1)*f(1) + row(3, 2)*f(2) + row(3, 3)*f(3))
   end subroutine add_rows

   !> Forces of the joints from the factors of their rays
   pure subroutine forces_of_rays(graph, x, unit, force)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: x(:, :)       !! Their factors: (n_side, n_joint)
      real(wp), intent(in) :: unit
      real(wp), intent(out) :: force(:, :)  !! N1, N2, T: (3, n_joint) [N/m]
      integer :: j

      do j = 1, size(x, 2)
         force(:, j) = unit*sum_of_rays(graph%kind(j), graph%friction(j), x(:, j))
      end do
   end subroutine forces_of_rays
end module dda_joint_rays
