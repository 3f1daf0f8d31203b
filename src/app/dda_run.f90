!> dda run: decks to results
module dda_run
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_case, only : case_t, compute_case, prepare_case, tell_case
   use dda_command_line, only : command_t
   use dda_deck, only : deck_t, flag_of, integer_of
   use dda_deck_sweep, only : case_deck, n_cases, swept_names, swept_texts
   use dda_deck_scene, only : check_scene, warning_line
   use dda_error, only : error_line, error_t, fatal_error
   use dda_picture_files, only : write_album
   use dda_process, only : error_is_terminal, exit_status, make_folder, worst_status
   use dda_progress, only : clear_progress, progress_t, report_progress
   use dda_read_deck, only : read_deck
   use dda_summary, only : print_row, print_total
   use dda_table_file, only : append_line, close_table, open_table, remove_file, table_file_t
   use dda_text, only : to_text
   use dda_write_frames, only : frame_joints_header, frames_header
   use dda_write_results, only : joint_line, joint_row_t, joints_header, result_row_t, &
      & results_header, results_line
   implicit none
   private

   public :: run_decks, deck_stem

   !> Where the results of one deck go
   type :: tables_t
      !> Name of the folder
      character(len=:), allocatable :: folder
      !> results.csv
      type(table_file_t) :: results
      !> joints.csv
      type(table_file_t) :: joints
      !> log.txt
      type(table_file_t) :: log
      !> frames.csv
      type(table_file_t) :: frames
      !> frame_joints.csv
      type(table_file_t) :: frame_joints
      !> Whether joints.csv is wanted
      logical :: has_joints = .false.
      !> Whether pictures are wanted
      logical :: has_frames = .false.
      !> Whether pictures are wanted as VTU too
      logical :: has_vtu = .false.
   end type tables_t

   !> Most cases at the same time
   integer, parameter :: max_jobs = 256
   !> Columns of results.csv that a swept parameter shares
   character(len=*), parameter :: own_column(*) = [character(len=16) :: "half_angle_deg", &
      & "thickness_ratio", "friction_deg", "mode", "geometry"]

