!> Progress callback of a long task
module dda_watch
   use dda_kinds, only : wp
   implicit none
   private

   public :: watch_t

   !> Is told of a task now and then, and makes of it what it likes
   type, abstract :: watch_t
   contains
      procedure(tell_of_task), deferred :: tell  !! Tell of the task
   end type watch_t

   abstract interface
      !> Tell how far a task is
      subroutine tell_of_task(watch, task, share)
         import :: watch_t, wp
         class(watch_t), intent(inout) :: watch
         character(len=*), intent(in) :: task  !! What is done
         !> How much of it is done, from 0 to 1; below 0 if that is not known
         real(wp), intent(in) :: share
      end subroutine tell_of_task
   end interface
end module dda_watch
