!> Record of the deck and program of a run; results with equal records belong together
module dda_run_record
   use dda_build_mark, only : build_mark
   use dda_deck, only : deck_sweep_t, deck_t, parameter_name
   use dda_deck_key, only : full_name, key_kind
   use dda_deck_keys, only : deck_group, deck_key
   use dda_help, only : version
   use dda_key_value, only : deck_value_t
   use dda_text, only : add_line, growing_text_t, lines_of, to_text
   implicit none
   private

   public :: run_record

contains

   !> Text of deck.record: program, then groups, given keys with their values, and sweeps. Comments,
   !> blanks and the order of keys have no effect; a --set has that of the key in the deck; files
   !> named in the deck are represented by their checksums
   pure function run_record(deck, stem) result(record)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: stem     !! Name of the deck without folder and extension
      character(len=:), allocatable :: record  !! Lines separated by line ends
      type(growing_text_t) :: lines
      integer :: i

      call add_line(lines, "dda "//version//" build "//build_mark//" on "//stem)
      do i = 1, size(deck_group)
         if (deck%group(i)%line > 0 .and. deck_group(i)%name /= "sweep") &
            & call add_line(lines, "&"//trim(deck_group(i)%name))
      end do
      do i = 1, size(deck_key)
         if (deck%value(i)%given .and. deck_key(i)%group /= "sweep") &
            & call add_value(lines, i, deck%value(i))
      end do
      do i = 1, size(deck%sweeps)
         call add_sweep(lines, deck%sweeps(i))
      end do
      if (allocated(deck%file_marks)) call add_line(lines, "files"//deck%file_marks)
      record = lines_of(lines)
   end function run_record

   !> Record one key
   pure subroutine add_value(lines, key, value)
      type(growing_text_t), intent(inout) :: lines
      integer, intent(in) :: key  !! Place of the key in the registry
      type(deck_value_t), intent(in) :: value
      integer :: i

      call add_line(lines, full_name(deck_key(key)))
      select case (deck_key(key)%kind)
      case (key_kind%number, key_kind%whole)
         call add_line(lines, "  "//to_text(value%number))
      case (key_kind%word, key_kind%text)
         call add_line(lines, "  "//value%text)
      case (key_kind%flag)
         call add_line(lines, "  "//merge(".true. ", ".false.", value%flag))
      case (key_kind%numbers)
         do i = 1, size(value%numbers)
            call add_line(lines, "  "//to_text(value%numbers(i)))
         end do
      end select
   end subroutine add_value

   !> Record one sweep
   pure subroutine add_sweep(lines, sweep)
      type(growing_text_t), intent(inout) :: lines
      type(deck_sweep_t), intent(in) :: sweep
      integer :: i

      call add_line(lines, "&sweep "//parameter_name(sweep%parameter) &
         & //trim(merge(" linked", "       ", sweep%linked)))
      do i = 1, size(sweep%numbers)
         call add_line(lines, "  "//to_text(sweep%numbers(i)))
      end do
      do i = 1, size(sweep%texts)
         call add_line(lines, "  "//trim(sweep%texts(i)))
      end do
   end subroutine add_sweep
end module dda_run_record
