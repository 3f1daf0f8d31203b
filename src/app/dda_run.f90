!> dda run: decks to results
module dda_run
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_case, only : case_t, compute_case, prepare_case
   use dda_case_rows, only : tell_case
   use dda_case_choice, only : choose_cases
   use dda_command_line, only : command_t, name_of
   use dda_cut, only : print_warnings
   use dda_deck, only : deck_t, flag_of
   use dda_deck_record, only : deck_record
   use dda_deck_sweep, only : case_deck, n_cases
   use dda_deck_scene, only : check_lines, check_scene, warning_line
   use dda_error, only : error_line, error_t, fatal_error
   use dda_help, only : version
   use dda_picture_files, only : write_album, write_energies, write_track
   use dda_process, only : error_is_terminal, exit_status, worst_status
   use dda_progress, only : clear_progress, progress_t, report_progress
   use dda_read_deck, only : read_deck
   use dda_result_tables, only : close_tables, name_tables, open_tables, result_tables_t, &
      & swept_fields, sync_when_due, table, write_case
   use dda_resume, only : find_finished, finished_t, reopen_tables
   use dda_restart, only : save_restart
   use dda_summary, only : print_resumed, print_row, print_total
   use dda_text, only : to_text
   use dda_write_blocks, only : told_blocks_t
   use dda_write_results, only : joint_row_t, result_row_t
   implicit none
   private

   public :: run_decks, deck_stem

   !> Most cases at the same time
   integer, parameter :: max_jobs = 256

