!> Verbs of the command: actions on a file or on decks
module dda_verbs
   use dda_command_line, only : command_t
   use dda_error, only : error_t
   implicit none
   private

   public :: check_file, cut_file, draw_map, export_deck, run_decks

   interface

      !> Compute the cases of decks, and write their tables
      module subroutine run_decks(command, status)
         type(command_t), intent(in) :: command
         integer, intent(out) :: status  !! Exit status
      end subroutine run_decks

      !> Read and check a deck, and print its plan
      module subroutine check_file(command, name, status, error)
         type(command_t), intent(in) :: command
         character(len=*), intent(in) :: name  !! Name of the deck
         integer, intent(out) :: status        !! Exit status of this deck
         type(error_t), allocatable, intent(out) :: error
      end subroutine check_file

      !> Cut the blocks of a file of lines, and print them
      module subroutine cut_file(command, name, status, error)
         type(command_t), intent(in) :: command
         character(len=*), intent(in) :: name  !! Name of the file
         integer, intent(out) :: status        !! Exit status of this file
         type(error_t), allocatable, intent(out) :: error
      end subroutine cut_file

      !> Draw the lines of a map of joints
      module subroutine draw_map(command, name, status, error)
         type(command_t), intent(in) :: command
         character(len=*), intent(in) :: name  !! Name of the map
         integer, intent(out) :: status        !! Exit status of this map
         type(error_t), allocatable, intent(out) :: error
      end subroutine draw_map

      !> Export the arch or the blocks of a deck in other formats
      module subroutine export_deck(command, name, status, error)
         type(command_t), intent(in) :: command
         character(len=*), intent(in) :: name  !! Name of the deck
         integer, intent(out) :: status        !! Exit status of this deck
         type(error_t), allocatable, intent(out) :: error
      end subroutine export_deck

   end interface
end module dda_verbs
