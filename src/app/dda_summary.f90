!> What a run prints before and after the table of its cases
module dda_summary
   use dda_screen, only : print_line, screen_t
   use dda_text, only : to_text
   implicit none
   private

   public :: print_resumed, print_total

contains

   !> Print what --resume has found
   subroutine print_resumed(screen, name, same_deck, finished, total)
      type(screen_t), intent(in) :: screen
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> Whether there are results of the same deck
      logical, intent(in) :: same_deck
      !> Cases that are finished
      integer, intent(in) :: finished
      !> Number of cases
      integer, intent(in) :: total

      if (same_deck) then
         call print_line(screen, name//": resumed, "//to_text(finished)//" of " &
            & //to_text(total)//" cases are there already")
      else
         call print_line(screen, name//": nothing to resume, there are no results of this very "// &
            & "deck with these settings by this build of dda; all cases are computed")
      end if
   end subroutine print_resumed

   !> Print the last line
   subroutine print_total(screen, name, folder, count, left_out)
      type(screen_t), intent(in) :: screen
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> Where the results are
      character(len=*), intent(in) :: folder
      !> Cases decided, undecided, written: (3)
      integer, intent(in) :: count(3)
      !> Which tables are not written, and why; empty if there is none
      character(len=*), intent(in) :: left_out

      call print_line(screen, name//": "//to_text(count(1))//" decided, "//to_text(count(2)) &
         & //" undecided; results in "//folder//"/results.csv")
      if (left_out /= "") call print_line(screen, name//": "//left_out)
   end subroutine print_total
end module dda_summary
