!> Memory that is used again from case to case, for the C library glibc
module dda_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private

   public :: keep_memory

   !> Free memory at the end of the heap that goes back to the system [bytes]
   integer(c_int), parameter :: trim_threshold = -1
   !> How much more than is needed the heap grows by [bytes]
   integer(c_int), parameter :: top_pad = -2
   !> Size from which on an array gets pages of its own [bytes]
   integer(c_int), parameter :: mmap_threshold = -3

   interface
      !> C: set a parameter of the allocator
      function c_mallopt(parameter, value) bind(c, name="mallopt") result(done)
         import :: c_int
         integer(c_int), intent(in), value :: parameter  !! One of the above
         integer(c_int), intent(in), value :: value      !! Its value
         integer(c_int) :: done                          !! 1 if it was set
      end function c_mallopt
   end interface

contains

   !> Keep freed memory instead of giving it back: a case uses as much as the case before, and pages
   !> that are new must be cleared by the system, which can take longer than the decision itself
   subroutine keep_memory()
      integer(c_int) :: done

      done = c_mallopt(trim_threshold, huge(done))
      done = c_mallopt(mmap_threshold, 32_c_int*1024_c_int**2)
      done = c_mallopt(top_pad, 1024_c_int**2)
   end subroutine keep_memory
end module dda_memory
