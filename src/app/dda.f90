!> The command dda
program dda
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_blas_threads, only : blas_has_locks, set_one_blas_thread
   use dda_command_line, only : command_t, read_command
   use dda_error, only : error_line, error_t, fatal_error
   use dda_help, only : print_help, version
   use dda_memory, only : keep_memory
   use dda_process, only : exit_status, leave, survive_file_limit, worst_status
   use dda_screen, only : close_screen, open_screen, print_line
   use dda_verbs, only : check_file, cut_file, draw_map, export_deck, run_decks
   implicit none
   type(command_t) :: command
   type(error_t), allocatable :: error
   integer :: i, status, status_of_file

   status = exit_status%success
   call keep_memory()
   call set_one_blas_thread()
   call survive_file_limit()
   call read_command(command, error)
   if (.not. allocated(error) .and. command%jobs > 1) then
      if (.not. blas_has_locks()) call fatal_error(error, "--jobs: the BLAS library has no locks" &
         & //" (a serial OpenBLAS). Install libopenblas-openmp-dev, or use --jobs 1.")
   end if
   if (allocated(error)) then
      write (error_unit, "(a)") error_line(error)
      call leave(exit_status%bad_input)
   end if
   call open_screen(command%screen)
   select case (command%verb)
   case ("run")
      call run_decks(command, status)
   case ("version")
      call print_line(command%screen, "dda "//version)
   case ("help")
      call print_help(command, status)
   case default
      do i = 1, size(command%name)
         call take_file(command%name(i)%text, status_of_file, error)
         if (allocated(error)) write (error_unit, "(a)") error_line(error)
         status = worst_status(status, status_of_file)
      end do
   end select
   call close_screen(command%screen, error)
   if (allocated(error)) then
      write (error_unit, "(a)") error_line(error)
      status = worst_status(status, exit_status%not_written)
   end if
   call leave(status)

contains

   !> Run the command for one file
   subroutine take_file(name, status, error)
      character(len=*), intent(in) :: name  !! Name of the file
      integer, intent(out) :: status        !! Exit status of this file
      type(error_t), allocatable, intent(out) :: error

      status = exit_status%bad_input
      select case (command%verb)
      case ("check")
         call check_file(command, name, status, error)
      case ("cut")
         call cut_file(command, name, status, error)
      case ("lines")
         call draw_map(command, name, status, error)
      case ("export")
         call export_deck(command, name, status, error)
      end select
   end subroutine take_file
end program dda
