!> How an assembly that cannot carry its load begins to fall
!>
!> Of all accelerations that the joints allow, the true ones are nearest to those of free fall, in
!> the measure of the masses (Gauss):
!>
!>    mass a = load + A x,   s = A'a >= 0,   x >= 0,   x s = 0      A: arms of the rays, x: forces
!>
!> It is the interior-point method of limit analysis with masses instead of a factor: springs of
!> stiffness x/s along the rays and masses make the matrix, and the answer is one alone. Joints that
!> slide open by their friction, as limit analysis has it.
module dda_first_motion
   use dda_joint_graph, only : joint_graph_t
   use dda_joint_rays, only : add_ray_forces, joint_forces, joint_rays_t, n_side, ray_rates, &
      & scale_load, set_rays
   use dda_kinds, only : wp
   use dda_limit_decision, only : keep_velocities, unit_of_force
   use dda_ray_matrix, only : plan_matrix, ray_matrix_t, set_springs, solve_springs
   implicit none
   private

   public :: find_first_motion

   !> Accelerations and forces, or a step from them
   type :: fall_t
      !> Accelerations: (3, 0:n_block)
      real(wp), allocatable :: a(:, :)
      !> Forces along the rays, rates at which the rays open: (n_side, n_joint)
      real(wp), allocatable :: x(:, :), s(:, :)
   end type fall_t

   !> What may be left of equations and products, and what is aimed at
   real(wp), parameter :: accepted = 1.0e-7_wp, aim = 1.0e-11_wp
   !> Share by which diagonal entries are raised
   real(wp), parameter :: lift = 1.0e-14_wp
   !> Stiffness of free rays over that of the others in the mean
   real(wp), parameter :: stiffness_of_free = 1.0e8_wp

