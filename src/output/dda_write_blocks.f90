!> Blocks as CSV: a row a corner, with its displacement (blocks.csv)
module dda_write_blocks
   use dda_growing_text, only : add_line, fields, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: told_blocks_t, blocks_header, block_lines

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
end module dda_write_blocks
