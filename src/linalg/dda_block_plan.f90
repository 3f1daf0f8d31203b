!> Which numbers a factor has, and where: columns in panels
!>
!> A panel is a group of columns that follow one another and have the same rows below: what is
!> eliminated by it are products of dense matrices. Columns whose rows differ a little share a
!> panel where its zeros cost less than panels apart. All is counted in triples of unknowns: a block
!> has one or two.
module dda_block_plan
   use dda_block_matrix, only : block_matrix_t, by_branches, elimination_t, new_elimination, &
      & products
   use dda_block_order, only : dissected_order, smallest_part
   use dda_kinds, only : small, wp
   use dda_sort, only : list_by_owner
   implicit none
   private

   public :: coupling_places_t, elimination_plan_t, most_columns, plan_panels, choose_order
   public :: list_places, side_of_rows

   !> Panels; a place is one in the order of elimination
   type :: elimination_plan_t
      !> Triples of one block
      integer :: n_triple = 0
      !> Block at each place: (n_block)
      integer, allocatable :: block(:)
      !> First column of each panel, and one beyond the last, as triples: (n_panel + 1)
      integer, allocatable :: first(:)
      !> Place of the first number of each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable :: start(:)
      !> First of each panel's rows in the list, and one beyond the last: (n_panel + 1)
      integer, allocatable :: first_row(:)
      !> Rows of the panels below their diagonals, as triples, rising in each panel
      integer, allocatable :: row(:)
      !> First source of each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable :: first_source(:)
      !> Panels that have rows in a panel's columns, and the first of these rows in the list: (2, :)
      integer, allocatable :: source(:, :)
      !> First coupling of the matrix in each panel, and one beyond the last: (n_panel + 1)
      integer, allocatable :: first_given(:)
      !> Couplings of the matrix, negative where transposed, and the place of their first number:
      !> (2, n_entry)
      integer, allocatable :: given(:, :)
      !> Most rows of a panel, those of its diagonal among them, as triples
      integer :: highest = 0
   end type elimination_plan_t

   !> Where what is added up in the factor itself has its numbers
   type :: coupling_places_t
      !> First number of the diagonal block of each block: (n_block)
      integer, allocatable :: diagonal(:)
      !> First number of each coupling, negative for what is transposed there, 0 for nothing:
      !> (n_coupling)
      integer, allocatable :: coupling(:)
      !> Whether the second block of a coupling has its rows: (n_coupling)
      logical(small), allocatable :: second_is_row(:)
   end type coupling_places_t

   !> A matrix that is no wider than this in the narrow order is eliminated in it without a thought:
   !> no other order does with much less
   integer, parameter :: narrow = 3
   !> Fewer blocks are not dissected
   integer, parameter :: few = 500
   !> Most columns of a panel, as triples: more gain nothing
   integer, parameter :: most_columns = 48

