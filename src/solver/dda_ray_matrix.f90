!> The barrier stiffness matrix along the rays of all joints, and its solutions
!>
!>    matrix = sum over rays of stiffness * arm * arm'
!>
!> is the matrix of a DDA step whose joints have these springs. Stiffness may spread over more
!> decades than working precision has: then there is a factor with more digits.
!>
!> Equation (M6) of docs/method.md
module dda_ray_matrix
   use dda_block_factor, only : block_factor_t, factorise, substitute
   use dda_block_matrix, only : block_matrix_t
   use dda_joint_graph, only : joint_graph_t, joint_kind, unit_of_length
   use dda_joint_matrix, only : lay_out_joints
   use dda_joint_rays, only : joint_rays, joint_spring, n_side, ray_rates, &
      & scaled_rows
   use dda_joint_strips, only : joint_strip_t, list_strips, part_opening, soften_spring
   use dda_kinds, only : wp
   use dda_wide_factor, only : factorise_wide, rk, substitute_wide
   implicit none
   private

   public :: ray_matrix_t, add_digits, plan_matrix, set_springs, solve_springs

   !> The matrix, its factor, and what work on them needs
   type :: ray_matrix_t
      type(block_matrix_t) :: matrix
      type(block_factor_t) :: factor
      !> Numbers of the factor with more digits
      real(rk), allocatable :: wide(:)
      !> True if that one is used, and if it was asked for
      logical :: is_wide = .false., asked_wide = .false.
      !> True if the factor exists
      logical :: usable = .false.
      !> Unit of length: [m]
      real(wp) :: length = 1.0_wp
      !> Number of each joint's coupling, negative where its second block has the rows: (n_joint)
      integer, allocatable :: entry(:)
      !> Stiffness of each ray: (n_side, n_joint)
      real(wp), allocatable :: stiffness(:, :)
      !> Joints that crush: (n)
      type(joint_strip_t), allocatable :: strip(:)
      !> Number of each joint among these, or 0: (n_joint)
      integer, allocatable :: crushed(:)
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
      integer :: i

      springs%length = unit_of_length(graph)
      call lay_out_joints(graph%block, 3, graph%n_block, .true., springs%matrix, springs%factor, &
         & springs%entry)
      allocate (springs%stiffness(n_side, size(graph%block, 2)))
      call list_strips(graph, springs%strip)
      allocate (springs%crushed(size(graph%kind)), source=0)
      springs%crushed(springs%strip%joint) = [(i, i=1, size(springs%strip))]
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
      do b = 1, graph%n_block
         associate (own => springs%matrix%diagonal(:, :, b))
            largest = maxval([(own(k, k) + mass(k, b), k=1, 3)])
            if (.not. largest > 0.0_wp) largest = 1.0_wp/lift
            do k = 1, 3
               own(k, k) = own(k, k) + mass(k, b)
               own(k, k) = merge(own(k, k)*(1.0_wp + lift), lift*largest, own(k, k) > 0.0_wp)
            end do
         end associate
      end do
      springs%is_wide = .false.
      springs%asked_wide = .false.
      call factorise(springs%matrix, springs%factor)
      springs%usable = springs%factor%usable
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine set_springs

   !> Assemble and factor the same springs and masses with more digits; the factor before stays in
   !> use where this one cannot be
   pure subroutine add_digits(graph, mass, springs)
      type(joint_graph_t), intent(in) :: graph
      real(wp), intent(in) :: mass(:, 0:)
      type(ray_matrix_t), intent(inout) :: springs
      real(rk) :: diagonal(3, 3, graph%n_block), coupling(3, 3, size(springs%matrix%pair, 2))
      real(rk) :: arm(3, 3, 2), pushed(3, 3, 2), spring(3, 3)
      integer :: b, c, j, side

      diagonal = 0.0_rk
      do b = 1, graph%n_block
         do c = 1, 3
            diagonal(c, c, b) = mass(c, b)
         end do
      end do
      do j = 1, size(graph%block, 2)
         arm = scaled_rows(graph, j, springs%length)
         if (springs%crushed(j) > 0) then
            associate (strip => springs%strip(springs%crushed(j)))
               spring = sum_of_springs(strip%stiffness, strip%wide_row)
            end associate
         else
            spring = sum_of_springs(springs%stiffness(:, j), &
               & real(joint_rays(graph%kind(j), graph%friction(j)), rk))
         end if
         do side = 1, 2
            pushed(:, :, side) = matmul(arm(:, :, side), spring)
            b = graph%block(side, j)
            if (b > 0) diagonal(:, :, b) = diagonal(:, :, b) &
               & + matmul(pushed(:, :, side), transpose(arm(:, :, side)))
         end do
         if (springs%entry(j) == 0) cycle
         side = merge(1, 2, springs%entry(j) > 0)
         coupling(:, :, abs(springs%entry(j))) = &
            & matmul(pushed(:, :, side), transpose(arm(:, :, 3 - side)))
      end do
      call factorise_wide(springs%factor%plan, diagonal, coupling, springs%wide, springs%is_wide)
      springs%asked_wide = .true.
      springs%usable = springs%usable .or. springs%is_wide
      springs%n_factorisation = springs%n_factorisation + 1
   end subroutine add_digits

   !> Sum of the springs of a joint
   pure function sum_of_springs(stiffness, ray) result(spring)
      real(wp), intent(in) :: stiffness(:)  !! Stiffness of each
      real(rk), intent(in) :: ray(:, :)     !! Rows of each: (3, n)
      real(rk) :: spring(3, 3)
      integer :: c, i

      spring = 0.0_rk
      do i = 1, size(stiffness)
         do c = 1, 3
            spring(:, c) = spring(:, c) + stiffness(i)*(ray(:, i)*ray(c, i))
         end do
      end do
   end function sum_of_springs

   !> Sum of all springs
   pure subroutine assemble(graph, springs)
      type(joint_graph_t), intent(in) :: graph
      type(ray_matrix_t), intent(inout) :: springs
      real(wp) :: pushed(3, 3, 2), row(3, 3, 2), spring(3, 3)
      integer :: c, j, side

      do j = 1, size(springs%strip)
         call soften_spring(springs%stiffness, springs%strip(j))
      end do
      springs%matrix%diagonal = 0.0_wp
      do j = 1, size(graph%block, 2)
         row = scaled_rows(graph, j, springs%length)
         spring = joint_spring(graph%kind(j), graph%friction(j), springs%stiffness(:, j))
         if (springs%crushed(j) > 0) then
            associate (strip => springs%strip(springs%crushed(j)))
               spring = matmul(strip%row*spread(strip%stiffness, 1, 3), transpose(strip%row))
            end associate
         end if
         do side = 1, 2
            if (graph%block(side, j) == 0) cycle
            do c = 1, 3
               pushed(:, c, side) = row(:, 1, side)*spring(1, c) + row(:, 2, side)*spring(2, c) &
                  & + row(:, 3, side)*spring(3, c)
            end do
            call add_lower(pushed(:, :, side), row(:, :, side), &
               & springs%matrix%diagonal(:, :, graph%block(side, j)))
         end do
         if (springs%entry(j) == 0) cycle
         side = merge(1, 2, springs%entry(j) > 0)
         associate (coupling => springs%matrix%coupling(:, :, abs(springs%entry(j))), &
            & push => pushed(:, :, side), other => row(:, :, 3 - side))
            do c = 1, 3
               coupling(:, c) = push(:, 1)*other(c, 1) + push(:, 2)*other(c, 2) &
                  & + push(:, 3)*other(c, 3)
            end do
         end associate
      end do
   end subroutine assemble

   !> sum = sum + a b', the lower triangle alone, the only part used of a diagonal block
   pure subroutine add_lower(a, b, sum)
      real(wp), intent(in) :: a(3, 3)       !! First factor
      real(wp), intent(in) :: b(3, 3)       !! Second factor, transposed
      real(wp), intent(inout) :: sum(3, 3)  !! The sum

      sum(:, 1) = sum(:, 1) + (a(:, 1)*b(1, 1) + a(:, 2)*b(1, 2) + a(:, 3)*b(1, 3))
      sum(2:, 2) = sum(2:, 2) + (a(2:, 1)*b(2, 1) + a(2:, 2)*b(2, 2) + a(2:, 3)*b(2, 3))
      sum(3, 3) = sum(3, 3) + (a(3, 1)*b(3, 1) + a(3, 2)*b(3, 2) + a(3, 3)*b(3, 3))
   end subroutine add_lower

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
      real(wp) :: opening(3), row(3, 3, 2)
      integer :: i

      motion = load
      motion(:, 0) = 0.0_wp
      springs%n_substitution = springs%n_substitution + 1
      if (springs%is_wide) then
         call solve_wide(graph, springs, motion, rate)
      else
         call substitute(springs%factor, motion(:, 1:))
         call ray_rates(graph, springs%length, motion, rate)
         do i = 1, size(springs%strip)
            associate (strip => springs%strip(i))
               row = scaled_rows(graph, strip%joint, springs%length)
               opening = matmul(motion(:, graph%block(1, strip%joint)), row(:, :, 1)) &
                  & + matmul(motion(:, graph%block(2, strip%joint)), row(:, :, 2))
               call part_opening(strip, matmul(opening, strip%row), rate)
            end associate
         end do
      end if
   end subroutine solve_springs

   !> The same with more digits: rates may be small differences of large motions
   pure subroutine solve_wide(graph, springs, motion, rate)
      type(joint_graph_t), intent(in) :: graph
      type(ray_matrix_t), intent(in) :: springs
      real(wp), intent(inout) :: motion(3, 0:graph%n_block)  !! Loads in, motion out
      real(wp), intent(out), contiguous :: rate(:, :)
      real(rk) :: x(3, 0:graph%n_block), arm(3, 3, 2), opening(3)
      integer :: j

      x = motion
      call substitute_wide(springs%factor%plan, springs%wide, x(:, 1:))
      motion = real(x, wp)
      rate = 0.0_wp
      do j = 1, size(rate, 2)
         if (graph%kind(j) == joint_kind%strip) exit
         arm = scaled_rows(graph, j, springs%length)
         opening = matmul(x(:, graph%block(1, j)), arm(:, :, 1)) &
            & + matmul(x(:, graph%block(2, j)), arm(:, :, 2))
         if (springs%crushed(j) > 0) then
            associate (strip => springs%strip(springs%crushed(j)))
               call part_opening(strip, real(matmul(opening, strip%wide_row), wp), rate)
            end associate
         else
            rate(:, j) = real(matmul(opening, &
               & real(joint_rays(graph%kind(j), graph%friction(j)), rk)), wp)
         end if
      end do
   end subroutine solve_wide
end module dda_ray_matrix
