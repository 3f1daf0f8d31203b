!> Files of frames: VTU with an index for ParaView, and CSV
submodule (dda_verbs:dda_run_cases) dda_picture_files
   use dda_block_rows, only : contact_states, frame_joint_rows
   use dda_binary_file, only : remove_link
   use dda_block_system, only : block_system_t
   use dda_force_rows, only : bar_lines, reaction_text
   use dda_frames, only : album_t, frame_t
   use dda_table_file, only : table_file_t
   use dda_write_frames, only : frame_joint_lines, frame_joint_row_t, frame_lines, point_lines
   use dda_write_results, only : energy_lines
   use dda_write_vtu, only : field_t, index_entry, scalar_field, state_field, tensor_field, &
      & vector_field, write_index, write_points, write_polygons
   implicit none

contains

   !> Write the frames, bars, monitoring points, energies and reactions of a case
   module procedure write_pictures
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
   end procedure write_pictures

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
      !> Joints of the frame: (n_joint)
      type(frame_joint_row_t), intent(in) :: row(:)
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

end submodule dda_picture_files
