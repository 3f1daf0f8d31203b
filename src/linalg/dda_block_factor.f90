!> Block factorisation and substitution: the solver of every step (Shi: df20, df21)
!>
!>    matrix = L L',  or with a diagonal D = L D L';   matrix = L U if it is not symmetric
!>
!> Only blocks that are not zero are stored, in panels of columns with the same rows, which are
!> eliminated one after the other. The chain of an arch is eliminated from both ends, so that its
!> mirror images have the same rounding and the processor has two panels to work on. A panel whose
!> numbers and whose predecessors have not changed keeps its factor.
!>
!> A panel holds w columns in a matrix of w rows on the diagonal and m rows below it. Where the
!> matrix is not symmetric, w rows with the m columns to the right of the diagonal follow. When its
!> columns are eliminated, one product changes all panels that have these rows.
module dda_block_factor
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, find_rows, plan_panels
   use dda_front, only : factor_front, multiply_front, substitute_down, substitute_up
   use dda_kinds, only : wp
   use dda_lapack, only : dlacn2
   implicit none
   private

   public :: block_factor_t, factored_condition, factorise, plan_factor, substitute

   !> Factor of a block matrix
   type :: block_factor_t
      type(elimination_plan_t) :: plan  !! Panels and their places
      real(wp), allocatable :: number(:)    !! The numbers
      integer, allocatable :: exchange(:)   !! Exchanges of rows, where the matrix is not symmetric
      !> True if the factor can be used: the matrix was positive definite, or if it is not
      !> symmetric, no pivot was zero
      logical :: usable = .false.
   end type block_factor_t

