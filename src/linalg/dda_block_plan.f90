!> Structure of a factor: columns in panels
!>
!> A panel is a group of columns that follow one another and have the same rows below: what is
!> eliminated by it are products of dense matrices. Columns whose rows differ a little share a
!> panel where its zeros cost less than panels apart.
module dda_block_plan
   use dda_block_matrix, only : block_matrix_t, by_branches, elimination_t, new_elimination
   use dda_kinds, only : wp
   use dda_minimum_degree, only : minimum_degree_order
   implicit none
   private

   public :: elimination_plan_t, plan_panels, choose_order, find_rows

   !> Panels; a place is one in the order of elimination
   type :: elimination_plan_t
      !> Unknowns of one block
      integer :: n_dof = 0
      !> Whether the matrix is symmetric
      logical :: symmetric = .true.
      !> Block at each place: (n_block)
      integer, allocatable :: block(:)
      !> Panel of each place: (n_block)
      integer, allocatable :: panel(:)
      !> First place of each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable :: first(:)
      !> First number of each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable :: start(:)
      !> First of each panel's rows in the list, and one beyond the last: (n_panel + 1)
      integer, allocatable :: first_row(:)
      !> Rows of the panels below their diagonals, as places, rising in each panel
      integer, allocatable :: row(:)
      !> Panel of each coupling, and where it stands in it: row and column, as blocks from zero on;
      !> the panel is negative where the coupling's first block has the column: (3, n_entry)
      integer, allocatable :: given(:, :)
      !> Most rows of a panel, below its diagonal and altogether, as blocks
      integer :: most_rows = 0, highest = 0
   end type elimination_plan_t

   !> Bandwidth up to which the narrow order is used directly
   integer, parameter :: narrow = 3
   !> Maximum number of unknowns per panel
   integer, parameter :: most_columns = 144

contains

   !> Lay out the panels of a matrix
   pure subroutine plan_panels(matrix, plan)
      type(block_matrix_t), intent(in) :: matrix  !! The matrix, of which the pattern counts
      type(elimination_plan_t), intent(out) :: plan
      type(elimination_t) :: elimination
      integer :: i, n

      n = size(matrix%place)
      call choose_order(matrix, elimination)
      plan%n_dof = matrix%n_dof
      plan%symmetric = matrix%symmetric
      allocate (plan%block(n), plan%panel(n))
      plan%block(elimination%place) = [(i, i=1, n)]
      call choose_panels(plan%n_dof, elimination, plan%first, plan%panel)
      call list_rows(elimination, plan)
      call lay_out(plan)
      call list_given(matrix%pair, elimination%place, plan)
   end subroutine plan_panels

   !> An order of elimination: a narrow one from both ends to the middle, of wide graphs one by
   !> minimum degree
   pure subroutine choose_order(matrix, elimination)
      type(block_matrix_t), intent(in) :: matrix
      type(elimination_t), intent(out) :: elimination

      associate (n => size(matrix%place), place => matrix%place, pair => matrix%pair)
         if (matrix%width <= narrow) then
            call new_elimination(merge(2*place - 1, 2*(n + 1 - place), 2*place <= n + 1), pair, &
               & elimination)
         else
            call new_elimination(by_branches(minimum_degree_order(n, pair), pair), pair, &
               & elimination)
         end if
      end associate
   end subroutine choose_order

   !> Group columns: a panel takes the one before it in where that saves work
   pure subroutine choose_panels(n_dof, elimination, first, panel)
      integer, intent(in) :: n_dof  !! Unknowns of one block
      type(elimination_t), intent(in) :: elimination
      !> First column of each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable, intent(out) :: first(:)
      integer, intent(out) :: panel(:)  !! Panel of each column: (n_block)
      integer :: head(size(panel) + 1), j, m, n, parent
      real(wp) :: cost(size(panel)), joint

      n = 0
      do j = 1, size(panel)
         n = n + 1
         head(n) = j
         cost(n) = work(1, elimination%below(j))
         do while (n > 1)
            m = j - head(n - 1) + 1
            parent = elimination%parent(head(n) - 1)
            if (parent == 0 .or. parent > j .or. m*n_dof > most_columns) exit
            joint = work(m, elimination%below(j))
            if (joint > cost(n - 1) + cost(n)) exit
            n = n - 1
            cost(n) = joint
         end do
      end do
      head(n + 1) = size(panel) + 1
      allocate (first(n + 1), source=head(:n + 1))
      do j = 1, n
         panel(first(j):first(j + 1) - 1) = j
      end do
   end subroutine choose_panels

   !> What a panel costs, in products of two blocks: its own, those that go to other panels and the
   !> places of these, what its numbers cost in substitutions, and what any panel costs. Measured on
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
   pure subroutine list_rows(elimination, plan)
      type(elimination_t), intent(in) :: elimination
      type(elimination_plan_t), intent(inout) :: plan
      integer, dimension(size(plan%panel)) :: seen
      integer, dimension(size(plan%first)) :: next
      integer :: g, i, j, pass

      allocate (plan%first_row(size(next)))
      next = 0
      do pass = 1, 2
         seen = 0
         do i = 1, size(plan%panel)
            do g = elimination%first(i), elimination%first(i + 1) - 1
               j = plan%first(plan%panel(elimination%column(g)) + 1) - 1
               do while (j < i)
                  if (seen(j) == i) exit
                  seen(j) = i
                  if (pass == 2) plan%row(next(plan%panel(j))) = i
                  next(plan%panel(j)) = next(plan%panel(j)) + 1
                  j = plan%first(plan%panel(elimination%parent(j)) + 1) - 1
               end do
            end do
         end do
         if (pass == 2) exit
         plan%first_row(1) = 1
         do i = 1, size(next) - 1
            plan%first_row(i + 1) = plan%first_row(i) + next(i)
         end do
         next = plan%first_row
         ! one more: where a last panel without rows would begin
         allocate (plan%row(plan%first_row(size(next))), source=1)
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
      integer :: e, k, p

      allocate (plan%given(3, size(pair, 2)))
      do e = 1, size(pair, 2)
         associate (low => minval(place(pair(:, e))), high => maxval(place(pair(:, e))))
            p = plan%panel(low)
            plan%given(:, e) = [p, high, low] - [0, plan%first(p), plan%first(p)]
            if (high >= plan%first(p + 1)) then
               k = plan%first_row(p)
               do while (plan%row(k) /= high)
                  k = k + 1
               end do
               plan%given(2, e) = k - plan%first_row(p) + plan%first(p + 1) - plan%first(p)
            end if
            if (place(pair(1, e)) == low) plan%given(1, e) = -p
         end associate
      end do
   end subroutine list_given

   !> Places of rows in a panel
   pure subroutine find_rows(plan, t, row, at, n)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: t       !! The panel
      integer, intent(in) :: row(:)  !! The rows, of which it has all
      integer, intent(out) :: at(:)  !! Their places from zero on
      integer, intent(out) :: n      !! How many are among its columns
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
