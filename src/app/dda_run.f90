!> dda run: decks to results
submodule (dda_verbs) dda_run
   use, intrinsic :: iso_c_binding, only : c_int
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_binary_file, only : binary_file_t, close_binary, descriptor_of, open_binary, &
      & remove_link
   use dda_case_table, only : case_table_t, end_case_table, new_case_table
   use dda_deck, only : deck_t
   use dda_deck_sweep, only : choose_cases, n_cases
   use dda_error, only : error_line, fatal_error
   use dda_process, only : deck_stem, error_is_terminal, exit_status, make_folder, worst_status
   use dda_read_deck, only : read_deck
   use dda_result_tables, only : check_origin, close_tables, left_out, name_tables, &
      & open_tables, result_tables_t
   use dda_run_record, only : run_record
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_lines, check_scene
   use dda_screen, only : end_watch, print_line, print_warnings, terminal_watch_t
   use dda_table_file, only : remove_file
   use dda_text, only : to_text
   use dda_vehicle_list, only : vehicle_words
   implicit none

   !> Maximum number of concurrent cases
   integer, parameter :: max_jobs = 256

   interface
      !> C: lock an open file; other file descriptors of the file do not share the lock
      function c_flock(descriptor, operation) bind(c, name="flock") result(failed)
         import :: c_int
         integer(c_int), intent(in), value :: descriptor  !! File descriptor
         integer(c_int), intent(in), value :: operation   !! Kind of lock
         integer(c_int) :: failed                         !! 0 if the file is locked
      end function c_flock

      !> C: identifier of this process
      function c_getpid() bind(c, name="getpid") result(number)
         import :: c_int
         integer(c_int) :: number
      end function c_getpid
   end interface

   !> Cases finished by an earlier run
   type :: finished_t
      logical :: same_deck = .false.   !! True if it had the same deck, settings and program
      logical, allocatable :: case(:)  !! True for finished cases: (n)
      integer :: count(2) = 0          !! Number of cases with a verdict, and of undecided ones: (2)
   end type finished_t

   interface

      !> Find the finished cases
      module subroutine find_finished(tables, record, total, finished)
         type(result_tables_t), intent(in) :: tables
         character(len=*), intent(in) :: record  !! Record of deck and program
         integer, intent(in) :: total            !! Number of cases
         type(finished_t), intent(out) :: finished
      end subroutine find_finished

      !> Reopen all tables with the rows of finished cases only
      module subroutine reopen_tables(tables, finished, error)
         type(result_tables_t), intent(inout) :: tables
         type(finished_t), intent(in) :: finished
         type(error_t), allocatable, intent(out) :: error
      end subroutine reopen_tables

      !> Compute cases until none is left or writing fails; runs in each thread. Finished cases are
      !> written in the same critical section in which the next ones are prepared, so that threads
      !> wait once
      module subroutine run_cases(command, name, deck, scene, chosen, next, tables, shown, count, &
         & error)
         type(command_t), intent(in) :: command
         character(len=*), intent(in) :: name  !! Name of the deck
         !> The deck; of a single case the corners of the blocks are moved out of it
         type(deck_t), intent(inout) :: deck
         type(scene_t), intent(inout) :: scene  !! Scene of a single case, if a check has made it
         logical, intent(in) :: chosen(:)       !! Cases to be computed
         integer, intent(inout) :: next         !! Last case taken by any thread
         type(result_tables_t), intent(inout) :: tables
         type(case_table_t), intent(inout) :: shown
         integer, intent(inout) :: count(3)  !! Number of cases decided, undecided, written: (3)
         type(error_t), allocatable, intent(inout) :: error  !! Allocated if writing fails
      end subroutine run_cases

   end interface

   !> C's LOCK_EX and LOCK_NB: exclusive, without waiting
   integer(c_int), parameter :: alone = 2, at_once = 4