contains

   !> Run all decks of the command line; a bad deck does not keep the others from running
   subroutine run_decks(command, status)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Exit status of the program
      integer, intent(out) :: status
      type(deck_t), allocatable :: deck(:)
      type(error_t), allocatable :: error
      logical, allocatable :: chosen(:)
      logical :: good(size(command%name))
      integer :: i, deck_status, w

      allocate (deck(size(command%name)))
      status = exit_status%success
      do i = 1, size(deck)
         call read_deck(name_of(command, i), command%setting, deck(i), error)
         if (.not. allocated(error)) call check_scene(deck(i), error)
         if (.not. allocated(error)) call check_lines(deck(i), error)
         if (.not. command%quiet) call print_warnings(deck(i)%warnings)
         if (.not. allocated(error)) call check_folder(command, i, good(:i - 1), error)
         if (.not. allocated(error)) call choose_cases(command%cases, &
            & n_cases(deck(i)), chosen, error)
         good(i) = .not. allocated(error)
         if (good(i) .and. .not. command%quiet) then
            do w = 1, size(deck(i)%plan%warning)
               write (error_unit, "(a)") warning_line(deck(i), w)
            end do
         else if (.not. good(i)) then
            write (error_unit, "(a)") error_line(error)
            status = exit_status%bad_input
         end if
      end do
      do i = 1, size(deck)
         if (.not. good(i)) cycle
         call run_deck(command, name_of(command, i), deck(i), deck_status)
         status = worst_status(status, deck_status)
      end do
   end subroutine run_decks

   !> No two decks may write into the same folder
   subroutine check_folder(command, number, good, error)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Number of the deck
      integer, intent(in) :: number
      !> Which of the decks before it will run: (number - 1)
      logical, intent(in) :: good(:)
      !> Allocated if an earlier deck writes where this one would
      type(error_t), allocatable, intent(inout) :: error
      integer :: i

      do i = 1, number - 1
         if (.not. good(i) .or. folder_of(command, name_of(command, i)) &
            & /= folder_of(command, name_of(command, number))) cycle
         call fatal_error(error, "wanted a deck with a folder of its own, found that "// &
            & name_of(command, i)//" writes to "//folder_of(command, name_of(command, i))// &
            & " too; rename one deck", name_of(command, number), 1)
         return
      end do
   end subroutine check_folder

   !> Folder that a deck's results go to
   pure function folder_of(command, name) result(folder)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> Name of the folder
      character(len=:), allocatable :: folder

      folder = deck_stem(name)
      if (.not. allocated(command%out)) return
      if (size(command%name) == 1) then
         folder = command%out
      else
         folder = command%out//"/"//folder
      end if
   end function folder_of

   !> Name of a deck without its folder and its ending; one that would stay the same, or be a folder
   !> that exists already, gets an ending
   pure function deck_stem(name) result(stem)
      !> Name of the file
      character(len=*), intent(in) :: name
      !> The stem
      character(len=:), allocatable :: stem
      integer :: dot

      stem = name(index(name, "/", back=.true.) + 1:)
      dot = index(stem, ".", back=.true.)
      if (dot > 1) then
         stem = stem(:dot - 1)
      else
         stem = stem//".results"
      end if
      if (verify(stem, ".") == 0) stem = stem//"results"
   end function deck_stem

   !> Run all cases of one deck
   subroutine run_deck(command, name, deck, status)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> The deck, checked
      type(deck_t), intent(in) :: deck
      !> Exit status of this deck
      integer, intent(out) :: status
      type(result_tables_t) :: tables
      type(finished_t) :: finished
      type(progress_t) :: progress
      type(error_t), allocatable :: error
      logical, allocatable :: chosen(:)
      integer :: count(3), next, total

      total = n_cases(deck)
      count = 0
      call choose_cases(command%cases, total, chosen, error)
      call name_tables(deck, folder_of(command, name), tables)
      call begin_tables(command, name, deck, total, tables, finished, error)
      progress%shown = error_is_terminal()
      if (command%quiet) progress%shown = .false.
      chosen = chosen .and. .not. finished%case
      progress%total = size(pack(chosen, chosen))
      call system_clock(progress%start)
      next = 0
      !$omp parallel num_threads(min(command%jobs, total, max_jobs)) default(none) &
      !$omp shared(deck, name, command, tables, progress, count, error, chosen, next)
      call run_cases(command, name, deck, chosen, next, tables, progress, count, error)
      !$omp end parallel
      call clear_progress(progress)
      call close_tables(tables, error)
      count = count + [finished%count, sum(finished%count)]
      status = exit_status%success
      if (count(2) > 0) status = exit_status%undecided
      if (allocated(error)) then
         status = exit_status%not_written
         write (error_unit, "(a)") error_line(error)
         if (count(3) > 0) write (error_unit, "(a)") to_text(count(3))//" of " &
            & //to_text(total)//" cases are safe in "//tables%folder//"/results.csv"
      else if (.not. command%quiet) then
         call print_total(name, tables%folder, count)
      end if
   end subroutine run_deck

   !> Begin the tables, or go on with those of an earlier run of the same deck
   subroutine begin_tables(command, name, deck, total, tables, finished, error)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> The deck
      type(deck_t), intent(in) :: deck
      !> Number of cases
      integer, intent(in) :: total
      !> The tables, named
      type(result_tables_t), intent(inout) :: tables
      !> What is finished already
      type(finished_t), intent(out) :: finished
      !> Allocated if the tables cannot be written
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: record

      record = deck_record(deck, "dda "//version//" on "//deck_stem(name))
      allocate (finished%case(total), source=.false.)
      if (command%resume) then
         call find_finished(tables, record, total, finished)
         if (.not. command%quiet) &
            & call print_resumed(name, finished%same_deck, sum(finished%count), total)
      end if
      if (finished%same_deck) then
         call reopen_tables(tables, finished, error)
      else
         call open_tables(tables, record, error)
      end if
   end subroutine begin_tables

   !> Compute cases until none is left, or none can be written; each thread runs this. A case is
   !> written down in the same turn in which the next one is prepared: one wait for other threads
   subroutine run_cases(command, name, deck, chosen, next, tables, progress, count, error)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> The deck with its sweeps
      type(deck_t), intent(in) :: deck
      !> Cases to be computed
      logical, intent(in) :: chosen(:)
      !> The last case that was begun by any thread
      integer, intent(inout) :: next
      !> Where the results go
      type(result_tables_t), intent(inout) :: tables
      !> What was told so far
      type(progress_t), intent(inout) :: progress
      !> Cases decided, undecided, written: (3)
      integer, intent(inout) :: count(3)
      !> Failure to write
      type(error_t), allocatable, intent(inout) :: error
      type(deck_t) :: case_of_deck
      type(case_t) :: this
      type(error_t), allocatable :: problem
      integer :: number

      number = 0
      do
         !$omp critical (texts)
         if (number > 0 .and. .not. allocated(error)) call write_down(command, name, deck, number, &
            & this, tables, progress, count, error)
         number = 0
         if (.not. allocated(error)) number = next_chosen(chosen, next)
         if (number > 0) then
            next = number
            call case_deck(deck, number, case_of_deck, problem)
            call prepare_case(case_of_deck, this)
            this%tells_tables = any(tables%at([table%joints, table%blocks])%wanted)
         end if
         !$omp end critical (texts)
         if (number == 0) exit
         call compute_case(this)
      end do
   end subroutine run_cases

   !> The first chosen case behind another one; 0 if there is none
   pure integer function next_chosen(chosen, last)
      !> Cases to be computed
      logical, intent(in) :: chosen(:)
      !> The other one
      integer, intent(in) :: last

      do next_chosen = last + 1, size(chosen)
         if (chosen(next_chosen)) return
      end do
      next_chosen = 0
   end function next_chosen

   !> Write a computed case down
   subroutine write_down(command, name, deck, number, this, tables, progress, count, error)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> The deck with its sweeps
      type(deck_t), intent(in) :: deck
      !> Number of the case
      integer, intent(in) :: number
      !> The case
      type(case_t), intent(in) :: this
      !> Where the results go
      type(result_tables_t), intent(inout) :: tables
      !> What was told so far
      type(progress_t), intent(inout) :: progress
      !> Cases decided, undecided, written: (3)
      integer, intent(inout) :: count(3)
      !> Failure to write
      type(error_t), allocatable, intent(inout) :: error
      type(result_row_t) :: row
      type(joint_row_t), allocatable :: joint_row(:)
      type(told_blocks_t) :: blocks
      character(len=:), allocatable :: remark

      call tell_case(this, row, joint_row, blocks, remark)
      row%deck = deck_stem(name)
      row%number = number
      row%swept = swept_fields(deck, number)
      joint_row%number = number
      call write_pictures(tables, number, this, error)
      if (.not. allocated(error)) call write_end(tables%folder, number, this, error)
      if (.not. allocated(error)) call write_case(tables, row, joint_row, blocks, remark, error)
      if (.not. allocated(error)) call sync_when_due(tables, error)
      if (allocated(error)) return
      count(3) = count(3) + 1
      count(merge(2, 1, row%verdict == "undecided")) = &
         & count(merge(2, 1, row%verdict == "undecided")) + 1
      call clear_progress(progress)
      if (.not. command%quiet) call print_row(row, remark, n_cases(deck), count(3))
      call report_progress(progress)
   end subroutine write_down

   !> Write what is seen of a case on its way: pictures, measured points, energies
   subroutine write_pictures(tables, number, this, error)
      !> Where the results go
      type(result_tables_t), intent(in) :: tables
      !> Number of the case
      integer, intent(in) :: number
      !> The case, computed
      type(case_t), intent(in) :: this
      !> Allocated if something cannot be written
      type(error_t), allocatable, intent(inout) :: error

      if (tables%at(table%frames)%wanted) call write_album(tables%folder, number, &
         & tables%has_vtu, this%scene%system, this%scene%origin, this%album, &
         & tables%at(table%frames)%open, tables%at(table%frame_joints)%open, error)
      if (tables%at(table%points)%wanted .and. .not. allocated(error)) call write_track( &
         & number, this%scene%origin, this%album, tables%at(table%points)%open, error)
      if (tables%at(table%energy)%wanted .and. .not. allocated(error)) call write_energies( &
         & number, this%album, tables%at(table%energy)%open, error)
   end subroutine write_pictures

   !> Write the end of a dynamic case, to go on from there
   subroutine write_end(folder, number, this, error)
      !> Folder of the deck's results
      character(len=*), intent(in) :: folder
      !> Number of the case
      integer, intent(in) :: number
      !> The case, computed
      type(case_t), intent(in) :: this
      !> Allocated if it cannot be written
      type(error_t), allocatable, intent(out) :: error

      if (.not. flag_of(this%deck, "output", "restart")) return
      if (.not. this%scene%settings%dynamic .or. allocated(this%error)) return
      call save_restart(folder//"/case_"//to_text(number)//".restart", this%decision%system, &
         & this%decision%contacts, this%onward, error)
   end subroutine write_end
end module dda_run
