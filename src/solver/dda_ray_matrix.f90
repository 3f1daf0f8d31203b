!> The stiffness matrix of springs along the rays of all joints, and systems solved with it
!>
!>    matrix = sum over rays of stiffness * arm * arm'
!>
!> is the matrix of a DDA step whose joints have these springs. Stiffness may spread over more
!> decades than working precision has: then there are factors with more digits.
!>
!> Equation (M6) of docs/method.md
module dda_ray_matrix
   use dda_block_factor, only : block_factor_t, factorise, plan_factor, substitute
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_extended_factor, only : extended_factor_t, factorise_extended, substitute_extended
   use dda_joint_rays, only : joint_rays_t, n_side, ray_rates
   use dda_kinds, only : wp
   use dda_wide_factor, only : factorise_wide, substitute_wide, wide_factor_t
   implicit none
   private

   public :: digits_of, digits_enum, ray_matrix_t
   public :: add_digits, plan_matrix, set_springs, solve_springs

   !> The numbers of a factor
   type :: digits_enum
      integer :: working = 0   !! In working precision
      integer :: extended = 1  !! With some more digits
      integer :: wide = 2      !! With twice the digits
   end type digits_enum

   !> Names of these numbers
   type(digits_enum), parameter :: digits_of = digits_enum()

   !> The matrix, its factor, and what work on them needs
   type :: ray_matrix_t
      !> The matrix
      type(block_matrix_t) :: matrix
      !> Its factor
      type(block_factor_t) :: factor
      !> Factors with more digits
      type(extended_factor_t) :: extended
      type(wide_factor_t) :: wide
      !> The one that is used, one of digits_of
      integer :: digits = digits_of%working
      !> Whether one can be used
      logical :: usable = .false.
      !> Entry of the matrix that each joint couples, 0 for none: (n_joint)
      integer, allocatable :: entry(:)
      !> Whether the second block of a joint has the rows of its entry: (n_joint)
      logical, allocatable :: second_is_row(:)
      !> Stiffness of each ray: (n_side, n_joint)
      real(wp), allocatable :: stiffness(:, :)
      !> Factorisations so far
      integer :: n_factorisation = 0
      !> Substitutions so far
      integer :: n_substitution = 0
   end type ray_matrix_t

