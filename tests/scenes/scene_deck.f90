!> Decks written in one line: parsed, or what is said of them
module scene_deck
   use dda_deck, only : deck_t
   use dda_error, only : error_t
   use dda_read_deck, only : parse_deck
   use dda_text, only : to_text
   implicit none
   private

   public :: deck_of, lines_of, said

contains

   !> A deck that must be good; an empty one if it is not
   pure function deck_of(text) result(deck)
      character(len=*), intent(in) :: text  !! Its lines, parted by |
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=1) :: none(0)

      call parse_deck(lines_of(text), "a.nml", none, deck, error)
      if (allocated(error)) deck%file = error%message
   end function deck_of

   !> What a deck is refused with instead of some words and advice; empty if it is with them, in their line
   pure function said(text, line, words) result(other)
      character(len=*), intent(in) :: text   !! Its lines, parted by |
      integer, intent(in) :: line            !! Line at fault; 0 for a deck that is good
      character(len=*), intent(in) :: words  !! Part of the message
      character(len=:), allocatable :: other
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=1) :: none(0)

      other = ""
      call parse_deck(lines_of(text), "a.nml", none, deck, error)
      if (.not. allocated(error)) then
         if (line > 0) other = "accepted: "//text
      else if (error%line /= line .or. index(error%message, words) == 0 .or. index(error%message, "; ") == 0) then
         other = text//": line "//to_text(error%line)//": "//error%message
      end if
   end function said

   !> Lines of a text
   pure function lines_of(text) result(lines)
      character(len=*), intent(in) :: text  !! Parted by |
      character(len=len(text)) :: lines
      integer :: i

      lines = text
      do i = 1, len(text)
         if (text(i:i) == "|") lines(i:i) = new_line("a")
      end do
   end function lines_of
end module scene_deck
