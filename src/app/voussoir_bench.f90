!> The build target voussoir-bench: one table of times, counts and memory
program voussoir_bench
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use dda_benchmark, only : figures_t, measure, search_once
   use dda_benchmark_table, only : print_tables
   use dda_error, only : error_t, fatal_error
   use dda_process, only : exit_status, leave
   use dda_stopwatch, only : peak_memory
   use dda_text, only : read_integer
   implicit none
   !> An arch needs four voussoirs to fall
   integer, parameter :: fewest = 4
   type(error_t), allocatable :: error
   type(figures_t), allocatable :: figures(:)
   integer, allocatable :: sizes(:)
   logical :: markdown
   integer :: i

   call read_options(sizes, markdown, error)
   if (allocated(error)) then
      write (error_unit, "(a)") "voussoir-bench: error: "//error%message
      call leave(exit_status%bad_input)
   end if
   allocate (figures(size(sizes)))
   call measure_memory()
   do i = 1, size(sizes)
      call measure(sizes(i), figures(i))
   end do
   call print_tables(figures, markdown)

contains

   !> Growth of the process's peak memory over that after a search of the smallest arch. Sizes rise,
   !> so that every peak is that of its own search
   subroutine measure_memory()
      integer :: before, k

      call search_once(fewest)
      before = peak_memory()
      if (before < 0) return
      do k = 1, size(sizes)
         call search_once(sizes(k))
         figures(k)%memory = peak_memory() - before
      end do
   end subroutine measure_memory

   !> Read the options
   subroutine read_options(sizes, markdown, error)
      !> Numbers of voussoirs, rising: (n)
      integer, allocatable, intent(out) :: sizes(:)
      !> Whether the tables are wanted in Markdown
      logical, intent(out) :: markdown
      !> Allocated if an option is not understood
      type(error_t), allocatable, intent(out) :: error
      character(len=200) :: argument
      integer :: k

      sizes = [12, 36, 180, 1000, 10000]
      markdown = .false.
      k = 1
      do while (k <= command_argument_count() .and. .not. allocated(error))
         call get_command_argument(k, argument)
         select case (argument)
         case ("--markdown")
            markdown = .true.
         case ("--sizes")
            k = k + 1
            call get_command_argument(k, argument)
            call read_sizes(trim(argument), sizes, error)
         case ("--help")
            write (output_unit, "(a)") "voussoir-bench [--sizes 12,36,...] [--markdown]"
            call leave(exit_status%success)
         case default
            call fatal_error(error, "--sizes, --markdown or --help is wanted, '"//trim(argument) &
               & //"' was found")
         end select
         k = k + 1
      end do
   end subroutine read_options

   !> Read a list of rising integers
   subroutine read_sizes(text, sizes, error)
      !> Such as 12,36
      character(len=*), intent(in) :: text
      !> The integers: (n)
      integer, allocatable, intent(out) :: sizes(:)
      !> Allocated if the text is no such list
      type(error_t), allocatable, intent(out) :: error
      integer :: comma, from, number
      logical :: ok

      allocate (sizes(0))
      from = 1
      do while (from <= len(text) + 1)
         comma = index(text(from:)//",", ",")
         call read_integer(text(from:from + comma - 2), number, ok)
         if (ok) ok = number > maxval([fewest - 1, sizes])
         if (.not. ok) then
            call fatal_error(error, "--sizes wants rising numbers from 4 such as 12,36, '"//text &
               & //"' was found")
            return
         end if
         sizes = [sizes, number]
         from = from + comma
      end do
   end subroutine read_sizes
end program voussoir_bench
