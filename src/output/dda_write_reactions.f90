!> Rows of reactions.csv: what supports put on the blocks
module dda_write_reactions
   use dda_growing_text, only : add_line, fields, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: reactions_header, reaction_lines

   !> Names of the columns
   character(len=*), parameter :: reactions_header = "case,time,block,point,fx,fy,moment"

contains

   !> Rows of one case
   pure function reaction_lines(number, time, support, reaction, origin) result(lines)
      !> Number of the case
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
end module dda_write_reactions
