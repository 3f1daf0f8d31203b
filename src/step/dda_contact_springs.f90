!> Springs in place of contact forces: the matrix of a group and its solutions. A factor hands a
!> force on through all blocks at once
!>
!>    f = f0 - S R' d,   A d = load + R f:   (A + R S R') d = load + R f0
module dda_contact_springs
   use dda_block_factor, only : block_factor_t, factorise, plan_factor, substitute
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_contact_problem, only : contact_problem_t
   use dda_kinds, only : wp
   use dda_spring_products, only : add_forces, add_product, relative_displacement
   implicit none
   private

   public :: contact_springs_t, factor_springs, lay_out, respond

   !> Matrix and factor
   type :: contact_springs_t
      !> Coupling of each joint in the matrix, or 0: (n_joint)
      integer, allocatable :: entry(:)
      !> Forces taken by openings and slip: (3, 3, n_joint) [N/m per m]
      real(wp), allocatable :: stiff(:, :, :)
      type(block_matrix_t) :: matrix
      type(block_factor_t) :: factor
   end type contact_springs_t

contains

   !> Pattern of matrix and factor, not symmetric: what slides takes its shear force from its
   !> normal forces
   pure subroutine lay_out(p, springs)
      type(contact_problem_t), intent(in) :: p
      type(contact_springs_t), intent(out) :: springs
      integer :: i, k, pair(2, size(p%joint))

      allocate (springs%entry(size(p%joint)), source=0)
      allocate (springs%stiff(3, 3, size(p%joint)), source=0.0_wp)
      k = 0
      do i = 1, size(p%joint)
         if (any(p%springs%equation(:, i) == 0)) cycle
         k = k + 1
         springs%entry(i) = k
         pair(:, k) = p%springs%equation(:, i)
      end do
      call set_pattern(springs%matrix, size(p%load, 1), size(p%equation), pair(:, :k), &
         & symmetric=.false.)
      call plan_factor(springs%matrix, springs%factor)
   end subroutine lay_out

   !> Make the factor of the springs as they are
   pure subroutine factor_springs(p, springs)
      type(contact_problem_t), intent(in) :: p
      type(contact_springs_t), intent(inout) :: springs  !! The springs; matrix and factor are set
      real(wp) :: steep(size(p%load, 1), 3)
      integer :: b, first, i, side

      associate (m => springs%matrix)
         m%diagonal = p%base
         m%coupling = 0.0_wp
         m%upper = 0.0_wp
         do i = 1, size(p%joint)
            associate (e => springs%entry(i), block => p%springs%equation(:, i), &
               & row => p%springs%row(:, :, :, i))
               do side = 1, 2
                  b = block(side)
                  if (b == 0) cycle
                  steep = matmul(row(:, :, side), springs%stiff(:, :, i))
                  call add_product(steep, row(:, :, side), m%diagonal(:, :, b))
                  if (e == 0) cycle
                  first = merge(1, 2, m%pair(1, e) == block(1))
                  if (side == first) then
                     call add_product(steep, row(:, :, 3 - side), m%coupling(:, :, e))
                  else
                     call add_product(steep, row(:, :, 3 - side), m%upper(:, :, e))
                  end if
               end do
            end associate
         end do
         call factorise(m, springs%factor)
      end associate
   end subroutine factor_springs

   !> Motion by what is lacking of the balance and by forces, and what the joints see of it
   pure subroutine respond(p, springs, balance, force, motion, opening)
      type(contact_problem_t), intent(in) :: p
      type(contact_springs_t), intent(in) :: springs
      real(wp), intent(in) :: balance(:, :)  !! What is lacking: (n_dof, n_block) [N/m]
      real(wp), intent(in) :: force(:, :)    !! The forces: (3, n_joint) [N/m]
      real(wp), intent(out) :: motion(:, :)  !! The motion: (n_dof, n_block) [m]
      real(wp), intent(out) :: opening(:, :) !! Openings and slips by it: (3, n_joint) [m]

      motion = balance
      call add_forces(p%springs, force, motion)
      call substitute(springs%factor, motion)
      opening = relative_displacement(p%springs, motion)
   end subroutine respond

end module dda_contact_springs
