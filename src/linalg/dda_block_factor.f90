!> Factor and substitute by blocks: the solver of every step (Shi: df20, df21)
!>
!>    matrix = L D L',  D diagonal,  the diagonal of L ones;   matrix = L U if it is not symmetric
!>
!> Only blocks that are not zero are stored, in panels of columns with the same rows, which are
!> eliminated one after the other. The chain of an arch is eliminated from both ends, so that its
!> mirror images feel the same rounding and the processor has two panels to work on. A panel whose
!> numbers and whose predecessors have not changed keeps its factor. Rows change places, where a
!> matrix is not symmetric, within three unknowns of a block alone.
!>
!> The condition number is estimated with the factor itself: a case that runs beside others must not
!> call LAPACK.
module dda_block_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, most_columns, plan_panels
   use dda_kinds, only : rk => wp, wp
   implicit none
   private

   public :: block_factor_t, factorise, factorise_in_place, plan_factor, substitute
   public :: factored_condition

   include "dda_panel_type.inc"

   !> Factor of a block matrix
   type :: block_factor_t
      type(elimination_plan_t) :: plan  !! Which numbers there are
      type(panels_t) :: panels          !! The numbers
      !> Whether the factor can be used: the matrix was positive definite, or if it is not
      !> symmetric, no pivot was zero
      logical :: usable = .false.
   end type block_factor_t

   !> Most steps of the ascent; two or three do
   integer, parameter :: max_steps = 5

