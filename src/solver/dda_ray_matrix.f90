!> The stiffness matrix of springs along the rays of all joints, and systems solved with it
!>
!>    matrix = sum over rays of stiffness * arm * arm'
!>
!> is the matrix of a DDA step whose joints have these springs. Stiffness may spread over more
!> decades than working precision has: then there are factors with more digits.
!>
!> Equation (M6) of docs/method.md
module dda_ray_matrix
   use dda_block_factor, only : block_factor_t, factorise_in_place, substitute
   use dda_block_plan, only : coupling_places_t, side_of_rows
   use dda_extended_factor, only : extended_factor_t, factorise_extended, substitute_extended
   use dda_joint_graph, only : joint_graph_t, unit_of_length
   use dda_joint_places, only : lay_out_joints
   use dda_joint_rays, only : joint_spring, n_side, ray_rates, scaled_rows
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

   !> The factor, in whose place the matrix is assembled, and what work on them needs
   type :: ray_matrix_t
      !> The factor
      type(block_factor_t) :: factor
      !> Factors with more digits
      type(extended_factor_t) :: extended
      type(wide_factor_t) :: wide
      !> The one that is used, one of digits_of
      integer :: digits = digits_of%working
      !> Whether one can be used
      logical :: usable = .false.
      !> Unit of length: [m]
      real(wp) :: length = 1.0_wp
      !> Where the joints have their numbers in it
      type(coupling_places_t) :: places
      !> Stiffness of each ray: (n_side, n_joint)
      real(wp), allocatable :: stiffness(:, :)
      !> Factorisations so far
      integer :: n_factorisation = 0
      !> Substitutions so far
      integer :: n_substitution = 0
   end type ray_matrix_t

