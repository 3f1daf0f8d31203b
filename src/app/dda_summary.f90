!> What a run prints: a line a case, and a last line
module dda_summary
   use dda_screen, only : print_line, screen_t
   use dda_text, only : to_text
   use dda_write_results, only : number_t, result_row_t
   implicit none
   private

   public :: print_resumed, print_row, print_total

   !> Most cases that are printed one by one
   integer, parameter :: max_rows = 100

contains

   !> Print one case; of long runs only those that are undecided
   subroutine print_row(screen, row, remark, total, printed)
      !> Where it goes
      type(screen_t), intent(in) :: screen
      !> Its row
      type(result_row_t), intent(in) :: row
      !> What the user should know beside the row
      character(len=*), intent(in) :: remark
      !> Number of cases
      integer, intent(in) :: total
      !> Cases computed so far, this one among them
      integer, intent(in) :: printed
      character(len=:), allocatable :: hinges
      character(len=90) :: columns
      integer :: i

      if (total > max_rows .and. row%verdict /= "undecided") return
      if (printed == 1) then
         write (columns, "(a6, 2x, a6, 2x, a10, 2x, a14, 2x, a14, 2x, a9, 2x, a10)") "case", &
            & "blocks", "verdict   ", "critical", "exact", "error", "mode      "
         call print_line(screen, columns(:83)//"intrados hinge [deg]")
      end if
      hinges = ""
      if (allocated(row%intrados_hinge_deg)) then
         do i = 1, size(row%intrados_hinge_deg)
            hinges = hinges//" "//to_text(anint(row%intrados_hinge_deg(i)*1.0e6)/1.0e6)
         end do
      end if
      write (columns, "(i6, 2x, i6, 2x, a10, 2x, a14, 2x, a14, 2x, a9, 2x, a10)") &
         & row%number, row%blocks, row%verdict, fixed(row%critical, "(f14.10)"), &
         & fixed(row%exact, "(f14.10)"), fixed(row%relative_error, "(es9.1)"), row%collapse_mode
      call print_line(screen, columns(:82)//hinges)
      if (remark /= "") call print_line(screen, repeat(" ", 8)//remark)
   end subroutine print_row

   !> Print what --resume has found
   subroutine print_resumed(screen, name, same_deck, finished, total)
      !> Where it goes
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
      !> Where it goes
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

   !> A number in a column of fixed width, blank if it is unknown
   pure function fixed(number, form) result(text)
      !> The number
      type(number_t), intent(in) :: number
      !> Format of one number
      character(len=*), intent(in) :: form
      !> The column
      character(len=14) :: text

      text = ""
      if (number%known) write (text, form) number%value
   end function fixed
end module dda_summary
