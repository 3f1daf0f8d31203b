!> Result tables of one deck: start, rows per case, end
!>
!> A row passed to the system survives the end of the program. Rows that a power failure takes are
!> found by the checksums of sizes.record.
module dda_result_tables
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_binary_file, only : is_link
   use dda_check_sum, only : add_sums, line_sum
   use dda_deck, only : deck_t, has_group
   use dda_deck_sweep, only : few_cases, n_cases, swept_texts
   use dda_error, only : error_t, fatal_error
   use dda_fill_loads, only : fill_yields
   use dda_force_rows, only : bars_header, proof_forces_header, proof_motion_header
   use dda_key_names, only : output_blocks, output_condition, output_energy, output_frames, &
      & output_joints, output_proof, output_reactions, output_vtu, search_group, tie_group
   use dda_kinds, only : wp
   use dda_table_file, only : append_line, close_table, field_number, first_line, open_table, &
      & remove_file, table_file_t, without_field
   use dda_text, only : add_line, bytes_of, fields, growing_text_t, lines_of, to_text
   use dda_write_frames, only : frame_joints_header, frames_header, points_header
   use dda_write_results, only : block_lines, blocks_header, energy_header, joint_line, &
      & joint_row_t, joints_header, reactions_header, result_row_t, results_header, results_line, &
      & told_blocks_t
   implicit none
   private

   public :: result_tables_t, result_table_t, table, table_enum
   public :: name_tables, check_origin, open_tables, close_tables, write_case, write_waiting
   public :: swept_fields, left_out, common_total

   !> Numbers of the tables in result_tables_t
   type :: table_enum
      integer :: results = 1       !! One row per case
      integer :: joints = 2        !! One row per joint
      integer :: log = 3           !! One line per case
      integer :: frames = 4        !! One row per corner of a frame
      integer :: frame_joints = 5  !! One row per joint of a frame
      integer :: points = 6        !! One row per monitoring point and step
      integer :: energy = 7        !! One row per step
      integer :: blocks = 8        !! One row per corner of a block
      !> One row per case: its bytes in all tables except this one and results.csv, and the checksum
      !> of its lines there
      integer :: sizes = 9
      integer :: proof_forces = 10  !! One row per joint: forces of the certificate
      integer :: proof_motion = 11  !! One row per block: velocities of the certificate
      integer :: bars = 12          !! One row per bar and time
      integer :: reactions = 13     !! One row per support, in dynamic runs per support and step
   end type table_enum

   !> Names of the tables
   type(table_enum), parameter :: table = table_enum()

   !> Size of the buffer for joint rows [bytes]
   integer, parameter :: most_bytes = 65536

   !> One table
   type :: result_table_t
      character(len=:), allocatable :: file    !! Name of the file with its folder
      character(len=:), allocatable :: header  !! First line
      logical :: wanted = .true.               !! True if the table is written
      type(table_file_t) :: open               !! The open file
   end type result_table_t

   !> Result tables of one deck
   type :: result_tables_t
      character(len=:), allocatable :: folder  !! Name of the folder
      type(result_table_t) :: at(13)           !! The tables, by their numbers
      integer :: seconds = 0                   !! Column of results.csv that differs in every run
      !> Bytes of all tables except results.csv and sizes.record after the last case, and the
      !> checksum of their lines: (2)
      integer(int64) :: total(2) = 0
      !> Unwritten lines of the log, sizes.record and results.csv
      type(growing_text_t) :: waiting(3)
      integer(int64) :: waiting_sum = 0             !! Checksum of the unwritten lines of the log
      character(len=:), allocatable :: record_file  !! File with the record of deck and program
      logical :: has_vtu = .false.  !! True to write frames as VTU too
   end type result_tables_t

   !> Characters of a header that identify a table
   integer, parameter :: origin_length = 9

   !> Columns of results.csv that are also swept parameters
   character(len=*), parameter :: own_column(*) = [character(len=16) :: "half_angle_deg", &
      & "thickness_ratio", "friction_deg", "mode", "geometry", "unknowns"]

