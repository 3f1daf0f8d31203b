!> Cases of a deck in sequence: prepare, compute, write
submodule (dda_verbs:dda_run) dda_run_cases
   use dda_binary_file, only : remove_link
   use dda_block_rows, only : contact_states, frame_joint_rows
   use dda_block_system, only : block_system_t
   use dda_case, only : case_t, prepare_case
   use dda_case_rows, only : tell_case
   use dda_case_table, only : add_case
   use dda_compute_case, only : compute_case
   use dda_deck_sweep, only : turn_to_case
   use dda_force_rows, only : bar_lines, proof_forces_lines, proof_motion_lines, reaction_text
   use dda_frames, only : album_t, frame_t
   use dda_key_names, only : output_restart
   use dda_kinds, only : wp
   use dda_restart, only : save_restart
   use dda_result_tables, only : swept_fields, table, write_case, write_waiting
   use dda_scene, only : move_scene
   use dda_table_file, only : append_line, table_file_t
   use dda_write_frames, only : frame_joint_lines, frame_joint_row_t, frame_lines, point_lines
   use dda_write_results, only : energy_lines, joint_row_t, result_row_t, told_blocks_t
   use dda_write_vtu, only : field_t, index_entry, scalar_field, state_field, tensor_field, &
      & vector_field, write_index, write_points, write_polygons
   implicit none

   !> Maximum number of cases per batch
   integer, parameter :: max_batch = 32
   !> Duration up to which cases form a batch [s]
   real(wp), parameter :: short_batch = 2.0e-3_wp

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

   !> Write the frames, bars, monitoring points, energies and reactions of a case
   subroutine write_pictures(tables, number, this, error)
      type(result_tables_t), intent(inout) :: tables
      integer, intent(in) :: number  !! Number of the case
      type(case_t), intent(in) :: this
      type(error_t), allocatable, intent(inout) :: error

      associate (at => tables%at, origin => this%scene%origin, album => this%album)
         if (at(table%frames)%wanted) call write_album(tables, number, this%scene%system, origin, &
            & album, error)
         if (at(table%bars)%wanted .and. .not. allocated(error)) &
            & call append_line(at(table%bars)%open, bar_lines(number, this), error)
         if (at(table%points)%wanted .and. .not. allocated(error)) &
            & call write_track(number, origin, album, at(table%points)%open, error)
         if (at(table%energy)%wanted .and. .not. allocated(error)) &
            & call write_energies(number, album, at(table%energy)%open, error)
         if (at(table%reactions)%wanted .and. .not. allocated(error)) &
            & call append_line(at(table%reactions)%open, reaction_text(number, this), error)
      end associate
   end subroutine write_pictures

   !> Write all frames of a case
   subroutine write_album(tables, number, system, origin, album, error)
      type(result_tables_t), intent(inout) :: tables
      integer, intent(in) :: number
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: origin(2)  !! Origin of the coordinates: (2) [m]
      type(album_t), intent(in) :: album
      type(error_t), allocatable, intent(inout) :: error
      type(frame_joint_row_t), allocatable :: row(:)
      character(len=:), allocatable :: case_and_frame, folder, index, stem
      real(wp) :: moment
      integer :: i, j

      stem = "case_"//to_text(number)
      folder = tables%folder//"/frames/"
      if (tables%has_vtu) then
         call remove_link(tables%folder//"/frames")
         call make_folder(tables%folder//"/frames")
      end if
      index = ""
      do i = 1, album%n
         if (allocated(error)) return
         associate (frame => album%frame(i))
            case_and_frame = to_text(number)//","//to_text(i - 1)
            ! steps of a static run have lengths, but no time
            moment = merge(real(i - 1, wp), frame%time, album%spacing > 0.0_wp)
            row = frame_joint_rows(frame)
            do j = 1, size(row)
               row(j)%point = row(j)%point + origin
               row(j)%contact = row(j)%contact + spread(origin, 2, 2)
            end do
            call append_line(tables%at(table%frames)%open, frame_lines(case_and_frame, &
               & frame%step, frame%time, system%first_vertex, &
               & frame%moved + spread(origin, 2, size(frame%moved, 2)), frame%absent), error)
            if (.not. allocated(error)) call append_line(tables%at(table%frame_joints)%open, &
               & frame_joint_lines(case_and_frame, row), error)
            if (allocated(error) .or. .not. tables%has_vtu) cycle
            call write_picture(folder//stem//"_"//to_text(i - 1), system, origin, frame, row, error)
            index = index//index_entry(moment, 0, stem//"_"//to_text(i - 1)//".vtu") &
               & //index_entry(moment, 1, stem//"_"//to_text(i - 1)//"_joints.vtu")
         end associate
      end do
      if (tables%has_vtu .and. .not. allocated(error)) &
         & call write_index(folder//stem//".pvd", index, error)
   end subroutine write_album

   !> Write the trajectories of the monitoring points of a case
   subroutine write_track(number, origin, album, points, error)
      integer, intent(in) :: number
      real(wp), intent(in) :: origin(2)
      type(album_t), intent(in) :: album
      type(table_file_t), intent(inout) :: points  !! points.csv
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: place(2, size(album%point))
      integer :: i

      if (album%n_track == 0 .or. size(album%point) == 0) return
      do i = 1, size(place, 2)
         place(:, i) = album%point(i)%point
      end do
      call append_line(points, point_lines(number, album%when(:, :album%n_track), place, &
         & album%track(:, :, :album%n_track), origin, album%speed), error)
   end subroutine write_track

   !> Write the energies of a case
   subroutine write_energies(number, album, table, error)
      integer, intent(in) :: number
      type(album_t), intent(in) :: album
      type(table_file_t), intent(inout) :: table  !! energy.csv
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: value(11, album%audit%n)
      integer :: i

      if (album%audit%n == 0) return
      do i = 1, size(value, 2)
         associate (energy => album%audit%energy(i))
            value(:, i) = [energy%time, energy%kinetic, energy%elastic, energy%contact, &
               & energy%gravity, energy%work, energy%friction, energy%damping, energy%impact, &
               & energy%numerical, energy%residual]
         end associate
      end do
      call append_line(table, energy_lines(number, value), error)
   end subroutine write_energies

   !> Write the blocks and joint forces of one frame
   subroutine write_picture(stem, system, origin, frame, row, error)
      character(len=*), intent(in) :: stem  !! Name of the file without its extension
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: origin(2)
      type(frame_t), intent(in) :: frame
      type(frame_joint_row_t), intent(in) :: row(:)  !! Joints of the frame: (n_joint)
      type(error_t), allocatable, intent(out) :: error
      type(field_t) :: of_corners(1), of_blocks(4), of_joints(3)
      real(wp) :: place(2, size(row)), force(2, size(row))
      integer :: states(2, size(row)), there(size(system%area)), b, j

      do j = 1, size(row)
         place(:, j) = row(j)%point
         force(:, j) = row(j)%force
         states(:, j) = contact_states(frame, j)
      end do
      of_corners(1) = vector_field("displacement", frame%moved - system%vertex)
      of_blocks(1) = state_field("block", [(b, b=1, size(system%area))])
      of_blocks(2) = scalar_field("rotation", frame%motion(3, :))
      of_blocks(3) = tensor_field("stress", frame%stress)
      there = 1
      if (allocated(frame%absent)) there = merge(0, 1, frame%absent)
      of_blocks(4) = state_field("present", there)
      of_joints(1) = vector_field("force", force)
      of_joints(2) = state_field("state_first", states(1, :))
      of_joints(3) = state_field("state_second", states(2, :))
      call write_polygons(stem//".vtu", frame%moved + spread(origin, 2, size(frame%moved, 2)), &
         & system%first_vertex, of_corners, of_blocks, error)
      if (.not. allocated(error)) call write_points(stem//"_joints.vtu", place, of_joints, error)
   end subroutine write_picture
end submodule dda_run_cases