contains

   !> Accelerations, the largest one
   pure subroutine find_first_motion(graph, load, motion, force, found, n_factorisation)
      !> The joints
      type(joint_graph_t), intent(in) :: graph
      !> Loads: (n_dof, n_block) [N/m, N/m, N ...]
      real(wp), intent(in) :: load(:, :)
      !> Accelerations: (n_dof, n_block)
      real(wp), intent(out) :: motion(:, :)
      !> N1, N2, T of each joint: (3, n_joint) [N/m]
      real(wp), intent(out) :: force(:, :)
      !> Whether they were found
      logical, intent(out) :: found
      !> Factorisations
      integer, intent(out) :: n_factorisation
      integer, parameter :: max_turn = 60, patience = 3, more_patience = 12
      type(joint_rays_t) :: rays
      type(ray_matrix_t) :: springs
      type(fall_t) :: best, now, step
      real(wp) :: least, left
      real(wp) :: driven(3, 0:graph%n_block), mass(3, 0:graph%n_block), product
      integer :: idle, turn

      call set_rays(graph, rays)
      call plan_matrix(rays, springs)
      call scale_load(rays, load, unit_of_force(load), driven)
      mass(:, 0) = 0.0_wp
      mass(:, 1:) = graph%mass(1:3, :)/maxval(graph%mass(1, :))
      mass(3, 1:) = mass(3, 1:)/rays%length**2
      call begin(rays, springs, driven, mass, now)
      step = now
      least = huge(least)
      idle = 0
      do turn = 1, max_turn
         left = what_is_left(rays, driven, mass, now)
         idle = idle + 1
         if (left < least) then
            least = left
            best = now
            idle = 0
         end if
         if (least < aim .or. .not. left <= huge(left)) exit
         if (idle == merge(patience, more_patience, least < accepted)) exit
         product = mean_product(rays, now%x*now%s)
         call set_stiffness(rays, now, springs)
         call set_springs(rays, lift, springs, mass)
         if (.not. springs%usable) exit
         step%x = -now%x*rays%bounded
         call find_step(rays, springs, driven, mass, now, step)
         product = product*(mean_product(rays, (now%x + reach(rays, now, step)*step%x) &
            & *(now%s + reach(rays, now, step)*step%s))/product)**3
         step%x = ((product - step%x*step%s)/now%s - now%x)*rays%bounded
         call find_step(rays, springs, driven, mass, now, step)
         step%s = step%s*rays%bounded
         call move(0.995_wp*reach(rays, now, step), step, now)
      end do
      found = least < accepted
      n_factorisation = springs%n_factorisation
      call keep_velocities(rays, best%a, motion)
      call joint_forces(rays, best%x, unit_of_force(load), force)
   end subroutine find_first_motion

   !> Springs of equal stiffness beside the masses; forces and rates are then pushed inside
   pure subroutine begin(rays, springs, load, mass, now)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The matrix
      type(ray_matrix_t), intent(inout) :: springs
      !> Load: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Where the iteration begins
      type(fall_t), intent(out) :: now

      allocate (now%a, mold=load)
      allocate (now%x, now%s, mold=rays%bounded)
      springs%stiffness = rays%bounded + rays%free
      call set_springs(rays, lift, springs, mass)
      call solve_springs(rays, springs, load, now%a, now%s)
      now%x = -now%s
      now%x = (now%x + max(0.0_wp, -1.5_wp*minval(now%x)) + 0.1_wp*maxval(abs(load)))*rays%bounded
      now%s = (now%s + max(0.0_wp, -1.5_wp*minval(now%s)) + 0.1_wp*maxval(abs(now%a))) &
         & *rays%bounded + (1.0_wp - rays%bounded)
   end subroutine begin

   !> Stiffness of the springs along all rays
   pure subroutine set_stiffness(rays, now, springs)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Forces and rates
      type(fall_t), intent(in) :: now
      !> Receives it
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: mean

      mean = max(1.0_wp, sum(now%x*rays%bounded)/max(sum(now%s*rays%bounded), tiny(mean)))
      springs%stiffness = rays%bounded*now%x/now%s + rays%free*stiffness_of_free*mean
   end subroutine set_stiffness

   !> Mean of products along the rays
   pure real(wp) function mean_product(rays, product) result(mean)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Products: (n_side, n_joint)
      real(wp), intent(in) :: product(:, :)

      mean = sum(product*rays%bounded)/real(max(1, rays%n_bounded), wp)
   end function mean_product

   !> What is left of the balance of forces with the accelerations
   pure function imbalance(rays, load, mass, now) result(left)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Load: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Accelerations and forces
      type(fall_t), intent(in) :: now
      !> The rest: (3, 0:n_block)
      real(wp) :: left(3, 0:rays%n_block)

      left = load - mass*now%a
      call add_ray_forces(rays, now%x, left)
   end function imbalance

   !> What accelerations and forces leave of the equations and of their products, relative
   pure real(wp) function what_is_left(rays, load, mass, now) result(left)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Load: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Accelerations and forces
      type(fall_t), intent(in) :: now
      real(wp) :: rate(n_side, size(now%s, 2))

      call ray_rates(rays, now%a, rate)
      left = max(maxval(abs(imbalance(rays, load, mass, now)))/maxval(abs(load)), &
         & maxval(abs(rate - now%s)*rays%bounded + abs(rate)*rays%free) &
         & /max(maxval(abs(now%a)), tiny(left)), &
         & sum(now%x*now%s*rays%bounded)/max(abs(sum(load*now%a)), tiny(left)))
   end function what_is_left

   !> The step to balance and compatible rates, corrected until the balance no longer gains
   pure subroutine find_step(rays, springs, load, mass, now, step)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> The matrix, factored
      type(ray_matrix_t), intent(inout) :: springs
      !> Load: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Where it begins
      type(fall_t), intent(in) :: now
      !> Change of forces at unchanged rates in, the step out
      type(fall_t), intent(inout) :: step
      integer, parameter :: max_correction = 3
      real(wp) :: a(3, 0:rays%n_block), rate(n_side, size(now%s, 2))
      real(wp) :: rest(3, 0:rays%n_block), left(3, 0:rays%n_block), last
      integer :: turn

      call ray_rates(rays, now%a, rate)
      step%s = rate - now%s*rays%bounded
      step%x = step%x - springs%stiffness*step%s
      step%a = 0.0_wp
      left = imbalance(rays, load, mass, now)
      last = huge(last)
      do turn = 0, max_correction
         rest = left - mass*step%a
         call add_ray_forces(rays, step%x, rest)
         if (.not. maxval(abs(rest)) < 0.5_wp*last) exit
         last = maxval(abs(rest))
         call solve_springs(rays, springs, rest, a, rate)
         step%a = step%a + a
         step%s = step%s + rate
         step%x = step%x - springs%stiffness*rate
      end do
   end subroutine find_step

   !> Longest step, at most 1, that keeps forces and rates inside their bounds
   pure real(wp) function reach(rays, now, step)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Where it begins
      type(fall_t), intent(in) :: now
      !> The step
      type(fall_t), intent(in) :: step
      integer :: i, j

      reach = 1.0_wp
      do j = 1, size(now%x, 2)
         do i = 1, n_side
            if (.not. rays%bounded(i, j) > 0.0_wp) cycle
            if (now%x(i, j) + reach*step%x(i, j) < 0.0_wp) reach = -now%x(i, j)/step%x(i, j)
            if (now%s(i, j) + reach*step%s(i, j) < 0.0_wp) reach = -now%s(i, j)/step%s(i, j)
         end do
      end do
   end function reach

   !> Go along a step
   pure subroutine move(share, step, now)
      !> Share of it
      real(wp), intent(in) :: share
      !> The step
      type(fall_t), intent(in) :: step
      !> What moves
      type(fall_t), intent(inout) :: now

      now%a = now%a + share*step%a
      now%x = now%x + share*step%x
      now%s = now%s + share*step%s
   end subroutine move
end module dda_first_motion
