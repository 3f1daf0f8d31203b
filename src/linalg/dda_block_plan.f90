!> Structure of a factor: columns in panels
!>
!> A panel is a group of columns that follow one another and have the same rows below: what is
!> eliminated by it are products of dense matrices. Columns whose rows differ a little share a
!> panel where its zeros cost less than panels apart.
module dda_block_plan
   use dda_block_matrix, only : block_matrix_t
   use dda_kinds, only : wp
   use dda_sort, only : list_by_owner
   implicit none
   private

   public :: elimination_plan_t, plan_panels, find_rows

   !> Panels; a place is one in the order of elimination
   type :: elimination_plan_t
      integer :: n_dof = 0              !! Unknowns of one block
      logical :: symmetric = .true.     !! True if the matrix is symmetric
      integer, allocatable :: block(:)  !! Block at each place: (n_block)
      integer, allocatable :: panel(:)  !! Panel of each place: (n_block)
      integer, allocatable :: below(:)  !! Rows below the diagonal of each column: (n_block)
      integer, allocatable :: first(:)  !! First place of each panel, and one beyond: (n_panel + 1)
      integer, allocatable :: start(:)  !! First number of each panel, and one beyond
      integer, allocatable :: first_row(:)  !! First of each panel's rows, and one beyond
      integer, allocatable :: row(:)    !! Rows of the panels below their diagonals, rising in each
      !> Panel of each coupling, and its row and column there, as blocks from zero on: (3, n_entry)
      integer, allocatable :: given(:, :)
      !> Most rows of a panel, below its diagonal and altogether, as blocks
      integer :: most_rows = 0, highest = 0
   end type elimination_plan_t

   !> Maximum number of unknowns per panel
   integer, parameter :: most_columns = 144

