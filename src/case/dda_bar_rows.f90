!> The bars of a case as rows of bars.csv
module dda_bar_rows
   use dda_bar, only : bar_name, bar_state_t
   use dda_case, only : case_t
   use dda_growing_text, only : add_line, growing_text_t, lines_of
   use dda_text, only : to_text
   use dda_kinds, only : wp
   implicit none
   private

   public :: bar_lines, bars_header

   !> Names of the columns
   character(len=*), parameter :: bars_header = "case,time,bar,force,state"

contains

   !> Bars in the pictures of a case, and at its end
   pure function bar_lines(number, this) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      type(case_t), intent(in) :: this
      !> Rows, parted by line ends; empty without bars
      character(len=:), allocatable :: lines
      type(growing_text_t) :: rows
      real(wp) :: time
      integer :: i

      lines = ""
      if (allocated(this%error)) return
      time = 0.0_wp
      if (allocated(this%album%frame)) then
         do i = 1, this%album%n
            if (.not. allocated(this%album%frame(i)%bar)) cycle
            call add_rows(number, this%album%frame(i)%time, this%album%frame(i)%bar, rows)
            time = this%album%frame(i)%time
         end do
      end if
      if (this%searches) then
         if (allocated(this%critical%standing)) then
            if (allocated(this%critical%standing%system%bar)) &
               & call add_rows(number, time, this%critical%standing%system%bar, rows)
         end if
      else if (allocated(this%decision%system%bar)) then
         call add_rows(number, end_time(this, time), this%decision%system%bar, rows)
      end if
      lines = lines_of(rows)
   end function bar_lines

   !> Time at the end of a case
   pure real(wp) function end_time(this, last)
      type(case_t), intent(in) :: this
      !> Time of its last picture [s]
      real(wp), intent(in) :: last

      end_time = last
      if (this%scene%settings%dynamic) end_time = max(last, this%onward%time)
      if (this%decision%outcome%has_path) end_time = this%decision%outcome%path_time
   end function end_time

   !> Add a row a bar
   pure subroutine add_rows(number, time, bar, rows)
      integer, intent(in) :: number
      !> The time [s]
      real(wp), intent(in) :: time
      !> The bars
      type(bar_state_t), intent(in) :: bar(:)
      type(growing_text_t), intent(inout) :: rows
      integer :: i

      do i = 1, size(bar)
         call add_line(rows, to_text(number)//","//to_text(time)//","//to_text(i)//"," &
            & //to_text(bar(i)%force)//","//trim(bar_name(bar(i)%condition)))
      end do
   end subroutine add_rows
end module dda_bar_rows
