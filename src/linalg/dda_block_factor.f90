!> Factor and substitute by blocks: the solver of every step (Shi: df20, df21)
!>
!>    matrix = L D L',  D diagonal,  the diagonal of L ones;   matrix = L U if it is not symmetric
!>
!> Only blocks that are not zero are stored, in panels of columns with the same rows, which are
!> eliminated one after the other. The chain of an arch is eliminated from both ends, so that its
!> mirror images feel the same rounding and the processor has two panels to work on. A panel whose
!> numbers and whose predecessors have not changed keeps its factor. Rows change places, where a
!> matrix is not symmetric, within three unknowns of a block alone.
module dda_block_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, most_columns, plan_panels
   use dda_kinds, only : rk => wp, wp
   implicit none
   private

   public :: block_factor_t, factorise, plan_factor, substitute

   include "dda_panel_type.inc"

   !> Factor of a block matrix
   type :: block_factor_t
      !> Which numbers there are
      type(elimination_plan_t) :: plan
      !> The numbers
      type(panels_t) :: panels
      !> Whether the factor can be used: the matrix was positive definite, or if it is not
      !> symmetric, no pivot was zero
      logical :: usable = .false.
   end type block_factor_t

contains

   !> Lay out the factor of a matrix
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts; three or six unknowns a block
      type(block_matrix_t), intent(in) :: matrix
      !> The factor, without numbers
      type(block_factor_t), intent(out) :: factor

      call plan_panels(matrix, factor%plan)
      call new_panels(factor%plan, matrix%symmetric, factor%panels)
   end subroutine plan_factor

   !> Factor a matrix; one that is not positive definite, or not symmetric and singular, gives a
   !> factor that is not usable
   pure subroutine factorise(matrix, factor, changed)
      type(block_matrix_t), intent(in) :: matrix
      !> Its factor, laid out for its pattern
      type(block_factor_t), intent(inout) :: factor
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
      call eliminate(factor%plan, matrix%diagonal, matrix%coupling, matrix%upper, anew, &
         & factor%panels)
      factor%usable = factor%panels%usable
   end subroutine factorise

   !> Solve for one right-hand side
   pure subroutine substitute(factor, x)
      !> Usable factor
      type(block_factor_t), intent(in) :: factor
      !> Right-hand side in, solution out: (n_dof, n_block)
      real(wp), intent(inout) :: x(:, :)
      real(wp) :: y(3, size(factor%panels%pivot, 2) + factor%plan%highest)
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
end module dda_block_factor