contains

   !> Pattern of the matrix and of its factor
   pure subroutine plan_matrix(rays, springs)
      type(joint_rays_t), intent(in) :: rays
      type(ray_matrix_t), intent(out) :: springs  !! The matrix, without numbers
      integer :: j, n, pair(2, size(rays%block, 2))

      allocate (springs%entry(size(rays%block, 2)), springs%second_is_row(size(rays%block, 2)))
      springs%entry = 0
      n = 0
      do j = 1, size(springs%entry)
         if (any(rays%block(:, j) == 0)) cycle
         n = n + 1
         springs%entry(j) = n
         pair(:, n) = rays%block(:, j)
      end do
      call set_pattern(springs%matrix, 3, rays%n_block, pair(:, :n))
      call plan_factor(springs%matrix, springs%factor)
      do j = 1, size(springs%entry)
         springs%second_is_row(j) = .false.
         if (springs%entry(j) == 0) cycle
         springs%second_is_row(j) = springs%matrix%pair(1, springs%entry(j)) == rays%block(2, j)
      end do
      allocate (springs%stiffness(n_side, size(rays%block, 2)))
   end subroutine plan_matrix

   !> Assemble springs and masses, and factor their matrix
   pure subroutine set_springs(rays, mass, lift, springs)
      type(joint_rays_t), intent(in) :: rays
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Share of itself that each diagonal entry is raised by; what no spring holds gets as much of
      !> the block's largest, or one
      real(wp), intent(in) :: lift
      !> The matrix with its stiffness; its factor may be unusable
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: largest
      integer :: b, k

      call assemble(rays, springs)
      do b = 1, rays%n_block
         largest = maxval([(springs%matrix%diagonal(k, k, b) + mass(k, b), k=1, 3)])
         if (.not. largest > 0.0_wp) largest = 1.0_wp/lift
         do k = 1, 3
            associate (d => springs%matrix%diagonal(k, k, b))
               d = d + mass(k, b)
               d = merge(d*(1.0_wp + lift), lift*largest, d > 0.0_wp)
            end associate
         end do
      end do
      springs%digits = digits_of%working
      call factorise(springs%matrix, springs%factor)
      springs%usable = springs%factor%usable
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine set_springs

   !> Assemble and factor the same springs and masses with more digits; the factor before stays in
   !> use where this one cannot be
   pure subroutine add_digits(rays, mass, digits, springs)
      type(joint_rays_t), intent(in) :: rays
      real(wp), intent(in) :: mass(:, 0:)
      integer, intent(in) :: digits  !! One of digits_of
      type(ray_matrix_t), intent(inout) :: springs
      logical :: usable

      associate (plan => springs%factor%plan)
         if (digits == digits_of%extended) then
            call factorise_extended(rays, springs%stiffness, mass, springs%matrix, springs%entry, &
               & plan, springs%extended%panels)
            usable = springs%extended%panels%usable
         else
            call factorise_wide(rays, springs%stiffness, mass, springs%matrix, springs%entry, &
               & plan, springs%wide%panels)
            usable = springs%wide%panels%usable
         end if
      end associate
      if (usable) springs%digits = digits
      springs%usable = springs%usable .or. usable
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine add_digits

   !> Sum of all springs
   pure subroutine assemble(rays, springs)
      type(joint_rays_t), intent(in) :: rays
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: pushed(n_side, 6)
      integer :: a, b, j, k

      springs%matrix%diagonal = 0.0_wp
      do j = 1, size(rays%block, 2)
         a = rays%block(1, j)
         b = rays%block(2, j)
         do k = 1, 6
            pushed(:, k) = springs%stiffness(:, j)*rays%arm(:, k, j)
         end do
         if (a /= 0) call add_product(pushed(1, 1), rays%arm(1, 1, j), &
            & springs%matrix%diagonal(1, 1, a))
         if (b /= 0) call add_product(pushed(1, 4), rays%arm(1, 4, j), &
            & springs%matrix%diagonal(1, 1, b))
         if (springs%entry(j) == 0) cycle
         associate (e => springs%entry(j))
            springs%matrix%coupling(:, :, e) = 0.0_wp
            if (springs%second_is_row(j)) then
               call add_product(pushed(1, 4), rays%arm(1, 1, j), springs%matrix%coupling(1, 1, e))
            else
               call add_product(pushed(1, 1), rays%arm(1, 4, j), springs%matrix%coupling(1, 1, e))
            end if
         end associate
      end do
   end subroutine assemble

   !> sum = sum + a' b
   pure subroutine add_product(a, b, sum)
      real(wp), intent(in) :: a(n_side, 3)  !! First factor, transposed
      real(wp), intent(in) :: b(n_side, 3)  !! Second factor
      real(wp), intent(inout) :: sum(3, 3)  !! What it is added to
      integer :: c, r

      do c = 1, 3
         do r = 1, 3
            sum(r, c) = sum(r, c) + (a(1, r)*b(1, c) + a(2, r)*b(2, c) &
               & + a(3, r)*b(3, c) + a(4, r)*b(4, c))
         end do
      end do
   end subroutine add_product

   !> Motion of the blocks by loads
   pure subroutine solve_springs(rays, springs, load, motion, rate)
      type(joint_rays_t), intent(in) :: rays
      type(ray_matrix_t), intent(inout) :: springs
      !> Loads: (3, 0:n_block)
      real(wp), intent(in) :: load(:, 0:)
      !> Motion, none of what cannot move: (3, 0:n_block)
      real(wp), intent(out) :: motion(:, 0:)
      !> Rates at which it opens the rays: (n_side, n_joint)
      real(wp), intent(out), contiguous :: rate(:, :)

      motion = load
      motion(:, 0) = 0.0_wp
      springs%n_substitution = springs%n_substitution + 1
      select case (springs%digits)
      case (digits_of%working)
         call substitute(springs%factor, motion(:, 1:))
         call ray_rates(rays, motion, rate)
      case (digits_of%extended)
         call substitute_extended(rays, springs%factor%plan, springs%extended%panels, &
            & motion(:, 1:), rate)
      case default
         call substitute_wide(rays, springs%factor%plan, springs%wide%panels, motion(:, 1:), rate)
      end select
   end subroutine solve_springs
end module dda_ray_matrix
