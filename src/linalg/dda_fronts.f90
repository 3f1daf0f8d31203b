!> Elimination by panels
!>
!> A panel holds w columns in a matrix of w rows on the diagonal and m rows below it. Where the
!> matrix is not symmetric, w rows with the m columns to the right of the diagonal follow. When its
!> columns are eliminated, one product changes all panels that have these rows.
module dda_fronts
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, find_rows
   use dda_front, only : factor_front, multiply_front, substitute_down, substitute_up
   use dda_kinds, only : wp
   implicit none
   private

   public :: assemble_fronts, eliminate_fronts, substitute_fronts

contains

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
      integer, intent(in) :: nd                     !! Unknowns of one block
      real(wp), intent(in) :: block(nd, nd)         !! The block
      integer, intent(in) :: height                 !! Rows of the panel
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
      integer :: c, first, i, j, last, length, r

      do j = 1, size(column)
         first = merge(j, 1, lower)
         do while (first <= size(row))
            last = first
            do while (last < size(row))
               if (row(last + 1) /= row(last) + 1) exit
               last = last + 1
            end do
            length = nd*(last + 1 - first)
            r = nd*row(first)
            i = nd*(first - 1)
            do c = 1, nd
               panel(r + 1:r + length, nd*column(j) + c) = share(i + 1:i + length, nd*(j - 1) + c) &
                  & + panel(r + 1:r + length, nd*column(j) + c)
            end do
            first = last + 1
         end do
      end do
   end subroutine add_share

   !> Solve with the panels
   pure subroutine substitute_fronts(plan, number, exchange, x)
      type(elimination_plan_t), intent(in) :: plan
      real(wp), intent(in) :: number(*)
      integer, intent(in) :: exchange(*)
      !> Right-hand side in, solution out: (n_dof, n_block)
      real(wp), intent(inout) :: x(plan%n_dof, *)
      real(wp) :: rest(plan%n_dof, plan%most_rows)
      integer :: below, i, n, p, step, width

      n = size(plan%first) - 1
      do step = 1, 2*n
         p = min(step, 2*n + 1 - step)
         width = plan%n_dof*(plan%first(p + 1) - plan%first(p))
         below = plan%first_row(p + 1) - plan%first_row(p)
         associate (row => plan%row(plan%first_row(p):plan%first_row(p + 1) - 1))
            if (step <= n) then
               rest(:, :below) = 0.0_wp
               call substitute_down(plan%symmetric, width, plan%n_dof*below, &
                  & number(plan%start(p)), exchange(plan%n_dof*(plan%first(p) - 1) + 1), &
                  & x(1, plan%first(p)), rest)
               do i = 1, below
                  x(:, row(i)) = x(:, row(i)) + rest(:, i)
               end do
            else
               do i = 1, below
                  rest(:, i) = x(:, row(i))
               end do
               call substitute_up(plan%symmetric, width, plan%n_dof*below, number(plan%start(p)), &
                  & rest, x(1, plan%first(p)))
            end if
         end associate
      end do
   end subroutine substitute_fronts
end module dda_fronts
