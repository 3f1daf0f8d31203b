!> dda check: read and check decks, and report the computation
submodule (dda_verbs) dda_check
   use dda_deck, only : deck_t
   use dda_process, only : deck_stem, error_is_terminal, exit_status
   use dda_read_deck, only : read_deck
   use dda_result_tables, only : name_tables, result_tables_t
   use dda_run_record, only : run_record
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_scene
   use dda_screen, only : end_watch, print_line, print_warnings, screen_t, terminal_watch_t
   implicit none

   interface

      !> Print the plan of a deck
      module subroutine print_plan(screen, name, deck, scene)
         type(screen_t), intent(in) :: screen
         character(len=*), intent(in) :: name  !! Name of the deck
         type(deck_t), intent(inout) :: deck
         !> Scene of the first case, if the blocks are from a file
         type(scene_t), intent(inout) :: scene
      end subroutine print_plan

   end interface

contains

   !> Check a deck
   module procedure check_file
      type(deck_t) :: deck
      type(scene_t) :: scene
      type(terminal_watch_t) :: watch
      character(len=:), allocatable :: record

      watch%shown = error_is_terminal() .and. .not. command%quiet
      call read_deck(name, command%setting, deck, error, watch)
      if (.not. allocated(error)) call check_scene(deck, scene, error, watch)
      call end_watch(watch)
      status = merge(exit_status%bad_input, exit_status%success, allocated(error))
      if (allocated(error)) return
      record = record_text(deck, deck_stem(name))
      if (.not. command%quiet) then
         call print_warnings(deck%warnings)
         call print_plan(command%screen, name, deck, scene)
      end if
      if (command%record) call print_line(command%screen, record)
   end procedure check_file

   !> Names and headers of the tables of a run, and its deck.record
   function record_text(deck, stem) result(text)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: stem   !! Name of the deck without folder and extension
      character(len=:), allocatable :: text  !! Lines separated by line ends
      type(result_tables_t) :: tables
      integer :: i

      call name_tables(deck, "", tables)
      text = "tables:"//new_line("a")
      do i = 1, size(tables%at)
         if (tables%at(i)%wanted) text = text//"   "//tables%at(i)%file(2:)//" " &
            & //tables%at(i)%header//new_line("a")
      end do
      text = text//"deck.record:"//new_line("a")//run_record(deck, stem)
   end function record_text
end submodule dda_check
