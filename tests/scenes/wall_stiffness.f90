!> Stiffness matrices of walls
module wall_stiffness
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: product_of, set_stiffness

contains

   !> Stiffness of the joints' springs, some far stiffer than others, and some that slide with
   !> friction where the matrix is not symmetric. Unknowns beyond the third are coupled by rows
   !> without meaning, so that all blocks of the matrix are full
   subroutine set_stiffness(graph, n_dof, symmetric, matrix)
      type(joint_graph_t), intent(in) :: graph     !! The joints
      integer, intent(in) :: n_dof                 !! Unknowns of a block, at least 3
      logical, intent(in) :: symmetric             !! True if the matrix is
      type(block_matrix_t), intent(out) :: matrix
      integer :: c, e, j
      real(wp) :: spring(3, 3), a(n_dof, 3), b(n_dof, 3)

      call set_pattern(matrix, n_dof, graph%n_block, &
         & graph%block(:, pack([(j, j=1, size(graph%block, 2))], all(graph%block > 0, dim=1))), &
         & symmetric)
      matrix%diagonal = 0.0_wp
      matrix%coupling = 0.0_wp
      matrix%upper = 0.0_wp
      do c = 1, n_dof
         matrix%diagonal(c, c, :) = merge(1.0e-3_wp, 1.0_wp, c <= 3)
      end do
      e = 0
      do j = 1, size(graph%block, 2)
         spring = 0.0_wp
         do c = 1, 3
            spring(c, c) = 10.0_wp**modulo(7*j + 3*c, 5)
         end do
         if (.not. symmetric .and. modulo(j, 3) == 0) then
            spring(3, 1) = 0.6_wp*spring(1, 1)
            spring(3, 2) = 0.6_wp*spring(2, 2)
         end if
         a = rows_of(graph%row(:, :, 1, j), n_dof, j)
         b = rows_of(graph%row(:, :, 2, j), n_dof, -j)
         associate (p => graph%block(1, j), q => graph%block(2, j))
            if (p > 0) matrix%diagonal(:, :, p) = matrix%diagonal(:, :, p) &
               & + matmul(a, matmul(spring, transpose(a)))
            if (q > 0) matrix%diagonal(:, :, q) = matrix%diagonal(:, :, q) &
               & + matmul(b, matmul(spring, transpose(b)))
            if (p == 0 .or. q == 0) cycle
            e = e + 1
            if (matrix%pair(1, e) == q) then
               matrix%coupling(:, :, e) = matmul(b, matmul(spring, transpose(a)))
               if (.not. symmetric) matrix%upper(:, :, e) = matmul(a, matmul(spring, transpose(b)))
            else
               matrix%coupling(:, :, e) = matmul(a, matmul(spring, transpose(b)))
               if (.not. symmetric) matrix%upper(:, :, e) = matmul(b, matmul(spring, transpose(a)))
            end if
         end associate
      end do
   end subroutine set_stiffness

   !> Rows of a joint in the equations of a block
   pure function rows_of(row, n_dof, seed) result(rows)
      real(wp), intent(in) :: row(:, :)  !! Those of its three motions: (3, 3)
      integer, intent(in) :: n_dof
      integer, intent(in) :: seed        !! Number that makes the others differ
      real(wp) :: rows(n_dof, 3)         !! All rows: (n_dof, 3)
      integer :: c, k

      rows(:3, :) = row
      do c = 1, 3
         rows(4:, c) = [(sin(real(seed + 7*k + 31*c, wp)), k=4, n_dof)]
      end do
   end function rows_of

   !> Product of the matrix and a vector
   function product_of(matrix, x) result(y)
      type(block_matrix_t), intent(in) :: matrix
      real(wp), intent(in) :: x(:, :)            !! The vector: (n_dof, n_block)
      real(wp) :: y(size(x, 1), size(x, 2))      !! The product: (n_dof, n_block)
      integer :: b, e

      do b = 1, size(x, 2)
         y(:, b) = matmul(matrix%diagonal(:, :, b), x(:, b))
      end do
      do e = 1, size(matrix%pair, 2)
         associate (p => matrix%pair(1, e), q => matrix%pair(2, e))
            y(:, p) = y(:, p) + matmul(matrix%coupling(:, :, e), x(:, q))
            if (matrix%symmetric) then
               y(:, q) = y(:, q) + matmul(x(:, p), matrix%coupling(:, :, e))
            else
               y(:, q) = y(:, q) + matmul(matrix%upper(:, :, e), x(:, p))
            end if
         end associate
      end do
   end function product_of
end module wall_stiffness
