!> Factor of the stiffness matrix in numbers of twice the digits, for springs whose stiffness
!> spreads over more decades than working precision has
module dda_wide_factor
   use dda_block_factor, only : block_factor_t
   use dda_joint_rays, only : joint_rays_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: wide_factor_t, factorise_wide, substitute_wide

   !> Kind of numbers with 30 digits or more
   integer, parameter :: qp = selected_real_kind(30)

   !> L D L' by 3 by 3 blocks; the pattern is that of the factor in working precision
   type :: wide_factor_t
      !> Entries of L below the diagonal: (3, 3, n_lower)
      real(qp), allocatable :: lower(:, :, :)
      !> Diagonal blocks, then the inverses of their triangular factors: (3, 3, n_block)
      real(qp), allocatable :: diagonal(:, :, :)
      !> Pivots: (3, n_block)
      real(qp), allocatable :: pivot(:, :)
      !> Work space: (3, n_block)
      real(qp), allocatable :: x(:, :)
      !> Whether it can be used
      logical :: usable = .false.
   end type wide_factor_t

contains

   !> Assemble springs along all rays, and factor
   pure subroutine factorise_wide(rays, stiffness, plan, wide)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Stiffness of each: (n_side, n_joint)
      real(wp), intent(in) :: stiffness(:, :)
      !> Pattern
      type(block_factor_t), intent(in) :: plan
      !> The factor
      type(wide_factor_t), intent(inout) :: wide
      real(qp) :: unscaled(3, 3)
      integer :: c, i, j, k, m, n, t

      if (.not. allocated(wide%lower)) then
         n = size(plan%block)
         allocate (wide%lower(3, 3, size(plan%row)), wide%diagonal(3, 3, n))
         allocate (wide%pivot(3, n), wide%x(3, n))
      end if
      call assemble(rays, stiffness, plan, wide)
      do j = 1, size(plan%block)
         call factor_diagonal(wide%diagonal(:, :, j), wide%pivot(:, j), wide%usable)
         if (.not. wide%usable) return
         do m = plan%first_below(j), plan%first_below(j + 1) - 1
            k = plan%row(m)
            unscaled = matmul(wide%lower(:, :, m), transpose(wide%diagonal(:, :, j)))
            do c = 1, 3
               wide%lower(:, c, m) = unscaled(:, c)/wide%pivot(c, j)
            end do
            wide%diagonal(:, :, k) = wide%diagonal(:, :, k) &
               & - matmul(unscaled, transpose(wide%lower(:, :, m)))
            ! rows above this one have their entries of L, and their columns have this row
            do i = plan%first_below(j), m - 1
               t = entry_of(plan, k, plan%row(i))
               wide%lower(:, :, t) = wide%lower(:, :, t) &
                  & - matmul(unscaled, transpose(wide%lower(:, :, i)))
            end do
         end do
      end do
   end subroutine factorise_wide

   !> Entry of L in a row and a column that have one
   pure integer function entry_of(plan, row, column) result(entry)
      !> Pattern
      type(block_factor_t), intent(in) :: plan
      !> Row and column, as places
      integer, intent(in) :: row, column
      integer :: high, middle

      entry = plan%first_below(column)
      high = plan%first_below(column + 1) - 1
      do while (entry < high)
         middle = (entry + high)/2
         if (plan%row(middle) < row) then
            entry = middle + 1
         else
            high = middle
         end if
      end do
   end function entry_of

   !> Sum of all springs
   pure subroutine assemble(rays, stiffness, plan, wide)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Stiffness of each: (n_side, n_joint)
      real(wp), intent(in) :: stiffness(:, :)
      !> Pattern
      type(block_factor_t), intent(in) :: plan
      !> Receives the matrix
      type(wide_factor_t), intent(inout) :: wide
      real(qp) :: arm(3, 2), pushed(3)
      integer :: at(2), c, e, i, j, place(0:size(plan%block)), side

      place(0) = 0
      place(plan%block) = [(i, i=1, size(plan%block))]
      wide%lower = 0.0_qp
      wide%diagonal = 0.0_qp
      do j = 1, size(rays%block, 2)
         at = place(rays%block(:, j))
         e = 0
         if (all(at > 0)) e = entry_of(plan, maxval(at), minval(at))
         do i = 1, size(stiffness, 1)
            arm = reshape(real(rays%arm(i, :, j), qp), [3, 2])
            do side = 1, 2
               if (at(side) == 0) cycle
               do c = 1, 3
                  pushed = stiffness(i, j)*arm(:, side)*arm(c, side)
                  wide%diagonal(:, c, at(side)) = wide%diagonal(:, c, at(side)) + pushed
               end do
            end do
            if (e == 0) cycle
            side = maxloc(at, 1)
            do c = 1, 3
               wide%lower(:, c, e) = wide%lower(:, c, e) &
                  & + stiffness(i, j)*arm(:, side)*arm(c, 3 - side)
            end do
         end do
      end do
   end subroutine assemble

   !> Factor a diagonal block into T D T'; the inverse of T is kept
   pure subroutine factor_diagonal(block, pivot, definite)
      !> The block in, the inverse of T out: (3, 3)
      real(qp), intent(inout) :: block(:, :)
      !> D: (3)
      real(qp), intent(out) :: pivot(:)
      !> Whether the block was positive definite
      logical, intent(out) :: definite
      real(qp) :: t21, t31, t32, left(3, 3)

      left = block
      pivot(1) = left(1, 1)
      pivot(2:) = 0.0_qp
      definite = pivot(1) > 0.0_qp
      if (.not. definite) return
      t21 = left(2, 1)/pivot(1)
      t31 = left(3, 1)/pivot(1)
      pivot(2) = left(2, 2) - t21*left(2, 1)
      definite = pivot(2) > 0.0_qp
      if (.not. definite) return
      t32 = (left(3, 2) - t31*left(2, 1))/pivot(2)
      pivot(3) = left(3, 3) - t31*left(3, 1) - t32*t32*pivot(2)
      definite = pivot(3) > 0.0_qp
      block(:, 1) = [1.0_qp, -t21, t32*t21 - t31]
      block(:, 2) = [0.0_qp, 1.0_qp, -t32]
      block(:, 3) = [0.0_qp, 0.0_qp, 1.0_qp]
   end subroutine factor_diagonal

   !> Solve for one right-hand side, and find the rates at which the solution opens the rays: they
   !> may be small differences of large motions
   pure subroutine substitute_wide(rays, plan, wide, x, rate)
      !> The rays
      type(joint_rays_t), intent(in) :: rays
      !> Pattern
      type(block_factor_t), intent(in) :: plan
      !> The factor
      type(wide_factor_t), intent(inout) :: wide
      !> Right-hand side in, solution out: (3, n_block)
      real(wp), intent(inout) :: x(:, :)
      !> Rates of opening: (n_side, n_joint)
      real(wp), intent(out) :: rate(:, :)
      real(qp) :: motion(3, 0:size(plan%block))
      integer :: j, k, n

      n = size(plan%block)
      wide%x = x(:, plan%block)
      do j = 1, n
         wide%x(:, j) = matmul(wide%diagonal(:, :, j), wide%x(:, j))
         do k = plan%first_below(j), plan%first_below(j + 1) - 1
            associate (y => wide%x(:, plan%row(k)))
               y = y - matmul(wide%lower(:, :, k), wide%x(:, j))
            end associate
         end do
      end do
      wide%x = wide%x/wide%pivot
      do j = n, 1, -1
         do k = plan%first_below(j), plan%first_below(j + 1) - 1
            wide%x(:, j) = wide%x(:, j) - matmul(wide%x(:, plan%row(k)), wide%lower(:, :, k))
         end do
         wide%x(:, j) = matmul(wide%x(:, j), wide%diagonal(:, :, j))
         motion(:, plan%block(j)) = wide%x(:, j)
      end do
      motion(:, 0) = 0.0_qp
      x = real(motion(:, 1:), wp)
      do j = 1, size(rate, 2)
         rate(:, j) = real(matmul(real(rays%arm(:, 1:3, j), qp), motion(:, rays%block(1, j))) &
            & + matmul(real(rays%arm(:, 4:6, j), qp), motion(:, rays%block(2, j))), wp)
      end do
   end subroutine substitute_wide
end module dda_wide_factor
