!> dda help and dda --version
module dda_help
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use dda_command_line, only : command_t
   use dda_deck_words, only : deck_help
   use dda_process, only : exit_status
   implicit none
   private

   public :: print_help, version

   !> Version of the program
   character(len=*), parameter :: version = "0.1.0"

contains

   !> Print help on a topic
   subroutine print_help(command, status)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Exit status of the program
      integer, intent(out) :: status
      character(len=:), allocatable :: topic

      status = exit_status%success
      topic = ""
      if (size(command%name) > 0) topic = trim(command%name(1))
      select case (topic)
      case ("")
         call print_lines([character(len=96) :: &
            & "dda: discontinuous deformation analysis of masonry arches", &
            & "", &
            & "   dda run DECK [DECK ...]     compute every case of every deck", &
            & "   dda check DECK [DECK ...]   read and check decks, compute nothing", &
            & "   dda help run | check | keys", &
            & "   dda --version", &
            & "", &
            & "Exit status: 0 every case reached a verdict; 2 bad input;", &
            & "3 a case ended undecided; 4 results could not be written."])
      case ("run")
         call print_lines([character(len=96) :: &
            & "dda run DECK [DECK ...] [--out DIR] [--jobs N] [--set group%key=value ...]", &
            & "        [--resume] [--quiet]", &
            & "", &
            & "   --out DIR   where results go; several decks each have a folder inside it", &
            & "               (without it: a folder named as the deck without its ending)", &
            & "   --jobs N    cases computed at the same time (1)", &
            & "   --set group%key=value   overrides the deck; commas for lists", &
            & "   --resume    skip the cases that an earlier run of the same deck with the same", &
            & "               --set has finished; if the deck has changed, compute all anew", &
            & "   --quiet     print nothing but errors", &
            & "", &
            & "Writes results.csv (a row a case), joints.csv (a row a joint), log.txt, and", &
            & "deck.record, by which --resume knows the deck again."])
      case ("check")
         call print_lines([character(len=96) :: &
            & "dda check DECK [DECK ...] [--set group%key=value ...] [--quiet]", &
            & "", &
            & "Reads and checks the decks and prints what would be computed, and why."])
      case ("keys")
         write (output_unit, "(a)", advance="no") deck_help()
      case default
         write (error_unit, "(a)") "dda: error: help on run, check or keys is wanted, '" &
            & //topic//"' was found"
         status = exit_status%bad_input
      end select
   end subroutine print_help

   !> Print lines of text
   subroutine print_lines(lines)
      !> The lines: (n)
      character(len=*), intent(in) :: lines(:)
      integer :: i

      do i = 1, size(lines)
         write (output_unit, "(a)") trim(lines(i))
      end do
   end subroutine print_lines
end module dda_help