contains

   !> Lay out the factor of a matrix
   pure subroutine plan_factor(matrix, factor)
      !> The matrix, of which the pattern counts
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(out) :: factor  !! The factor, without numbers

      call plan_panels(matrix, factor%plan)
      allocate (factor%number(factor%plan%start(size(factor%plan%start)) - 1))
      allocate (factor%exchange(size(matrix%diagonal(1, :, :))))
   end subroutine plan_factor

   !> Factor a matrix; one that is not positive definite, or not symmetric and singular, gives a
   !> factor that is not usable
   pure subroutine factorise(matrix, factor, changed)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(inout) :: factor  !! Its factor, laid out for its pattern
      !> Blocks whose diagonal block or couplings have changed since the factor was usable; all if
      !> it is not given: (n_block)
      logical, intent(in), optional :: changed(:)
      logical :: fresh(size(factor%plan%first) - 1)
      integer :: p

      fresh = .not. (present(changed) .and. factor%usable)
      associate (plan => factor%plan)
         do p = 1, size(fresh)
            if (present(changed)) fresh(p) = fresh(p) .or. &
               & any(changed(plan%block(plan%first(p):plan%first(p + 1) - 1)))
            if (fresh(p)) fresh(plan%panel(plan%row(plan%first_row(p):plan%first_row(p + 1) - 1))) &
               & = .true.
         end do
         call assemble_fronts(plan, matrix, fresh, factor%number)
         call eliminate_fronts(plan, fresh, factor%number, factor%exchange, factor%usable)
      end associate
   end subroutine factorise

   !> Solve for one right-hand side, panel by panel
   pure subroutine substitute(factor, x)
      type(block_factor_t), intent(in) :: factor  !! Usable factor
      real(wp), intent(inout), contiguous :: x(:, :)  !! Load in, solution out: (n_dof, n_block)
      real(wp) :: rest(size(x, 1)*factor%plan%most_rows), y(size(x, 1), size(x, 2))
      integer :: below, n, p, step, width

      n = size(factor%plan%first) - 1
      call take_blocks(size(x, 1), size(x, 2), factor%plan%block, x, y)
      do step = 1, 2*n
         p = min(step, 2*n + 1 - step)
         associate (plan => factor%plan, nd => size(x, 1), first => factor%plan%first(p), &
            & row => factor%plan%row(factor%plan%first_row(p):factor%plan%first_row(p + 1) - 1))
            width = nd*(plan%first(p + 1) - first)
            below = nd*size(row)
            if (step > n) then
               call take_blocks(nd, size(row), row, y, rest)
               call substitute_up(plan%symmetric, width, below, factor%number(plan%start(p)), &
                  & rest, y(1, first))
            else if (any(abs(y(:, first:plan%first(p + 1) - 1)) > 0.0_wp)) then
               ! the load of a single joint concerns few panels
               rest(:below) = 0.0_wp
               call substitute_down(plan%symmetric, width, below, factor%number(plan%start(p)), &
                  & factor%exchange(nd*(first - 1) + 1), y(1, first), rest)
               call add_blocks(nd, size(row), row, rest, y)
            end if
         end associate
      end do
      x = 0.0_wp
      call add_blocks(size(x, 1), size(x, 2), factor%plan%block, y, x)
   end subroutine substitute

   !> Condition number in the one-norm of the matrix scaled to a unit diagonal, so that neither the
   !> unit of length nor the size of a block shows; huge if the factor is not usable
   pure function factored_condition(matrix, factor) result(condition)
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(in) :: factor
      real(wp) :: condition  !! Estimate of the condition number, at least 1
      real(wp), allocatable :: root(:, :)
      integer :: c

      condition = huge(condition)
      if (.not. factor%usable) return
      allocate (root(matrix%n_dof, size(matrix%diagonal, 3)))
      do c = 1, matrix%n_dof
         root(c, :) = sqrt(matrix%diagonal(c, c, :))
      end do
      condition = max(1.0_wp, scaled_norm(matrix, 1.0_wp/root)*inverse_norm(factor, root))
   end function factored_condition

   !> Largest sum of magnitudes of a column of the scaled matrix; entries of the same pair count
   !> apart, which can only enlarge it
   pure function scaled_norm(matrix, scale) result(norm)
      type(block_matrix_t), intent(in) :: matrix
      real(wp), intent(in) :: scale(:, :)  !! Factors of rows and columns: (n_dof, n_block)
      real(wp) :: norm, column(size(scale, 1), size(scale, 2))
      integer :: b, e

      do b = 1, size(scale, 2)
         column(:, b) = matmul(scale(:, b), abs(matrix%diagonal(:, :, b)))
      end do
      do e = 1, size(matrix%pair, 2)
         associate (row => matrix%pair(1, e), col => matrix%pair(2, e))
            column(:, col) = column(:, col) + matmul(scale(:, row), abs(matrix%coupling(:, :, e)))
            column(:, row) = column(:, row) + matmul(abs(matrix%coupling(:, :, e)), scale(:, col))
         end associate
      end do
      norm = maxval(scale*column)
   end function scaled_norm

   !> One-norm of the inverse of the scaled matrix from below (LAPACK's dlacn2)
   pure function inverse_norm(factor, root) result(norm)
      type(block_factor_t), intent(in) :: factor
      real(wp), intent(in) :: root(:, :)  !! Roots of the matrix's diagonal: (n_dof, n_block)
      real(wp) :: norm, v(size(root)), x(size(root, 1), size(root, 2))
      integer :: kase, state(3), sign_of(size(root))

      kase = 0
      norm = 0.0_wp
      do
         call dlacn2(size(root), v, x, sign_of, norm, kase, state)
         if (kase == 0) return
         ! the matrix is symmetric: its transpose solves the same
         x = root*x
         call substitute(factor, x)
         x = root*x
      end do
   end function inverse_norm

   !> Lay the blocks of the matrix into panels
   pure subroutine assemble_fronts(plan, matrix, fresh, number)
      type(elimination_plan_t), intent(in) :: plan
      type(block_matrix_t), intent(in) :: matrix
      logical, intent(in) :: fresh(:)           !! Panels to be factored: (n_panel)
      real(wp), intent(inout) :: number(*)     !! Numbers of the panels
      integer :: b, c, e, height, k, nd, p, r, width

      nd = plan%n_dof
      do p = 1, size(fresh)
         if (.not. fresh(p)) cycle
         number(plan%start(p):plan%start(p + 1) - 1) = 0.0_wp
         height = nd*(plan%first(p + 1) - plan%first(p) + plan%first_row(p + 1) - plan%first_row(p))
         do b = plan%first(p), plan%first(p + 1) - 1
            call add_block(nd, matrix%diagonal(:, :, plan%block(b)), height, &
               & number(plan%start(p) + nd*(height + 1)*(b - plan%first(p))))
         end do
      end do
      do e = 1, size(plan%given, 2)
         p = plan%given(1, e)
         if (.not. fresh(p)) cycle
         r = nd*plan%given(2, e)
         c = nd*plan%given(3, e)
         width = nd*(plan%first(p + 1) - plan%first(p))
         height = width + nd*(plan%first_row(p + 1) - plan%first_row(p))
         call add_block(nd, matrix%coupling(:, :, e), height, number(plan%start(p) + r + c*height))
         if (plan%symmetric) cycle
         k = plan%start(p) + c + r*height
         if (r >= width) then
            k = plan%start(p) + height*width + c + (r - width)*width
            height = width
         end if
         call add_block(nd, matrix%upper(:, :, e), height, number(k))
      end do
   end subroutine assemble_fronts

   !> Add a block to a panel
   pure subroutine add_block(nd, block, height, sum)
      integer, intent(in) :: nd, height             !! Unknowns of one block, rows of the panel
      real(wp), intent(in) :: block(nd, nd)         !! The block
      real(wp), intent(inout) :: sum(height, *)     !! The panel from the block's first number on
      integer :: c

      do c = 1, nd
         sum(:nd, c) = sum(:nd, c) + block(:, c)
      end do
   end subroutine add_block

   !> Eliminate panel by panel
   pure subroutine eliminate_fronts(plan, fresh, number, exchange, usable)
      type(elimination_plan_t), intent(in) :: plan
      logical, intent(in) :: fresh(:)
      real(wp), intent(inout) :: number(*)
      integer, intent(inout) :: exchange(*)  !! Exchanges of rows in the panels: (n_dof*n_block)
      !> True if all pivots of a symmetric matrix are positive, those of another one not zero
      logical, intent(out) :: usable
      real(wp), allocatable :: share(:)
      integer :: below, info, omitted, p, width

      usable = .false.
      allocate (share((plan%n_dof*plan%most_rows)**2), source=0.0_wp)
      do p = 1, size(fresh)
         width = plan%n_dof*(plan%first(p + 1) - plan%first(p))
         below = plan%n_dof*(plan%first_row(p + 1) - plan%first_row(p))
         if (fresh(p)) then
            call factor_front(plan%symmetric, width, below, number(plan%start(p)), &
               & exchange(plan%n_dof*(plan%first(p) - 1) + 1), info)
            if (info /= 0) return
         end if
         associate (row => plan%row(plan%first_row(p):plan%first_row(p + 1) - 1))
            ! rows of a panel couple: those behind a row of a panel to be factored are of such, too
            omitted = count(.not. fresh(plan%panel(row)))
            if (omitted == size(row)) cycle
         end associate
         call multiply_front(plan%symmetric, width, below, plan%n_dof*omitted, &
            & number(plan%start(p)), share)
         call spread_share(plan, p, omitted, below, share, number)
      end do
      usable = .true.
   end subroutine eliminate_fronts

   !> Add the products of one panel to those that have its rows
   pure subroutine spread_share(plan, p, omitted, below, share, number)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: p, below  !! The panel, and its rows below the diagonal
      integer, intent(in) :: omitted   !! First rows, as blocks, of panels that keep their factor
      real(wp), intent(in) :: share(below, *)  !! The products: (below, below)
      real(wp), intent(inout) :: number(*)
      integer :: at(plan%first_row(p + 1) - plan%first_row(p)), height, i, k, n, nd, t, width

      nd = plan%n_dof
      n = omitted
      do while (n < size(at))
         t = plan%panel(plan%row(plan%first_row(p) + n))
         width = plan%first(t + 1) - plan%first(t)
         height = width + plan%first_row(t + 1) - plan%first_row(t)
         k = n + 1
         call find_rows(plan, t, plan%row(plan%first_row(p) + n:plan%first_row(p + 1) - 1), &
            & at(k:), n)
         n = k - 1 + n
         i = nd*(k - 1) + 1
         call add_share(nd, at(k:), at(k:n), plan%symmetric, below, share(i, i), nd*height, &
            & number(plan%start(t)))
         if (.not. plan%symmetric) call add_share(nd, at(k:n), at(n + 1:) - width, .false., below, &
            & share(i, nd*n + 1), nd*width, number(plan%start(t) + nd**2*height*width))
      end do
   end subroutine spread_share

   !> Add blocks to a panel: panel(row, column) = panel(row, column) + share. Rows that follow
   !> one another are taken together
   pure subroutine add_share(nd, row, column, lower, below, share, height, panel)
      integer, intent(in) :: nd, below, height
      integer, intent(in) :: row(:), column(:)  !! Places of the blocks in the panel, from zero on
      logical, intent(in) :: lower              !! True if those above the diagonal are omitted
      real(wp), intent(in) :: share(below, *)
      real(wp), intent(inout) :: panel(height, *)    !! The panel
      integer :: c, first, i, j, last(size(row)), length, r

      last = size(row)
      do i = size(row) - 1, 1, -1
         last(i) = merge(last(i + 1), i, row(i + 1) == row(i) + 1)
      end do
      do j = 1, size(column)
         first = merge(j, 1, lower)
         do while (first <= size(row))
            length = nd*(last(first) + 1 - first)
            r = nd*row(first)
            i = nd*(first - 1)
            do c = 1, nd
               panel(r + 1:r + length, nd*column(j) + c) = share(i + 1:i + length, nd*(j - 1) + c) &
                  & + panel(r + 1:r + length, nd*column(j) + c)
            end do
            first = last(first) + 1
         end do
      end do
   end subroutine add_share

   !> Unknowns of some blocks; three at a time, since calls of the library for each would cost more
   pure subroutine take_blocks(nd, n, block, x, some)
      integer, intent(in) :: nd, n, block(n)  !! 3 or 6 unknowns of a block; numbers of blocks
      real(wp), intent(in) :: x(nd, *)        !! Unknowns of all blocks
      real(wp), intent(inout) :: some(nd, *)  !! Unknowns of those blocks
      integer :: c, i

      do c = 1, nd, 3
         do i = 1, n
            some(c:c + 2, i) = x(c:c + 2, block(i))
         end do
      end do
   end subroutine take_blocks

   !> Add to the unknowns of some blocks
   pure subroutine add_blocks(nd, n, block, some, x)
      integer, intent(in) :: nd, n, block(n)
      real(wp), intent(in) :: some(nd, *)   !! Addends of those blocks
      real(wp), intent(inout) :: x(nd, *)   !! Unknowns of all blocks
      integer :: c, i

      do c = 1, nd, 3
         do i = 1, n
            x(c:c + 2, block(i)) = x(c:c + 2, block(i)) + some(c:c + 2, i)
         end do
      end do
   end subroutine add_blocks
end module dda_block_factor