contains

   !> Run all decks of the command line; an invalid deck does not stop the others
   module procedure run_decks
      type(deck_t), allocatable :: deck(:)
      type(scene_t), allocatable :: scene(:)
      type(error_t), allocatable :: error
      logical, allocatable :: chosen(:)
      logical :: good(size(command%name))
      integer :: i, deck_status

      allocate (deck(size(command%name)), scene(size(command%name)))
      status = exit_status%success
      do i = 1, size(deck)
         call read_and_check(command, i, deck(i), scene(i), error)
         if (.not. allocated(error)) call check_lines(deck(i), error)
         if (.not. command%quiet) call print_warnings(deck(i)%warnings)
         if (.not. allocated(error)) call check_folder(command, i, good(:i - 1), error)
         if (.not. allocated(error)) call choose_cases(command%cases, &
            & n_cases(deck(i)), chosen, error)
         good(i) = .not. allocated(error)
         if (.not. good(i)) then
            write (error_unit, "(a)") error_line(error)
            status = exit_status%bad_input
         end if
      end do
      do i = 1, size(deck)
         if (.not. good(i)) cycle
         call run_deck(command, command%name(i)%text, deck(i), scene(i), deck_status)
         status = worst_status(status, deck_status)
      end do
   end procedure run_decks

   !> Run all cases of one deck
   subroutine run_deck(command, name, deck, scene, status)
      type(command_t), intent(in) :: command
      character(len=*), intent(in) :: name
      type(deck_t), intent(inout) :: deck
      type(scene_t), intent(inout) :: scene
      integer, intent(out) :: status  !! Exit status of this deck
      type(result_tables_t) :: tables
      type(finished_t) :: finished
      type(case_table_t) :: shown
      type(error_t), allocatable :: error
      logical, allocatable :: chosen(:)
      integer :: count(3), next, total

      total = n_cases(deck)
      count = 0
      call choose_cases(command%cases, total, chosen, error)
      call name_tables(deck, folder_of(command, name), tables)
      call begin_tables(command, name, deck, total, tables, finished, error)
      chosen = chosen .and. .not. finished%case
      if (vehicle_words(deck) /= "" .and. .not. command%quiet) call print_line(command%screen, &
         & name//": "//vehicle_words(deck))
      call new_case_table(command%screen, deck, chosen, shown)
      next = 0
      !$omp parallel num_threads(min(command%jobs, total, max_jobs)) default(none) &
      !$omp shared(deck, scene, name, command, tables, shown, count, error, chosen, next)
      call run_cases(command, name, deck, scene, chosen, next, tables, shown, count, error)
      !$omp end parallel
      call end_case_table(shown)
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
         call print_line(command%screen, name//": "//to_text(count(1))//" decided, " &
            & //to_text(count(2))//" undecided; results in "//tables%folder//"/results.csv")
         if (left_out(deck) /= "") call print_line(command%screen, name//": "//left_out(deck))
      end if
   end subroutine run_deck

   !> Start the tables, or continue those of an earlier run of the same deck
   subroutine begin_tables(command, name, deck, total, tables, finished, error)
      type(command_t), intent(in) :: command
      character(len=*), intent(in) :: name
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: total
      type(result_tables_t), intent(inout) :: tables
      type(finished_t), intent(out) :: finished
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: found, record

      allocate (finished%case(total), source=.false.)
      call make_folder(tables%folder)
      call lock_folder(tables%folder, command%quiet, error)
      if (.not. allocated(error) .and. .not. command%force) call check_origin(tables, error)
      if (allocated(error)) return
      record = run_record(deck, deck_stem(name))
      if (command%resume) then
         call find_finished(tables, record, total, finished)
         found = "nothing to resume: the deck, its settings or the program have changed; "// &
            & "all cases are computed"
         if (finished%same_deck) found = "resumed, "//to_text(sum(finished%count))//" of " &
            & //to_text(total)//" cases are already computed"
         if (.not. command%quiet) call print_line(command%screen, name//": "//found)
      end if
      if (finished%same_deck) then
         call reopen_tables(tables, finished, error)
      else
         call open_tables(tables, record, error)
      end if
   end subroutine begin_tables

   !> Read a deck, and check that its scene can be run
   subroutine read_and_check(command, number, deck, scene, error)
      type(command_t), intent(in) :: command
      integer, intent(in) :: number  !! Number of the deck
      type(deck_t), intent(out) :: deck
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(terminal_watch_t) :: watch

      watch%shown = error_is_terminal() .and. .not. command%quiet
      call read_deck(command%name(number)%text, command%setting, deck, error, watch, &
         & command%cases, command%tight)
      if (.not. allocated(error)) call check_scene(deck, scene, error, watch, &
         & command%cases)
      call end_watch(watch)
   end subroutine read_and_check

   !> Check that no two decks write into the same folder
   subroutine check_folder(command, number, good, error)
      type(command_t), intent(in) :: command
      integer, intent(in) :: number
      logical, intent(in) :: good(:)  !! True for earlier decks that will run: (number - 1)
      type(error_t), allocatable, intent(inout) :: error
      integer :: i

      do i = 1, number - 1
         if (.not. good(i) .or. folder_of(command, command%name(i)%text) &
            & /= folder_of(command, command%name(number)%text)) cycle
         call fatal_error(error, "expected a deck with a folder of its own, got "// &
            & folder_of(command, command%name(i)%text)//", to which "//command%name(i)%text// &
            & " writes too; rename one deck", command%name(number)%text, 1)
         return
      end do
   end subroutine check_folder

   !> Lock a folder until the end of the program, before changing anything in it
   subroutine lock_folder(folder, quiet, error)
      character(len=*), intent(in) :: folder  !! Name of the existing folder
      logical, intent(in) :: quiet            !! True to suppress the warning
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: file
      type(binary_file_t) :: held

      file = folder//"/run.lock"
      call remove_link(file)
      call open_binary(file, held, error, keep=.true.)
      if (allocated(error)) return
      if (is_locked(held)) return
      if (has_locks(file)) then
         call fatal_error(error, "expected a folder that no other run or deck writes to, got "// &
            & "one in use; choose another folder with --out, or wait for that run to end", file, 1)
      else if (.not. quiet) then
         write (error_unit, "(a)") file//":1: warning: this file system has no locks; "// &
            & "let no other run write to "//folder
      end if
   end subroutine lock_folder

   !> Lock an open file; true on success
   logical function is_locked(file)
      !> The file; it stays locked until the end of the program
      type(binary_file_t), intent(in) :: file
      integer(c_int) :: failed

      failed = c_flock(int(descriptor_of(file), c_int), ior(alone, at_once))
      is_locked = failed == 0
   end function is_locked

   !> True if the file system supports locks, tested with a new file
   logical function has_locks(file)
      character(len=*), intent(in) :: file  !! Name of the file that could not be locked
      character(len=:), allocatable :: name
      type(binary_file_t) :: probe
      type(error_t), allocatable :: error

      name = file//"."//to_text(int(c_getpid()))
      call open_binary(name, probe, error)
      has_locks = .true.
      if (allocated(error)) return
      has_locks = is_locked(probe)
      call close_binary(probe, error)
      call remove_file(name)
   end function has_locks

   !> Folder of the results of a deck
   pure function folder_of(command, name) result(folder)
      type(command_t), intent(in) :: command
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: folder  !! Name of the folder
      folder = deck_stem(name)
      if (.not. allocated(command%out)) return
      if (size(command%name) == 1) then
         folder = command%out
      else
         folder = command%out//"/"//folder
      end if
   end function folder_of

end submodule dda_run
