!> Cases of a deck in sequence: prepare, compute, write
submodule (dda_verbs:dda_run) dda_run_cases
   use dda_case, only : case_t, prepare_case
   use dda_case_rows, only : tell_case
   use dda_case_table, only : add_case
   use dda_compute_case, only : compute_case
   use dda_deck_sweep, only : turn_to_case
   use dda_key_names, only : output_restart
   use dda_kinds, only : wp
   use dda_force_rows, only : proof_forces_lines, proof_motion_lines
   use dda_restart, only : save_restart
   use dda_result_tables, only : swept_fields, table, write_case, write_waiting
   use dda_scene, only : move_scene
   use dda_table_file, only : append_line
   use dda_write_results, only : joint_row_t, result_row_t, told_blocks_t
   implicit none

   !> Maximum number of cases per batch
   integer, parameter :: max_batch = 32
   !> Duration up to which cases form a batch [s]
   real(wp), parameter :: short_batch = 2.0e-3_wp

   interface

      !> Write the frames, bars, monitoring points, energies and reactions of a case
      module subroutine write_pictures(tables, number, this, error)
         type(result_tables_t), intent(inout) :: tables
         integer, intent(in) :: number  !! Number of the case
         type(case_t), intent(in) :: this
         type(error_t), allocatable, intent(inout) :: error
      end subroutine write_pictures

   end interface

contains

   !> Compute cases until none is left or writing fails
   module procedure run_cases
      type(case_t), allocatable :: batch(:)
      type(case_t) :: empty
      integer :: number(max_batch), i, most, n

      allocate (batch(max_batch), source=empty)
      n = 0
      most = 1
      do
         !$omp critical (texts)
         do i = 1, n
            if (.not. allocated(error)) call write_down(command, name, deck, number(i), &
               & batch(i), tables, shown, count, error)
         end do
         if (n > 0) call write_waiting(tables, error)
         n = 0
         if (.not. allocated(error)) then
            call take_cases(chosen, min(most, 1 + (size(chosen) - next)/(4*command%jobs)), next, &
               & number, n)
            do i = 1, n
               call prepare(deck, scene, number(i), tables, batch(i))
            end do
         end if
         !$omp end critical (texts)
         if (n == 0) exit
         do i = 1, n
            call compute_case(batch(i))
         end do
         if (command%jobs > 1) most = next_batch(n, sum(batch(:n)%seconds))
      end do
   end procedure run_cases

   !> Number of cases of the next batch, from the time of the last one
   pure integer function next_batch(n, seconds)
      integer, intent(in) :: n         !! Cases of the last batch
      real(wp), intent(in) :: seconds  !! Time of the last batch [s]

      next_batch = max(1, n/2)
      if (seconds < short_batch) next_batch = n
      if (2.0_wp*seconds < short_batch) next_batch = min(max_batch, 2*n)
   end function next_batch

   !> Take the next chosen cases
   pure subroutine take_cases(chosen, most, next, number, n)
      logical, intent(in) :: chosen(:)
      integer, intent(in) :: most          !! Maximum number of cases to take
      integer, intent(inout) :: next
      integer, intent(inout) :: number(:)  !! Numbers of the first n cases: (max_batch)
      integer, intent(out) :: n            !! Number of cases taken

      n = 0
      do while (n < most .and. next < size(chosen))
         next = next + 1
         if (.not. chosen(next)) cycle
         n = n + 1
         number(n) = next
      end do
   end subroutine take_cases

   !> Prepare one case for its computation
   subroutine prepare(deck, scene, number, tables, this)
      type(deck_t), intent(inout) :: deck
      !> Scene of a single case, if a check has made it; moved into the case
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: number
      type(result_tables_t), intent(in) :: tables
      !> An earlier case of the deck, if any: only the swept values of its deck change
      type(case_t), intent(inout) :: this
      type(deck_t), allocatable :: turned
      type(error_t), allocatable :: problem
      real(wp), allocatable :: vertex(:, :)

      ! the deck of a search for the worst vehicle position was changed and cannot be reused
      if (.not. this%has_worst) call move_alloc(this%family%deck, turned)
      if (.not. allocated(turned)) allocate (turned)
      if (n_cases(deck) == 1) call move_alloc(deck%plan%vertex, vertex)
      call turn_to_case(deck, number, turned, problem)
      if (allocated(vertex)) call move_alloc(vertex, turned%plan%vertex)
      call prepare_case(turned, this)
      if (n_cases(deck) == 1) call move_scene(scene, this%scene)
      this%writes_tables = any(tables%at([table%joints, table%blocks])%wanted)
      this%proves = tables%at(table%proof_forces)%wanted
   end subroutine prepare

   !> Write a computed case
   subroutine write_down(command, name, deck, number, this, tables, shown, count, error)
      type(command_t), intent(in) :: command
      character(len=*), intent(in) :: name
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: number
      type(case_t), intent(in) :: this
      type(result_tables_t), intent(inout) :: tables
      type(case_table_t), intent(inout) :: shown
      integer, intent(inout) :: count(3)
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
      if (.not. allocated(error)) call write_proof(tables, number, this, error)
      if (this%family%deck%value(output_restart)%flag .and. this%scene%settings%dynamic &
         & .and. .not. (allocated(error) .or. allocated(this%error))) call save_restart( &
         & tables%folder//"/case_"//to_text(number)//".restart", this%scene%settings, &
         & this%decision%system, this%decision%contacts, this%onward, error)
      if (.not. allocated(error)) call write_case(tables, row, joint_row, blocks, remark, error)
      if (allocated(error)) return
      count(3) = count(3) + 1
      count(merge(2, 1, row%verdict == "undecided")) = &
         & count(merge(2, 1, row%verdict == "undecided")) + 1
      if (.not. command%quiet) call add_case(shown, deck, row, remark)
   end subroutine write_down

   !> Write the certificate of the verdict of a case
   subroutine write_proof(tables, number, this, error)
      type(result_tables_t), intent(inout) :: tables
      integer, intent(in) :: number
      type(case_t), intent(in) :: this
      type(error_t), allocatable, intent(inout) :: error
      character(len=:), allocatable :: lines, value

      if (.not. tables%at(table%proof_forces)%wanted) return
      value = ""
      if (this%searches) value = to_text(this%proof%force_at)
      lines = proof_forces_lines(number, value, this%proof)
      call append_line(tables%at(table%proof_forces)%open, lines, error)
      if (allocated(error)) return
      if (this%searches) value = to_text(this%proof%motion_at)
      lines = proof_motion_lines(number, value, this%proof)
      call append_line(tables%at(table%proof_motion)%open, lines, error)
   end subroutine write_proof

end submodule dda_run_cases
