!> Factor L D L' of the barrier stiffness matrix in extended precision
!>
!> The plan is that of the factor in working precision. Few libraries have such numbers: the loops
!> are plain.
module dda_wide_factor
   use dda_block_plan, only : elimination_plan_t, find_rows
   use dda_kinds, only : wp
   implicit none
   private

   public :: rk, factorise_wide, substitute_wide

   !> Kind of numbers with 30 digits, or 18 if unavailable
   integer, parameter :: rk = merge(selected_real_kind(30), selected_real_kind(18), &
      & selected_real_kind(30) > 0)

contains

   !> Factor a matrix of three unknowns a block
   pure subroutine factorise_wide(plan, diagonal, coupling, number, usable)
      type(elimination_plan_t), intent(in) :: plan
      real(rk), intent(in) :: diagonal(:, :, :)  !! Diagonal blocks: (3, 3, n_block)
      !> Couplings, rows of the first block of each pair: (3, 3, n_entry)
      real(rk), intent(in) :: coupling(:, :, :)
      real(rk), allocatable, intent(inout) :: number(:)  !! Numbers of the panels
      logical, intent(out) :: usable                     !! True if all pivots are positive
      integer :: b, e, height, p

      if (.not. allocated(number)) allocate (number(plan%start(size(plan%start)) - 1))
      number = 0.0_rk
      do b = 1, size(plan%block)
         p = plan%panel(b)
         call add_block(b - plan%first(p), b - plan%first(p), diagonal(:, :, plan%block(b)), &
            & height_of(plan, p), number(plan%start(p)))
      end do
      do e = 1, size(plan%given, 2)
         p = plan%given(1, e)
         call add_block(plan%given(2, e), plan%given(3, e), coupling(:, :, e), &
            & height_of(plan, p), number(plan%start(p)))
      end do
      do p = 1, size(plan%first) - 1
         height = height_of(plan, p)
         call factor_panel(3*(plan%first(p + 1) - plan%first(p)), height, &
            & number(plan%start(p)), usable)
         if (.not. usable) return
         call change_others(plan, p, reshape(number(plan%start(p):plan%start(p + 1) - 1), &
            & [height, (plan%start(p + 1) - plan%start(p))/height]), number)
      end do
   end subroutine factorise_wide

   !> Rows of a panel, as unknowns
   pure integer function height_of(plan, p) result(height)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: p  !! The panel

      height = 3*(plan%first(p + 1) - plan%first(p) + plan%first_row(p + 1) - plan%first_row(p))
   end function height_of

   !> Add a block to a panel
   pure subroutine add_block(row, column, block, height, panel)
      integer, intent(in) :: row, column             !! Its place, as blocks from zero on
      real(rk), intent(in) :: block(3, 3)            !! The block
      integer, intent(in) :: height                  !! Rows of the panel
      real(rk), intent(inout) :: panel(height, *)    !! The panel

      panel(3*row + 1:3*row + 3, 3*column + 1:3*column + 3) = block &
         & + panel(3*row + 1:3*row + 3, 3*column + 1:3*column + 3)
   end subroutine add_block

   !> Factor a panel: D stands on the diagonal of L, whose own is ones
   pure subroutine factor_panel(width, height, panel, usable)
      integer, intent(in) :: width  !! Its columns
      integer, intent(in) :: height
      real(rk), intent(inout) :: panel(height, width)  !! The panel
      logical, intent(out) :: usable
      integer :: c, k

      do c = 1, width
         usable = panel(c, c) > 0.0_rk
         if (.not. usable) return
         do k = c + 1, width
            panel(k:, k) = panel(k:, k) - panel(k:, c)*(panel(k, c)/panel(c, c))
         end do
         panel(c + 1:, c) = panel(c + 1:, c)/panel(c, c)
      end do
   end subroutine factor_panel

   !> Take what a panel eliminates from those that have its rows
   pure subroutine change_others(plan, p, panel, number)
      type(elimination_plan_t), intent(in) :: plan
      integer, intent(in) :: p
      real(rk), intent(in) :: panel(:, :)  !! The panel: (height, width)
      real(rk), intent(inout), allocatable :: number(:)
      real(rk) :: share(size(panel, 1))
      integer :: at(plan%first_row(p + 1) - plan%first_row(p)), c, first, i, k, n, t, width

      width = size(panel, 2)
      n = 0
      do while (n < size(at))
         t = plan%panel(plan%row(plan%first_row(p) + n))
         i = n
         call find_rows(plan, t, plan%row(plan%first_row(p) + n:plan%first_row(p + 1) - 1), &
            & at(n + 1:), k)
         n = n + k
         do i = 3*i + 1, 3*n
            first = 3*((i - 1)/3) + 1
            share(first:3*size(at)) = 0.0_rk
            do c = 1, width
               share(first:3*size(at)) = share(first:3*size(at)) &
                  & + panel(width + first:, c)*(panel(width + i, c)*panel(c, c))
            end do
            c = plan%start(t) + height_of(plan, t)*(3*at((i + 2)/3) + i - first)
            do k = (i + 2)/3, size(at)
               associate (to => number(c + 3*at(k):c + 3*at(k) + 2))
                  to = to - share(3*k - 2:3*k)
               end associate
            end do
         end do
      end do
   end subroutine change_others

   !> Solve for one right-hand side
   pure subroutine substitute_wide(plan, number, x)
      type(elimination_plan_t), intent(in) :: plan
      real(rk), intent(in), allocatable :: number(:)
      real(rk), intent(inout) :: x(:, :)  !! Right-hand side in, solution out: (3, n_block)
      real(rk) :: y(3, size(x, 2)), z(3, plan%highest)
      integer :: i, n, p, width

      y = x(:, plan%block)
      n = size(plan%first) - 1
      do i = 1, 2*n
         p = min(i, 2*n + 1 - i)
         width = plan%first(p + 1) - plan%first(p)
         associate (row => plan%row(plan%first_row(p):plan%first_row(p + 1) - 1), &
            & own => y(:, plan%first(p):plan%first(p + 1) - 1))
            z(:, :width) = own
            z(:, width + 1:width + size(row)) = y(:, row)
            call substitute_panel(3*width, height_of(plan, p), number(plan%start(p)), i > n, z)
            own = z(:, :width)
            y(:, row) = z(:, width + 1:width + size(row))
         end associate
      end do
      x(:, plan%block) = y
   end subroutine substitute_wide

   !> Solve with L of a panel, or with D and the transpose of L
   pure subroutine substitute_panel(width, height, panel, back, z)
      integer, intent(in) :: width, height
      real(rk), intent(in) :: panel(height, width)  !! The panel
      logical, intent(in) :: back               !! True if with the transpose
      real(rk), intent(inout) :: z(height)      !! Right-hand side in, solution out
      integer :: c

      if (.not. back) then
         do c = 1, width
            z(c + 1:) = z(c + 1:) - panel(c + 1:, c)*z(c)
         end do
      else
         do c = width, 1, -1
            z(c) = z(c)/panel(c, c) - sum(panel(c + 1:, c)*z(c + 1:))
         end do
      end if
   end subroutine substitute_panel
end module dda_wide_factor