contains

   !> Pattern of the matrix and of its factor
   pure subroutine plan_matrix(graph, springs)
      type(joint_graph_t), intent(in) :: graph
      type(ray_matrix_t), intent(out) :: springs  !! The matrix, without numbers

      springs%length = unit_of_length(graph)
      call lay_out_joints(graph, .true., springs%factor, springs%places)
      allocate (springs%stiffness(n_side, size(graph%block, 2)))
   end subroutine plan_matrix

   !> Assemble springs and masses, and factor their matrix
   pure subroutine set_springs(graph, mass, lift, springs)
      type(joint_graph_t), intent(in) :: graph
      !> Masses: (3, 0:n_block)
      real(wp), intent(in) :: mass(:, 0:)
      !> Share of itself that each diagonal entry is raised by; what no spring holds gets as much of
      !> the block's largest, or one
      real(wp), intent(in) :: lift
      !> The matrix with its stiffness; its factor may be unusable
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: largest
      integer :: b, k

      call assemble(graph, springs)
      associate (number => springs%factor%panels%lower)
         do b = 1, graph%n_block
            associate (own => number(springs%places%diagonal(b):springs%places%diagonal(b) + 8:4))
               largest = maxval(own + mass(:, b))
               if (.not. largest > 0.0_wp) largest = 1.0_wp/lift
               do k = 1, 3
                  own(k) = own(k) + mass(k, b)
                  own(k) = merge(own(k)*(1.0_wp + lift), lift*largest, own(k) > 0.0_wp)
               end do
            end associate
         end do
      end associate
      springs%digits = digits_of%working
      call factorise_in_place(springs%factor)
      springs%usable = springs%factor%usable
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine set_springs

   !> Assemble and factor the same springs and masses with more digits; the factor before stays in
   !> use where this one cannot be
   pure subroutine add_digits(graph, mass, digits, springs)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: mass(:, 0:)
      integer, intent(in) :: digits  !! One of digits_of
      type(ray_matrix_t), intent(inout) :: springs
      logical :: usable

      associate (plan => springs%factor%plan)
         if (digits == digits_of%extended) then
            call factorise_extended(graph, springs%length, springs%stiffness, mass, &
               & springs%places, plan, &
               & springs%extended%panels)
            usable = springs%extended%panels%usable
         else
            call factorise_wide(graph, springs%length, springs%stiffness, mass, &
               & springs%places, plan, &
               & springs%wide%panels)
            usable = springs%wide%panels%usable
         end if
      end associate
      if (usable) springs%digits = digits
      springs%usable = springs%usable .or. usable
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine add_digits

   !> Sum of all springs
   pure subroutine assemble(graph, springs)
      type(joint_graph_t), intent(in) :: graph
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: pushed(3, 3, 2), row(3, 3, 2), spring(3, 3)
      integer :: j, side

      associate (number => springs%factor%panels%lower)
         number = 0.0_wp
         do j = 1, size(graph%block, 2)
            row = scaled_rows(graph, j, springs%length)
            spring = joint_spring(graph%kind(j), graph%friction(j), springs%stiffness(:, j))
            do side = 1, 2
               if (graph%block(side, j) == 0) cycle
               pushed(:, :, side) = matmul(row(:, :, side), spring)
               call add_lower(pushed(:, :, side), row(:, :, side), &
                  & number(springs%places%diagonal(graph%block(side, j))))
            end do
            if (springs%places%coupling(j) == 0) cycle
            side = side_of_rows(springs%places, j)
            call add_product(pushed(:, :, side), row(:, :, 3 - side), &
               & number(abs(springs%places%coupling(j))))
         end do
      end associate
   end subroutine assemble

   !> sum = sum + a b', the lower triangle alone: no more is looked at of a diagonal block
   pure subroutine add_lower(a, b, sum)
      real(wp), intent(in) :: a(3, 3)       !! First factor
      real(wp), intent(in) :: b(3, 3)       !! Second factor, transposed
      real(wp), intent(inout) :: sum(3, 3)  !! What it is added to

      sum(:, 1) = sum(:, 1) + (a(:, 1)*b(1, 1) + a(:, 2)*b(1, 2) + a(:, 3)*b(1, 3))
      sum(2:, 2) = sum(2:, 2) + (a(2:, 1)*b(2, 1) + a(2:, 2)*b(2, 2) + a(2:, 3)*b(2, 3))
      sum(3, 3) = sum(3, 3) + (a(3, 1)*b(3, 1) + a(3, 2)*b(3, 2) + a(3, 3)*b(3, 3))
   end subroutine add_lower

   !> sum = sum + a b'
   pure subroutine add_product(a, b, sum)
      real(wp), intent(in) :: a(3, 3)       !! First factor
      real(wp), intent(in) :: b(3, 3)       !! Second factor, transposed
      real(wp), intent(inout) :: sum(3, 3)  !! What it is added to
      integer :: c

      do c = 1, 3
         sum(:, c) = sum(:, c) + (a(:, 1)*b(c, 1) + a(:, 2)*b(c, 2) + a(:, 3)*b(c, 3))
      end do
   end subroutine add_product

   !> Motion of the blocks by loads
   pure subroutine solve_springs(graph, springs, load, motion, rate)
      type(joint_graph_t), intent(in) :: graph
      type(ray_matrix_t), intent(inout) :: springs
      !> Loads: (3, 0:n_block)
      real(wp), intent(in) :: load(3, 0:graph%n_block)
      !> Motion, none of what cannot move: (3, 0:n_block)
      real(wp), intent(out) :: motion(3, 0:graph%n_block)
      !> Rates at which it opens the rays: (n_side, n_joint)
      real(wp), intent(out), contiguous :: rate(:, :)

      motion = load
      motion(:, 0) = 0.0_wp
      springs%n_substitution = springs%n_substitution + 1
      select case (springs%digits)
      case (digits_of%working)
         call substitute(springs%factor, motion(:, 1:))
         call ray_rates(graph, springs%length, motion, rate)
      case (digits_of%extended)
         call substitute_extended(graph, springs%length, springs%factor%plan, &
            & springs%extended%panels, motion(:, 1:), rate)
      case default
         call substitute_wide(graph, springs%length, springs%factor%plan, springs%wide%panels, &
            & motion(:, 1:), rate)
      end select
   end subroutine solve_springs
end module dda_ray_matrix
