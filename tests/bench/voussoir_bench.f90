!> The build target voussoir-bench: one table of times, counts and memory
program voussoir_bench
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use dda_benchmark, only : figures_t, measure, search_once
   use dda_benchmark_table, only : print_tables
   use dda_error, only : error_t, fatal_error
   use dda_memory, only : keep_memory
   use dda_process, only : exit_status, leave
   use dda_stopwatch, only : peak_memory
   use dda_text, only : read_integer
   implicit none
   !> An arch needs four voussoirs to fall
   integer, parameter :: fewest = 4
   !> Unknowns of a block: chains take less memory, and come first
   integer, parameter :: both(2) = [3, 6]
   type(error_t), allocatable :: error
   type(figures_t), allocatable :: figures(:)
   integer, allocatable :: sizes(:), unknowns(:)
   logical :: markdown
   integer :: i, k

   call read_options(sizes, unknowns, markdown, error)
   if (allocated(error)) then
      write (error_unit, "(a)") "voussoir-bench: error: "//error%message
      call leave(exit_status%bad_input)
   end if
   allocate (figures(size(unknowns)*size(sizes)))
   call measure_memory()
   ! as the program does
   call keep_memory()
   do k = 1, size(unknowns)
      do i = 1, size(sizes)
         call measure(sizes(i), unknowns(k), figures(size(sizes)*(k - 1) + i))
      end do
   end do
   call print_tables(figures, markdown)

contains

   !> Growth of the process's peak memory over that after a search of the smallest arch. Sizes rise,
   !> so that every peak is that of its own search; with 6 unknowns only those beyond the largest
   !> peak with 3 are known
   subroutine measure_memory()
      integer :: before, i, k, peak

      call search_once(fewest, maxval(unknowns))
      before = peak_memory()
      if (before < 0) return
      do k = 1, size(unknowns)
         do i = 1, size(sizes)
            peak = peak_memory()
            call search_once(sizes(i), unknowns(k))
            if (peak_memory() > peak .or. k == 1) &
               & figures(size(sizes)*(k - 1) + i)%memory = peak_memory() - before
         end do
      end do
   end subroutine measure_memory

   !> Read the options
   subroutine read_options(sizes, unknowns, markdown, error)
      integer, allocatable, intent(out) :: sizes(:)     !! Numbers of voussoirs, rising: (n)
      integer, allocatable, intent(out) :: unknowns(:)  !! Unknowns of a block: 3, 6, or both
      logical, intent(out) :: markdown                  !! True if the tables are wanted in Markdown
      type(error_t), allocatable, intent(out) :: error  !! Allocated if an option is not understood
      character(len=200) :: argument
      integer :: k

      sizes = [12, 36, 180, 1000, 10000]
      unknowns = both
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
         case ("--unknowns")
            k = k + 1
            call get_command_argument(k, argument)
            unknowns = pack(both, [trim(argument) == "3", trim(argument) == "6"])
            if (size(unknowns) == 0) call fatal_error(error, "--unknowns wants 3 or 6, '" &
               & //trim(argument)//"' was found")
         case ("--help")
            write (output_unit, "(a)") "voussoir-bench [--sizes 12,36,...] [--unknowns 3] "// &
               & "[--markdown]"
            call leave(exit_status%success)
         case default
            call fatal_error(error, "--sizes, --unknowns, --markdown or --help is wanted, '" &
               & //trim(argument)//"' was found")
         end select
         k = k + 1
      end do
   end subroutine read_options

   !> Read a list of rising integers
   subroutine read_sizes(text, sizes, error)
      character(len=*), intent(in) :: text              !! Such as 12,36
      integer, allocatable, intent(out) :: sizes(:)     !! The integers: (n)
      type(error_t), allocatable, intent(out) :: error  !! Allocated if the text is no such list
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
