!> The build target voussoir-step-bench: what a step costs, block by block, and how that grows
program voussoir_step_bench
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use dda_benchmark_table, only : machine_line, print_row, rounded
   use dda_kinds, only : wp
   use dda_process, only : exit_status, leave
   use dda_step_benchmark, only : measure_steps, step_case_t, step_figures_t
   use dda_text, only : read_integer, to_text
   implicit none
   !> Characters of a cell
   integer, parameter :: cell = 30
   logical :: markdown
   character(len=cell) :: head(11)
   character(len=cell) :: only
   integer :: largest

   call read_options(markdown, largest, only)
   write (output_unit, "(a)") machine_line(), ""
   head = [character(len=cell) :: "scene", "blocks", "search us", "transfer us", "assemble us", &
      & "factorise us", "substitute us", "step us", "search %", "passes", "factorisations"]
   call print_row(head, markdown, head=.true.)
   call measure_walls("ten courses", .false.)
   call measure_walls("square", .true.)
   call measure_loose()

contains

   !> Walls of rising length or size, in reference geometry and moving, static and in time
   subroutine measure_walls(name, square)
      character(len=*), intent(in) :: name  !! Name of the scene
      logical, intent(in) :: square         !! As many courses as bricks in one; otherwise ten
      integer, parameter :: side(3) = [10, 32, 100]
      type(step_case_t) :: step_case(3)
      integer :: i

      do i = 1, 3
         step_case(i)%size = merge(spread(side(i), 1, 2), [10, side(i)**2/10], square)
         ! a step of the largest squares takes minutes
         if (square .and. side(i) > 32) step_case(i)%steps(2) = 0
      end do
      step_case%name = name
      call measure_sizes(step_case, ", reference")
      step_case%current = .true.
      if (.not. square) step_case%steps(1) = 2
      if (.not. square) step_case%steps(2) = 3
      call measure_sizes(step_case, ", current")
      if (square) return
      step_case%current = .false.
      step_case%dynamic = .true.
      call measure_sizes(step_case, ", in time")
      step_case%name = "ten courses, settled"
      step_case%steps(1) = 40
      step_case%steps(2) = 20
      call measure_sizes(step_case, ", in time")
      step_case%current = .true.
      call measure_sizes(step_case, ", in time, current")
   end subroutine measure_walls

   !> Loose blocks that have begun to land on one another
   subroutine measure_loose()
      type(step_case_t) :: step_case(3)

      step_case%name = "loose"
      step_case(1)%size = [0, 10]
      step_case(2)%size = [0, 32]
      step_case(3)%size = [0, 60]
      step_case%dynamic = .true.
      step_case%current = .true.
      step_case%steps(1) = 50
      step_case%steps(2) = 5
      call measure_sizes(step_case, ", current, in time")
   end subroutine measure_loose

   !> Measure one scene in all sizes, and print them with their exponents
   subroutine measure_sizes(step_case, how)
      type(step_case_t), intent(in) :: step_case(:)  !! The scene in rising sizes: (3)
      character(len=*), intent(in) :: how            !! How it is run
      type(step_figures_t) :: figures(size(step_case))
      character(len=cell) :: cells(11)
      real(wp) :: exponent
      integer :: i, j, n

      if (index(trim(step_case(1)%name)//how, trim(only)) == 0) return
      n = count([(blocks_of(step_case(i)) <= largest, i=1, size(step_case))])
      do i = 1, n
         call measure_steps(step_case(i), figures(i))
         call fill_cells(trim(step_case(i)%name)//how, figures(i), cells)
         call print_row(cells, markdown, head=.false.)
      end do
      if (n < 2) return
      cells = ""
      cells(1) = "exponent"
      do j = 1, 6
         if (.not. minval(figures(n - 1:n)%part(j)) > 0.0_wp) cycle
         exponent = log(figures(n)%part(j)/figures(n - 1)%part(j)) &
            & /log(real(figures(n)%blocks, wp)/real(figures(n - 1)%blocks, wp))
         cells(2 + j) = rounded(exponent, 2)
      end do
      call print_row(cells, markdown, head=.false.)
   end subroutine measure_sizes

   !> Number of blocks of a scene, nearly
   pure integer function blocks_of(step_case)
      type(step_case_t), intent(in) :: step_case

      blocks_of = step_case%size(2)*merge(step_case%size(1), step_case%size(2), &
         & step_case%size(1) > 0)
   end function blocks_of

   !> The figures of one scene as one line of the table
   subroutine fill_cells(name, figures, cells)
      character(len=*), intent(in) :: name  !! Name of the scene
      type(step_figures_t), intent(in) :: figures
      character(len=*), intent(out) :: cells(:)  !! Text of each column: (11)
      real(wp) :: us(6)
      integer :: j

      us = 1.0e6_wp*figures%part/real(figures%blocks, wp)
      cells = "-"
      cells(1) = name
      cells(2) = to_text(figures%blocks)
      do j = 1, merge(6, 5, us(6) > 0.0_wp)
         cells(2 + j) = three_digits(us(j))
      end do
      if (.not. us(6) > 0.0_wp) return
      cells(9) = rounded(100.0_wp*figures%count(1)*us(1)/us(6), 0)
      cells(10) = rounded(figures%count(2), 1)
      cells(11) = rounded(figures%count(3), 1)
   end subroutine fill_cells

   !> A number with at least three digits
   function three_digits(number) result(text)
      real(wp), intent(in) :: number         !! The number
      character(len=:), allocatable :: text  !! The text

      text = rounded(number, merge(3, merge(2, 1, number < 10.0_wp), number < 1.0_wp))
   end function three_digits

   !> Read the options
   subroutine read_options(markdown, largest, only)
      logical, intent(out) :: markdown       !! True if the table is wanted in Markdown
      integer, intent(out) :: largest        !! Most blocks
      character(len=*), intent(out) :: only  !! Part of the names of the scenes that are measured
      character(len=200) :: argument
      integer :: k
      logical :: ok

      markdown = .false.
      largest = 10000
      only = ""
      k = 1
      do while (k <= command_argument_count())
         call get_command_argument(k, argument)
         ok = .true.
         select case (argument)
         case ("--markdown")
            markdown = .true.
         case ("--largest")
            k = k + 1
            call get_command_argument(k, argument)
            call read_integer(trim(argument), largest, ok)
         case ("--only")
            k = k + 1
            call get_command_argument(k, only)
         case ("--help")
            write (output_unit, "(a)") "voussoir-step-bench [--largest BLOCKS] [--only NAME] " &
               & //"[--markdown]"
            call leave(exit_status%success)
         case default
            ok = .false.
         end select
         if (.not. ok) then
            write (error_unit, "(a)") "voussoir-step-bench: error: expected --largest BLOCKS, " &
               & //"--only NAME, --markdown or --help, got '"//trim(argument)//"'"
            call leave(exit_status%bad_input)
         end if
         k = k + 1
      end do
   end subroutine read_options
end program voussoir_step_bench