contains

   !> Run all decks of the command line; a bad deck does not keep the others from running
   subroutine run_decks(command, status)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Exit status of the program
      integer, intent(out) :: status
      type(deck_t), allocatable :: deck(:)
      type(error_t), allocatable :: error
      logical :: good(size(command%name))
      integer :: i, deck_status, w

      allocate (deck(size(command%name)))
      status = exit_status%success
      do i = 1, size(deck)
         call read_deck(trim(command%name(i)), command%setting, deck(i), error)
         if (.not. allocated(error)) call check_scene(deck(i), error)
         if (.not. allocated(error)) call check_folder(command, i, good(:i - 1), error)
         good(i) = .not. allocated(error)
         do w = 1, merge(size(deck(i)%plan%warning), 0, good(i) .and. .not. command%quiet)
            write (error_unit, "(a)") warning_line(deck(i), w)
         end do
         if (good(i)) cycle
         write (error_unit, "(a)") error_line(error)
         status = exit_status%bad_input
      end do
      do i = 1, size(deck)
         if (.not. good(i)) cycle
         call run_deck(command, trim(command%name(i)), deck(i), deck_status)
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
         if (.not. good(i) .or. folder_of(command, trim(command%name(i))) &
            & /= folder_of(command, trim(command%name(number)))) cycle
         call fatal_error(error, "a deck with a folder of its own is wanted, "// &
            & trim(command%name(i))//" writes to the same one", trim(command%name(number)), 1)
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
      type(tables_t) :: tables
      type(progress_t) :: progress
      type(error_t), allocatable :: error
      integer :: count(3), number, total

      total = n_cases(deck)
      count = 0
      tables%folder = folder_of(command, name)
      tables%has_joints = flag_of(deck, "output", "joints")
      tables%has_frames = integer_of(deck, "output", "frames") > 0
      tables%has_vtu = flag_of(deck, "output", "vtu")
      call open_tables(deck, tables, error)
      progress%shown = error_is_terminal()
      if (command%quiet) progress%shown = .false.
      progress%total = total
      call system_clock(progress%start)
      !$omp parallel do num_threads(min(command%jobs, total, max_jobs)) schedule(dynamic) &
      !$omp default(none) shared(total, deck, name, command, tables, progress, count, error)
      do number = 1, total
         call run_one_case(command, name, deck, number, total, tables, progress, count, error)
      end do
      !$omp end parallel do
      call clear_progress(progress)
      call close_table(tables%results)
      call close_table(tables%joints)
      call close_table(tables%log)
      call close_table(tables%frames)
      call close_table(tables%frame_joints)
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

   !> Compute one case and write it down; nothing is computed after a failure to write
   subroutine run_one_case(command, name, deck, number, total, tables, progress, count, error)
      !> What the user asked for
      type(command_t), intent(in) :: command
      !> Name of the deck
      character(len=*), intent(in) :: name
      !> The deck with its sweeps
      type(deck_t), intent(in) :: deck
      !> Number of the case
      integer, intent(in) :: number
      !> Number of cases
      integer, intent(in) :: total
      !> Where the results go
      type(tables_t), intent(in) :: tables
      !> What was told so far
      type(progress_t), intent(inout) :: progress
      !> Cases decided, undecided, written: (3)
      integer, intent(inout) :: count(3)
      !> Failure to write
      type(error_t), allocatable, intent(inout) :: error
      type(deck_t) :: case_of_deck
      type(case_t) :: this
      type(error_t), allocatable :: problem
      type(result_row_t) :: row
      type(joint_row_t), allocatable :: joint_row(:)
      character(len=:), allocatable :: remark
      logical :: failed

      !$omp critical (texts)
      failed = allocated(error)
      if (.not. failed) then
         call case_deck(deck, number, case_of_deck, problem)
         call prepare_case(case_of_deck, this)
      end if
      !$omp end critical (texts)
      if (failed) return
      call compute_case(this)
      !$omp critical (texts)
      if (.not. allocated(error)) then
         call tell_case(this, row, joint_row, remark)
         row%deck = deck_stem(name)
         row%number = number
         row%swept = swept_fields(deck, number)
         joint_row%number = number
         if (tables%has_frames) call write_album(tables%folder, number, tables%has_vtu, &
            & this%scene%system, this%scene%contacts, this%album, tables%frames, &
            & tables%frame_joints, error)
         if (.not. allocated(error)) call write_case(tables, row, joint_row, remark, error)
      end if
      if (.not. allocated(error)) then
         count(3) = count(3) + 1
         count(merge(2, 1, row%verdict == "undecided")) = &
            & count(merge(2, 1, row%verdict == "undecided")) + 1
         call clear_progress(progress)
         if (.not. command%quiet) call print_row(row, remark, total, count(3))
         call report_progress(progress)
      end if
      !$omp end critical (texts)
   end subroutine run_one_case

   !> Make the folder and begin the tables
   subroutine open_tables(deck, tables, error)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> The tables; their units are set
      type(tables_t), intent(inout) :: tables
      !> Allocated if they cannot be written
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: names
      integer :: s

      names = ""
      associate (swept => swept_names(deck))
         do s = 1, size(swept)
            if (all(own_column /= swept(s))) names = names//trim(swept(s))//","
         end do
      end associate
      call make_folder(tables%folder)
      call open_table(tables%folder//"/results.csv", results_header(names), tables%results, error)
      if (.not. allocated(error)) &
         & call open_table(tables%folder//"/log.txt", "case verdict remark", tables%log, error)
      if (allocated(error)) return
      if (tables%has_joints) then
         call open_table(tables%folder//"/joints.csv", joints_header(), tables%joints, error)
      else
         call remove_file(tables%folder//"/joints.csv")
      end if
      if (allocated(error) .or. .not. tables%has_frames) return
      call open_table(tables%folder//"/frames.csv", frames_header(), tables%frames, error)
      if (.not. allocated(error)) call open_table(tables%folder//"/frame_joints.csv", &
         & frame_joints_header(), tables%frame_joints, error)
   end subroutine open_tables

   !> Values of the swept parameters that have no column of their own, each with a comma behind it
   function swept_fields(deck, number) result(fields)
      !> The deck
      type(deck_t), intent(in) :: deck
      !> Number of the case
      integer, intent(in) :: number
      !> The fields
      character(len=:), allocatable :: fields
      integer :: s

      fields = ""
      associate (swept => swept_names(deck), texts => swept_texts(deck, number))
         do s = 1, size(swept)
            if (all(own_column /= swept(s))) fields = fields//trim(texts(s))//","
         end do
      end associate
   end function swept_fields

   !> Write the rows of one case: the joints first, so that a case with a row is whole
   subroutine write_case(tables, row, joint_row, remark, error)
      !> The tables
      type(tables_t), intent(in) :: tables
      !> Row of the case
      type(result_row_t), intent(in) :: row
      !> Rows of its joints
      type(joint_row_t), intent(in) :: joint_row(:)
      !> What goes to the log
      character(len=*), intent(in) :: remark
      !> Allocated if they cannot be written
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: lines
      integer :: j

      if (tables%has_joints .and. size(joint_row) > 0) then
         lines = joint_line(joint_row(1))
         do j = 2, size(joint_row)
            lines = lines//new_line("a")//joint_line(joint_row(j))
         end do
         call append_line(tables%joints, lines, error)
         if (allocated(error)) return
      end if
      call append_line(tables%log, to_text(row%number)//" " &
         & //trim(trim(row%verdict)//" "//remark), error)
      if (allocated(error)) return
      call append_line(tables%results, results_line(row), error)
   end subroutine write_case
end module dda_run
