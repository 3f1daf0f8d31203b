!> How far a run, or a long task before it, is, on a terminal
module dda_progress
   use, intrinsic :: iso_fortran_env, only : error_unit, int64
   use dda_kinds, only : wp
   use dda_text, only : to_text
   use dda_watch, only : watch_t
   implicit none
   private

   public :: progress_t, report_progress, clear_progress, terminal_watch_t, end_watch

   !> Width of a line on the screen
   integer, parameter :: width = 60
   !> Of so many cases each one is reported, of more they are in intervals
   integer, parameter :: few = 100
   !> A task is reported once it has taken so long, then in intervals [s]
   real(wp), parameter :: patience = 0.5_wp, interval = 0.2_wp

   !> What was told so far
   type :: progress_t
      !> Whether anything is told
      logical :: shown = .false.
      !> Number of cases
      integer :: total = 0
      !> Cases done
      integer :: done = 0
      !> Clock at the beginning, and when the line was written
      integer(int64) :: start = 0, last = 0
      !> Whether it stands on the screen
      logical :: told = .false.
   end type progress_t

   !> Tells of tasks on a terminal
   type, extends(watch_t) :: terminal_watch_t
      !> Whether anything is told
      logical :: shown = .false.
      !> Whether a line stands on the screen
      logical :: told = .false.
      !> Clock at the beginning, and when the line was written
      integer(int64) :: start = 0, last = 0
      !> The task that was told of
      character(len=width) :: task = ""
   contains
      !> Tell of a task
      procedure :: tell => tell_of_task
   end type terminal_watch_t

contains

   !> Tell how far a task is: not at once, and not too often
   subroutine tell_of_task(watch, task, share)
      class(terminal_watch_t), intent(inout) :: watch
      !> What is done
      character(len=*), intent(in) :: task
      !> How much of it is done, from 0 to 1; below 0 if that is not known
      real(wp), intent(in) :: share
      integer(int64) :: now, rate
      character(len=width) :: line

      if (.not. watch%shown) return
      call system_clock(now, rate)
      if (watch%start == 0) watch%start = now
      if (real(now - watch%start, wp) < patience*real(rate, wp)) return
      if (watch%task == task .and. real(now - watch%last, wp) < interval*real(rate, wp)) return
      watch%last = now
      watch%task = task
      watch%told = .true.
      line = task
      if (share >= 0.0_wp) line = task//": "//to_text(int(100.0_wp*share))//" %"
      write (error_unit, "(a)", advance="no") achar(13)//line
      flush (error_unit)
   end subroutine tell_of_task

   !> Wipe the line of a task
   subroutine end_watch(watch)
      class(terminal_watch_t), intent(inout) :: watch

      if (watch%told) call wipe_line()
      watch%told = .false.
      watch%start = 0
   end subroutine end_watch

   !> Wipe the line on the screen
   subroutine wipe_line()
      write (error_unit, "(a)", advance="no") achar(13)//repeat(" ", width)//achar(13)
      flush (error_unit)
   end subroutine wipe_line

   !> Count one case and tell how many are done and how long the others will take
   subroutine report_progress(progress)
      type(progress_t), intent(inout) :: progress
      integer(int64) :: now, rate
      real(wp) :: left

      progress%done = progress%done + 1
      if (.not. progress%shown .or. progress%done == progress%total) return
      call system_clock(now, rate)
      if (progress%total > few .and. real(now - progress%last, wp) < interval*real(rate, wp)) return
      progress%last = now
      progress%told = .true.
      left = real(now - progress%start, wp)/real(rate, wp) &
         & *real(progress%total - progress%done, wp)/real(progress%done, wp)
      write (error_unit, "(a)", advance="no") achar(13)//"case "//to_text(progress%done)//" of " &
         & //to_text(progress%total)//", about "//to_text(ceiling(left))//" s left"
      flush (error_unit)
   end subroutine report_progress

   !> Wipe the line
   subroutine clear_progress(progress)
      type(progress_t), intent(inout) :: progress

      if (.not. progress%told) return
      call wipe_line()
      progress%told = .false.
   end subroutine clear_progress
end module dda_progress
