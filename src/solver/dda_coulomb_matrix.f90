!> The matrix A S A' + damping*mass of joints with any stiffness S, and its factor
module dda_coulomb_matrix
   use dda_block_factor, only : block_factor_t, factorise_in_place, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_block_plan, only : list_places
   use dda_coulomb_joints, only : coulomb_joints_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: coulomb_matrix_t, add_stiffness, begin_matrix, factor_matrix, new_matrix

   !> The factor, in whose place the matrix is assembled
   type :: coulomb_matrix_t
      !> The factor
      type(block_factor_t) :: factor
      !> First number of the diagonal block of each block: (n_block)
      integer, allocatable :: diagonal(:)
      !> First number of what each joint couples, negative where its second block has the rows, 0
      !> for one that couples nothing: (n_joint)
      integer, allocatable :: coupling(:)
      !> Number of factorisations so far
      integer :: n_factorisation = 0
   end type coulomb_matrix_t

contains

   !> Pattern of the matrix
   pure subroutine new_matrix(joints, matrix)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_matrix_t), intent(out) :: matrix
      type(block_matrix_t) :: pattern
      logical :: couples(size(joints%shear_role))
      integer, allocatable :: first(:), pair(:, :), place(:)

      associate (graph => joints%graph)
         couples = all(graph%block /= 0, 1) .and. graph%block(1, :) /= graph%block(2, :)
         pair = reshape(pack(graph%block, spread(couples, 1, 2)), [2, count(couples)])
         first = pair(1, :)
         call set_pattern(pattern, graph%n_dof, graph%n_block, pair, symmetric=.false.)
         deallocate (pair, pattern%diagonal, pattern%coupling, pattern%upper)
         call plan_factor(pattern, matrix%factor)
         allocate (matrix%diagonal(graph%n_block), place(count(couples)))
      end associate
      call list_places(matrix%factor%plan, matrix%diagonal, place)
      ! a place is negative where the first of a pair is eliminated first
      where (pattern%pair(1, :) /= first) place = -place
      matrix%coupling = unpack(place, couples, spread(0, 1, size(couples)))
   end subroutine new_matrix

   !> Begin to add up the matrix, with a multiple of the mass
   pure subroutine begin_matrix(matrix, joints, damping)
      type(coulomb_matrix_t), intent(inout) :: matrix
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in) :: damping  !! The multiple
      integer :: b

      associate (lower => matrix%factor%panels%lower)
         lower = 0.0_wp
         matrix%factor%panels%upper = 0.0_wp
         do b = 1, joints%graph%n_block
            lower(matrix%diagonal(b):matrix%diagonal(b) + 8:4) = damping*joints%graph%mass(:, b)
         end do
      end associate
   end subroutine begin_matrix

   !> Factor what has been added up
   pure subroutine factor_matrix(matrix)
      type(coulomb_matrix_t), intent(inout) :: matrix
      integer :: b

      associate (lower => matrix%factor%panels%lower, upper => matrix%factor%panels%upper)
         do b = 1, size(matrix%diagonal)
            associate (at => matrix%diagonal(b))
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
         & at => abs(matrix%coupling(j)), lower => matrix%factor%panels%lower, &
         & upper => matrix%factor%panels%upper)
         do one = 1, 2
            if (block(one) > 0) call add_product(row(:, :, one), stiffness, row(:, :, one), &
               & lower(matrix%diagonal(block(one))))
         end do
         if (at > 0) then
            one = merge(1, 2, matrix%coupling(j) > 0)
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
                  & lower(matrix%diagonal(block(1))))
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
      real(wp), intent(in) :: left(3, 3)    !! Rows of the block that is pushed: (n_dof, 3)
      real(wp), intent(in) :: middle(3, 3)  !! Stiffness of the joint
      real(wp), intent(in) :: right(3, 3)   !! Rows of the block that moves: (n_dof, 3)
      real(wp), intent(inout) :: sum(3, 3)  !! What is added to: (n_dof, n_dof)
      real(wp) :: force(3)
      integer :: c

      do c = 1, 3
         force = middle(:, 1)*right(c, 1) + middle(:, 2)*right(c, 2) + middle(:, 3)*right(c, 3)
         sum(:, c) = sum(:, c) + left(:, 1)*force(1) + left(:, 2)*force(2) + left(:, 3)*force(3)
      end do
   end subroutine add_product
end module dda_coulomb_matrix
