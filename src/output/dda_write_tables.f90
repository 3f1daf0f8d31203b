!> Rows of blocks.csv, energy.csv and reactions.csv
module dda_write_tables
   use dda_growing_text, only : add_line, fields, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: block_lines, blocks_header, energy_header, energy_lines, reaction_lines
   public :: reactions_header, told_blocks_t

   !> The blocks of one case
   type :: told_blocks_t
      !> First corner of each block, and one beyond the last: (n_block + 1)
      integer, allocatable :: first_vertex(:)
      !> fixed, held (by points) or free: (n_block)
      character(len=5), allocatable :: state(:)
      !> Corners at the beginning, in the user's coordinates: (2, n_vertex) [m]
      real(wp), allocatable :: corner(:, :)
      !> Displacements of the corners at the end, or a collapse mechanism whose largest displacement
      !> is 1; unallocated where they are not known: (2, n_vertex) [m]
      real(wp), allocatable :: displacement(:, :)
   end type told_blocks_t

   !> Names of the columns of blocks.csv
   character(len=*), parameter :: blocks_header = "case,block,state,vertex,x,y,u,v"

   !> Names of the columns
   character(len=*), parameter :: energy_header = &
      & "case,step,time,kinetic,elastic,contact,gravity,work,friction,damping,impact,numerical"

   !> Names of the columns
   character(len=*), parameter :: reactions_header = "case,time,block,point,fx,fy,moment"

contains

   !> Rows of the blocks of one case in blocks.csv
   pure function block_lines(number, blocks) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      type(told_blocks_t), intent(in) :: blocks
      character(len=:), allocatable :: lines
      character(len=:), allocatable :: common
      type(growing_text_t) :: rows
      integer :: b, v

      do b = 1, size(blocks%state)
         if (blocks%state(b) == "") cycle
         common = to_text(number)//","//to_text(b)//","//trim(blocks%state(b))//","
         do v = blocks%first_vertex(b), blocks%first_vertex(b + 1) - 1
            if (allocated(blocks%displacement)) then
               call add_line(rows, common//to_text(v - blocks%first_vertex(b) + 1)//"," &
                  & //fields(blocks%corner(:, v))//","//fields(blocks%displacement(:, v)))
            else
               call add_line(rows, common//to_text(v - blocks%first_vertex(b) + 1)//"," &
                  & //fields(blocks%corner(:, v))//",,")
            end if
         end do
      end do
      lines = lines_of(rows)
   end function block_lines

   !> Rows of one case
   pure function energy_lines(number, value) result(lines)
      integer, intent(in) :: number
      !> Time and energies after each step, as the columns have them: (10, n_step) [s, J per metre]
      real(wp), intent(in) :: value(:, :)
      character(len=:), allocatable :: lines
      type(growing_text_t) :: text
      integer :: k

      do k = 1, size(value, 2)
         call add_line(text, to_text(number)//","//to_text(k)//","//fields(value(:, k)))
      end do
      lines = lines_of(text)
   end function energy_lines

   !> Rows of one case
   pure function reaction_lines(number, time, support, reaction, origin) result(lines)
      integer, intent(in) :: number
      !> The times: (n_time) [s]
      real(wp), intent(in) :: time(:)
      !> Block, and number of the held point or 0: (2, n)
      integer, intent(in) :: support(:, :)
      !> Force, and moment about the origin of the blocks' coordinates:
      !> (3, n, n_time) [N/m, N/m, N]
      real(wp), intent(in) :: reaction(:, :, :)
      !> Where that origin is in coordinates of the user: (2) [m]
      real(wp), intent(in) :: origin(2)
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      real(wp) :: moment
      integer :: i, k

      do k = 1, size(time)
         do i = 1, size(support, 2)
            associate (r => reaction(:, i, k))
               moment = r(3) + origin(1)*r(2) - origin(2)*r(1)
               call add_line(rows, to_text(number)//","//to_text(time(k))//"," &
                  & //to_text(support(1, i))//","//to_text(support(2, i))//"," &
                  & //fields([r(1:2), moment]))
            end associate
         end do
      end do
      lines = lines_of(rows)
   end function reaction_lines
end module dda_write_tables
