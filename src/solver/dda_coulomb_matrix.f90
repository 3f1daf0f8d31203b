!> The matrix A S A' + damping*mass of joints with any stiffness S, and its factor
module dda_coulomb_matrix
   use dda_block_factor, only : block_factor_t, factorise_in_place
   use dda_block_plan, only : coupling_places_t, side_of_rows
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: coulomb_matrix_t, add_stiffness, begin_matrix, factor_matrix

   !> The factor, in whose place the matrix is assembled
   type :: coulomb_matrix_t
      !> The factor
      type(block_factor_t) :: factor
      !> Where the joints have their numbers in it
      type(coupling_places_t) :: places
      !> Number of factorisations so far
      integer :: n_factorisation = 0
   end type coulomb_matrix_t

contains

   !> Begin to add up the matrix, with a multiple of the mass
   pure subroutine begin_matrix(matrix, joints, damping)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: damping  !! The multiple
      integer :: b

      associate (lower => matrix%factor%panels%lower, at => matrix%places%diagonal)
         lower = 0.0_wp
         matrix%factor%panels%upper = 0.0_wp
         do b = 1, joints%graph%n_block
            lower(at(b):at(b) + 8:4) = damping*joints%graph%mass(:, b)
         end do
      end associate
   end subroutine begin_matrix

   !> Factor what has been added up
   pure subroutine factor_matrix(matrix)
      type(coulomb_matrix_t), intent(inout) :: matrix
      integer :: b

      associate (lower => matrix%factor%panels%lower, upper => matrix%factor%panels%upper)
         do b = 1, size(matrix%places%diagonal)
            associate (at => matrix%places%diagonal(b))
               upper(at:at + 8) = lower([at, at + 3, at + 6, at + 1, at + 4, at + 7, at + 2, &
                  & at + 5, at + 8])
            end associate
         end do
      end associate
      call factorise_in_place(matrix%factor)
      matrix%n_factorisation = matrix%n_factorisation + 1
   end subroutine factor_matrix

   !> Add the stiffness of a joint to the matrix; above the diagonal to its transpose
   pure subroutine add_stiffness(matrix, joints, j, stiffness)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j                 !! Number of the joint
      real(wp), intent(in) :: stiffness(3, 3)  !! Rows N1, N2, T; columns opening 1, opening 2, slip
      real(wp) :: product(3, 3)
      integer :: one, other

      associate (block => joints%graph%block(:, j), row => joints%graph%row(:, :, :, j), &
         & at => abs(matrix%places%coupling(j)), lower => matrix%factor%panels%lower, &
         & upper => matrix%factor%panels%upper)
         do one = 1, 2
            if (block(one) > 0) call add_product(row(:, :, one), stiffness, row(:, :, one), &
               & lower(matrix%places%diagonal(block(one))))
         end do
         if (at > 0) then
            one = side_of_rows(matrix%places, j)
            other = 3 - one
            product = 0.0_wp
            call add_product(row(:, :, one), stiffness, row(:, :, other), product)
            call add_block(product, lower(at))
            product = 0.0_wp
            call add_product(row(:, :, other), stiffness, row(:, :, one), product)
            call add_block(transpose(product), upper(at))
         else if (block(1) == block(2)) then
            do one = 1, 2
               call add_product(row(:, :, one), stiffness, row(:, :, 3 - one), &
                  & lower(matrix%places%diagonal(block(1))))
            end do
         end if
      end associate
   end subroutine add_stiffness

   !> sum = sum + block
   pure subroutine add_block(block, sum)
      real(wp), intent(in) :: block(3, 3)   !! What is added
      real(wp), intent(inout) :: sum(3, 3)  !! What it is added to

      sum = sum + block
   end subroutine add_block

   !> sum = sum + left*middle*right'
   pure subroutine add_product(left, middle, right, sum)
      real(wp), intent(in) :: left(3, 3)    !! Rows of the block that is pushed
      real(wp), intent(in) :: middle(3, 3)  !! Stiffness of the joint
      real(wp), intent(in) :: right(3, 3)   !! Rows of the block that moves
      real(wp), intent(inout) :: sum(3, 3)  !! What is added to
      real(wp) :: force(3)
      integer :: c

      do c = 1, 3
         force = middle(:, 1)*right(c, 1) + middle(:, 2)*right(c, 2) + middle(:, 3)*right(c, 3)
         sum(:, c) = sum(:, c) + left(:, 1)*force(1) + left(:, 2)*force(2) + left(:, 3)*force(3)
      end do
   end subroutine add_product
end module dda_coulomb_matrix
