!> The command dda
program dda
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_check, only : check_decks
   use dda_command_line, only : command_t, read_command
   use dda_cut, only : cut_files
   use dda_error, only : error_line, error_t
   use dda_export, only : export_decks
   use dda_lines, only : draw_lines
   use dda_help, only : print_help, version
   use dda_memory, only : keep_memory
   use dda_process, only : exit_status, leave, survive_file_limit, worst_status
   use dda_run, only : run_decks
   use dda_screen, only : close_screen, open_screen, print_line
   implicit none
   type(command_t) :: command
   type(error_t), allocatable :: error
   integer :: status

   status = exit_status%success
   call keep_memory()
   call survive_file_limit()
   call read_command(command, error)
   if (allocated(error)) then
      write (error_unit, "(a)") error_line(error)
      call leave(exit_status%bad_input)
   end if
   call open_screen(command%screen)
   select case (command%verb)
   case ("run")
      call run_decks(command, status)
   case ("check")
      call check_decks(command, status)
   case ("cut")
      call cut_files(command, status)
   case ("lines")
      call draw_lines(command, status)
   case ("export")
      call export_decks(command, status)
   case ("version")
      call print_line(command%screen, "dda "//version)
   case default
      call print_help(command, status)
   end select
   call close_screen(command%screen, error)
   if (allocated(error)) then
      write (error_unit, "(a)") error_line(error)
      status = worst_status(status, exit_status%not_written)
   end if
   call leave(status)
end program dda
