!> Elimination by panels with LAPACK factors of dense matrices
!>
!> A panel holds w columns in a matrix of w rows on the diagonal and m rows below it. Where the
!> matrix is not symmetric, w rows with the m columns to the right of the diagonal follow. When its
!> columns are eliminated, one product changes all panels that have these rows.
module dda_fronts
   use dda_block_matrix, only : block_matrix_t
   use dda_block_plan, only : elimination_plan_t, find_rows
   use dda_front_factor, only : factor_front, narrow, take_triple
   use dda_kinds, only : wp
   use dda_lapack, only : dgemm, dgemv, dlaswp, dsyrk, dtrsv
   implicit none
   private

   public :: assemble_fronts, eliminate_fronts, substitute_fronts

contains

   !> Lay the blocks of the matrix into panels
   pure subroutine assemble_fronts(plan, matrix, anew, number)
      type(elimination_plan_t), intent(in) :: plan
      type(block_matrix_t), intent(in) :: matrix
      logical, intent(in) :: anew(:)           !! Panels to be made anew: (n_panel)
      real(wp), intent(inout) :: number(*)     !! Numbers of the panels
      integer :: b, c, e, height, k, nd, p, r, width

      nd = plan%n_dof
      do p = 1, size(anew)
         if (.not. anew(p)) cycle
         number(plan%start(p):plan%start(p + 1) - 1) = 0.0_wp
         height = nd*(plan%first(p + 1) - plan%first(p) + plan%first_row(p + 1) - plan%first_row(p))
         k = plan%start(p)
         do b = plan%first(p), plan%first(p + 1) - 1
            call add_block(nd, matrix%diagonal(:, :, plan%block(b)), height, number(k))
            k = k + nd*(height + 1)
         end do
      end do
      do e = 1, size(plan%given, 2)
         p = abs(plan%given(1, e))
         if (.not. anew(p)) cycle
         r = nd*plan%given(2, e)
         c = nd*plan%given(3, e)
         width = nd*(plan%first(p + 1) - plan%first(p))
         height = width + nd*(plan%first_row(p + 1) - plan%first_row(p))
         k = plan%start(p) + r + c*height
         associate (first_is_row => plan%given(1, e) > 0)
            if (first_is_row) then
               call add_block(nd, matrix%coupling(:, :, e), height, number(k))
            else if (plan%symmetric) then
               call add_block(nd, transpose(matrix%coupling(:, :, e)), height, number(k))
            else
               call add_block(nd, matrix%upper(:, :, e), height, number(k))
            end if
            if (plan%symmetric) cycle
            if (r < width) then
               k = plan%start(p) + c + r*height
            else
               k = plan%start(p) + height*width + c + (r - width)*width
               height = width
            end if
            if (first_is_row) then
               call add_block(nd, matrix%upper(:, :, e), height, number(k))
            else
               call add_block(nd, matrix%coupling(:, :, e), height, number(k))
            end if
         end associate
      end do
   end subroutine assemble_fronts

   !> Add a block to a panel
   pure subroutine add_block(nd, block, height, sum)
      integer, intent(in) :: nd                     !! Unknowns of one block
      real(wp), intent(in) :: block(nd, nd)         !! The block
      integer, intent(in) :: height                 !! Rows of the panel
      real(wp), intent(inout) :: sum(height, *)     !! The panel from the block's first number on
      integer :: c, r

      do c = 1, nd
         do r = 1, nd
            sum(r, c) = sum(r, c) + block(r, c)
         end do
      end do
   end subroutine add_block

   !> Eliminate panel by panel
   pure subroutine eliminate_fronts(plan, anew, number, exchange, usable)
      type(elimination_plan_t), intent(in) :: plan
      logical, intent(in) :: anew(:)
      real(wp), intent(inout) :: number(*)
      integer, intent(inout) :: exchange(*)  !! Exchanges of rows in the panels: (n_dof*n_block)
      !> Whether all pivots of a symmetric matrix are positive, those of another one not zero
      logical, intent(out) :: usable
      real(wp), allocatable :: share(:)
      integer :: below, info, p, width

      usable = .false.
      allocate (share((plan%n_dof*plan%most_rows)**2), source=0.0_wp)
      do p = 1, size(anew)
         width = plan%n_dof*(plan%first(p + 1) - plan%first(p))
         below = plan%n_dof*(plan%first_row(p + 1) - plan%first_row(p))
         if (anew(p)) then
            call factor_front(plan%symmetric, width, below, number(plan%start(p)), &
               & exchange(plan%n_dof*(plan%first(p) - 1) + 1), info)
            if (info /= 0) return
         end if
         if (below == 0) cycle
         associate (row => plan%row(plan%first_row(p):plan%first_row(p + 1) - 1))
            if (.not. any(anew(plan%panel(row)))) cycle
         end associate
         call multiply_front(plan%symmetric, width, below, number(plan%start(p)), share)
         call spread_share(plan, p, anew, below, share, number)
      end do
      usable = .true.
   end subroutine eliminate_fronts

   !> What elimination of a panel takes from its rows; of a symmetric matrix the lower triangle
   pure subroutine multiply_front(symmetric, width, below, front, share)
      logical, intent(in) :: symmetric                    !! Whether the matrix is
      integer, intent(in) :: width                        !! Columns of the panel
      integer, intent(in) :: below                        !! Rows below its diagonal
      real(wp), intent(in) :: front(width + below, *)     !! The panel
      real(wp), intent(inout) :: share(below, *)  !! The products: (below, below)
      integer :: c, height, k

      height = width + below
      if (.not. symmetric) then
         call dgemm("N", "N", below, below, width, 1.0_wp, front(width + 1, 1), height, &
            & front(1, width + 1), width, 0.0_wp, share, below)
      else if (width <= narrow) then
         do k = 1, below
            share(k:below, k) = 0.0_wp
            do c = 1, width, 3
               call take_triple(below + 1 - k, front(width + k, c), front(width + k, c + 1), &
                  & front(width + k, c + 2), [-front(width + k, c)*front(c, c), &
                  & -front(width + k, c + 1)*front(c + 1, c + 1), &
                  & -front(width + k, c + 2)*front(c + 2, c + 2)], share(k, k))
            end do
         end do
      else
         call dsyrk("L", "N", below, width, 1.0_wp, front(width + 1, 1), height, 0.0_wp, share, &
            & below)
      end if
   end subroutine multiply_front

   !> Take the products of one panel from those that have its rows
   pure subroutine spread_share(plan, p, anew, below, share, number)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: p  !! The panel
      logical, intent(in) :: anew(:)
      integer, intent(in) :: below
      real(wp), intent(in) :: share(below, *)  !! The products: (below, below)
      real(wp), intent(inout) :: number(*)
      integer :: at(plan%first_row(p + 1) - plan%first_row(p)), height, i, k, n, nd, t, width

      nd = plan%n_dof
      n = 0
      do while (n < size(at))
         t = plan%panel(plan%row(plan%first_row(p) + n))
         width = plan%first(t + 1) - plan%first(t)
         height = width + plan%first_row(t + 1) - plan%first_row(t)
         k = n + 1
         call find_rows(plan, t, plan%row(plan%first_row(p) + n:plan%first_row(p + 1) - 1), &
            & at(k:), n)
         n = k - 1 + n
         if (.not. anew(t)) cycle
         i = nd*(k - 1) + 1
         call subtract(nd, at(k:), at(k:n), plan%symmetric, below, share(i, i), nd*height, &
            & number(plan%start(t)))
         if (.not. plan%symmetric) call subtract(nd, at(k:n), at(n + 1:) - width, .false., below, &
            & share(i, nd*n + 1), nd*width, number(plan%start(t) + nd**2*height*width))
      end do
   end subroutine spread_share

   !> Take blocks from a panel: panel(row, column) = panel(row, column) - share. Rows that follow
   !> one another are taken together
   pure subroutine subtract(nd, row, column, lower, below, share, height, panel)
      integer, intent(in) :: nd
      integer, intent(in) :: row(:), column(:)  !! Places of the blocks in the panel, from zero on
      logical, intent(in) :: lower              !! Whether those above the diagonal are left out
      integer, intent(in) :: below
      real(wp), intent(in) :: share(below, *)
      integer, intent(in) :: height                  !! Rows of the panel
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
               associate (into => panel(r + 1:r + length, nd*column(j) + c))
                  into = into - share(i + 1:i + length, nd*(j - 1) + c)
               end associate
            end do
            first = last + 1
         end do
      end do
   end subroutine subtract

   !> Solve with the panels
   pure subroutine substitute_fronts(plan, number, exchange, x)
      type(elimination_plan_t), intent(in) :: plan
      real(wp), intent(in) :: number(*)
      integer, intent(in) :: exchange(*)
      !> Right-hand side in, solution out: (n_dof, n_block)
      real(wp), intent(inout) :: x(plan%n_dof, *)
      real(wp) :: rest(plan%n_dof, plan%most_rows)
      integer :: below, i, k, p, width

      do p = 1, size(plan%first) - 1
         k = plan%first_row(p) - 1
         below = plan%first_row(p + 1) - 1 - k
         width = plan%n_dof*(plan%first(p + 1) - plan%first(p))
         rest(:, :below) = 0.0_wp
         call substitute_down(plan%symmetric, width, plan%n_dof*below, number(plan%start(p)), &
            & exchange(plan%n_dof*(plan%first(p) - 1) + 1), x(1, plan%first(p)), rest)
         do i = 1, below
            x(:, plan%row(k + i)) = x(:, plan%row(k + i)) + rest(:, i)
         end do
      end do
      do p = size(plan%first) - 1, 1, -1
         k = plan%first_row(p) - 1
         below = plan%first_row(p + 1) - 1 - k
         width = plan%n_dof*(plan%first(p + 1) - plan%first(p))
         do i = 1, below
            rest(:, i) = x(:, plan%row(k + i))
         end do
         call substitute_up(plan%symmetric, width, plan%n_dof*below, number(plan%start(p)), rest, &
            & x(1, plan%first(p)))
      end do
   end subroutine substitute_fronts

   !> Solve with L of a panel, and take the solution from the rows below
   pure subroutine substitute_down(symmetric, width, below, front, exchange, x, rest)
      logical, intent(in) :: symmetric
      integer, intent(in) :: width, below
      real(wp), intent(in) :: front(width + below, *)  !! The panel
      integer, intent(in) :: exchange(width)           !! Exchanges of its rows
      real(wp), intent(inout) :: x(width)              !! Right-hand side in, solution out
      real(wp), intent(inout) :: rest(below)           !! Zeros in, what the rows below get out
      integer :: c, height

      height = width + below
      if (.not. symmetric) call dlaswp(1, x, width, 1, width, exchange, 1)
      if (width > narrow) then
         call dtrsv("L", "N", merge("N", "U", symmetric), width, front, height, x, 1)
         if (below > 0) call dgemv("N", below, width, -1.0_wp, front(width + 1, 1), height, x, 1, &
            & 0.0_wp, rest, 1)
         return
      end if
      do c = 1, width, 3
         x(c + 1) = x(c + 1) - front(c + 1, c)*x(c)
         x(c + 2) = x(c + 2) - front(c + 2, c)*x(c) - front(c + 2, c + 1)*x(c + 1)
         if (c + 2 < width) call take_triple(width - c - 2, front(c + 3, c), front(c + 3, c + 1), &
            & front(c + 3, c + 2), x(c:c + 2), x(c + 3))
         call take_triple(below, front(width + 1, c), front(width + 1, c + 1), &
            & front(width + 1, c + 2), x(c:c + 2), rest)
      end do
   end subroutine substitute_down

   !> Solve with the transpose of L of a panel, or with U
   pure subroutine substitute_up(symmetric, width, below, front, known, x)
      logical, intent(in) :: symmetric
      integer, intent(in) :: width, below
      real(wp), intent(in) :: front(width + below, *)
      real(wp), intent(in) :: known(below)      !! Solution of the rows below
      real(wp), intent(inout) :: x(width)       !! Right-hand side in, solution out
      integer :: c, height

      height = width + below
      if (.not. symmetric) then
         call take_right(width, below, front(1, width + 1), known, x)
         do c = width, 1, -1
            x(c) = x(c)/front(c, c)
            x(:c - 1) = x(:c - 1) - front(:c - 1, c)*x(c)
         end do
      else if (width > narrow) then
         if (below > 0) call dgemv("T", below, width, -1.0_wp, front(width + 1, 1), height, &
            & known, 1, 1.0_wp, x, 1)
         call dtrsv("L", "T", "N", width, front, height, x, 1)
      else
         do c = 1, width
            x(c) = x(c)/front(c, c)
         end do
         do c = width - 2, 1, -3
            call take_rows(below, front(width + 1, c), front(width + 1, c + 1), &
               & front(width + 1, c + 2), known, x(c))
            if (c + 2 < width) call take_rows(width - c - 2, front(c + 3, c), front(c + 3, c + 1), &
               & front(c + 3, c + 2), x(c + 3), x(c))
            x(c + 1) = x(c + 1) - front(c + 2, c + 1)*x(c + 2)
            x(c) = x(c) - front(c + 1, c)*x(c + 1) - front(c + 2, c)*x(c + 2)
         end do
      end if
   end subroutine substitute_up

   !> Take products of three columns and a vector from three numbers
   pure subroutine take_rows(n, one, two, three, known, x)
      integer, intent(in) :: n                            !! Rows
      real(wp), intent(in) :: one(n), two(n), three(n)    !! The columns
      real(wp), intent(in) :: known(n)                    !! The vector
      real(wp), intent(inout) :: x(3)                     !! The numbers
      integer :: i

      do i = 1, n
         x(1) = x(1) - one(i)*known(i)
         x(2) = x(2) - two(i)*known(i)
         x(3) = x(3) - three(i)*known(i)
      end do
   end subroutine take_rows

   !> Take what stands to the right of the diagonal of a panel
   pure subroutine take_right(width, below, right, known, x)
      integer, intent(in) :: width, below
      real(wp), intent(in) :: right(width, *)  !! The rows to the right: (width, below)
      real(wp), intent(in) :: known(below)     !! Solution of the rows below
      real(wp), intent(inout) :: x(width)      !! Vector that they are subtracted from
      integer :: c

      if (below == 0) return
      if (width > narrow) then
         call dgemv("N", width, below, -1.0_wp, right, width, known, 1, 1.0_wp, x, 1)
      else
         do c = 1, below, 3
            call take_triple(width, right(1, c), right(1, c + 1), right(1, c + 2), &
               & known(c:c + 2), x)
         end do
      end if
   end subroutine take_right
end module dda_fronts