contains

   !> Lay out the panels of a matrix
   pure subroutine plan_panels(matrix, plan)
      type(block_matrix_t), intent(in) :: matrix  !! The matrix, of which the pattern counts
      type(elimination_plan_t), intent(out) :: plan
      type(elimination_t) :: elimination
      integer :: panel(size(matrix%place)), i

      call choose_order(matrix, elimination)
      plan%n_triple = matrix%n_dof/3
      allocate (plan%block(size(panel)))
      plan%block(elimination%place) = [(i, i=1, size(panel))]
      call choose_panels(plan%n_triple, elimination, plan%first, panel)
      call list_rows(elimination, panel, plan)
      call list_sources(panel, plan)
      call count_in_triples(plan)
      call list_given(matrix%pair, elimination%place, panel, plan)
   end subroutine plan_panels

   !> An order of elimination. The narrow order is eliminated from both ends to the middle; where
   !> that is wide, minimum degree or dissection give the order, whichever takes fewer products
   pure subroutine choose_order(matrix, elimination)
      type(block_matrix_t), intent(in) :: matrix
      type(elimination_t), intent(out) :: elimination
      type(elimination_t) :: other
      integer :: n

      n = size(matrix%place)
      associate (place => matrix%place, pair => matrix%pair)
         if (matrix%width <= narrow) then
            call new_elimination(merge(2*place - 1, 2*(n + 1 - place), 2*place <= n + 1), pair, &
               & elimination)
            return
         end if
         call new_elimination(by_branches(dissected_order(n, pair, n), pair), pair, elimination)
         if (n < few) return
         call new_elimination(by_branches(dissected_order(n, pair, smallest_part), pair), pair, &
            & other)
         if (products(other) < products(elimination)) elimination = other
      end associate
   end subroutine choose_order

   !> Group columns: a panel takes the one before it in where that saves work
   pure subroutine choose_panels(n_triple, elimination, first, panel)
      integer, intent(in) :: n_triple  !! Triples of one block
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
            if (parent == 0 .or. parent > j .or. m*n_triple > most_columns) exit
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
   pure subroutine list_rows(elimination, panel, plan)
      type(elimination_t), intent(in) :: elimination
      integer, intent(in) :: panel(:)
      type(elimination_plan_t), intent(inout) :: plan
      integer, dimension(size(panel)) :: seen
      integer, dimension(size(plan%first)) :: next
      integer :: g, i, j, pass

      allocate (plan%first_row(size(next)))
      next = 0
      do pass = 1, 2
         seen = 0
         do i = 1, size(panel)
            do g = elimination%first(i), elimination%first(i + 1) - 1
               j = plan%first(panel(elimination%column(g)) + 1) - 1
               do while (j < i)
                  if (seen(j) == i) exit
                  seen(j) = i
                  if (pass == 2) plan%row(next(panel(j))) = i
                  next(panel(j)) = next(panel(j)) + 1
                  j = plan%first(panel(elimination%parent(j)) + 1) - 1
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

   !> Panels that have rows in each panel's columns
   pure subroutine list_sources(panel, plan)
      integer, intent(in) :: panel(:)
      !> The plan with its rows; receives the sources
      type(elimination_plan_t), intent(inout) :: plan
      integer :: above(size(plan%row)), target(size(plan%row)), i, k
      integer, allocatable :: row(:)

      target = 0
      do i = 1, size(plan%first) - 1
         do k = plan%first_row(i), plan%first_row(i + 1) - 1
            above(k) = i
            target(k) = panel(plan%row(k))
            if (k == plan%first_row(i)) cycle
            if (target(k) == panel(plan%row(k - 1))) target(k) = 0
         end do
      end do
      allocate (plan%first_source(size(plan%first)))
      call list_by_owner(target, plan%first_source, row)
      allocate (plan%source(2, size(row)))
      plan%source(1, :) = above(row)
      plan%source(2, :) = row
   end subroutine list_sources

   !> Turn blocks into triples, and lay out the numbers
   pure subroutine count_in_triples(plan)
      type(elimination_plan_t), intent(inout) :: plan
      integer :: i, k, height, width

      associate (n => plan%n_triple)
         plan%row = [((n*(plan%row(i) - 1) + k, k=1, n), i=1, size(plan%row))]
         plan%first_row = n*(plan%first_row - 1) + 1
         plan%source(2, :) = n*(plan%source(2, :) - 1) + 1
         plan%first = n*(plan%first - 1) + 1
      end associate
      allocate (plan%start(size(plan%first)))
      plan%start(1) = 1
      do i = 1, size(plan%first) - 1
         width = plan%first(i + 1) - plan%first(i)
         height = width + plan%first_row(i + 1) - plan%first_row(i)
         plan%start(i + 1) = plan%start(i) + 9*height*width
         plan%highest = max(plan%highest, height)
      end do
   end subroutine count_in_triples

   !> Where the couplings of the matrix lie in the panels
   pure subroutine list_given(pair, place, panel, plan)
      integer, intent(in) :: pair(:, :)                !! Coupled blocks: (2, n_entry)
      integer, intent(in) :: place(:)                  !! Place of each block: (n_block)
      integer, intent(in) :: panel(:)                  !! Panel of each place: (n_block)
      type(elimination_plan_t), intent(inout) :: plan  !! The plan; receives the couplings
      integer :: at(size(place)), g, i, p, width, height
      integer, allocatable :: coupling(:)

      allocate (plan%first_given(size(plan%first)), plan%given(2, size(pair, 2)))
      call list_by_owner(panel(min(place(pair(1, :)), place(pair(2, :)))), plan%first_given, &
         & coupling)
      plan%given(1, :) = merge(coupling, -coupling, &
         & place(pair(1, coupling)) > place(pair(2, coupling)))
      do p = 1, size(plan%first) - 1
         width = plan%first(p + 1) - plan%first(p)
         height = width + plan%first_row(p + 1) - plan%first_row(p)
         associate (n => plan%n_triple, first => (plan%first(p) - 1)/plan%n_triple)
            at(first + 1:first + width/n) = [(i, i=0, width - 1, n)]
            at((plan%row(plan%first_row(p):plan%first_row(p + 1) - 1:n) - 1)/n + 1) = &
               & [(i, i=width, height - 1, n)]
         end associate
         do g = plan%first_given(p), plan%first_given(p + 1) - 1
            associate (ends => place(pair(:, abs(plan%given(1, g)))))
               plan%given(2, g) = plan%start(p) + 9*(at(maxval(ends)) + height*at(minval(ends)))
            end associate
         end do
      end do
   end subroutine list_given

   !> Where matrices of three unknowns a block have their numbers in the panels: the first number of
   !> each diagonal block and of each coupling, negative for one that is transposed
   pure subroutine list_places(plan, diagonal, coupling)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(out) :: diagonal(:)  !! Of diagonal blocks: (n_block)
      integer, intent(out) :: coupling(:)  !! Of couplings: (n_entry)
      integer :: c, height, p, width

      do p = 1, size(plan%first) - 1
         width = plan%first(p + 1) - plan%first(p)
         height = width + plan%first_row(p + 1) - plan%first_row(p)
         diagonal(plan%block(plan%first(p):plan%first(p + 1) - 1)) = &
            & [(plan%start(p) + 9*c*(height + 1), c=0, width - 1)]
      end do
      coupling(abs(plan%given(1, :))) = sign(plan%given(2, :), plan%given(1, :))
   end subroutine list_places

   !> The block of a coupling, 1 or 2, that has the rows of what stands in its place
   pure integer function side_of_rows(places, coupling) result(side)
      type(coupling_places_t), intent(in) :: places
      integer, intent(in) :: coupling  !! Its number

      side = merge(2, 1, places%second_is_row(coupling) .neqv. places%coupling(coupling) < 0)
   end function side_of_rows
end module dda_block_plan
