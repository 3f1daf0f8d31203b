!> Times the factor of walls: lay out, factorise and substitute, symmetric and not
!>
!>    factor_bench [6] [UNITSxCOURSES ...]
!>
!> "6" lets each block have 6 unknowns. Times of the processor, the least of several.
program factor_bench
   use, intrinsic :: iso_fortran_env, only : output_unit
   use dda_block_factor, only : block_factor_t, factorise, plan_factor, substitute
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dense_reference, only : products
   use graph_wall, only : new_wall
   use wall_stiffness, only : product_of, set_stiffness
   implicit none

   !> Walls where none is asked for
   character(len=7), parameter :: usual(5) = &
      & ["4x8    ", "10x10  ", "20x20  ", "40x40  ", "100x100"]
   !> Time that each measurement may take [s]
   real(wp), parameter :: budget = 0.5_wp
   integer :: i, n_dof, n
   character(len=20) :: argument

   n_dof = 3
   n = 0
   write (output_unit, "(a)") "wall     blocks  entries products/block  plan us " &
      & //"  factor us   L U us   substitute us   L U us   residual   L U"
   do i = 1, command_argument_count()
      call get_command_argument(i, argument)
      if (argument == "6") then
         n_dof = 6
      else
         n = n + 1
         call measure(argument)
      end if
   end do
   if (n == 0) then
      do i = 1, size(usual)
         call measure(usual(i))
      end do
   end if

contains

   !> One line for a wall
   subroutine measure(wall)
      !> Bricks of a course, "x", courses
      character(len=*), intent(in) :: wall
      type(joint_graph_t) :: graph
      type(block_matrix_t) :: matrix(2)
      type(block_factor_t) :: factor(2)
      real(wp), allocatable :: weight(:, :), push(:, :), x(:, :), load(:, :)
      real(wp) :: plan, make(2), solve(2), residual(2)
      integer :: cross, units, courses, k

      cross = index(wall, "x")
      read (wall(:cross - 1), *) units
      read (wall(cross + 1:), *) courses
      ! a wall of one brick a course is a tower: the chain of an arch
      call new_wall(units, courses, 0.6_wp, graph, weight, push)
      allocate (load(n_dof, graph%n_block), source=1.0_wp)
      load(:3, :) = weight + push
      do k = 1, 2
         call set_stiffness(graph, n_dof, k == 1, matrix(k))
         plan = least_time(1, matrix(k), factor(k), load, x)
         make(k) = least_time(2, matrix(k), factor(k), load, x)
         solve(k) = least_time(3, matrix(k), factor(k), load, x)
         if (.not. factor(k)%usable) error stop "the factor is not usable"
         residual(k) = maxval(abs(load - product_of(matrix(k), x)))/maxval(abs(load))
      end do
      write (output_unit, "(a8,i7,f9.1,f15.0,f9.0,f12.1,f9.1,f16.1,f9.1,2es10.1)") wall, &
         & graph%n_block, real(size(factor(1)%number), wp)/(n_dof**2*graph%n_block), &
         & products(matrix(1))/graph%n_block, 1.0e6_wp*plan, 1.0e6_wp*make, 1.0e6_wp*solve, &
         & residual
      flush (output_unit)
   end subroutine measure

   !> Least processor time of some work in several tries, each of a millisecond or more [s]
   real(wp) function least_time(work, matrix, factor, load, x)
      !> 1: plan; 2: factorise; 3: substitute
      integer, intent(in) :: work
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(inout) :: factor
      !> The right-hand side: (n_dof, n_block)
      real(wp), intent(in) :: load(:, :)
      !> Receives the solution: (n_dof, n_block)
      real(wp), allocatable, intent(inout) :: x(:, :)
      type(block_matrix_t) :: pattern
      real(wp) :: before, after, spent
      integer :: batch, done, try

      least_time = huge(1.0_wp)
      spent = 0.0_wp
      batch = 1
      try = 0
      do while (try < 5 .or. spent < budget)
         call cpu_time(before)
         do done = 1, batch
            select case (work)
            case (1)
               call set_pattern(pattern, matrix%n_dof, size(load, 2), matrix%pair, matrix%symmetric)
               call plan_factor(matrix, factor)
            case (2)
               call factorise(matrix, factor)
            case (3)
               x = load
               call substitute(factor, x)
            end select
         end do
         call cpu_time(after)
         spent = spent + after - before
         if (after - before < 1.0e-3_wp) then
            batch = 2*batch
            cycle
         end if
         try = try + 1
         least_time = min(least_time, (after - before)/batch)
      end do
   end function least_time
end program factor_bench
