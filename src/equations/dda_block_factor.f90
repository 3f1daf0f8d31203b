!> Factor and substitute by blocks: the solver of every step (Shi: df20, df21)
!>
!>    matrix = L D L',  D diagonal,  the diagonal of L ones;   matrix = L U if it is not symmetric
!>
!> Rows of blocks are eliminated one after the other; only blocks that are not zero are stored. The
!> chain of an arch is eliminated from both ends, so that its mirror images feel the same rounding
!> and the processor has two rows to work on. A row whose numbers and whose predecessors have not
!> changed keeps its factor. Rows change places, where a matrix is not symmetric, within a block
!> alone.
module dda_block_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : block_factor_t, plan_factor
   use dda_block_rows_3, only : eliminate_3 => eliminate, eliminate_pairs_3 => eliminate_pairs, &
      & substitute_3 => substitute_rows
   use dda_block_rows_6, only : eliminate_6 => eliminate, eliminate_pairs_6 => eliminate_pairs, &
      & substitute_6 => substitute_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: block_factor_t, plan_factor, factorise, substitute

contains

   !> Factor a matrix; one that is not positive definite, or not symmetric and singular, gives a
   !> factor that is not usable
   pure subroutine factorise(matrix, factor, changed, lift)
      !> The matrix
      type(block_matrix_t), intent(in) :: matrix
      !> Its factor, laid out for its pattern
      type(block_factor_t), intent(inout) :: factor
      !> Blocks whose diagonal block or couplings have changed since the factor was usable; all if
      !> it is not given: (n_block)
      logical, intent(in), optional :: changed(:)
      !> Whether a diagonal block that has no factor is lifted by some of the matrix's diagonal
      !> until it has one, from 1e-10 of it on; not if it is not given
      logical, intent(in), optional :: lift
      logical :: anew(size(factor%block)), may_lift
      integer :: i

      may_lift = .false.
      if (present(lift)) may_lift = lift
      anew = .true.
      if (present(changed) .and. factor%usable) then
         do i = 1, size(anew)
            anew(i) = changed(factor%block(i)) &
               & .or. any(anew(factor%column(factor%start(i):factor%start(i + 1) - 1)))
         end do
      end if
      factor%lifted = factor%lifted .and. .not. anew
      select case (factor%n_dof)
      case (6)
         if (factor%symmetric) then
            call eliminate_6(matrix, anew, may_lift, factor)
         else
            call eliminate_pairs_6(matrix, anew, may_lift, factor)
         end if
      case (3)
         if (factor%symmetric) then
            call eliminate_3(matrix, anew, may_lift, factor)
         else
            call eliminate_pairs_3(matrix, anew, may_lift, factor)
         end if
      case default
         factor%usable = .false.
      end select
   end subroutine factorise

   !> Solve for one right-hand side
   pure subroutine substitute(factor, x)
      !> Usable factor
      type(block_factor_t), intent(in) :: factor
      !> Right-hand side in, solution out: (n_dof, n_block)
      real(wp), intent(inout) :: x(:, :)

      select case (factor%n_dof)
      case (6)
         call substitute_6(factor, x)
      case (3)
         call substitute_3(factor, x)
      end select
   end subroutine substitute
end module dda_block_factor
