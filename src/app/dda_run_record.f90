!> What a run was asked for, and who computes it: results with equal records go together
module dda_run_record
   use dda_build_mark, only : build_mark
   use dda_deck, only : deck_t
   use dda_deck_record, only : deck_record
   use dda_help, only : version
   implicit none
   private

   public :: run_record

contains

   !> The text of deck.record
   pure function run_record(deck, stem) result(record)
      type(deck_t), intent(in) :: deck
      !> Its name without folder and ending
      character(len=*), intent(in) :: stem
      !> Lines parted by line ends
      character(len=:), allocatable :: record

      record = deck_record(deck, "dda "//version//" build "//build_mark//" on "//stem)
   end function run_record
end module dda_run_record