contains

   !> Set names and headers of the tables of a deck, without access to files
   subroutine name_tables(deck, folder, tables)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: folder  !! Name of the folder
      type(result_tables_t), intent(out) :: tables
      character(len=:), allocatable :: log, names
      logical :: searches, wanted
      integer :: s

      names = ""
      do s = 1, size(deck%sweeps)
         if (all(own_column /= deck%sweeps(s)%name)) names = names//trim(deck%sweeps(s)%name)//","
      end do
      tables%folder = folder
      tables%record_file = folder//"/deck.record"
      tables%has_vtu = deck%value(output_vtu)%flag
      searches = has_group(deck, search_group)
      call name_table(table%results, "/results.csv", results_header(names, &
         & deck%value(output_condition)%flag), .true.)
      tables%seconds = field_number(tables%at(table%results)%header, "seconds")
      log = "case verdict remark"
      if (left_out(deck) /= "") log = log//" ("//left_out(deck)//")"
      call name_table(table%log, "/log.txt", log, .true.)
      call name_table(table%sizes, "/sizes.record", "case,bytes,sum", .true.)
      call name_table(table%joints, "/joints.csv", joints_header, deck%value(output_joints)%flag)
      call name_table(table%blocks, "/blocks.csv", blocks_header, deck%value(output_blocks)%flag)
      wanted = nint(deck%value(output_frames)%number) > 0
      call name_table(table%frames, "/frames.csv", frames_header, wanted)
      call name_table(table%frame_joints, "/frame_joints.csv", frame_joints_header, wanted)
      wanted = .false.
      if (allocated(deck%plan%boundary%measured)) wanted = size(deck%plan%boundary%measured) > 0
      call name_table(table%points, "/points.csv", points_header, wanted .and. .not. searches)
      call name_table(table%reactions, "/reactions.csv", reactions_header, &
         & deck%value(output_reactions)%flag .and. .not. searches)
      call name_table(table%energy, "/energy.csv", energy_header, &
         & deck%value(output_energy)%flag .and. .not. searches)
      wanted = deck%value(output_proof)%flag
      call name_table(table%proof_forces, "/proof_forces.csv", proof_forces_header, wanted)
      call name_table(table%proof_motion, "/proof_motion.csv", proof_motion_header, wanted)
      wanted = allocated(deck%plan%boundary%bar) .or. has_group(deck, tie_group) &
         & .or. fill_yields(deck)
      if (allocated(deck%cut)) wanted = size(deck%cut%bolt) > 0
      call name_table(table%bars, "/bars.csv", bars_header, wanted)

   contains

      !> Set name and header of one table
      subroutine name_table(place, name, header, wanted)
         integer, intent(in) :: place            !! Number of the table
         character(len=*), intent(in) :: name    !! Name of the file in the folder
         character(len=*), intent(in) :: header  !! First line
         logical, intent(in) :: wanted           !! True if the table is written

         tables%at(place)%file = folder//name
         tables%at(place)%header = header
         tables%at(place)%wanted = wanted
      end subroutine name_table
   end subroutine name_tables

   !> Sentence on tables that are not written because there are many cases, and the keys that write
   !> them; empty if there are none
   pure function left_out(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text
      character(len=:), allocatable :: files, keys

      text = ""
      if (n_cases(deck) <= few_cases) return
      files = ""
      keys = ""
      if (.not. deck%value(output_joints)%given) then
         files = " and joints.csv"
         keys = ", output%joints = .true."
      end if
      if (.not. deck%value(output_blocks)%given) then
         files = files//" and blocks.csv"
         keys = keys//", output%blocks = .true."
      end if
      if (files /= "") text = "no "//files(6:)//" of more than "//to_text(few_cases) &
         & //" cases without "//keys(3:)
   end function left_out

   !> Report an error if a file with the name of a table has another header, because another program
   !> has written it. Symbolic links are replaced and their targets kept
   subroutine check_origin(tables, error)
      type(result_tables_t), intent(in) :: tables
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: found, own
      integer :: i

      do i = 1, size(tables%at)
         if (allocated(error)) return
         if (is_link(tables%at(i)%file)) cycle
         found = first_line(tables%at(i)%file)
         own = tables%at(i)%header(:origin_length)
         ! a full disk may have ended an earlier run within the header
         if (index(found, own) == 1 .or. index(own, found) == 1) cycle
         call fatal_error(error, "expected a table that begins with "//own//", got a file that " &
            & //"dda has not written; choose another folder with --out, or overwrite it with " &
            & //"--force", tables%at(i)%file, 1)
      end do
   end subroutine check_origin

   !> Start all tables; those of an earlier run are replaced or removed
   subroutine open_tables(tables, record, error)
      type(result_tables_t), intent(inout) :: tables
      character(len=*), intent(in) :: record  !! Record of deck and program
      type(error_t), allocatable, intent(out) :: error
      type(table_file_t) :: file
      integer :: i

      ! remove the record first: if the run is killed here, old rows must not be taken for new ones
      call remove_file(tables%record_file)
      do i = 1, size(tables%at)
         associate (this => tables%at(i))
            if (this%wanted) then
               call open_table(this%file, this%header, this%open, error)
            else
               call remove_file(this%file)
            end if
         end associate
         if (allocated(error)) return
      end do
      tables%total = common_total(tables)
      call open_table(tables%record_file, record, file, error)
      call close_table(file, error)
   end subroutine open_tables

   !> Close all tables
   subroutine close_tables(tables, error)
      type(result_tables_t), intent(inout) :: tables
      type(error_t), allocatable, intent(inout) :: error
      integer :: i

      do i = 1, size(tables%at)
         call close_table(tables%at(i)%open, error)
      end do
   end subroutine close_tables

   !> Values of the swept parameters without their own column, each followed by a comma
   function swept_fields(deck, number) result(fields)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number  !! Number of the case
      character(len=:), allocatable :: fields
      integer :: s

      fields = ""
      associate (texts => swept_texts(deck, number))
         do s = 1, size(texts)
            if (all(own_column /= deck%sweeps(s)%name)) fields = fields//trim(texts(s))//","
         end do
      end associate
   end function swept_fields

   !> Bytes of all tables except results.csv and sizes.record, and the checksum of their appended
   !> lines
   pure function common_total(tables) result(total)
      type(result_tables_t), intent(in) :: tables
      integer(int64) :: total(2)  !! Bytes and checksum: (2)
      integer :: i

      total = 0
      do i = 1, size(tables%at)
         if (i == table%results .or. i == table%sizes) cycle
         associate (file => tables%at(i)%open)
            total = [total(1) + file%length, add_sums(total(2), file%sum)]
         end associate
      end do
   end function common_total

   !> Write the rows of one case; its frames, points and certificate are already written. The rows
   !> of the log, sizes.record and results.csv are kept for write_waiting
   subroutine write_case(tables, row, joint_row, blocks, remark, error)
      type(result_tables_t), intent(inout) :: tables
      type(result_row_t), intent(in) :: row
      type(joint_row_t), intent(in) :: joint_row(:)  !! Rows of its joints
      type(told_blocks_t), intent(in) :: blocks
      character(len=*), intent(in) :: remark         !! Remark for the log
      type(error_t), allocatable, intent(inout) :: error
      type(growing_text_t) :: lines
      character(len=:), allocatable :: log, results
      integer(int64) :: own, total(2)
      integer :: j

      if (tables%at(table%joints)%wanted) then
         do j = 1, size(joint_row)
            call add_line(lines, joint_line(joint_row(j)))
            if (bytes_of(lines) < most_bytes .and. j < size(joint_row)) cycle
            call append_line(tables%at(table%joints)%open, lines_of(lines), error)
            if (allocated(error)) return
            lines = growing_text_t()
         end do
      end if
      if (tables%at(table%blocks)%wanted .and. allocated(blocks%state)) then
         call append_line(tables%at(table%blocks)%open, block_lines(row%number, blocks), error)
         if (allocated(error)) return
      end if
      log = to_text(row%number)//" "//trim(trim(row%verdict)//" "//remark)
      call add_line(tables%waiting(1), log)
      tables%waiting_sum = add_sums(tables%waiting_sum, line_sum(log))
      total = common_total(tables) + [int(bytes_of(tables%waiting(1)), int64), tables%waiting_sum]
      results = results_line(row)
      own = add_sums(total(2) - tables%total(2), line_sum(without_field(results, tables%seconds)))
      call add_line(tables%waiting(2), to_text(row%number)//"," &
         & //fields(real([total(1) - tables%total(1), own], wp)))
      tables%total = total
      call add_line(tables%waiting(3), results)
   end subroutine write_case

   !> Write the kept rows, those of results.csv last, so that a case with a row there is complete
   subroutine write_waiting(tables, error)
      type(result_tables_t), intent(inout) :: tables
      type(error_t), allocatable, intent(inout) :: error  !! An earlier error or a failure to write
      type(error_t), allocatable :: late
      integer :: i, place(3)

      place = [table%log, table%sizes, table%results]
      do i = 1, size(place)
         call append_line(tables%at(place(i))%open, lines_of(tables%waiting(i)), late)
         if (allocated(late)) exit
         tables%waiting(i) = growing_text_t()
      end do
      tables%waiting_sum = 0
      if (allocated(late) .and. .not. allocated(error)) call move_alloc(late, error)
   end subroutine write_waiting
end module dda_result_tables