contains

   !> Lay out the panels of a matrix
   pure subroutine plan_panels(matrix, plan)
      type(block_matrix_t), intent(in) :: matrix  !! The matrix, of which the pattern counts
      type(elimination_plan_t), intent(out) :: plan
      integer :: first(size(matrix%place) + 1)  !! First coupling of each row, and one beyond
      integer :: parent(size(matrix%place))     !! Column that each goes into first; 0 for a root
      integer, allocatable :: column(:)         !! Columns of the couplings, row by row
      integer :: i

      plan%n_dof = matrix%n_dof
      plan%symmetric = matrix%symmetric
      allocate (plan%block(size(parent)), plan%panel(size(parent)), plan%below(size(parent)))
      plan%block(matrix%place) = [(i, i=1, size(parent))]
      call list_by_owner(matrix%place(matrix%pair(1, :)), first, column)
      column = matrix%place(matrix%pair(2, column))
      call grow_tree(first, column, parent, plan%below)
      call choose_panels(plan%n_dof, parent, plan%below, plan%first, plan%panel)
      call list_rows(first, column, parent, plan)
      call lay_out(plan)
      call list_given(matrix%pair, matrix%place, plan)
   end subroutine plan_panels

   !> Elimination tree and numbers of rows (Liu 1990): a row has its couplings, and from the column
   !> of each the way to the root of the tree
   pure subroutine grow_tree(first, column, parent, below)
      integer, intent(in) :: first(:), column(:)  !! Couplings by rows
      integer, intent(out) :: parent(:)  !! Column that each goes into: (n_block)
      integer, intent(out) :: below(:)  !! Rows below the diagonal of each column: (n_block)
      integer :: g, i, j, seen(size(parent))

      parent = 0
      below = 0
      do i = 1, size(parent)
         seen(i) = i
         do g = first(i), first(i + 1) - 1
            j = column(g)
            do while (seen(j) /= i)
               seen(j) = i
               below(j) = below(j) + 1
               if (parent(j) == 0) parent(j) = i
               j = parent(j)
            end do
         end do
      end do
   end subroutine grow_tree

   !> Group columns: a panel takes the one before it in where that saves work
   pure subroutine choose_panels(n_dof, parent, below, first, panel)
      integer, intent(in) :: n_dof  !! Unknowns of one block
      integer, intent(in) :: parent(:), below(:)  !! Rows of each column
      integer, allocatable, intent(out) :: first(:)  !! First column of each panel
      integer, intent(out) :: panel(:)  !! Panel of each column: (n_block)
      integer :: head(size(panel) + 1), j, m, n, next
      real(wp) :: cost(size(panel)), joint

      n = 0
      do j = 1, size(panel)
         n = n + 1
         head(n) = j
         cost(n) = work(1, below(j))
         do while (n > 1)
            m = j - head(n - 1) + 1
            next = parent(head(n) - 1)
            if (next == 0 .or. next > j .or. m*n_dof > most_columns) exit
            joint = work(m, below(j))
            if (joint > cost(n - 1) + cost(n)) exit
            n = n - 1
            cost(n) = joint
         end do
      end do
      head(n + 1) = size(panel) + 1
      first = head(:n + 1)
      do j = 1, n
         panel(first(j):first(j + 1) - 1) = j
      end do
   end subroutine choose_panels

   !> Cost of a panel, in products of two blocks: its own, those that go to other panels and the
   !> places of these, its numbers in substitutions, and a constant. Measured on
   !> walls of 36 to 10000 blocks: times hardly change where these figures are halved or doubled
   pure real(wp) function work(n_column, n_row)
      integer, intent(in) :: n_column  !! Its columns
      integer, intent(in) :: n_row     !! Its rows below the diagonal
      real(wp), parameter :: per_entry = 3.0_wp, per_target = 1.0_wp, per_panel = 20.0_wp
      real(wp) :: c, r

      c = real(n_column, wp)
      r = real(n_row, wp)
      work = c*(c*c - 1.0_wp)/6.0_wp + r*c*(c - 1.0_wp)/2.0_wp &
         & + 0.5_wp*r*(r + 1.0_wp)*(c + per_target) &
         & + per_entry*c*(0.5_wp*(c + 1.0_wp) + r) + per_panel
   end function work

   !> Rows of each panel: those of its last column
   pure subroutine list_rows(first, column, parent, plan)
      integer, intent(in) :: first(:), column(:), parent(:)  !! Couplings by rows, tree
      type(elimination_plan_t), intent(inout) :: plan
      integer :: g, i, j, next(size(plan%first)), p, seen(size(parent))

      next(1) = 1
      do p = 1, size(next) - 1
         next(p + 1) = next(p) + plan%below(plan%first(p + 1) - 1)
      end do
      plan%first_row = next
      ! one more: where a last panel without rows would begin
      allocate (plan%row(next(size(next))), source=1)
      seen = 0
      do i = 1, size(parent)
         do g = first(i), first(i + 1) - 1
            j = plan%first(plan%panel(column(g)) + 1) - 1
            do while (j < i)
               if (seen(j) == i) exit
               seen(j) = i
               p = plan%panel(j)
               plan%row(next(p)) = i
               next(p) = next(p) + 1
               j = plan%first(plan%panel(parent(j)) + 1) - 1
            end do
         end do
      end do
   end subroutine list_rows

   !> Lay out the numbers: the columns of a panel, and behind them, where the matrix is not
   !> symmetric, its rows to the right of the diagonal
   pure subroutine lay_out(plan)
      type(elimination_plan_t), intent(inout) :: plan
      integer :: below, p, width

      allocate (plan%start(size(plan%first)))
      plan%start(1) = 1
      do p = 1, size(plan%first) - 1
         width = plan%first(p + 1) - plan%first(p)
         below = plan%first_row(p + 1) - plan%first_row(p)
         plan%start(p + 1) = plan%start(p) &
            & + plan%n_dof**2*width*(width + merge(1, 2, plan%symmetric)*below)
         plan%most_rows = max(plan%most_rows, below)
         plan%highest = max(plan%highest, width + below)
      end do
   end subroutine lay_out

   !> Where the couplings of the matrix stand in the panels
   pure subroutine list_given(pair, place, plan)
      integer, intent(in) :: pair(:, :)                !! Coupled blocks: (2, n_entry)
      integer, intent(in) :: place(:)                  !! Place of each block: (n_block)
      type(elimination_plan_t), intent(inout) :: plan  !! The plan; receives the couplings
      integer :: at(1), e, n, p

      allocate (plan%given(3, size(pair, 2)))
      do e = 1, size(pair, 2)
         p = plan%panel(place(pair(2, e)))
         call find_rows(plan, p, place(pair(1:1, e)), at, n)
         plan%given(:, e) = [p, at, place(pair(2, e)) - plan%first(p)]
      end do
   end subroutine list_given

   !> Places of rows in a panel
   pure subroutine find_rows(plan, t, row, at, n)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: t       !! The panel
      integer, intent(in) :: row(:)  !! The rows, of which it has all
      integer, intent(out) :: at(:)  !! Their places from zero on
      integer, intent(out) :: n      !! Number of those among its columns
      integer :: i, k

      n = 0
      k = plan%first_row(t)
      do i = 1, size(row)
         if (row(i) < plan%first(t + 1)) then
            at(i) = row(i) - plan%first(t)
            n = i
         else
            do while (plan%row(k) /= row(i))
               k = k + 1
            end do
            at(i) = k - plan%first_row(t) + plan%first(t + 1) - plan%first(t)
         end if
      end do
   end subroutine find_rows
end module dda_block_plan
