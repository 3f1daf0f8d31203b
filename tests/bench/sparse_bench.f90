!> The program's factor of walls beside those of CHOLMOD and MUMPS: analysis, factor, solution
!>
!>    sparse_bench [UNITSxCOURSES ...]
!>
!> Times of the processor, the least of several, the solvers in turn.
program sparse_bench
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_ptr
   use, intrinsic :: iso_fortran_env, only : output_unit
   use dda_block_factor, only : block_factor_t, factorise, plan_factor, substitute
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use graph_wall, only : new_wall
   use wall_stiffness, only : product_of, set_stiffness
   implicit none

   interface
      !> Give a matrix to both libraries
      function sparse_open(n, n_entry, row, column, value) bind(c) result(handle)
         import :: c_double, c_int, c_ptr
         integer(c_int), intent(in), value :: n         !! Order
         integer(c_int), intent(in), value :: n_entry   !! Numbers in the lower triangle
         integer(c_int), intent(in) :: row(*), column(*)
         real(c_double), intent(in) :: value(*)
         type(c_ptr) :: handle
      end function sparse_open

      !> CHOLMOD's analysis (1), factor (2) or solution (3)
      subroutine cholmod_work(handle, work, x) bind(c)
         import :: c_double, c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int), intent(in), value :: work
         real(c_double), intent(inout) :: x(*)          !! Right-hand side in, solution out: (n)
      end subroutine cholmod_work

      !> The same by MUMPS
      subroutine mumps_work(handle, work, x) bind(c)
         import :: c_double, c_int, c_ptr
         type(c_ptr), intent(in), value :: handle
         integer(c_int), intent(in), value :: work
         real(c_double), intent(inout) :: x(*)
      end subroutine mumps_work

      !> Free both
      subroutine sparse_close(handle) bind(c)
         import :: c_ptr
         type(c_ptr), intent(in), value :: handle
      end subroutine sparse_close
   end interface

   !> Walls where none is asked for: about 36, 400, 1600, 5000 and 20000 bricks
   character(len=7), parameter :: usual(5) = &
      & ["4x8    ", "20x20  ", "40x40  ", "70x70  ", "140x140"]
   character(len=*), parameter :: solver(3) = ["voussoir", "CHOLMOD ", "MUMPS   "]
   !> Time that the measurement of a wall takes at least [s], and fewest rounds
   real(wp), parameter :: budget = 1.0_wp
   integer, parameter :: fewest = 5
   integer :: i, k
   character(len=20) :: argument

   write (output_unit, "(a)") "| bricks | unknowns | solver | analysis [us] | factor [us] " &
      & //"| solution [us] | residual |", "|---:|---:|---|---:|---:|---:|---:|"
   do k = 3, 6, 3
      if (command_argument_count() == 0) then
         do i = 1, size(usual)
            call measure(usual(i), k)
         end do
      end if
      do i = 1, command_argument_count()
         call get_command_argument(i, argument)
         call measure(argument, k)
      end do
   end do

