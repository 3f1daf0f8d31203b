!> Frames of a run as CSV: block corners (frames.csv), joints (frame_joints.csv)
module dda_write_frames
   use dda_kinds, only : wp
   use dda_text, only : add_line, fields, growing_text_t, lines_of, to_text
   implicit none
   private

   public :: frame_joint_row_t
   public :: frames_header, frame_lines, frame_joints_header, frame_joint_lines
   public :: points_header, point_lines

   !> A row of frame_joints.csv without the columns of its frame
   type :: frame_joint_row_t
      integer :: joint = 0                !! Number of the joint, from 1
      real(wp) :: contact(2, 2) = 0.0_wp  !! Positions of the two contacts: (2, 2) [m]
      !> Point of application of the force; without force, the middle of the joint: (2) [m]
      real(wp) :: point(2) = 0.0_wp
      real(wp) :: force(2) = 0.0_wp      !! Force of the joint on its second block: (2) [N/m]
      character(len=8) :: state(2) = ""  !! State of each contact in one word: (2)
   end type frame_joint_row_t

   !> Names of the columns of frames.csv
   character(len=*), parameter :: frames_header = "case,frame,step,time,block,vertex,x,y"
   !> Names of the columns of frame_joints.csv
   character(len=*), parameter :: frame_joints_header = &
      & "case,frame,joint,x_1,y_1,x_2,y_2,x,y,force_x,force_y,state_1,state_2"
   !> Names of the columns of points.csv
   character(len=*), parameter :: points_header = "case,step,time,point,x,y,u,v,vx,vy"

contains

   !> Rows of one frame in frames.csv
   pure function frame_lines(case_and_frame, step, time, first_vertex, point, absent) result(lines)
      character(len=*), intent(in) :: case_and_frame  !! Numbers of the case and of the frame
      integer, intent(in) :: step                     !! Number of accepted steps
      real(wp), intent(in) :: time                    !! Time [s]
      !> First corner of each block, and one past the last: (n_block + 1)
      integer, intent(in) :: first_vertex(:)
      real(wp), intent(in) :: point(:, :)         !! Corners of all blocks: (2, n_vertex) [m]
      logical, intent(in), optional :: absent(:)  !! Absent blocks, without rows: (n_block)
      character(len=:), allocatable :: lines
      character(len=:), allocatable :: common
      type(growing_text_t) :: rows
      integer :: block, vertex

      common = case_and_frame//","//to_text(step)//","//to_text(time)//","
      do block = 1, size(first_vertex) - 1
         if (present(absent)) then
            if (absent(block)) cycle
         end if
         do vertex = first_vertex(block), first_vertex(block + 1) - 1
            call add_line(rows, common//to_text(block)//"," &
               & //to_text(vertex - first_vertex(block) + 1)//","//fields(point(:, vertex)))
         end do
      end do
      lines = lines_of(rows)
   end function frame_lines

   !> Rows of one frame in frame_joints.csv
   pure function frame_joint_lines(case_and_frame, row) result(lines)
      character(len=*), intent(in) :: case_and_frame
      type(frame_joint_row_t), intent(in) :: row(:)  !! The joints: (n_joint)
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      integer :: j

      do j = 1, size(row)
         call add_line(rows, case_and_frame//","//to_text(row(j)%joint)//"," &
            & //fields(row(j)%contact(:, 1))//","//fields(row(j)%contact(:, 2))//"," &
            & //fields(row(j)%point)//","//fields(row(j)%force)//"," &
            & //trim(row(j)%state(1))//","//trim(row(j)%state(2)))
      end do
      lines = lines_of(rows)
   end function frame_joint_lines

   !> Rows of the monitoring points of one case in points.csv
   pure function point_lines(number, when, point, track, origin, speed) result(lines)
      integer, intent(in) :: number       !! Number of the case
      real(wp), intent(in) :: when(:, :)  !! Step and time: (2, n) [-, s]
      !> Coordinates of the points in the reference shape: (2, n_point) [m]
      real(wp), intent(in) :: point(:, :)
      real(wp), intent(in) :: track(:, :, :)  !! Their coordinates in each step: (2, n_point, n) [m]
      real(wp), intent(in) :: origin(2)       !! Origin of the coordinates: (2) [m]
      !> Their velocities, absent if not known: (2, n_point, n or more) [m/s]
      real(wp), intent(in), optional :: speed(:, :, :)
      character(len=:), allocatable :: lines
      character(len=:), allocatable :: fast
      type(growing_text_t) :: rows
      integer :: i, k

      do k = 1, size(when, 2)
         do i = 1, size(track, 2)
            fast = ","
            if (present(speed)) fast = fields(speed(:, i, k))
            call add_line(rows, to_text(number)//","//to_text(nint(when(1, k)))//"," &
               & //to_text(when(2, k))//","//to_text(i)//","//fields(track(:, i, k) + origin)//"," &
               & //fields(track(:, i, k) - point(:, i))//","//fast)
         end do
      end do
      lines = lines_of(rows)
   end function point_lines
end module dda_write_frames
