!> Frames of a run as CSV: a row for each corner of each block (frames.csv), a row for each joint
!> (frame_joints.csv)
module dda_write_frames
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: frame_stamp_t, frame_joint_row_t
   public :: frames_header, frame_lines, frame_joints_header, frame_joint_lines

   !> What all rows of a frame have in common
   type :: frame_stamp_t
      !> Number of the case, from 1
      integer :: number = 0
      !> Number of the frame, from 0
      integer :: frame = 0
      !> Accepted steps before it
      integer :: step = 0
      !> Sum of the lengths of these steps [s]
      real(wp) :: time = 0.0_wp
   end type frame_stamp_t

   !> One row of frame_joints.csv without what its frame has in common
   type :: frame_joint_row_t
      !> Number of the joint, from 1
      integer :: joint = 0
      !> Where the two contacts of the joint are: (2, 2) [m]
      real(wp) :: contact(2, 2) = 0.0_wp
      !> Where the force acts; of no force, the middle of the joint: (2) [m]
      real(wp) :: point(2) = 0.0_wp
      !> Force of the joint on its second block: (2) [N/m]
      real(wp) :: force(2) = 0.0_wp
      !> What the two contacts do, in a word each: (2)
      character(len=8) :: state(2) = ""
   end type frame_joint_row_t

   !> Rows that are put together into one text, whose room doubles where it must
   type :: rows_t
      !> The text and room behind it
      character(len=:), allocatable :: text
      !> Length of the text
      integer :: length = 0
   end type rows_t

contains

   !> Names of the columns of frames.csv
   pure function frames_header() result(line)
      !> The line
      character(len=:), allocatable :: line

      line = "case,frame,step,time,block,vertex,x,y"
   end function frames_header

   !> Rows of one frame in frames.csv
   pure function frame_lines(stamp, first_vertex, point) result(lines)
      !> Case, frame, step and time
      type(frame_stamp_t), intent(in) :: stamp
      !> First corner of each block, and one beyond the last: (n_block + 1)
      integer, intent(in) :: first_vertex(:)
      !> Corners of all blocks: (2, n_vertex) [m]
      real(wp), intent(in) :: point(:, :)
      !> The rows, parted by line ends
      character(len=:), allocatable :: lines
      character(len=:), allocatable :: common
      type(rows_t) :: rows
      integer :: block, vertex

      common = stamp_text(stamp)//","//to_text(stamp%step)//","//to_text(stamp%time)//","
      do block = 1, size(first_vertex) - 1
         do vertex = first_vertex(block), first_vertex(block + 1) - 1
            call add_row(rows, common//to_text(block)//"," &
               & //to_text(vertex - first_vertex(block) + 1)//","//pair(point(:, vertex)))
         end do
      end do
      lines = text_of(rows)
   end function frame_lines

   !> Names of the columns of frame_joints.csv
   pure function frame_joints_header() result(line)
      !> The line
      character(len=:), allocatable :: line

      line = "case,frame,joint,x_1,y_1,x_2,y_2,x,y,force_x,force_y,state_1,state_2"
   end function frame_joints_header

   !> Rows of one frame in frame_joints.csv
   pure function frame_joint_lines(stamp, row) result(lines)
      !> Case and frame
      type(frame_stamp_t), intent(in) :: stamp
      !> The joints: (n_joint)
      type(frame_joint_row_t), intent(in) :: row(:)
      !> The rows, parted by line ends
      character(len=:), allocatable :: lines
      type(rows_t) :: rows
      integer :: j

      do j = 1, size(row)
         call add_row(rows, stamp_text(stamp)//","//to_text(row(j)%joint)//"," &
            & //pair(row(j)%contact(:, 1))//","//pair(row(j)%contact(:, 2))//"," &
            & //pair(row(j)%point)//","//pair(row(j)%force)//"," &
            & //trim(row(j)%state(1))//","//trim(row(j)%state(2)))
      end do
      lines = text_of(rows)
   end function frame_joint_lines

   !> Case and frame as the first fields of a row
   pure function stamp_text(stamp) result(text)
      !> Case and frame
      type(frame_stamp_t), intent(in) :: stamp
      !> The fields
      character(len=:), allocatable :: text

      text = to_text(stamp%number)//","//to_text(stamp%frame)
   end function stamp_text

   !> Two fields of a row
   pure function pair(vector) result(text)
      !> The numbers: (2)
      real(wp), intent(in) :: vector(2)
      !> The fields
      character(len=:), allocatable :: text

      text = to_text(vector(1))//","//to_text(vector(2))
   end function pair

   !> Put a row below the others
   pure subroutine add_row(rows, row)
      !> The rows so far
      type(rows_t), intent(inout) :: rows
      !> The row
      character(len=*), intent(in) :: row
      character(len=:), allocatable :: longer
      integer :: room

      if (.not. allocated(rows%text)) rows%text = repeat(" ", 4096)
      room = rows%length + len(row) + 1
      if (room > len(rows%text)) then
         longer = rows%text//repeat(" ", max(room, len(rows%text)))
         call move_alloc(longer, rows%text)
      end if
      rows%text(rows%length + 1:room) = row//new_line("a")
      rows%length = room
   end subroutine add_row

   !> The rows without the last line end
   pure function text_of(rows) result(text)
      !> The rows
      type(rows_t), intent(in) :: rows
      !> The text; empty if there are none
      character(len=:), allocatable :: text

      text = ""
      if (rows%length > 0) text = rows%text(:rows%length - 1)
   end function text_of
end module dda_write_frames