contains

   !> Three lines for a wall
   subroutine measure(wall, n_dof)
      character(len=*), intent(in) :: wall  !! Bricks of a course, "x", courses
      integer, intent(in) :: n_dof          !! Unknowns of a block
      type(joint_graph_t) :: graph
      type(block_matrix_t) :: matrix
      type(block_factor_t) :: factor
      integer(c_int), allocatable :: row(:), column(:)
      real(wp), allocatable :: weight(:, :), push(:, :), load(:, :), value(:), x(:, :)
      real(wp) :: least(3, 3), residual(3), start, now
      integer :: courses, cross, rounds, s, units, work
      type(c_ptr) :: handle

      cross = index(wall, "x")
      read (wall(:cross - 1), *) units
      read (wall(cross + 1:), *) courses
      call new_wall(units, courses, 0.6_wp, graph, weight, push)
      call set_stiffness(graph, n_dof, .true., matrix)
      allocate (load(n_dof, graph%n_block), source=1.0_wp)
      load(:3, :) = weight + push
      allocate (x, source=load)
      call list_numbers(matrix, row, column, value)
      handle = sparse_open(size(load), size(value), row, column, value)
      least = huge(1.0_wp)
      rounds = 0
      call cpu_time(start)
      do
         do s = 1, 3
            do work = 1, 3
               call time_work(s, work, matrix, factor, handle, load, x, least(work, s))
            end do
            residual(s) = maxval(abs(load - product_of(matrix, x)))/maxval(abs(load))
         end do
         rounds = rounds + 1
         call cpu_time(now)
         if (rounds >= fewest .and. now - start > budget) exit
      end do
      call sparse_close(handle)
      do s = 1, 3
         write (output_unit, "('| ', i0, ' | ', i0, ' | ', a, 3(' | ', i0), ' | ', es7.1, ' |')") &
            & graph%n_block, n_dof, trim(solver(s)), nint(1.0e6_wp*least(:, s)), residual(s)
      end do
      flush (output_unit)
   end subroutine measure

   !> Time one piece of work, repeated to at least a millisecond
   subroutine time_work(solver, work, matrix, factor, handle, load, x, least)
      integer, intent(in) :: solver
      integer, intent(in) :: work                      !! 1: analysis, 2: factor, 3: solution
      type(block_matrix_t), intent(in) :: matrix
      type(block_factor_t), intent(inout) :: factor    !! The program's
      type(c_ptr), intent(in) :: handle                !! Those of the libraries
      real(wp), intent(in) :: load(:, :)               !! Right-hand side: (n_dof, n_block)
      real(wp), intent(inout) :: x(:, :)               !! Receives the solution: (n_dof, n_block)
      real(wp), intent(inout) :: least                 !! Least time [s]
      type(block_matrix_t) :: pattern
      real(wp) :: start, finish
      integer :: n

      n = 0
      call cpu_time(start)
      do
         x = load
         if (solver == 2) then
            call cholmod_work(handle, work, x)
         else if (solver == 3) then
            call mumps_work(handle, work, x)
         else if (work == 1) then
            call set_pattern(pattern, matrix%n_dof, size(load, 2), matrix%pair)
            call plan_factor(matrix, factor)
         else if (work == 2) then
            call factorise(matrix, factor)
         else
            call substitute(factor, x)
         end if
         n = n + 1
         call cpu_time(finish)
         if (finish - start > 1.0e-3_wp) exit
      end do
      least = min(least, (finish - start)/n)
   end subroutine time_work

   !> Numbers of the lower triangle, one by one
   subroutine list_numbers(matrix, row, column, value)
      type(block_matrix_t), intent(in) :: matrix
      integer(c_int), allocatable, intent(out) :: row(:), column(:)  !! Places: (n)
      real(wp), allocatable, intent(out) :: value(:)                 !! Numbers: (n)
      real(wp) :: block(matrix%n_dof, matrix%n_dof)
      integer :: c, e, n, nd, p, q, r

      nd = matrix%n_dof
      n = size(matrix%diagonal(1, 1, :))*nd*(nd + 1)/2 + size(matrix%coupling)
      allocate (row(n), column(n), value(n))
      n = 0
      do e = 1 - size(matrix%diagonal, 3), size(matrix%pair, 2)
         if (e > 0) then
            p = maxval(matrix%pair(:, e))
            q = minval(matrix%pair(:, e))
            block = matrix%coupling(:, :, e)
            if (matrix%pair(1, e) == q) block = transpose(block)
         else
            p = 1 - e
            q = p
            block = matrix%diagonal(:, :, p)
         end if
         do c = 1, nd
            do r = merge(c, 1, p == q), nd
               n = n + 1
               row(n) = nd*(p - 1) + r
               column(n) = nd*(q - 1) + c
               value(n) = block(r, c)
            end do
         end do
      end do
   end subroutine list_numbers
end program sparse_bench