contains

   !> Lay out the factor of a matrix
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts; three or six unknowns a block
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(out) :: factor  !! The factor, without numbers

      call plan_panels(matrix, factor%plan)
      call new_panels(factor%plan, matrix%symmetric, factor%panels)
   end subroutine plan_factor

   !> Factor a matrix; one that is not positive definite, or not symmetric and singular, gives a
   !> factor that is not usable
   pure subroutine factorise(matrix, factor, changed)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(inout) :: factor  !! Its factor, laid out for its pattern
      !> Blocks whose diagonal block or couplings have changed since the factor was usable; all if
      !> it is not given: (n_block)
      logical, intent(in), optional :: changed(:)
      logical :: anew(size(factor%plan%first) - 1)
      integer :: p

      anew = .true.
      if (present(changed) .and. factor%usable) then
         associate (plan => factor%plan, n => factor%plan%n_triple)
            do p = 1, size(anew)
               associate ( &
                  & block => plan%block((plan%first(p) + n - 1)/n:(plan%first(p + 1) - 1)/n), &
                  & source => plan%source(1, plan%first_source(p):plan%first_source(p + 1) - 1))
                  anew(p) = any(changed(block)) .or. any(anew(source))
               end associate
            end do
         end associate
      end if
      call eliminate(factor%plan, anew, factor%panels, matrix%diagonal, matrix%coupling, &
         & matrix%upper)
      factor%usable = factor%panels%usable
   end subroutine factorise

   !> Factor what has been added up in the panels
   pure subroutine factorise_in_place(factor)
      type(block_factor_t), intent(inout) :: factor
      integer :: p

      call eliminate(factor%plan, [(.true., p=1, size(factor%plan%first) - 1)], factor%panels)
      factor%usable = factor%panels%usable
   end subroutine factorise_in_place

   !> Solve for one right-hand side
   pure subroutine substitute(factor, x)
      !> Usable factor
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(inout) :: x(:, :)  !! Right-hand side in, solution out: (n_dof, n_block)
      real(wp) :: y(3, factor%plan%n_triple*size(factor%plan%block) + factor%plan%highest)
      integer :: b, k

      associate (n => factor%plan%n_triple, block => factor%plan%block)
         do b = 1, size(block)
            do k = 1, n
               y(:, n*(b - 1) + k) = x(3*k - 2:3*k, block(b))
            end do
         end do
         call substitute_panels(factor%plan, factor%panels, y)
         do b = 1, size(block)
            do k = 1, n
               x(3*k - 2:3*k, block(b)) = y(:, n*(b - 1) + k)
            end do
         end do
      end associate
   end subroutine substitute

   include "dda_panels.inc"
   include "dda_panel_factor.inc"
   include "dda_panel_substitution.inc"

   !> Condition number in the one-norm of the matrix scaled to a unit diagonal, so that neither the
   !> unit of length nor the size of a block shows; huge if the factor is not usable
   pure function factored_condition(matrix, factor) result(condition)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(in) :: factor
      real(wp) :: condition  !! Estimate of the condition number, at least 1
      real(wp) :: root(matrix%n_dof, size(matrix%diagonal, 3))
      integer :: b, c

      condition = huge(condition)
      if (.not. factor%usable) return
      do b = 1, size(root, 2)
         do c = 1, matrix%n_dof
            root(c, b) = sqrt(matrix%diagonal(c, c, b))
         end do
      end do
      condition = max(1.0_wp, scaled_norm(matrix, root)*inverse_norm(factor, root))
   end function factored_condition

   !> Largest sum of magnitudes of a column of the scaled matrix
   pure function scaled_norm(matrix, root) result(norm)
      !> The matrix; entries of the same pair count apart, which can only enlarge the norm
      type(block_matrix_t), intent(in) :: matrix
      !> Roots of its diagonal: (n_dof, n_block)
      real(wp), intent(in) :: root(:, :)
      !> The norm
      real(wp) :: norm
      real(wp) :: column(size(root, 1), size(root, 2)), one(size(root, 1))
      integer :: b, e

      one = 1.0_wp
      do b = 1, size(root, 2)
         column(:, b) = matmul(one/root(:, b), abs(matrix%diagonal(:, :, b)))/root(:, b)
      end do
      do e = 1, size(matrix%pair, 2)
         associate (row => matrix%pair(1, e), col => matrix%pair(2, e))
            column(:, col) = column(:, col) &
               & + matmul(one/root(:, row), abs(matrix%coupling(:, :, e)))/root(:, col)
            column(:, row) = column(:, row) &
               & + matmul(abs(matrix%coupling(:, :, e)), one/root(:, col))/root(:, row)
         end associate
      end do
      norm = maxval(column)
   end function scaled_norm

   !> One-norm of the inverse of the scaled matrix from below, by Hager's ascent with Higham's
   !> safeguard (ACM Transactions on Mathematical Software 14, 1988, 381)
   pure function inverse_norm(factor, root) result(norm)
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(in) :: root(:, :)  !! Roots of the matrix's diagonal: (n_dof, n_block)
      real(wp) :: norm                    !! The norm
      real(wp) :: x(size(root, 1), size(root, 2)), y(size(root, 1), size(root, 2))
      integer :: i, place(2), step

      norm = 0.0_wp
      x = 1.0_wp/real(size(x), wp)
      do step = 1, max_steps
         y = scaled_solution(factor, root, x)
         if (.not. sum(abs(y)) > norm) exit
         norm = sum(abs(y))
         y = scaled_solution(factor, root, sign(1.0_wp, y))
         place = maxloc(abs(y))
         if (abs(y(place(1), place(2))) <= sum(x*y)) exit
         x = 0.0_wp
         x(place(1), place(2)) = 1.0_wp
      end do
      x = reshape([((-1.0_wp)**i*(1.0_wp + real(i, wp)/real(max(1, size(x) - 1), wp)), &
         & i=0, size(x) - 1)], shape(x))
      y = scaled_solution(factor, root, x)
      norm = max(norm, 2.0_wp*sum(abs(y))/(3.0_wp*real(size(x), wp)))
   end function inverse_norm

   !> Solution with the scaled matrix
   pure function scaled_solution(factor, root, load) result(x)
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(in) :: root(:, :)
      real(wp), intent(in) :: load(:, :)           !! The right-hand side: (n_dof, n_block)
      real(wp) :: x(size(load, 1), size(load, 2))  !! The solution: (n_dof, n_block)

      x = root*load
      call substitute(factor, x)
      x = root*x
   end function scaled_solution

end module dda_block_factor
