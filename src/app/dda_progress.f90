!> How far a run is, on a terminal
module dda_progress
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: progress_t, report_progress, clear_progress

   !> What was told so far
   type :: progress_t
      !> Whether anything is told
      logical :: shown = .false.
      !> Number of cases
      integer :: total = 0
      !> Cases done
      integer :: done = 0
      !> Clock at the beginning
      integer(int64) :: start = 0
   end type progress_t

contains

   !> Count one case and tell how many are done and how long the others will take
   subroutine report_progress(progress)
      !> What was told so far
      type(progress_t), intent(inout) :: progress
      integer(int64) :: now, rate
      real(wp) :: left

      progress%done = progress%done + 1
      if (.not. progress%shown .or. progress%done == progress%total) return
      call system_clock(now, rate)
      left = real(now - progress%start, wp)/real(rate, wp) &
         & *real(progress%total - progress%done, wp)/real(progress%done, wp)
      write (error_unit, "(a)", advance="no") achar(13)//"case "//to_text(progress%done)//" of " &
         & //to_text(progress%total)//", about "//to_text(ceiling(left))//" s left"
      flush (error_unit)
   end subroutine report_progress

   !> Wipe the line
   subroutine clear_progress(progress)
      !> What was told so far
      type(progress_t), intent(in) :: progress

      if (.not. progress%shown .or. progress%done == 0) return
      write (error_unit, "(a)", advance="no") achar(13)//repeat(" ", 60)//achar(13)
      flush (error_unit)
   end subroutine clear_progress
end module dda_progress
