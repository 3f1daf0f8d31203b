!> Progress callback of a long task
module dda_watch
   use dda_kinds, only : wp
   implicit none
   private

   public :: watch_t

   !> Receiver of progress reports
   type, abstract :: watch_t
   contains
      procedure(report_task), deferred :: tell  !! Report the progress of a task
   end type watch_t

   abstract interface
      !> Report the progress of a task
      subroutine report_task(watch, task, share)
         import :: watch_t, wp
         class(watch_t), intent(inout) :: watch
         character(len=*), intent(in) :: task  !! Name of the task
         real(wp), intent(in) :: share         !! Completed share from 0 to 1; negative if not known
      end subroutine report_task
   end interface
end module dda_watch
